#!/bin/bash
# farfield-link between real sockets: bytes pass unchanged both ways, several connections at once, cuts are seen as cuts, errors are
# one line, SIGTERM ends it cleanly.
set -u
cd "$(dirname "$0")/../.." || exit 2
link=${BIN:-build/bin}/farfield-link
work=build/tests/link_proxy.$$ # runs may go on side by side; left behind only after a failure
mkdir -p "$work"
pids=()
trap 'for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null; done' EXIT
. tests/rig/result.bash

# An echo server; tells its port in a file.
cat >"$work/echo.py" <<'END'
import socket, sys, threading
listener = socket.create_server(("127.0.0.1", 0))
with open(sys.argv[1], "w") as file:
    file.write(str(listener.getsockname()[1]) + "\n")
def serve(connection):
    with connection:
        try:
            while data := connection.recv(65536):
                connection.sendall(data)
        except OSError:
            pass # cut
while True:
    threading.Thread(target=serve, args=(listener.accept()[0],), daemon=True).start()
END
# Sends SEED's bytes through PORT on COUNT connections at once; 0 when all come back as they were, 3 when a connection ends early.
cat >"$work/ask.py" <<'END'
import random, socket, sys, threading
port, count, size = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
results = []
def ask(seed):
    data = random.Random(seed).randbytes(size)
    connection = socket.create_connection(("127.0.0.1", port))
    connection.settimeout(60)
    threading.Thread(target=lambda: send(connection, data), daemon=True).start()
    back = b""
    try:
        while len(back) < size:
            piece = connection.recv(65536)
            if not piece:
                break
            back += piece
    except OSError:
        pass
    results.append(0 if back == data else 3 if data.startswith(back) else 1)
def send(connection, data):
    try:
        connection.sendall(data)
    except OSError:
        pass
threads = [threading.Thread(target=ask, args=(seed,)) for seed in range(count)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
sys.exit(max(results))
END

start_link() { # NAME ARGUMENTS...: sets $port and $link_pid
    local name=$1
    shift
    "$link" --listen 127.0.0.1:0 --connect "127.0.0.1:$echo_port" --json "$@" >"$work/$name.json" 2>"$work/$name.err" &
    link_pid=$!
    pids+=("$link_pid")
    wait_for "$work/$name.err" "listening on"
    port=$(sed -n 's/.* listening on [^ ]*:\([0-9]*\),.*/\1/p' "$work/$name.err")
}
stop_link() { # WHAT
    kill -TERM "$link_pid"
    wait "$link_pid"
    result $? "$1 ends cleanly on SIGTERM"
}

python3 "$work/echo.py" "$work/port" &
pids+=($!)
wait_for "$work/port" "[0-9]"
echo_port=$(cat "$work/port")

start_link lan --profile lan
python3 "$work/ask.py" "$port" 5 400000
result $? "five connections of 400 kB over lan come back unchanged"
stop_link lan
grep -q '"connections": 5' "$work/lan.json" && grep -q '"bytes_down": 2000000' "$work/lan.json" && grep -q '"bytes_up": 2000000' "$work/lan.json"
result $? "its totals are right"

start_link umts --profile umts
python3 "$work/ask.py" "$port" 2 6000
result $? "two connections of 6 kB over umts come back unchanged"
stop_link umts

seq 0 20 1000 >"$work/trace"
start_link traced --profile lan --down-trace "$work/trace" --up-trace "$work/trace"
python3 "$work/ask.py" "$port" 1 30000
result $? "30 kB over a recorded link come back unchanged"
stop_link "the recorded link"

# ---- asleep while nothing happens ----
start_link idle --profile gprs
python3 - "$port" "$link_pid" <<'END'
import re, socket, sys, time
def wake_ups():
    return int(re.search(r"^voluntary_ctxt_switches:\s*(\d+)", open(f"/proc/{sys.argv[2]}/status").read(), re.M)[1])
connections = [socket.create_connection(("127.0.0.1", int(sys.argv[1]))) for _ in range(3)]
time.sleep(1.5)
before, since = wake_ups(), time.monotonic()
time.sleep(1)
rate = (wake_ups() - before) / (time.monotonic() - since)
sys.exit(f"{rate:.0f} wake-ups a second" if rate > 40 else 0)
END
result $? "three open connections without traffic wake it 40 times a second at most"
stop_link "the idle link"

start_link cut --profile "lan,cut_every_ms=200,down.bytes_s=20000,up.bytes_s=20000"
python3 "$work/ask.py" "$port" 1 200000
result $(($? != 3)) "a cut ends the connection, with nothing wrong before it"
stop_link "the cut link"
grep -q '"cut": 1' "$work/cut.json"
result $? "the cut is counted"

refused() { # WHAT ARGUMENTS...
    local what=$1 status
    shift
    timeout 10 "$link" "$@" >"$work/out" 2>"$work/err"
    status=$?
    [ $status -ne 0 ] && [ $status -lt 124 ] && [ "$(wc -l <"$work/err")" = 1 ] && grep -q '^farfield-link: ' "$work/err"
    result $? "one line and an error for $what"
}
refused "no arguments"
refused "an unknown profile" --profile telex --listen 127.0.0.1:0 --connect 127.0.0.1:9
refused "a bad field" --profile lan,color=1 --listen 127.0.0.1:0 --connect 127.0.0.1:9
refused "a bad address" --profile lan --listen nowhere --connect 127.0.0.1:9
refused "a bad seed" --profile lan --listen 127.0.0.1:0 --connect 127.0.0.1:9 --seed -1
refused "a port in use" --profile lan --listen "127.0.0.1:$echo_port" --connect 127.0.0.1:9
"$link" --help | grep -q -- --profile && "$link" --version | grep -q "^farfield-link [0-9]"
result $? "--help and --version"
"$link" --list | grep -q "^gprs "
result $? "--list"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
