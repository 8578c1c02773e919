#!/bin/sh
# The demonstration behind `make demo`: real terrain, a real server, an emulated link, a real client; then the same minute in
# simulated time. Usage: demo.sh BIN_DIR OUT_DIR. Everything it makes lies under OUT_DIR.
# shellcheck disable=SC2086 # options in words
set -eu
bin=$1
out=$2
pack=$out/trinidad.ffp
owner="U.S. Geological Survey"
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

# fly NAME LINK SECONDS SIZE [OPTION...]: the flight, or as many seconds of it; its CSV, summary and pictures are named NAME.
fly() {
    name=$1 link=$2 seconds=$3 size=$4
    shift 4
    mkdir -p "$out/$name"
    "$bin/farfield-fly" --pack "$pack" --link "$link" --path "$out/flight.csv" --seconds "$seconds" --seed 1 --size "$size" \
        --csv "$out/$name.csv" --png "$out/$name" --json "$@" >"$out/$name.json"
    rm -f "$out/$name/frame-0000.00.png" # nothing has arrived yet
}

mkdir -p "$out"
rm -f "$out/server.log" "$out/link.log" # an earlier run's addresses
say "terrain: Trinidad, Colorado (USGS, public domain) from Debian's libncarg-data"
dem=$("$(dirname "$0")/trinidad.sh" "$out") || fail "no terrain"

say "bake: $dem"
"$bin/farfield-bake" "$dem" --scale 0.3048780488 --name "Trinidad, Colorado" --attribution "$owner" --licence "public domain" -o "$pack"
"$bin/farfield-info" "$pack"

# Along the crest of the Culebra range towards the Spanish Peaks, 40 km away: 15 s standing still, then 45 s at 150 km/h, 1.4 km above ground.
cat >"$out/flight.csv" <<END
t_s,x_m,y_m,z_m,pitch_deg
15,67500,5200,4750,-9
60,68440,6825,5000,-9
END

say "server and a UMTS link, real sockets, real time: 30 seconds"
"$bin/farfield-server" --pack "$pack" --listen 127.0.0.1:0 --workers 2 --renderers 1 >"$out/server.log" 2>&1 &
server_pid=$!
server=$(address_of "$out/server.log" farfield-server)
"$bin/farfield-link" --profile umts --listen 127.0.0.1:0 --connect "$server" --seed 1 >"$out/link.log" 2>&1 &
link_pid=$!
link=$(address_of "$out/link.log" farfield-link)
fly live-umts umts 15 240x320 --far paint --backend gles1 --every 5 --server "$link"
stop
server_pid="" link_pid=""

say "simulated: GPRS, 60 seconds, 960x600, and as it should be"
large="960x600 --far paint --fov 50 --every 60"
fly gprs-large gprs 45 $large --fps 10 --audit on --reference "$out/gprs-large.true"
fly gprs-wireframe gprs 45 $large --fps 2 --wireframe

against=""
for field in far panorama tree; do
    case $field in
    far) how="--far paint" ;;
    panorama) how="--panorama on" ;;
    tree) how="--far off" ;;
    esac
    say "simulated: GPRS, 60 seconds, 240x320, far ground by $field"
    fly gprs-$field gprs 45 240x320 $how --every 15 --audit on --reference "$out/gprs-$field.true"
    against="$against --against $out/gprs-$field=$out/gprs-$field.true"
done

say "integers beside GL ES: the same minute twice"
"$(dirname "$0")/look.sh" "$bin" "$pack" "$out/look" --path "$out/flight.csv" --far paint --quality high --memory 8M

say "report"
pictures=""
for name in gprs-wireframe live-umts gprs-far gprs-panorama gprs-tree; do
    last=$(ls "$out/$name"/*.png | tail -n 1)
    pictures="$pictures --picture $last"
done
"$bin/farfield-report" "$out"/gprs-large.csv "$out"/gprs-far.csv "$out"/gprs-panorama.csv "$out"/gprs-tree.csv "$out"/live-umts.csv \
    -o "$out/report" --title "Culebra Range and Spanish Peaks, Colorado" --attribution "$owner" \
    --slider "over GPRS=$out/gprs-large" --slider "as it should be=$out/gprs-large.true" \
    --beside soft="$out/look/soft" --beside gles1="$out/look/gles1" $against $pictures

say "done"
echo "report:   $out/report/index.html (text: $out/report/REPORT.md)"
echo "pictures:"
ls "$out"/*/*.png | grep -v "^$out/report/" | sed 's/^/  /'
