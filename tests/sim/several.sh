#!/bin/bash
# farfield-fly over several grounds at once: a country and fine ground inset, grounds side by side, a part on the device; from packs on one
# server, packs on the device and a real server; judged by the truths of all; and packs that do not go together.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/several.$$ # left behind only after a failure
mkdir -p "$work"
server_pid=
trap '[ -n "$server_pid" ] && kill "$server_pid" 2>/dev/null' EXIT
. tests/rig/result.bash
is() { # EXPRESSION WHAT: over the summaries of all flights so far, by name
    python3 - "$work" "$1" <<'END'
import glob, json, os, sys
f = {os.path.basename(path)[:-5]: json.load(open(path)) for path in glob.glob(sys.argv[1] + "/*.json") if os.path.getsize(path)}
sys.exit(0 if eval(sys.argv[2], {"any": any, "all": all, "abs": abs, "sum": sum}, {k: type("flight", (), v) for k, v in f.items()}) else 1)
END
    result $? "$2"
}
flies() { # NAME ARGUMENTS...
    local name=$1
    shift
    timeout 300 "$bin/farfield-fly" --backend none --panorama off --quality px:2 --audit on --csv "$work/$name.csv" --json "$@" \
        >"$work/$name.json" 2>"$work/$name.err" && [ "$(grep -c -v '^farfield-fly: seed ' "$work/$name.err")" = 0 ] && return 0
    sed 's/^/# /' "$work/$name.err"
    result 1 "$name flies"
}
pack() { # NAME PART STEP OPTION...: a part of the ground as a pack
    local name=$1 part=$2 step=$3
    shift 3
    python3 tests/rig/placed.py "$work/ground.raw" 513 "$part" "$step" 10 "${EPSG:-32632}" "$work/$name.vrt" &&
        "$bin/farfield-bake" "$work/$name.vrt" --quiet "$@" -o "$work/$name.ffp" || result 1 "pack $name"
}

# 5.1 km of ground, whose samples are 10 m apart; x and y of flights are metres from the country's south-west corner.
python3 tests/rig/hills.py 513:fractal "$work/ground.raw"
pack country 0,0,129,129 4
pack inset 160,160,193,193 1
pack west 0,0,257,513 1
pack east 256,0,65,129 4
pack over 240,0,69,129 4
pack lossy 0,0,129,129 4 --max-error 8
pack nodes 160,160,193,193 1 --node-log2 4
EPSG=32633 pack system 160,160,193,193 1
"$bin/farfield-bake" "$work/ground.raw" --raw 513x513 --spacing 10 --quiet -o "$work/nowhere.ffp"
"$bin/farfield-export" "$work/country.ffp" --region 9.015,45.115,9.05,45.15 --quiet -o "$work/region.ffp" && [ -s "$work/region.ffp" ]
result $? "grounds beside each other and a part of one"

# From the west to the east and back, over the borders; then on the spot.
printf 't_s,x_m,y_m,h_m,heading_deg,pitch_deg\n0,300,2400,150,90,-10\n4,300,2400,150,90,-10\n24,4800,2400,150,90,-10\n25,4800,2600,150,270,-10\n' >"$work/there.path"
printf '45,300,2600,150,270,-10\n' >>"$work/there.path"
there="--path $work/there.path --settle 3 --fps 10"

# ---- inset ----
inset="--pack $work/country.ffp --pack $work/inset.ffp"
flies alone $there --link lan --pack "$work/country.ffp"
flies inset $there --link lan $inset
is 'inset.ground_px_percent[0] > 20 and inset.ground_px_percent[1] > 20 and abs(sum(inset.ground_px_percent) - 100) < 0.01' \
    "both of two grounds are seen"
is 'inset.undrawn_px_percent == 0 and inset.crack_frames == inset.requests_failed == inset.empty_frames == 0' "and leave no gap, crack or question open"
is 'inset.seam_px_max >= inset.seam_px_p95 > 0 and alone.seam_px_p95 is None and alone.seam_px_max is None' \
    "errors at the border are told apart, where there is one"
is 'alone.ground_px_percent == [100] and inset.packs[1].endswith("inset.ffp") and inset.local == []' "and the summary says what was flown over"
is 'inset.err_px_p95 < 0.3 and inset.seam_px_p95 < 0.6' "vertices are judged where the seam lowers them"
python3 - "$work" <<'END'
import csv, sys
work = sys.argv[1]
rows = lambda name: list(csv.DictReader(open(f"{work}/{name}.csv")))
both = [(float(a["z_m"]), float(b["z_m"])) for a, b in zip(rows("alone"), rows("inset")) if 1600 < float(a["x_m"]) < 3500]
sys.exit(0 if len(both) > 10 and sum(a != b for a, b in both) > len(both) / 2 else 1)
END
result $? "the path keeps above the finer ground, where there is some"
flies again $there --link lan $inset
cmp -s "$work/inset.csv" "$work/again.csv"
result $? "the same again, byte for byte"
for hidden in drawn fetched; do
    flies inset_$hidden $there --link umts $inset --hidden $hidden
    is "inset_$hidden.crack_frames == 0 and inset_$hidden.undrawn_px_percent < 0.5" "ground behind nearer ground is $hidden"
done
flies thin $there --link gprs $inset
is 'thin.crack_frames == thin.requests_failed == 0 and thin.bytes_heights > 0.5 * thin.bytes_down' "over a thin link, too"
flies views_off $there --link lan $inset --views off
is 'views_off.undrawn_px_percent == 0 and views_off.requests_failed == 0' "and asked for level by level"

# ---- side by side, in either order ----
flies beside $there --link lan --pack "$work/west.ffp" --pack "$work/east.ffp"
is 'beside.ground_px_percent[0] > 20 and beside.ground_px_percent[1] > 20' "two grounds side by side are seen"
is 'beside.undrawn_px_percent == 0 and beside.crack_frames == beside.requests_failed == 0' "and leave no gap"
awk -F, 'BEGIN { OFS = "," } NR > 1 { $2 -= 2560 } { print }' "$work/there.path" >"$work/from-east.path"
flies turned --path "$work/from-east.path" --settle 3 --fps 10 --link lan --pack "$work/east.ffp" --pack "$work/west.ffp"
is 'abs(turned.ground_px_percent[0] - beside.ground_px_percent[1]) < 3 and turned.undrawn_px_percent == 0' "the other one may come first"

flies over $there --link lan --pack "$work/west.ffp" --pack "$work/over.ffp"
is 'over.undrawn_px_percent == 0 and over.crack_frames == over.requests_failed == 0 and over.ground_px_percent[1] > 20' \
    "nor do two that overlap by 160 m"

# ---- on the device ----
flies local $there --link lan --pack "$work/country.ffp" --local "$work/inset.ffp"
is 'local.undrawn_px_percent == 0 and local.ground_px_percent[1] > 20 and local.requests_failed == 0' "a pack on the device is shown with the server's"
is 'local.bytes_down_all < 0.75 * inset.bytes_down_all and local.bytes_down_all < 1.3 * alone.bytes_down_all' "and comes over no link"
hover="--path hover --start 0.4 --link gprs --quality px:1 --settle 30 --seconds 60 --fps 10 --backend soft --every 90"
flies far $hover --pack "$work/country.ffp" --png "$work/far"
flies near $hover --pack "$work/country.ffp" --local "$work/region.ffp" --png "$work/near"
cmp -s "$work/far/frame-0090.00.png" "$work/near/frame-0090.00.png"
result $? "a part of the server's ground on the device: the same picture, once all has come"
held=$(stat -c %s "$work/region.ffp")
is "0.4 * $held < far.bytes_down_all - near.bytes_down_all < 1.1 * $held and near.requests_failed == near.empty_frames == 0 and near.ground_px_percent == [100]" \
    "and what the part holds has not come over the link"

# ---- truths ----
flies itself $there --link lan --pack "$work/lossy.ffp" --pack "$work/inset.ffp"
flies source $there --link lan --pack "$work/lossy.ffp" --pack "$work/inset.ffp" --truth "$work/country.ffp"
is 'source.truth.endswith("country.ffp") and source.truth_error_m == 0 and itself.truth_error_m == 8 and source.request_hash == itself.request_hash' \
    "the first truth is the first pack's"
is 'source.err_px_p95 > 1.1 * itself.err_px_p95' "and judges it"
for flight in written kept; do
    flies $flight $there --link lan $inset --ground-cache "$work/ground"
    cmp -s "$work/inset.csv" "$work/$flight.csv" && [ -s "$work/ground" ] && [ -s "$work/ground.2" ]
    result $? "decoded grounds are $flight, a file each"
done
timeout 120 "$bin/farfield-fly" $inset --link lan --panorama off --backend soft --seconds 0 --settle 4 --diff on --csv "$work/diff.csv" 2>/dev/null &&
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "ssim") at = i } END { exit !($at > 0.9) }' "$work/diff.csv"
result $? "the picture as it should be has both grounds"

refused() { # PATTERN WHAT ARGUMENTS...: one line, and no flight
    local pattern=$1 what=$2 status
    shift 2
    timeout 60 "$bin/farfield-fly" --backend none --seconds 0 --settle 1 "$@" >"$work/out" 2>"$work/err"
    status=$?
    [ $status -ne 0 ] && [ $status -lt 124 ] && [ "$(grep -c -v '^farfield-fly: seed ' "$work/err")" = 1 ] && grep -q "^farfield-fly: .*$pattern" "$work/err"
    result $? "one line for $what" || sed 's/^/# /' "$work/err"
}

# ---- a far set over grounds beside each other ----
pack half 256,0,257,513 1
pack whole 0,0,513,513 1
printf 't_s,x_m,y_m,h_m,heading_deg,pitch_deg\n0,500,2400,300,90,-5\n8,620,2400,300,90,-5\n' >"$work/east.path"
sets="--path $work/east.path --settle 3 --fps 10 --link lan --far paint --far-front 1200 --far-coarse 8"
flies sets_whole $sets --pack "$work/whole.ffp"
flies sets_half $sets --pack "$work/west.ffp"
flies sets_halves $sets --pack "$work/west.ffp" --pack "$work/half.ffp"
flies no_sets $sets --far off --quality px:16 --pack "$work/west.ffp" --pack "$work/half.ffp"
is 'sets_halves.far_sectors == sets_whole.far_sectors > 0 and sets_halves.far_fins_bytes == sets_whole.far_fins_bytes > sets_half.far_fins_bytes' \
    "the outlines of two grounds are those of the whole"
is 'abs(sets_halves.far_bytes / sets_whole.far_bytes - 1) < 0.01 and sets_halves.requests_failed == 0' "and so are their colours"
is 'sets_halves.skyline_px_rms < no_sets.skyline_px_rms / 2' "and they mend the skyline"

# ---- a real server ----
"$bin/farfield-server" $inset --listen 127.0.0.1:0 >"$work/server.log" 2>&1 &
server_pid=$!
wait_for "$work/server.log" "listening on.*renderers"
port=$(sed -n 's/.*listening on [^ ]*:\([0-9]*\).*/\1/p' "$work/server.log")
flies real $inset --server "127.0.0.1:$port" --local "$work/region.ffp" --start 0.4 --speed 400 --seconds 4 --settle 3
is 'real.undrawn_px_percent == 0 and real.crack_frames == 0 and real.ground_px_percent[1] > 10 and real.bytes_down_all > 1000' \
    "a server of both grounds, and a part on the device"
flies real_sets $inset --server "127.0.0.1:$port" --far fins --far-front 1000 --speed 400 --seconds 2 --settle 2
is 'real_sets.far_sectors > 0 and real_sets.requests_failed == 0' "and its far sets"
timeout 60 "$bin/farfield-fly" --pack "$work/country.ffp" --server "127.0.0.1:$port" --backend none --seconds 0 --settle 3 2>"$work/err"
[ $? = 1 ] && grep -q "^farfield-fly: 127.0.0.1:$port: serves more packs than --pack$" "$work/err"
result $? "a server of more packs than were named is an error"
timeout 60 "$bin/farfield-fly" --pack "$work/country.ffp" --pack "$work/east.ffp" --server "127.0.0.1:$port" --backend none --seconds 0 --settle 3 2>"$work/err"
[ $? = 1 ] && grep -q "^farfield-fly: 127.0.0.1:$port: serves another terrain than --pack$" "$work/err"
result $? "as is one whose second pack is another"
kill "$server_pid"
wait "$server_pid" 2>/dev/null
server_pid=
refused "127.0.0.1:$port: no terrain came from there" "a server that is not there, although a part of its ground is" $inset \
    --server "127.0.0.1:$port" --local "$work/region.ffp"

# ---- what does not go together ----
for how in --pack --local; do
    refused "system.ffp: .*--t-srs" "$how of another system" --pack "$work/country.ffp" $how "$work/system.ffp"
    refused "nowhere.ffp: .*--t-srs" "$how that lies nowhere" --pack "$work/country.ffp" $how "$work/nowhere.ffp"
    refused "nodes.ffp: .*--node-log2" "$how of other nodes" --pack "$work/country.ffp" $how "$work/nodes.ffp"
    refused "missing.ffp: " "$how that is not there" --pack "$work/country.ffp" $how "$work/missing.ffp"
done
refused "country.ffp: .*farfield-merge" "the same pack twice" --pack "$work/country.ffp" --pack "$work/country.ffp"
refused "region.ffp: .*farfield-merge" "a pack and a part of it from one server" --pack "$work/country.ffp" --pack "$work/region.ffp"
refused "no truth for .*inset.ffp" "a truth that is another pack's" $inset --audit on --truth "$work/country.ffp" --truth "$work/country.ffp"
refused "one for each --pack" "a truth too many" --pack "$work/country.ffp" --audit on --truth "$work/country.ffp" --truth "$work/inset.ffp"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
