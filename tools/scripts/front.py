#!/usr/bin/env python3
"""What a flight costs against how true its picture is, for many settings over many grounds: the front of triangles, bytes and error, and
where the settings that have a name stand. Writes OUT/front.csv, a row a flight, OUT/front.md and its plots OUT/*.svg.

A flight over the same pack with the same program and options is not flown again. The whole sweep is about 6000 flights of a second:
about an hour on two processors; --grounds, --heights and --links fly a slice of it, and leave the other rows in front.csv.

  QUICK=1             a few settings, two grounds, two heights, one link, short flights, into OUT/quick
  JOBS=N              flights side by side (default: one per processor)
  FARFIELD_DATA=DIR   holds puget-sound-gatech/, aconcagua-srtm3/ and so on (default ../shared/data); what is not there is not flown
  FRONT_PACKS="A.ffp B.ffp"   grounds in place of all others"""
import argparse
import collections
import concurrent.futures
import csv
import hashlib
import io
import json
import os
import subprocess
import sys
import tempfile
import threading

import front_report
import front_rule

QUICK = bool(os.environ.get("QUICK"))

# ---- the settings: name, options of farfield-fly; each list may be changed freely ----
# What must lie on the front. One that the program does not know is left out, and front.md says so.
NAMED = [("default", "")] + [(name, "--quality " + name) for name in ("low", "medium", "high")]
BALANCED = [1500, 2500, 5000, 10000, 20000]
NAMED += [("balance %d" % n, "--balance %d" % n) for n in BALANCED]

# What they are judged against: measure x value x panorama, and round some of them depth, back plane and face size, one at a time.
C = "0.5 0.7 1 1.4 2 3 4.5 6 9".split()
PIXELS = "0.5 0.7 1 1.4 2 2.8 4 5.6 8 11 16 32".split()
DEPTHS = "1:5 2:5 3:4 3:5 3:6 5:6 9:8".split()
SWEPT = [("%s %s" % (quality, panorama), "--quality %s --panorama %s" % (quality, panorama))
         for quality in [c + ":0" for c in C] + DEPTHS + ["px:" + e for e in PIXELS] for panorama in ("on", "off")]
SWEPT += [("%s on, back plane %s" % (quality, plane), "--quality %s --panorama on --back-plane %s" % (quality, plane))
          for quality in ("1:0", "px:4") for plane in (2000, 4000, 15000, 30000)]
SWEPT += [("%s on, face %d" % (quality, face), "--quality %s --panorama on --face %d --memory 8M" % (quality, face))
          for quality in ("1:0", "px:4") for face in (128, 512)]

LINKS = {"umts": 20, "gprs": 30, "nbiot": 60}  # seconds until settled
HEIGHTS = {100: 150, 600: 150, 2000: 150, 12000: 900}  # metres above ground: km/h
FLOWN_S, WINDOW_S, SAMPLE_S = 80, 20, 2
# Pictures judged by luminance cost seconds a row: named settings alone, over this link, at these heights.
DIFF_LINK, DIFF_HEIGHTS, DIFF_SAMPLE_S = "umts", (100, 12000), 20

# A stranger's ground and no options: this link and speed, these heights and along the edge, at most so much error and so many triangles.
TARGET = {"setting": "default", "link": "umts", "speed": 150, "heights": (2, 10, 50, 100, 600, 2000, 6000, 12000), "edge_height": 100,
          "err_px_p95": 2.0, "triangles": 5500}

if QUICK:
    NAMED = [n for n in NAMED if n[0] in ("default", "low", "high", "balance 2500")]
    SWEPT = [s for s in SWEPT if s[0] in ("1:0 off", "3:4 on", "3:4 off", "px:4 on", "px:4 off", "px:16 off", "px:4 on, back plane 2000")]
    LINKS, HEIGHTS = {"umts": 6}, {100: 150, 2000: 150}
    FLOWN_S, WINDOW_S, DIFF_HEIGHTS = 8, 4, ()
    TARGET["heights"] = (2,)

# ---- the grounds: name, source below FARFIELD_DATA, options of farfield-bake (the tiles are the baker's own choice), heights left out ----
Source = collections.namedtuple("Source", "name file options highest_m")
DATA = (
    Source("puget", "puget-sound-gatech/ps_height_1k.png", "--hscale 0.1 --spacing 160 --color {dir}/ps_texture_1k.png", 12000),
    Source("aconcagua", "aconcagua-srtm3/S33W071.tif", "", 12000),
    Source("fuji", "fuji-srtm3/mt_fuji_90m.tif", "", 12000),
    Source("jotunheimen", "jotunheimen-pair/jotunheimen512.bin",
           "--raw 512x512 --spacing 117.4 --scale 0.0377 --color {dir}/jotunheimen-texture.jpg", 12000),
    Source("slovenia", "slovenia-lidar-1m/TM1_564_146.tif", "", 100),  # a square kilometre
)
# Trinidad, Colorado, in feet; and its highest mountains with invented detail every 10 m.
TRINIDAD = "--scale 0.3048780488"
DENSE_WINDOW, DENSE = "780 300 480 480", TRINIDAD + " --densify 8"

STANDING_STILL = "--backend none --seconds 0 --settle 0".split()
WRONG_USAGE = 2  # a program's exit status

Ground = collections.namedtuple("Ground", "name pack highest_m")
Flight = collections.namedtuple("Flight", "ground course height_m speed_kmh link settle_s setting kind options diff")
COLUMNS = ("ground course height_m speed_kmh link setting kind options triangles bytes bytes_flight err_px_p95 err_px_rms skyline_px_rms "
           "undrawn_px_percent panorama_px_percent pool_full diff_mean ssim windows program key").split()


class Failure(Exception):
    """One line for stderr."""


def say(text):
    print("== " + text, flush=True)


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise Failure((done.stderr.strip().splitlines() or ["%s ended with %d" % (command[0], done.returncode)])[-1])
    return done.stdout


def hash_of(*paths):
    total = hashlib.sha256()
    for path in paths:
        with open(path, "rb") as file:
            total.update(file.read())
    return total.hexdigest()[:16]


class Grounds:
    """Packs, baked once into OUT."""

    def __init__(self, bin_dir, out):
        self.bin, self.out = bin_dir, out
        self.data = os.environ.get("FARFIELD_DATA", "../shared/data")

    def bake(self, name, source, options):
        pack, key = "%s/%s.ffp" % (self.out, name), "%s %s" % (options, hash_of(source, self.bin + "/farfield-bake"))
        if not (os.path.exists(pack) and os.path.exists(pack + ".key") and open(pack + ".key", encoding="utf-8").read() == key):
            say("bake " + pack)
            run([self.bin + "/farfield-bake", source, *options.split(), "--quiet", "-o", pack])
            with open(pack + ".key", "w", encoding="utf-8") as file:
                file.write(key)
        return pack

    def find(self, names):
        """All that are there, of these names (None: any)."""
        given = os.environ.get("FRONT_PACKS", "").split()
        if given:
            return [Ground(os.path.splitext(os.path.basename(pack))[0], pack, 1e6) for pack in given]
        wanted = lambda name: not names or name in names
        found = []
        if wanted("trinidad") or wanted("dense"):
            dem, window = run([os.path.dirname(__file__) + "/trinidad.sh", self.out]).strip(), self.out + "/dense.tif"
            if wanted("trinidad"):
                found.append(Ground("trinidad", self.bake("trinidad", dem, TRINIDAD), 1e6))
            if wanted("dense"):
                run(["gdal_translate", "-q", "-srcwin", *DENSE_WINDOW.split(), dem, window])
                found.append(Ground("dense", self.bake("dense", window, DENSE), 1e6))
        for source in DATA:
            path = "%s/%s" % (self.data, source.file)
            if wanted(source.name) and os.path.exists(path):
                options = source.options.format(dir=os.path.dirname(path))
                found.append(Ground(source.name, self.bake(source.name, path, options), source.highest_m))
        return found


class Sweep:
    """Flies what is missing in front.csv."""

    def __init__(self, options):
        self.fly, self.out = options.bin + "/farfield-fly", options.out
        self.info = options.bin + "/farfield-info"
        self.table = self.out + "/front.csv"
        self.program = hash_of(self.fly)
        self.lock, self.done, self.count = threading.Lock(), 0, 0
        self.packs, self.caches = {}, {}

    def prepare(self, grounds):
        """The true ground is decoded once; settings the program refuses are told apart. Returns their names."""
        for ground in grounds:
            self.packs[ground.name] = hash_of(ground.pack)
            self.caches[ground.name] = "%s/%s.ground" % (self.out, ground.name)
            run([self.fly, "--pack", ground.pack, "--ground-cache", self.caches[ground.name], "--audit", "on", *STANDING_STILL])
        refused = []
        for name, options in NAMED + SWEPT:
            probe = [self.fly, "--pack", grounds[0].pack, *STANDING_STILL, *options.split()]
            if subprocess.run(probe, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False).returncode == WRONG_USAGE:
                refused.append(name)
        return refused

    def edge_path(self, flight):
        """A recorded flight that stands and then goes along the southern edge, a sample inside it, looking along it."""
        path, ground = "%s/%s-edge.csv" % (self.out, flight.ground.name), json.loads(run([self.info, "--json", flight.ground.pack]))
        spacing = ground["spacing_m"]
        start, end = (share * (ground["samples_x"] - 1) * spacing for share in (0.3, 0.9))
        end = min(end, start + FLOWN_S * flight.speed_kmh / 3.6)
        with open(path, "w", encoding="utf-8") as file:
            file.write("t_s,x_m,y_m,h_m,heading_deg\n")
            for t, x in ((0, start), (flight.settle_s, start), (flight.settle_s + FLOWN_S, end)):
                file.write("%g,%.2f,%.2f,%g,90\n" % (t, x, spacing, flight.height_m))
        return path

    def arguments(self, flight):
        """What makes the flight, but for the file of its path."""
        words = [*flight.options.split(), "--link", flight.link, "--settle", str(flight.settle_s), "--seconds", str(FLOWN_S), "--seed", "1"]
        return words + ["--height", str(flight.height_m), "--speed", str(flight.speed_kmh)]

    def key(self, flight):
        text = " ".join([self.program, self.packs[flight.ground.name], flight.course, str(flight.diff), str(SAMPLE_S), str(WINDOW_S),
                         *self.arguments(flight)])
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def rows_of(self, flight, more):
        """The rows of its CSV, as numbers; None for nan."""
        path = ["--path", self.edge_path(flight)] if flight.course == "edge" else []
        with tempfile.NamedTemporaryFile(suffix=".csv") as file:
            run([self.fly, "--pack", flight.ground.pack, "--ground-cache", self.caches[flight.ground.name], "--check", "off", "--csv", file.name,
                 *self.arguments(flight), *path, *more.split()])
            with open(file.name, newline="", encoding="utf-8") as table:
                return [{name: None if text == "nan" else float(text) for name, text in row.items() if not name.endswith("_hash")}
                        for row in csv.DictReader(table)]

    def measure(self, flight):
        """A row of front.csv."""
        rows = self.rows_of(flight, "--backend none --audit on --sample %d" % SAMPLE_S)
        before = [r for r in rows if r["t_s"] <= flight.settle_s]
        after = [r for r in rows if r["t_s"] > flight.settle_s]
        row = {"ground": flight.ground.name, "course": flight.course, "height_m": flight.height_m, "speed_kmh": flight.speed_kmh,
               "link": flight.link, "setting": flight.setting, "kind": flight.kind, "options": flight.options, "key": self.key(flight),
               "program": self.program, "bytes": after[-1]["bytes_down"],
               "bytes_flight": after[-1]["bytes_down"] - before[-1]["bytes_down"],
               "pool_full": after[-1]["pool_full"], "diff_mean": None, "ssim": None}
        for name in ("triangles", "err_px_p95", "err_px_rms", "skyline_px_rms", "undrawn_px_percent", "panorama_px_percent"):
            row[name] = mean(after, name)
        row["windows"] = [self.window(after, flight.settle_s + at) for at in range(0, FLOWN_S, WINDOW_S)]
        if flight.diff:
            pictures = self.rows_of(flight, "--backend soft --diff on --sample %d" % DIFF_SAMPLE_S)
            pictures = [r for r in pictures if r["t_s"] > flight.settle_s]
            row["diff_mean"], row["ssim"] = mean(pictures, "diff_mean"), mean(pictures, "ssim")
        return row

    @staticmethod
    def window(rows, start):
        """Mean triangles, bytes since the start of the flight, and mean error."""
        part = [r for r in rows if start < r["t_s"] <= start + WINDOW_S]
        return (mean(part, "triangles"), part[-1]["bytes_down"], mean(part, "err_px_p95"))

    # ---- front.csv: flown rows are added as they come, and put in order in the end ----
    def load(self):
        """Rows by their keys."""
        try:
            with open(self.table, newline="", encoding="utf-8") as file:
                table = csv.DictReader(file)
                rows = list(table) if table.fieldnames == COLUMNS else []
        except FileNotFoundError:
            return {}
        whole = (row for row in rows if None not in row.values() and None not in row)
        return {row["key"]: unpack(row) for row in whole if row["program"] == self.program}

    def save(self, rows):
        with open(self.table + ".part", "w", encoding="utf-8") as file:
            file.write(",".join(COLUMNS) + "\n" + "".join(pack(row) for row in rows))
        os.replace(self.table + ".part", self.table)

    def take(self, flight):
        """Flies it and adds its row, which is returned as it will be read again."""
        line = pack(self.measure(flight))
        with self.lock:
            with open(self.table, "a", encoding="utf-8") as file:
                file.write(line)
            self.done += 1
            if self.done % 50 == 0 or self.done == self.count:
                say("%d of %d flights" % (self.done, self.count))
        return unpack(next(csv.DictReader([line], COLUMNS)))

    def fly_all(self, flights):
        """The rows of these flights, in their order."""
        known = self.load()
        keys = [self.key(flight) for flight in flights]
        missing = [flight for flight, key in zip(flights, keys) if key not in known]
        self.save(known.values())
        self.count = len(missing)
        say("%d flights, %d of them flown before" % (len(flights), len(flights) - len(missing)))
        with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("JOBS") or os.cpu_count())) as pool:
            tasks = [pool.submit(self.take, flight) for flight in missing]
            try:
                known.update((task.result()["key"], task.result()) for task in concurrent.futures.as_completed(tasks))
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
        rows = [{**known.pop(key), "setting": f.setting, "kind": f.kind} for f, key in zip(flights, keys)]
        self.save(rows + sorted(known.values(), key=pack))
        return rows


def mean(rows, name):
    values = [r[name] for r in rows if r[name] is not None]
    return sum(values) / len(values) if values else None


def text_of(value):
    if value is None or isinstance(value, str):
        return value or ""
    return str(int(value)) if value == int(value) else "%.6g" % value


def pack(row):
    """A line of front.csv; windows are TRIANGLES:BYTES:ERROR, parted by spaces."""
    line = io.StringIO()
    windows = " ".join(":".join(text_of(v) for v in w) for w in row["windows"])
    csv.writer(line, lineterminator="\n").writerow([windows if c == "windows" else text_of(row[c]) for c in COLUMNS])
    return line.getvalue()


def unpack(row):
    texts = ("ground", "course", "link", "setting", "kind", "options", "program", "key")
    number = lambda text: float(text) if text else None
    windows = [tuple(number(v) for v in w.split(":")) for w in row["windows"].split()]
    return {name: windows if name == "windows" else text if name in texts else number(text) for name, text in row.items()}


def list_flights(grounds, heights, links, refused):
    """Every flight once, whichever table wants it."""
    settings = [(*s, "named") for s in NAMED if s[0] not in refused] + [(*s, "swept") for s in SWEPT if s[0] not in refused]
    flights = []
    for ground in grounds:
        for height in (h for h in heights if h <= ground.highest_m):
            for link in links:
                flights += [Flight(ground, "front", height, HEIGHTS[height], link, LINKS[link], name, kind, options,
                                   kind == "named" and link == DIFF_LINK and height in DIFF_HEIGHTS) for name, options, kind in settings]
    if TARGET["link"] not in links:
        return flights
    there = {(f.ground.name, f.height_m, f.speed_kmh, f.link, f.setting) for f in flights}
    options = dict(NAMED)[TARGET["setting"]]
    for ground in grounds:
        for height in [h for h in TARGET["heights"] if h <= ground.highest_m] + ["edge"]:
            course, metres = ("edge", TARGET["edge_height"]) if height == "edge" else ("target", height)
            if course == "edge" or (ground.name, metres, TARGET["speed"], TARGET["link"], TARGET["setting"]) not in there:
                flights.append(Flight(ground, course, metres, TARGET["speed"], TARGET["link"], LINKS[TARGET["link"]], TARGET["setting"],
                                      "named", options, False))
    return flights


def parse():
    words = lambda text: text.split(",")
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bin")
    parser.add_argument("out")
    parser.add_argument("--grounds", type=words, default=["trinidad", "dense"] if QUICK else None,
                        help="of " + ",".join(["trinidad", "dense"] + [source.name for source in DATA]))
    parser.add_argument("--heights", type=lambda text: [int(h) for h in words(text)], default=list(HEIGHTS),
                        help="of " + ",".join("%d" % h for h in HEIGHTS))
    parser.add_argument("--links", type=words, default=list(LINKS), help="of " + ",".join(LINKS))
    options = parser.parse_args()
    if not set(options.heights) <= set(HEIGHTS) or not set(options.links) <= set(LINKS):
        parser.error("heights are of %s, links of %s" % (list(HEIGHTS), list(LINKS)))
    return options


def main():
    options = parse()
    os.makedirs(options.out, exist_ok=True)
    grounds = Grounds(options.bin, options.out).find(options.grounds)
    if not grounds:
        raise Failure("no such ground here: %s" % ",".join(options.grounds or []))
    if QUICK:
        options.out += "/quick"
        os.makedirs(options.out, exist_ok=True)
    sweep = Sweep(options)
    refused = sweep.prepare(grounds)
    for name in refused:
        say("this program does not know the setting %s: left out" % name)
    rows = sweep.fly_all(list_flights(grounds, options.heights, options.links, refused))
    front_report.write(options.out, rows, TARGET, WINDOW_S, refused)
    for name, s in front_rule.standing([row for row in rows if row["course"] == "front"]).items():
        print("%-14s dominated at %d of %d points" % (name, s["dominated"], s["points"]))
    say(options.out + "/front.md")


if __name__ == "__main__":
    try:
        main()
    except Failure as failure:
        sys.exit("front: %s" % failure)
