#!/usr/bin/env python3
"""What a frame costs on the handheld, in ARM instructions, counted exactly.

Each flight is flown twice: by farfield-fly on this machine (audited against the true ground, and recorded on tape), then from the tape by
the cross-built farfield-handheld under qemu-arm with the counting plugin; it ends with an error unless both did the very same. Writes
OUT/handheld.md, OUT/handheld.json and OUT/work-precision.csv.

Bins of the phase table: the program's marks cut a frame into work (link, decoding), update and draw; within these, the linker map says
which object file an instruction belongs to."""
import argparse
import csv
import json
import os
import re

from handheld_counts import Counts, Program, die, run

SECONDS, SWEEP_SECONDS, SETTLE = "20", "6", 20
FLIGHT = ["--backend", "none", "--link", "umts", "--settle", str(SETTLE), "--sample", "0.5", "--audit", "on", "--check", "off"]
SWEEP = ["2:4", "3:4", "4:5", "6:5", "px:4", "px:2", "px:1"]
TARGET = 4.0e6
BINS = [  # first match counts: row of the table, pattern of the object's path
    ("inflate and residuals", r"ff_decode|ff_inflate|libz"),
    ("JPEG", r"libjpeg|/jpeg\.o|ff_intake_(face|texture)|ff_face_columns"),
    ("link and messages", r"ff_stream|ff_receive|ff_message|ff_bytes|ff_link|ff_intake|sim_tape|ff_local|ff_pack"),
    ("take in: prediction, pool", r"ff_predict|ff_pool|ff_evict|ff_new_data|ff_tree\.o|ff_terrain\.o|ff_key"),
    ("select: measure, restrict, cull", r"ff_select|ff_restrict|ff_measure|ff_view_cull|ff_sort"),
    ("rank: wishes, queue, prefetch", r"ff_wish|ff_request|ff_foresee|ff_motion|ff_refusals|client_rank"),
    ("panorama rules and faces", r"ff_panorama"),
    ("images: find, wish", r"ff_texture"),
    ("stitch and draw set-up", r"ff_terrain_view|ff_surface|ff_shade|ff_strips|ff_ground_frame|ff_sky|client_update|client\.o|client_carve"),
    ("transform", r"soft_(transform|clip|line)|c3d_camera|c3d_device|c3d_pool|c3d_edges|c3d_fixed"),
    ("rasterise", r"/soft/"),
    ("division, memory (libgcc, libc)", r"libgcc|libc\.a|libpthread"),
]


def row_of(obj):
    for name, pattern in BINS:
        if re.search(pattern, obj):
            return name
    return "other"


class Bench:
    def __init__(self, options):
        self.bin, self.handheld, self.plugin, self.pack, self.out = options.bin, options.handheld, options.plugin, options.pack, options.out
        self.program = Program(self.handheld)

    def count(self, name, arguments):
        return Counts(self.plugin, self.handheld, arguments, "%s/%s.counts" % (self.out, name))

    def tape(self, name, quality, panorama, seconds):
        """A flight on this machine, on tape; its path and the auditor's rows after settling."""
        tape, table = "%s/%s.tape" % (self.out, name), "%s/%s.csv" % (self.out, name)
        run([self.bin + "/farfield-fly", "--pack", self.pack, *FLIGHT, "--seconds", seconds, "--quality", quality, "--panorama", panorama, "--tape", tape,
             "--csv", table])
        return tape, [r for r in csv.DictReader(open(table)) if float(r["t_s"]) > SETTLE and r["err_px_rms"] not in ("", "nan")]

    def rows(self, counts):
        """Instructions by phase and row of the table."""
        sums = {}
        for address, length, executions in counts.blocks:
            row = row_of(self.program.object_of(address))
            for phase in ("work", "update", "draw"):
                sums[phase, row] = sums.get((phase, row), 0) + length * executions[phase]
        return sums

    def fly(self, name, quality, panorama, seconds):
        tape, rows = self.tape(name, quality, panorama, seconds)
        counts = self.count(name, ["--tape", tape, "--fb", "%s/%s.ppm" % (self.out, name)])
        figures, frames, by_row, n = counts.figures, counts.frames, self.rows(counts), len(counts.frames)
        if not n or not rows:
            die("%s: nothing was drawn" % name)
        cost = sorted(counts.costs())
        mean = lambda key: sum(float(r[key]) for r in rows) / len(rows)
        return {"quality": quality, "panorama": panorama, "frames": n,
                "triangles": figures["triangles_mean"], "triangles_max": figures["triangles_max"],
                "instructions": sum(cost) / n, "instructions_p95": cost[min(n - 1, n * 95 // 100)], "instructions_max": cost[-1],
                "update": sum(f["update"] for f in frames) / n, "draw": sum(f["draw"] for f in frames) / n, "work": sum(f["work"] for f in frames) / n,
                "err_px_rms": (sum(float(r["err_px_rms"]) ** 2 for r in rows) / len(rows)) ** 0.5, "err_px_p95": mean("err_px_p95"),
                "panorama_px_percent": mean("panorama_px_percent"), "undrawn_px_percent": mean("undrawn_px_percent"),
                "bytes_down": figures["bytes_down"], "high_water": {k: figures[k] for k in figures if "high" in k or "memory" in k},
                "phases": [{"phase": p, "what": r, "per_frame": c / n} for (p, r), c in sorted(by_row.items(), key=lambda i: -i[1]) if c]}


def million(value):
    return "%.3f" % (value / 1e6)


def report(low, sweep, memory):
    out = ["# A frame on the handheld, in ARM instructions", "",
           "armv6, soft float, `-O2`, counted exactly under qemu-arm; 240x320, RGB565; 150 km/h over 20 s after settling. A frame is",
           "update and draw; work is link and decoding, reported apart.", "",
           "| low quality (C 3, depth 4), textured, panorama | |", "|---|---|",
           "| instructions a frame, mean (M) | **%s** (target %s) |" % (million(low["instructions"]), million(TARGET)),
           "| 95th percentile, maximum (M) | %s, %s |" % (million(low["instructions_p95"]), million(low["instructions_max"])),
           "| link and decoding, a frame (M) | %s |" % million(low["work"]),
           "| triangles a frame, mean (max) | %d (%d) |" % (low["triangles"], low["triangles_max"]),
           "| pixels filled a frame | %d (all of the picture, each once) |" % (240 * 320),
           "| err_px RMS, 95th percentile | %.3f, %.3f |" % (low["err_px_rms"], low["err_px_p95"]),
           "| of the picture's ground from the panorama | %.1f %% |" % low["panorama_px_percent"],
           "| at 332 MHz and 1.6 cycles an instruction | %.1f frames/s |" % (332e6 / 1.6 / low["instructions"]), "",
           "## Where it goes", "", "| phase | what | M a frame | share of update and draw |", "|---|---|---|---|"]
    for row in low["phases"]:
        if row["per_frame"] >= 500:
            share = "apart" if row["phase"] == "work" else "%.1f %%" % (100 * row["per_frame"] / low["instructions"])
            out.append("| %s | %s | %s | %s |" % (row["phase"], row["what"], million(row["per_frame"]), share))
    out += ["", "## Work and precision", "", "| quality | panorama | M a frame | triangles | err_px RMS | err_px p95 | not drawn % |",
            "|---|---|---|---|---|---|---|"]
    for s in sweep:
        out.append("| %s | %s | %s | %d | %.3f | %.3f | %.2f |" % (s["quality"], s["panorama"], million(s["instructions"]), s["triangles"],
                   s["err_px_rms"], s["err_px_p95"], s["undrawn_px_percent"]))
    out += ["", "## Memory", "", "| block | flown | pool full | M a frame | triangles | err_px as seen by the tree |", "|---|---|---|---|---|---|"]
    out += ["| %s | %s |" % (name, text) for name, text in memory]
    return "\n".join(out) + "\n"


def memory_rows(bench):
    """The same local flight in blocks of several sizes."""
    rows = []
    for size in ("8M", "4M", "2M", "1M", "768K"):
        counts = bench.count("memory", ["--pack", bench.pack, "--frames", "60", "--memory", size])
        f = counts.figures
        rows.append((size, "%d of 60 frames, %d of %d nodes | %d | %s | %d | %.1f" % (
            f["frames_drawn"], f["nodes_high"], f["nodes_capacity"], f["pool_full"],
            million(sum(counts.costs()) / max(1, len(counts.frames))), f["triangles_mean"], f["tree_err_px_q8"] / 256)))
    return rows


def functions(bench, most):
    """The functions that cost most, in the low-quality flight."""
    counts = bench.count("functions", ["--tape", bench.tape("functions", "low", "on", SECONDS)[0]])
    n, sums = len(counts.frames), {}
    for address, length, executions in counts.blocks:
        name, entry = bench.program.function_of(address)
        s = sums.setdefault((name, os.path.basename(bench.program.object_of(address))), {"calls": 0, "work": 0, "update": 0, "draw": 0})
        for phase in ("work", "update", "draw"):
            s[phase] += length * executions[phase]
            s["calls"] += executions[phase] * entry
    whole = sum(counts.costs()) / n
    print("%.4f M a frame (p95 %.4f, max %.4f), %d triangles; work apart %.4f. Inlined functions count where they are inlined." % (
          whole / 1e6, sorted(counts.costs())[n * 95 // 100] / 1e6, max(counts.costs()) / 1e6, counts.figures["triangles_mean"],
          sum(s["work"] for s in sums.values()) / n / 1e6))
    print("%9s %6s %9s %9s %9s %9s  %s" % ("a frame", "%", "update", "draw", "(work)", "calls", "function, object"))
    for (name, obj), s in sorted(sums.items(), key=lambda i: -i[1]["update"] - i[1]["draw"])[:most]:
        cost = s["update"] + s["draw"]
        print("%9d %6.2f %9d %9d %9d %9.1f  %s, %s" % (cost / n, 100 * cost / n / whole, s["update"] / n, s["draw"] / n, s["work"] / n, s["calls"] / n, name, obj))


def main():
    parser = argparse.ArgumentParser(prog="bench_handheld.py", description=__doc__.split("\n\n")[0])
    for name in ("bin", "handheld", "plugin", "pack", "out"):
        parser.add_argument(name)
    parser.add_argument("--quick", action="store_true", help="the low-quality flight only")
    parser.add_argument("--functions", nargs="?", type=int, const=40, metavar="N", help="print the N functions that cost most, and nothing else")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    bench = Bench(options)
    if options.functions:
        functions(bench, options.functions)
        return
    low = bench.fly("low", "low", "on", SECONDS)
    if sum(bench.count("low", ["--tape", options.out + "/low.tape"]).costs()) / low["frames"] != low["instructions"]:
        die("counted twice, different numbers")
    sweep = [] if options.quick else [bench.fly("sweep", quality, panorama, SWEEP_SECONDS) for panorama in ("on", "off") for quality in SWEEP]
    memory = [] if options.quick else memory_rows(bench)
    text = report(low, sweep, memory)
    open(options.out + "/handheld.md", "w").write(text)
    json.dump({"low": low, "sweep": sweep, "memory": memory, "target": TARGET}, open(options.out + "/handheld.json", "w"), indent=1)
    with open(options.out + "/work-precision.csv", "w", newline="") as f:
        keys = ["quality", "panorama", "instructions", "triangles", "err_px_rms", "err_px_p95", "work", "update", "draw"]
        table = csv.DictWriter(f, keys, extrasaction="ignore")
        table.writeheader()
        table.writerows(sweep)
    print(text, end="")


if __name__ == "__main__":
    main()
