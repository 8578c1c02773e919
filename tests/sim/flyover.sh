#!/bin/bash
# tools/scripts/flyover.sh over a small pack: resumable, the same table every time; farfield-report --paper: ratios and stable times computed
# right; the kept true ground changes nothing.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/flyover.$$
rm -rf "$work"
mkdir -p "$work"
. tests/rig/result.bash
fly_over() { # OUT [VARIABLE=VALUE...]
    local out=$1
    shift
    env QUICK=1 SECONDS_EACH=2 FLYOVER_PACK="$work/hills.ffp" JOBS=2 "$@" tools/scripts/flyover.sh "$bin" "$out" >"$work/said" 2>"$work/error"
}

python3 tests/rig/hills.py 129 "$work/hills.raw"
"$bin/farfield-bake" "$work/hills.raw" --raw 129x129 --spacing 80 --tile-log2 5 --quiet -o "$work/hills.ffp"
result $? "a pack to fly over"

# ---- the matrix ----
fly_over "$work/first"
result $? "a quick fly-over"
[ "$(grep -c ' finished)$' "$work/said")" = 8 ] && [ "$(ls "$work"/first/quick/*.csv | wc -l)" = 8 ]; result $? "flies all its flights"
[ -s "$work/first/quick/report/index.html" ] && grep -q '^| umts | 150 | low | on | 5139 | ' "$work/first/quick/report/REPORT.md"
result $? "and reports them beside the paper's"
cp "$work/first/quick/report/REPORT.md" "$work/first.md"
fly_over "$work/first"
[ "$(grep -c ': flown before$' "$work/said")" = 8 ] && cmp -s "$work/first.md" "$work/first/quick/report/REPORT.md"
result $? "finished flights are not flown again"
rm "$work/first/quick/gprs-150-low-on.csv"
fly_over "$work/first"
[ "$(grep -c ': flown before$' "$work/said")" = 7 ] && cmp -s "$work/first.md" "$work/first/quick/report/REPORT.md"
result $? "a missing one is"
fly_over "$work/second"
cmp -s "$work/first.md" "$work/second/quick/report/REPORT.md"; result $? "the same seed gives the same table, byte for byte"
fly_over "$work/first" SECONDS_EACH=3
[ "$(grep -c ' finished)$' "$work/said")" = 8 ] && ! cmp -s "$work/first.md" "$work/first/quick/report/REPORT.md"
result $? "other options: all are flown again"
head -c 5000 "$work/hills.ffp" >"$work/short.ffp"
! fly_over "$work/third" FLYOVER_PACK="$work/short.ffp" && [ "$(grep -c . "$work/error")" = 1 ] && grep -q '^farfield-fly: ' "$work/error"
result $? "a damaged pack is one line and an error"

# ---- the true ground kept on disk ----
flies() { # CSV OPTION...
    local csv=$1
    shift
    "$bin/farfield-fly" --pack "$work/hills.ffp" --backend none --audit on --settle 2 --seconds 2 --csv "$csv" "$@" 2>"$work/error"
}
head -c 5000 /dev/urandom >"$work/ground"
flies "$work/plain.csv" && flies "$work/written.csv" --ground-cache "$work/ground" && cp "$work/ground" "$work/kept" &&
    flies "$work/mapped.csv" --ground-cache "$work/ground"
result $? "flights without and with the ground kept on disk"
cmp -s "$work/plain.csv" "$work/written.csv" && cmp -s "$work/plain.csv" "$work/mapped.csv" && cmp -s "$work/ground" "$work/kept"
result $? "are the same; what was no ground was replaced"

# ---- the paper's numbers beside ours ----
cat >"$work/paper.csv" <<'END'
# A. Author
link,speed_kmh,quality,panorama,fps,triangles,kilobytes,stable_from_s,stable_to_s
umts,25,low,on,53.08,2000,158,10,15
gprs,1000,high,on,,,,,
gprs,25,low,on,1,1,1,1,1
END
flight() { # ERRORS FROM SECOND: 10 px before, 1 px from then on; 1000 triangles, 2000 before second 15; 5000 bytes a second
    echo "t_s,triangles,nodes_drawn,nodes_held,bytes_down,bytes_up,requests,panoramas,err_px_rms,err_px_p95,err_px_max,undrawn_px_percent"
    for t in $(seq 0 20); do
        echo "$t,$((t < 15 ? 2000 : 1000)),10,20,$((t * 5000)),0,1,0,1,$((t < $1 ? 10 : 1)),20,0"
    done
}
mkdir "$work/flights"
flight 9 >"$work/flights/umts-25-low-on.csv"
flight 30 >"$work/flights/gprs-1000-high-on.csv"
flight 1 >"$work/flights/lan-25-low-on.csv"
flight 1 >"$work/flights/lan-1000-high-on.csv"
flight 4 >"$work/flights/sweep-px-1.csv"
flight 4 >"$work/flights/sweep-px-2.csv"
"$bin/farfield-report" --paper "$work/paper.csv" "$work"/flights/*.csv -o "$work/paper" >"$work/said" 2>"$work/error"
result $? "a report beside a paper"
table=$work/paper/REPORT.md
grep -q -F '| umts | 25 | low | on | 2000 | 1000 | 0.50 | 158 | 100.0 | 0.63 | 10–15 | 9 | 1.00 | 0.0 |' "$table"
result $? "ratios, means in flight, and the time until it is as good as over a LAN"
grep -q -F '| gprs | 1000 | high | on | – | 1000 | – | – | 100.0 | – | – | – | 10.00 | 0.0 |' "$table"
result $? "what the paper does not tell, and a picture never stable"
! grep -q '^| gprs | 25 ' "$table"; result $? "no row for a flight not flown"
grep -q -F '| px-2 | 1000 | 100.0 | 1.00 | 0.0 |' "$table"; result $? "a row of the sweep"
# 2 of convergence, 2 of error against work, 4 for each flight
[ "$(grep -c '<svg' "$work/paper/index.html")" = $((2 + 2 + 4 * 6)) ]; result $? "all plots"
sed 's/^umts,25/umts,x,25/' "$work/paper.csv" >"$work/bad.csv"
"$bin/farfield-report" --paper "$work/bad.csv" "$work"/flights/*.csv -o "$work/bad" >"$work/said" 2>"$work/error"
[ $? = 1 ] && [ "$(cat "$work/error")" = "farfield-report: $work/bad.csv:3: not a paper's table of flights" ] && [ ! -e "$work/bad" ]
result $? "refuses a table with a bad row"
"$bin/farfield-report" --paper tools/report/hybrid_table3.csv "$work"/flights/*.csv -o "$work/own" >/dev/null 2>"$work/error"
result $? "reads the paper's own table"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
