#!/usr/bin/env python3
"""Packs that farfield-merge joins, run by merge.sh. MERGE_DRAWS: random draws, 12 without it."""
import os
import random
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

EAST, NORTH = 500000, 5100000  # where the south-west samples lie
DRAWS = int(os.environ.get("MERGE_DRAWS", 12))


def ground(size, seed=1, rough=25):
    """Heights of size + 1 samples each way in whole metres, row 0 south."""
    y, x = np.mgrid[0:size + 1, 0:size + 1].astype(float)
    waves = 900 + 300 * np.sin(x / 41 + seed) * np.cos(y / 37) + rough * np.sin(x * 1.3 + y * 0.9) + 9 * np.sin(x * 2.9 - seed) * np.sin(y * 2.3)
    return np.rint(waves)


def raster(name, heights, spacing=10, x=0, y=0, **options):
    """A raster whose south-west sample lies x, y metres from EAST, NORTH."""
    place = (EAST + x - spacing / 2, spacing, 0, NORTH + y + (heights.shape[0] - 0.5) * spacing, 0, -spacing)
    options = {"kind": gdal.GDT_Int16, **options}
    return put(name, heights[::-1], place=place, **options)


def pack(name, heights, *options, spacing=10, x=0, y=0, **written):
    done = run("bake", raster(name + ".tif", heights, spacing, x, y, **written), "-o", name + ".ffp", *options)
    assert done.returncode == 0, done.stderr
    return name + ".ffp"


def data(name):
    return open(os.path.join(work, name), "rb").read()


def merge(*packs, out="joint.ffp", options=()):
    done = run("merge", *packs, "-o", out, "--json", *options)
    assert done.returncode == 0, done.stderr
    assert run("info", "--verify", out).returncode == 0
    return json.loads(done.stdout)


def refused_merge(pattern, *packs, options=()):
    done = run("merge", *packs, "-o", "never.ffp", *options)
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and re.search(pattern, done.stderr), (done.returncode, done.stderr)
    assert not [name for name in os.listdir(work) if name.startswith("never")]


def read(name):
    """(heights with row 0 south, x, y, spacing) of a pack."""
    done = run("export", name, "-o", "read.tif", "--quiet")
    assert done.returncode == 0, done.stderr
    made = gdal.Open(os.path.join(work, "read.tif"))
    band, place = made.GetRasterBand(1), made.GetGeoTransform()
    heights = band.ReadAsArray() * (band.GetScale() or 1) + (band.GetOffset() or 0)
    spacing = place[1]
    return heights[::-1], place[0] + spacing / 2 - EAST, place[3] - (heights.shape[0] - 0.5) * spacing - NORTH, spacing


def holds(joint, heights, spacing, x, y, but=None):
    """Whether a joint pack, as read, has all samples of a source that are not marked in `but`."""
    have, left, bottom, fine = joint
    column, row, apart = round((x - left) / fine), round((y - bottom) / fine), round(spacing / fine)
    part = have[row:row + (heights.shape[0] - 1) * apart + 1:apart, column:column + (heights.shape[1] - 1) * apart + 1:apart]
    assert part.shape == heights.shape, (part.shape, heights.shape)
    wrong = part != heights
    return not (wrong if but is None else wrong & ~but).any()


def fly(name, *options):
    done = run("fly", "--pack", name, "--json", "--backend", "soft565", "--settle", 10, "--audit", "on", "--quality", "px:1", "--seconds", 20, *options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


LAND = ground(260)


@case("parts of a raster give the pack of the whole: sharing samples, side by side, lying over each other, in any order")
def _():
    pack("whole", LAND)
    for shared in 1, 0, 40:
        parts = []
        for i, (left, right) in enumerate(((0, 120 + shared), (120, 261))):
            for j, (bottom, top) in enumerate(((0, 90 + shared), (90, 261))):
                parts.append(pack(f"part{i}{j}", LAND[bottom:top, left:right], x=10 * left, y=10 * bottom))
        for order in range(3):
            random.Random(order).shuffle(parts)
            summary = merge(*parts, options=("--jobs", 1 + order % 2))
            assert data("joint.ffp") == data("whole.ffp"), (shared, parts)
            assert summary["uncovered"] == 0
        left, right = pack("left", LAND[:, :120 + shared]), pack("right", LAND[:, 120:], x=1200)
        merge(right, left)
        assert data("joint.ffp") == data("whole.ffp"), shared


@case("so do parts of ground below the sea, with steps of a tenth of a metre, and with heights of their own zero")
def _():
    for name, heights, written in ("sea", LAND - 1100, {}), ("tenths", LAND, {"scale": 0.1}), ("offset", LAND, {"scale": 0.1, "offset": -30.02}):
        pack("whole", heights, **written)
        left, right = pack("left", heights[:, :131], **written), pack("right", heights[:, 130:], x=1300, **written)
        merge(left, right)
        assert data("joint.ffp") == data("whole.ffp"), name


finish()
