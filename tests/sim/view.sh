#!/bin/bash
# farfield-view in a window of a virtual X server and off screen: scripts press keys and report device events, pictures are looked at.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
view=$bin/farfield-view
work=build/tests/view
server_pid=""
. tests/rig/result.bash
stop_server() {
    [ -z "$server_pid" ] || { kill "$server_pid"; wait "$server_pid"; } 2>/dev/null
    server_pid=""
}
trap stop_server EXIT
rm -rf "$work"
mkdir -p "$work"

# Hills of 257 x 257 samples, 30 m apart; the middle is at 3840, 3840 m.
python3 - "$work/hills.r16" <<'END'
import math, struct, sys
def height(x, y):
    hill = 600 * math.exp(-((x - 128) ** 2 + (y - 60) ** 2) / 700)
    return int(500 + 200 * math.sin(x / 21) * math.cos(y / 17) + 60 * math.sin(x / 7 + y / 5) + hill)
with open(sys.argv[1], "wb") as out:
    for y in range(257):
        out.write(struct.pack("<257H", *(height(x, y) for x in range(257))))
END
pack=$work/hills.ffp
"$bin/farfield-bake" --quiet "$work/hills.r16" --raw 257x257 --spacing 30 --scale 1 -o "$pack"
result $? "a pack to fly over"

# pictures WHAT FILE...: prints for each file the number of its colours, of its pixels that are sky and dark, or of its pixels that differ from the first one's.
cat >"$work/pictures.py" <<'END'
import struct, sys, zlib
def rows(path):
    data, at, packed = open(path, "rb").read(), 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert depth == 8 and colour == 2
        packed += body if kind == b"IDAT" else b""
        at += size + 12
    raw, line, out = zlib.decompress(packed), bytearray(3 * width), []
    for y in range(height):
        method, new = raw[y * (3 * width + 1)], bytearray(raw[y * (3 * width + 1) + 1:(y + 1) * (3 * width + 1)])
        for i in range(3 * width):
            left, up, corner = (new[i - 3] if i > 2 else 0), line[i], (line[i - 3] if i > 2 else 0)
            nearest = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
            new[i] = (new[i] + (0, left, up, (left + up) // 2, nearest)[method]) & 255
        line = new
        out.append(bytes(new))
    return [row[i:i + 3] for row in out for i in range(0, 3 * width, 3)]
first = rows(sys.argv[2])
for path in sys.argv[2:]:
    pixels = rows(path)
    if sys.argv[1] == "colours":
        print(len(set(pixels)))
    elif sys.argv[1] == "sky": # blue ones, and dark ones
        print(sum(p[2] > p[0] + 20 for p in pixels), sum(max(p) < 80 for p in pixels))
    elif sys.argv[1] == "red":
        print(sum(p[0] > 150 and p[1] < 90 and p[2] < 90 for p in pixels))
    else:
        print(sum(a != b for a, b in zip(first, pixels)) if len(first) == len(pixels) else -1)
END
pictures() { python3 "$work/pictures.py" "$@" | tr '\n' ' '; }
value() { # NAME: of the counters in $work/said
    grep -o "\"$1\": [-0-9.]*" "$work/said" | grep -o '[-0-9.]*$'
}

# A driver is unloaded with its window, and what it leaves behind can then no longer be told from ours: windows go without the
# search for leaks; the same paths off screen have it.
windowed="env ASAN_OPTIONS=detect_leaks=0 xvfb-run -a"

# ---- toggles, in a window and off screen, on both back ends ----
cat >"$work/toggles.txt" <<END
# frame command
0 settle
0 screenshot $work/plain.png
1 key m
2 screenshot $work/mesh.png
3 key m
4 key b
5 screenshot $work/borders.png
6 key b
7 key f1
8 screenshot $work/help.png
9 key f1
10 key k
11 screenshot $work/pools.png
12 key k
13 screenshot $work/again.png
END
toggles() { # WHAT, command before the program, options
    local what=$1 mode=$2
    shift 2
    rm -f "$work"/*.png
    # shellcheck disable=SC2086
    $mode "$view" "$pack" --place 3840,300,250 --quality 3:6 --no-hud --script "$work/toggles.txt" --json "$@" >"$work/said" 2>"$work/error"
    result $? "$what: runs to the end of its script" && [ ! -s "$work/error" ] || head -n 5 "$work/error"
    read -r colours _ < <(pictures colours "$work/plain.png")
    [ "${colours:-0}" -gt 200 ]; result $? "$what: the picture has ${colours:-no} colours"
    read -r _ mesh borders help pools again < <(pictures differences "$work/plain.png" "$work"/{mesh,borders,help,pools,again}.png)
    [ "${mesh:-0}" -gt 2000 ]; result $? "$what: the wireframe changes the picture"
    [ "${borders:-0}" -gt 100 ]; result $? "$what: node borders change the picture"
    [ "${help:-0}" -gt 5000 ]; result $? "$what: the list of keys changes the picture"
    [ "${pools:-0}" -gt 5000 ]; result $? "$what: what the pools hold changes the picture"
    [ "${again:-1}" = 0 ]; result $? "$what: all off again is the first picture, to the pixel"
    read -r red_plain red_mesh < <(pictures red "$work/plain.png" "$work/mesh.png")
    [ "${red_plain:-1}" = 0 ] && [ "${red_mesh:-0}" -gt 50 ]; result $? "$what: stitching strips have a colour of their own"
}
toggles "window, gles1" "$windowed" --backend gles1
toggles "window, gl" "$windowed" --backend gl
toggles "headless, gles1" "" --headless --backend gles1
toggles "headless, gl" "" --headless --backend gl
toggles "window, soft" "$windowed" --backend soft
toggles "headless, soft" "" --headless --backend soft

# ---- events ----
cat >"$work/events.txt" <<END
0 settle
1 down w
31 up w
40 position 1000 2000 1500
41 accelerometer 0 866 500
42 touch down 100 100
43 touch move 140 100
44 touch up 140 100
45 key f2
46 key f6
48 down w
55 up w
56 key f6
60 key f5
70 settle
END
"$view" "$pack" --headless --place 3840,1000 --script "$work/events.txt" --events "$work/events.log" --json >"$work/said" 2>"$work/error"
result $? "a script of events"
cat >"$work/expected" <<END
key w down
key w up
position 1000 2000 1500
accelerometer 0 866 500
pointer 0 100 100
pointer 1 140 100
pointer 2 140 100
key f2 down
position 923 2494 1500
key f2 up
key f6 down
interruption begin
key f6 up
key w down
key w up
key f6 down
interruption end
key f6 up
key f5 down
battery low
key f5 up
END
cut -d' ' -f2- "$work/events.log" | cmp -s - "$work/expected"; result $? "every event is handled, in order" ||
    diff <(cut -d' ' -f2- "$work/events.log") "$work/expected"
[ "$(value low_power)" = 1 ]; result $? "low battery saves power"
# The drag turned the view by 8.8 degrees: half a kilometre ahead is (923, 2494). Then only the interruption's keys came: they do
# not fly.
[ "$(value x_m | cut -d. -f1),$(value y_m | cut -d. -f1)" = 923,2494 ]
result $? "a position fix moves there, and an interruption holds still"
printf '0 settle\n1 down w\n31 up w\n32 quit\n' >"$work/fly.txt"
"$view" "$pack" --headless --place 3840,1000 --script "$work/fly.txt" --json >"$work/said"
# 30 frames of 1/30 s at 150 km/h: 41.7 m to the north.
value y_m | awk '{ exit !($1 > 1039 && $1 < 1045) }'; result $? "flying forward goes north at the speed shown"
"$view" "$pack" --headless --frames 120 --json >"$work/said"
[ "$(value frames)" = 120 ] && [ "$(value drawn)" -lt 60 ]; result $? "draws only when something changed"
"$view" "$pack" --headless --keys "wwd+m" --screenshot "$work/keys.png" --json >"$work/said"
[ $? = 0 ] && [ -s "$work/keys.png" ] && [ "$(value events)" = 10 ]; result $? "--keys and --screenshot"

# ---- a person at the window: key, mouse and close events sent through X ----
cat >"$work/person.py" <<'END'
import ctypes, sys, time
x = ctypes.CDLL("libX11.so.6")
x.XOpenDisplay.restype = ctypes.c_void_p
x.XInternAtom.restype = x.XDefaultRootWindow.restype = ctypes.c_ulong
for f in (x.XDefaultRootWindow, x.XKeysymToKeycode, x.XFlush, x.XInternAtom, x.XFetchName, x.XQueryTree, x.XSendEvent):
    f.argtypes = None
class Key(ctypes.Structure):  # XKeyEvent, XButtonEvent and XMotionEvent begin alike
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("sent", ctypes.c_int), ("display", ctypes.c_void_p),
                ("window", ctypes.c_ulong), ("root", ctypes.c_ulong), ("sub", ctypes.c_ulong), ("time", ctypes.c_ulong),
                ("x", ctypes.c_int), ("y", ctypes.c_int), ("xr", ctypes.c_int), ("yr", ctypes.c_int), ("state", ctypes.c_uint),
                ("code", ctypes.c_uint), ("same", ctypes.c_int), ("pad", ctypes.c_long * 24)]
class Message(ctypes.Structure):
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("sent", ctypes.c_int), ("display", ctypes.c_void_p),
                ("window", ctypes.c_ulong), ("kind", ctypes.c_ulong), ("format", ctypes.c_int), ("data", ctypes.c_long * 5),
                ("pad", ctypes.c_long * 24)]
display = ctypes.c_void_p(x.XOpenDisplay(None))
root = ctypes.c_ulong(x.XDefaultRootWindow(display))
def find(window):
    name, count = ctypes.c_char_p(), ctypes.c_uint()
    r, p, children = ctypes.c_ulong(), ctypes.c_ulong(), ctypes.POINTER(ctypes.c_ulong)()
    if x.XFetchName(display, window, ctypes.byref(name)) and name.value == b"Farfield":
        return window
    x.XQueryTree(display, window, ctypes.byref(r), ctypes.byref(p), ctypes.byref(children), ctypes.byref(count))
    for i in range(count.value):
        found = find(ctypes.c_ulong(children[i]))
        if found: return found
for _ in range(100):
    window = find(root)
    if window: break
    time.sleep(0.1)
def send(event, mask):
    x.XSendEvent(display, window, 0, ctypes.c_long(mask), ctypes.byref(event))
    x.XFlush(display)
    time.sleep(0.15)
def key(symbol, down):
    code = x.XKeysymToKeycode(display, ctypes.c_ulong(symbol))
    send(Key(2 if down else 3, 0, 0, display.value, window.value, root.value, 0, 0, 9, 9, 9, 9, 0, code & 255, 1), 1 if down else 2)
def button(down, number):
    at = (0, 0, 9, 9)
    send(Key(4 if down else 5, 0, 0, display.value, window.value, root.value, 0, 0, *at, 0, number, 1), 4 if down else 8)
def move(at_x, at_y):
    x.XWarpPointer(display, ctypes.c_ulong(0), window, 0, 0, 0, 0, at_x, at_y)
    x.XFlush(display)
    time.sleep(0.15)
time.sleep(1)
key(ord("w"), 1); key(ord("w"), 0)
key(0xffbe, 1); key(0xffbe, 0)
move(100, 100); button(1, 1); move(140, 100); button(0, 1)
button(1, 4)
message = Message(33, 0, 0, display.value, window.value, x.XInternAtom(display, b"WM_PROTOCOLS", 0), 32)
message.data[0] = x.XInternAtom(display, b"WM_DELETE_WINDOW", 0)
send(message, 0)
END
cat >"$work/person.sh" <<'END'
"$1" "$2" --events "$3/person.log" --frames 6000 >"$3/said" 2>&1 &
python3 "$3/person.py" || kill $!
wait $!
END
# shellcheck disable=SC2086
timeout 120 $windowed bash "$work/person.sh" "$view" "$pack" "$work"
result $? "closing the window ends the program" || cat "$work/said"
cut -d' ' -f2- "$work/person.log" | cmp -s - <(printf '%s\n' "key w down" "key w up" "key f1 down" "key f1 up" "pointer 0 100 100" \
    "pointer 1 140 100" "pointer 2 140 100" "pointer 3 140 100" quit)
result $? "keys and mouse arrive from the window" || cat "$work/person.log"

# ---- a server, a link that changes, a server that vanishes ----
"$bin/farfield-server" --pack "$pack" --listen 127.0.0.1:0 --workers 1 --renderers 1 >"$work/server.log" 2>&1 &
server_pid=$!
wait_for "$work/server.log" "listening on.*renderers"
address=$(sed -n 's/.*listening on \([^ ,]*\).*/\1/p' "$work/server.log")
printf '0 settle\n0 screenshot %s\n1 key l\n2 key l\n30 settle\n' "$work/server.png" >"$work/link.txt"
"$view" "$address" --headless --link lan --panorama off --script "$work/link.txt" --json >"$work/said" 2>"$work/error"
result $? "over a link to a server" && [ ! -s "$work/error" ] || cat "$work/error"
[ "$(value nodes_held)" -gt 20 ] && [ "$(value bytes_down)" -gt 1000 ]; result $? "the ground came from the server"
[ "$(value reconnects)" -ge 1 ]; result $? "another link profile: connected anew"
"$view" "$address" --headless --panorama on --place 3840,300,900 --script "$work/toggles.txt" --json >"$work/said" 2>"$work/error"
[ $? = 0 ] && [ "$(value panoramas)" -ge 1 ]; result $? "panoramas come from the server"
stop_server
for backend in gles1 gl soft; do
    "$view" "$address" --headless --backend $backend --no-hud --frames 30 --screenshot "$work/waiting.png" --json >"$work/said" 2>"$work/error"
    [ $? = 0 ] && [ -s "$work/waiting.png" ] && [ ! -s "$work/error" ] && [ "$(value nodes_held)" = 0 ]; result $? "a server that is not there is waited for, with $backend"
    read -r blue dark < <(pictures sky "$work/waiting.png")
    [ "${blue:-0}" -gt 20000 ] && [ "$dark" = 0 ]; result $? "under the sky"
done
"$view" "$pack" --headless --link umts --panorama on --place 3840,300,900 --script "$work/toggles.txt" --json >"$work/said" 2>"$work/error"
[ $? = 0 ] && [ "$(value bytes_down)" -gt 1000 ] && [ "$(value panoramas)" -ge 1 ]; result $? "a pack behind a link of its own, with panoramas"

# ---- the map ----
cat >"$work/map.txt" <<END
0 settle
0 screenshot $work/before.png
1 key n
3 screenshot $work/aslant.png
40 settle
41 screenshot $work/map.png
42 down pageup
52 up pageup
53 settle
54 screenshot $work/wide.png
55 key n
90 settle
91 screenshot $work/after.png
92 key c
93 screenshot $work/lines.png
94 key c
95 screenshot $work/without.png
END
declare -A drawn
for backend in gles1 soft; do
    "$view" "$pack" --headless --backend $backend --place 3840,2000,400 --no-hud --script "$work/map.txt" >"$work/said" 2>"$work/error"
    [ $? = 0 ] && [ ! -s "$work/error" ]; result $? "a map and back, with $backend"
    read -r _ aslant map wide after lines without < <(pictures differences "$work/before.png" "$work"/{aslant,map,wide,after,lines,without}.png)
    [ "${aslant:-0}" -gt 20000 ] && [ "$map" -gt 20000 ] && [ "$wide" -gt 20000 ] && [ "$after" -lt 500 ]; result $? "the flight is as it was: aslant $aslant, map $map, after $after"
    [ "${lines:-0}" -gt 1500 ] && [ "$without" -lt 500 ]; result $? "contours in flight, and off again: $lines"
    drawn[$backend]=$lines
    read -r before map after < <(pictures red "$work"/{before,map,after}.png)
    [ "$before" = 0 ] && [ "$map" -ge 30 ] && [ "$after" = 0 ]; result $? "the place of the viewer is a point: $map"
done
[ "${drawn[gles1]:-0}" -ge "${drawn[soft]:-1}" ]; result $? "a GL, which leaves out a line's last pixel, has contours without gaps"
"$view" "$pack" --headless --backend soft --place 3840,2000,400 --no-hud --map --script <(printf '0 settle\n1 screenshot %s\n' "$work/first.png") >"$work/said" 2>"$work/error"
read -r _ first < <(pictures differences "$work/map.png" "$work/first.png")
[ "${first:--1}" -ge 0 ] && [ "$first" -lt 500 ]; result $? "begins with the map: $first"
{
    echo 0 settle
    for ((i = 0; i < 100; i++)); do echo 1 scroll down; done
    echo 2 settle
    for ((i = 0; i < 200; i++)); do echo 3 scroll up; done
    echo 4 settle
} >"$work/zoom.txt"
timeout 60 "$view" "$pack" --headless --backend soft --map --script "$work/zoom.txt" >"$work/said" 2>"$work/error" && [ ! -s "$work/error" ]
result $? "a map as small and as large as can be" || cat "$work/error"

cat >"$work/finger.txt" <<END
0 settle
0 screenshot $work/before.png
1 touch down 100 100
2 key n
3 touch up 100 100
40 key n
80 touch move 30 100
81 settle
82 screenshot $work/after.png
END
"$view" "$pack" --headless --backend soft --place 3840,2000,400 --no-hud --script "$work/finger.txt" >"$work/said" 2>"$work/error"
read -r _ after < <(pictures differences "$work"/{before,after}.png)
[ "${after:-99999}" -lt 5000 ]; result $? "a finger down as the map comes turns no flight after it: $after"

# ---- wrong words ----
python3 tests/rig/hills.py 65 "$work/far.raw" &&
    python3 tests/rig/placed.py "$work/far.raw" 65 0,0,65,65 1 30 32632 "$work/far.vrt" &&
    "$bin/farfield-bake" --quiet "$work/far.vrt" --t-srs EPSG:32632 -o "$work/far.ffp" &&
    timeout 60 "$view" --headless --frames 20 "$pack" --pack "$work/far.ffp" 2>"$work/error" &&
    [ "$(grep -c "far.ffp is not shown: it has no reference system" "$work/error")" = 1 ]
result $? "tells once of a pack that fits not" || cat "$work/error"

refuses() { # STATUS WHAT MESSAGE OPTION...
    local status=$1 what=$2 message=$3
    shift 3
    timeout 60 "$view" --headless --frames 2 "$@" >"$work/said" 2>"$work/error"
    [ $? = "$status" ] && [ "$(wc -l <"$work/error")" = 1 ] && grep -q -F "farfield-view: $message" "$work/error"
    result $? "refuses $what"
}
head -c 5000 "$pack" >"$work/short.ffp"
echo "not a pack" >"$work/foreign.ffp"
echo "0 jump high" >"$work/bad.txt"
refuses 2 "no terrain" "ADDR:PORT or a pack is wanted"
refuses 1 "a missing pack" "$work/none.ffp: " "$work/none.ffp"
refuses 1 "a foreign file" "$work/foreign.ffp: " "$work/foreign.ffp"
refuses 1 "a truncated pack" "$work/short.ffp: " "$work/short.ffp"
refuses 1 "an address without a port" "host:: neither a pack nor ADDR:PORT" host:
refuses 2 "a size" "--size: 0x5 is not WIDTHxHEIGHT, each 16 to 4096" --size 0x5 "$pack"
refuses 2 "a quality" "--quality: best is not low, medium, high" --quality best "$pack"
refuses 2 "a link" "--link: pigeon is not none or NAME" --link pigeon "$pack"
refuses 1 "a script" "$work/bad.txt:1: not a command: 0 jump high" --script "$work/bad.txt" "$pack"
refuses 2 "too little memory" "--memory: 16 is not a number of bytes, with K or M: 544K to 4095M" --memory 16 "$pack"
refuses 1 "a folder for a picture" "$work/none/a.png: " --screenshot "$work/none/a.png" "$pack"
"$view" --help | grep -q '^Usage: farfield-view' && "$view" --version | grep -q '^farfield-view [0-9]'
result $? "--help and --version"
exit $((failures > 0))
