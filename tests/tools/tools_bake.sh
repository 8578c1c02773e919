#!/bin/sh
# Script test of farfield-bake, -info and -export, on small rasters made here.
# Prints "ok - what" / "not ok - what"; reads programs from BIN; writes only under build/.
set -u
BIN=${BIN:-build/bin}
BIN=$(cd "$BIN" && pwd) || exit 1
BAKE=$BIN/farfield-bake INFO=$BIN/farfield-info EXPORT=$BIN/farfield-export
here=$(cd "$(dirname "$0")" && pwd)
DIR=$(pwd)/build/tests/tools_bake.$$
mkdir -p "$DIR" && cd "$DIR" || exit 1
trap 'rm -rf "$DIR"' EXIT
failures=0

check() { # check WHAT COMMAND...: the command must succeed
    what=$1
    shift
    if "$@" >check.out 2>&1; then
        echo "ok - $what"
    else
        echo "not ok - $what"
        sed 's/^/#   /' check.out | head -5
        failures=$((failures + 1))
    fi
}

refuses() { # refuses STATUS WHAT PATTERN COMMAND...: this exit status, one line on stderr with PATTERN, no OUT.ffp left
    status=$1 what=$2 pattern=$3
    shift 3
    rm -f OUT.ffp
    "$@" >refuse.out 2>refuse.err
    rc=$?
    if [ $rc -eq "$status" ] && [ "$(wc -l <refuse.err)" -eq 1 ] && grep -q "$pattern" refuse.err && [ ! -e OUT.ffp ] \
        && ! ls OUT.ffp.tmp-* .farfield-* >/dev/null 2>&1; then
        echo "ok - refused: $what"
    else
        echo "not ok - refused: $what (exit $rc)"
        sed 's/^/#   /' refuse.err | head -5
        failures=$((failures + 1))
    fi
}

field() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$2"; } # field NAME FILE: a number or word of flat JSON

# ---- rasters ----
python3 - <<'PY'
import math, struct
def h(x, y):
    return int(900 + 400 * math.sin(x / 17.0) * math.cos(y / 23.0) + 60 * math.sin(x / 3.1 + y / 5.3) + (x * 7919 + y * 104729) % 7)
def raw(name, w, hgt, f, fmt='<'):
    with open(name, 'wb') as out:
        for y in range(hgt):
            out.write(struct.pack(fmt + '%dH' % w, *[f(x, y) for x in range(w)]))
raw('plain.r16', 150, 131, h)
raw('plain.be', 150, 131, h, '>')
raw('cliff.r16', 40, 33, lambda x, y: 65535 if (x // 3 + y // 4) % 2 else 0)
raw('noise.r16', 700, 700, lambda x, y: (x * x * 2654435761 + y * 40503 * (x + 1)) >> 7 & 0xffff)
raw('five.r16', 5, 5, h)
def grid(name, w, hgt, head, f):
    with open(name, 'w') as out:
        out.write('ncols %d\nnrows %d\n%s' % (w, hgt, head))
        for y in range(hgt):
            out.write(' '.join(str(f(x, y)) for x in range(w)) + '\n')
place = 'xllcorner 500000\nyllcorner 4000000\ncellsize 30\nNODATA_value -9999\n'
grid('metric.asc', 90, 70, place, h)
grid('holes.asc', 90, 70, place, lambda x, y: -9999 if 20 <= x < 31 and 30 <= y < 40 else h(x, y))
grid('void.asc', 20, 20, place, lambda x, y: -9999)
grid('row.asc', 20, 1, place, h)
grid('float.asc', 64, 50, place, lambda x, y: '%.3f' % (h(x, y) / 7.0))
grid('absurd.asc', 40, 30, place, lambda x, y: 'nan' if x == 5 else '1e30' if x == 7 else '-inf' if x == 9 else '%.1f' % (100 + x / 2))
grid('south.asc', 120, 100, 'xllcorner -70.1\nyllcorner -33.1\ncellsize 0.001\nNODATA_value -9999\n', h)
grid('world.asc', 360, 180, 'xllcorner -180\nyllcorner -90\ncellsize 1\n', h)
open('world.prj', 'w').write('GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]')
with open('N45E006.hgt', 'wb') as out:
    for y in range(1201):
        out.write(struct.pack('>1201h', *[-32768 if x == 600 and y == 600 else 1000 + (x + y) // 8 for x in range(1201)]))
with open('image.ppm', 'wb') as out:  # red to the east, green to the north
    out.write(b'P6\n300 262\n255\n')
    for y in range(262):
        for x in range(300):
            out.write(bytes((x * 255 // 299, 255 - y * 255 // 261, 40)))
PY

compare() { # compare A.r16 B.r16 BOUND: same size, no sample further apart
    python3 - "$@" <<'PY'
import array, sys
a, b = (array.array('H', open(n, 'rb').read()) for n in sys.argv[1:3])
worst = max(abs(x - y) for x, y in zip(a, b))
print('sizes', len(a), len(b), 'worst', worst)
sys.exit(len(a) != len(b) or worst > int(sys.argv[3]))
PY
}

round_trip() { # round_trip RAW WxH BOUND OPTIONS...
    raw=$1 size=$2 bound=$3
    shift 3
    "$BAKE" "$raw" --raw "$size" --spacing 10 "$@" --quiet -o trip.ffp && "$EXPORT" trip.ffp -o trip.r16 \
        && "$INFO" --verify trip.ffp && compare "$raw" trip.r16 "$bound"
}

# ---- what must hold ----
check "lossless round trip is exact" round_trip plain.r16 150x131 0
codecs=$("$BAKE" plain.r16 --codec '?' -o OUT.ffp 2>&1 | sed -n 's/.*--codec: ? is not \(.*\)$/\1/p' | tr -d , | sed 's/ or / /')
radius_of() { # radius_of WANTED RASTER OPTIONS...: of the sphere that falls away like the pack's ground, in whole metres, within 10
    wanted=$1
    shift
    "$BAKE" "$@" --quiet -o curve.ffp && "$INFO" --json curve.ffp >curve.json && [ $(($(field effective_radius_m curve.json) - wanted)) -le 10 ] &&
        [ $(($(field effective_radius_m curve.json) - wanted)) -ge -10 ]
}
check "ground falls away as on the Earth, with refraction" radius_of 7322998 plain.r16 --raw 150x131 --spacing 10
check "with another refraction" radius_of 6371009 plain.r16 --raw 150x131 --spacing 10 --refraction 0
check "flat ground does not" radius_of 0 plain.r16 --raw 150x131 --spacing 10 --flat
gdal_translate -q -of VRT -a_srs '+proj=eqc +R=1737400 +units=m +no_defs' metric.asc moon.vrt
check "on the Moon as on the Moon, where light goes straight" radius_of 1737400 moon.vrt
check "codecs are told by name" test "$codecs" != "${codecs#raw deflate rice trained}"
codec_trip() {
    round_trip plain.r16 150x131 0 --codec "$1" && "$INFO" trip.ffp | grep -q "^codec  *$1\$" && "$INFO" --json trip.ffp >codec.json &&
        [ "$(field codec codec.json)" = "$1" ]
}
for codec in $codecs; do check "$codec codec round trip is exact, and told" codec_trip "$codec"; done
other_codec() { # the header with codec 200, its checksum made good
    python3 - <<'PY'
import struct, zlib
b = bytearray(open('trip.ffp', 'rb').read())
b[14] = 200
b[4092:4096] = struct.pack('<I', zlib.crc32(b[:4092]))
open('other.ffp', 'wb').write(b)
PY
}
other_codec
refuses 1 "a pack of an unknown codec" "codec 200 is not supported by this build" "$INFO" other.ffp
check "round trip over small tiles is exact" round_trip plain.r16 150x131 0 --tile-log2 4 --node-log2 2
check "round trip of the finest nodes is exact" round_trip plain.r16 150x131 0 --tile-log2 6 --node-log2 5
check "cliffs of 0 and 65535 round trip exactly" round_trip cliff.r16 40x33 0
check "noise round trips exactly" round_trip noise.r16 700x700 0
check "a 5 x 5 raster round trips exactly" round_trip five.r16 5x5 0
check "--max-error 4 keeps its bound" round_trip plain.r16 150x131 4 --max-error 4
check "--max-error 9 keeps its bound over small tiles" round_trip plain.r16 150x131 9 --max-error 9 --tile-log2 4
check "--max-error keeps its bound on cliffs" round_trip cliff.r16 40x33 25 --max-error 25
rms_bound() { # rms_bound METRES OPTIONS...: the root mean square is what is said, within METRES, and with one step of error more it is not
    wanted=$1
    shift
    "$BAKE" plain.r16 --raw 150x131 --spacing 10 "$@" --rms-error "$wanted" --quiet --json -o rms.ffp >rms.json && "$EXPORT" rms.ffp -o rms.r16 || return 1
    "$BAKE" plain.r16 --raw 150x131 --spacing 10 "$@" --max-error "$(($(field max_error_m rms.json) + 1))" --quiet --json -o more.ffp >more.json || return 1
    python3 - "$wanted" <<'PY'
import array, json, sys
wanted, told, more = float(sys.argv[1]), json.load(open('rms.json')), json.load(open('more.json'))
source, back = (array.array('H', open(name, 'rb').read()) for name in ('plain.r16', 'rms.r16'))
rms = (sum((a - b) ** 2 for a, b in zip(source, back)) / len(source)) ** 0.5
print('asked', wanted, 'told', told['rms_error_m'], 'is', rms, 'next', more['rms_error_m'])
assert told['max_error_m'] > 0 and told['rms_error_m'] <= wanted < more['rms_error_m']
assert abs(rms - told['rms_error_m']) < 0.02 * rms
PY
}
for rms in 1 3 12; do check "--rms-error $rms is kept, and no step is left" rms_bound $rms; done
check "--rms-error is kept over blocks and small tiles" rms_bound 3 --tile-log2 4
"$BAKE" plain.r16 --raw 150x131 --spacing 10 --max-error 60000 --quiet --json -o rms.ffp >rms.json # errors that no bound makes larger
far=$(python3 -c "print($(field rms_error_m rms.json) * 1.0001)")
check "--rms-error ends where errors do not grow with their bound" timeout 60 "$BAKE" plain.r16 --raw 150x131 --spacing 10 --rms-error "$far" --quiet -o rms.ffp
check "--rms-error below a step is lossless" round_trip plain.r16 150x131 0 --rms-error 0.3
refuses 2 "--rms-error beside --max-error" "rms-error chooses --max-error" "$BAKE" plain.r16 --raw 150x131 --rms-error 1 --max-error 1 -o OUT.ffp
for steps in 0.1:10 0.05:20 0.3:3 0.01:100; do
    "$BAKE" plain.r16 --raw 150x131 --spacing 10 --hscale "${steps%:*}" --max-error 1 --quiet -o lossy.ffp
    check "--max-error 1 is ${steps#*:} steps of ${steps%:*} m" sh -c '"$1" --json lossy.ffp | grep -q "\"max_error\": $2,"' sh "$INFO" "${steps#*:}"
done
"$BAKE" plain.r16 --raw 150x131 --spacing 10 --max-error 4 --quiet -o lossy.ffp
"$EXPORT" lossy.ffp -o lossy.r16
check "--max-error 4 does leave something out" sh -c '! cmp -s lossy.r16 plain.r16'

big_endian() {
    "$BAKE" plain.be --raw 150x131:be --spacing 10 --quiet -o be.ffp && "$EXPORT" be.ffp -o be.r16 && cmp be.r16 plain.r16
}
check "big-endian raw input" big_endian

png_trip() {
    "$BAKE" plain.r16 --raw 150x131 --spacing 10 --quiet -o p.ffp && "$EXPORT" p.ffp -o p.png \
        && "$BAKE" p.png --hscale 0.1 --spacing 10 --quiet -o q.ffp && "$EXPORT" q.ffp -o q.r16 && cmp q.r16 plain.r16
}
check "16-bit PNG out and in again, --hscale told: units stay steps" png_trip

tiff_trip() {
    "$BAKE" metric.asc --quiet -o m.ffp && "$EXPORT" m.ffp -o m.tif && "$BAKE" m.tif --quiet -o m2.ffp \
        && "$EXPORT" m.ffp -o m.r16 && "$EXPORT" m2.ffp -o m2.r16 && cmp m.r16 m2.r16 && "$INFO" --json m2.ffp >m2.json \
        && [ "$(field spacing_m m2.json)" = 30 ] && [ "$(field origin_x_mm m2.json)" = 500015000 ]
}
check "GeoTIFF out and in again keeps samples, spacing and origin" tiff_trip

same_bytes() {
    for jobs in 1 2 5; do
        "$BAKE" plain.r16 --raw 150x131 --spacing 10 --color image.ppm --tile-log2 5 --jobs $jobs --quiet -o jobs$jobs.ffp || return 1
    done
    "$BAKE" south.asc --jobs 1 --quiet -o south1.ffp && "$BAKE" south.asc --jobs 4 --quiet -o south4.ffp || return 1
    cmp jobs1.ffp jobs2.ffp && cmp jobs1.ffp jobs5.ffp && cmp south1.ffp south4.ffp
}
check "same bytes for any number of jobs, projected or not" same_bytes

one_tile() { # 1193 x 1041 samples: a tile of 2^11, four blocks
    big="plain.r16 --raw 150x131 --spacing 80 --densify 8 --color image.ppm --quiet --json"
    for jobs in 1 3; do "$BAKE" $big --jobs $jobs -o one$jobs.ffp >one.json || return 1; done
    cmp one1.ffp one3.ffp && [ "$(field tile_log2 one.json)" = 11 ] && [ "$(field tiles_x one.json)$(field tiles_y one.json)" = 11 ] \
        && "$INFO" --verify one1.ffp >/dev/null && "$BAKE" $big --tile-log2 8 -o grid.ffp >grid.json \
        && [ "$(field tiles_x grid.json)$(field tiles_y grid.json)" = 55 ] && "$EXPORT" one1.ffp -o one.r16 && "$EXPORT" grid.ffp -o grid.r16 \
        && cmp one.r16 grid.r16
}
check "a ground is one tile by default, whole however many blocks and jobs make it" one_tile

levels() {
    "$EXPORT" jobs1.ffp --level 0 -o l0.r16 && [ "$(wc -c <l0.r16)" -eq $((2 * 38 * 33)) ] \
        && python3 -c '
import array
a=array.array("H",open("l0.r16","rb").read()); b=array.array("H",open("plain.r16","rb").read())
assert all(a[j*38+i]==b[(130-4*(32-j))*150+4*i] for j in range(33) for i in range(38))'
}
check "--level 0 exports every fourth sample" levels

voids() {
    "$BAKE" holes.asc --json -o holes.ffp >holes.json 2>holes.err && [ "$(field voids holes.json)" = 110 ] \
        && grep -q "110 of 6300 samples are void" holes.err && [ "$(field height_min_m holes.json | cut -d. -f1)" -gt 0 ]
}
check "voids are filled and counted" voids

absurd() {
    "$BAKE" absurd.asc --json -o absurd.ffp >absurd.json 2>/dev/null && [ "$(field voids absurd.json)" = 90 ] \
        && [ "$(field height_max_m absurd.json)" = 119.5 ] && [ "$(field height_min_m absurd.json)" = 100 ]
}
check "NaN, infinite and absurd heights are voids" absurd

upside_down() { # a raster whose first row is the southern one comes out north-up
    gdal_translate -q -of VRT -a_srs EPSG:32613 -a_ullr 500000 4002100 502700 4000000 metric.asc up.vrt \
        && sed 's/4.002100[0-9e+]*, *0.0[0-9e+]*, *-3.0*[0-9e+]*/4.0000000000000000e+06, 0.0, 30.0/' up.vrt >down.vrt \
        && "$BAKE" down.vrt --quiet -o down.ffp && "$EXPORT" down.ffp -o down.r16 && "$BAKE" up.vrt --quiet -o up.ffp \
        && "$EXPORT" up.ffp -o up.r16 && python3 -c '
a,b=(open(n,"rb").read() for n in ("up.r16","down.r16"))
assert a==b"".join(b[180*y:180*y+180] for y in reversed(range(70)))'
}
check "rasters with their first row south come out the right way" upside_down

filled_well() { # known samples stay, filled ones lie within the range of the rest
    "$EXPORT" holes.ffp -o holes.r16 && "$BAKE" metric.asc --quiet -o whole.ffp && "$EXPORT" whole.ffp -o whole.r16 && python3 -c '
import array
a=array.array("H",open("holes.r16","rb").read()); b=array.array("H",open("whole.r16","rb").read())
for y in range(70):
    for x in range(90):
        void = 20<=x<31 and 30<=y<40
        assert void or a[y*90+x]==b[y*90+x], (x,y)
        assert not void or abs(a[y*90+x]-b[y*90+x]) < 300, (x,y,a[y*90+x],b[y*90+x])'
}
check "known samples stay, filled ones follow their surroundings" filled_well

# ---- filled ground is told ----
seen_filled() { # PACK: percent of the ground seen from straight above that may be filled
    printf 't_s,x_m,y_m,z_m,pitch_deg\n0,1000,1000,6000,-90\n9,1000,1000,6000,-90\n' >above.csv
    "$BIN/farfield-fly" --pack "$1" --path above.csv --backend none --link lan --seconds 1 --settle 1 --audit on --audit-step 2 --json 2>/dev/null |
        sed -n 's/.*"filled_px_percent": \([0-9.]*\).*/\1/p'
}
told() { # voids are about 2 % of these: told by nodes, so more, but not all; nothing is told of whole ground
    gdal_translate -q -a_srs EPSG:4326 -a_ullr -70 -33 -69.97 -33.0233 holes.asc degrees.tif && "$BAKE" degrees.tif --quiet -o degrees.ffp &&
        [ "$(seen_filled whole.ffp)" = 0.000 ] || return 1
    for pack in holes degrees; do
        seen_filled $pack.ffp | awk -v pack=$pack '{ print pack, $1; bad = $1 < 2 || $1 > 20 } END { exit NR != 1 || bad }' || return 1
    done
}
check "filled voids are told from measured ground, projected or not" told

south() {
    "$BAKE" south.asc --json -o south.ffp >south.json 2>south.err && [ "$(field epsg south.json)" = 32719 ] \
        && grep -q "taken as WGS84" south.err && [ "$(field outside south.json)" -gt 0 ] && "$INFO" --verify south.ffp
}
check "southern degrees are projected to UTM 19 south" south

south_place() { # the export, looked at in degrees again, lies where the source lies, and shows its heights
    "$EXPORT" south.ffp -o south.tif && gdallocationinfo -valonly -wgs84 south.tif -70.04 -33.05 >south.z \
        && gdallocationinfo -valonly -geoloc south.asc -70.04 -33.05 >source.z \
        && python3 -c 'a,b=(float(open(n).read()) for n in ("south.z","source.z")); assert abs(a-b)<60,(a,b)'
}
check "projected ground lies where its source lies" south_place

hgt() {
    "$BAKE" N45E006.hgt --json --tile-log2 9 -o hgt.ffp >hgt.json 2>/dev/null && [ "$(field epsg hgt.json)" = 32632 ] \
        && [ "$(field voids hgt.json)" = 1 ] && [ "$(field hscale_m hgt.json)" = 1 ]
}
check "SRTM .hgt is read, its void found, metres kept" hgt

float_steps() {
    "$BAKE" float.asc --json -o float.ffp >float.json 2>/dev/null && "$EXPORT" float.ffp -o float.tif \
        && gdal_translate -q -unscale -ot Float64 -of AAIGrid float.tif back.asc && python3 -c '
import itertools
rows=lambda n:[float(v) for l in open(n) if l.strip() and not l[0].isalpha() for v in l.split()]
a,b=rows("float.asc"),rows("back.asc")
assert len(a)==len(b)==3200 and max(abs(x-y) for x,y in zip(a,b))<=0.006,max(abs(x-y) for x,y in zip(a,b))'
}
check "float heights keep to half a step" float_steps

resampled() {
    "$BAKE" metric.asc --spacing 60 --json -o r.ffp >r.json 2>/dev/null && [ "$(field spacing_m r.json)" = 60 ] && [ "$(field samples_x r.json)" = 45 ]
}
check "--spacing resamples a placed raster" resampled

densified() {
    "$BAKE" plain.r16 --raw 150x131 --spacing 16 --hscale 0.5 --densify 4 --json -o d.ffp >d.json 2>/dev/null && [ "$(field samples_x d.json)" = 597 ] \
        && "$EXPORT" d.ffp -o d.r16 && python3 -c '
import array
a=array.array("H",open("d.r16","rb").read()); b=array.array("H",open("plain.r16","rb").read())
assert all(a[4*y*597+4*x]==b[y*150+x] for y in range(131) for x in range(150))
assert len(set(a)) > len(set(b))'
}
check "--densify keeps every sample and invents some" densified

textured() {
    "$INFO" --json jobs1.ffp >t.json && [ "$(field texture_levels t.json)" -ge 1 ] && [ "$(field texture_bytes t.json)" -gt 0 ]
}
check "an image becomes textures" textured

right_way_up() { # the root's texture: red grows to the east, green to the north
    "$BAKE" plain.r16 --raw 150x131 --spacing 10 --color image.ppm --tile-log2 8 --texture-quality 95 --image-codec jpeg --quiet -o up.ffp \
        && python3 "$here/../whole_jpeg.py" up.ffp up.jpg \
        && gdal_translate -q -of PNM up.jpg up.ppm && python3 -c '
d=open("up.ppm","rb").read()[-64*64*3:]
px=lambda row,column: d[(row*64+column)*3:(row*64+column)*3+3]
edge=(149*63)//256  # the image ends with the ground; beyond it the rim is repeated
assert px(63,0)[0]<16 and px(63,edge)[0]>235 and px(63,63)[0]>235, [px(63,i)[0] for i in (0,edge,63)]
assert px(63,0)[1]<16 and px(0,0)[1]>239 and px(63-(130*63)//256,0)[1]>232, [px(i,0)[1] for i in (63,0)]'
}
check "textures lie as their ground does" right_way_up

ends_with_the_image() { # over half of the ground: beyond it the ground has colours of its own
    gdal_translate -q -of GTiff -a_srs EPSG:4326 -a_ullr -70.09 -33.01 -70.04 -33.09 image.ppm half.tif \
        && "$BAKE" south.asc --color half.tif --texture-levels 1 --texture-quality 95 --image-codec jpeg --quiet -o half.ffp \
        && python3 "$here/../whole_jpeg.py" half.ffp half.jpg \
        && gdal_translate -q -of PNM half.jpg half.ppm \
        && python3 -c 'd=open("half.ppm","rb").read()[-64*64*3:]
blue = [[d[3 * (64 * y + x) + 2] for y in range(16, 48) for x in range(left, left + 16)] for left in (10, 40)]
inside, beyond = (sum(some) / len(some) for some in blue)  # of the image 40 everywhere
assert 36 < inside < 44 and beyond > 70, (inside, beyond)'
}
check "ground that an image does not cover has its own colours" ends_with_the_image

# ---- what must be refused ----
refuses 1 "one row" "at least 2 rows" "$BAKE" row.asc -o OUT.ffp
refuses 1 "voids only" "not one valid height" "$BAKE" void.asc -o OUT.ffp
refuses 1 "no georeference" "no georeference: give --spacing" "$BAKE" plain.r16 --raw 150x131 -o OUT.ffp
refuses 1 "a raw file of another size" "needs 40000" "$BAKE" plain.r16 --raw 200x100 --spacing 1 -o OUT.ffp
refuses 1 "a missing raster" "cannot read" "$BAKE" nowhere.tif -o OUT.ffp
refuses 1 "a foreign file as raster" "cannot read" "$BAKE" t.json -o OUT.ffp
refuses 1 "a world in one UTM zone" "too wide for a UTM zone" "$BAKE" world.asc -o OUT.ffp
refuses 1 "an unwritable output" "cannot write" "$BAKE" metric.asc -o nowhere/OUT.ffp
refuses 1 "a directory as output" "not a plain file" "$BAKE" metric.asc -o .
cp metric.asc same.asc
refuses 1 "its own input as output" "is the input" "$BAKE" same.asc -o ./same.asc
refuses 2 "no output" "OUT.ffp is missing" "$BAKE" metric.asc
refuses 2 "an unknown option" "unknown option --frobnicate" "$BAKE" metric.asc --frobnicate -o OUT.ffp
refuses 2 "an absurd spacing" "number from" "$BAKE" metric.asc --spacing 1e9 -o OUT.ffp
refuses 2 "spacing that is not a number" "number from" "$BAKE" metric.asc --spacing nan -o OUT.ffp
refuses 1 "too coarse a spacing" "too coarse" "$BAKE" metric.asc --spacing 5000 -o OUT.ffp
refuses 1 "too fine a step" "span more than 65536 steps" "$BAKE" metric.asc --hscale 0.001 -o OUT.ffp
refuses 1 "a missing image" "cannot read" "$BAKE" metric.asc --color nowhere.png -o OUT.ffp
gdal_translate -q -of GTiff -a_srs EPSG:4326 -a_ullr 10 50 11 49 image.ppm far.tif
refuses 1 "an image of other ground" "image" "$BAKE" south.asc --color far.tif --quiet -o OUT.ffp
refuses 2 "densify by three" "power of two" "$BAKE" metric.asc --densify 3 -o OUT.ffp
refuses 1 "an unknown ending" "ending must be" "$EXPORT" jobs1.ffp -o OUT.xyz
refuses 1 "a level the pack has not" "has levels 0 to" "$EXPORT" jobs1.ffp --level 12 -o OUT.tif
head -c 9000 jobs1.ffp >cut.ffp
refuses 1 "a truncated pack" "cut.ffp: data ends too early" "$INFO" cut.ffp
refuses 1 "a foreign pack" "not a Farfield file" "$INFO" plain.r16
refuses 1 "an empty pack" "empty.ffp: data ends too early" sh -c ": >empty.ffp; exec $INFO empty.ffp"

flip() { # flip FILE OFFSET: inverts one byte
    python3 -c 'import sys; d=bytearray(open(sys.argv[1],"rb").read()); d[int(sys.argv[2])]^=255; open(sys.argv[1],"wb").write(d)' "$1" "$2"
}
cp jobs1.ffp flip.ffp && flip flip.ffp 40
refuses 1 "a damaged header" "checksum mismatch" "$INFO" flip.ffp
cp jobs1.ffp flip.ffp && flip flip.ffp $(($(wc -c <flip.ffp) - 100))
refuses 1 "a damaged record, by --verify" "damaged records" "$INFO" --verify flip.ffp

# ---- a full disk ----
full() { # full COMMAND...: exit 1 and one line that says what was not written
    "$@" 2>full.err
    rc=$?
    [ $rc = 1 ] && [ "$(grep -c "cannot write" full.err)" = 1 ] || { echo "$* (exit $rc)"; cat full.err; return 1; }
}
fly() { "$BIN/farfield-fly" --pack whole.ffp --backend none --seconds 2 --settle 1 "$@"; }
full_disk() {
    full fly --csv /dev/full && full sh -c "'$BAKE' metric.asc --quiet --json -o full.ffp >/dev/full" && full sh -c "'$INFO' whole.ffp >/dev/full" &&
        full sh -c "'$INFO' --json whole.ffp >/dev/full" && full sh -c "'$BIN/farfield-fly' --pack whole.ffp --backend none --seconds 2 --settle 1 --json >/dev/full" &&
        full sh -c "'$BIN/farfield-report' fly.csv -o full.d --json >/dev/full" &&
        for program in bake info export fly report server view handheld link; do
            full sh -c "'$BIN/farfield-$program' --help >/dev/full" || return 1
        done
}
fly --csv fly.csv 2>/dev/null
check "a result that does not fit on the disk is an error, in every program" full_disk

# ---- killed half-way ----
killed() {
    : >OUT.ffp.tmp-4194305 # left behind by a run that is no more: no process has this number
    for pause in 0.02 0.1 0.2 0.4; do
        "$BAKE" noise.r16 --raw 700x700 --spacing 1 --quiet -o OUT.ffp &
        pid=$!
        sleep $pause
        kill -9 $pid 2>/dev/null
        wait $pid 2>/dev/null
        if [ -e OUT.ffp ]; then "$INFO" --verify OUT.ffp || return 1; fi
        rm -f OUT.ffp
    done
    "$BAKE" noise.r16 --raw 700x700 --spacing 1 --quiet -o OUT.ffp && "$INFO" --verify OUT.ffp || return 1
    ! ls OUT.ffp.tmp-* .farfield-* 2>/dev/null
}
check "killed with -9 it leaves no broken pack; the next run cleans up" killed

for program in "$BAKE" "$INFO" "$EXPORT"; do
    check "$(basename "$program") --help and --version" sh -c "$program --help | grep -q Usage && $program --version | grep -q '[0-9]'"
done
[ $failures -eq 0 ]
