#!/bin/bash
# Script test of farfield-bake: where things are. Rasters and images placed in every way that GDAL knows come out where they lie, or are
# refused at once, in one line. Prints "ok - what" / "not ok - what"; reads programs from BIN; writes only under build/.
set -u
BIN=$(cd "${BIN:-build/bin}" && pwd) || exit 1
# shellcheck source=../rig/result.bash
. tests/rig/result.bash
here=$PWD DIR=$PWD/build/tests/bake_place.$$
mkdir -p "$DIR" && cd "$DIR" || exit 1
trap 'rm -rf "$DIR"' EXIT

bake() { timeout 30 "$BIN/farfield-bake" "$@" -o OUT.ffp --json >bake.json 2>bake.err; }
field() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" bake.json; } # NAME: a number or word of the last bake's summary
noted() { grep -q "$1" bake.err || { sed 's/^/#   /' bake.err; return 1; }; }

refused() { # PATTERN BAKE-ARGUMENTS...: at once, in one line, and nothing is left
    local pattern=$1
    shift
    rm -f OUT.ffp
    bake "$@"
    [ $? = 1 ] && [ "$(wc -l <bake.err)" = 1 ] && noted "$pattern" && [ ! -e OUT.ffp ]
}

# ---- rasters: heights of 500 + 3 x - 2 y in 60 x 48 samples, and an image of 60 x 48 whose red grows to the right, green downwards ----
python3 - <<'PY'
with open('bare.asc', 'w') as out:
    out.write('ncols 60\nnrows 48\nxllcorner 0\nyllcorner 0\ncellsize 1\n')
    for y in range(48):
        out.write(' '.join(str(500 + 3 * x - 2 * y) for x in range(60)) + '\n')
with open('bare.ppm', 'wb') as out:
    out.write(b'P6\n60 48\n255\n' + b''.join(bytes((4 * x, 5 * y, 40)) for y in range(48) for x in range(60)))
PY
placed() { # SOURCE OUT.vrt SRS GT0..GT5: the raster there ("": without a reference system)
    local from=$1 to=$2 srs=$3
    shift 3
    gdal_translate -q -of VRT ${srs:+-a_srs "$srs"} "$from" "$to" &&
        python3 -c 'import re, sys
text = re.sub(r"\s*<GeoTransform>.*?</GeoTransform>", "", open(sys.argv[1]).read())
head, tail = text.split(">", 1)
open(sys.argv[1], "w").write(head + "><GeoTransform>" + ", ".join(sys.argv[2:]) + "</GeoTransform>" + tail)' "$to" "$@"
}
seen() { # WEST-PERCENT NORTH-PERCENT RED GREEN: the whole ground's texture there, within 16
    python3 "$here/tests/whole_jpeg.py" OUT.ffp OUT.jpg && gdal_translate -q -of PNM OUT.jpg OUT.ppm &&
        python3 -c 'import json, sys
b = json.load(open("bake.json"))
d = open("OUT.ppm", "rb").read()[-64 * 64 * 3:]
edge = 1 << b["tile_log2"]
at = lambda percent, n: round(63 * percent / 100 * (n - 1) / edge)
x, y = (int(v) for v in sys.argv[1:3])
i = ((63 - at(100 - y, b["samples_y"])) * 64 + at(x, b["samples_x"])) * 3
print("#   seen", list(d[i:i + 3]), "wanted", sys.argv[3:])
sys.exit(max(abs(d[i] - int(sys.argv[3])), abs(d[i + 1] - int(sys.argv[4]))) > 16)' "$@"
}
look=(--tile-log2 7 --texture-levels 1 --texture-quality 95)

# ---- nothing runs without bound ----
placed bare.asc degrees.vrt EPSG:4326 9 .001 0 45 0 -.001
placed bare.asc utm.vrt EPSG:32632 500000 30 0 5000000 0 -30
placed bare.ppm degrees-image.vrt "" 9 .001 0 45 0 -.001
bake degrees.vrt --color degrees-image.vrt "${look[@]}" && noted "degrees-image.vrt names no reference system: taken as the heights'" &&
    seen 10 10 24 24 && seen 90 50 212 120
result $? "an image in degrees without a reference system lies over heights in degrees"
placed bare.ppm metres-image.vrt "" 500000 78 0 4983000 0 -110
bake degrees.vrt --color metres-image.vrt "${look[@]}" && noted "heights' after projection"
result $? "one in the metres of the projected ground lies over that"
placed bare.ppm pixels.vrt "" 70000 .001 0 45 0 -.001
refused "in the heights' own it shows nothing" degrees.vrt --color pixels.vrt
result $? "one that lies nowhere near is refused, and its reference system asked for"
placed bare.ppm far.vrt EPSG:4326 80 .001 0 45 0 -.001
refused "shows nothing of this ground" utm.vrt --color far.vrt
result $? "an image of ground far off is refused before a pixel of it is read"
placed bare.ppm dots.vrt EPSG:32632 500000 .00001 0 5000000 0 -.00001
refused "make it coarser (gdalwarp -tr)" utm.vrt --color dots.vrt
result $? "an image whose pixels are dust on the ground is refused with what to do"
gdal_translate -q -of VRT -outsize 400000 300000 utm.vrt vast.vrt
refused "cut a part with gdal_translate -projwin" vast.vrt
result $? "more samples than the limit are refused before they are read"
placed bare.asc world.vrt EPSG:4326 -180 6 0 72 0 -3
refused "a terrain at most 8389 km" world.vrt --t-srs EPSG:32701
result $? "a projection that tears the raster is refused before it is walked"

exit $((failures > 0))
