#!/bin/bash
# farfield-fly over a small pack: the same twice, the same on every back end, no cracks whatever the link does, events, errors, and
# the same flight against a real server.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
fly=$bin/farfield-fly
work=build/tests/fly.$$ # runs may go on side by side; left behind only after a failure
mkdir -p "$work"
server_pid=
trap '[ -n "$server_pid" ] && kill "$server_pid" 2>/dev/null' EXIT
. tests/rig/result.bash
is() { # EXPRESSION WHAT: a python expression over the rows `r` (dicts of numbers), and the summary `s`, of the flight last flown
    python3 - "$work/$flown.csv" "$work/$flown.json" "$1" <<'END'
import csv, json, sys
r = [{k: v if k.endswith("_hash") else float(v) for k, v in row.items()} for row in csv.DictReader(open(sys.argv[1]))]
s = json.load(open(sys.argv[2]))
sys.exit(0 if eval(sys.argv[3]) else 1)
END
    result $? "$2"
}
flies() { # NAME ARGUMENTS...: over the hills, unless they name packs
    flown=$1
    shift
    case " $* " in *" --pack "*) ;; *) set -- --pack "$work/hills.ffp" "$@" ;; esac
    timeout 300 "$fly" --csv "$work/$flown.csv" --json "$@" >"$work/$flown.json" 2>"$work/$flown.err"
}

hashes() { # NAME: of the flight's pictures
    sed -n 's/.*"frame_hash": "\([0-9a-f]*\)".*/\1/p' "$work/$1.json"
}

python3 tests/rig/hills.py 257 "$work/hills.raw" 9 "$work/node.raw"
"$bin/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 40 --tile-log2 6 --quiet -o "$work/hills.ffp" &&
    "$bin/farfield-bake" "$work/node.raw" --raw 9x9 --spacing 40 --tile-log2 3 --quiet -o "$work/node.ffp" &&
    "$bin/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 40 --densify 2 --tile-log2 6 --quiet -o "$work/dense.ffp"
result $? "packs to fly over"

# ---- the same again ----
usual="--link gprs --panorama on --quality px:2 --back-plane 1500 --seconds 6 --settle 6 --sample 0.5 --audit on"
flies first $usual --backend gl --png "$work/pictures" --every 6
result $? "a flight over GPRS with panorama and audit"
is 's["crack_frames"] == 0 and s["stitched_frames"] > 0' "no crack in any frame, and stitching was needed"
is 's["seed"] == 1 and s["frames"] == 361 and len(r) == 25 and abs(r[-1]["t_s"] - 12) < 1e-9' "the summary and the rows are complete"
is 'all(a["bytes_down"] <= b["bytes_down"] for a, b in zip(r, r[1:])) and r[-1]["bytes_down"] > 2000' "bytes arrive and are counted"
is 's["panoramas"] + r[12]["panoramas"] > 0 and r[-1]["panorama_faces"] > 0' "panoramas are asked for and arrive"
is 'r[-1]["err_px_p95"] < 6 and r[-1]["undrawn_px_percent"] < 5 and 0 <= s["settle_s"] <= 12' "the picture is right at the end"
is 'abs(((r[-1]["x_m"] - r[0]["x_m"])**2 + (r[-1]["y_m"] - r[0]["y_m"])**2)**0.5 - 250) < 1' "6 s at 150 km/h are 250 m"
is 'r[0]["x_m"] == r[12]["x_m"] != r[14]["x_m"]' "it stands still before"
is 'len({row["frame_hash"] for row in r}) > 10' "pictures change"
head -1 "$work/first.csv" | grep -q '^t_s,x_m,y_m,z_m,triangles,nodes_drawn,nodes_held,bytes_down,bytes_up,requests,in_flight,panoramas,err_px_rms,err_px_p95,err_px_max,frame_hash,'
result $? "the CSV's columns stand as promised"
faces_err() { # TEXELS: mean square of the panorama's error with faces of so many texels
    flies "faces$1" $usual --backend none --seconds 1 --face "$1" --memory 8M
    python3 -c "import json; print(json.load(open('$work/faces$1.json'))['square_px_panorama'])"
}
coarse=$(faces_err 64) && fine=$(faces_err 512) && python3 -c "exit(not $coarse > 2 * $fine > 0)"
result $? "faces of larger texels are more wrong"
flies faces $usual --backend none --audit off --seconds 1 --face 128
is "0 < r[12]['panorama_bytes'] < 0.7 * $(python3 -c "
import csv; print(list(csv.DictReader(open('$work/first.csv')))[12]['panorama_bytes'])")" "smaller faces cost fewer bytes"
[ "$(ls "$work/pictures")" = "frame-0000.00.png
frame-0006.00.png
frame-0012.00.png" ]
result $? "pictures are written when asked for"

flies again $usual --backend gl
cmp -s "$work/first.csv" "$work/again.csv"
result $? "the same seed gives the same CSV, byte for byte"
flies seed2 $usual --backend none --seed 2
! cmp -s <(cut -d, -f8-12 "$work/first.csv") <(cut -d, -f8-12 "$work/seed2.csv")
result $? "another seed gives other arrivals"
for backend in gles1 soft none; do
    flies "$backend" $usual --backend $backend
    cmp -s <(cut -d, -f1-15,17- "$work/first.csv") <(cut -d, -f1-15,17- "$work/$backend.csv")
    result $? "all but the pixels is the same with backend $backend"
done
is 'all(row["frame_hash"] == "0" * 16 for row in r)' "without a back end there are no pixels"
flies narrow $usual --backend soft565
cp "$work/narrow.csv" "$work/narrow1.csv"
flies narrow $usual --backend soft565
cmp -s "$work/narrow.csv" "$work/narrow1.csv" && ! cmp -s "$work/narrow.csv" "$work/soft.csv"
result $? "RGB565 gives the same pixels twice, and others than RGBA8888"
flies plain $usual --backend gl --plain-arrays
cmp -s "$work/first.csv" "$work/plain.csv"
result $? "plain arrays draw the same picture as vertex buffers"
flies wire $usual --backend gl --wireframe
is 's["crack_frames"] == 0' "a wireframe flight"
! cmp -s <(cut -d, -f16 "$work/first.csv") <(cut -d, -f16 "$work/wire.csv")
result $? "and its pictures differ"

# ---- hidden ground ----
behind="--link umts --panorama off --quality px:2 --height 20 --speed 450 --seconds 6 --settle 6 --sample 0.2 --fps 10"
for backend in soft gl; do
    flies $backend-left-out $behind --backend $backend
    is 'sum(row["triangles_hidden"] for row in r) > len(r) * 100' "near ground hides triangles ($backend)"
    flies $backend-drawn $behind --backend $backend --hidden drawn
    [ "$(hashes $backend-left-out)" = "$(hashes $backend-drawn)" ]
    result $? "drawn or left out, hidden ground has no pixel ($backend)"
done
flies fetched $behind --backend none --hidden fetched
is 'all(row["nodes_hidden"] == 0 for row in r)' "nothing hides where all is fetched"

# ---- panorama, quality ----
quick="--backend none --link lan --seconds 4 --settle 2 --audit on --back-plane 1500"
flies off $quick --panorama off --quality 3:4
is 's["panoramas"] == 0 and r[-1]["panorama_bytes"] == 0 and r[-1]["panorama_px_percent"] == 0' "panorama off: none asked for"
triangles_off=$(python3 -c "import json; print(json.load(open('$work/off.json'))['triangles'])")
flies on $quick --panorama on --quality 3:4
is "r[-1]['panorama_px_percent'] > 1 and s['triangles'] < $triangles_off" "panorama on: it shows ground, and triangles are saved"
flies fine $quick --panorama off --quality px:0.5 --view 20000
is 'r[-1]["err_px_max"] < 2 and r[-1]["undrawn_px_percent"] == 0' "half a pixel of error allowed: the audit finds no more than two"
is 'r[-1]["skyline_px_rms"] < 1 and s["skyline_px_p95"] < 2 and all(row["skyline_px_rms"] <= row["skyline_px_max"] <= s["skyline_px_max"] or row["t_s"] <= 2 for row in r)' \
    "and its skyline is right"
skyline=$(python3 -c "import json; print(json.load(open('$work/fine.json'))['skyline_px_rms'])")
flies rough $quick --panorama off --quality 0.5:2 --view 20000
is "s['skyline_px_rms'] > 3 * $skyline" "the skyline of coarse ground is wrong"
# ground far beyond 100 km is the panorama's, too
"$bin/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 1000 --tile-log2 6 --quiet -o "$work/wide.ffp"
flies wide $quick --pack "$work/wide.ffp" --panorama on --height 12000 --speed 0 --start 0.1
is "r[-1]['panorama_px_percent'] > 99 and r[-1]['undrawn_px_percent'] == 0 and r[-1]['skyline_px_p95'] < 2" \
    "a panorama's ground beyond 100 km counts as drawn"

flies toggled $quick --panorama on --event 2:panorama-off
is 'r[1]["panoramas"] > 0 and r[-1]["panoramas"] == r[3]["panoramas"] and r[-1]["panorama_px_percent"] == 0' "the panorama can be switched off in flight"

# ---- judged by the source ----
"$bin/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 40 --tile-log2 6 --max-error 4 --quiet -o "$work/lossy.ffp" &&
    "$bin/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 40 --tile-log2 7 --quiet -o "$work/tiles.ffp" &&
    "$bin/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 41 --tile-log2 6 --quiet -o "$work/wide.ffp"
result $? "other packs of the same ground"
of() { python3 -c "import json; print(json.load(open('$work/$1.json'))['$2'])"; }
fine="--pack $work/lossy.ffp $quick --panorama off --quality px:0.5 --view 20000"
flies itself $fine
is "s['truth'] == '$work/lossy.ffp' and s['truth_error_m'] == 4" "a pack is judged by itself, unless another is named"
flies source $fine --truth "$work/hills.ffp"
is "s['truth'] == '$work/hills.ffp' and s['truth_error_m'] == 0 and all(row['truth_error_m'] == 0 for row in r)" "and says which"
is "s['err_px_rms'] > 3 * $(of itself err_px_rms) and s['err_px_p95'] > 3 * $(of itself err_px_p95) and s['request_hash'] == '$(of itself request_hash)'" \
    "4 m that the pack is off are seen by its source alone"
flies source2 $fine --truth "$work/tiles.ffp"
is "s['err_px_rms'] == $(of source err_px_rms)" "however that is cut into tiles"

# ---- as it should look ----
looks="--seconds 0 --settle 6 --sample 6 --link lan --audit on --diff on --every 6"
differs() { # NAME: its picture's mean difference, as last flown
    python3 -c "import json; print(json.load(open('$work/$1.json'))['diff_mean'])"
}
flies settled $looks --backend gl --panorama off --quality px:1 --view 20000 --png "$work/settled" --reference "$work/true"
is '0 < s["diff_mean"] < 1 and s["diff_p95"] < 2 and 0.99 < s["ssim"] < 1' "a picture with all that it needs differs from what it should be by its stairs alone"
is 'r[0]["diff_mean"] > 10 * s["diff_mean"] and r[0]["ssim"] < 0.9' "before anything has come it differs by its ground"
for backend in gl gles1 soft soft565; do
    flies first $looks --backend $backend --settle 1 --link gprs
    is 'r[0]["nodes_held"] == 0 and r[0]["diff_mean"] < 30 and r[0]["ssim"] > 0.7' "and is sky, with backend $backend"
done
flies coarse $looks --backend soft --panorama on --back-plane 1500 --png "$work/coarse" --reference "$work/true2"
is "s['diff_mean'] > $(differs settled) / 2 and s['ssim'] < 0.99" "a coarse one looks less like it"
cmp -s "$work/true/frame-0006.00.png" "$work/true2/frame-0006.00.png"
result $? "what it should be is the same for both, whatever their back ends"
flies fine $looks --backend soft --panorama off --quality px:1 --view 20000
is "s['diff_mean'] < 0.8 * $(differs coarse)" "a pixel of error and no panorama differ less than low"
flies faces $looks --backend soft --panorama on --back-plane 1500 --face 1024 --memory 16M
is "s['diff_mean'] < 0.9 * $(differs coarse)" "larger faces differ less than those of 256"
flies hazy $looks --backend soft --panorama off --quality px:1 --view 6000
flies clear $looks --backend soft --panorama off --quality px:1 --view 6000 --no-fog
is "s['diff_mean'] < $(differs hazy) - 1" "haze counts"
flies rows $looks --backend none --diff off
is 'all(row[c] != row[c] for row in r for c in ("diff_mean", "diff_p95", "ssim")) and s["ssim"] is None' "without --diff there is nothing in its columns"
! "$bin/farfield-fly" --pack "$work/hills.ffp" --backend none --diff on 2>"$work/error" &&
    [ "$(cat "$work/error")" = "farfield-fly: --diff needs a --backend other than none" ]
result $? "--diff without pictures is an error"
! "$bin/farfield-fly" --pack "$work/hills.ffp" --reference "$work/true" 2>"$work/error" &&
    [ "$(cat "$work/error")" = "farfield-fly: --reference needs --png" ]
result $? "--reference without --png is an error"

# ---- to the horizon: 290 km of hills, seen from 3 km above their corner ----
python3 tests/rig/hills.py 257 "$work/far.raw"
"$bin/farfield-bake" "$work/far.raw" --raw 257x257 --spacing 800 --quiet -o "$work/far.ffp"
printf 't_s,x_m,y_m,z_m,heading_deg\n0,9000,9000,4000,45\n9,9000,9000,4000,45\n' >"$work/far.path"
far="--pack $work/far.ffp --path $work/far.path --link lan --seconds 1 --settle 6 --quality px:2 --backend none --audit on"
for panorama in on off; do
    flies far $far --panorama $panorama
    is 's["undrawn_px_percent"] == 0 and s["skyline_px_rms"] < 2' "ground is drawn as far as it can be seen (panorama $panorama)"
done
flies near $far --panorama off --view 30000
is 's["undrawn_px_percent"] > 2 and s["skyline_px_rms"] > 5' "unless a limit is asked for"

# ---- the client's own estimate, against the auditor ----
estimated="--backend none --link umts --seconds 20 --settle 4 --sample 2 --audit on --audit-step 10 --check off"
for ground in hills fractal plateaus; do
    python3 tests/rig/hills.py 257:$ground "$work/wide.raw"
    "$bin/farfield-bake" "$work/wide.raw" --raw 257x257 --spacing 100 --quiet -o "$work/wide.ffp"
    for height in 100 600 2000 12000; do
        flies "estimate-$ground-$height-low" --pack "$work/wide.ffp" $estimated --height $height --panorama off
        flies "estimate-$ground-$height-fine" --pack "$work/wide.ffp" $estimated --height $height --panorama off --quality px:4
        flies "estimate-$ground-$height-finest" --pack "$work/wide.ffp" $estimated --height $height --panorama off --quality px:1
    done
done
python3 - "$work"/estimate-*.csv <<'END'
import csv, sys
near = rows = 0
for name in sys.argv[1:]:
    for row in csv.DictReader(open(name)):
        if float(row["t_s"]) >= 4 and row["err_px_p95"] != "nan":
            ratio = max(float(row["tree_err_px"]), 0.1) / max(float(row["err_px_p95"]), 0.1)
            rows += 1
            near += 0.5 <= ratio <= 2
print("# the estimate is near in %d of %d rows" % (near, rows))
sys.exit(0 if rows > 300 and near >= 0.85 * rows else 1)
END
result $? "over three kinds of ground the client's estimate is within a factor of two of the judged p95 (from 0.1 px on) in 85 rows of 100"

# ---- what the talk costs ----
python3 tests/rig/hills.py 1025 "$work/wide.raw" && "$bin/farfield-bake" "$work/wide.raw" --raw 1025x1025 --spacing 40 --quiet -o "$work/wide.ffp"
talk="--pack $work/wide.ffp --backend none --height 100 --settle 0 --check off"
flies talk $talk --link gprs --seconds 120 --sample 1
is 's["node_requests"] > 20 and s["node_request_bytes"] <= 4 * s["node_requests"]' "a request for a node has 4 bytes as a mean, at most"
is 's["node_answers"] > 20 and s["node_header_bytes"] == 2 * s["node_answers"]' "an answer has 2 bytes before its payload"
is 's["bytes_framing"] < 0.03 * s["bytes_down"] and s["bytes_up"] < 0.05 * s["bytes_down"]' "less than 3 % of what comes is no payload, and up goes less than 5 % of it"
is 's["packets_up"] < s["requests"] and 0 < s["packets_down"]' "requests share packets"
for link in gprs umts nbiot; do
    flies "start-$link" $talk --link "$link" --seconds 30 --sample 0.25 --audit on --fps 8
    is '(lambda a: a["round_trips"] <= 2 and a["t_s"] <= 2 * (a["delay_up_s"] + a["delay_down_s"]) + a["bytes_down"] / {"gprs": 5500, "umts": 48000, "nbiot": 3268}["'"$link"'"] + 1)(next(a for a in r if a["nodes_drawn"] > 0 and a["err_px_p95"] <= 2))' \
        "over $link the picture is right in two round trips, as the link drew them, its bytes and a second"
    is 'r[-1]["wasted_views"] <= 0.05 * r[-1]["bytes_views"]' "and what came so was of use"
done
flies leap $talk --link iridium,stall_every_ms=0 --seconds 40 --sample 0.25 --audit on --fps 8 --event 30:teleport=0.7,0.3
is 'next(a["t_s"] for a in r if a["t_s"] > 30.3 and a["err_px_p95"] <= 2.5) <= 30 + 2 * (r[-1]["delay_up_s"] + r[-1]["delay_down_s"]) + (r[-1]["bytes_down"] - r[120]["bytes_down"]) / 11000 + 1' \
    "after a leap, too"

# ---- relevance ----
flies still $usual --backend none --speed 0 --seconds 20 --reserve off
is '0 < s["relevance_percent"] < 100 and r[-1]["unused_images"] == 0 and r[-1]["unused_heights"] == r[-1]["unused_supporting"] and r[-1]["bytes_reserve"] == 0 and s["relevance_percent"] == s["relevance_no_reserve_percent"] and abs(r[-1]["bytes_heights"] + r[-1]["bytes_images"] + r[-1]["bytes_faces"] + r[-1]["bytes_overhead"] - r[-1]["bytes_down"]) < 1' \
    "standing still all ground that comes is drawn, or lets what is drawn be so fine; the kinds of bytes add up"
flies kept $usual --backend none --speed 0 --seconds 20 --panorama off
is 's["relevance_percent"] < s["relevance_no_reserve_percent"] < 100 and 0 < r[-1]["unused_reserve"] <= r[-1]["bytes_reserve"] < r[-1]["bytes_heights"] and r[-1]["unused_hidden"] > 0 and r[-1]["unused_heights"] == r[-1]["unused_supporting"] + r[-1]["unused_hidden"] + r[-1]["unused_reserve"]' \
    "with a reserve the rest is of the reserve, or was found hidden when it came, and the relevance is told with and without it"
hidden=$(python3 -c "
import csv
last = list(csv.DictReader(open('$work/still.csv')))[-1]
print(float(last['unused_faces']) / float(last['bytes_faces']))")
flies high $usual --backend none --speed 0 --seconds 20 --height 1500 --reserve off
is "r[-1]['unused_faces'] / r[-1]['bytes_faces'] < 0.7 * $hidden < 0.7" "near ground hides more of a panorama from low above it than from high up"

# ---- events ----
flies events $quick --event 2:low-battery --event 4:battery-ok --event 5:interruption
is '[row["low_power"] for row in r] == [0, 0, 1, 1, 0, 1, 1]' "low battery and interruption save power, and end"
flies looks $quick --speed 0 --path diagonal --event 2:turn=90 --event 3:turn=-45 --event 4:pitch=-80 --event 5:fov=20
python3 - "$work/looks.csv" <<'END'
import csv, sys
r = [{k: float(v) for k, v in row.items() if not k.endswith("_hash")} for row in csv.DictReader(open(sys.argv[1]))]
drawn = [row["nodes_drawn"] for row in r]
sys.exit(0 if len({row["geometry_hash"] for row in csv.DictReader(open(sys.argv[1])) if float(row["t_s"]) >= 1}) >= 5 and drawn[6] < drawn[4] else 1)
END
result $? "turns at once, looks down and zooms"
flies cut $quick --event 1:cut --event 3:cut
is 's["crack_frames"] == 0 and r[-1]["reconnects"] == 2 and r[-1]["link_up"] == 1 and r[-1]["err_px_p95"] < 10' "two cuts: reconnected, whole, and the picture gets right"

# ---- bad links: nothing breaks, it is only coarser ----
for link in "lan,cut_every_ms=1000" "lan,down.bytes_s=10" "lan,down.delay_us=60000000" "ideal,down.bytes_s=1000000000" \
            "gprs,stall_every_ms=500,stall_ms_min=100,stall_ms_max=2000" nbiot iridium edge ltem; do
    flies "link" $quick --link "$link"
    result $? "a flight over $link"
    is 's["crack_frames"] == 0' "without a crack"
done
seq 0 30 2000 >"$work/trace"
flies traced $quick --down-trace "$work/trace" --up-trace "$work/trace"
is 'r[-1]["bytes_down"] > 2000 and s["crack_frames"] == 0' "a flight over a recorded link"

# ---- paths, sizes, one node ----
for path in circle hover; do
    flies $path $quick --path $path
    is 's["crack_frames"] == 0 and r[-1]["err_px_p95"] < 10' "path $path"
done
cat >"$work/walk.csv" <<'END'
pitch_deg,t_s,note,x_m,y_m,h_m,heading_deg
-10,1,start,4000,4000,50,350
-10,3,turn,4100,4000,50,10
-30,5,fall,4100,4200,-1000,90
END
flies walk $quick --path "$work/walk.csv" --settle 1
is 'len(r) == 6 and s["crack_frames"] == 0 and s["settle_s"] <= 5' "a recorded path lasts as long as it was recorded"
is '[(a["x_m"], a["y_m"]) for a in r] == [(4000, 4000), (4000, 4000), (4050, 4000), (4100, 4000), (4100, 4100), (4100, 4200)]' "and leads where it led"
is 'abs(r[0]["z_m"] - 50 - (r[5]["z_m"] - 1)) < 500 and r[5]["z_m"] > 300' "above the ground, whatever was recorded"
# The terrain ends 9160 m to the east, within its last tile; from there the flight looks back, below the rim's height in the end.
python3 tests/rig/hills.py 230 "$work/edge.raw"
"$bin/farfield-bake" "$work/edge.raw" --raw 230x230 --spacing 40 --tile-log2 6 --quiet -o "$work/edge.ffp"
cat >"$work/leave.path" <<'END'
t_s,x_m,y_m,z_m,heading_deg
0,8800,5000,2000,90
4,9600,5000,2000,90
5,9600,5000,2000,270
9,13600,5000,2000,270
12,13600,5000,-100,270
END
leave="--path $work/leave.path --link lan --quality px:1 --settle 1 --audit on --audit-step 4"
for panorama in on off; do
    px=$([ $panorama = on ] && echo 7.5 || echo 1) # the parallax allowed, and half a texel
    flies leave $leave --pack "$work/edge.ffp" --panorama $panorama
    is '[(a["x_m"], a["z_m"]) for a in r[:2] + r[9:]] == [(8800, 2000), (9000, 2000), (13600, 2000), (13600, 1300), (13600, 600), (13600, -100)]' \
        "a recorded path leaves the terrain, and keeps above nothing there (panorama $panorama)"
    is 's["crack_frames"] == 0 and r[4]["triangles"] == 0 and r[4]["undrawn_px_percent"] == 0' "looking away there is nothing to draw, and nothing missing (panorama $panorama)"
    is 'all(a["triangles"] > 500 and a["undrawn_px_percent"] == 0 and a["err_px_p95"] <= '$px' for a in r[6:])' \
        "and the terrain is seen from outside (panorama $panorama)"
done
flies flown $quick --path diagonal
flies reflown $quick --path "$work/flown.csv" --seconds 4
is "all(abs(a['x_m'] - float(b['x_m'])) < 0.1 and abs(a['z_m'] - float(b['z_m'])) < 0.1 for a, b in zip(r, csv.DictReader(open('$work/flown.csv'))))" \
    "the CSV of a flight is a recorded path"
printf '# a bad day\n  2:low-battery # comment\n\n4:battery-ok\n3:teleport=0.5,0.5\n' >"$work/day"
flies listed $quick --events "$work/day"
cp "$work/listed.csv" "$work/listed1.csv"
flies listed $quick --event 2:low-battery --event 3:teleport=0.5,0.5 --event 4:battery-ok
cmp -s "$work/listed.csv" "$work/listed1.csv"
result $? "events from a file are those given one by one"
flies away $quick --path "$work/walk.csv" --event 2:teleport=0.75,0.25
is 'r[1]["x_m"] == 4000 and abs(r[2]["x_m"] - 7680) < 1 and abs(r[-1]["y_m"] - r[2]["y_m"] - 200) < 1' "a recorded path goes on from where it is teleported to"
flies around $quick --speed 10000
is 's["crack_frames"] == 0 and all(0 < row["x_m"] < 10240 and 0 < row["y_m"] < 10240 for row in r)' "10 000 km/h turn round before the border"
flies node --pack "$work/node.ffp" $quick
is 's["crack_frames"] == 0 and r[-1]["nodes_drawn"] == 1' "a terrain of one node"
flies tight --pack "$work/dense.ffp" $quick --memory 544K --fov 100 --quality px:0.1 --triangles 500000 --view 20000 --panorama off
is 's["crack_frames"] == 0 and 50 < r[-1]["nodes_drawn"] < r[-1]["nodes_held"] < 1500' "little memory: whole"
little=$(python3 -c "import json; print(json.load(open('$work/tight.json'))['err_px_rms'])")
flies roomy --pack "$work/dense.ffp" $quick --memory 8M --fov 100 --quality px:0.1 --triangles 500000 --view 20000 --panorama off
is "r[-1]['nodes_held'] > 1800 and s['err_px_rms'] < $little" "more memory: finer"
for fov in 0.1 170; do
    flies fov $quick --fov $fov --backend gl
    is 's["crack_frames"] == 0' "a field of view of $fov degrees"
done

# ---- a real server in real time, and one that vanishes ----
"$bin/farfield-server" --pack "$work/hills.ffp" --listen 127.0.0.1:0 >"$work/server.log" 2>&1 &
server_pid=$!
wait_for "$work/server.log" "listening on.*renderers"
port=$(sed -n 's/.*listening on [^ ]*:\([0-9]*\).*/\1/p' "$work/server.log")
timeout 60 "$fly" --pack "$work/dense.ffp" --server "127.0.0.1:$port" --backend none --seconds 0 --settle 3 2>"$work/err"
[ $? = 1 ] && grep -q "^farfield-fly: 127.0.0.1:$port: serves another terrain than --pack$" "$work/err"
result $? "a server with another terrain than the pack's is an error"
flies real --server "127.0.0.1:$port" --backend none --quality px:2 --back-plane 1500 --seconds 2 --settle 3 --audit on
result $? "a flight against a real server"
is 's["crack_frames"] == 0 and r[-1]["link_up"] == 1 and r[-1]["bytes_down"] > 2000 and r[-1]["nodes_drawn"] > 0' "it sees the ground"
( # gone as soon as there is something to fly on with
    for _ in $(seq 100); do
        [ -n "$(awk -F, 'NR > 1 && $6 > 0' "$work/gone.csv" 2>/dev/null)" ] && break
        sleep 0.05
    done
    kill "$server_pid"
) &
flies gone --server "127.0.0.1:$port" --backend none --quality px:2 --back-plane 1500 --seconds 4 --settle 4 --sample 0.2 --audit on
result $? "a server that goes away in flight"
is 's["crack_frames"] == 0 and r[-1]["link_up"] == 0 and r[-1]["nodes_drawn"] > 0' "the client flies on with what it has"
wait
server_pid=

# ---- errors ----
refused() { # WHAT ARGUMENTS...
    local what=$1 status
    shift
    timeout 60 "$fly" "$@" >"$work/out" 2>"$work/err"
    status=$?
    [ $status -ne 0 ] && [ $status -lt 124 ] && [ "$(grep -c -v '^farfield-fly: seed ' "$work/err")" = 1 ] && grep -q '^farfield-fly: ' "$work/err"
    result $? "one line and an error for $what"
}
head -c 5000 "$work/hills.ffp" >"$work/short.ffp"
head -c 20000 /dev/urandom >"$work/noise.ffp"
cp "$work/hills.ffp" "$work/flipped.ffp"
printf '\125' | dd of="$work/flipped.ffp" bs=1 seek=$(($(stat -c %s "$work/hills.ffp") / 2)) conv=notrunc 2>/dev/null
refused "no pack" --backend none
refused "a missing pack" --pack "$work/missing.ffp"
refused "a truncated pack" --pack "$work/short.ffp"
refused "a foreign file" --pack "$work/noise.ffp"
refused "a damaged pack" --pack "$work/flipped.ffp" --backend none
refused "an unknown back end" --pack "$work/hills.ffp" --backend vulkan
refused "an unknown link" --pack "$work/hills.ffp" --link telex
refused "an unknown quality" --pack "$work/hills.ffp" --quality superb
refused "an unknown event" --pack "$work/hills.ffp" --event 3:earthquake
refused "a link unknown in flight" --pack "$work/hills.ffp" --event 3:link=telex
refused "a teleport to nowhere" --pack "$work/hills.ffp" --event 3:teleport=0.5,2
printf 't_s,x_m,y_m\n1,2,3\n' >"$work/flat.csv"
printf 't_s,x_m,y_m,z_m\n1,2,3,4\n1,2,3,4\n' >"$work/again.path"
printf 't_s,x_m,y_m,z_m\n1,2,3\n' >"$work/narrow.path"
printf 't_s,x_m,y_m,z_m\n1,2,nan,4\n' >"$work/nan.path"
printf '3:earthquake\n' >"$work/quake"
refused "a path that is neither word nor file" --pack "$work/hills.ffp" --path spiral
refused "a recorded path without heights" --pack "$work/hills.ffp" --path "$work/flat.csv"
refused "a recorded path whose time stands" --pack "$work/hills.ffp" --path "$work/again.path"
refused "a recorded path with a short line" --pack "$work/hills.ffp" --path "$work/narrow.path"
refused "a recorded path that is no number" --pack "$work/hills.ffp" --path "$work/nan.path"
refused "a pack as a recorded path" --pack "$work/hills.ffp" --path "$work/hills.ffp"
refused "missing events" --pack "$work/hills.ffp" --events "$work/missing"
refused "an unknown event in a file" --pack "$work/hills.ffp" --events "$work/quake"
refused "an impossible size" --pack "$work/hills.ffp" --size 0x0
refused "faces too large" --pack "$work/hills.ffp" --face 2048
refused "a server that is not there" --pack "$work/hills.ffp" --server 127.0.0.1:9 --backend none --seconds 0 --settle 1
for other in node wide dense missing short; do
    refused "a truth that is not this ground's: $other" --pack "$work/hills.ffp" --audit on --truth "$work/$other.ffp"
done
refused "a truth that nobody asks" --pack "$work/hills.ffp" --truth "$work/hills.ffp"
refused "a missing trace" --pack "$work/hills.ffp" --down-trace "$work/missing"
refused "too little memory" --pack "$work/hills.ffp" --memory 1K --backend none
refused "memory too little for the terrain" --pack "$work/hills.ffp" --memory 256K --backend none --seconds 0 --settle 5
refused "a CSV that cannot be written" --pack "$work/hills.ffp" --csv "$work/missing/x.csv" --backend none
"$fly" --help | grep -q -- --pack && "$fly" --version | grep -q "^farfield-fly [0-9]"
result $? "--help and --version"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
