#!/usr/bin/env python3
"""bench_codec.py BIN OUT [OPTION]...: how many bits heights take at the same largest error, ours beside others', and how many instructions
decoding takes. Writes OUT/codec.json, OUT/codec.md and its plots OUT/codec-*.svg.

Codec "trained" is measured with the tables that are built in and, held out, with tables trained on all grounds but the one that is coded:
farfield-train writes them, and a baker and an exporter are linked with them. Ours are packs, all bytes of their records, nodes of 17 and 9
heights a side. Others' are bare streams, of the whole ground and of pieces as large as nodes are.

  --decoder PROGRAM --plugin FILE   decode_pack.c built for the handheld, tcg_count.c: counts instructions under qemu-arm
  --peer-decoder PROGRAM --peer-libs DIR   decode_peer.c built likewise, and a root with the libraries it needs
  --quick             generated ground of 257 samples, two errors
  --no-peers          ours alone
  FARFIELD_DATA=DIR   holds puget-sound-gatech/, aconcagua-srtm3/ and so on (default ../shared/data); without any, ground is generated
  MAKE="make -s"      what links the fold's programs
  JOBS=N              grounds and errors side by side (default: one per processor)"""
import argparse
import concurrent.futures
import json
import math
import os
import random
import threading

import codec_grounds
import codec_peers
import codec_plot
import codec_report
from codec_grounds import run

OLDER = ("deflate", "rice", "raw")
NODE_LOG2 = (4, 3)
PIECES, PIECE_SIDES = 60, (65, 17, 9)
QUICK_SIDE, QUICK_ERRORS = 257, (0, 4)
PEER_PATH = "/lib/arm-linux-gnueabi:/usr/lib/arm-linux-gnueabi"  # in --peer-libs
QEMU = ["qemu-arm", "-cpu", "arm1136"]


def steps_of(ground, metres):
    return int(metres / ground.scale + 1e-6)


def raw_options(ground):
    """As farfield-bake takes them: one tile for all."""
    tile_log2 = (max(ground.side) - 2).bit_length()
    return [ground.raw, "--raw", "%dx%d" % ground.side, "--spacing", str(ground.spacing), "--hscale", "%.8f" % ground.scale, "--tile-log2",
            str(tile_log2), "--quiet"]


def errors_of(ground, heights, decoded):
    """The largest, and RMS, in metres."""
    off = [a - b for a, b in zip(heights, decoded)]
    return {"max_m": max(max(off), -min(off)) * ground.scale, "rms_m": math.sqrt(sum(o * o for o in off) / len(off)) * ground.scale}


class Bench:
    def __init__(self, options, grounds, work):
        self.options, self.grounds, self.work = options, grounds, work
        self.tool = lambda name: os.path.join(options.bin, "farfield-" + name)
        self.peers, self.notes = ([], []) if options.no_peers else codec_peers.installed(work)
        if not (options.decoder and options.plugin):
            self.notes.append("instructions are left out: no --decoder and --plugin")
        self.counts_peers = options.plugin and os.path.exists(options.peer_decoder or "")
        if self.peers and not self.counts_peers:
            self.notes.append("instructions of other codecs are left out: no --peer-decoder")

    # ---- folds ----
    def train(self):
        """A folder for each ground, with a baker and an exporter that have not seen it."""
        packs = {}
        for ground in self.grounds:
            packs[ground.name] = os.path.join(self.work, ground.name + ".ffp")
            run([self.tool("bake"), *raw_options(ground), "--node-log2", "4", "-o", packs[ground.name]])
        with self.side_by_side() as pool:
            list(pool.map(lambda ground: self.fold(ground, packs), self.grounds))

    def fold(self, ground, packs):
        folder = os.path.join(self.work, ground.name)
        os.makedirs(folder, exist_ok=True)
        others = [path for name, path in packs.items() if name != ground.name]
        run([self.tool("train"), ",".join(others), "--output", os.path.join(folder, "tables.c")])
        run([*os.environ.get("MAKE", "make -s").split(), os.path.join(folder, "fold-bake"), os.path.join(folder, "fold-export")])

    def side_by_side(self):
        return concurrent.futures.ThreadPoolExecutor(int(os.environ.get("JOBS") or os.cpu_count() or 1))

    # ---- ours ----
    def ours(self, ground, metres, heights):
        fold = os.path.join(self.work, ground.name)
        for node_log2 in NODE_LOG2:
            yield self.pack(ground, metres, heights, "trained", node_log2, "held out", os.path.join(fold, "fold-bake"), os.path.join(fold, "fold-export"))
            for codec in ("trained",) + OLDER:
                yield self.pack(ground, metres, heights, codec, node_log2, "built in" if codec == "trained" else "",
                                self.tool("bake"), self.tool("export"))

    def pack(self, ground, metres, heights, codec, node_log2, tables, bake, export):
        steps = steps_of(ground, metres)
        path = os.path.join(self.work, "%s-%g-%s-%s-%d.ffp" % (ground.name, metres, codec, tables.replace(" ", "-"), node_log2))
        # A step's length is rounded in the pack: a little more, so that whole steps of error stay whole.
        error = (steps + 0.001) * ground.scale if steps else 0
        run([bake, *raw_options(ground), "--node-log2", str(node_log2), "--max-error", "%.8f" % error, "--codec", codec, "-o", path])
        info = json.loads(run([self.tool("info"), "--json", path]))
        if info["max_error"] != steps:
            raise SystemExit("bench_codec: %s: an error of %d steps, not %d" % (path, info["max_error"], steps))
        row = {"ground": ground.name, "error_m": metres, "codec": codec, "tables": tables, "piece": (1 << node_log2) + 1,
               "bits": info["bits_per_sample"], "bits_once": info["bits_per_sample_sides_once"]}
        run([export, path, "--quiet", "-o", path + ".r16"])
        row.update(errors_of(ground, heights, codec_grounds.read(path + ".r16")))
        if tables != "held out" and self.options.decoder and self.options.plugin:
            row.update(self.instructions(ground, path))
        os.remove(path)
        os.remove(path + ".r16")
        return row

    def count(self, command, counts):
        """Instructions in the phase "work", heights that were made, and their sum."""
        total = 0
        said = run([*QEMU, "-plugin", "%s,out=%s" % (self.options.plugin, counts), *command]).split()
        with open(counts, encoding="utf-8") as file:
            for line in file:
                word = line.split()
                if word[0] == "at":
                    total += int(word[2]) * int(word[4])
        os.remove(counts)
        return total, int(said[1]), int(said[3])

    def instructions(self, ground, pack):
        total, made, _ = self.count([self.options.decoder, pack], pack + ".counts")
        samples = ground.side[0] * ground.side[1]
        return {"instructions": total / samples, "instructions_made": total / made}

    # ---- others' ----
    def instructions_of(self, peer, ground, packed, expected):
        if not self.counts_peers:
            return {}
        path = os.path.join(self.work, "%s.%d" % (peer.name, threading.get_ident()))
        with open(path, "wb") as file:
            file.write(packed)
        libraries = ["-L", self.options.peer_libs, "-E", "LD_BIND_NOW=1", "-E", "LD_LIBRARY_PATH=" + PEER_PATH]
        total, made, total_height = self.count([*libraries, self.options.peer_decoder, peer.name, path, *map(str, ground.side)], path + ".counts")
        if total_height != sum(expected):
            raise SystemExit("bench_codec: %s decodes %s otherwise on ARM" % (peer.name, ground.name))
        os.remove(path)
        return {"instructions": total / made}

    def others(self, ground, metres, heights):
        steps, grid = steps_of(ground, metres), codec_peers.Grid(ground.side, heights)
        for peer in self.peers:
            row = {"ground": ground.name, "error_m": metres, "codec": peer.name, "tables": ""}
            packed = peer.pack(grid, steps)
            decoded = peer.unpack(packed, grid, steps)
            yield {**row, "piece": 0, "bits": 8 * len(packed) / len(heights), **errors_of(ground, heights, decoded),
                   **self.instructions_of(peer, ground, packed, grid.quantised(steps).heights if peer.quantises(steps) else decoded)}
            chance = random.Random(ground.name)
            for side in PIECE_SIDES:
                size = 0
                for _ in range(PIECES):
                    x, y = (chance.randrange(n - side + 1) for n in ground.side)
                    size += len(peer.pack(grid.crop(x, y, side, side), steps))
                yield {**row, "piece": side, "bits": 8 * size / (PIECES * (side - 1) ** 2)}

    # ---- all ----
    def rows(self):
        cases = [(ground, metres) for ground in self.grounds for metres in ground.errors]

        def case(one):
            ground, metres = one
            heights = codec_grounds.read(ground.raw)
            rows = [*self.ours(ground, metres, heights), *self.others(ground, metres, heights)]
            print("%s, %g m" % (ground.name, metres), flush=True)
            return rows
        with self.side_by_side() as pool:
            return [row for rows in pool.map(case, cases) for row in rows]


def grounds_of(options, work):
    """The grounds, and a line about them."""
    data = os.environ.get("FARFIELD_DATA", "../shared/data")
    if options.quick:
        made = [g._replace(errors=QUICK_ERRORS) for g in codec_grounds.generated(QUICK_SIDE, work)]
        return made, "Ground is generated."
    found = codec_grounds.real(data, work) if os.path.isdir(data) else []
    if len(found) > 1:
        return found, "Grounds are real, see tools/scripts/codec_grounds.py."
    return codec_grounds.generated(codec_grounds.SIDE, work), "Ground is generated: there is none in %s (`make bench-codec DATA=DIR`)." % data


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--decoder")
    parser.add_argument("--plugin")
    parser.add_argument("--peer-decoder")
    parser.add_argument("--peer-libs")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--no-peers", action="store_true")
    options = parser.parse_args()
    work = os.path.join(options.out, "codec")
    os.makedirs(work, exist_ok=True)
    grounds, about = grounds_of(options, work)
    bench = Bench(options, grounds, work)
    for note in bench.notes:
        print("bench_codec: " + note)
    bench.train()
    result = {"about": about, "notes": bench.notes, "grounds": [{k: v for k, v in g._asdict().items() if k != "raw"} for g in grounds],
              "rows": bench.rows()}
    with open(os.path.join(options.out, "codec.json"), "w", encoding="utf-8") as file:
        json.dump(result, file, indent=1)
    plots = codec_plot.write(options.out, result)
    codec_report.write(os.path.join(options.out, "codec.md"), result, plots)
    print("bench_codec: " + os.path.join(options.out, "codec.md"))


if __name__ == "__main__":
    main()
