#!/bin/bash
# Script test of farfield-export --mesh: Cesium's own reader (npm's @cesium/engine, in node) reads the meshes, and their heights are the
# pack's within the error that layer.json states. Skipped where there is no node, or the package can neither be found (CESIUM=DIR that has
# node_modules, build/cesium) nor fetched; what needs no reader is tried all the same. PACK=FILE: another pack instead of the small ones.
# Prints "ok - what" / "not ok - what"; reads programs from BIN; writes only under build/.
set -u
BIN=$(cd "${BIN:-build/bin}" && pwd) || exit 1
# shellcheck source=../rig/result.bash
. tests/rig/result.bash
here=$PWD DIR=$PWD/build/tests/export_mesh.$$
cesium=${CESIUM:-$here/build/cesium}
mkdir -p "$DIR" && cd "$DIR" || exit 1
trap 'rm -rf "$DIR"' EXIT

refused() { # PATTERN ARGUMENTS...: in one line, and no folder is left
    local pattern=$1
    shift
    "$BIN/farfield-export" "$@" 2>err
    [ $? != 0 ] && [ "$(wc -l <err)" = 1 ] && grep -q -- "$pattern" err && [ ! -e meshes ]
}

python3 "$here/tests/rig/hills.py" 400:fractal ground.r16
gdal_translate -q -of GTiff -a_srs EPSG:32633 -a_ullr 500000 5212000 512000 5200000 \
    "<VRTDataset rasterXSize=\"400\" rasterYSize=\"400\"><VRTRasterBand dataType=\"UInt16\" band=\"1\" subClass=\"VRTRawRasterBand\"><SourceFilename>ground.r16</SourceFilename><LineOffset>800</LineOffset><ByteOrder>LSB</ByteOrder></VRTRasterBand></VRTDataset>" ground.tif
"$BIN/farfield-bake" ground.tif --max-error 1 --quiet -o ground.ffp
result $? "a pack is made"

/usr/bin/python3 - <<'PY' # a small ground across 180 degrees
import array, math
from osgeo import gdal, osr
gdal.UseExceptions()
degrees, plane = osr.SpatialReference(), osr.SpatialReference()
degrees.ImportFromEPSG(4326)
plane.ImportFromEPSG(32601)
degrees.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
x, y, _ = osr.CoordinateTransformation(degrees, plane).TransformPoint(180.0, 68.0)
raster = gdal.GetDriverByName('GTiff').Create('across.tif', 200, 150, 1, gdal.GDT_Int16)
raster.SetProjection(plane.ExportToWkt())
raster.SetGeoTransform([round(x) - 6000, 60, 0, round(y) + 4500, 0, -60])
heights = [int(500 + 300 * math.sin(i / 20) * math.cos(j / 17)) for j in range(150) for i in range(200)]
raster.GetRasterBand(1).WriteRaster(0, 0, 200, 150, array.array('h', heights).tobytes())
PY
"$BIN/farfield-bake" across.tif --quiet -o across.ffp
result $? "and one of ground across 180 degrees"

refused "end its name in a slash" ground.ffp --mesh -o meshes
result $? "meshes go to a folder"
refused "--zoom 0-9" ground.ffp --mesh --zoom 5-9 -o meshes/
result $? "and begin at zoom 0"
refused "are for --mesh" ground.ffp --normals -o meshes/
result $? "options of meshes are for meshes"

get_cesium() { # 0, or why there is none
    command -v node >/dev/null || { echo "no node"; return 1; }
    [ -d "$cesium/node_modules/@cesium/engine" ] && return 0
    command -v npm >/dev/null || { echo "no @cesium/engine, and no npm to fetch it with"; return 1; }
    timeout 150 npm install --silent --no-audit --no-fund --prefix "$cesium" @cesium/engine@24 >/dev/null 2>&1 && return 0
    rm -rf "$cesium"
    echo "npm cannot fetch @cesium/engine"
    return 1
}

points_of() { # PACK: samples of its finest level, as longitude, latitude, metres, and metres to the rim
    "$BIN/farfield-export" "$1" --quiet -o points.tif && /usr/bin/python3 - <<'PY'
from osgeo import gdal, osr
gdal.UseExceptions()
raster = gdal.Open('points.tif')
band, gt = raster.GetRasterBand(1), raster.GetGeoTransform()
degrees = osr.SpatialReference()
degrees.ImportFromEPSG(4326)
degrees.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
plane = raster.GetSpatialRef()
plane.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
to_degrees = osr.CoordinateTransformation(plane, degrees)
steps, scale, offset = band.ReadAsArray(), band.GetScale() or 1, band.GetOffset() or 0
stride = max(3, int((raster.RasterXSize * raster.RasterYSize / 20000) ** 0.5))
with open('points', 'w') as out:
    for j in range(0, raster.RasterYSize, stride):
        for i in range(0, raster.RasterXSize, stride):
            x, y, _ = to_degrees.TransformPoint(gt[0] + gt[1] * (i + 0.5), gt[3] + gt[5] * (j + 0.5))
            rim = min(i, j, raster.RasterXSize - 1 - i, raster.RasterYSize - 1 - j) * gt[1]
            out.write('%.10f %.10f %.4f %.1f\n' % (x, y, steps[j, i] * scale + offset, rim))
PY
}

read_by_cesium() { # PACK METRES EXPORT-OPTIONS...: the finest zoom states METRES at most ("": anything)
    local pack=$1 finest=$2
    shift 2
    rm -rf meshes
    "$BIN/farfield-export" "$pack" --mesh "$@" --quiet -o meshes/ && points_of "$pack" && node "$here/tests/tools/export_mesh.mjs" "$cesium" meshes points $finest >said
    local rc=$?
    grep '^not ok\|^#\|^ok' said | sed "s/^ok - /ok - $(basename "$pack") $*: /; s/^not ok - /not ok - $(basename "$pack") $*: /"
    failures=$((failures + $(grep -c '^not ok' said)))
    return $rc
}

"$BIN/farfield-export" ground.ffp --mesh --quiet -o once/ && "$BIN/farfield-export" ground.ffp --mesh --quiet -o twice/ && diff -r once twice
result $? "the same pack makes the same bytes"
same_unpacked() {
    "$BIN/farfield-export" ground.ffp --mesh --quiet --gzip -o packed/ || return 1
    for tile in $(cd once && find . -name '*.terrain'); do gzip -dc "packed/$tile" | cmp -s - "once/$tile" || return 1; done
}
same_unpacked
result $? "--gzip packs what is the same otherwise"

if why=$(get_cesium); then
    if [ -n "${PACK:-}" ]; then
        read_by_cesium "$PACK" ""
    else
        read_by_cesium ground.ffp 9
        result $? "Cesium reads plain meshes"
        read_by_cesium ground.ffp 8 --normals --gzip --mesh-error 2
        result $? "and packed ones with normals, closer to the ground"
        read_by_cesium across.ffp 10
        result $? "and those of ground across 180 degrees"
    fi
else
    echo "ok - Cesium reads the meshes # skip $why"
fi
exit $((failures > 0))
