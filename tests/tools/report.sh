#!/bin/bash
# farfield-report: the page and the table from CSV files, and one clear error for each kind of bad CSV.
set -u
cd "$(dirname "$0")/../.." || exit 2
report=${BIN:-build/bin}/farfield-report
work=build/tests/report
. tests/rig/result.bash
rm -rf "$work"
mkdir -p "$work/fly"

header="t_s, x_m, y_m, z_m, triangles, nodes_drawn, nodes_held, bytes_down, bytes_up, requests, in_flight, panoramas, err_px_rms, err_px_p95, err_px_max, frame_hash, extra"
flight() { # ERROR_AT_START
    echo "$header"
    awk -v error="$1" 'BEGIN {
        for (t = 0; t <= 90; t++)
            printf "%d, %d, 0, 500, %d, %d, %d, %d, %d, %d, 4, %d, %s, %s, %s, %08x, word\n", t, t * 41, 100 + 40 * t, 5 + t,
                20 + 2 * t, 1000 * t, 50 * t, 3 * t, t / 30, error == "" ? "" : error / (t + 1), error == "" ? "" : 2 * error / (t + 1),
                error == "" ? "" : 5 * error / (t + 1), t
    }'
}
flight 60 >"$work/umts <&> on.csv"
flight "" >"$work/blind.csv"
printf 'not really a picture' >"$work/fly/one & two.png"

"$report" "$work/umts <&> on.csv" "$work/blind.csv" -o "$work/deep/out" --settle 0 --title 'Ground & "far" <ground>' \
    --picture "$work/fly/one & two.png" >"$work/said" 2>"$work/error"
result $? "makes a report"
page=$work/deep/out/index.html
table=$work/deep/out/REPORT.md
[ "$(cat "$work/said")" = "$page
$table" ]; result $? "names the files it made"
[ "$(grep -c '<svg' "$page")" = 12 ]; result $? "twelve plots: five for a flight, four without auditor, three for all"
! grep -q -E '(src|href)="?https?:|url\(http' "$page"; result $? "nothing comes from a network"
grep -q '<h1>Ground &amp; &quot;far&quot; &lt;ground&gt;</h1>' "$page"; result $? "the title is escaped"
grep -q '<h2>umts &lt;&amp;&gt; on</h2>' "$page"; result $? "a flight's name is escaped"
cmp -s "$work/fly/one & two.png" "$work/deep/out/01-fly-one & two.png"; result $? "the picture is copied"
grep -q 'src="01-fly-one%20%26%20two.png"' "$page"; result $? "and linked"
[ "$(ls "$work/deep/out" | wc -l)" = 3 ]; result $? "no temporary files stay"
# Means of 100 + 40 t and of 60/(t+1) for t = 0..90; 1000 bytes a second down.
grep -q -F '| umts \<&\> on | 90 | 1900 | 3700 | 50 | 200 | 60.0 | 90.0 | 4.5 | 270 | 3 | 3.36 | 6.72 | 300.0 |' "$table"
result $? "the numbers of the table"
grep -q -F '| blind | 90 | 1900 | 3700 | 50 | 200 | 60.0 | 90.0 | 4.5 | 270 | 3 | – | – | – |' "$table"
result $? "a flight without auditor has no error"
! grep -q -E 'SSIM|difference' "$page" "$table"; result $? "no flight compared its pictures: no columns of them"
awk -F, '{ print NR == 1 ? $0 ", diff_mean, diff_p95, ssim" : $0 (NR % 2 ? ", 3, 5, 0.75" : ", nan, nan, nan") }' "$work/blind.csv" >"$work/seen.csv"
"$report" "$work/seen.csv" "$work/blind.csv" -o "$work/seen" --settle 0 >"$work/said" 2>"$work/error" &&
    grep -q -F '| seen | 90 | 1900 | 3700 | 50 | 200 | 60.0 | 90.0 | 4.5 | 270 | 3 | 3.00 | 5.0 | 0.7500 |' "$work/seen/REPORT.md" &&
    grep -q -F '| blind | 90 | 1900 | 3700 | 50 | 200 | 60.0 | 90.0 | 4.5 | 270 | 3 | – | – | – |' "$work/seen/REPORT.md" &&
    grep -q -F '<th>SSIM</th>' "$work/seen/index.html" && [ "$(grep -c '<svg' "$work/seen/index.html")" = 10 ]
result $? "differences of pictures where a flight has them, and a plot of them"
# Pictures of two flights: three of the same names, one that only one of them has, one that differs everywhere by 2.
if command -v python3 >/dev/null; then
    python3 - "$work" <<'END'
import os, struct, sys, zlib
def png(path, grey, side=20):
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes([grey] * side) for _ in range(side))
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 0, 0, 0, 0)) +
                           chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
for folder in ("one", "two", "odd"):
    os.makedirs(sys.argv[1] + "/" + folder)
for t, grey in ((1, 10), (2, 20), (3, 30), (4, 40)):
    png("%s/one/frame-%07.2f.png" % (sys.argv[1], t), grey)
for t, grey in ((1, 10), (2, 22), (4, 80)):
    png("%s/two/frame-%07.2f.png" % (sys.argv[1], t), grey)
png(sys.argv[1] + "/odd/frame-0001.00.png", 10, 21)
END
    beside() { "$report" "$work/blind.csv" -o "$work/beside" "$@" >"$work/said" 2>"$work/error"; }
    beside --against "$work/one=$work/two" && grep -q 'src="reference-1.png"' "$work/beside/index.html" && [ -s "$work/beside/reference-1.png" ]
    result $? "pictures beside what they should be"
    ! beside --against "$work/one" && grep -q '^farfield-report: --against: .* is not DIR=DIR$' "$work/error"; result $? "--against wants two folders"
    beside --beside soft="$work/one" --beside gles1="$work/two"; result $? "two flights side by side"
    grep -q 'src="side-by-side.png"' "$work/beside/index.html" && grep -q 'At most 100.00 % of a picture' "$work/beside/REPORT.md"
    result $? "with the largest share that differs"
    python3 - "$work/beside/side-by-side.png" <<'END'
import struct, sys, zlib
data = open(sys.argv[1], "rb").read()
width, height = struct.unpack(">II", data[16:24])
body, at = b"", 8
while at < len(data):
    length, kind = struct.unpack(">I4s", data[at:at + 8])
    body += data[at + 8:at + 8 + length] if kind == b"IDAT" else b""
    at += 12 + length
raw, rows = zlib.decompress(body), []
for y in range(height):
    line, kind = bytearray(raw[y * (3 * width + 1) + 1:(y + 1) * (3 * width + 1)]), raw[y * (3 * width + 1)]
    for x in range(3 * width):
        left, up = line[x - 3] if x > 2 else 0, rows[-1][x] if rows else 0
        corner = rows[-1][x - 3] if rows and x > 2 else 0
        guess = min((abs(up - corner), 0, left), (abs(left - corner), 1, up), (abs(left + up - 2 * corner), 2, corner))[2]
        line[x] = line[x] + (0, left, up, (left + up) // 2, guess)[kind] & 255
    rows.append(line)
centre = [[rows[24 + 10 + row * 44][3 * (8 + 10 + column * 28)] for column in range(3)] for row in range(3)]
sys.exit(centre != [[10, 20, 40], [10, 22, 80], [0, 64, 255]] and "pixels %s" % centre)
END
    result $? "pictures, pictures, and differences 32 times as large"
    ! beside --beside soft="$work/one" && grep -q '^farfield-report: --beside: give two folders$' "$work/error"
    result $? "one folder alone is an error"
    ! beside --beside a="$work/one" --beside b="$work/odd" && grep -q '^farfield-report: --beside: .*frame-0001.00.png' "$work/error" &&
        [ "$(wc -l <"$work/error")" = 1 ]; result $? "pictures of another size are one clear error"
    ! beside --beside a="$work/one" --beside b="$work/deep" && grep -q 'no picture of the same name' "$work/error"
    result $? "folders without a common picture are an error"
fi
if command -v python3 >/dev/null; then
    "$report" --json "$work/blind.csv" -o "$work/json" |
        python3 -c 'import json, sys; f = json.load(sys.stdin)[0]; sys.exit(f["kb_down_60s"] != 60 or f["err_px_max"] is not None)'
    result $? "--json can be read"
    python3 - "$page" <<'END'
import re, sys, xml.dom.minidom
for svg in re.findall(r"<svg.*?</svg>", open(sys.argv[1], encoding="utf-8").read(), re.S):
    curves = re.findall(r"d='M[^']{300,}'", svg) + re.findall(r'd="M[^"]{300,}"', svg)
    xml.dom.minidom.parseString(svg)
    if not curves:
        sys.exit("a plot without a curve")
END
    result $? "every plot is well-formed and has a curve"
fi

# ---- the skyline, and by which truth ----
printf 't_s,triangles,nodes_drawn,nodes_held,bytes_down,bytes_up,requests,panoramas,err_px_rms,skyline_px_rms,truth_error_m\n0,1,1,1,1,1,1,0,9,9,4\n20,1,1,1,1,1,1,0,1,1.5,4\n21,1,1,1,1,1,1,0,1,2.5,4\n' >"$work/judged.csv"
"$report" --json "$work/judged.csv" -o "$work/judged" >"$work/said" 2>"$work/error"
grep -q '"skyline_px_rms_mean": 2, "truth_error_m": 4}' "$work/said" && grep -q '| 1.00 | 2.00 | 4.00 |$' "$work/judged/REPORT.md" &&
    grep -q 'judged by ground within m of its source' "$work/judged/index.html"
result $? "the skyline's error, and how true the truth is"

# ---- findings ----
mkdir -p "$work/found"
found() { # NAME RELEVANCE WITHOUT_RESERVE
    echo "t_s,triangles,nodes_drawn,nodes_held,bytes_down,bytes_up,requests,panoramas,err_px_rms,err_px_p95,err_px_max,undrawn_px_percent,square_px_waiting,square_px_depth,square_px_quality,square_px_panorama,square_px_undrawn,bytes_heights,bytes_images,bytes_faces,bytes_overhead,bytes_judged,unused_heights,unused_images,unused_faces,unused_supporting,relevance_percent,bytes_reserve,unused_reserve,relevance_no_reserve_percent,unused_hidden"
    for t in 0 15 20 315; do echo "$t,4000,10,20,$((t * 1000)),100,9,1,4,5,6,0,1,12,0,3,0,$((t * 300)),$((t * 600)),$((t * 90)),$((t * 10)),$((t * 1000)),2300,0,0,250,$2,40,30,$3,2000"; done
}
for name in umts-150-low-on lan-150-low-on gprs-150-low-on umts-0-low-on; do found $name 96.5 97.5 >"$work/found/$name.csv"; done
printf 'quality,panorama,instructions,err_px_p95,more\npx:2,on,5000000,0.5,x\n3:4,on,4000000,5,x\npx:4,on,3000000,1,x\n' >"$work/work.csv"
"$report" --paper tools/report/hybrid_table3.csv --instructions "$work/work.csv" "$work"/found/*.csv -o "$work/findings" >/dev/null 2>"$work/error"
result $? "a report with findings"
table=$work/findings/REPORT.md page=$work/findings/index.html
grep -q -F '| umts-150-low-on: kB of the paper'"'"'s | 0.50 | 0.73 | missed by 0.234 | most of it: images, 60 % |' "$table"; result $? "a target missed, by how much and why"
grep -q -F '| umts-150-low-on: triangles of the paper'"'"'s | 1.00 | 0.78 | hit |' "$table"; result $? "a target hit"
grep -q -F '| gprs-150-low-on: seconds to a stable picture | 15.00 | 0.00 | hit |' "$table"; result $? "stable from the start"
grep -q -F '| umts-0-low-on: relevance without the reserve % (with it 96.50) | 99.50 | 97.50 | missed by 2 | never drawn: 0.2 kB of neighbours without which nodes in view could not split, 2.0 kB hidden by near ground, 0.0 kB others' "$table" &&
    grep -q -F '| umts-150-low-on: relevance without the reserve % (with it 96.50) | 95.00 | 97.50 | hit |' "$table"
result $? "relevance, standing still and in flight: the target is for what was not asked for the reserve"
grep -q -F '| images | 60.0 |' "$table" && grep -q -F '| depth limit of the quality | 75.0 |' "$table" && grep -q -F '| parallax and texels of the panorama | 18.8 |' "$table"
result $? "where bytes go and error comes from"
grep -q 'Error against instructions' "$page" && grep -q '<td>px:2</td><td>on</td><td>5.00</td><td>0.50</td>' "$page"; result $? "the error against instructions"
sed '2s/5000000/many/' "$work/work.csv" >"$work/bad.work"
! "$report" --instructions "$work/bad.work" "$work/blind.csv" -o "$work/bad" 2>"$work/error" &&
    [ "$(cat "$work/error")" = "farfield-report: $work/bad.work:2: not a table of instructions and errors" ] && [ ! -e "$work/bad" ]
result $? "refuses a bad table of instructions"

refuses() { # WHAT MESSAGE, CSV on stdin
    cat >"$work/bad.csv"
    "$report" "$work/bad.csv" -o "$work/bad" >"$work/said" 2>"$work/error"
    [ $? = 1 ] && [ "$(cat "$work/error")" = "farfield-report: $2" ] && [ ! -s "$work/said" ] && [ ! -e "$work/bad" ]
    result $? "refuses $1"
}
refuses "an empty file" "$work/bad.csv: empty file" </dev/null
refuses "a file without rows" "$work/bad.csv:1: no rows" <<<"$header"
refuses "a foreign header" "$work/bad.csv:1: no column t_s: not the CSV of a flight" <<<"a,b,c"
refuses "a short row" "$work/bad.csv:5: 16 fields where the header has 17" < <(flight 1 | sed '5s/, 0, 500/, 500/')
refuses "a word for a number" "$work/bad.csv:5: t_s is not a number: three" < <(flight 1 | sed '5s/^3, /three, /')
refuses "NaN" "$work/bad.csv:5: t_s is out of range: nan" < <(flight 1 | sed '5s/^3, /nan, /')
refuses "time that goes back" "$work/bad.csv:5: t_s goes back" < <(flight 1 | sed '5s/^3, /0, /')
refuses "binary data" "$work/bad.csv:11: not text" < <(flight 1 | sed '11s/9/9\x00/')
"$report" "$work/none.csv" -o "$work/bad" 2>"$work/error"
[ "$(cat "$work/error")" = "farfield-report: $work/none.csv: No such file or directory" ]; result $? "names a missing file"
"$report" "$work/blind.csv" -o "$work/blind.csv/x" 2>"$work/error"
[ $? = 1 ] && [ "$(wc -l <"$work/error")" = 1 ]; result $? "a folder that cannot be made"
PATH=/nonexistent "$report" "$work/blind.csv" -o "$work/bad" 2>"$work/error"
[ $? = 1 ] && grep -q 'cannot run gnuplot' "$work/error"; result $? "says when gnuplot is missing"
"$report" --help | grep -q '^Usage: farfield-report' && "$report" --version | grep -q '^farfield-report [0-9]'
result $? "--help and --version"
exit $((failures > 0))
