#!/bin/bash
# Script test of farfield-bake --estimate: what it tells of a bake beforehand is near what the bake tells of itself, and no pack is written.
# Prints "ok - what" / "not ok - what"; reads programs from BIN; writes only under build/.
set -u
BIN=$(cd "${BIN:-build/bin}" && pwd) || exit 1
# shellcheck source=../rig/result.bash
. tests/rig/result.bash
here=$PWD DIR=$PWD/build/tests/bake_estimate.$$
mkdir -p "$DIR" && cd "$DIR" || exit 1
trap 'rm -rf "$DIR"' EXIT

field() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$2"; } # NAME FILE: a number or word of flat JSON

near() { # PERCENT BAKE-ARGUMENTS...: the size told is that near the pack's, and what can be known is known
    local percent=$1 name
    shift
    rm -f OUT.ffp
    "$BIN/farfield-bake" "$@" --estimate -o OUT.ffp --quiet --json >told.json || return 1
    [ ! -e OUT.ffp ] || { echo "#   a pack is there"; return 1; }
    "$BIN/farfield-bake" "$@" -o OUT.ffp --quiet --json >made.json || return 1
    for name in samples_x samples_y spacing_m hscale_m max_error_m tiles_x tiles_y tile_log2 node_log2 epsg texture_levels; do
        [ "$(field $name told.json)" = "$(field $name made.json)" ] || { echo "#   $name: $(field $name told.json), not $(field $name made.json)"; return 1; }
    done
    awk -v told="$(field file_bytes told.json)" -v made="$(field file_bytes made.json)" -v percent="$percent" \
        'BEGIN { off = 100 * (told / made - 1); printf "#   %d, made %d: %+.1f %%\n", told, made, off; exit !(off >= -percent && off <= percent) }'
}

python3 "$here/tests/rig/hills.py" 700:hills hills.r16 700:fractal fractal.r16 500:plateaus plateaus.r16 130:fractal small.r16
python3 - <<'PY'
import struct
# Half of it is sea, and the other half rough; and an image whose texture changes from the west to the east.
land = struct.unpack('<490000H', open('fractal.r16', 'rb').read())
with open('coast.r16', 'wb') as out:
    for y in range(700):
        out.write(struct.pack('<700H', *(0 if x + y // 4 < 400 else land[700 * y + x] for x in range(700))))
with open('image.ppm', 'wb') as out:
    out.write(b'P6\n700 700\n255\n')
    for y in range(700):
        out.write(bytes(v for x in range(700) for v in ((x * y // (701 - x)) % 256, x * 255 // 700, 255 - y * 255 // 700)))
head = 'ncols 400\nnrows 400\nxllcorner 7\nyllcorner 46\ncellsize 0.001\n'
with open('degrees.asc', 'w') as out:
    out.write(head + '\n'.join(' '.join(str(land[700 * y + x]) for x in range(400)) for y in range(400)) + '\n')
open('degrees.prj', 'w').write('GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]]')
PY
raw=(--raw 700x700 --spacing 10)
for error in 0 1 4; do
    for ground in hills fractal coast; do
        near 10 $ground.r16 "${raw[@]}" --max-error $error
        result $? "of $ground with an error of $error m the size is told within a tenth"
    done
done
"$BIN/farfield-bake" coast.r16 "${raw[@]}" --max-error 1 --estimate --quiet --json >told.json &&
    awk -v bytes="$(field file_bytes told.json)" -v high="$(field file_bytes_high told.json)" 'BEGIN { exit !(high < 1.12 * bytes) }'
result $? "half sea makes the range no wider than 12 %, since roughness is known of all ground"
near 10 plateaus.r16 --raw 500x500 --spacing 10 --codec rice --node-log2 4
result $? "with another codec and larger nodes, too"
near 10 degrees.asc --max-error 1
result $? "of projected ground, too"
near 12 hills.r16 "${raw[@]}" --color image.ppm --max-error 1
result $? "with an image, too"
near 12 plateaus.r16 --raw 500x500 --spacing 10 --densify 2 --max-error 1
result $? "with invented detail, too"
near 0.6 small.r16 --raw 130x130 --spacing 10
result $? "small ground is made as a whole: its size is exact"
[ "$(field share told.json)" = 1.0000 ]
result $? "and it says so"

"$BIN/farfield-bake" fractal.r16 "${raw[@]}" --estimate --quiet --json >told.json 2>err && [ ! -s err ] &&
    awk -v share="$(field share told.json)" -v low="$(field file_bytes_low told.json)" -v bytes="$(field file_bytes told.json)" \
        -v high="$(field file_bytes_high told.json)" 'BEGIN { exit !(share < 0.2 && low < bytes && bytes < high) }'
result $? "no OUT is needed, less than a fifth of the ground is made, and the size has a range"
"$BIN/farfield-bake" fractal.r16 "${raw[@]}" --estimate --jobs 2 >told.txt && grep -q '^pack .* kB, likely' told.txt && grep -q '^time .* this machine, 2 jobs' told.txt &&
    grep -q '^memory .* MiB of disk' told.txt
result $? "in words, with time and memory"
"$BIN/farfield-bake" --estimate 2>err
[ $? = 2 ] && [ "$(wc -l <err)" = 1 ] && grep -q 'HEIGHTS is missing' err
result $? "the ground is needed"
[ -z "$(find . -name '.farfield-*')" ]
result $? "nothing is left behind"
exit $((failures > 0))
