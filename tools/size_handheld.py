#!/usr/bin/env python3
"""size_handheld.py HANDHELD-DIR PLUGIN OUT: sizes of the cross-built client, as Markdown in OUT/size.md and on stdout.

Code by part of the program (from the linker map), what each feature left out saves, the largest stack frames (-fstack-usage), and the
4 KiB pages a flight touches: code and data executed, read or written, each counted once, which is what a system with demand paging keeps
resident. The tape takes the place of the link; its pages are not counted."""
import glob
import json
import os
import re
import subprocess
import sys

FEATURES = ["panorama", "textures", "network", "jpeg", "hud", "deflate"]
PARTS = [("protocol", r"obj/protocol/"), ("client/terrain", r"obj/client/terrain/"), ("client", r"obj/client/"),
         ("common3d/soft", r"obj/common3d/soft/"), ("common3d", r"obj/common3d/"), ("platform", r"obj/platform/"),
         ("program", r"obj/sim/"), ("zlib", r"libz\.a"), ("libjpeg", r"libjpeg\.a"), ("libc, libgcc", r".")]


def run(command):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def sections(path):
    word = run(["arm-linux-gnueabi-size", path]).splitlines()[1].split()
    return [int(w) for w in word[:3]]


def parts(path):
    """Bytes by part and kind, from the linker map."""
    text = re.sub(r"\n {16,}0x", " 0x", open(path + ".map").read().split("Linker script and memory map")[1])
    sums = {}
    for kind, size, obj in re.findall(r"^ \.(text|rodata|data|bss)\S*\s+0x[0-9a-f]{5,}\s+0x([0-9a-f]+)\s+(\S+)", text, re.M):
        part = next(name for name, pattern in PARTS if re.search(pattern, obj))
        key = "text" if kind == "text" else kind
        sums.setdefault(part, {}).setdefault(key, 0)
        sums[part][key] += int(size, 16)
    return sums


def stack(folder):
    frames = []
    for path in glob.glob(folder + "/obj/**/*.su", recursive=True):
        for line in open(path):
            where, size, kind = line.rstrip("\n").split("\t")
            frames.append((int(size), where.split(":")[0], where.split(":")[-1], kind))
    return sorted(frames, reverse=True)


def resident(program, plugin, folder, out):
    counts = out + "/pages.counts"
    figures = json.loads(run(["qemu-arm", "-cpu", "arm1136", "-plugin", "%s,out=%s,pages=1" % (plugin, counts), program, "--tape",
                              folder + "/size.tape", "--json"]))
    low, high = figures["mapping_at"] // 4096, (figures["mapping_at"] + figures["mapping_bytes"] - 1) // 4096
    image_end = max(int(at, 16) + int(size, 16) for at, size in re.findall(
        r"LOAD\s+0x\S+\s+0x(\S+)\s+0x\S+\s+0x\S+\s+0x(\S+)", run(["arm-linux-gnueabi-readelf", "-lW", program]))) // 4096
    pages = {"program (code and data)": 0, "block and heap": 0, "stack": 0}
    for line in open(counts):
        if line.startswith("page"):
            first, last = (int(w, 16) // 4096 for w in line.split()[1:])
            for page in range(first, last + 1):
                if low <= page <= high or page >= 0xffff0:
                    continue
                where = "program (code and data)" if page <= image_end else "stack" if page >= 0x40000 else "block and heap"
                pages[where] += 1
    os.remove(counts)
    return figures, pages


def main(folder, plugin, out):
    os.makedirs(out, exist_ok=True)
    full = folder + "/farfield-handheld"
    text = ["# Size of the handheld client", "", "armv6, soft float, -O2, static. Bytes.", "", "| part | text | rodata | data | bss |", "|---|---|---|---|---|"]
    sums = parts(full)
    for name, _ in PARTS:
        s = sums.get(name, {})
        text.append("| %s | %s |" % (name, " | ".join(str(s.get(k, 0)) for k in ("text", "rodata", "data", "bss"))))
    base = sections(full)
    text += ["", "| build | code and constants | data + bss | saved by leaving out |", "|---|---|---|---|",
             "| everything | %d | %d | |" % (base[0], base[1] + base[2])]
    for name in FEATURES + ["-".join(FEATURES)]:
        size = sections(full + "-no-" + name)
        label = "no " + name if name in FEATURES else "heights only, offline"
        text.append("| %s | %d | %d | %d |" % (label, size[0], size[1] + size[2], sum(base) - sum(size)))
    lean = parts(full + "-no-" + "-".join(FEATURES))
    ours = sum(sum(v.values()) for k, v in lean.items() if k in ("protocol", "client", "client/terrain", "common3d", "common3d/soft"))
    text += ["", "Heights only, offline, without C library and program: %d bytes." % ours, "", "| largest stack frames | bytes |", "|---|---|"]
    text += ["| %s, %s (%s) | %d |" % (f[2], f[1], f[3], f[0]) for f in stack(folder)[:8]]
    figures, pages = resident(full, plugin, folder, out)
    text += ["", "| touched in a flight (block of %d bytes) | KiB |" % figures["memory_bytes"], "|---|---|"]
    text += ["| %s | %d |" % (k, 4 * n) for k, n in pages.items()]
    text += ["| **all of the process** | **%d** |" % (4 * sum(pages.values())), "", "| pool | high-water mark |", "|---|---|"]
    text += ["| %s | %d |" % (k, figures[k]) for k in figures if "high" in k]
    text += ["| nodes, of capacity | %d of %d |" % (figures["nodes_high"], figures["nodes_capacity"])]
    open(out + "/size.md", "w").write("\n".join(text) + "\n")
    print("\n".join(text))


if __name__ == "__main__":
    main(*sys.argv[1:])
