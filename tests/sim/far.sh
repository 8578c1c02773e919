#!/bin/bash
# farfield-fly with far sets: what they cost and mend, as the judge sees it; the same twice and on every back end; a tape of such a
# flight, played by farfield-handheld.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/far.$$
mkdir -p "$work"
. tests/rig/result.bash
flies() { # NAME ARGUMENTS...
    flown=$1
    shift
    timeout 300 "$bin/farfield-fly" --pack "$work/hills.ffp" --link lan --panorama off --quality px:2 --far-front 2000 --far-coarse 8 --height 300 \
        --speed 600 --seconds 5 --settle 5 --csv "$work/$flown.csv" --json "$@" >"$work/$flown.json" 2>"$work/$flown.err"
}
is() { # EXPRESSION WHAT: over the summaries `s`, by flight
    python3 - "$work" "$1" <<'END'
import glob, json, os, sys
s = {os.path.basename(path)[:-5]: json.load(open(path)) for path in glob.glob(sys.argv[1] + "/*.json")}
sys.exit(0 if eval(sys.argv[2]) else 1)
END
    result $? "$2"
}

python3 tests/rig/hills.py 513 "$work/hills.raw" &&
    "$bin/farfield-bake" "$work/hills.raw" --raw 513x513 --spacing 40 --tile-log2 6 --quiet -o "$work/hills.ffp"
result $? "a pack to fly over"

flies coarse --far off --quality px:16 --audit on --backend none
result $? "coarse ground alone"
flies fins --far fins --audit on --backend none
result $? "fins on coarse far ground"
is 's["fins"]["far"] == "fins" and s["coarse"]["far"] == "off"' "the summary says which"
is 's["coarse"]["far_requests"] == s["coarse"]["far_bytes"] == s["coarse"]["bytes_far"] == 0' "without sets nothing is asked for"
is 's["fins"]["far_requests"] > 0 and s["fins"]["far_sectors"] > 0 and s["fins"]["requests_failed"] == 0' "sets are asked for while flying"
is '0 < s["fins"]["far_fins_bytes"] < s["fins"]["far_bytes"] == s["fins"]["bytes_far"]' "bytes of fins are counted, and those of their messages"
is 's["fins"]["skyline_px_rms"] < s["coarse"]["skyline_px_rms"] / 2' "fins mend the skyline"
is 's["fins"]["square_px_panorama"] == 0 and s["fins"]["undrawn_px_percent"] < 0.1 and s["fins"]["crack_frames"] == 0' \
    "the ground below is whole, and no panorama"

flies paint --far paint --backend soft565
result $? "fins and paint"
flies again --far paint --backend soft565
cmp -s "$work/paint.csv" "$work/again.csv"
result $? "the same twice"
flies shown --far paint --backend soft --diff on
flies outlined --far fins --backend soft --diff on
is 's["shown"]["diff_mean"] < 0.6 * s["outlined"]["diff_mean"] and s["shown"]["ssim"] > s["outlined"]["ssim"] + 0.02' \
    "paint is nearer to the truth than fins alone"
flies gl --far paint --backend gl --diff on
is 'abs(s["gl"]["ssim"] - s["shown"]["ssim"]) < 0.005' "as near on another back end"
is 's["paint"]["geometry_hash"] == s["gl"]["geometry_hash"] and s["paint"]["request_hash"] == s["gl"]["request_hash"]' \
    "the same requests and geometry on another back end"
is 's["paint"]["bytes_far"] > 2 * s["fins"]["bytes_far"] and s["paint"]["relevance_percent"] > 0' "paint weighs more than fins"
flies single --far paint --backend none --views off
is 's["paint"]["bytes_heights"] < 1.1 * s["single"]["bytes_heights"]' "a view at once brings far ground as coarsely as asked for"
flies half --far paint --far-shift 1 --backend none
is 's["half"]["bytes_far"] < 0.6 * s["paint"]["bytes_far"]' "texels twice as large cost less than half"

# a turn right round while the link is down
down="--event 9:link=lan,down.bytes_s=1,up.bytes_s=1 --event 9.5:turn=180 --speed 60 --settle 9 --seconds 4 --audit on --backend none"
flies unready --far paint --reserve off $down
flies ready --far paint $down
is '0 < s["ready"]["skyline_px_rms"] < s["unready"]["skyline_px_rms"] / 2' "a turn while the link is down shows its ridges"
is 'all((s[name]["relevance_percent"] == s[name]["relevance_no_reserve_percent"]) == (name == "unready") for name in ("ready", "unready"))' \
    "without the reserve it is not asked for"

flies high --far paint --backend none --height 6000
is 's["high"]["far_sectors"] > 0' "pictures from high above are tall, and taken in"

# far auto: the same ground, with few triangles, with many, on a link that carries next to nothing, by the client alone; and a plain
decides() { # NAME PACK ARGUMENTS...
    flown=$1
    pack=$2
    shift 2
    timeout 300 "$bin/farfield-fly" --pack "$work/$pack.ffp" --link lan --far auto --panorama off --far-front 2000 --height 300 --speed 600 \
        --seconds 20 --backend none --triangles 3000 --json "$@" >"$work/$flown.json" 2>"$work/$flown.err"
}
decides few hills
is 's["few"]["far"] == "auto" and s["few"]["far_use"] == 2 and s["few"]["far_sectors"] > 0 and s["few"]["far_turns"] == 0' \
    "far auto takes paint where triangles are short, and keeps to it"
decides many hills --quality px:1 --triangles 200000 --seconds 10
decides without hills --quality px:1 --triangles 200000 --seconds 10 --far off
is 's["many"]["far_turns"] == 0 and s["many"]["request_hash"] == s["without"]["request_hash"]' "where they are not, all is as without"
decides thin hills --speed 3000 --link gprs,down.bytes_s=1200
is '0 < s["thin"]["far_bytes"] < s["few"]["far_bytes"] / 2 and s["thin"]["far_use"] < 1.5' "less on a thin link"
decides alone hills --balance client
is 's["alone"]["far_requests"] == 0' "nothing by the client alone"
timeout 300 "$bin/farfield-fly" --pack "$work/hills.ffp" --link lan --balance server --height 300 --speed 600 --seconds 2 --settle 5 --backend none --json \
    >"$work/served.json" 2>"$work/served.err"
is 's["served"]["far"] == "off" and s["served"]["panorama_bytes"] > 0 and s["served"]["far_requests"] == 0' "panoramas alone by the server alone"
python3 - "$work/plain.raw" <<'END' && "$bin/farfield-bake" "$work/plain.raw" --raw 513x513 --spacing 40 --tile-log2 6 --quiet -o "$work/plain.ffp"
import array, sys
array.array("H", [(i // 513 * 3 + i % 513 * 2) // 50 + 100 for i in range(513 * 513)]).tofile(open(sys.argv[1], "wb"))
END
python3 - "$work/hills.raw" "$work/half.raw" <<'END' && "$bin/farfield-bake" "$work/half.raw" --raw 513x513 --spacing 40 --tile-log2 6 --quiet -o "$work/half.ffp"
import array, sys
heights = array.array("H", open(sys.argv[1], "rb").read())
for i in range(256 * 513, 513 * 513):
    heights[i] = 20000
heights.tofile(open(sys.argv[2], "wb"))
END
decides turning half --path hover --start 0.6 --height 100 --settle 20 --seconds 70
is 's["turning"]["far_use"] == 2 and s["turning"]["far_turns"] == 0' "who turns between hills and a plain keeps them"
decides plain plain
is 's["plain"]["far_requests"] == 0 and s["plain"]["triangles"] > 0' "nothing over a plain"

flies taped --far paint --backend soft565 --tape "$work/tape"
"$bin/farfield-handheld" --tape "$work/tape" --json >"$work/played.json" 2>"$work/played.err"
result $? "a tape plays the same flight"
is 's["played"]["far_sectors"] > 0 and s["played"]["far_sets"] >= s["taped"]["far_sets"]' "with its sets"

for wrong in "far on" "far-front 0" "far-front 1.2.3" "far-front 9000000" "far-coarse 17" "far-shift 4" "far-quality 0" "far-quality 101"; do
    set -- $wrong
    "$bin/farfield-fly" --pack "$work/hills.ffp" "--$1" "$2" >/dev/null 2>"$work/err"
    [ $? = 2 ] && [ "$(wc -l <"$work/err")" = 1 ]
    result $? "--$wrong is refused in one line"
done
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
