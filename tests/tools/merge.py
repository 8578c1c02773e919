#!/usr/bin/env python3
"""Packs that farfield-merge joins, run by merge.sh. FULL=1 (make parts): 200 draws by chance, and more of everything."""
import os
import random
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

EAST, NORTH = 500000, 5100000  # where the south-west samples lie
FULL = os.environ.get("FULL", "0") != "0"
DRAWS = 200 if FULL else 4


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
    done = run("fly", "--pack", name, "--json", "--backend", "soft565", "--settle", 4, "--audit", "on", "--audit-step", 24, "--quality", "px:1", "--seconds", 20 if FULL else 8, *options)
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
        for order in range(3 if FULL else 1):
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


COUNTRY = ground(640, 2)


def inset(left, bottom, columns, rows):
    """A fine pack of a part of COUNTRY: (name, heights, x, y)."""
    heights = COUNTRY[bottom:bottom + rows, left:left + columns]
    return pack("fine", heights, x=10 * left, y=10 * bottom), heights, 10 * left, 10 * bottom


@case("fine ground in coarse country: all samples of both stay, the pack is no larger than both, what is coarse costs nothing finer")
def _():
    coarse = pack("coarse", COUNTRY[::4, ::4] + 30, spacing=40)  # 30 m higher: one is told from the other
    for left, bottom, columns, rows in ((160, 160, 129, 129), (203, 301, 150, 97), (0, 0, 100, 641), (37, 2, 20, 9))[:None if FULL else 2]:
        fine, heights, x, y = inset(left, bottom, columns, rows)
        summary = merge(coarse, fine)
        joint = read("joint.ffp")
        assert joint[1:] == (0, 0, 10) and joint[0].shape == (641, 641)
        assert holds(joint, heights, 10, x, y)
        under = np.zeros((161, 161), bool)
        under[-(-bottom // 4):(bottom + rows - 1) // 4 + 1, -(-left // 4):(left + columns - 1) // 4 + 1] = True
        assert holds(joint, COUNTRY[::4, ::4] + 30, 40, 0, 0, but=under)
        assert summary["file_bytes"] <= 1.05 * summary["packs_bytes"] and summary["uncovered"] == 0, summary
        merge(fine, coarse, out="other.ffp", options=("--jobs", 1))
        assert data("joint.ffp") == data("other.ffp")


def flies(name, *options):
    """Flies over a pack: all is drawn, without cracks, and nothing is asked for that is not stored."""
    flight = fly(name, "--check", "on", "--path", "diagonal", "--start", 0.1, "--speed", 900, "--height", 120, "--panorama", "off", *options)
    assert flight["requests_failed"] == 0 and flight["crack_frames"] == 0 and flight["undrawn_px_percent"] < 0.5, flight
    return flight


@case("over the rim of fine ground all is drawn, nothing is asked for below leaves, and coarse ground is no rougher than it was")
def _():
    coarse = pack("coarse", COUNTRY[::4, ::4], spacing=40)
    fine, *_ = inset(203, 211, 150, 137)
    merge(coarse, fine)
    flies("joint.ffp")
    FULL and flies("joint.ffp", "--memory", "1M", "--panorama", "on", "--back-plane", 2000)
    levels = max(s["level"] for s in json.loads(run("info", "--json", "joint.ffp").stdout)["sections"] if s["kind"] == "refinement") + 2
    for region, rough in ("9.0013,46.0545,9.0129,46.0615", False), ("9.03,46.08,9.035,46.085", True):
        done = run("export", "joint.ffp", "-o", "level.tif", "--level", levels - 3, "--region", region)
        assert done.returncode == 0, done.stderr
        error = gdal.Open(os.path.join(work, "level.tif")).GetMetadataItem("error")
        assert ("between" in error) == rough, (region, error)  # of the coarse pack's level there



def joins(parts):
    """Joins packs (name, heights, spacing, x, y), the later ones finer or named later, and compares all samples with the sources."""
    summary = merge(*(part[0] for part in parts))
    joint = read("joint.ffp")
    have, left, bottom, fine = joint
    owner = np.full(have.shape, -1)
    for number, (_, heights, spacing, x, y) in sorted(enumerate(parts), key=lambda part: (part[1][2], part[0]), reverse=True):
        column, row, apart = round((x - left) / fine), round((y - bottom) / fine), round(spacing / fine)
        owner[row:row + (heights.shape[0] - 1) * apart + 1, column:column + (heights.shape[1] - 1) * apart + 1] = number
    for number, (name, heights, spacing, x, y) in enumerate(parts):
        column, row, apart = round((x - left) / fine), round((y - bottom) / fine), round(spacing / fine)
        own = owner[row:row + (heights.shape[0] - 1) * apart + 1:apart, column:column + (heights.shape[1] - 1) * apart + 1:apart]
        assert holds(joint, heights, spacing, x, y, but=own != number), name
    return summary


@case("three spacings, fine ground that reaches beyond the country, and packs apart: what nobody covers is filled, and told so")
def _():
    coarse = pack("coarse", COUNTRY[::4, ::4], spacing=40), COUNTRY[::4, ::4], 40, 0, 0
    middle = pack("middle", COUNTRY[40:401:2, 80:501:2], spacing=20, x=800, y=400), COUNTRY[40:401:2, 80:501:2], 20, 800, 400
    inner = pack("inner", COUNTRY[100:200, 150:263], x=1500, y=1000), COUNTRY[100:200, 150:263], 10, 1500, 1000
    out = pack("out", LAND[:, :101], x=5930, y=5170), LAND[:, :101], 10, 5930, 5170
    far = pack("far", LAND[:90, :77], x=9010, y=-1270), LAND[:90, :77], 10, 9010, -1270
    assert joins([coarse, middle, inner])["uncovered"] == 0
    FULL and flies("joint.ffp")
    assert 0.1 < joins([coarse, out, inner])["uncovered"] < 0.3
    flies("joint.ffp", "--start", 0.6)
    summary = joins([far, middle, out])
    assert 0.6 < summary["uncovered"] < 0.95 and summary["file_bytes"] < 1.05 * summary["packs_bytes"], summary
    heights = read("joint.ffp")[0]
    assert 550 < heights.min() and heights.max() < 1250, (heights.min(), heights.max())  # as the packs
    FULL and flies("joint.ffp", "--seconds", 60)
    done = run("export", "joint.ffp", "-o", "told.tif", "--voids", "nodata")
    assert done.returncode == 0, done.stderr
    told = gdal.Open(os.path.join(work, "told.tif"))
    void = (told.ReadAsArray() == told.GetRasterBand(1).GetNoDataValue()).mean()
    assert abs(void - summary["uncovered"]) < 0.1, (void, summary["uncovered"])


@case("what was filled in a pack is told as filled in the joint one, and not much more")
def _():
    holed = LAND.copy()
    holed[30:60, 100:180] = holed[200:, 3:9] = -9999
    left, right = pack("left", holed[:, :131], nodata=-9999), pack("right", holed[:, 130:], x=1300, nodata=-9999)
    coarse = pack("coarse", LAND[::4, ::4], spacing=40, x=2600)
    merge(left, coarse, right)
    assert holds(read("joint.ffp"), LAND, 10, 0, 0, but=holed == -9999)
    done = run("export", "joint.ffp", "-o", "told.tif", "--voids", "nodata")
    assert done.returncode == 0, done.stderr
    told = gdal.Open(os.path.join(work, "told.tif"))
    void = (told.ReadAsArray() == told.GetRasterBand(1).GetNoDataValue())[::-1]
    assert void[:261, :261][holed == -9999].all() and void.sum() < 2 * (holed == -9999).sum(), (void.sum(), (holed == -9999).sum())


@case("ground that was filled in the finer pack gives way to coarse ground that was measured")
def _():
    coarse = pack("coarse", COUNTRY[::4, ::4] + 500, spacing=40)
    holed = COUNTRY[200:361, 200:361].copy()
    holed[40:121, 40:121] = -9999
    fine = pack("fine", holed, x=2000, y=2000, nodata=-9999)
    for order in (coarse, fine), (fine, coarse):
        merge(*order)
        have = read("joint.ffp")[0]
        assert (have[256:305:4, 256:305:4] == COUNTRY[256:305:4, 256:305:4] + 500).all()  # well within the hole
        assert (have[200:230, 200:361] == holed[:30]).all()  # well beside it
        done = run("export", "joint.ffp", "-o", "told.tif", "--voids", "nodata")
        assert done.returncode == 0, done.stderr
        told = gdal.Open(os.path.join(work, "told.tif"))
        void = told.GetRasterBand(1).GetNoDataValue()
        assert void is None or not (told.ReadAsArray() == void).any()


WAVES = np.array([np.clip(128 + 100 * np.sin(np.arange(641)[None, :] / (9 + band)) * np.cos(np.arange(641)[:, None] / 7), 0, 255) for band in range(3)])


def cut(whole, out, region, *options):
    done = run("export", whole, "-o", out, "--region", region, *options)
    assert done.returncode == 0, done.stderr
    return out


@case("parts cut from a pack give that pack again, and a part of it where they leave some out: lossy, with voids, images and tiles of any size")
def _():
    land = np.where((np.arange(641) % 97 < 5)[:, None] & (np.arange(641) % 71 < 9)[None, :], -9999, COUNTRY)
    colour = put("colour.tif", WAVES.astype(np.uint8), kind=gdal.GDT_Byte, place=(EAST - 5, 10, 0, NORTH + 6405, 0, -10))
    west, middle, east = "8.9,46,9.03,46.2", "9.02,46,9.06,46.2", "9.04,46,9.2,46.2"
    for options in ((), ("--max-error", 3, "--tile-log2", 8, "--color", colour, "--codec", "rice"), ("--tile-log2", 7, "--color", colour, "--texture-levels", 3), ("--codec", "raw"))[:None if FULL else 2]:
        whole = pack("whole", land, "--name", "Waves", "--attribution", "Nobody", *options, nodata=-9999)
        parts = [cut(whole, f"part{i}.ffp", region) for i, region in enumerate((west, middle, east))]
        merge(*parts)
        assert data("joint.ffp") == data("whole.ffp"), options
        merge(parts[2], parts[0], out="two.ffp")  # what lies between them is left out
        assert max(map(len, map(data, parts))) < len(data("two.ffp")) < len(data("whole.ffp"))
        merge("two.ffp", parts[1])
        assert data("joint.ffp") == data("whole.ffp"), options
        FULL and flies("two.ffp")
        coarse = cut(whole, "coarse.ffp", west, "--level", 2)
        merge(coarse, parts[0])
        assert data("joint.ffp") == data(parts[0])
    other, first = pack("other", COUNTRY), pack("first", COUNTRY[::-1])  # of one size, from the same lowest to the same highest sample
    refused_merge("is a part cut from a pack", cut(other, "a.ffp", west), cut(first, "b.ffp", east))
    refused_merge("is a part cut from a pack", cut(other, "a.ffp", west), pack("far", LAND, x=9000))


@case("what does not fit is refused in one line with the bake that makes it fit, and that bake does")
def _():
    first = pack("first", LAND)
    def refits(pattern, name, heights, *options, again=None, **written):
        refused_merge(pattern + r".*farfield-bake HEIGHTS --lattice first\.ffp", first, pack(name, heights, *options, **written))
        done = run("bake", f"{name}.tif", "-o", f"{name}.ffp", "--lattice", first, *(again or ()))
        assert done.returncode == 0, done.stderr
        summary = merge(first, f"{name}.ffp")
        return summary, read(f"{name}.ffp")
    east = dict(x=2600)
    _, (heights, x, y, spacing) = refits("reference systems", "zone", LAND, "--t-srs", "EPSG:32633", **east)
    assert spacing == 10 and x % 10 == 0 and y % 10 == 0
    assert refits("spacings of 15 and 10 m", "fifteen", LAND, spacing=15, **east)[1][3] == 20
    assert refits("spacings of 35 and 10 m", "forty", LAND[::4, ::4], spacing=35, again=("--spacing", 40), **east)[1][3] == 40
    _, (heights, x, y, spacing) = refits("each other's places", "between", LAND, x=2604, y=3)
    assert (x, y) in ((2600, 0), (2610, 10)) and spacing == 10  # as resampling fills the source's area
    _, (heights, x, y, spacing) = refits("each other's places", "near", LAND, x=2601, y=-1)
    assert (x, y) == (2600, 0) and (heights == LAND).all()  # within an eighth of a sample: kept
    _, (heights, *place) = refits("heights in steps of 0.1 and 1 m", "tenths", LAND, "--hscale", 0.1, **east)
    assert (heights == LAND).all()
    assert (refits("nodes of unlike size or codec", "rice", LAND, "--codec", "rice", **east)[1][0] == LAND).all()
    assert (refits("nodes of unlike size or codec", "nodes", LAND, "--node-log2", 4, **east)[1][0] == LAND).all()
    assert (refits("fall away differently", "flat", LAND, "--flat", **east)[1][0] == LAND).all()
    refused_merge("has an error of 2 m.*--max-error", first, pack("lossy", LAND, "--max-error", 2, **east))
    refused_merge("span more than 65536 steps.*--hscale", pack("low", LAND * 0.01 - 400, "--hscale", 0.01, kind=gdal.GDT_Float32), pack("high", LAND * 0.01 + 400, "--hscale", 0.01, kind=gdal.GDT_Float32, **east))
    degrees = put("degrees.tif", LAND, kind=gdal.GDT_Int16, place=(9.1, 1e-4, 0, 46.06, 0, -1e-4), reference="EPSG:4326")
    done = run("bake", degrees, "-o", "degrees.ffp", "--lattice", first)
    assert done.returncode == 0, done.stderr
    merge(first, "degrees.ffp")
    for pattern, options in ("not a power of two times", ("--spacing", 30)), ("takes all that", ("--t-srs", "EPSG:32632")):
        done = run("bake", "first.tif", "-o", "never.ffp", "--lattice", first, *options)
        assert done.returncode != 0 and re.search(pattern, done.stderr) and done.stderr.count("\n") == 1, done.stderr
    merge(first, first)
    assert data("joint.ffp") == data(first)


@case("an input is never written over, one pack alone and what is no pack are refused, and damage leaves nothing behind")
def _():
    left, right = pack("left", LAND[:, :131]), pack("right", LAND[:, 130:], x=1300)
    before = data(left)
    merge(left, right)
    done = run("merge", left, right, "-o", left)
    assert done.returncode == 1 and "not overwritten" in done.stderr and data(left) == before
    refused_merge("two packs or more", left)
    refused_merge("nowhere.ffp: ", left, "nowhere.ffp")
    chance = random.Random(5)
    for at in [chance.randrange(4096, len(before)) for _ in range(40 if FULL else 6)] + [9, 30, 700]:
        with open(os.path.join(work, "bad.ffp"), "wb") as out:
            out.write(before[:at] + bytes((before[at] ^ 1 << chance.randrange(8),)) + before[at + 1:])
        done = run("merge", right, "bad.ffp", "-o", "never.ffp", "--quiet")
        assert done.returncode in (0, 1) and done.stderr.count("\n") == done.returncode, (at, done.stderr)
        if done.returncode == 0:  # a bit that says nothing
            assert data("never.ffp") == data("joint.ffp"), at
            os.remove(os.path.join(work, "never.ffp"))
        assert not [name for name in os.listdir(work) if name.startswith("never")]


@case("what packs say of themselves is joined, each word once, as told or as there is room for")
def _():
    a = pack("a", LAND[:, :100], "--name", "Alps", "--attribution", "Alpha", "--licence", "CC0", "--date", "2020")
    b = pack("b", LAND[:, 99:200], "--name", "Alps", "--attribution", "Beta; Alpha", "--vertical-datum", "EGM96 height", x=990)
    c = pack("c", LAND[:, 199:], "--name", "Jura", "--attribution", "Al", x=1990)
    def about(*packs, options=()):
        merge(*packs, options=options)
        return json.loads(run("info", "--json", "joint.ffp").stdout)["about"]
    told = about(a, b, c)
    assert [told.get(key) for key in ("name", "attribution", "licence", "date", "vertical_datum")] == ["Alps; Jura", "Alpha; Beta; Al", "CC0", "2020", "EGM96 height"], told
    os.rename(os.path.join(work, "joint.ffp"), os.path.join(work, "all.ffp"))
    assert about("all.ffp", b)["attribution"] == "Alpha; Beta; Al"
    assert about(b, a, options=("--attribution", "Who", "--name", "Where"))["attribution"] == "Who"
    long = [pack(f"long{i}", LAND[:, 100 * i:100 * i + 61], "--attribution", chr(97 + i) * 300, x=1000 * i) for i in (0, 1)]
    refused_merge("--attribution have 602 bytes together, at most 400", *long)
    merge(*long, options=("--attribution", "both"))
    assert about(a, b)["projection_wkt"] == json.loads(run("info", "--json", a).stdout)["about"]["projection_wkt"]


def texels(name):
    """(colours, geotransform) of a pack's finest images."""
    done = run("export", name, "-o", "texels.tif", "--images")
    assert done.returncode == 0, done.stderr
    made = gdal.Open(os.path.join(work, "texels.tif"))
    return made.ReadAsArray()[:3].astype(float), made.GetGeoTransform()


def sampled(name, x, y):
    """The colours of a pack's images at places in metres from EAST, NORTH."""
    colours, place = texels(name)
    column, row = ((EAST + x - place[0]) / place[1]).astype(int), ((NORTH + y - place[3]) / place[5]).astype(int)
    return colours[:, np.clip(row, 0, colours.shape[1] - 1), np.clip(column, 0, colours.shape[2] - 1)]


@case("images are put together without a seam: about as near to their source as in the parts, in a pack no larger")
def _():
    colour = put("colour.tif", WAVES.astype(np.uint8), kind=gdal.GDT_Byte, place=(EAST - 5, 10, 0, NORTH + 6405, 0, -10))
    y, x = np.mgrid[20:6390:10, 20:6390:10].astype(float)
    source = WAVES[:, (640 - y / 10).round().astype(int), (x / 10).round().astype(int)]
    whole = pack("whole", COUNTRY, "--color", colour)
    left, right = pack("left", COUNTRY[:, :311], "--color", colour), pack("right", COUNTRY[:, 310:], "--color", colour, x=3100)
    bare = pack("bare", COUNTRY[:, 310:], x=3100)
    summary = merge(left, right)
    assert summary["file_bytes"] < 1.05 * summary["packs_bytes"] and summary["texture_levels"] > 1, summary
    once, twice = (np.abs(sampled(name, x, y) - source) for name in (whole, "joint.ffp"))
    assert twice.mean() < 2 * once.mean() + 2 and twice[:, :, 305:312].mean() < 1.2 * twice.mean() + 1, (once.mean(), twice.mean(), twice[:, :, 305:312].mean())
    one = data("joint.ffp")
    merge(left, right, options=("--jobs", 1))
    assert data("joint.ffp") == one
    assert flies("joint.ffp")["bytes_images"] > 0
    assert (read("joint.ffp")[0] == COUNTRY).all()
    night = put("night.tif", np.full((3, 60, 60), 20, np.uint8), kind=gdal.GDT_Byte, place=(EAST - 5, 100, 0, NORTH + 6005, 0, -100))
    dark, light = pack("dark", COUNTRY[::4, ::4], "--color", night, spacing=40), pack("light", COUNTRY[200:301, 200:301], "--color", colour, x=2000, y=2000)
    for order in (dark, light), (light, dark):
        merge(*order)
        joint = sampled("joint.ffp", x, y)
        assert np.abs(joint - source)[:, 200:296, 200:296].mean() < 2 * once.mean() + 2 and np.abs(joint[:, :150, :590] - 20).mean() < 4
    merge(left, bare)
    assert np.abs(sampled("joint.ffp", x, y) - source)[:, :, :300].mean() < 2 * once.mean() + 2


@case(f"{DRAWS} draws of packs by chance: spacings, sizes and places of all kinds keep all their samples, whatever --jobs")
def _():
    for seed in range(DRAWS):
        chance = random.Random(1000 + seed)
        land = ground(300, seed, rough=chance.choice((0, 5, 60)))
        apart = [chance.choice((1, 1, 2, 4, 8, 32)) for _ in range(chance.randint(2, 5))]
        parts, coarsest = [], max(apart)
        shift = chance.choice((0, 0, -1200, 900))
        for number, times in enumerate(apart):
            columns, rows = chance.randint(2, 300 // times), chance.randint(2, 300 // times)
            left, bottom = times * chance.randint(0, 300 // times - columns), times * chance.randint(0, 300 // times - rows)
            heights = land[bottom:bottom + (rows - 1) * times + 1:times, left:left + (columns - 1) * times + 1:times] + chance.choice((0, 40)) + shift
            x, y = 10 * left + chance.choice((0, 0, 10 * coarsest * 20)), 10 * bottom
            parts.append((pack(f"draw{number}", heights, *(() if chance.random() < 0.7 else ("--node-log2", 3)), spacing=10 * times, x=x, y=y), heights, 10 * times, x, y))
        try:
            summary = joins(parts)
            assert summary["file_bytes"] <= 1.05 * summary["packs_bytes"], summary
            merge(*(part[0] for part in parts), out="other.ffp", options=("--jobs", chance.choice((1, 3))))
            assert data("joint.ffp") == data("other.ffp"), "jobs"
        except Exception as fault:
            raise AssertionError(f"draw {seed}: {[(name, heights.shape, *place) for name, heights, *place in parts]}: {fault}")


finish()
