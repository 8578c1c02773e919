#!/bin/bash
# Images of a part of the ground: inside them the photograph, beyond them what a pack without images shows, at no bytes and no requests;
# several layers that cover different parts; parts of such packs and what joins them; far pictures; levels left out above.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/partial.$$
mkdir -p "$work"
. tests/rig/result.bash
bakes() { # NAME ARGUMENTS...
    baked=$1
    shift
    "$bin/farfield-bake" "$work/hills.tif" --hscale 0.1 --tile-log2 "${tile_log2:-9}" --quiet -o "$work/$baked.ffp" "$@" 2>"$work/bake.err" &&
        "$bin/farfield-info" --verify --json "$work/$baked.ffp" >"$work/$baked-info.json"
}
flies() { # NAME PACK PATH ARGUMENTS...: still for 8 s at a place of `$work/PATH.csv`
    flown=$1 pack=$2 path=$3
    shift 3
    mkdir -p "$work/$flown"
    timeout 300 "$bin/farfield-fly" --pack "$work/$pack.ffp" --path "$work/$path.csv" --link lan --far off --seconds 9 --settle 0 --backend soft \
        --png "$work/$flown" --every 8 --json "$@" >"$work/$flown.json" 2>"$work/$flown.err"
}
is() { # EXPRESSION WHAT: over the summaries `s`, by flight, and off(A, B): mean difference of two settled pictures, in 255ths
    /usr/bin/python3 - "$work" "$1" <<'END'
import glob, json, os, sys
import numpy as np
from osgeo import gdal
gdal.UseExceptions()
s = {os.path.basename(path)[:-5]: json.load(open(path)) for path in glob.glob(sys.argv[1] + "/*.json")}
frame = lambda name: gdal.Open(f"{sys.argv[1]}/{name}/frame-0008.00.png").ReadAsArray()[:3].astype(int)
off = lambda a, b: np.abs(frame(a) - frame(b)).mean()
root = lambda name: next(x["bytes"] for x in s[name + "-info"]["sections"] if x["kind"] == "texture")
bands = lambda name: gdal.Open(f"{sys.argv[1]}/{name}").RasterCount
alpha = lambda name: (gdal.Open(f"{sys.argv[1]}/{name}.tif").ReadAsArray()[3] > 0).mean()
covered = lambda name, layer=0: s[name + "-info"]["layers"][layer]["covered"]
sys.exit(0 if eval(sys.argv[2]) else 1)
END
    result $? "$2"
}

python3 tests/rig/hills.py 513 "$work/hills.raw" && /usr/bin/python3 - "$work" <<'END'
import sys
import numpy as np
from osgeo import gdal, osr
gdal.UseExceptions()
work, srs = sys.argv[1], osr.SpatialReference()
srs.ImportFromEPSG(32632)
def put(name, bands, metres, kind, x=0, y=0):
    file = gdal.GetDriverByName("GTiff").Create(f"{work}/{name}.tif", bands.shape[2], bands.shape[1], bands.shape[0], kind, ["ALPHA=YES"] if bands.shape[0] == 4 else [])
    file.SetProjection(srs.ExportToWkt())
    file.SetGeoTransform((500000 + x, metres, 0, 5100000 - y, 0, -metres))
    file.WriteArray(bands)
hills = np.fromfile(f"{work}/hills.raw", np.uint16).reshape(1, 513, 513)
put("hills", hills, 40, gdal.GDT_UInt16)
def photo(size, metres, x0=0, y0=0):
    y, x = np.mgrid[:size, :size] * metres + np.array([y0, x0])[:, None, None]
    patches = (np.sin(x / 90) * np.cos(y / 130) > 0) * 90 + (np.sin(x / 900 + y / 700) + 1) * 60
    return np.stack([patches, 220 - patches / 2, patches / 3 + 30]).astype(np.uint8)
whole = photo(1026, 20)
put("whole", whole, 20, gdal.GDT_Byte)
put("part", whole[:, 200:500, 300:600], 20, gdal.GDT_Byte, 6000, 4000)     # a square of 6 km, its middle at 9000, 7000
put("other", 255 - whole[:, 700:860, 700:860], 20, gdal.GDT_Byte, 14000, 14000)
alpha = np.zeros((1, 1026, 1026), np.uint8)
alpha[:, 200:500, 300:600] = 255
put("clear", np.concatenate([whole, alpha]), 20, gdal.GDT_Byte)
put("fine", photo(800, 1.25, 8500, 6500), 1.25, gdal.GDT_Byte, 8500, 6500)  # a square of 1 km with 32 pixels a sample
def at(name, x, y, h, heading, pitch, to=None, above="h_m"):
    rows = [(t, x, 20500 - y, h, heading, pitch) for t in (0, 20)]
    if to: rows[1] = (20, to[0], 20500 - to[1], h, heading, pitch)
    with open(f"{work}/{name}.csv", "w") as file:
        file.write(f"t_s,x_m,y_m,{above},heading_deg,pitch_deg\n" + "".join("%g,%g,%g,%g,%g,%g\n" % row for row in rows))
at("inside", 9000, 7000, 900, 0, -80)
at("beyond", 15000, 16000, 400, 135, -20)
at("edge", 9000, 12000, 900, 0, -15)
at("far", 9000, 19000, 1200, 0, -6)
at("low", 9000, 7000, 150, 0, -60)
at("along", 15000, 12000, 300, 150, -20, (19000, 19000))
at("high", 9000, 12000, hills.max() + 300, 0, -15, above="z_m")
END
result $? "a ground, and images of parts of it"
fine="--texture-quality 95"
bakes none && bakes whole --color "$work/whole.tif" $fine && bakes part --color "$work/part.tif" $fine
result $? "packs without an image, with one of all, with one of a part"
is 'covered("whole") == 1 and 0.08 < covered("part") < 0.12 and s["part-info"]["texture_bytes"] < 0.2 * s["whole-info"]["texture_bytes"]' \
    "farfield-info tells how much of the ground is covered, a twelfth and its rim; it takes as much less"
"$bin/farfield-info" "$work/part.ffp" | grep -q '^textures .* over [0-9.]* % of the ground$' && ! "$bin/farfield-info" "$work/whole.ffp" | grep -q 'of the ground$'
result $? "in text, too"
bakes clear --color "$work/clear.tif" $fine
is 'abs(covered("clear") - covered("part")) < 0.01 and abs(s["clear-info"]["texture_bytes"] / s["part-info"]["texture_bytes"] - 1) < 0.05' \
    "an image that is clear elsewhere covers as much"
tile_log2=7 bakes tiles --color "$work/part.tif" $fine
is '[x["records"] for x in s["tiles-info"]["sections"] if x["kind"] == "texture"][0] == 16 and abs(covered("tiles") - covered("part")) < 0.01' \
    "of many tiles most are a mark"

for view in inside beyond edge far; do
    for pack in none whole part tiles; do
        [ $pack$view != wholebeyond ] && flies $pack-$view $pack $view
    done
done
is 'off("part-inside", "whole-inside") < 2 and off("part-inside", "none-inside") > 20' "inside, the picture is that of an image of all"
is 'off("part-beyond", "none-beyond") == 0 and 0 < s["part-beyond"]["bytes_images"] < root("part") + 8' \
    "beyond, that of a pack without images: one image has come"
is 'off("tiles-beyond", "none-beyond") == 0 and s["tiles-beyond"]["bytes_images"] < 40' "of many tiles, not even that"
is '5 < off("part-edge", "none-edge") and off("part-edge", "tiles-edge") < 1.5 and off("part-far", "none-far") < off("whole-far", "none-far") / 2' \
    "both are seen from the side and from afar"
is 'all(s[f"{pack}-{view}"]["requests_failed"] == 0 for pack in ("part", "tiles") for view in ("inside", "beyond", "edge", "far"))' "nothing is asked for that is not stored"
for pack in none whole part; do
    flies $pack-judged $pack inside --diff on --settle 4 --seconds 2
    flies $pack-judged-edge $pack edge --diff on --settle 4 --seconds 2
done
is 's["part-judged"]["diff_mean"] < s["whole-judged"]["diff_mean"] + 0.3' "inside as it should look: the judge draws the same"
is 's["part-judged-edge"]["diff_mean"] < max(s[f"{pack}-judged-edge"]["diff_mean"] for pack in ("none", "whole")) + 0.3' "and at the edge"
flies along-part part along --link gprs --seconds 20
flies along-none none along --link gprs --seconds 20
is 's["along-part"]["bytes_images"] < root("part") + 8 and abs(s["along-part"]["bytes_heights"] / s["along-none"]["bytes_heights"] - 1) < 0.02' \
    "a flight over ground without the image brings one image and all its heights"

# far pictures, drawn by the server, and levels that a near view leaves out above
for pack in none part; do
    flies $pack-fins $pack far --far paint --far-front 4000 --seconds 16
    flies $pack-faces $pack far --far off --panorama on --back-plane 5000 --size 320x240 --seconds 16
    flies $pack-near $pack edge --view 3000
    flies $pack-lower $pack inside --view 2000
done
flies part-upper part edge --view 3000 --entry off
flies part-whole part inside --view 2000 --entry off
is '0.3 < off("part-faces", "none-faces") < 12 and s["part-faces"]["requests_failed"] == 0 and s["part-faces"]["bytes_faces"] > 0' "a panorama shows the image where it is"
is '0.3 < off("part-fins", "none-fins") < 12 and s["part-fins"]["requests_failed"] == 0 and s["part-fins"]["bytes_far"] > 0' "and so does far ground by fins and paint"
is 'off("part-near", "part-upper") < 1 and off("part-lower", "part-whole") < 1 and s["part-lower"]["requests_failed"] == 0' "entered below its top it looks the same"
is 's["part-near"]["bytes_heights"] == s["none-near"]["bytes_heights"]' "and is entered as deep as a pack without images"

# an image much deeper than the heights
bakes fine --color "$work/fine.tif"
is 's["fine-info"]["texture_levels"] > s["none-info"]["levels"] and covered("fine") < 0.01' "an image of 32 pixels a sample over a 400th of the ground"
flies fine-low fine low --size 640x480
flies fine-beyond fine beyond --size 640x480
flies none-low none low --size 640x480
is 's["fine-low"]["requests_failed"] == 0 and off("fine-low", "none-low") > 20 and s["fine-beyond"]["bytes_images"] < root("fine") + 8' "it shows where it is"

# layers of different parts
bakes other --color "$work/other.tif" $fine && bakes both --color "$work/part.tif" $fine --layer "other=$work/other.tif"
is 'covered("both") == covered("part") and covered("both", 1) == covered("other")' "two layers that cover different parts"
flies both-edge both edge
flies both-other both beyond --layer other
flies other-beyond other beyond
flies both-switched both edge --event 2:layer=other --event 5:layer=
is 'off("both-edge", "part-edge") == 0 and off("both-other", "other-beyond") == 0' "each looks as it does alone"
is 'off("both-switched", "part-edge") == 0 and s["both-switched"]["requests_failed"] == 0' "switched there and back, too"

# parts of the pack, and what joins them
cut() { "$bin/farfield-export" "$work/both.ffp" "--region=$1" -o "$work/$2.ffp" --quiet; }
cut 8.9,45,9.11,47 west && cut 9.11,45,9.4,47 east && "$bin/farfield-info" --verify "$work/west.ffp" >/dev/null &&
    "$bin/farfield-merge" "$work/west.ffp" "$work/east.ffp" -o "$work/joined.ffp" --quiet && cmp -s "$work/both.ffp" "$work/joined.ffp"
result $? "two halves joined are the pack, byte for byte"
flies halves west high --local "$work/east.ffp"
flies both-high both high
is 'off("halves", "both-high") == 0' "a server with one half, a device with the other"

# other programs
"$bin/farfield-export" "$work/both.ffp" --images -o "$work/first.tif" --quiet && "$bin/farfield-export" "$work/both.ffp" --images --layer other -o "$work/other.tif" --quiet &&
    "$bin/farfield-export" "$work/part.ffp" --images -o "$work/opaque.jpg" --quiet && "$bin/farfield-export" "$work/whole.ffp" --images -o "$work/all.tif" --quiet
result $? "images of either layer are exported"
is 'alpha("first") < 0.01 + covered("both") and alpha("first") > covered("both") and covered("both", 1) < alpha("other") < covered("both", 1) + 0.01 and bands("opaque.jpg") == bands("all.tif") == 3' \
    "with an alpha band where they end, clear beyond, but in JPEGs"
gdal_translate -q -srcwin 0 0 257 513 "$work/hills.tif" "$work/left.tif" && gdal_translate -q -srcwin 256 0 257 513 "$work/hills.tif" "$work/right.tif" &&
    "$bin/farfield-bake" "$work/left.tif" --hscale 0.1 --color "$work/part.tif" --quiet -o "$work/left.ffp" &&
    "$bin/farfield-bake" "$work/right.tif" --lattice "$work/left.ffp" --quiet -o "$work/right.ffp" &&
    "$bin/farfield-merge" "$work/left.ffp" "$work/right.ffp" --quiet -o "$work/merged.ffp" && "$bin/farfield-info" --json "$work/merged.ffp" >"$work/merged-info.json"
result $? "ground with an image and ground without are joined"
is '0.4 * covered("part") < covered("merged") < 0.8 * covered("part")' "what was not covered is not"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
