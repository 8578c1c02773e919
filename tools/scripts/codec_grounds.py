"""The grounds that bench_codec.py codes: crops of real ones, or, without any, ground from integers alone."""
import array
import collections
import os
import subprocess
import sys

import bench_terrain

# heights: a raw file of 16 bits, little-endian, the lowest 0; scale: metres a step; errors: metres, at most
Ground = collections.namedtuple("Ground", "name title raw side scale spacing errors")

METRES = (0, 1, 4, 10)
SIDE = 1025  # crops: their north-west corner
REAL = [  # name, what it is, file, metres a step, metres between samples, errors
    ("aconcagua", "Aconcagua, SRTM 3\"", "aconcagua-srtm3/S33W071.tif", 1, 90, METRES),
    ("fuji", "Fuji, SRTM 3\", voids filled", "fuji-srtm3/mt_fuji_90m.tif", 1, 90, METRES),
    ("puget", "Puget Sound", "puget-sound-gatech/ps_height_1k.png", 0.1, 160, METRES),
    ("jotunheimen", "Jotunheimen", "jotunheimen-pair/jotunheimen512.bin", 0.03769, 40, METRES),
    ("slovenia", "Slovenia, lidar", "slovenia-lidar-1m/TM1_564_146.tif", 0.01, 1, (0, 0.02, 0.1, 0.25)),
]
JOTUNHEIMEN_SIDE = 512


def write(path, heights):
    low = min(heights)
    grid = array.array("H", (h - low for h in heights))
    if sys.byteorder == "big":
        grid.byteswap()
    with open(path, "wb") as file:
        file.write(grid.tobytes())


def read(path):
    grid = array.array("H")
    with open(path, "rb") as file:
        grid.frombytes(file.read())
    if sys.byteorder == "big":
        grid.byteswap()
    return grid


def run(command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit("bench_codec: %s: %s" % (command[0], (done.stdout.strip().splitlines() or ["failed"])[-1]))
    return done.stdout


def translate(source, scale, out):
    """The crop in steps, by GDAL: width and height. Voids are filled from around."""
    run(["gdal_fillnodata.py", "-q", "-md", "200", source, out + ".tif"])
    size = [line for line in run(["gdalinfo", out + ".tif"]).splitlines() if line.startswith("Size is ")][0]
    width, height = (min(int(n), SIDE) for n in size[len("Size is "):].split(", "))
    unit = ["-scale", "0", "1", "0", "100"] if scale == 0.01 else []  # told in metres
    run(["gdal_translate", "-q", "-of", "ENVI", "-ot", "Int32", *unit, "-srcwin", "0", "0", str(width), str(height), out + ".tif", out + ".i32"])
    heights = array.array("i")
    with open(out + ".i32", "rb") as file:
        heights.frombytes(file.read())
    write(out, heights)
    for ending in (".tif", ".i32", ".hdr", ".i32.aux.xml"):
        if os.path.exists(out + ending):
            os.remove(out + ending)
    return width, height


def real(data, folder):
    """Those that are there."""
    grounds = []
    for name, title, source, scale, spacing, errors in REAL:
        path, raw = os.path.join(data, source), os.path.join(folder, name + ".raw")
        if not os.path.exists(path):
            print("bench_codec: no %s" % path, file=sys.stderr)
            continue
        if source.endswith(".bin"):
            write(raw, read(path))
            side = (JOTUNHEIMEN_SIDE, JOTUNHEIMEN_SIDE)
        else:
            side = translate(path, scale, raw)
        grounds.append(Ground(name, title, raw, side, scale, spacing, errors))
    return grounds


def generated(n, folder):
    """Hills of two kinds, and mountains; decimetres. The finest noise is that of a sensor."""
    def hills(seed, smooth):
        octaves = [bench_terrain.octave(n, step, seed + k, 60 * step >> smooth) for k, step in enumerate((128, 64, 32, 16, 8, 4, 2))]
        return [sum(o[y][x] for o in octaves) + (bench_terrain.hash32(x, y, seed) & 3) for y in range(n) for x in range(n)]

    made = {"hills": lambda: hills(11, 0), "downs": lambda: hills(71, 2),
            "mountains": lambda: [h for row in bench_terrain.mountains(n) for h in row]}
    grounds = []
    for name, heights in made.items():
        raw = os.path.join(folder, name + ".raw")
        write(raw, heights())
        grounds.append(Ground(name, name + ", generated", raw, (n, n), 0.1, 90, METRES))
    return grounds
