#!/bin/bash
# tools/scripts/bench_codec.py over small generated ground, ours alone: its files are well formed, no height is further off than was allowed,
# and codec trained takes fewer bits than deflate by a margin. What comes of peers that are missing, and how others' streams are made.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/bench_codec.$$
rm -rf "$work"
mkdir -p "$work"
export PYTHONDONTWRITEBYTECODE=1
. tests/rig/result.bash
case $bin in build/san/*) flavour="SAN=1" ;; *) flavour="BUILD=${bin%/bin}" ;; esac

MAKE="make -s $flavour" tools/scripts/bench_codec.py "$bin" "$work" --quick --no-peers >"$work/said" 2>"$work/error"
result $? "a quick bench $(tail -n 1 "$work/error")"
grep -q '^bench_codec: instructions are left out: ' "$work/said"; result $? "says that it cannot count"
"$bin/farfield-train" "$work/codec/downs.ffp,$work/codec/mountains.ffp" --output "$work/tables.c" && cmp "$work/tables.c" "$work/codec/hills/tables.c"
result $? "tables that are held out are trained on the other grounds"

cat >"$work/rows.py" <<'END'
import json, sys
rows = json.load(open(sys.argv[1], encoding="utf-8"))["rows"]
bits = {(r["ground"], r["error_m"], r["codec"], r["tables"], r["piece"]): r.get("bits_once", r["bits"]) for r in rows}
END
python3 - "$work/codec.json" <<END
$(cat "$work/rows.py")
assert len(rows) == len(bits) == 3 * 2 * 2 * 5, len(rows)
for r in rows:
    assert r["max_m"] <= r["error_m"] + 1e-6 and r["rms_m"] <= r["max_m"] and r["bits"] > 0, r
    assert r["max_m"] > 0.9 * r["error_m"] or not r["error_m"], r
END
result $? "every ground, error, codec and node has its row, and keeps the bound"
python3 - "$work/codec.json" <<END
$(cat "$work/rows.py")
for ground in ("hills", "downs"):
    for piece in (17, 9):
        deflate = bits[ground, 4, "deflate", "", piece]
        for tables, share in (("built in", 0.8), ("held out", 0.85)):
            mine = bits[ground, 4, "trained", tables, piece]
            assert mine < share * deflate, "%s, %d: %s %.3f, deflate %.3f" % (ground, piece, tables, mine, deflate)
for (ground, error, codec, tables, piece), mine in bits.items():
    deflate = bits[ground, error, "deflate", "", piece]
    assert (codec, tables) != ("trained", "built in") or mine < 1.02 * deflate, (ground, error, piece, mine, deflate)
END
result $? "at 4 m over hills, trained takes a fifth fewer bits than deflate, a seventh with tables held out; nowhere 2 % more"
python3 - "$work" <<'END'
import re, sys, xml.dom.minidom
folder = sys.argv[1]
text = open(folder + "/codec.md", encoding="utf-8").read()
for heading in ("Bits", "Errors", "Plots"):
    assert "\n## " + heading in text, heading
assert "\n## Targets" not in text and "\n## Instructions" not in text and "Ground is generated" in text
for block in re.findall(r"(?:^\|.*\n)+", text, re.M):
    assert len({len(re.findall(r"\|", line)) for line in block.splitlines()}) == 1, block
pictures = re.findall(r"!\[.*?\]\((.*?)\)", text)
assert pictures == ["codec-bits.svg"], pictures
svg = xml.dom.minidom.parse(folder + "/codec-bits.svg")
assert len(svg.getElementsByTagName("polyline")) == 3 * 4
END
result $? "tables and plot are well formed"

# ---- peers ----
python3 - "$work" <<'END'
import array, random, sys
sys.path.insert(0, "tools/scripts")
import codec_peers as peers

chance = random.Random(1)
grid = peers.Grid((70, 50), array.array("H", (900 + 40 * y + 3 * x + chance.randrange(9) for y in range(50) for x in range(70))))
piece = grid.crop(60, 40, 9, 9)
assert len(piece.heights) == 81 and piece.heights[80] == grid.heights[48 * 70 + 68]
for steps in (0, 1, 10, 300):
    worst = max(abs(a - b) for a, b in zip(grid.heights, grid.near(steps)))
    assert steps // 2 <= worst <= steps, (steps, worst)
low = peers.Grid((70, 50), array.array("H", (h % 251 for h in grid.heights)))
for peer in peers.installed(sys.argv[1])[0]:
    for ground in (grid, low, piece):
        for steps in (0, 3):
            decoded = peer.unpack(peer.pack(ground, steps), ground, steps)
            worst = max(abs(a - b) for a, b in zip(ground.heights, decoded))
            assert len(decoded) == len(ground.heights) and worst <= steps, (peer.name, steps, worst)
for kind in (peers.JpegLs, peers.Lerc):
    kind.library = "not-there.so"
for kind in (peers.Jpeg2000, peers.JpegXl):
    kind.program = "not-there"
found, missing = peers.installed("/tmp")
assert not found and len(missing) == 4 and "libcharls2" in missing[0] and "libjxl-tools" in missing[3], missing
END
result $? "pieces are cut out, peers that are here keep the bound, and one that is missing is named with its package"

[ "$failures" != 0 ] || rm -rf "$work"
exit $((failures > 0))
