#!/bin/bash
# hashes.sh BIN WORK: bakes three terrains and flies ten flights over them in simulated time. Prints the packs' hashes, and for each flight
# those of its geometry, requests, pictures and CSV; two flights go on tape and are flown again by the handheld's client. Two builds that
# print the same lines bake, send, draw and judge the same: for a change that should change nothing. About a minute.
set -eu
bin=$1 work=$2 here=$(dirname "$0")
mkdir -p "$work"
[ -f "$work/ground.raw" ] || "$here/bench_terrain.py" "$work"
"$bin/farfield-bake" "$work/ground.raw" --raw 2049x2049 --scale 0.1 --spacing 50 --quiet --color "$work/ground.ppm" --texture-levels 4 \
    -o "$work/ground.ffp"
"$bin/farfield-bake" "$work/ground.raw" --raw 2049x2049 --scale 0.1 --spacing 10 --codec rice --max-error 2 --quiet -o "$work/rice.ffp"
dem=$("$here/trinidad.sh" "$work")
"$bin/farfield-bake" "$dem" --scale 0.3048780488 --quiet -o "$work/trinidad.ffp"
(cd "$work" && md5sum ground.ffp rice.ffp trinidad.ffp | awk '{ print $2, $1 }')
fly() { # NAME PACK OPTION...
    local name=$1 pack=$2
    shift 2
    "$bin/farfield-fly" --pack "$work/$pack.ffp" --seconds 40 --settle 10 --json --csv "$work/$name.csv" "$@" >"$work/$name.json" 2>/dev/null
    printf '%s' "$name"
    for key in geometry request frame; do
        printf ' %s' "$(sed -n 's/.*"'$key'_hash": "\([0-9a-f]*\)".*/\1/p' "$work/$name.json")"
    done
    printf ' %s' "$(md5sum <"$work/$name.csv" | cut -c1-16)"
    [ ! -f "$work/$name.tape" ] || printf ' tape=%s' "$(md5sum <"$work/$name.tape" | cut -c1-16)"
    echo
}
fly 01 ground --link umts --backend gl --speed 150
fly 02 ground --link gprs --backend gles1 --speed 750 --start 0.3 --audit on
fly 03 ground --link lan --backend soft565 --quality paper-high --speed 1000
fly 04 trinidad --link gprs --backend soft565 --quality px:2 --audit on
fly 05 trinidad --link umts --backend gl --quality px:1 --panorama off --view 100000
fly 06 trinidad --link nbiot --backend soft565 --balance 5000 --quality paper-high
fly 07 rice --link edge --backend soft --path turn --height 20 --memory 1M
fly 08 rice --link iridium --backend gles1 --path circle --balance 3000,4000 --event 20:cut --event 30:low-battery
fly 09 ground --link umts --backend soft565 --path hover --tape "$work/09.tape"
fly 10 trinidad --link gprs --backend soft565 --tape "$work/10.tape"
for n in 09 10; do
    "$bin/farfield-handheld" --tape "$work/$n.tape" --hash | grep -E 'hash|frames_drawn' | tr '\n' ' '; echo
done
