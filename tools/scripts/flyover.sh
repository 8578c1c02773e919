#!/bin/bash
# The flights of Hybrid's Table 3 in simulated time, and a report beside its numbers. Usage: flyover.sh BIN_DIR OUT_DIR.
#   QUICK=1             few flights of 60 s, into OUT_DIR/quick
#   FARFIELD_DATA=DIR   holds puget-sound-gatech/; without it the ground is Trinidad, Colorado, from a Debian package
#   FLYOVER_PACK=PACK   flies over this pack instead
#   JOBS=N              flights side by side (default: one per processor)
#   SECONDS_EACH=S      in the air (default 300)
# A finished flight is not flown again unless its pack, its options or the program changed.
set -euo pipefail
here=$(dirname "$0")
bin=$1
out=$2
: "${FARFIELD_DATA:=../shared/data}" "${JOBS:=$(nproc)}" "${QUICK:=}" "${FLYOVER_PACK:=}"
: "${SECONDS_EACH:=$([ -n "$QUICK" ] && echo 60 || echo 300)}"
flights=$out${QUICK:+/quick} # their rows and the report; packs and the decoded ground are shared
settle_s=15

say() { printf '== %s\n' "$*"; }

# bake PACK SOURCE OPTION...: unless this very pack is there already.
bake() {
    local pack=$1 key
    shift
    key="$* $(cksum <"$1")"
    [ -f "$pack" ] && [ "$(cat "$pack.key" 2>/dev/null)" = "$key" ] && "$bin/farfield-info" "$pack" >/dev/null 2>&1 && return
    say "bake $pack (once; some minutes)"
    rm -f "$pack.key"
    "$bin/farfield-bake" "$@" -o "$pack"
    printf '%s\n' "$key" >"$pack.key"
}

# The paper's ground in size and structure: 16385 x 16385 heights at 10 m, 16 x 16 tiles of 1025 x 1025, nodes of 9 x 9, textures of
# 64 x 64 on the first five levels. Else Trinidad, 2401 x 1201, densified to about the same spacing.
find_ground() {
    local puget=$FARFIELD_DATA/puget-sound-gatech dem
    if [ -n "$FLYOVER_PACK" ]; then
        pack=$FLYOVER_PACK ground="$(basename "$FLYOVER_PACK" .ffp)"
    elif [ -f "$puget/ps_height_1k.png" ]; then
        pack=$out/puget-16k.ffp ground="Puget Sound, densified 16 times to 16385 x 16385 at 10 m"
        bake "$pack" "$puget/ps_height_1k.png" --hscale 0.1 --spacing 160 --densify 16 --tile-log2 10 \
            --color "$puget/ps_texture_1k.png" --texture-levels 5
    else
        pack=$out/trinidad.ffp ground="Trinidad, Colorado, densified 8 times to about 10 m"
        dem=$("$here/trinidad.sh" "$out")
        bake "$pack" "$dem" --scale 0.3048780488 --densify 8 --tile-log2 10
    fi
}

# Lines "NAME OPTION...": a flight each. Those over a LAN are references: the picture that a link without limits gives.
list_flights() {
    local link speed quality panorama
    if [ -n "$QUICK" ]; then
        for link in umts gprs lan; do echo "$link-150-low-on --link $link --speed 150 --quality paper-low --panorama on"; done
        echo "umts-0-low-on --link umts --speed 0 --quality paper-low --panorama on"
        printf '%s\n' "px-8 px:8" "px-4 px:4" "C-2 2:8" "C-3 3:8" | list_sweep
        return
    fi
    for quality in low high; do
        for speed in 1000 750 150 25; do
            for panorama in off on; do
                for link in umts gprs lan; do
                    echo "$link-$speed-$quality-$panorama --link $link --speed $speed --quality paper-$quality --panorama $panorama"
                done
            done
        done
    done
    for link in umts gprs; do # standing still, for relevance
        for panorama in off on; do echo "$link-0-low-$panorama --link $link --speed 0 --quality paper-low --panorama $panorama"; done
    done
    printf '%s\n' "px-8 px:8" "px-4 px:4" "px-2 px:2" "px-1 px:1" "C-2 2:8" "C-3 3:8" "C-5 5:8" "C-9 9:8" | list_sweep
    printf '%s\n' "share-server px:1 server" "share-2500 px:1 2500" "share-5000 px:1 5000" "share-10000 px:1 10000" "share-20000 px:1 20000" \
        "share-client px:1 client" | list_sweep
}

# Quality against work, on one flight: "SERIES-VALUE QUALITY [BALANCE]" each; share: budgets of triangles, from all server to all client.
list_sweep() {
    while read -r name quality balance; do
        echo "sweep-$name --link umts --speed 150 --quality $quality --panorama on --balance ${balance:-off}"
    done
}

# fly NAME OPTION...
fly_one() {
    local name=$1 key started=$SECONDS
    shift
    set -- --start 0.4 --height 100 --seconds "$SECONDS_EACH" --settle $settle_s --seed 1 --backend none --audit on "$@"
    key="$flyover_key $*"
    if [ -f "$flights/$name.csv" ] && [ "$(cat "$flights/$name.key" 2>/dev/null)" = "$key" ]; then
        echo "$name: flown before"
        return
    fi
    rm -f "$flights/$name.key"
    "$bin/farfield-fly" --pack "$pack" --ground-cache "$out/truth.ground" --csv "$flights/$name.csv.part" --json "$@" \
        >"$flights/$name.json" 2>"$flights/$name.log" || { tail -n 1 "$flights/$name.log" >&2; return 255; } # 255: xargs stops
    mv "$flights/$name.csv.part" "$flights/$name.csv"
    printf '%s\n' "$key" >"$flights/$name.key"
    echo "$name: $((SECONDS - started)) s ($(find "$flights" -maxdepth 1 -name '*.csv' | wc -l) of $(wc -l <"$flights/list") finished)"
}

fly_all() {
    flyover_key=$(cat "$bin/farfield-fly" "$pack" | sha256sum | cut -d' ' -f1)
    export flyover_key pack out flights bin settle_s SECONDS_EACH
    "$bin/farfield-fly" --pack "$pack" --ground-cache "$out/truth.ground" --audit on --backend none --seconds 0 --settle 0 2>"$out/truth.log" ||
        { tail -n 1 "$out/truth.log" >&2; exit 1; }
    export -f fly_one
    list_flights >"$flights/list"
    # shellcheck disable=SC2016
    xargs -P "$JOBS" -L 1 bash -c 'set -euo pipefail; fly_one "$@"' fly <"$flights/list"
}

# look NAME OPTION...: the beginning of that flight once more, in pictures, and how they should look.
look() {
    local name=$1 folder=$flights/look/$1 key
    shift
    key="$flyover_key $*"
    [ "$(cat "$folder.key" 2>/dev/null)" = "$key" ] && return
    rm -rf "$folder" "$folder.true"
    mkdir -p "$flights/look"
    "$bin/farfield-fly" --pack "$pack" --start 0.4 --height 100 --seconds "$(awk -v s="$SECONDS_EACH" 'BEGIN { print s < 60 ? s : 60 }')" \
        --settle $settle_s --seed 1 --backend soft --png "$folder" --reference "$folder.true" --every 15 "$@" 2>"$folder.log" ||
        { tail -n 1 "$folder.log" >&2; exit 1; }
    rm -f "$folder/frame-0000.00.png" # nothing has arrived yet
    printf '%s\n' "$key" >"$folder.key"
}

main() {
    local -a csv more=()
    local instructions=build/bench/work-precision.csv
    mkdir -p "$flights"
    find_ground
    say "$(basename "$pack"): flights of $SECONDS_EACH s, $JOBS side by side"
    fly_all
    say "pictures beside what they should be"
    look umts-150-low-on --link umts --speed 150 --quality paper-low --panorama on
    look gprs-150-high-on --link gprs --speed 150 --quality paper-high --panorama on
    [ ! -s "$instructions" ] || more=(--instructions "$instructions")
    mapfile -t csv < <(sed "s|^\([^ ]*\).*|$flights/\1.csv|" "$flights/list")
    "$bin/farfield-report" --paper "$here/../report/hybrid_table3.csv" --settle $settle_s --title "The flights of Hybrid's Table 3 over $ground" \
        --against "$flights/look/umts-150-low-on=$flights/look/umts-150-low-on.true" \
        --against "$flights/look/gprs-150-high-on=$flights/look/gprs-150-high-on.true" \
        "${more[@]}" "${csv[@]}" -o "$flights/report"
}

main
