#!/bin/bash
# farfield-server's command line: every mistake is one clear line and exit status 2, what fails later 1; starting and stopping leaves nothing behind.
set -u
cd "$(dirname "$0")/../.." || exit 2
: "${BIN:=build/bin}"
work=build/tests/server
rm -rf "$work" && mkdir -p "$work"
. tests/rig/result.bash
server() { "$BIN/farfield-server" "$@" >"$work/out" 2>"$work/err" </dev/null; }

# STATUS WHAT PATTERN ARGUMENTS: refused with one line on stderr that matches, nothing on stdout.
refused() {
    local wanted=$1 what=$2 pattern=$3 status
    shift 3
    server "$@"
    status=$?
    [ "$status" = "$wanted" ] && [ "$(wc -l <"$work/err")" = 1 ] && grep -q -E "^farfield-server: .*$pattern" "$work/err" && [ ! -s "$work/out" ]
    result $? "$what is refused in one line"
}

awk 'BEGIN { for (i = 0; i < 65 * 65; i++) printf "%c%c", 1 + i % 120, 1 }' | LC_ALL=C head -c 8450 >"$work/hills.r16"
"$BIN/farfield-bake" --quiet --raw 65x65 --spacing 30 --name Hills --attribution nobody --licence CC "$work/hills.r16" -o "$work/hills.ffp"
result $? "a pack to serve"
head -c 3000 "$work/hills.ffp" >"$work/short.ffp"
{ head -c 100 "$work/hills.ffp"; printf 'x'; tail -c +102 "$work/hills.ffp"; } >"$work/flipped.ffp"
: >"$work/empty.ffp"

server --help && grep -q -- --pack "$work/out"
result $? "--help"
server --version && grep -q -E '^farfield-server [0-9]+\.' "$work/out"
result $? "--version"
refused 2 "no pack" "--pack" --workers 1
refused 1 "a missing pack" "nowhere.ffp" --pack "$work/nowhere.ffp"
refused 1 "a folder as pack" "$work" --pack "$work"
refused 1 "an empty pack" "empty.ffp" --pack "$work/empty.ffp"
refused 1 "a truncated pack" "short.ffp" --pack "$work/short.ffp"
refused 1 "a damaged pack" "flipped.ffp: checksum" --pack "$work/flipped.ffp"
refused 1 "a foreign file" "hills.r16: not a Farfield" --pack "$work/hills.r16"
refused 1 "a pack of version 5" "version 5, this program reads 9: bake it again: farfield-bake HEIGHTS" --pack tests/corpus/pack/version-5
refused 1 "a pack with an unknown part that is needed" "section MARK" --pack tests/corpus/pack/unknown-needed
refused 2 "an address without a port" "listen" --pack "$work/hills.ffp" --listen 127.0.0.1
refused 1 "a foreign address" "listen" --pack "$work/hills.ffp" --listen 192.0.2.1:7788
refused 2 "no workers" "--workers" --pack "$work/hills.ffp" --workers 0
refused 2 "half a number" "--idle" --pack "$work/hills.ffp" --idle 1x
refused 2 "an unknown GL" "--gl" --pack "$work/hills.ffp" --gl soft
refused 2 "an unknown option" "--nonsense" --pack "$work/hills.ffp" --nonsense
refused 2 "a missing value" "--pack" --pack
refused 2 "a stray argument" "stray" --pack "$work/hills.ffp" stray

# Runs while FUNCTION looks at it; $port is where it listens.
with_server() { # FUNCTION ARGUMENTS
    local check=$1 pid line
    shift
    : >"$work/log" # the line looked for below is not the last server's
    "$BIN/farfield-server" --pack "$work/hills.ffp" --listen 127.0.0.1:0 "$@" >"$work/log" 2>"$work/err" </dev/null &
    pid=$!
    for ((tries = 0; tries < 1000; tries++)); do
        line=$(grep -m1 listening "$work/log") && break
        kill -0 "$pid" 2>/dev/null || break
        sleep 0.02
    done
    port=$(grep -o -E '127\.0\.0\.1:[0-9]+' <<<"$line" | head -1 | cut -d: -f2)
    children=$(cat "/proc/$pid/task/$pid/children" 2>/dev/null)
    "$check"
    kill -TERM "$pid" 2>/dev/null
    wait "$pid"
    status=$?
}

port_in_use() {
    [ -n "$port" ]
    result $? "it says where it listens"
    refused 1 "a port in use" "in use" --pack "$work/hills.ffp" --listen "127.0.0.1:$port"
}
with_server port_in_use --workers 2 --renderers 1
[ "$status" = 0 ] && grep -q stopped "$work/log"
result $? "SIGTERM stops it with status 0"
left=0
for child in $children; do [ -e "/proc/$child" ] && left=1; done
[ -n "$children" ] && [ "$left" = 0 ]
result $? "no process is left"

# HELLO, CAPS, and GET_NODE of tile 0's root, whose record is damaged (the server does not read records before they are asked for)
cp "$work/hills.ffp" "$work/good.ffp"
python3 - "$work/hills.ffp" <<'END'
import struct, sys
file = bytearray(open(sys.argv[1], "rb").read())
index, data = struct.unpack_from("<QQ", file, 84 + 24)
file[data + struct.unpack_from("<Q", file, index)[0] + 6] ^= 1
open(sys.argv[1], "wb").write(file)
END
ask_root() {
    python3 -c '
import socket, sys
s = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
s.sendall(b"\1\x0cFFLD\x0b\0\0\0\0\0\0\0" + b"\7\0" + b"\x80\0")
answer = b""
while len(answer) < 2 or len(answer) < 2 + answer[1] + 5: # WELCOME, FAILED
    more = s.recv(4096)
    answer += more or sys.exit("the server closed the connection")
' "$port"
}
with_server ask_root
[ "$status" = 0 ] && grep -q "^farfield-server: $work/hills.ffp is damaged: 1 answers" "$work/err"
result $? "a damaged record is told to the operator"
mv "$work/good.ffp" "$work/hills.ffp"

ask_about() { # name and attribution are asked for; a client of version 10 is sent away with the error of versions
    python3 -c '
import socket, sys
def hear(said, messages):
    s = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
    s.sendall(said)
    heard, whole = b"", []
    while len(whole) < messages:
        heard += s.recv(4096) or sys.exit("the server closed the connection")
        while len(heard) >= 2 and len(heard) >= 2 + heard[1]:
            whole.append(heard[:2 + heard[1]])
            heard = heard[2 + heard[1]:]
    return whole
about = b"\1\5Hills\2\6nobody"
heard = hear(b"\1\x0cFFLD\x0b\0\0\0\0\0\0\0" + b"\7\0" + b"\x08\1\3", 2)
heard[1] == b"\x49" + bytes([len(about)]) + about or sys.exit(repr(heard))
heard = hear(b"\1\x0cFFLD\x0a\0\0\0\0\0\0\0", 1)
heard[0] == b"\x48\3\0\0\xfb" or sys.exit(repr(heard))
' "$port" >"$work/asked" 2>&1
}
with_server ask_about
[ "$status" = 0 ] && [ -f "$work/asked" ] && [ ! -s "$work/asked" ]
result $? "a server tells whose the ground is, and sends older clients away"

far_of() { # flies with far sets past it
    timeout 60 "$BIN/farfield-fly" --pack "$work/hills.ffp" --server "127.0.0.1:$port" --far fins --far-front 300 --backend none --panorama off \
        --seconds 3 --settle 0 --json >"$work/flown.json" 2>"$work/out"
}
with_server far_of --renderers 0
grep -q '"far_requests": 0,' "$work/flown.json" && grep -q '"requests_failed": 0,' "$work/flown.json"
result $? "no far set is asked of a server without renderers"
with_server far_of
grep -q '"far_requests": [1-9]' "$work/flown.json" && grep -q '"requests_failed": 0,' "$work/flown.json"
result $? "of another it is"

nothing() { :; }
with_server nothing --json --gl egl
[ "$(grep -c '^{.*}$' "$work/log")" = "$(wc -l <"$work/log")" ] && grep -q '"event":"listening"' "$work/log" &&
    grep -q '"event":"stopped"' "$work/log"
result $? "--json prints JSON lines only, and --gl egl comes up"

# A server of another version, as far as it goes: it says GOODBYE to whoever greets.
python3 -c '
import socket
s = socket.create_server(("127.0.0.1", 0))
print(s.getsockname()[1], flush=True)
while True:
    client, _ = s.accept()
    client.recv(100)
    client.sendall(b"\x48\3\0\0\xfb")
    client.close()
' >"$work/port" &
old=$!
for ((tries = 0; tries < 1000; tries++)); do [ -s "$work/port" ] && break; sleep 0.02; done
"$BIN/farfield-handheld" --server "127.0.0.1:$(cat "$work/port")" --frames 30 >"$work/out" 2>"$work/err"
[ $? = 1 ] && [ "$(wc -l <"$work/err")" = 1 ] && grep -q "another version of Farfield" "$work/err"
result $? "a server of another version is told in one line"
kill "$old"
wait "$old" 2>/dev/null

exit $((failures > 0))
