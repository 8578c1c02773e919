#!/usr/bin/env python3
"""What a frame costs on the handheld, in ARM instructions, counted exactly.

Each flight is flown twice: by farfield-fly on this machine (audited against the true ground, and recorded on tape), then from the tape by
the cross-built farfield-handheld under qemu-arm with the counting plugin; it ends with an error unless both did the very same. Writes
OUT/handheld.md, OUT/handheld.json and OUT/work-precision.csv.

The program's marks cut a frame into work (link, decoding), update and draw; within these, the linker map says which object file an
instruction belongs to, and handheld_rows.py which row that counts to. Helpers (division, memset, ...) count to the file that called them."""
import argparse
import csv
import json
import os

from handheld_counts import Counts, Program, die, run
from handheld_rows import MARKS, NoRow, phase_of, without_row

SECONDS, PLACE_SECONDS, SWEEP_SECONDS, SETTLE = "20", "10", "6", 20
START, PLACES = "0.4", ("0.2", "0.3", "0.4", "0.5", "0.6")  # parts of the diagonal
FLIGHT = ["--backend", "none", "--link", "umts", "--settle", str(SETTLE), "--sample", "0.5", "--audit", "on", "--check", "off"]
SWEEP = ["2:4", "3:4", "4:5", "6:5", "px:4", "px:2", "px:1", "low", "medium", "high"]
FAR_MEMORY, FAR_SECONDS, FAR_HEIGHTS = "8M", "10", ("600", "2000")
FAR_FLIGHT = ["--backend", "soft565", "--diff", "on", "--speed", "900"]
FAR_SETTINGS = (("off", "medium"), ("fins", "medium"), ("paint", "medium"), ("auto", "medium"), ("off", "px:2"))  # medium: 5486 triangles at most
SWEEP_MEMORY = "16M"  # where a pool is full the flight depends on its capacity, which differs between machines
BLOCKS = ("8M", "4M", "2M", "1M", "768K")
TARGET = 4.0e6
PHASES = ("take in", "select", "stitch", "transform", "rasterise", "decode")
FILLERS = ("soft_tiny", "soft_small", "soft_perspective")  # each takes what the one before could not, of triangles left after culling
CLEARING = ("memcpy", "memset")


def million(value):
    return "%.3f" % (value / 1e6)


class Bench:
    def __init__(self, options, pack):
        self.bin, self.handheld, self.plugin, self.pack, self.out = options.bin, options.handheld, options.plugin, pack, options.out
        self.program = Program(self.handheld)
        wrong = without_row(set(self.program.places))
        if wrong:
            die("\n".join(wrong))

    def count(self, name, arguments, options=""):
        return Counts(self.plugin, self.program, arguments, "%s/%s.counts" % (self.out, name), options)

    def tape(self, name, quality, panorama, seconds, memory="4M", start=START, more=()):
        """A flight on this machine, on tape; its path and the auditor's rows after settling."""
        tape, table = "%s/%s.tape" % (self.out, name), "%s/%s.csv" % (self.out, name)
        run([self.bin + "/farfield-fly", "--pack", self.pack, *FLIGHT, "--seconds", seconds, "--quality", quality, "--panorama", panorama,
             "--start", start, "--memory", memory, "--tape", tape, "--csv", table, *more])
        return tape, [r for r in csv.DictReader(open(table)) if float(r["t_s"]) > SETTLE and r["err_px_rms"] not in ("", "nan")]

    def phases(self, counts):
        """Instructions a frame by row of the table."""
        sums = {}
        for address, length, executions, helped in counts.blocks:
            place = self.program.place_of(address)
            for mark in MARKS:
                cost = helped[mark] + (0 if self.program.is_helper(address) else length * executions[mark])
                if cost:
                    row = phase_of(mark, place)
                    sums[row] = sums.get(row, 0) + cost / len(counts.frames)
        return sums

    def fly(self, name, quality, panorama, seconds, memory="4M", start=START, more=()):
        tape, rows = self.tape(name, quality, panorama, seconds, memory, start, more)
        counts = self.count(name, ["--tape", tape, "--fb", "%s/%s.ppm" % (self.out, name)])
        figures, frames, n = counts.figures, counts.frames, len(counts.frames)
        if not n or not rows:
            die("%s: nothing was drawn" % name)
        if figures["pool_full"]:
            die("%s: the pool is full" % name)
        cost = sorted(counts.costs())
        mean = lambda key: sum(float(r[key]) for r in rows) / len(rows)
        flown = {"quality": quality, "panorama": panorama, "start": start, "frames": n,
                 "triangles": figures["triangles_mean"], "triangles_max": figures["triangles_max"],
                 "triangles_submitted": figures["triangles_submitted_mean"], "triangles_rasterised": {name: self.calls(counts, name) / n for name in FILLERS},
                 "instructions": sum(cost) / n, "instructions_p95": cost[min(n - 1, n * 95 // 100)], "instructions_max": cost[-1],
                 "err_px_rms": (sum(float(r["err_px_rms"]) ** 2 for r in rows) / len(rows)) ** 0.5, "err_px_p95": mean("err_px_p95"),
                 "panorama_px_percent": mean("panorama_px_percent"), "undrawn_px_percent": mean("undrawn_px_percent"),
                 "bytes_down": figures["bytes_down"], "high_water": {k: figures[k] for k in figures if "high" in k or "memory" in k},
                 "phases": [{"phase": p, "what": w, "per_frame": c} for (p, w), c in sorted(self.phases(counts).items(), key=lambda i: -i[1])]}
        flown.update({mark: sum(f[mark] for f in frames) / n for mark in MARKS})
        flown.update({key: mean(key) for key in ("skyline_px_rms", "diff_mean") if rows[0].get(key)})
        return flown

    def far(self):
        """Sets beside none, at as many triangles and at as many as 2 pixels of error ask for."""
        return [dict(self.fly("far", quality, "off", FAR_SECONDS, FAR_MEMORY, more=[*FAR_FLIGHT, "--far", far, "--height", height]), far=far, height=height)
                for height in FAR_HEIGHTS for far, quality in FAR_SETTINGS]

    def calls(self, counts, name):
        return sum(e["draw"] for address, _, e, _ in counts.blocks if self.program.function_of(address) == (name, True))

    def pixels(self, tape):
        """Pixels a frame, from every access to the picture and to the depths behind it (see c3d_soft.c) while drawing: written; tested:
        depths read by functions that write pixels; cleared. The pictures must be those that this machine draws from the tape."""
        flight = ["--tape", tape, "--hash"]
        here = json.loads(run([self.bin + "/farfield-handheld", *flight, "--json"]))
        at, size = (self.count("pixels", flight).figures[k] for k in ("pixels_at", "pixels_bytes"))
        counts = self.count("pixels", flight, ",watch=%x:%d,watch=%x:%d" % (at, size, at + size, 2 * size))
        if counts.figures["pictures_hash"] != here["pictures_hash"]:
            die("the pictures differ from those drawn by this machine")
        if counts.figures["pixels_at"] != at:
            die("the picture lies elsewhere in every run: its pixels cannot be counted")
        sums, n = {}, len(counts.frames)
        for area, address, read, written in counts.watched:
            s = sums.setdefault(self.program.function_of(address)[0], {"written": 0, "read": 0, "marked": 0})
            s["written" if area == 0 else "marked"] += written / (2, 4)[area] / n
            s["read"] += read / 4 / n if area == 1 else 0
        drawing = [s for name, s in sums.items() if name not in CLEARING and s["written"]]
        written, marked = sum(s["written"] for s in drawing), sum(s["marked"] for s in drawing)
        found = marked > written / 4 and all(s["marked"] < s["written"] + 1 for s in drawing) # what marks depths writes pixels: they are there
        return {"written": written, "cleared": sum(s["written"] for name, s in sums.items() if name in CLEARING),
                "tested": sum(s["read"] for s in drawing) if found else None,
                "pictures_hash": here["pictures_hash"]}


def phase_table(low):
    out = ["| phase | what | M a frame | share of a frame |", "|---|---|--:|--:|"]
    for phase in PHASES:
        rows = [r for r in low["phases"] if r["phase"] == phase]
        whole = sum(r["per_frame"] for r in rows)
        share = lambda cost: "apart" if phase == "decode" else "%.1f %%" % (100 * cost / low["instructions"])
        out.append("| **%s** | | **%s** | %s |" % (phase, million(whole), share(whole)))
        if len(rows) > 1:
            out += ["| | %s | %s | %s |" % (r["what"], million(r["per_frame"]), share(r["per_frame"])) for r in rows if r["per_frame"] >= 500]
    return out


def place_table(places):
    row = lambda name, p: "| %s | %s | %s | %d | %.3f | %.3f |" % (
        name, million(p["instructions"]), million(p["instructions_p95"]), p["triangles"], p["err_px_rms"], p["err_px_p95"])
    mean = {key: sum(p[key] for p in places) / len(places) for key in ("instructions", "instructions_p95", "triangles", "err_px_rms", "err_px_p95")}
    return ["## Low quality (C 3, depth 4), textured, with panorama, at %d places, %s s each" % (len(places), PLACE_SECONDS), "",
            "| from, of the diagonal | M a frame | p95 | triangles | err_px RMS | err_px p95 |", "|---|--:|--:|--:|--:|--:|",
            *[row(p["start"], p) for p in places], row("**mean** (target %s at 5000 triangles)" % million(TARGET), mean), ""]


def far_tables(bench, flights):
    """Cost and error of each flight, then its rows side by side."""
    cost = lambda f, row: sum(r["per_frame"] for r in f["phases"] if (r["phase"], r["what"]) == row)
    rows = sorted({(r["phase"], r["what"]) for f in flights for r in f["phases"]}, key=lambda row: (PHASES.index(row[0]), row[1]))
    out = ["## Far ground: fins and paint", "",
           "Over %s, without panoramas, UMTS, 900 km/h, %s s; medium: 2 pixels of error and a triangle for 14 pixels at most." % (
               os.path.basename(bench.pack), FAR_SECONDS), "",
           "| height, m | far | quality | M a frame | p95 | decode | triangles, submitted | skyline px RMS | luminance off, of 255 |",
           "|--:|---|---|--:|--:|--:|--:|--:|--:|"]
    out += ["| %s | %s | %s | %s | %s | %s | %d, %d | %.2f | %.2f |" % (
        f["height"], f["far"], f["quality"], million(f["instructions"]), million(f["instructions_p95"]), million(f["work"]), f["triangles"],
        f["triangles_submitted"], f["skyline_px_rms"], f["diff_mean"]) for f in flights]
    out += ["", "| M a frame | %s |" % " | ".join("%s m, %s, %s" % (f["height"], f["far"], f["quality"]) for f in flights),
            "|---|" + "--:|" * len(flights)]
    out += ["| %s | %s |" % (": ".join(filter(None, row)), " | ".join(million(cost(f, row)) for f in flights)) for row in rows]
    return out + [""]


def report(bench, low, places, sweep, memory, far_bench, far):
    pixels, known = low["pixels"], lambda n: "%d" % n if n else "not known"
    out = ["# A frame on the handheld, in ARM instructions", "",
           "armv6, soft float, `-O2`, counted exactly under qemu-arm; 240x320, RGB565, over %s; UMTS, 150 km/h, after %d s of settling." %
           (os.path.basename(bench.pack), SETTLE),
           "A frame is update and draw; decode (link, messages, decoding) is apart.", "",
           *place_table(places),
           "| from %s on, %s s | |" % (low["start"], SECONDS), "|---|---|",
           "| instructions a frame, mean (M) | %s |" % million(low["instructions"]),
           "| 95th percentile, maximum (M) | %s, %s |" % (million(low["instructions_p95"]), million(low["instructions_max"])),
           "| decode, a frame (M) | %s |" % million(low["work"]),
           "| triangles of the ground a frame, mean (max) | %d (%d) |" % (low["triangles"], low["triangles_max"]),
           "| triangles submitted; rasterised after culling: %s | %d; %s |" % (
               ", of these ".join(FILLERS), low["triangles_submitted"], ", ".join("%d" % c for c in low["triangles_rasterised"].values())),
           "| pixels of the picture | %d |" % (240 * 320),
           "| pixels written; tested for depth; cleared first | %d; %s; %d |" % (pixels["written"], known(pixels["tested"]), pixels["cleared"]),
           "| err_px RMS, 95th percentile | %.3f, %.3f |" % (low["err_px_rms"], low["err_px_p95"]),
           "| of the picture's ground from the panorama | %.1f %% |" % low["panorama_px_percent"],
           "| at 332 MHz and 1.6 cycles an instruction | %.1f frames/s |" % (332e6 / 1.6 / low["instructions"]),
           "| all %d pictures, here and there | hash %s |" % (low["frames"], pixels["pictures_hash"]), "",
           "## Where it goes", "", *phase_table(low), "", *far_tables(far_bench, far)]
    if sweep:
        out += ["## Work and precision", "", "In a block of %s, so that every quality finds room; what smaller blocks show is told below." % SWEEP_MEMORY, "",
                "| quality | panorama | M a frame | p95 | triangles | err_px RMS | err_px p95 | not drawn % |",
                "|---|---|--:|--:|--:|--:|--:|--:|"]
    for s in sweep:
        out.append("| %s | %s | %s | %s | %d | %.3f | %.3f | %.2f |" % (s["quality"], s["panorama"], million(s["instructions"]),
                   million(s["instructions_p95"]), s["triangles"], s["err_px_rms"], s["err_px_p95"], s["undrawn_px_percent"]))
    if memory:
        out += ["", "## Memory", "", "| block | frames drawn | nodes, of capacity | pool full | M a frame | triangles | err_px as seen by the tree |",
                "|---|---|---|--:|--:|--:|--:|", *memory]
    return "\n".join(out) + "\n"


def memory_rows(bench):
    """The same flight over the pack in blocks of several sizes."""
    rows = []
    for size in BLOCKS:
        counts = bench.count("memory", ["--pack", bench.pack, "--frames", "60", "--memory", size])
        f = counts.figures
        rows.append("| %s | %d of 60 | %d of %d | %d | %s | %d | %.1f |" % (
            size, f["frames_drawn"], f["nodes_high"], f["nodes_capacity"], f["pool_full"],
            million(sum(counts.costs()) / max(1, len(counts.frames))), f["triangles_mean"], f["tree_err_px_q8"] / 256))
    return rows


def functions(bench, most):
    """The functions that cost most, in the low-quality flight."""
    counts = bench.count("functions", ["--tape", bench.tape("functions", "paper-low", "on", SECONDS)[0]])
    n, sums = len(counts.frames), {}
    for address, length, executions, helped in counts.blocks:
        name, entry = bench.program.function_of(address)
        s = sums.setdefault((name, os.path.basename(bench.program.place_of(address))),
                            {"calls": 0, "helped": 0, "work": 0, "update": 0, "draw": 0})
        s["helped"] += helped["update"] + helped["draw"]
        for mark in MARKS:
            s[mark] += length * executions[mark]
            s["calls"] += executions[mark] * entry
    cost = counts.costs()
    print("%.4f M a frame (p95 %.4f, max %.4f), %d triangles; work apart %.4f. Inlined functions count where they are inlined." % (
          sum(cost) / n / 1e6, sorted(cost)[n * 95 // 100] / 1e6, max(cost) / 1e6, counts.figures["triangles_mean"],
          sum(s["work"] for s in sums.values()) / n / 1e6))
    print("%9s %6s %9s %9s %9s %9s %9s  %s" % ("a frame", "%", "update", "draw", "(helpers", "(work)", "calls", "function, object"))
    print("%9s %6s %9s %9s %9s" % ("", "", "", "", "called)"))
    for (name, obj), s in sorted(sums.items(), key=lambda i: -i[1]["update"] - i[1]["draw"])[:most]:
        whole = s["update"] + s["draw"]
        print("%9d %6.2f %9d %9d %9d %9d %9.1f  %s, %s" % (whole / n, 100 * whole / sum(cost), s["update"] / n, s["draw"] / n, s["helped"] / n,
                                                         s["work"] / n, s["calls"] / n, name, obj))


def write_curve(path, sweep):
    with open(path, "w", newline="") as f:
        keys = ["quality", "panorama", "instructions", "instructions_p95", "triangles", "err_px_rms", "err_px_p95", "work", "update", "draw"]
        table = csv.DictWriter(f, keys, extrasaction="ignore")
        table.writeheader()
        table.writerows(sweep)


def main():
    parser = argparse.ArgumentParser(prog="bench_handheld.py", description=__doc__.split("\n\n")[0])
    for name in ("bin", "handheld", "plugin", "pack", "far_pack", "out"):
        parser.add_argument(name)
    parser.add_argument("--quick", action="store_true", help="the low-quality flight and the sets only")
    parser.add_argument("--far", action="store_true", help="print the tables of sets, and nothing else")
    parser.add_argument("--functions", nargs="?", type=int, const=40, metavar="N", help="print the N functions that cost most, and nothing else")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    bench, far_bench = Bench(options, options.pack), Bench(options, options.far_pack)
    if options.functions:
        functions(bench, options.functions)
        return
    far = far_bench.far()
    if options.far:
        print("\n".join(far_tables(far_bench, far)))
        return
    low = bench.fly("low", "paper-low", "on", SECONDS)
    places = [bench.fly("place", "paper-low", "on", PLACE_SECONDS, start=start) for start in PLACES]
    low["pixels"] = bench.pixels(options.out + "/low.tape")
    if sum(bench.count("low", ["--tape", options.out + "/low.tape"]).costs()) / low["frames"] != low["instructions"]:
        die("counted twice, different numbers")
    sweep = [] if options.quick else [bench.fly("sweep", quality, panorama, SWEEP_SECONDS, SWEEP_MEMORY) for panorama in ("on", "off") for quality in SWEEP]
    memory = [] if options.quick else memory_rows(bench)
    text = report(bench, low, places, sweep, memory, far_bench, far)
    open(options.out + "/handheld.md", "w").write(text)
    json.dump({"low": low, "places": places, "far": far, "sweep": sweep, "memory": memory, "target": TARGET}, open(options.out + "/handheld.json", "w"), indent=1)
    if sweep:  # a quick run has no curve, and leaves that of an earlier one alone
        write_curve(options.out + "/work-precision.csv", sweep)
    print(text, end="")


if __name__ == "__main__":
    try:
        main()
    except NoRow as what:
        die(what)
