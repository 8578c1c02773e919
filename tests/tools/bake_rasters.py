"""A property of all rasters, run by bake_rasters.sh: whatever the type, the form of voids, the unit, scale and offset, the exported heights are
within the error asked, exact where the source's own steps are kept, and voids are where they were. Case N is made from N alone: FIRST=N CASES=1."""
import os
import random
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
import rasters
from rasters import *

ROWS, COLUMNS = 40, 50
y, x = np.mgrid[0:ROWS, 0:COLUMNS].astype(float)
WHOLE = {gdal.GDT_Byte: (0, 255), gdal.GDT_UInt16: (0, 65535), gdal.GDT_Int16: (-32768, 32767), gdal.GDT_Int32: (-2**31, 2**31 - 1), gdal.GDT_UInt32: (0, 2**32 - 1)}
TYPES = [*WHOLE, gdal.GDT_Float32, gdal.GDT_Float64]
UNITS = [(None, 1), ("m", 1), ("ft", 0.3048), ("US survey foot", 1200 / 3937), ("dm", 0.1), ("cm", 0.01), ("km", 1000), ("fathom", 1.8288)]
FORMS = ("none", "nodata", "mask", "mask file", "alpha", "nan", "sentinel", "--nodata")
FLOAT = 2.0**-23  # metres pass through single precision


def holes(chance):
    void = np.zeros((ROWS, COLUMNS), bool)
    for _ in range(chance.randrange(1, 5)):
        row, column = chance.randrange(ROWS - 4), chance.randrange(COLUMNS - 4)
        void[row:row + chance.randrange(1, 15), column:column + chance.randrange(1, 15)] = True
    return void


def draw(seed):
    """What case `seed` is: a dictionary."""
    chance = random.Random(seed)
    kind = chance.choice(TYPES)
    name, metres = chance.choice(UNITS)
    scale = chance.choice((None, 1, 0.1, 0.5, 0.01, 2, 0.3, 1 / 3))
    offset = chance.choice((0, 0, 100, -50.5, 0.123, 1000.05)) if scale else None
    # ground of a few hundred metres, as values of the raster
    heights = chance.uniform(0, 3000) + 150 * np.sin(x / chance.uniform(3, 20) + chance.random()) * np.cos(y / chance.uniform(3, 20))
    values = (heights / metres - (offset or 0)) / (scale or 1)
    if kind in WHOLE:
        low, high = WHOLE[kind]
        values = np.clip(np.round(values), low + 2, high - 2)
    elif kind == gdal.GDT_Float32:
        values = values.astype(np.float32).astype(float)
    form = chance.choice(FORMS)
    if abs((values * (scale or 1) + (offset or 0)) * metres).max() > 11000:  # no ground: the type's least is too much
        name, metres, scale, offset = None, 1, None, None
    truth = (values * (scale or 1) + (offset or 0)) * metres
    apart = (-9999 * (scale or 1) + (offset or 0)) * metres < truth.min() - 200
    if form == "nan" and kind in WHOLE or form == "sentinel" and not (apart and (kind not in WHOLE or WHOLE[kind][0] < -9999)):
        form = "mask"
    if form == "--nodata" and kind not in WHOLE:
        form = "nodata"
    return {"kind": kind, "unit": name, "scale": scale, "offset": offset, "form": form, "values": values, "truth": truth, "void": holes(chance),
            "max_error": chance.choice((0, 0, 0.5, 3.7)), "give": chance.random() < 0.5, "chance": chance}


def make(case):
    """Writes the raster; tells its path and the options that go with it."""
    kind, values, void, form = case["kind"], case["values"].copy(), case["void"], case["form"]
    low = WHOLE[kind][0] if kind in WHOLE else -1e30
    written = {"nodata": low, "--nodata": low, "nan": np.nan, "sentinel": -9999, "mask": low, "mask file": low, "alpha": low}
    if form == "none":
        case["void"] = void = np.zeros_like(void)
    else:
        values[void] = written[form]
    place = {"kind": kind, "unit": case["unit"], "scale": case["scale"], "offset": case["offset"]}
    valid = np.where(void, 0, 255)
    if form == "nodata":
        place["nodata"] = low
    if form in ("mask", "mask file"):
        place["mask"] = valid
        gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES" if form == "mask" else "NO")
    bands = [values, valid] if form == "alpha" else values
    path = put("case.tif", bands, alpha=form == "alpha", **place)
    options = ["--nodata", "%d" % low] if form == "--nodata" else []
    return path, options


def look(seed):
    case = draw(seed)
    for left in ("case.tif", "case.tif.msk", "case.tif.aux.xml"):
        if os.path.exists(os.path.join(work, left)):
            os.unlink(os.path.join(work, left))
    path, options = make(case)
    void, truth, count = case["void"], case["truth"], int(case["void"].sum())
    step = (case["scale"] or 1) * dict(UNITS)[case["unit"]]
    own = (case["offset"] or 0) * dict(UNITS)[case["unit"]]
    given = own + round((truth[~void].max() + 50 - own) / step) * step + step * round(20 / step)  # a whole step above all heights
    if case["give"]:
        options += ["--void-height", "%.9f" % given]
    summary, said = bake(path, "--max-error", case["max_error"], *options)
    assert summary, said
    heights, _ = export()
    exact = case["kind"] in WHOLE and "coarser steps" not in said and "not exact" not in said
    bound = case["max_error"] + (1 / 500 + 2**16 / 2**25 if exact else summary["hscale_m"] / 2 + 1 / 256) + abs(truth).max() * FLOAT
    worst = abs(heights - truth)[~void].max()
    assert worst <= bound, ("worst", worst, "bound", bound, said)
    assert (summary["voids"], summary["given"]) == ((0, count) if case["give"] else (count, 0)), (summary["voids"], summary["given"], count, said)
    if case["give"] and count:
        assert abs(heights - given)[void].max() <= bound + summary["hscale_m"] / 2, ("given", abs(heights - given)[void].max(), bound)
    elif count:
        assert heights[void].min() >= truth[~void].min() - bound and heights[void].max() <= truth[~void].max() + bound
    return worst - case["max_error"] if exact else 0


first, cases = int(os.environ.get("FIRST", 1)), int(os.environ.get("CASES", 40))
worst = 0
for number in range(first, first + cases):
    try:
        worst = max(worst, look(number))
    except AssertionError as fault:
        case = draw(number)
        print("not ok - raster %d (FIRST=%d CASES=1): %s" % (number, number, {k: case[k] for k in ("kind", "unit", "scale", "offset", "form", "max_error", "give")}))
        print("#  ", str(fault)[:400].replace("\n", "\n#   "))
        rasters.failures += 1
print("# heights in the source's own steps are at most %.5f m off beyond the error asked" % worst)
if not rasters.failures:
    print("ok - %d rasters by chance: heights within the error asked, voids where they were" % cases)
rasters.finish()
