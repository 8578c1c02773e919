#!/bin/bash
# handheld.sh PROGRAM HOSTBIN OBJECTS [FEATURE LEFT OUT...]: the cross-built client, checked and flown under qemu-arm: its core has no
# floating point; over a pack, over a tape and against a real server (both on this machine) it does what the client built for this
# machine does. Prints "ok - what" / "not ok - what" lines. Work files in build/handheld/work.
set -u
program=$1 host=$2 objects=$3 features=" $4 "
shift 4
without=" $* "
qemu=(qemu-arm -cpu arm1136)
work=build/handheld/work
mkdir -p "$work"
server_pid=
trap '[ -z "$server_pid" ] || kill "$server_pid"' EXIT
. tests/rig/result.bash
value() { grep -E "^$1 " "$2" | awk '{ print $2 }'; } # NAME FILE: a figure of a flight
has() { # FEATURE: this build has it
    [[ $features == *" $1 "* ]] || { echo "handheld.sh: no feature is called $1 (features.mk)" >&2; exit 2; }
    [[ $without != *" $1 "* ]]
}

mapfile -t core < <(find "$objects"/{protocol,client,common3d,platform/options,sim/options,sim/handheld} -name '*.o')
counted=$(tools/scripts/check-no-float.sh arm-linux-gnueabi- "${core[@]}")
result $? "the core and the command line have neither floating-point instructions nor helpers ($counted)"
! arm-linux-gnueabi-readelf -A "$program" | grep -q 'Tag_ABI_VFP_args' && [ "$(arm-linux-gnueabi-readelf -h "$program" | grep -c 'soft-float')" = 1 ]
result $? "the program is static, for armv6, soft float"

python3 tests/rig/hills.py 257 "$work/hills.raw"
python3 - "$work" <<'END'
import struct, sys
n = 257
heights = struct.unpack("<%dH" % (n * n), open(sys.argv[1] + "/hills.raw", "rb").read())
rgb = bytearray()
for y in range(n):
    for x in range(n):
        h = heights[y * n + x] * 255 // 1300
        rgb += bytes((h // 2 + 40 + (x ^ y) % 16, 90 + h // 3, h // 2))
open(sys.argv[1] + "/hills.ppm", "wb").write(b"P6 %d %d 255\n" % (n, n) + rgb)
END
image=(); codec=deflate
if has textures && { has picture || has jpeg; }; then image=(--color "$work/hills.ppm"); fi
has picture || image+=(--image-codec jpeg)
has deflate || codec=rice
"$host/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 40 --tile-log2 6 --quiet --codec "$codec" "${image[@]}" -o "$work/hills.ffp"
result $? "a pack to fly over ($codec${image:+, with images})"

"${qemu[@]}" "$program" --pack "$work/hills.ffp" --frames 60 --fb "$work/pack.ppm" >"$work/pack.txt"
result $? "a flight over the pack"
[ "$(value frames_drawn "$work/pack.txt")" = 60 ] && [ "$(value triangles_mean "$work/pack.txt")" -gt 200 ]
result $? "every frame shows ground ($(value triangles_mean "$work/pack.txt") triangles)"
[ "$(head -c 15 "$work/pack.ppm" | tr '\n' ' ')" = "P6 240 320 255 " ] && [ "$(stat -c %s "$work/pack.ppm")" = 230415 ]
result $? "the frame buffer file is a picture"
if [ -x "$host/farfield-handheld" ] && [ -z "${without// /}" ]; then
    "$host/farfield-handheld" --pack "$work/hills.ffp" --frames 60 --fb "$work/host.ppm" >"$work/host.txt"
    [ "$(value geometry_hash "$work/pack.txt")" = "$(value geometry_hash "$work/host.txt")" ] && cmp -s "$work/pack.ppm" "$work/host.ppm"
    result $? "the same geometry and the same pixels as on this machine"
fi
python3 tests/rig/placed.py "$work/hills.raw" 257 0,0,257,257 1 40 32632 "$work/placed.vrt" &&
    "$host/farfield-bake" "$work/placed.vrt" --quiet --codec "$codec" -o "$work/placed.ffp"
at=(--pack "$work/placed.ffp" --at 45.12,9.05,200 --to 45.13,9.06 --speed 900 --frames 60)
if has geo && [ -x "$host/farfield-handheld" ] && [ -z "${without// /}" ]; then
    "${qemu[@]}" "$program" "${at[@]}" >"$work/at.txt" && "$host/farfield-handheld" "${at[@]}" >"$work/host.txt" &&
        [ "$(value geometry_hash "$work/at.txt")" = "$(value geometry_hash "$work/host.txt")" ]
    result $? "from one latitude and longitude to another, as on this machine"
elif ! has geo; then
    ! "${qemu[@]}" "$program" "${at[@]}" >/dev/null 2>"$work/err.txt" && [ "$(wc -l <"$work/err.txt")" = 1 ]
    result $? "without geo a latitude is refused in one line"
fi
! "${qemu[@]}" "$program" --pack "$work/hills.raw" >/dev/null 2>"$work/err.txt" && [ "$(wc -l <"$work/err.txt")" = 1 ]
result $? "what is no pack is refused in one line"
if ! has deflate; then
    "$host/farfield-bake" "$work/hills.raw" --raw 257x257 --spacing 40 --tile-log2 6 --quiet -o "$work/deflate.ffp"
    ! "${qemu[@]}" "$program" --pack "$work/deflate.ffp" >/dev/null 2>"$work/err.txt" && grep -q "not supported" "$work/err.txt"
    result $? "a deflated pack is refused as not supported"
fi

if has network; then
    "$host/farfield-server" --pack "$work/hills.ffp" --listen 127.0.0.1:0 >"$work/server.log" 2>&1 &
    server_pid=$!
    for _ in $(seq 100); do
        port=$(sed -nE 's/.*127\.0\.0\.1:([1-9][0-9]*)\b.*/\1/p' "$work/server.log" | head -1)
        [ -n "$port" ] && break
        sleep 0.1
    done
    "${qemu[@]}" "$program" --server "127.0.0.1:${port:-1}" --panorama on --frames 150 --fb "$work/live.ppm" >"$work/live.txt"
    result $? "a flight against a real server"
    [ "$(value bytes_down "$work/live.txt")" -gt 2000 ] && [ "$(value triangles_mean "$work/live.txt")" -gt 100 ] &&
        [ "$(value protocol_errors "$work/live.txt")" = 0 ]
    result $? "ground comes over the socket"
    if has panorama && has picture; then
        faces=$(($(value panorama_faces "$work/live.txt") + $(value panorama_faces_empty "$work/live.txt")))
        [ "$faces" -gt 0 ]
        result $? "and faces of panoramas ($faces)"
    fi
else
    ! "${qemu[@]}" "$program" --server 127.0.0.1:1 >/dev/null 2>"$work/err.txt" && grep -q "not supported" "$work/err.txt"
    result $? "a server is refused as not supported"
fi
if has network && has panorama && has textures && has jpeg && has picture; then
    "$host/farfield-fly" --pack "$work/hills.ffp" --panorama on --back-plane 1500 --seconds 4 --settle 6 --backend none --tape "$work/flight.tape" 2>"$work/fly.err"
    result $? "a flight recorded on tape"
    "${qemu[@]}" "$program" --tape "$work/flight.tape" --hash >"$work/tape.txt"
    result $? "flown again: the same requests, the same geometry"
    "$host/farfield-handheld" --tape "$work/flight.tape" --hash >"$work/tape-host.txt" &&
        [ "$(value pictures_hash "$work/tape.txt")" = "$(value pictures_hash "$work/tape-host.txt")" ]
    result $? "every picture of it is the one this machine draws"
fi
exit $((failures > 0))
