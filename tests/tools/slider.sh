#!/bin/bash
# farfield-report --slider: the page opens with two pictures of one moment, and with what the flight's CSV tells of it. In headless Chromium,
# where there is one, the page fits a phone and a desk.
set -u
cd "$(dirname "$0")/../.." || exit 2
report=${BIN:-build/bin}/farfield-report
work=build/tests/slider
. tests/rig/result.bash
rm -rf "$work"
mkdir -p "$work"
command -v python3 >/dev/null || { echo "ok - slider # skip no python3"; exit 0; }

# Pictures of one grey: a flight at 15, 30 and 60 s, the truth at 15 and 30 s; and the truth a pixel wider.
python3 - "$work" <<'END'
import os, struct, sys, zlib
def png(name, grey, width=40, height=25):
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    path = sys.argv[1] + "/" + name
    os.makedirs(os.path.dirname(path), exist_ok=True)
    rows = (b"\0" + bytes([grey] * width)) * height
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
                           chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
for t in 15, 30, 60:
    png("gprs/frame-%07.2f.png" % t, t)
for t in 15, 30:
    png("true/frame-%07.2f.png" % t, 100 + t)
png("wide/frame-0030.00.png", 130, 41)
png("early/frame-0031.00.png", 1)
png("late/frame-0031.00.png", 1)
os.makedirs(sys.argv[1] + "/none")
END
head="t_s,triangles,nodes_drawn,nodes_held,bytes_down,bytes_up,requests,panoramas"
more="err_px_rms,skyline_px_rms,bytes_heights,bytes_images,bytes_faces,bytes_overhead,unused_heights,unused_images,unused_faces,unused_supporting,relevance_percent,far_sets,far_sectors,far_bytes,bytes_far,unused_far,square_px_waiting,square_px_far"
{
    echo "$head,$more"
    for t in 0 15 29.7 30 60; do
        s=$t t=${t%.*}
        echo "$s,4000,30,90,$((t * 1000)),100,9,0,0.$((t + 10)),0.$((t + 20)),$((t * 600)),0,0,80,0,0,0,0,90,$((t / 15)),$((t / 5)),$((t * 390)),$((t * 390)),900,3,1"
    done
} >"$work/gprs.csv"
printf '%s\n0,1,1,1,0,1,1,0\n31,1,1,1,2000,1,1,0\n' "$head" >"$work/early.csv"

slider() { "$report" "$work"/*.csv -o "$work/out" "$@" >"$work/said" 2>"$work/error"; }
page=$work/out/index.html table=$work/out/REPORT.md
slider --slider "over GPRS=$work/gprs/" --slider "as it should be=$work/true" --title "A & B" --attribution "Owner & <sons>"
result $? "makes a page"
grep -q '<meta name="viewport" content="width=device-width,initial-scale=1">' "$page"; result $? "a phone shows it in its own width"
[ "$(grep -o 'img src="slider-[a-z]*.png" width="40" height="25" alt="[^"]*"><span>[^<]*' "$page")" = 'img src="slider-left.png" width="40" height="25" alt="The ground over GPRS"><span>over GPRS
img src="slider-right.png" width="40" height="25" alt="The ground as it should be"><span>as it should be' ]
result $? "both pictures are named, in their size"
python3 - "$work/out" <<'END'
import sys, zlib
for side, grey in ("left", 30), ("right", 130):
    data = open("%s/slider-%s.png" % (sys.argv[1], side), "rb").read()
    at = data.index(b"IDAT")
    row = zlib.decompressobj().decompress(data[at + 4:])[:4]
    if row[1] != grey:
        sys.exit("%s is %d, not %d" % (side, row[1], grey))
END
result $? "they are the last of the moments that both have"
says='30.0 kB came over GPRS in 30 s, 18.0 kB as heights, 11.7 kB as sets of far ground: the picture is 0.40 px off (rms), its skyline 0.50 px.'
grep -q -F "<p class=\"says\">$says</p>" "$page" && grep -q -F "$says" "$table"; result $? "one sentence with the figures of that moment"
[ "$(grep -c '<input type="range"' "$page")" = 1 ] && ! grep -q '<script' "$page" && ! grep -q -E '(src|href)="?https?:|url\(http' "$page"
result $? "a range that keys move, no script but its own, nothing from a network"
[ "$(grep -o '<h1>.*</h1>\|<figure class="slider">\|<table>' "$page" | head -n 3)" = '<h1>A &amp; B</h1>
<figure class="slider">
<table>' ]; result $? "heading and pictures come before all tables"
grep -q 'Ground: Owner &amp; &lt;sons&gt;' "$page" && grep -q 'Ground: Owner & \\<sons\\>' "$table"; result $? "whose ground it is"
grep -q '| gprs | .*| 60.0 | 0.1 | 9 | 0 | 4 | 12 | 36.0 | 23.4 | 0.4[0-9] | 0.5[0-9] |$' "$table" && grep -q '<th>sets of far ground</th>' "$page" &&
    ! grep -q 'kB panoramas' "$page" "$table"
result $? "what came as heights and as sets in the table, and no column of what no flight had"
sed 's/,[1-9][0-9]*,[0-9]*,[0-9]*,[0-9]*,900,3,1$/,0,0,0,0,0,3,1/' "$work/gprs.csv" >"$work/tree.csv"
slider && grep -q '| tree | .*| 0 | – | – | 36.0 | – | 0.4' "$table" && "$report" "$work/tree.csv" -o "$work/tree" >/dev/null 2>"$work/error" &&
    ! grep -q 'their sectors' "$work/tree/index.html"
result $? "a flight without sets of far ground beside one with them, and alone"
rm "$work/tree.csv"
slider && grep -q -F '| sets of far ground | 39.' "$table" && grep -q -F '| outlines of far ground | 25.0 |' "$table" &&
    grep -q -F '| gprs | 90.00 | – | 36.0 | 0.0 | 0.0 | 23.4 | 0.1 | 0.0 | 0.0 | – | 0.0 | 0.0 | 0.9 | – |' "$table"
result $? "sets of far ground among the sources of bytes and error, and in the relevance"
slider --slider "<b>\"x\"&'y'=$work/gprs" --slider "*|<img onerror>=$work/true" --title '</h1><script>' --attribution '"><u>'
! grep -q -F -e '<b>' -e '<script' -e '<img onerror' -e '"x"' -e '"><u>' "$page" && grep -q -F '&lt;b&gt;&quot;x&quot;&amp;' "$page" &&
    grep -q -F '\*\|\<img onerror\>' "$table"
result $? "names, title and owner show as they are"
"$report" "$work/gprs.csv" -o "$work/plain" >/dev/null 2>"$work/error" && ! grep -q -i 'slider\|<header' "$work/plain/index.html"
result $? "without --slider nothing of it"
mkdir -p "$work/early.true" && cp "$work/early/frame-0031.00.png" "$work/early.true"
slider --slider "over UMTS=$work/early" --slider "truth=$work/early.true" && grep -q '<p class="says">2.0 kB came over UMTS in 31 s.</p>' "$page"
result $? "a flight that nobody judged has no error"

refuses() { # WHAT MESSAGE OPTION...
    what=$1 message=$2
    shift 2
    slider "$@"
    [ $? = "${exit_code:-1}" ] && [ "$(cat "$work/error")" = "farfield-report: --slider: $message" ] && [ ! -s "$work/said" ]
    result $? "refuses $what"
}
exit_code=2 refuses "one folder" "give two folders" --slider "a=$work/gprs"
refuses "a flight without CSV" "$work/true: no CSV is named as this folder" --slider "a=$work/true" --slider "b=$work/gprs"
refuses "pictures of two sizes" "$work/wide/frame-0030.00.png: not as large as the other picture" --slider "a=$work/gprs" --slider "b=$work/wide"
refuses "no common moment" "$work/none: no picture of the same name" --slider "a=$work/gprs" --slider "b=$work/none"
cp "$work/late/frame-0031.00.png" "$work/gprs"
refuses "a moment that the CSV does not know" "frame-0031.00.png: no row of the CSV is of its moment" --slider "a=$work/gprs" --slider "b=$work/late"
rm "$work/gprs/frame-0031.00.png"

# ---- as a browser shows it ----
what="fits 390 and 1280 pixels, the pictures lie exactly over each other, the range moves what is seen"
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
if [ -z "$browser" ]; then
    echo "ok - $what # skip no Chromium (Debian's package chromium)"
else
    slider --slider "over GPRS=$work/gprs" --slider "as it should be=$work/true" --title "A rather long title of a page about mountains far away"
    cat >"$work/frames.html" <<'END'
<!DOCTYPE html><body><iframe src="out/index.html" style="width:390px;height:844px;border:0"></iframe>
<iframe src="out/index.html" style="width:1280px;height:800px;border:0"></iframe><script>
const box = e => { const r = e.getBoundingClientRect(); return [r.left, r.top, r.width, r.height].join(); };
function measure(frame) {
    const page = frame.contentDocument, [left, right] = page.querySelectorAll('.slider img'), figure = page.querySelector('.slider'), range = page.querySelector('input');
    range.focus(); range.value = 20; range.dispatchEvent(new Event('input'));
    const cut = frame.contentWindow.getComputedStyle(right.parentNode).clipPath;
    return [page.documentElement.scrollWidth <= frame.clientWidth, box(left) == box(right) && box(left) == box(figure), left.naturalWidth, page.activeElement == range, cut,
            page.querySelector('.says').getBoundingClientRect().bottom < frame.clientHeight].join(' ');
}
onload = () => { document.body.textContent = [...document.querySelectorAll('iframe')].map(measure).join(' and '); };
</script></body>
END
    timeout 60 "$browser" --headless=new --no-sandbox --no-first-run --disable-gpu --disable-dev-shm-usage --allow-file-access-from-files \
        --user-data-dir="$PWD/$work/profile" --dump-dom "file://$PWD/$work/frames.html" >"$work/dom" 2>"$work/error"
    one='true true 40 true inset(0px 0px 0px 20%) true'
    grep -q -F "$one and $one" "$work/dom"; result $? "$what"
    rm -rf "$work/profile"
fi
exit $((failures > 0))
