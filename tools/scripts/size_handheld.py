#!/usr/bin/env python3
"""size_handheld.py HANDHELD-DIR PLUGIN PACK OUT FEATURE...: sizes of the cross-built client, as Markdown in OUT/size.md and on stdout.

Code by part of the program (from the linker map, by the rows of handheld_rows.py), what each feature left out saves, the most stack the core can take (stack_handheld.py), and
the 4 KiB pages a flight touches: code and data executed, read or written, each counted once, which is what a system with demand paging keeps
resident. The tape takes the place of the link; its pages are not counted. What each pool of the client's block held in that flight, and how
blocks of other sizes are shared out for the ground of PACK. Ends with an error when stack or memory pass their limits."""
import os
import re
import sys

import stack_handheld
from handheld_counts import QEMU, Counts, Program, die, map_sections, run
from handheld_rows import SIZES, NoRow, place_of

KINDS = ("text", "rodata", "data", "bss")
CORE = ("protocol", "client", "client/terrain", "common3d", "common3d/soft")
PAGE = 4096
RESIDENT_MAX = 8 << 20
PATHS = 7
BUDGET = "client/ff_budget.h"


def sections(path):
    word = run(["arm-linux-gnueabi-size", path]).splitlines()[1].split()
    return [int(w) for w in word[:3]]


def parts(path):
    """Bytes by part and kind, from the linker map."""
    sums = {part: dict.fromkeys(KINDS, 0) for part in SIZES.rows.values()}
    for kind, _, size, obj in map_sections(path + ".map"):
        sums[SIZES.of(place_of(obj))][kind if kind in KINDS else "text"] += size
    return sums


def resident(program, plugin, folder, out):
    """What the flight on tape said, and 4 KiB pages touched by kind."""
    counts = Counts(plugin, program, ["--tape", folder + "/size.tape"], out + "/pages.counts", ",pages=1")
    figures = counts.figures
    low, high = figures["mapping_at"] // PAGE, (figures["mapping_at"] + figures["mapping_bytes"] - 1) // PAGE
    image_end = max(int(at, 16) + int(size, 16) for at, size in re.findall(
        r"LOAD\s+0x\S+\s+0x(\S+)\s+0x\S+\s+0x\S+\s+0x(\S+)", run(["arm-linux-gnueabi-readelf", "-lW", program.path]))) // PAGE
    pages = {"program (code and data)": 0, "block and heap": 0, "stack": 0}
    for first, last in counts.pages:
        for page in range(first // PAGE, last // PAGE + 1):
            if low <= page <= high or page >= 0xffff0:
                continue
            pages["program (code and data)" if page <= image_end else "stack" if page >= 0x40000 else "block and heap"] += 1
    return figures, pages


def size_tables(full, features):
    text = ["| part | text | rodata | data | bss |", "|---|--:|--:|--:|--:|"]
    text += ["| %s | %s |" % (name, " | ".join(str(s[k]) for k in KINDS)) for name, s in parts(full).items()]
    base = sections(full)
    text += ["", "| build | code and constants | data + bss | saved by leaving out |", "|---|--:|--:|--:|",
             "| everything | %d | %d | |" % (base[0], base[1] + base[2])]
    for name in features + ["-".join(features)]:
        size = sections(full + "-no-" + name)
        label = "no " + name if name in features else "heights only, offline"
        text.append("| %s | %d | %d | %d |" % (label, size[0], size[1] + size[2], sum(base) - sum(size)))
    lean = parts(full + "-no-" + "-".join(features))
    return text + ["", "Heights only, offline, without C library and program: %d bytes." % sum(sum(lean[p].values()) for p in CORE)]


def stack_table(paths):
    text = ["| call | worst stack of the core, bytes | with the platform | by way of |", "|---|--:|--:|---|"]
    for core, whole, path in paths[:PATHS]:
        text.append("| `%s` | %d | %d | %s |" % (path[0], core, whole, stack_handheld.plain(path[1:])))
    return text + ["", "All calls of `client/farfield.h`, calls through pointers and libgcc, zlib and string functions included, no recursion; limit %d bytes. "
                   "With the platform: its own frames too, not those of libjpeg and the C library (the pages below have them)." % stack_handheld.LIMIT]


def memory_tables(figures, pages):
    text = ["| touched in a flight (block of %d bytes) | KiB |" % figures["memory_bytes"], "|---|--:|"]
    text += ["| %s | %d |" % (k, PAGE // 1024 * n) for k, n in pages.items()]
    return text + ["| **all of the process**, limit %d | **%d** |" % (RESIDENT_MAX // 1024, PAGE // 1024 * sum(pages.values()))]


def pool_tables(figures, plan):
    """The pools in that flight, each with the reason from its row in client/ff_budget.h; then blocks of other sizes."""
    why = dict(re.findall(r'^ +(?:X|PART)\((\w+), .*?"([^"]*)"\)', open(BUDGET).read(), re.S | re.M))
    if set(why) != set(figures["pools"]):
        die("%s has other rows than the program has pools" % BUDGET)
    text = ["| pool | high-water mark | of | bytes | what is in it |", "|---|--:|--:|--:|---|"]
    text += ["| %s%s | %d | %d | %d | %s |" % ("of it " if p["inside"] else "", name, p["high"], p["count"], p["bytes"], why[name])
             for name, p in figures["pools"].items()]
    text += ["| found no room | | | | %d nodes, %d images |" % (figures["pool_full"], figures["textures_full"]), "",
             "How blocks of other sizes are shared out, over a link with images and panoramas:", ""]
    return text + plan.splitlines()


def main(folder, plugin, pack, out, *features):
    os.makedirs(out, exist_ok=True)
    full = folder + "/farfield-handheld"
    try:
        paths = stack_handheld.worst_paths(full, "client/farfield.h")
    except stack_handheld.Unresolved as what:
        die("stack: %s" % what)
    plan = run([*QEMU, full, "--pack", pack, "--plan"])
    figures, pages = resident(Program(full), plugin, folder, out)
    text = ["# Size of the handheld client", "", "armv6, soft float, -O2, static. Bytes.", "", *size_tables(full, list(features)), "", *stack_table(paths), "",
            *memory_tables(figures, pages), "", *pool_tables(figures, plan)]
    open(out + "/size.md", "w").write("\n".join(text) + "\n")
    print("\n".join(text))
    if paths[0][0] > stack_handheld.LIMIT:
        die("the core takes up to %d bytes of stack, limit %d" % (paths[0][0], stack_handheld.LIMIT))
    if PAGE * sum(pages.values()) >= RESIDENT_MAX:
        die("the process touches %d KiB, limit %d" % (PAGE // 1024 * sum(pages.values()), RESIDENT_MAX // 1024))


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except NoRow as what:
        die(what)
