"""What the heights of a raster mean, run by bake_heights.sh: each case bakes small rasters and looks at the ground that comes out."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

y, x = np.mgrid[0:60, 0:80].astype(float)
plane = 800 + 3 * x - 5 * y  # a tilted plane: any shift, turn or mirror shows
hole = np.zeros(plane.shape, bool)
hole[20:40, 30:50] = True
inner = (slice(25, 35), slice(35, 45))
valid = np.where(hole, 0, 255)


def holed(path, *options):
    """The 400 samples of the hole are void, and all others as they were."""
    summary, said = bake(path, *options)
    assert summary, said
    heights, _ = export()
    assert summary["voids"] == 400, (summary["voids"], said)
    assert abs(heights - plane)[~hole].max() < 0.01, abs(heights - plane)[~hole].max()
    assert abs(heights[inner] - plane[inner]).max() < 60
    return said


# ---- voids ----
@case("an internal mask, a mask file and a mask beside a nodata value are voids")
def _():
    zero = np.where(hole, 0, plane)
    holed(put("mask.tif", zero, mask=valid))
    gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", "NO")
    path = put("beside.tif", zero, mask=valid)
    gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES")
    assert os.path.exists(path + ".msk")
    holed(path)
    holed(put("both.tif", zero, mask=valid, nodata=-1))


@case("alpha is a mask beside heights of any type")
def _():
    for kind in (gdal.GDT_Float32, gdal.GDT_Int16, gdal.GDT_UInt16, gdal.GDT_Float64):
        holed(put("alpha.tif", [np.where(hole, 7, plane), valid], kind, alpha=True))


@case("nodata values of all types are voids: too large ones for the type, NaN, whole ones of 64 bits")
def _():
    for kind, nodata in ((gdal.GDT_Int16, -32768), (gdal.GDT_UInt16, 0), (gdal.GDT_Int32, -2147483648), (gdal.GDT_Float32, float("nan")),
                         (gdal.GDT_Float32, -3.4028234663852886e38), (gdal.GDT_Float64, -1.7976931348623157e308), (gdal.GDT_Float64, 9999)):
        holed(put("nodata.tif", np.where(hole, nodata, plane), kind, nodata=nodata))
    for nodata in "0.1", "-9999.9":  # no float is that number, and the nearest is meant
        holed(put("nodata.tif", np.where(hole, float(nodata), plane), gdal.GDT_Float32), "--nodata", nodata)


@case("sentinels that no tag declares are voids where they lie apart, and told in one line")
def _():
    for kind, value in ((gdal.GDT_Float32, -9999), (gdal.GDT_Int16, -9999), (gdal.GDT_Int16, -32768), (gdal.GDT_Int16, -32767), (gdal.GDT_Int32, -99999),
                        (gdal.GDT_Float32, float(np.finfo(np.float32).min)), (gdal.GDT_Float64, float(np.finfo(np.float64).min))):
        said = holed(put("sentinel.tif", np.where(hole, value, plane), kind))
        assert said.count("no nodata tag declares") == 1, said
    assert "400 of 4800 samples are void" in holed(put("nan.tif", np.where(hole, np.nan, plane)))
    assert "beyond +-12000 m" in holed(put("absurd.tif", np.where(hole, 1e6, plane)))


@case("a floor of -9999 m beside others is no void, and told; --nodata decides")
def _():
    trench = -9990 - 0.25 * np.arange(80) * np.ones((60, 1))
    trench[10, 40] = -9999
    path = put("trench.tif", trench)
    summary, said = bake(path)
    assert summary["voids"] == 0 and "taken as heights" in said, (summary, said)
    cells = int((trench == -9999).sum())
    assert bake(path, "--nodata", "-9999")[0]["voids"] == cells
    path = put("sentinel.tif", np.where(hole, -9999, plane))
    summary, said = bake(path, "--nodata", "none")
    assert summary["voids"] == 0 and summary["height_min_m"] == -9999 and "nodata" not in said, (summary, said)
    holed(put("odd.tif", np.where(hole, 4321, plane)), "--nodata", "4321")
    assert run("bake", path, "-o", "out.ffp", "--nodata", "x").returncode == 2


@case("a void height is given to all voids, a rim void height to those that touch the rim: they count as given, not as filled")
def _():
    coast = np.where(x < 40, 2 + 12 * (40 - x), -9999)
    coast[30:34, 10:14] = -9999  # a void in the land
    coast[50:55, 40:60] = 5  # land in the sea, and a lake in it that touches the sea by a corner
    coast[52:54, 42:59] = -9999
    path = put("coast.tif", coast, nodata=-9999)
    sea, land, lake, inner = coast == -9999, coast != -9999, np.zeros(coast.shape, bool), np.zeros(coast.shape, bool)
    inner[30:34, 10:14] = lake[52:54, 42:59] = True
    voids = int(sea.sum())
    summary, _ = bake(path, "--void-height", "0")
    heights, _ = export()
    assert (summary["voids"], summary["given"]) == (0, voids) and abs(heights[sea]).max() < 0.01 and abs(heights - coast)[land].max() < 0.01
    summary, said = bake(path, "--rim-void-height", "0")
    heights, _ = export()
    rim = sea & ~inner & ~lake
    assert (summary["voids"], summary["given"]) == (int((inner | lake).sum()), int(rim.sum())) and "given the height" in said, (summary, said)
    assert abs(heights[rim]).max() < 0.01 and heights[inner].min() > 200 and 4 < heights[lake].min() <= heights[lake].max() < 6
    summary, _ = bake(path, "--rim-void-height", "-3", "--void-height", "777")
    heights, _ = export()
    assert summary["given"] == voids and abs(heights[rim] + 3).max() < 0.01 and abs(heights[inner] - 777).max() < 0.01


@case("voids that touch the rim are found in any shape: as a second search, sample by sample, finds them")
def _():
    chance = np.random.default_rng(7)
    for share in (0.3, 0.45, 0.6):
        ground = np.where(chance.random((60, 80)) < share, -9999, 100.0)
        reached = np.zeros((62, 82), bool)
        reached[0] = reached[-1] = reached[:, 0] = reached[:, -1] = True
        void = np.pad(ground == -9999, 1)
        while True:
            near = np.zeros_like(reached)
            for dy in (-1, 0, 1):
                for dx in (-1, 0, 1):
                    near |= np.roll(reached, (dy, dx), (0, 1))
            grown = reached | near & void
            if (grown == reached).all():
                break
            reached = grown
        reached = reached[1:-1, 1:-1] & (ground == -9999)
        summary, said = bake(put("chance.tif", ground, nodata=-9999), "--rim-void-height", "0")
        heights, _ = export()
        assert summary["given"] == int(reached.sum()), (share, summary["given"], reached.sum())
        assert ((heights < 1) == reached).all(), share


# ---- units ----
@case("units of all sizes are metres (their spellings: test_bake.c)")
def _():
    foot = 0.3048
    for metres, name in ((foot, "foot (International)"), (1200 / 3937, "US_survey_foot"), (1, "m (MSL)"), (1000, "km"), (0.1, "0.1 m"), (6 * foot, "fathom")):
        summary, said = bake(put("unit.tif", plane / metres, gdal.GDT_Float64, unit=name))
        assert abs(summary["height_max_m"] - plane.max()) < 0.05 and "unit" not in said, (name, summary["height_max_m"], said)


@case("an unknown unit is told; --scale decides")
def _():
    path = put("unit.tif", plane, unit="klafter")
    summary, said = bake(path)
    assert "klafter" in said and "--scale" in said and summary["height_max_m"] == plane.max(), said
    summary, said = bake(path, "--scale", "1.8965")
    assert "klafter" not in said and abs(summary["height_max_m"] - 1.8965 * plane.max()) < 0.01, (summary["height_max_m"], said)


@case("the vertical part of a compound reference system tells the unit; the raster's own goes first")
def _():
    compound = "EPSG:32612+6360"  # NAVD88 height in US survey feet
    survey = 1200 / 3937
    told, untold = put("told.tif", plane / survey, reference=compound), os.path.join(work, "untold.vrt")
    gdal.Translate(untold, put("plain.tif", plane / survey), format="VRT", outputSRS=compound)
    for path, unit in ((told, "US survey foot"), (untold, "")):  # GDAL makes it the band's unit in a GeoTIFF
        raster = gdal.Open(path)
        assert raster.GetRasterBand(1).GetUnitType() == unit, raster.GetRasterBand(1).GetUnitType()
        assert abs(bake(path)[0]["height_max_m"] - plane.max()) < 0.05, path
    assert abs(bake(put("own.tif", plane / 0.3048, reference=compound, unit="ft"))[0]["height_max_m"] - plane.max()) < 0.01


# ---- steps ----
@case("heights of any scale and offset come out exact, as whole steps of their own")
def _():
    whole = np.round(plane).astype(int)
    kinds, places = (gdal.GDT_Int16, gdal.GDT_Float32, gdal.GDT_Int32), (0, -900)  # below zero, too
    trial = 0
    for scale in (1, 0.5, 0.1, 0.3048, 0.01, 1 / 3):
        for offset in (0.5, 0.3 * scale, -4000.125):
            values = whole + places[trial % 2]
            summary, said = bake(put("scaled.tif", values, kinds[trial % 3], scale=scale, offset=offset))
            heights, _ = export()
            wrong = heights - (values * scale + offset)
            # the offset is told in 1/256 m, the step in 2^-24 m
            assert abs(wrong).max() < 1 / 500 + 1e-6 * abs(heights).max() and np.ptp(wrong) < 1e-3, (scale, offset, wrong.min(), wrong.max(), said)
            assert abs(summary["hscale_m"] / scale - 1) < 1e-5 and "not exact" not in said, (scale, offset, said)
            trial += 1


@case("steps finer than a pack tells are said to be, and heights are within half of one")
def _():
    values = np.round(plane * 10).astype(int)
    summary, said = bake(put("fine.tif", values, gdal.GDT_Int32, scale=0.0001))
    heights, _ = export()
    assert "not exact" in said and abs(heights - values * 0.0001).max() < 0.0002 + 1 / 500, (said, abs(heights - values * 0.0001).max())


@case("heights are absurd by the body's measure: 21 km stand on Mars, not on the Earth, 11 km on the Moon, and 25 km on a small body")
def _():
    high = np.where(hole, 21229, plane)
    for radius, top, voids in ((3396190, 21229, 0), (6378137, 8849, 400), (1737400, 10786, 0), (262700, 22000, 0)):
        high = np.where(hole, 21229 if voids else top, plane)
        summary, said = bake(put("body.tif", high, reference="+proj=eqc +R=%d +units=m +no_defs" % radius))
        assert summary["voids"] == voids and (voids or summary["height_max_m"] == top), (radius, summary["voids"], said)
        assert ("no ground reaches" in said) == (voids > 0), said


# ---- heights in colours ----
def encoded(heights, encoding):
    number = np.round((heights + 10000) * 10 if encoding == "mapbox" else (heights + 32768) * 256).astype(int)
    return np.stack([number >> 16, number >> 8 & 255, number & 255])


def coloured(path, colours):
    """The raster with a palette of (red, green, blue, alpha)."""
    table = gdal.ColorTable()
    for index, colour in enumerate(colours):
        table.SetColorEntry(index, tuple(int(c) for c in colour))
    raster = gdal.Open(path, gdal.GA_Update)
    raster.GetRasterBand(1).SetColorTable(table)
    return path


@case("Terrain-RGB and Terrarium are decoded from TIFF, PNG, WebP and palettes, transparent pixels void")
def _():
    rough = plane + 0.3 * x  # no whole metres
    for encoding, step in (("mapbox", 0.1), ("terrarium", 1 / 256)):
        colours = encoded(rough, encoding)
        for name, driver, options in (("c.tif", "GTiff", []), ("c.png", "PNG", []), ("c.webp", "WEBP", ["LOSSLESS=YES"])):
            path = put(name, colours, gdal.GDT_Byte, driver=driver, options=options)
            summary, said = bake(path, "--rgb", encoding, "--spacing", "30")
            heights, _ = export()
            assert abs(heights - rough).max() < step / 2 + 0.0101, (encoding, name, abs(heights - rough).max(), said)
        covered = [*colours, valid]
        for name, driver, options in (("a.tif", "GTiff", []), ("a.webp", "WEBP", ["LOSSLESS=YES", "EXACT=YES"])):
            summary, said = bake(put(name, covered, gdal.GDT_Byte, driver=driver, options=options, alpha=True), "--rgb", encoding, "--spacing", "30")
            assert summary["voids"] == 400, (summary, said)
        black = np.where(hole, 0, colours)
        summary, said = bake(put("black.tif", black, gdal.GDT_Byte), "--rgb", encoding)
        assert summary["voids"] == 400 and said.count("no nodata tag declares") == 1, said
    flat = np.where(x < 40, 700.0, 900.0)
    palette = [(*encoded(np.array(height), "terrarium"), 255) for height in (700.0, 900.0)] + [(0, 0, 0, 0)]
    path = coloured(put("palette.tif", np.where(hole, 2, flat > 800), gdal.GDT_Byte), palette)
    summary, said = bake(path, "--rgb", "terrarium")
    heights, _ = export()
    assert summary["voids"] == 400 and abs(heights - flat)[~hole].max() < 0.01, (summary, said)


@case("encoded heights are noticed by metadata or name, and told; other images are refused in a line whose advice works")
def _():
    for encoding in ("mapbox", "terrarium"):
        path = put("colours.tif", encoded(plane, encoding), gdal.GDT_Byte)
        said = refused(path)
        assert "not heights" in said and "--rgb" in said, said
        assert bake(path, "--rgb", encoding)[0]["height_max_m"] == plane.max()
        tagged = gdal.Open(path, gdal.GA_Update)
        tagged.SetMetadataItem("encoding", encoding)
        del tagged
        summary, said = bake(path)
        assert summary["height_max_m"] == plane.max() and "metadata says" in said, said
    for name, encoding in (("my-terrain-rgb.tif", "mapbox"), ("Terrarium_12.tif", "terrarium")):
        summary, said = bake(put(name, encoded(plane, encoding), gdal.GDT_Byte))
        assert summary["height_max_m"] == plane.max() and "name says (--rgb " + encoding in said, said
    grey = (np.arange(60 * 80).reshape(60, 80) // 19).astype(int)
    for path in (put("colour.tif", [grey, grey, grey], gdal.GDT_Byte), put("rgba.tif", [grey, grey, grey, grey], gdal.GDT_Byte, alpha=True),
                 coloured(put("palette.tif", grey, gdal.GDT_Byte), [(index, 0, 0, 255) for index in range(256)])):
        assert "--rgb none where" in refused(path)
        summary, said = bake(path, "--rgb", "none")
        assert summary and summary["height_max_m"] == grey.max(), said
    assert "three bands" in refused(put("one.tif", plane), "--rgb", "mapbox")


# ---- limits ----
@case("a ground beyond the world's limits is refused with the field and its limit")
def _():
    said = refused(put("wide.tif", plane, place=(0, 300000, 0, 0, 0, -300000), reference=None))
    assert "spacing_wu 76800000 is not from 1 to" in said, said
    said = refused(put("wide.tif", plane, place=(0, 1e11, 0, 0, 0, -1e11), reference=None))
    assert "spacing_wu 4294967295 is not from 1 to" in said, said
    for place in ((0, 1e200, 0, 0, 0, -1e200), (1e308, 1e307, 0, 1e308, 0, -1e307), (1e13, 30, 0, 0, 0, -30), (float("nan"), 30, 0, 0, 0, -30)):
        said = refused(put("nowhere.tif", plane, place=place, reference=None))
        assert "is no place" in said, said


finish()
