"""Rasters made with GDAL, baked, and exported again, for tests in Python (python3-gdal). Programs come from BIN, files go to `work`."""
import json
import os
import shutil
import subprocess
import tempfile

import numpy as np
from osgeo import gdal, osr

gdal.UseExceptions()
gdal.SetConfigOption("GDAL_TIFF_INTERNAL_MASK", "YES")
gdal.PushErrorHandler("CPLQuietErrorHandler")
programs = os.path.abspath(os.environ.get("BIN", "build/bin"))
os.makedirs("build/tests", exist_ok=True)
work = tempfile.mkdtemp(dir=os.path.abspath("build/tests"))
UTM_PLACE = (500000, 30, 0, 5000000, 0, -30)
failures = 0


def put(name, bands, kind=gdal.GDT_Float32, place=UTM_PLACE, reference="EPSG:32632", nodata=None, unit=None, mask=None, scale=None, offset=None,
        driver="GTiff", options=(), alpha=False):
    """Writes bands (rows x columns, or bands x rows x columns) and tells the path."""
    path = os.path.join(work, name)
    bands = np.asarray(bands)
    bands = bands if bands.ndim == 3 else bands[None]
    memory = driver != "GTiff"
    made = gdal.GetDriverByName("MEM" if memory else "GTiff").Create("" if memory else path, bands.shape[2], bands.shape[1], len(bands), kind, [] if memory else list(options))
    if place:
        made.SetGeoTransform(place)
    if reference:
        system = osr.SpatialReference()
        system.SetFromUserInput(reference)
        made.SetSpatialRef(system)
    for number, values in enumerate(bands, 1):
        band = made.GetRasterBand(number)
        if nodata is not None:
            band.SetNoDataValue(nodata)
        if unit:
            band.SetUnitType(unit)
        if scale is not None:
            band.SetScale(scale)
        if offset is not None:
            band.SetOffset(offset)
        if alpha and number == len(bands):
            band.SetColorInterpretation(gdal.GCI_AlphaBand)
        band.WriteArray(values)
    if mask is not None:
        made.CreateMaskBand(gdal.GMF_PER_DATASET)
        made.GetRasterBand(1).GetMaskBand().WriteArray(mask)
    made.FlushCache()
    if memory:
        gdal.GetDriverByName(driver).CreateCopy(path, made, options=list(options))
    del made
    return path


def run(program, *arguments):
    return subprocess.run([os.path.join(programs, "farfield-" + program), *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=work)


def bake(path, *options):
    """(the summary or None, what was said)"""
    done = run("bake", path, "-o", "out.ffp", "--json", *options)
    return (json.loads(done.stdout) if done.returncode == 0 else None), done.stderr


def export():
    """(heights in metres, row 0 north; geotransform) of the last pack."""
    done = run("export", "out.ffp", "-o", "out.tif", "--quiet")
    assert done.returncode == 0, done.stderr
    raster = gdal.Open(os.path.join(work, "out.tif"))
    band = raster.GetRasterBand(1)
    return band.ReadAsArray().astype(float) * (band.GetScale() or 1) + (band.GetOffset() or 0), raster.GetGeoTransform()


def refused(path, *options):
    """The one line with which a raster is refused."""
    summary, said = bake(path, *options)
    assert summary is None and said.count("\n") == 1, (summary, said)
    return said


def case(name):
    """Runs a function as a test: an assertion that fails is `not ok`."""
    def decorate(function):
        global failures
        try:
            function()
            print("ok -", name, flush=True)
        except Exception as fault:
            failures += 1
            print("not ok -", name, flush=True)
            print("#  ", type(fault).__name__, str(fault)[:600].replace("\n", "\n#   "), flush=True)
        return function
    return decorate


def finish():
    shutil.rmtree(work, ignore_errors=True)
    raise SystemExit(failures > 0)
