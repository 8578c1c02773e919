#!/bin/sh
# The same flight drawn by integers and by GL ES: look.sh BIN_DIR PACK OUT_DIR [FLY-OPTION...]. Makes OUT_DIR/soft.csv, OUT_DIR/gles1.csv and,
# in OUT_DIR/soft and OUT_DIR/gles1, pictures of five moments for farfield-report --beside.
set -eu
bin=$1 pack=$2 out=$3
shift 3
for backend in soft gles1; do
    rm -rf "$out/$backend"
    mkdir -p "$out/$backend"
    "$bin/farfield-fly" --pack "$pack" --link umts --seconds 45 --every 15 --seed 1 --size 240x320 "$@" --backend "$backend" \
        --csv "$out/$backend.csv" --png "$out/$backend"
    rm -f "$out/$backend/frame-0000.00.png" # nothing has arrived yet
done
