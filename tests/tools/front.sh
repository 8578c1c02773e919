#!/bin/bash
# tools/scripts/front.py over two small packs: its files are well formed, flown flights are not flown again, and the same table comes every
# time; front_rule.py: which setting is dominated, by what, and what is compared with the balance, on flights made up for it.
set -u
cd "$(dirname "$0")/../.." || exit 2
bin=${BIN:-build/bin}
work=build/tests/front.$$
rm -rf "$work"
mkdir -p "$work"
export PYTHONDONTWRITEBYTECODE=1
. tests/rig/result.bash
sweep() { # OUT [VARIABLE=VALUE...]
    local out=$1
    shift
    env QUICK=1 FRONT_PACKS="$work/hills.ffp $work/fractal.ffp" "$@" tools/scripts/front.py "$bin" "$out" >"$work/said" 2>"$work/error"
}

# ---- the rule ----
cat >"$work/made-up.csv" <<'END'
ground,height_m,link,setting,kind,triangles,bytes,err_px_p95
alps,100,umts,default,named,5000,20000,2
alps,100,umts,just-ten-percent,swept,4500,18000,1.8
alps,100,umts,less-in-two,swept,100,100,1.81
alps,100,umts,low,named,4000,20000,2
alps,100,gprs,default,named,5000,20000,2
alps,100,gprs,other-link-counts-apart,swept,4600,100,0.1
alps,2000,umts,default,named,5000,20000,8
alps,2000,umts,half,swept,2500,5000,2
alps,2000,umts,nearly-half,swept,2600,100,0.1
alps,2000,umts,another-named,named,100,100,0.1
sea,100,umts,default,named,5000,20000,0
sea,100,umts,nothing-is-less-than-0,swept,100,100,0
sea,600,umts,default,named,5000,20000,
sea,600,umts,not-judged,swept,100,100,0.1
END
tools/scripts/front_rule.py "$work/made-up.csv" >"$work/standing"
result $? "named settings of a made-up table"
grep -q '^default 4 2 2\.000 alps 2000 umts half$' "$work/standing"; result $? "dominated where all three are a tenth less; the worst factor, where and by what"
grep -q '^low 1 0$' "$work/standing"; result $? "not where one of the three is not"
python3 - <<'END'
import sys
sys.path.insert(0, "tools/scripts")
import front_rule as rule

def row(setting, triangles, size, error, windows=()):
    return {"setting": setting, "triangles": triangles, "bytes": size, "err_px_p95": error, "windows": list(windows)}

rows = [row("a", 1, 9, 9), row("b", 9, 1, 9), row("c", 9, 9, 1), row("worse", 9, 9, 2), row("twin of c", 9, 9, 1), row("far", 99, 99, 0.5)]
assert [r["setting"] for r in rule.front(rows)] == ["a", "b", "c", "far"], rule.front(rows)
assert rule.within(rows, 9)["setting"] == "c" and rule.within(rows, 1)["setting"] == "a" and rule.within(rows, 0) is None
fixed = [row("dear", 0, 0, 0, [(5300, 10, 0.1)]), row("long", 0, 0, 0, [(5000, 106, 0.1)]), row("fair", 0, 0, 0, [(5200, 104, 1.0)]),
         row("blurred", 0, 0, 0, [(10, 10, 3.0)]), row("blind", 0, 0, 0, [(10, 10, None)])]
factor, by = rule.against_fixed((5000, 100, 1.5), 0, fixed)
assert by["setting"] == "fair" and factor == 1.5
assert rule.against_fixed((5000, 100, 0.5), 0, fixed)[0] == 1
assert rule.against_fixed((1, 1, 0.5), 0, fixed) is None
balanced = row("balance 1000", 700, 0, 1.0)
assert rule.needs_more(balanced, 1000, [row("finer", 1500, 0, 0.8)]) and not rule.needs_more(balanced, 1000, [row("finer", 1500, 0, 0.81)])
assert not rule.needs_more(balanced, 1000, [row("enough", 900, 0, 0.1)])

import front_report as report
there = {"ground": "alps", "height_m": 100, "link": "umts", "speed_kmh": 150, "course": "front", "skyline_px_rms": 0, "undrawn_px_percent": 0}
made = lambda kind, *figures: {**row(*figures), **there, "kind": kind}
lines = report.balance_lines([made("named", "balance 5000", 4000, 10, 1, [(4000, 10, 1), (4000, 10, 1.2), (4000, 10, 1.21), (100, 1, 9)]),
                              made("swept", "finer", 9000, 10, 0.8, [(4000, 10, 1)] * 4)])
assert [(line["used"], line["needs"], line["windows"], line["late"], line["worst"][0]) for line in lines] == [(80, True, 3, 1, 1.21)], lines
target = {"setting": "default", "link": "umts", "speed": 150, "err_px_p95": 2.0, "triangles": 5500}
flown = [made("named", "default", *figures) for figures in ((5500, 10, 2), (5501, 10, 2), (5500, 10, 2.01), (5500, 10, None))]
assert report.target_table(flown, target).startswith("3 of 4 missed."), report.target_table(flown, target)
END
result $? "the front's members, the best within a budget, what the balance is held against, and what counts as missed"

# ---- the sweep ----
python3 tests/rig/hills.py 129 "$work/hills.raw" 129:fractal "$work/fractal.raw"
for kind in hills fractal; do "$bin/farfield-bake" "$work/$kind.raw" --raw 129x129 --spacing 80 --quiet -o "$work/$kind.ffp"; done
sweep "$work/one"
result $? "a quick sweep"
python3 - "$work/one/quick" <<'END'
import csv, re, sys, xml.dom.minidom
folder = sys.argv[1]
rows = list(csv.DictReader(open(folder + "/front.csv", encoding="utf-8")))
settings = {r["setting"] for r in rows if r["course"] == "front"}
points = {(r["ground"], r["height_m"], r["link"]) for r in rows if r["course"] == "front"}
assert len(points) == 4 and len(settings) == 11 and {"default", "balance 2500", "px:4 off"} <= settings, (points, settings)
assert len(rows) == 4 * 11 + 2 * 2, len(rows)
for r in rows:
    assert None not in r and None not in r.values()
    assert float(r["triangles"]) > 0 and float(r["bytes"]) > 0 and float(r["err_px_p95"]) >= 0, r
    assert len(r["windows"].split()) == 2 and all(len(w.split(":")) == 3 for w in r["windows"].split()), r
text = open(folder + "/front.md", encoding="utf-8").read()
for heading in ("Named settings and the front", "A stranger's ground", "The balance", "Plots", "The front at each point"):
    assert "\n## " + heading in text, heading
for block in re.findall(r"(?:^\|.*\n)+", text, re.M):
    assert len({len(re.findall(r"\|", line)) for line in block.splitlines()}) == 1, block
pictures = re.findall(r"!\[.*?\]\((.*?)\)", text)
assert len(pictures) == 2
for name in pictures:
    svg = xml.dom.minidom.parse(folder + "/" + name)
    assert len(svg.getElementsByTagName("polyline")) == 4 and len(svg.getElementsByTagName("path")) == 1 + 4 * 4
END
result $? "every flight has its row; tables and plots are well formed"
cp "$work/one/quick/front.csv" "$work/first.csv"
cp "$work/one/quick/front.md" "$work/first.md"
grep -v '^fractal,front,2000,150,umts,high' "$work/first.csv" >"$work/one/quick/front.csv"
head -c -100 "$work/one/quick/front.csv" >"$work/cut" && mv "$work/cut" "$work/one/quick/front.csv"
sweep "$work/one"
grep -q '^== 48 flights, 46 of them flown before$' "$work/said"; result $? "flown flights are not flown again; one missing and one broken off are"
cmp -s "$work/one/quick/front.csv" "$work/first.csv" && cmp -s "$work/one/quick/front.md" "$work/first.md"
result $? "and the files are those of before"
sweep "$work/two"
cmp -s "$work/two/quick/front.csv" "$work/first.csv" && cmp -s "$work/two/quick/front.md" "$work/first.md" &&
    cmp -s "$work/one/quick/front-umts-bytes.svg" "$work/two/quick/front-umts-bytes.svg"
result $? "the same sweep gives the same files, byte for byte"
head -c 5000 "$work/hills.ffp" >"$work/short" && mv "$work/short" "$work/hills.ffp"
! sweep "$work/one" && [ "$(grep -c . "$work/error")" = 1 ] && grep -q '^front: farfield-fly: ' "$work/error"
result $? "a damaged pack is one line and an error"
[ $failures = 0 ] && rm -rf "$work"
exit $((failures > 0))
