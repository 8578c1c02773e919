#!/bin/bash
# The balance in flight: triangles keep a frame budget that is halved and use it, 100 m and 12 km up; bytes follow a link that gets worse
# and better again; the two ends, hovering. No crack, no empty frame, one set of panoramas out at most, the same twice.
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
    case " $* " in *" --pack "*) ;; *) set -- --pack "$work/hills.ffp" "$@" ;; esac
    timeout 300 "$bin/farfield-fly" --csv "$work/$flown.csv" --json $usual "$@" >"$work/$flown.json" 2>"$work/$flown.err"
    result $? "flight: $flown $*"
    is 's["crack_frames"] == 0 and s["empty_frames"] == 0 and s["panoramas_in_flight_high"] <= 1' "no crack, no empty frame, no queue of panoramas"
}
usual="--settle 10 --panorama on --quality px:1 --back-plane 2000 --view 10000 --face 64 --fps 10 --start 0.2 --backend none --check on"

python3 tests/rig/hills.py 513 "$work/hills.raw" 1025:fractal "$work/wide.raw"
"$bin/farfield-bake" "$work/hills.raw" --raw 513x513 --spacing 30 --tile-log2 7 --quiet -o "$work/hills.ffp" &&
    "$bin/farfield-bake" "$work/wide.raw" --raw 1025x1025 --spacing 90 --quiet -o "$work/wide.ffp"
result $? "ground to fly over"

# ---- the frame's budget ----
flies frame --link umts --seconds 110 --panorama off --balance 3000 --event 60:budget=1500
is 'all(row["triangles"] <= 3000 for row in span(0, 60)) and all(row["triangles"] <= 1500 for row in span(60.5, 120))' "no picture has more triangles than the budget, not the first ones after it was halved"
is 'mean(20, 60, "triangles") >= 3000 * 0.85 and mean(60, 120, "triangles") >= 1500 * 0.8' "which is made use of"
is 's["balance_moves"] == 0 and s["fidelity_percent"] == 100' "without a controller"
cp "$work/frame.csv" "$work/frame1.csv"
flies frame --link umts --seconds 110 --panorama off --balance 3000 --event 60:budget=1500
cmp -s "$work/frame.csv" "$work/frame1.csv"; result $? "the same again, byte for byte"
for budget in 2500 10000; do
    flies "high$budget" --pack "$work/wide.ffp" --view 200000 --link gprs --speed 900 --height 12000 --seconds 60 --panorama off --balance "$budget"
    is "all(row['triangles'] <= $budget for row in r) and mean(20, 70, 'triangles') >= $budget * 0.85" "12 km up at 900 km/h over GPRS: at most $budget triangles, and 85 % of them"
done

# ---- the link ----
flies link --speed 600 --start 0.1 --link umts --seconds 250 --balance 4000,3000 --event 90:link=gprs,down.bytes_s=700 --event 170:link=umts
is 'all(row["triangles"] <= 4000 for row in r)' "triangles within their budget all the time"
is 'gain(60, 90, "bytes_down") / 29 <= 3000 * 1.1' "bytes within theirs on the good link"
is 'mean(120, 170, "fidelity_percent") < mean(60, 90, "fidelity_percent")' "fidelity gives way on the bad one"
is 'mean(130, 170, "queued") < 40' "so that little waits"
is 'mean(220, 260, "fidelity_percent") > mean(130, 170, "fidelity_percent")' "and comes back"
is 's["balance_turns"] <= 8' "without going to and fro"
flies detail --speed 600 --start 0.1 --link umts --seconds 250 --panorama off --triangles 38400 --balance 0,600
is 'gain(40, 100, "bytes_down") / 59 <= 600 * 1.1 and mean(40, 100, "error_px") > 1.5' "without panoramas detail gives way"
# at the corners of the ground nothing is left to ask for, and then much at once
is 'all(gain(a, a + 40, "bytes_down") / 39 <= 600 * 1.1 for a in range(40, 220))' "in any 40 s, after idle ones too, it is not passed"

# ---- the ends ----
flies server --link umts --seconds 40 --balance server --audit on
flies middle --link umts --seconds 40 --audit on
flies client --link umts --seconds 40 --balance client --audit on
is 'summary("server")["triangles"] < summary("middle")["triangles"] < s["triangles"]' "triangles: all server < as set < all client"
is 'summary("server")["panorama_px_percent"] > summary("middle")["panorama_px_percent"] > 0 == s["panoramas"]' "panoramas the other way round"
is 's["err_px_p95"] < summary("server")["err_px_p95"] and all(row["back_plane_m"] == 500 for row in rows("server")[1:])' "errors and back planes as these ends have them"
flies plenty --link lan --seconds 60 --balance 0
is 'r[-1]["share_percent"] == 100 and s["balance_moves"] == 0 and r[-1]["back_plane_m"] == 2000' "with a LAN and no budget for frames all is as set"
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
