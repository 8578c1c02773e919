#!/bin/bash
# The balance in flight: triangles follow a frame budget that is halved, bytes follow a link that gets worse and better again, the two
# ends, hovering. No crack, no empty frame, one set of panoramas out at most, the same twice.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/balance.$$
mkdir -p "$work"
. tests/rig/result.bash
is() { # EXPRESSION WHAT: python over the rows `r` and the summary `s` of the flight last flown, or of another: rows(NAME), summary(NAME)
    python3 - "$work" "$flown" "$1" <<'END'
import csv, json, sys
work, flown, expression = sys.argv[1:]
rows = lambda n: [{k: v if k.endswith("_hash") else float(v) for k, v in row.items()} for row in csv.DictReader(open(f"{work}/{n}.csv"))]
summary = lambda n: json.load(open(f"{work}/{n}.json"))
r, s = rows(flown), summary(flown)
span = lambda a, b: [row for row in r if a < row["t_s"] <= b]
mean = lambda a, b, name: sum(row[name] for row in span(a, b)) / len(span(a, b))
gain = lambda a, b, name: span(a, b)[-1][name] - span(a, b)[0][name]
sys.exit(0 if eval(expression) else 1)
END
    result $? "$2"
}
flies() { # NAME ARGUMENTS...
    flown=$1
    shift
    timeout 300 "$bin/farfield-fly" --pack "$work/hills.ffp" --csv "$work/$flown.csv" --json $usual "$@" >"$work/$flown.json" 2>"$work/$flown.err"
    result $? "flight: $flown $*"
    is 's["crack_frames"] == 0 and s["empty_frames"] == 0 and s["panoramas_in_flight_high"] <= 1' "no crack, no empty frame, no queue of panoramas"
}
usual="--settle 10 --panorama on --quality 6:8 --back-plane 2000 --view 10000 --face 64 --fps 10 --start 0.2 --backend none --check on"

python3 tests/rig/hills.py 513 "$work/hills.raw"
"$bin/farfield-bake" "$work/hills.raw" --raw 513x513 --spacing 30 --tile-log2 7 --quiet -o "$work/hills.ffp"
result $? "ground to fly over"

# ---- the frame's budget ----
flies frame --link umts --seconds 230 --balance 4000 --event 120:budget=2000
is 'mean(60, 120, "triangles") <= 4000 and sum(row["triangles"] <= 4400 for row in span(60, 120)) >= 54' "triangles within the budget"
is 'mean(60, 120, "triangles") >= 2000' "which is made use of"
is 'mean(150, 240, "triangles") <= 2000 and mean(150, 240, "triangles") >= 1000' "the budget halved: half a minute later they have followed"
is 'gain(60, 120, "balance_turns") <= 4 and gain(150, 240, "balance_turns") <= 6' "without going to and fro"
cp "$work/frame.csv" "$work/frame1.csv"
flies frame --link umts --seconds 230 --balance 4000 --event 120:budget=2000
cmp -s "$work/frame.csv" "$work/frame1.csv"; result $? "the same again, byte for byte"

# ---- the link ----
flies link --speed 600 --start 0.1 --link umts --seconds 250 --balance 4000,3000 --event 90:link=gprs,down.bytes_s=700 --event 170:link=umts
is 'gain(60, 90, "bytes_down") / 29 <= 3000 * 1.1' "bytes within their budget on the good link"
is 'mean(120, 170, "fidelity_percent") < mean(60, 90, "fidelity_percent")' "fidelity gives way on the bad one"
is 'mean(130, 170, "queued") < 40' "so that little waits"
is 'mean(220, 260, "fidelity_percent") > mean(130, 170, "fidelity_percent")' "and comes back"
is 's["balance_turns"] <= 16' "without going to and fro"

# ---- the ends ----
flies server --link umts --seconds 40 --balance server --audit on
flies middle --link umts --seconds 40 --audit on
flies client --link umts --seconds 40 --balance client --audit on
is 'summary("server")["triangles"] < summary("middle")["triangles"] < s["triangles"]' "triangles: all server < as set < all client"
is 'summary("server")["panorama_px_percent"] > summary("middle")["panorama_px_percent"] > 0 == s["panoramas"]' "panoramas the other way round"
is 's["err_px_p95"] < summary("server")["err_px_p95"] and all(row["back_plane_m"] == 500 for row in rows("server")[1:])' "errors and back planes as these ends have them"
flies plenty --link lan --seconds 60 --balance 0
is 'r[-1]["share_percent"] == 100 and r[-1]["back_plane_m"] == 0 and gain(60, 70, "panoramas") == 0' "with a LAN and no budget for frames the client does it all"
flies hover --link gprs --seconds 110 --path hover --balance 3000
is 'mean(60, 120, "triangles") <= 3000 and gain(60, 120, "balance_turns") <= 2' "hovering and turning round over GPRS"

# ---- mistakes ----
for wrong in x 5000,x -1 5000,2,3; do
    "$bin/farfield-fly" --pack "$work/hills.ffp" --balance "$wrong" >/dev/null 2>"$work/error"
    [ $? = 2 ] && [ "$(grep -c '^farfield-fly: ' "$work/error")" = 1 ]; result $? "--balance $wrong is refused"
done
! "$bin/farfield-fly" --pack "$work/hills.ffp" --balance 1000 --tape "$work/tape" >/dev/null 2>&1; result $? "no tape of a balanced flight"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
