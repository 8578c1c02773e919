#!/bin/bash
# Several layers of images over one ground: baked, listed, flown, and switched in flight. What is seen of a layer is what a pack with
# its image alone shows.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/layers.$$
mkdir -p "$work"
. tests/rig/result.bash
bakes() { # NAME ARGUMENTS...
    baked=$1
    shift
    "$bin/farfield-bake" "$work/hills.tif" --hscale 0.1 --tile-log2 7 --quiet -o "$work/$baked.ffp" "$@" 2>"$work/bake.err"
}
flies() { # NAME PACK ARGUMENTS...
    flown=$1 pack=$2
    shift 2
    mkdir -p "$work/$flown"
    timeout 300 "$bin/farfield-fly" --pack "$work/$pack.ffp" --link lan --far off --speed 150 --seconds 6 --settle 3 --backend soft \
        --png "$work/$flown" --every 3 --json "$@" >"$work/$flown.json" 2>"$work/$flown.err"
}
same() { # NAME NAME FRAME
    cmp -s "$work/$1/frame-000$3.00.png" "$work/$2/frame-000$3.00.png"
}
is() { # EXPRESSION WHAT: over the summaries `s`, by flight
    python3 - "$work" "$1" <<'END'
import glob, json, os, sys
s = {os.path.basename(path)[:-5]: json.load(open(path)) for path in glob.glob(sys.argv[1] + "/*.json")}
sys.exit(0 if eval(sys.argv[2]) else 1)
END
    result $? "$2"
}
refused() { # TEXT WHAT
    [ "$(wc -l <"$work/bake.err")" = 1 ] && grep -q -- "$1" "$work/bake.err"
    result $? "$2"
}

python3 tests/rig/hills.py 257 "$work/hills.raw" && /usr/bin/python3 - "$work" <<'END'
import sys
import numpy as np
from osgeo import gdal, osr
gdal.UseExceptions()
work, srs = sys.argv[1], osr.SpatialReference()
srs.ImportFromEPSG(32632)
def put(name, bands, metres, kind):
    file = gdal.GetDriverByName("GTiff").Create(f"{work}/{name}.tif", bands.shape[2], bands.shape[1], bands.shape[0], kind)
    file.SetProjection(srs.ExportToWkt())
    file.SetGeoTransform((500000, metres, 0, 5100000, 0, -metres))
    file.WriteArray(bands)
put("hills", np.fromfile(f"{work}/hills.raw", np.uint16).reshape(1, 257, 257), 40, gdal.GDT_UInt16)
y, x = np.mgrid[:514, :514]
put("a", np.stack([x % 64 * 3, x * 0 + 80, y % 96 * 2]).astype(np.uint8), 20, gdal.GDT_Byte)
put("b", np.stack([255 - x // 3, y // 3, 40 + x % 32 * 6]).astype(np.uint8), 20, gdal.GDT_Byte)
END
result $? "a ground and two images"
bakes a --color "$work/a.tif"
result $? "a pack of one layer"
bakes b --color "$work/b.tif" && bakes both --color "$work/a.tif" --layer "autumn=$work/b.tif"
result $? "packs of the other, and of both"
"$bin/farfield-info" --verify "$work/both.ffp" >/dev/null
result $? "both are whole"
"$bin/farfield-info" --json "$work/both.ffp" >"$work/both-info.json"
"$bin/farfield-info" --json "$work/b.ffp" >"$work/b-info.json"
is '[row["name"] for row in s["both-info"]["layers"]] == ["", "autumn"]' "the layers are listed by name"
is 's["both-info"]["layers"][1]["bytes"] == s["b-info"]["texture_bytes"] and s["both-info"]["layers"][1]["levels"] == s["b-info"]["texture_levels"]' \
    "with bytes and levels, those of the image alone"
"$bin/farfield-info" "$work/both.ffp" | grep -q '^layer 1 *autumn'
result $? "in text, too"

bakes x --color "$work/a.tif" --layer "$work/b.tif"
refused "NAME=IMAGE" "a layer without a name is refused"
bakes x --layer "n=$work/a.tif" --layer "n=$work/b.tif"
refused "there is a layer of this name" "two of one name are refused"
eight=$(for i in 1 2 3 4 5 6 7 8; do echo "--layer l$i=$work/a.tif"; done)
bakes x --color "$work/a.tif" $eight
refused "at most 8 layers" "a ninth layer is refused"

flies one a
flies first both
same one first 6 && same one first 9
result $? "the first layer looks as it does alone"
is 's["first"]["request_hash"] == s["one"]["request_hash"] and s["first"]["bytes_images"] == s["one"]["bytes_images"]' \
    "and costs as much: nothing of the other one comes"
flies alone b
flies second both --layer autumn
same alone second 6 && same alone second 9 && ! same first second 6
result $? "the second layer looks as it does alone"
is 's["second"]["bytes_images"] == s["alone"]["bytes_images"] and s["second"]["requests_failed"] == 0' "and costs as much"
flies switched both --event 4:layer=autumn
same switched first 3 && same switched second 9
result $? "switched in flight: before, the one; settled, the other, as if it had been there from the start"
is 's["switched"]["geometry_hash"] == s["second"]["geometry_hash"] and s["switched"]["bytes_heights"] == s["second"]["bytes_heights"]' \
    "heights are the same, drawn and fetched"
flies back both --event 4:layer=autumn --event 6:layer=
same back first 9
result $? "and back"
is 's["back"]["bytes_down_all"] < s["switched"]["bytes_down_all"] + 2000' "what was shown before comes back without its bytes"
flies none both --layer off
is 's["none"]["bytes_images"] == 0 and s["none"]["textures_held"] == 0 and s["none"]["requests_failed"] == 0' "none: no images are asked for or held"
flies later both --layer off --event 1:layer=autumn
same later second 9
result $? "chosen where there was none"
flies taped both --layer autumn --event 4:layer= --event 6:layer=off --backend soft565 --tape "$work/tape"
"$bin/farfield-handheld" --tape "$work/tape" >"$work/played.log" 2>"$work/played.err"
result $? "a tape plays a flight in which layers are chosen"
# its head says "no views", which the client that was recorded asked for
printf '\1' | dd of="$work/tape" bs=1 seek=$((8 + 4 * 19)) conv=notrunc 2>"$work/dd.err"
"$bin/farfield-handheld" --tape "$work/tape" --no-pictures >"$work/played.log" 2>"$work/played.err"
[ $? = 1 ] && grep -q "does something else than the one recorded" "$work/played.err"
result $? "one of another client is told"
flies unknown both --layer winter
[ $? != 0 ] && tail -1 "$work/unknown.err" | grep -q "no layer of this name; it has: one without a name autumn"
result $? "an unknown one is refused, with those that there are"

# a server's are known only when it is heard
"$bin/farfield-server" --pack "$work/both.ffp" --listen 127.0.0.1:0 --renderers 0 >"$work/server.log" 2>&1 &
server_pid=$!
wait_for "$work/server.log" "listening on"
at=127.0.0.1:$(sed -n 's/.*listening on [^ ]*:\([0-9]*\).*/\1/p' "$work/server.log")
timeout 60 "$bin/farfield-handheld" --server "$at" --layer autumn --frames 30 >"$work/held.log" 2>&1
result $? "a server's layer on the handheld"
timeout 60 "$bin/farfield-handheld" --server "$at" --layer winter --frames 30 >/dev/null 2>"$work/held.err"
[ $? = 1 ] && [ "$(cat "$work/held.err")" = "farfield-handheld: winter: the ground has no layer of images of this name" ]
result $? "one that it has not is refused"
kill "$server_pid"

# parts and what joins them have all layers
"$bin/farfield-export" "$work/both.ffp" -o "$work/again.ffp" --quiet && cmp -s "$work/both.ffp" "$work/again.ffp"
result $? "a part that leaves out nothing is the pack, byte for byte"
region() { "$bin/farfield-export" "$work/both.ffp" "--region=$1" -o "$work/$2.ffp" --quiet; }
region 8.9,45,9.06,47 west && region 9.06,45,9.2,47 east && "$bin/farfield-info" --verify "$work/west.ffp" >/dev/null &&
    [ "$(stat -c %s "$work/west.ffp")" -lt "$(stat -c %s "$work/both.ffp")" ]
result $? "two halves"
"$bin/farfield-merge" "$work/west.ffp" "$work/east.ffp" -o "$work/joined.ffp" --quiet && cmp -s "$work/both.ffp" "$work/joined.ffp"
result $? "joined they are the pack, byte for byte"
flies parts west --local "$work/east.ffp" --layer autumn
same alone parts 9
result $? "a second layer of which a server has one half, and this device the other"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
