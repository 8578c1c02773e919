#!/bin/bash
# Script test of farfield-bake and -export: what goes from one datum to another. Ground that may lie off is told by how much, and what to
# do; the operation that is told is the one that is used; what nothing is known of is refused. Prints "ok - what" / "not ok - what"; reads
# programs from BIN; writes only under build/.
set -u
BIN=$(cd "${BIN:-build/bin}" && pwd) || exit 1
# shellcheck source=../rig/result.bash
. tests/rig/result.bash
# shellcheck source=../rig/bake.bash
. tests/rig/bake.bash
here=$PWD DIR=$PWD/build/tests/bake_datum.$$
mkdir -p "$DIR/grids" && cd "$DIR" || exit 1
trap 'rm -rf "$DIR"' EXIT

unsaid() { if grep -E 'shifted|datum' bake.err; then return 1; fi; }

bare_rasters
placed() { # SOURCE OUT.vrt SRS WEST CELL NORTH
    [ -e "$1.vrt" ] || gdal_translate -q -of VRT "$1" "$1.vrt" || return 1
    sed "/<GeoTransform>/d; 1s|\$|<SRS>$3</SRS><GeoTransform>$4,$5,0,$6,0,-$5</GeoTransform>|" "$1.vrt" >"$2"
}
# The height that the pack shows where PROJ's pipeline puts a place: LON LAT STEPS.
shown() {
    local at
    at=$(echo "$1 $2" | gdaltransform -ct "+proj=pipeline $3" -output_xy) && "$BIN/farfield-export" OUT.ffp -o OUT.tif --quiet &&
        gdallocationinfo -valonly -geoloc OUT.tif $at # shellcheck disable=SC2086
}
near() { awk -v a="$1" -v b="$2" -v within="$3" 'BEGIN { d = a - b; if (a ~ /[0-9]/ && d <= within && -d <= within) exit 0; print "#   " a ", wanted " b; exit 1 }'; }

# ---- told, and as told ----
placed bare.asc nad27.vrt EPSG:4267 -95.05 .00001 40.05
helmert() { # X Y Z: NAD27's degrees to UTM, by a shift of the Earth's middle, as EPSG has it
    echo "+step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=push +v_3 +step +proj=cart +ellps=clrk66 +step +proj=helmert +x=$1 +y=$2 +z=$3" \
        "+step +inv +proj=cart +ellps=WGS84 +step +proj=pop +v_3 +step +proj=utm +zone=15 +ellps=WGS84"
}
bake nad27.vrt && noted 'shifted from NAD27 to WGS 84 by "NAD27 to WGS 84 (6)", accurate to 7 m' && [ "$(field epsg)" = 32615 ]
result $? "NAD27 to WGS 84: the note tells by which shift, and how accurate that is"
near "$(shown -95.049695 40.049795 "$(helmert -8 159 175)")" 550 4
result $? "the shift that is told is the one that is used"
# Where several shifts are meant to be used, GDAL left alone takes another one for a raster whose columns run north.
placed bare.asc gulf.vrt EPSG:4267 -94.37 .00001 30.034
sed -i 's|<GeoTransform>.*</GeoTransform>|<GeoTransform>-94.37,-.000002,-.00001,30.034,.00001,-.000002</GeoTransform>|' gulf.vrt
bake gulf.vrt --t-srs EPSG:32615 && noted '"NAD27 to WGS 84 (81)", accurate to 5 m' && near "$(shown -94.370266 30.034264 "$(helmert -7 151 175)")" 550 4
result $? "with --t-srs, too"
bake nad27.vrt
stay=$(sed -n 's/.*; --t-srs \(EPSG:[0-9]*\) keeps its datum$/\1/p' bake.err)
bake nad27.vrt --t-srs "$stay" && unsaid && [ "EPSG:$(field epsg)" = "$stay" ]
result $? "the --t-srs that it advises keeps the datum, without a word"
timeout 30 "$BIN/farfield-bake" nad27.vrt --estimate 2>estimate.err >/dev/null && cp estimate.err bake.err && noted '"NAD27 to WGS 84 (6)"'
result $? "--estimate tells the same beforehand"
placed bare.asc coarse.vrt EPSG:4267 -95.05 .001 40.05
bake coarse.vrt && unsaid && placed bare.asc etrs89.vrt EPSG:4258 9 .00003 50 && bake etrs89.vrt && unsaid
result $? "what is less than half a sample is not told"
[ "$(field datum_shift), $(field datum_shift_m)" = "ETRS89 to WGS 84 (1), 1" ] && bake etrs89.vrt --t-srs EPSG:25832 && [ "$(field datum_shift), $(field datum_shift_m)" = ", 0" ]
result $? "but the summary has it"
placed bare.asc rim.vrt EPSG:4314 7 .003 47.36
bake rim.vrt && noted "where it is meant for, but not all of this lies there"
result $? "ground that reaches beyond where a shift is meant for is told, however coarse"
placed bare.asc given.vrt '+proj=longlat +ellps=krass +towgs84=23,-123,-98' 40 .001 55
bake given.vrt && noted "of unknown accuracy" && [ "$(field datum_shift_m)" = null ]
result $? "a shift that the raster itself gives is one of unknown accuracy"
placed bare.asc west.vrt EPSG:4167 179.9998 .00001 -31
bake west.vrt && noted 'accurate to 1 m' && [ "$(field samples_x)" -lt 80 ] &&
    near "$(shown 180.000105 -31.000205 '+step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=utm +zone=1 +south +ellps=GRS80')" 550 4
result $? "so is ground across 180 degrees"

# ---- better with a grid ----
missing=$(sed -n 's/.*PROJ had \([^)]*\)).*/\1/p' <(bake nad27.vrt; cat bake.err))
[ "$missing" = "us_noaa_conus.tif and us_noaa_mohpgn.tif" ]
result $? "where a better one lacks its grids they are named"
/usr/bin/python3 - "$missing" <<'PY'
import sys
import numpy
from osgeo import gdal, osr
gdal.UseExceptions()
for n, name in enumerate(sys.argv[1].split(' and ')):  # the first one moves 3 seconds of arc to the north, the second one nowhere
    made = gdal.GetDriverByName('GTiff').Create('grids/' + name, 41, 31, 2, gdal.GDT_Float32)
    made.SetGeoTransform((-100.125, .25, 0, 43.125, 0, -.25))
    srs = osr.SpatialReference()
    srs.ImportFromEPSG(4267 if n == 0 else 4269)
    made.SetProjection(srs.ExportToWkt())
    made.SetMetadata({'AREA_OR_POINT': 'Point', 'TYPE': 'HORIZONTAL_OFFSET'})
    for band, what, value in ((1, 'latitude_offset', 3.0 if n == 0 else 0.0), (2, 'longitude_offset', 0.0)):
        made.GetRasterBand(band).WriteArray(numpy.full((31, 41), value, 'f4'))
        made.GetRasterBand(band).SetDescription(what)
        made.GetRasterBand(band).SetUnitType('arc-second')
PY
folders=$(/usr/bin/python3 -c 'from osgeo import osr; print(":".join(osr.GetPROJSearchPaths()))')
PROJ_DATA=$DIR/grids:$folders PROJ_LIB=$DIR/grids:$folders bake nad27.vrt && noted 'accurate to 2.15 m' &&
    near "$(shown -95.049695 40.050628333 '+step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=utm +zone=15 +ellps=GRS80')" 550 4
result $? "and once they are installed, used"

# ---- nothing known ----
placed bare.asc offshore.vrt EPSG:4277 1.935 .001 50.3
refused "PROJ knows no shift from OSGB36 to WGS 84 at this place: install uk_os_OSTN15_NTv2_OSGBtoETRS.tif for it (accurate to 1 m), or keep its datum with --t-srs EPSG:27700" offshore.vrt
result $? "degrees of one datum are not taken for those of another: refused, with what to do"
bake offshore.vrt --t-srs EPSG:27700 && unsaid && [ "$(field epsg)" = 27700 ]
result $? "and that works"
placed bare.asc china.vrt EPSG:4490 110 .001 30
refused "keep its datum with --t-srs EPSG:" china.vrt && bake china.vrt --t-srs "$(sed -n 's/.*--t-srs //p' bake.err)" && unsaid
result $? "also where no grid is known"
placed bare.asc afar.vrt EPSG:4258 100 .001 35
refused "name another system with gdal_translate -a_srs" afar.vrt && gdal_translate -q -of VRT -a_srs EPSG:4326 afar.vrt said.vrt && bake said.vrt && unsaid
result $? "and where there is no plane to stay on"
placed bare.asc sphere.vrt '+proj=sinu +R=6371007.181 +units=m' 2000 30 4000000
bake sphere.vrt --t-srs EPSG:32631 && noted "sphere.vrt names no datum that PROJ knows: its degrees are taken for those of WGS 84"
result $? "a sphere is no datum: its degrees are taken, and told"

# ---- images ----
gdalwarp -q -t_srs EPSG:26715 -r near nad27.vrt plane.tif # the datum stays
placed bare.ppm image.vrt EPSG:4267 -95.05 .00001 40.05
bake plane.tif --color image.vrt && unsaid && bake plane.tif --t-srs EPSG:32615 --color image.vrt && [ "$(grep -c '"NAD27 to WGS 84 (6)"' bake.err)" = 2 ]
result $? "an image is told by itself: not where it stays on its datum"
seen() { # (WEST-PERCENT NORTH-PERCENT RED GREEN)...: the whole ground's texture there, within 16
    python3 "$here/tests/whole_jpeg.py" OUT.ffp OUT.jpg && gdal_translate -q -of PNM OUT.jpg OUT.ppm && python3 -c 'import json, sys
b = json.load(open("bake.json"))
d = open("OUT.ppm", "rb").read()[-64 * 64 * 3:]
at = lambda percent, n: round(63 * percent / 100 * (n - 1) / (1 << b["tile_log2"]))
places = [int(v) for v in sys.argv[1:]]
for x, y, red, green in zip(*[iter(places)] * 4):
    i = ((63 - at(100 - y, b["samples_y"])) * 64 + at(x, b["samples_x"])) * 3
    if max(abs(d[i] - red), abs(d[i + 1] - green)) > 16:
        sys.exit("#   seen %s at %d, %d, wanted %d, %d" % (list(d[i:i + 3]), x, y, red, green))' "$@"
}
bake nad27.vrt --color image.vrt --tile-log2 7 --texture-levels 1 --texture-quality 95 --image-codec jpeg && seen 20 20 48 48 80 20 190 48 20 80 48 190
result $? "over heights on the same datum it goes their way"
placed bare.ppm offshore-image.vrt EPSG:4277 1.935 .001 50.3
gdal_translate -q -of VRT -a_srs EPSG:4326 offshore.vrt offshore84.vrt
refused "install uk_os_OSTN15_NTv2_OSGBtoETRS.tif for it (accurate to 1 m), or project it first with gdalwarp" offshore84.vrt --color offshore-image.vrt --quiet
result $? "and refused where nothing is known"

# ---- exports ----
placed bare.asc britain.vrt EPSG:27700 400000 1 300000
export_tiles() { timeout 60 "$BIN/farfield-export" OUT.ffp -o OUT.mbtiles --zoom 14 >/dev/null 2>bake.err; }
bake britain.vrt && unsaid && export_tiles && noted 'OUT.ffp: shifted from OSGB36 to WGS 84 by "OSGB36 to WGS 84 (6)", accurate to 2 m'
result $? "map tiles of a pack on another datum: the export tells"
bake offshore.vrt --t-srs EPSG:27700 && { ! export_tiles; } && [ "$(wc -l <bake.err)" = 1 ] && noted "or write .tif, .png or .r16, which stay on its datum" &&
    "$BIN/farfield-export" OUT.ffp -o OUT.tif --quiet
result $? "or refuses, and what it advises works"

exit $((failures > 0))
