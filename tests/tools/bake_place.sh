#!/bin/bash
# Script test of farfield-bake: where things are. Rasters and images placed in every way that GDAL knows come out where they lie, or are
# refused at once, in one line. Prints "ok - what" / "not ok - what"; reads programs from BIN; writes only under build/.
set -u
BIN=$(cd "${BIN:-build/bin}" && pwd) || exit 1
# shellcheck source=../rig/result.bash
. tests/rig/result.bash
# shellcheck source=../rig/bake.bash
. tests/rig/bake.bash
here=$PWD DIR=$PWD/build/tests/bake_place.$$
mkdir -p "$DIR" && cd "$DIR" || exit 1
trap 'rm -rf "$DIR"' EXIT

# ---- rasters ----
bare_rasters
python3 - <<'PY'
with open('cliff.asc', 'w') as out:
    out.write('ncols 60\nnrows 48\nxllcorner 0\nyllcorner 0\ncellsize 1\n')
    for y in range(48):
        out.write(' '.join(str(1000 * (x // 20 % 2)) for x in range(60)) + '\n')
# The same ground, and the same image, stored in each of the eight ways: turn-N.asc, .ppm, and turn-N.gt, where it lies (30 m).
for n in range(8):
    w, h = (48, 60) if n & 4 else (60, 48)
    def at(i, j):  # column and row of the ground for column i and row j of the file
        x, y = (j, i) if n & 4 else (i, j)
        return 59 - x if n & 1 else x, 47 - y if n & 2 else y
    with open('turn-%d.asc' % n, 'w') as out:
        out.write('ncols %d\nnrows %d\nxllcorner 0\nyllcorner 0\ncellsize 1\n' % (w, h))
        for j in range(h):
            out.write(' '.join(str(500 + 3 * x - 2 * y) for x, y in (at(i, j) for i in range(w))) + '\n')
    with open('turn-%d.ppm' % n, 'wb') as out:
        out.write(b'P6\n%d %d\n255\n' % (w, h) + b''.join(bytes((4 * x, 5 * y, 40)) for x, y in (at(i, j) for j in range(h) for i in range(w))))
    dx, dy = -30 if n & 1 else 30, 30 if n & 2 else -30
    gt = [501800 if n & 1 else 500000, dx, 0, 4998560 if n & 2 else 5000000, 0, dy]
    if n & 4:
        gt = [gt[0], 0, dx, gt[3], dy, 0]
    open('turn-%d.gt' % n, 'w').write(' '.join(str(v) for v in gt))
PY
placed() { # SOURCE OUT.vrt SRS GT0..GT5: the raster there ("": without a reference system)
    local from=$1 to=$2 srs=${3:+<SRS>$3</SRS>} IFS=,
    shift 3
    [ -e "$from.vrt" ] || gdal_translate -q -of VRT "$from" "$from.vrt" || return 1
    sed "/<GeoTransform>/d; 1s|\$|$srs<GeoTransform>$*</GeoTransform>|" "$from.vrt" >"$to"
}
seen() { # (WEST-PERCENT NORTH-PERCENT RED GREEN)...: the whole ground's texture there, within 16
    python3 "$here/tests/whole_jpeg.py" OUT.ffp OUT.jpg && gdal_translate -q -of PNM OUT.jpg OUT.ppm &&
        python3 -c 'import json, sys
b = json.load(open("bake.json"))
d = open("OUT.ppm", "rb").read()[-64 * 64 * 3:]
edge = 1 << b["tile_log2"]
at = lambda percent, n: round(63 * percent / 100 * (n - 1) / edge)
places = [int(v) for v in sys.argv[1:]]
for x, y, red, green in zip(*[iter(places)] * 4):
    i = ((63 - at(100 - y, b["samples_y"])) * 64 + at(x, b["samples_x"])) * 3
    if max(abs(d[i] - red), abs(d[i + 1] - green)) > 16:
        sys.exit("#   seen %s at %d, %d, wanted %d, %d" % (list(d[i:i + 3]), x, y, red, green))' "$@"
}
look=(--tile-log2 7 --texture-levels 1 --texture-quality 95 --image-codec jpeg)

# ---- nothing runs without bound ----
placed bare.asc degrees.vrt EPSG:4326 9 .001 0 45 0 -.001
placed bare.asc utm.vrt EPSG:32632 500000 30 0 5000000 0 -30
placed bare.ppm degrees-image.vrt "" 9 .001 0 45 0 -.001
bake degrees.vrt --color degrees-image.vrt "${look[@]}" && noted "degrees-image.vrt names no reference system: taken as the heights'" &&
    seen 10 10 24 24 90 50 212 120
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
gdal_translate -q -of VRT -outsize 200000 160000 -a_srs EPSG:32632 -a_ullr 500000 5000000 501800 4998560 bare.ppm dots.vrt
refused "make it coarser (gdalwarp -tr)" utm.vrt --color dots.vrt
result $? "an image whose pixels are dust on the ground is refused with what to do"
placed bare.ppm speck.vrt EPSG:32632 500000 .00001 0 5000000 0 -.00001
refused "shows nothing of this ground" utm.vrt --color speck.vrt
result $? "an image that is a speck on the ground is refused"
gdal_translate -q -of VRT -outsize 400000 300000 utm.vrt vast.vrt
refused "cut a part with gdal_translate -projwin" vast.vrt
result $? "more samples than the limit are refused before they are read"
placed bare.asc world.vrt EPSG:4326 -180 6 0 72 0 -3
refused "a terrain at most 8389 km" world.vrt --t-srs EPSG:32701
result $? "a projection that tears the raster is refused before it is walked"

# ---- any invertible geotransform ----
for n in 0 1 2 3 4 5 6 7; do # shellcheck disable=SC2046
    placed turn-$n.asc turn-$n.vrt EPSG:32632 $(cat turn-$n.gt)
done
eight() { # OPTIONS...: all eight make the pack of the first
    local n
    for n in 0 1 2 3 4 5 6 7; do
        bake turn-$n.vrt "$@" || { cat bake.err; return 1; }
        if [ $n = 0 ]; then mv OUT.ffp first.ffp; else cmp OUT.ffp first.ffp || return 1; fi
    done
}
eight && [ "$(field samples_x) $(field samples_y) $(field epsg)" = "60 48 32632" ]
result $? "rows and columns exchanged or running backwards, in all eight ways, are the same ground"
eight --spacing 30 && eight --no-project && eight --no-project --spacing 30
result $? "with --spacing as well, and with --no-project"
eight_seen() {
    local n
    for n in 0 1 2 3 4 5 6 7; do
        bake turn-$n.vrt --color turn-$n.ppm "${look[@]}" && seen 10 10 24 24 90 20 212 48 20 90 48 212 || return 1
    done
}
eight_seen
result $? "an image without georeference lies over them pixel by pixel"
eight --spacing 45 && bake turn-6.vrt --spacing 45 --color turn-6.ppm "${look[@]}" && seen 10 10 24 24 90 20 212 48
result $? "and so it does when they are resampled"
placed bare.asc slant.vrt EPSG:32632 500000 25.98 15 5000000 15 -25.98
refused "turned or no squares" slant.vrt --no-project
result $? "turned cells are not taken as they are without --spacing"
bake slant.vrt --no-project --spacing 30 && noted "does not tell where they lie" && [ "$(field epsg) $(field samples_x)" = "0 60" ]
result $? "with it they are, and the pack names no place"
placed bare.asc line.vrt EPSG:32632 500000 30 60 5000000 15 30
refused "all samples on one line" line.vrt
result $? "a geotransform that cannot be inverted is refused"

# ---- projections that are not true to scale ----
near() { awk -v a="$1" -v b="$2" -v within="$3" 'BEGIN { d = a - b; if (a ~ /[0-9]/ && d <= within && -d <= within) exit 0; print "#   " a ", wanted " b; exit 1 }'; }
placed bare.asc mercator.vrt EPSG:3857 1113194 30 0 8399737 0 -30 # 60 degrees north, where a metre is shown as two
bake mercator.vrt && noted "Pseudo-Mercator shows a metre of this ground as 1.99" && [ "$(field epsg)" = 32632 ] && near "$(field spacing_m)" 15.03 .05
result $? "Web Mercator is projected to the local UTM zone, and the note tells why"
placed bare.asc carree.vrt EPSG:4087 1113194 60 0 6679169 0 -60
bake carree.vrt && noted "Equidistant Cylindrical shows a metre of this ground as 0.99[0-9] to 1.99" && [ "$(field epsg)" = 32632 ]
result $? "so is plate carree"
bake mercator.vrt --no-project && noted "kept" && [ "$(field epsg) $(field spacing_m)" = "3857 30" ]
result $? "with --no-project it stays, and the note tells"
bake degrees.vrt --t-srs EPSG:3857 && noted "shows a metre of this ground as 1.41.* are not true"
result $? "asked for by --t-srs it is made, and the note tells"
bake utm.vrt && [ "$(wc -l <bake.err)" = 1 ] && [ "$(field epsg) $(field resampled)" = "32632 false" ]
result $? "a plane true to scale stays, without a word"
placed bare.asc europe.vrt EPSG:3035 2700000 100 0 1900000 0 -100 # 20 degrees west of its middle
bake europe.vrt && noted "projected to WGS 84 / UTM zone 29N" && [ "$(field epsg)" = 32629 ]
result $? "a plane of a whole continent is projected at its rim"
placed bare.asc moon.vrt "+proj=eqc +R=1737400 +units=m" 30323 100 0 1819405 0 -100
bake moon.vrt && noted "projected to local transverse Mercator" && near "$(field spacing_m)" 73.7 .1
result $? "on the Moon the local projection is one of the Moon"
placed bare.asc lo29.vrt EPSG:2053 20000 30 0 3000000 0 -30 # axes west and south
bake lo29.vrt && noted "Lo29 points west: projected to WGS 84 / UTM zone 35S" && [ "$(field epsg)" = 32735 ]
result $? "a plane whose axes point west and south, turned round in a pack, is projected"
placed bare.asc krovak.vrt EPSG:5513 1100000 30 0 650000 0 -30 # axes south and west
bake krovak.vrt && noted "Krovak points west: projected to WGS 84 / UTM zone 33N" && "$BIN/farfield-export" OUT.ffp -o OUT.tif --quiet
status=$?
# its rows run east: from 499 at the first row's last sample down to the last row
near "$(gdallocationinfo -valonly -l_srs EPSG:5513 OUT.tif 1100300 649300 2>/dev/null)" 482 3 && [ $status = 0 ]
result $? "so is one whose axes point south and west, a mirrored one"
bake lo29.vrt --no-project && noted "pack's north is another: kept" && refused "whose axes point east and north" utm.vrt --t-srs EPSG:2053
result $? "with --no-project it stays, and the note tells; --t-srs to such a plane is refused"

# ---- resampling ----
placed cliff.asc cliff.vrt EPSG:32632 500000 25.98 15 5000000 15 -25.98
bake cliff.vrt && noted "beyond the source's lowest or highest height at [0-9]* samples, by up to 7[0-9].[0-9] m: kept" &&
    [ "$(field height_min_m) $(field height_max_m)" = "0 1000" ]
result $? "cliffs do not overshoot the source's range, and the note tells"

# ---- spacings that a pack does not have ----
product() { awk -v a="$(field "$1")" -v b="$(field spacing_m)" 'BEGIN { printf "%.9g", a * b }'; }
width() { near "$(product samples_x)" "$1" "$2"; }
placed bare.asc fine.vrt EPSG:32632 500000 .05 0 5000000 0 -.05 # 12.8 units
bake fine.vrt && noted "no multiple of 1/256 m: resampled to squares of 0.05078125 m" && width 3 .026 && [ "$(field resampled)" = true ]
result $? "cells of 5 cm are resampled to keep their extent"
placed bare.asc finest.vrt EPSG:32632 500000 .01 0 5000000 0 -.01
bake finest.vrt && width .6 .006
result $? "so are cells of 1 cm"
placed bare.asc little.vrt EPSG:32632 500000 30 0 5000000 0 -30.3
bake little.vrt && noted "unlike" && near "$(product samples_y)" 1454.4 31
result $? "so are cells that are unlike by 1 %"
bake bare.ppm --rgb none --spacing .05 --scale .1 && noted "resampled to squares of 0.05078125 m" && width 3 .026 && [ "$(field epsg)" = 0 ]
result $? "so is a raster without a place whose --spacing the pack does not have"
bake bare.ppm --rgb none --spacing .05 --color bare.ppm "${look[@]}" && seen 10 10 24 24 90 50 212 120
result $? "and an image still lies over it"
placed bare.asc near.vrt EPSG:32632 500000 28.4 0 5000000 0 -28.4
bake near.vrt && [ "$(field resampled)" = false ] && [ "$(wc -l <bake.err)" = 1 ] && width 1704 .1
result $? "where all drift stays below a quarter of a sample every sample is kept"
bake fine.vrt --no-project && noted "rounded to 0.05078125 m: 0.0 m from end to end" && [ "$(field resampled)" = false ]
result $? "with --no-project it is rounded, and the note tells"

# ---- across 180 degrees ----
python3 - <<'PY'
for name, west, first in (('east', 179, 0), ('west', -180, 20)):
    with open(name + '.asc', 'w') as out:
        out.write('ncols 20\nnrows 20\nxllcorner %d\nyllcorner -17\ncellsize 0.05\n' % west)
        for y in range(20):
            out.write(' '.join(str(900 + 10 * (first + x)) for x in range(20)) + '\n')
with open('metres.asc', 'w') as out:
    out.write('ncols 360\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -99\n')
    for y in range(4):
        out.write(' '.join(str(x if x < 100 or x >= 340 else -99) for x in range(360)) + '\n')
PY
gdalbuildvrt -q -a_srs EPSG:4326 both.vrt east.asc west.asc
gdalbuildvrt -q -a_srs EPSG:4326 -vrtnodata -99 void.vrt east.asc west.asc && gdal_translate -q void.vrt void.tif
slope() { # the heights rise evenly from west to east
    local at
    "$BIN/farfield-export" OUT.ffp -o OUT.tif --quiet || return 1
    for at in 179.175:930 179.975:1090 -179.975:1100 -179.375:1220; do
        near "$(gdallocationinfo -valonly -wgs84 OUT.tif "${at%:*}" -16.5)" "${at#*:}" 6 || return 1
    done
}
for raster in both.vrt void.vrt void.tif; do
    bake $raster --hscale 1 && noted "joined at 180 degrees" && [ "$(field epsg)" = 32701 ] && slope
    result $? "a mosaic on both sides of 180 degrees is one ground ($raster)"
done
gdal_translate -q -scale 0 9999 -99 -99 void.vrt nothing.tif
refused "not one valid height" nothing.tif
result $? "a raster all round the Earth with nothing in it is told to be that"
bake metres.asc && ! grep -q "180 degrees" bake.err && [ "$(field samples_x) $(field voids)" = "360 960" ]
result $? "360 columns of a metre are not 360 degrees"
gdal_translate -q -of VRT -srcwin 0 0 3600 20 both.vrt crop.vrt
refused "cut a part with gdal_translate -projwin" crop.vrt
result $? "half the Earth is refused"
gdal_translate -q -projwin 179 -16 180 -17 both.vrt part.tif && bake part.tif
result $? "and the advice works: the part is baked"

# ---- mosaics ----
gdal_translate -q -of GTiff utm.vrt whole.tif
for part in "0 0 31 25" "29 0 31 25" "0 24 31 24" "29 24 31 24"; do # shellcheck disable=SC2086
    gdal_translate -q -srcwin $part whole.tif "part-${part// /-}.tif"
    gdal_translate -q -srcwin $part -a_nodata -9999 whole.tif "void-${part// /-}.tif"
done
/usr/bin/python3 - <<'PY'
# the second of the overlapping parts knows nothing of what the first one knows
from osgeo import gdal
raster = gdal.Open("void-29-0-31-25.tif", gdal.GA_Update)
values = raster.GetRasterBand(1).ReadAsArray()
values[:, :2] = -9999
raster.GetRasterBand(1).WriteArray(values)
PY
gdalbuildvrt -q parts.vrt part-*.tif && gdalbuildvrt -q voids.vrt void-*.tif
bake whole.tif && mv OUT.ffp first.ffp && bake parts.vrt && cmp OUT.ffp first.ffp && bake voids.vrt && cmp OUT.ffp first.ffp
result $? "a mosaic of overlapping parts (gdalbuildvrt) is the ground that they were cut from, without seams"
bake utm.vrt --t-srs EPSG:32633 && mv OUT.ffp first.ffp && bake parts.vrt --t-srs EPSG:32633 && cmp OUT.ffp first.ffp
result $? "projected, too"

# ---- other ways of telling where a raster lies ----
gcps() { # NAME: with control points at three corners, and whatever follows
    local to=$1
    shift
    gdal_translate -q -a_srs EPSG:32632 -gcp 0 0 500000 5000000 -gcp 60 0 501800 5000000 -gcp 0 48 500000 4998560 "$@" bare.asc "$to"
}
gcps agree.tif -gcp 60 48 501800 4998560 && bake agree.tif && [ "$(field epsg) $(field spacing_m) $(field origin_x_mm)" = "32632 30 " ]
result $? "control points that agree on a geotransform are one"
gcps bent.tif -gcp 60 48 501900 4998660 && refused "make a grid of it first with gdalwarp -r cubic" bent.tif
result $? "others are refused, with what to do"
gdalwarp -q -r cubic bent.tif straight.tif && bake straight.tif && [ "$(field epsg)" = 32632 ]
result $? "and that works"
gdal_translate -q -of VRT bare.asc rpc.vrt && sed -i 's|</GeoTransform>|&<Metadata domain="RPC"><MDI key="LINE_OFF">24</MDI></Metadata>|; s|<GeoTransform>.*</GeoTransform>||' rpc.vrt
refused "sensor model (RPC): make a grid of it first with gdalwarp -rpc -r cubic" rpc.vrt --spacing 30
result $? "a raster placed by RPCs is refused, also with --spacing"
gdal_translate -q -a_srs EPSG:32632 -gcp 0 0 500000 5000000 -gcp 60 0 501800 5000000 -gcp 0 48 500000 4998560 bare.ppm gcps-image.tif
refused "gcps-image.tif is placed by ground control points" utm.vrt --color gcps-image.tif
result $? "so is an image placed by control points, over heights that have a place"

# ---- what a pack says of its reference system ----
placed bare.asc compound.vrt EPSG:32632+5773 500000 30 0 5000000 0 -30
placed bare.asc compound-degrees.vrt EPSG:4326+5773 9 .001 0 45 0 -.001
bake compound.vrt && [ "$(wc -l <bake.err) $(field epsg)" = "1 32632" ] && bake compound-degrees.vrt && [ "$(field epsg)" = 32632 ]
result $? "a compound system keeps the code of its horizontal part"
prj_files() {
    local code
    for code in 2056 25832 31467 27700 2154 5514 28992 26913; do
        sed 's/^cellsize.*/cellsize 30/' bare.asc >prj.asc && gdalsrsinfo -o wkt_esri EPSG:$code | tr -d '\n' >prj.prj
        bake prj.asc --no-project && [ "$(field epsg)" = $code ] || { echo "#   EPSG:$code became $(field epsg)"; return 1; }
    done
}
prj_files
result $? ".prj files, which name no code, keep theirs"

exit $((failures > 0))
