#!/bin/bash
# A view that ends near costs the same whatever the size of the ground that it is in: bytes and triangles of flights over the same places of
# grounds of 257 and of 1025 samples. All levels of the large one cost more.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/growth.$$ # left behind only after a failure
mkdir -p "$work"
. tests/rig/result.bash

# The small ground is the south-western corner of the large one.
python3 tests/rig/hills.py 1025:waves "$work/1025.raw"
python3 - "$work" <<'END'
import sys
rows = open(sys.argv[1] + "/1025.raw", "rb").read()
open(sys.argv[1] + "/257.raw", "wb").write(b"".join(rows[2050 * y:2050 * y + 514] for y in range(768, 1025)))
END
for n in 257 1025; do
    "$bin/farfield-bake" "$work/$n.raw" --raw "${n}x$n" --spacing 30 --hscale 0.25 --max-error 0.5 --quiet -o "$work/$n.ffp" || result 1 "bakes $n"
done

# Flights to the north-east from eight places, of two heights, the same over both grounds, whose diagonals are not alike.
python3 - "$work" <<'END'
import sys
for height in 100, 600:
    for place in 55, 70, 85, 100, 115, 130, 145, 160: # samples from west and south
        with open("%s/%d.%d.csv" % (sys.argv[1], height, place), "w") as out:
            out.write("t_s,x_m,y_m,h_m,heading_deg\n")
            for t in range(21):
                at = 30 * place + t * 150 / 3.6 / 2 ** 0.5
                out.write("%d,%.3f,%.3f,%d,45\n" % (t, at, at, height))
END
# A line: flights, bytes, triangles, requests that failed.
cost() { # SAMPLES OPTION...
    local n=$1 path
    shift
    for path in "$work"/*.csv; do
        "$bin/farfield-fly" --pack "$work/$n.ffp" --link gprs --path "$path" --settle 0 --panorama off --backend none --json "$@" 2>>"$work/fly.err"
    done | python3 -c '
import json, sys
rows = [json.loads(row) for row in sys.stdin.read().replace("}\n{", "}\0{").split("\0")]
print(len(rows), *(round(sum(r[name] for r in rows)) for name in ("bytes_down_all", "triangles", "requests_failed")))'
}
small=$(cost 257 --view 1500)
large=$(cost 1025 --view 1500)
all=$(cost 1025 --view 1500 --entry off)
echo "# flights, bytes, triangles, failed: $small on 257 samples, $large on 1025, $all with all levels"
python3 -c "
s, l, f = ([int(x) for x in row.split()] for row in ('$small', '$large', '$all'))
assert s[0] == l[0] == f[0] == 16 and s[3] == l[3] == f[3] == 0
assert abs(l[1] - s[1]) <= 0.05 * s[1], 'bytes'
assert abs(l[2] - s[2]) <= 0.05 * s[2], 'triangles'
assert f[1] > 1.3 * l[1], 'the top costs nothing here'"
result $? "sixteen times the ground costs a near view as much, within 5 %"
[ "$failures" = 0 ] && rm -r "$work"
exit $((failures > 0))
