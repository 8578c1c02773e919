#!/bin/sh
# The demonstration behind `make demo`: real terrain, a real server, an emulated link, a real client; then the same minute in
# simulated time. Usage: demo.sh BIN_DIR OUT_DIR. Everything it makes lies under OUT_DIR.
set -eu
bin=$1
out=$2
pack=$out/trinidad.ffp
server_pid=""
link_pid=""

say() { printf '== %s\n' "$*"; }
fail() { printf 'demo: %s\n' "$*" >&2; exit 1; }
stop() {
    for pid in $link_pid $server_pid; do kill "$pid" 2>/dev/null || true; done
    wait 2>/dev/null || true
}
trap stop EXIT
trap 'exit 130' INT TERM

# The address in a program's "listening on ADDR:PORT" line, once it is there.
address_of() {
    tries=0
    until address=$(sed -n 's/.*listening on \([^ ,]*\).*/\1/p' "$1" 2>/dev/null) && [ -n "$address" ]; do
        tries=$((tries + 1))
        [ $tries -lt 100 ] || fail "$2 did not start: $(cat "$1")"
        sleep 0.1
    done
    printf '%s\n' "$address"
}

# fly NAME LINK SECONDS PANORAMA SIZE [OPTION...]: one flight towards the Culebra range; its CSV, summary and pictures are named NAME.
fly() {
    name=$1 link=$2 seconds=$3 panorama=$4 size=$5
    shift 5
    mkdir -p "$out/$name"
    "$bin/farfield-fly" --pack "$pack" --link "$link" --start 0.35 --speed 150 --panorama "$panorama" --seconds "$seconds" \
        --seed 1 --size "$size" --csv "$out/$name.csv" --png "$out/$name" --json "$@" >"$out/$name.json"
    rm -f "$out/$name/frame-0000.00.png" # nothing has arrived yet
}

mkdir -p "$out"
rm -f "$out/server.log" "$out/link.log" # an earlier run's addresses
say "terrain: Trinidad, Colorado (USGS, public domain) from Debian's libncarg-data"
dem=$("$(dirname "$0")/trinidad.sh" "$out") || fail "no terrain"

say "bake: $dem"
"$bin/farfield-bake" "$dem" --scale 0.3048780488 --name "Trinidad, Colorado" --attribution "U.S. Geological Survey" \
    --licence "public domain" -o "$pack"
"$bin/farfield-info" "$pack"

say "server and a UMTS link, real sockets, real time: 25 seconds"
"$bin/farfield-server" --pack "$pack" --listen 127.0.0.1:0 --workers 2 --renderers 1 >"$out/server.log" 2>&1 &
server_pid=$!
server=$(address_of "$out/server.log" farfield-server)
"$bin/farfield-link" --profile umts --listen 127.0.0.1:0 --connect "$server" --seed 1 >"$out/link.log" 2>&1 &
link_pid=$!
link=$(address_of "$out/link.log" farfield-link)
fly live-umts umts 25 auto 240x320 --settle 10 --backend gles1 --every 5 --server "$link"
stop
server_pid="" link_pid=""

for profile in umts gprs; do
    for panorama in on off; do
        say "simulated: $profile, panorama $panorama, 60 seconds"
        fly "$profile-panorama-$panorama" "$profile" 60 "$panorama" 240x320 --every 15 --audit on \
            --reference "$out/$profile-panorama-$panorama.true"
    done
done
say "pictures at 640x480 in high quality, and the wireframe"
fly large-panorama umts 10 on 640x480 --every 5 --quality high --memory 8M --face 512
fly large umts 10 off 640x480 --every 5 --quality high --memory 8M
fly wireframe umts 10 off 640x480 --every 5 --wireframe --quality 2:7 --height 1500

say "integers beside GL ES: the same minute twice"
"$(dirname "$0")/look.sh" "$bin" "$pack" "$out/look" --start 0.35 --speed 900 --height 300 --quality high --memory 8M

say "report"
pictures=""
against=""
for name in umts-panorama-on gprs-panorama-on umts-panorama-off; do against="$against --against $out/$name=$out/$name.true"; done
for name in live-umts umts-panorama-on gprs-panorama-on umts-panorama-off large-panorama large wireframe; do
    last=$(ls "$out/$name"/*.png | tail -n 1)
    pictures="$pictures --picture $last"
done
# shellcheck disable=SC2086
"$bin/farfield-report" "$out"/live-umts.csv "$out"/umts-*.csv "$out"/gprs-*.csv -o "$out/report" \
    --beside soft="$out/look/soft" --beside gles1="$out/look/gles1" --title "Trinidad, Colorado: 150 km/h" $against $pictures

say "done"
echo "report:   $out/report/index.html (text: $out/report/REPORT.md)"
echo "pictures:"
ls "$out"/*/*.png | grep -v "^$out/report/" | sed 's/^/  /'
