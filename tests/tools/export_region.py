#!/usr/bin/env python3
"""Parts of packs that farfield-export writes, run by export_region.sh: each is compared with the whole that it is of. FULL=1 (make
parts): every level of every region, and longer flights."""
import os
import re
import shutil
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

SPACING, WIDTH, HEIGHT = 30, 500, 420
PLACE = (500000 - SPACING / 2, SPACING, 0, 5100000 + SPACING / 2, 0, -SPACING)  # covers 9.0000,45.9399,9.1935,46.0535
REGIONS = "9.05,45.97,9.1,46.01", "9.1,45.93,9.3,46.0", "8.9,46.04,9.02,46.1", "9.0801,45.9901,9.0802,45.9902", "8,45,10,47"
LEVELS = 8  # of tiles of 2^10; 5 of 2^7
FULL = os.environ.get("FULL", "0") != "0"


def bake_ground():
    """Two packs of one ground, of a tile and of many, with images, flats and voids."""
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    heights = 900 + 300 * np.sin(columns / 41) * np.cos(rows / 37) + 25 * np.sin(columns * 1.3 + rows * 0.9)
    heights[columns > 400] = 500  # level: leaves
    heights[20:40, 100:140] = -9999
    path = put("land.tif", heights.astype(np.float32), place=PLACE, nodata=-9999)
    waves = [np.clip(128 + 100 * np.sin(columns / (9 + band)) * np.cos(rows / 7), 0, 255) for band in range(3)]
    colour = put("land-colour.tif", np.array(waves).astype(np.uint8), kind=gdal.GDT_Byte, place=PLACE)
    for log2 in 10, 7:
        done = run("bake", path, "-o", f"land{log2}.ffp", "--tile-log2", log2, "--color", colour, "--texture-levels", 4, "--name", "Waves", "--attribution", "Nobody")
        assert done.returncode == 0, done.stderr


def part(pack, out, *options):
    done = run("export", pack, "-o", out, *options)
    assert done.returncode == 0 and not done.stderr.strip(), done.stderr
    return open(os.path.join(work, out), "rb").read()


def told(pack, *options):
    done = run("export", pack, "--estimate", *options)
    assert done.returncode == 0, done.stderr
    return int(done.stdout.split()[1])


def size(name):
    return os.path.getsize(os.path.join(work, name))


def raster(pack, out, *options):
    """(metres or colours, geotransform, error_m) of an export."""
    done = run("export", pack, "-o", out, *options)
    assert done.returncode == 0, done.stderr
    made = gdal.Open(os.path.join(work, out))
    band = made.GetRasterBand(1)
    if "--images" in options:
        return made.ReadAsArray().astype(int), made.GetGeoTransform(), None
    return band.ReadAsArray() * (band.GetScale() or 1) + (band.GetOffset() or 0), made.GetGeoTransform(), float(made.GetMetadataItem("error_m"))


def sections(pack):
    done = run("info", "--verify", "--json", pack)
    assert done.returncode == 0, done.stderr
    return {(s["kind"], s["level"]): s["records"] for s in json.loads(done.stdout)["sections"]}


def fly(pack, *options):
    done = run("fly", "--pack", pack, "--json", "--backend", "soft565", "--settle", 10, "--audit", "on", "--quality", "px:1", *options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def fly_to(frames, pack, *options):
    """What fly tells, and the picture that the flight ends with, as bytes of its PNG."""
    frames = os.path.join(work, frames)
    shutil.rmtree(frames, ignore_errors=True)
    told = fly(pack, "--png", frames, "--every", 1, *options)
    return told, open(os.path.join(frames, max(os.listdir(frames))), "rb").read()


def refused_part(pattern, pack, out, *options, code=1):
    done = run("export", pack, "-o", out, *options)
    assert done.returncode == code and done.stderr.count("\n") == 1 and re.search(pattern, done.stderr), (done.returncode, done.stderr)


bake_ground()


@case("all of a pack as a pack is the same file")
def _():
    for log2 in 10, 7:
        whole = open(os.path.join(work, f"land{log2}.ffp"), "rb").read()
        assert part(f"land{log2}.ffp", "all.ffp") == whole and part(f"land{log2}.ffp", "all.ffp", "--region=8,45,10,47") == whole


@case("the size told beforehand is the size")
def _():
    for log2 in 10, 7:
        for region in REGIONS:
            for level in range(0, LEVELS if log2 == 10 else LEVELS - 3, (2 if log2 == 10 else 1) if FULL else 3):
                options = "--region=" + region, "--level", level
                part(f"land{log2}.ffp", "part.ffp", *options)
                assert told(f"land{log2}.ffp", *options) == size("part.ffp"), (log2, options)
    assert told("land7.ffp", "--region=" + REGIONS[3]) < size("land7.ffp") / 4
    assert told("land10.ffp", "-o", "not-there.ffp") == size("land10.ffp") and not os.path.exists(os.path.join(work, "not-there.ffp"))


@case("heights and images of the region are those of the whole, at every level; what it says of itself goes along")
def _():
    for log2 in 10, 7:
        for region in REGIONS[:3]:
            part(f"land{log2}.ffp", "part.ffp", "--region=" + region)
            sections("part.ffp")
            finest = LEVELS - (10 - log2) - 1
            for level in range(finest + 1) if FULL or region == REGIONS[0] else (finest - 2, finest):
                options = "--region=" + region, "--level", level
                ours, theirs = raster("part.ffp", "a.tif", *options), raster(f"land{log2}.ffp", "b.tif", *options)
                assert np.array_equal(ours[0], theirs[0]) and ours[1:] == theirs[1:], (log2, options, ours[2], theirs[2])
            for level in range(4) if FULL else (3,):
                options = "--images", "--region=" + region, "--level", level
                ours, theirs = raster("part.ffp", "a.tif", *options), raster(f"land{log2}.ffp", "b.tif", *options)
                assert np.array_equal(ours[0], theirs[0]), (log2, options, abs(ours[0] - theirs[0]).max())
        for west, south in np.random.default_rng(3).uniform((9.0, 45.94), (9.15, 46.03), (12 if FULL else 3, 2)).round(4):  # some end where nodes do
            region = f"--region={west},{south},{west + 0.03:.4f},{south + 0.02:.4f}"
            part(f"land{log2}.ffp", "part.ffp", region)
            assert np.array_equal(raster("part.ffp", "a.tif", region)[0], raster(f"land{log2}.ffp", "b.tif", region)[0]), (log2, region)
        said = run("info", "part.ffp").stdout
        assert "Waves" in said and "Nobody" in said
        assert re.search("checksum.*", said)[0] != re.search("checksum.*", run("info", f"land{log2}.ffp").stdout)[0]


@case("a part to a level has the whole's heights down to it, and none below")
def _():
    for level in range(5):
        part("land7.ffp", "part.ffp", "--region=" + REGIONS[0], "--level", level)
        assert sum(count for (kind, l), count in sections("part.ffp").items() if l >= level and kind == "refinement" or l > level) == 0
        for coarser in range(level + 1):
            options = "--region=" + REGIONS[0], "--level", coarser
            assert np.array_equal(raster("part.ffp", "a.tif", *options)[0], raster("land7.ffp", "b.tif", *options)[0]), (level, coarser)


@case("a part of a part is that part of the whole")
def _():
    for log2 in 10, 7:
        part(f"land{log2}.ffp", "outer.ffp", "--region=9.02,45.96,9.15,46.03")
        for options in ("--region=" + REGIONS[0],), ("--region=" + REGIONS[0], "--level", 3), ("--region=" + REGIONS[3],):
            assert part("outer.ffp", "inner.ffp", *options) == part(f"land{log2}.ffp", "direct.ffp", *options), options


@case("beyond the region there is ground, as far off as is told, and its images are enlarged")
def _():
    for log2 in 10, 7:
        part(f"land{log2}.ffp", "part.ffp", "--region=" + REGIONS[0])
        (ours, _, error), (theirs, _, exact) = raster("part.ffp", "a.tif"), raster(f"land{log2}.ffp", "b.tif")
        most = abs(ours - theirs).max()
        assert exact == 0 and 10 < most <= error < 2 * most + 10, (most, error)
        for level in range(4) if FULL else (0, 3):
            ours, theirs = (raster(pack, "a.tif", "--images", "--level", level)[0] for pack in ("part.ffp", f"land{log2}.ffp"))
            assert ours.shape == theirs.shape and (abs(ours - theirs).mean() < 40 and ours.max(axis=0).min() > 0), (level, abs(ours - theirs).mean())


@case("flights within the region draw and ask as over the whole; out of it ground is coarse, never missing, and nothing is refused")
def _():
    for log2 in 10, 7:
        part(f"land{log2}.ffp", "part.ffp", "--region=9.03,45.955,9.16,46.04")
        # a part has six bytes more in all: on a slow link something would come a frame later
        within = "--link", "lan", "--path", "hover", "--start", 0.5, "--height", 60, "--settle", 0, "--seconds", 40 if FULL else 16, "--view", 2000, "--entry", "off", "--panorama", "off"
        for memory in ("4M", "1M") if FULL else ("4M",) if log2 == 10 else ("1M",):
            whole, there = fly_to("whole", f"land{log2}.ffp", *within, "--memory", memory)
            ours, here = fly_to("part", "part.ffp", *within, "--memory", memory, "--truth", f"land{log2}.ffp")
            assert (ours["bytes_images"] > 0) == (memory == "4M"), ours["bytes_images"]
            if ours["bytes_images"]:  # a part's images come a level at a time; the same ones, but for bytes that say what has none
                assert here == there
            else:
                for key in "geometry_hash", "request_hash", "frame_hash", "err_px_rms":
                    assert whole[key] == ours[key], (log2, key, whole[key], ours[key])
            assert abs(ours["bytes_down"] - whole["bytes_down"]) < 20, (ours["bytes_down"], whole["bytes_down"])
            assert ours["requests_failed"] == 0, ours["requests_failed"]
        still, far = ("--panorama", "off"), ("--panorama", "on", "--back-plane", 3000)
        for options in (still, far) if FULL else (still,) if log2 == 10 else (far,):
            out = fly("part.ffp", "--path", "diagonal", "--start", 0.5, "--speed", 900, "--height", 150, "--seconds", 60 if FULL else 30, "--truth", f"land{log2}.ffp", "--check", "on", *options)
            assert out["requests_failed"] == 0 and out["crack_frames"] == 0 and out["undrawn_px_percent"] < 0.5 and out["square_px_stub"] > 0, out


@case("images of sea are left out, asked for by nobody, and exported as the sea; the same with any --jobs, and a part keeps the marks")
def _():
    rows, columns = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    waves = np.array([np.clip(128 + 100 * np.sin(columns / (4 + band)) * np.cos(rows / 3), 0, 255) for band in range(3)])
    sea = np.where(columns > 200, np.array([30, 60, 120])[:, None, None], waves).astype(np.uint8)
    size_of = {}
    for name, colours in ("waves", waves.astype(np.uint8)), ("sea", sea):
        image = put(name + ".tif", colours, kind=gdal.GDT_Byte, place=PLACE)
        for jobs in 1, 2:
            done = run("bake", "land.tif", "-o", f"{name}{jobs}.ffp", "--color", image, "--texture-levels", 4, "--jobs", jobs)
            assert done.returncode == 0, done.stderr
        assert open(os.path.join(work, name + "1.ffp"), "rb").read() == open(os.path.join(work, name + "2.ffp"), "rb").read()
        size_of[name] = sum(count for (kind, level), count in sections(name + "1.ffp").items() if kind == "texture")
    assert size_of["sea"] < 0.8 * size_of["waves"], size_of
    ours, place, _ = raster("sea1.ffp", "a.tif", "--images")
    j, i = np.mgrid[0:ours.shape[1], 0:ours.shape[2]]
    at_sea = place[0] + i * place[1] > PLACE[0] + 260 * SPACING  # images coarser by a level or two are blurred across the coast
    assert abs(ours - np.array([30, 60, 120])[:, None, None]).max(axis=0)[at_sea].max() < 10
    assert part("sea1.ffp", "all.ffp") == open(os.path.join(work, "sea1.ffp"), "rb").read()
    assert told("sea1.ffp", "--region=" + REGIONS[0]) == len(part("sea1.ffp", "part.ffp", "--region=" + REGIONS[0]))
    for pack in "sea1.ffp", "part.ffp":
        for panorama in "off", "on":
            flight = fly(pack, "--settle", 10 if FULL else 1, "--seconds", 40 if FULL else 16, "--speed", 1200, "--height", 300, "--panorama", panorama, "--back-plane", 3000)
            assert flight["requests_failed"] == 0 and (panorama == "on" or flight["bytes_images"] > 0), (pack, panorama, flight["requests_failed"])


@case("what cannot be cut is refused in one line")
def _():
    refused_part("beside the pack", "land7.ffp", "x.ffp", "--region=20,45,21,46")
    refused_part("is not", "land7.ffp", "x.ffp", "--region=9.05,45.97,9.05,46.01", code=2)
    refused_part("levels 0 to 4", "land7.ffp", "x.ffp", "--level", 5)
    refused_part("is the input", "land7.ffp", "land7.ffp")
    refused_part("are for other outputs", "land7.ffp", "x.ffp", "--images")
    refused_part("are for other outputs", "land7.ffp", "x.ffp", "--voids", "nodata")
    refused_part("-o OUT.ffp, or none", "land7.ffp", "x.tif", "--estimate", code=2)
    assert run("export", "--estimate").returncode == 2
    plain = run("bake", put("plain.tif", np.arange(40000).reshape(200, 200) % 97, reference=None), "-o", "plain.ffp")
    assert plain.returncode == 0, plain.stderr
    refused_part("reference system", "plain.ffp", "x.ffp", "--region=9,45,10,46")
    part("plain.ffp", "coarse.ffp", "--level", 1)
    damaged = bytearray(open(os.path.join(work, "land7.ffp"), "rb").read())
    for at in range(len(damaged) // 3, len(damaged) // 3 + 4000):
        damaged[at] ^= 0x55
    open(os.path.join(work, "damaged.ffp"), "wb").write(damaged)
    refused_part("tile [0-9]+, level [0-9]+, code [0-9]+: ", "damaged.ffp", "x.ffp")
    assert not [name for name in os.listdir(work) if name.startswith("x.")], os.listdir(work)


finish()
