"""What packs say of themselves, run by bake_about.sh: names, attributions and projections from options and sources, told by farfield-info,
exported and baked again. Latitudes and longitudes are worked out from a pack's numbers alone, and compared with GDAL's."""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

HILLS = np.fromfunction(lambda y, x: 500 + 3 * x + 2 * y, (40, 50))
ALL = {"name": 'Hügel "7"', "attribution": "© 2026 Landesamt\\Ämter", "licence": "CC BY 4.0", "date": "2026-11", "vertical_datum": "EGM96 height"}
OPTIONS = [word for name, text in ALL.items() for word in ("--" + name.replace("_", "-"), text)]


def about():
    done = run("info", "--json", "out.ffp")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def texts():
    return {name: value for name, value in about()["about"].items() if not name.startswith("projection")}


def tagged(name, tags, **more):
    path = put(name, HILLS, **more)
    raster = gdal.Open(path, gdal.GA_Update)
    raster.SetMetadata(tags)
    del raster
    return path


@case("what options say comes back from info, from an export, and from a bake of it")
def _():
    summary, said = bake(put("plain.tif", HILLS), *OPTIONS)
    assert summary and texts() == ALL, (said, texts())
    shown = run("info", "out.ffp").stdout
    assert all(text in shown for text in ALL.values()), shown
    assert run("info", "--verify", "out.ffp").returncode == 0
    export()
    tags = gdal.Open(os.path.join(work, "out.tif")).GetMetadata()
    assert tags["TIFFTAG_COPYRIGHT"] == ALL["attribution"] and tags["TIFFTAG_IMAGEDESCRIPTION"] == ALL["name"], tags
    assert run("export", "out.ffp", "-o", "out.png").returncode == 0
    tags = gdal.Open(os.path.join(work, "out.png")).GetMetadata()
    assert tags["Copyright"] == ALL["attribution"] and tags["Title"] == ALL["name"], tags
    os.rename(os.path.join(work, "out.tif"), os.path.join(work, "again.tif"))
    assert bake("again.tif")[0] and texts() == ALL, texts()


@case("a source that says nothing is not made to say anything")
def _():
    bake(put("plain.tif", HILLS))
    assert texts() == {} and about()["about"]["projection"]["method"] == 9807
    HILLS.astype("<u2").tofile(os.path.join(work, "plain.raw"))
    assert bake("plain.raw", "--raw", "50x40", "--spacing", "10")[0] and about()["about"] == {}, about()["about"]


@case("TIFF's tags are taken, in the character sets that they come in, and options go before them")
def _():
    tags = {"TIFFTAG_COPYRIGHT": "Survey of H\u00fcgelland", "TIFFTAG_DATETIME": "2008:05:20 11:22:33", "TIFFTAG_IMAGEDESCRIPTION": "two\nlines \x1b[2J"}
    path = tagged("tags.tif", tags)
    assert bake(path)[0] and texts() == {"name": "two lines [2J", "attribution": "Survey of Hügelland", "date": "2008-05-20"}, texts()
    data = open(path, "rb").read()
    assert data.count("H\u00fcgelland".encode()) == 1
    open(path, "wb").write(data.replace("H\u00fcgelland".encode(), b"H\xfcgelland\0"))  # as old programs write it
    assert bake(path, "--name", "Land")[0] and texts()["name"] == "Land" and texts()["attribution"].startswith("Survey of Hügelland"), texts()


@case("netCDF's global attributes are taken")
def _():
    memory = gdal.GetDriverByName("MEM").Create("", 50, 40, 1, gdal.GDT_Float32)
    memory.GetRasterBand(1).WriteArray(HILLS)
    memory.SetGeoTransform(UTM_PLACE)
    system = osr.SpatialReference()
    system.ImportFromEPSG(32632)
    memory.SetSpatialRef(system)
    memory.SetMetadata({"NC_GLOBAL#title": "Land", "NC_GLOBAL#institution": "Survey", "NC_GLOBAL#license": "free"})
    path = os.path.join(work, "land.nc")
    gdal.GetDriverByName("netCDF").CreateCopy(path, memory)
    assert bake(path)[0] and texts() == {"name": "Land", "attribution": "Survey", "licence": "free"}, texts()


@case("a compound system tells what heights are above")
def _():
    assert bake(put("compound.tif", HILLS, reference="EPSG:32632+5773"))[0] and texts() == {"vertical_datum": "EGM96 height"}, texts()
    assert about()["epsg"] == 32632


@case("long texts of a source are cut between characters, and it is told")
def _():
    summary, said = bake(tagged("long.tif", {"TIFFTAG_COPYRIGHT": "x" + "ü" * 300}))
    assert summary and "attribution is longer than 400 bytes" in said and texts()["attribution"] == "x" + "ü" * 199, (said, texts())


@case("texts of options that are too long, or no text, are wrong usage")
def _():
    path = put("plain.tif", HILLS)
    for option, text in ("--name", "a\nb"), ("--name", "n" * 101), ("--attribution", "a" * 401), ("--licence", b"\xfc"), ("--date", "d" * 41), ("--vertical-datum", "\u202e"):
        done = subprocess.run([os.path.join(programs, "farfield-bake"), path, option, text, "-o", os.path.join(work, "not.ffp")], capture_output=True)
        assert done.returncode == 2 and done.stderr.count(b"\n") == 1 and option.encode() in done.stderr, done
    assert bake(path, "--name", "n" * 100, "--attribution", "a" * 400)[0]


@case("a system without a code comes back from an export")
def _():
    system = osr.SpatialReference()
    system.ImportFromProj4("+proj=lcc +lat_1=41 +lat_2=45.5 +lat_0=43 +lon_0=7.25 +x_0=1234.5 +y_0=-77 +ellps=intl +units=m +no_defs")
    summary, said = bake(put("own.tif", HILLS, place=(1234, 30, 0, 77000, 0, -30), reference=system.ExportToWkt()))
    assert summary and about()["epsg"] == 0, (summary, said)
    export()
    again = gdal.Open(os.path.join(work, "out.tif")).GetSpatialRef()
    assert again.IsSame(system), again.ExportToWkt()
    numbers = about()["about"]["projection"]
    assert numbers["method"] == 9802 and numbers["parameters"]["8826"] == 1234500000 and numbers["inverse_flattening_e9"] == 297000000000, numbers


# ---- from numbers to degrees, as EPSG's guidance note 7-2 has it ----
def eccentricity(numbers):
    flattening = 1e9 / numbers["inverse_flattening_e9"] if numbers["inverse_flattening_e9"] else 0
    return numbers["semi_major_um"] / 1e6, math.sqrt(2 * flattening - flattening**2), flattening


def transverse_mercator(numbers, x, y):
    a, e, f = eccentricity(numbers)
    p = numbers["parameters"]
    origin = math.radians(p["8801"] / 1e9)
    n = f / (2 - f)
    b = a / (1 + n) * (1 + n**2 / 4 + n**4 / 64)
    forward = [n / 2 - 2 / 3 * n**2 + 5 / 16 * n**3, 13 / 48 * n**2 - 3 / 5 * n**3, 61 / 240 * n**3]
    back = [n / 2 - 2 / 3 * n**2 + 37 / 96 * n**3, n**2 / 48 + n**3 / 15, 17 / 480 * n**3]
    conformal = math.asinh(math.tan(origin)) - e * math.atanh(e * math.sin(origin))
    beta = math.atan(math.sinh(conformal))
    m0 = b * (beta + sum(h * math.sin(2 * (i + 1) * beta) for i, h in enumerate(forward)))
    k = p["8805"] / 1e12
    eta, xi = (x - p["8806"] / 1e6) / (b * k), (y - p["8807"] / 1e6 + k * m0) / (b * k)
    xi0 = xi - sum(h * math.sin(2 * (i + 1) * xi) * math.cosh(2 * (i + 1) * eta) for i, h in enumerate(back))
    eta0 = eta - sum(h * math.cos(2 * (i + 1) * xi) * math.sinh(2 * (i + 1) * eta) for i, h in enumerate(back))
    beta = math.asin(math.sin(xi0) / math.cosh(eta0))
    q = first = math.asinh(math.tan(beta))
    for _ in range(8):
        q = first + e * math.atanh(e * math.tanh(q))
    return math.degrees(math.asin(math.tanh(eta0) / math.cos(beta))) + p["8802"] / 1e9, math.degrees(math.atan(math.sinh(q)))


def lambert_two_parallels(numbers, x, y):
    a, e, _ = eccentricity(numbers)
    p = {code: value / (1e6 if code in ("8826", "8827") else 1e9) for code, value in numbers["parameters"].items()}
    m = lambda latitude: math.cos(latitude) / math.sqrt(1 - (e * math.sin(latitude)) ** 2)
    t = lambda latitude: math.tan(math.pi / 4 - latitude / 2) / ((1 - e * math.sin(latitude)) / (1 + e * math.sin(latitude))) ** (e / 2)
    first, second, origin = (math.radians(p[code]) for code in ("8823", "8824", "8821"))
    n = (math.log(m(first)) - math.log(m(second))) / (math.log(t(first)) - math.log(t(second)))
    f = m(first) / (n * t(first) ** n)
    r_origin, east, north = a * f * t(origin) ** n, x - p["8826"], y - p["8827"]
    r = math.copysign(math.hypot(east, r_origin - north), n)
    small = (r / (a * f)) ** (1 / n)
    latitude = math.pi / 2 - 2 * math.atan(small)
    for _ in range(8):
        latitude = math.pi / 2 - 2 * math.atan(small * ((1 - e * math.sin(latitude)) / (1 + e * math.sin(latitude))) ** (e / 2))
    return math.degrees(math.atan2(east, r_origin - north) / n) + p["8822"], math.degrees(latitude)


@case("a pack's numbers alone give latitude and longitude, to a millimetre")
def _():
    for code, place, inverse in (32632, (500000, 5000000), transverse_mercator), (32733, (700000, 8000000), transverse_mercator), (27700, (400000, 300000), transverse_mercator), \
            (2154, (652000, 6862000), lambert_two_parallels), (31370, (150000, 170000), lambert_two_parallels):
        assert bake(put("%d.tif" % code, HILLS, place=(place[0], 30, 0, place[1], 0, -30), reference="EPSG:%d" % code))[0]
        pack = about()
        system = osr.SpatialReference()
        system.ImportFromEPSG(code)
        degrees = system.CloneGeogCS()
        for one in (system, degrees):
            one.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
        x, y = pack["origin_x_mm"] / 1000, pack["origin_y_mm"] / 1000
        wanted = osr.CoordinateTransformation(system, degrees).TransformPoint(x, y)
        found = inverse(pack["about"]["projection"], x, y)
        off = max(abs(found[0] - wanted[0]), abs(found[1] - wanted[1])) * 111e3
        assert off < 1e-3, (code, found, wanted)


@case("golden packs: this version is read, older ones are refused with the command that bakes them, needed parts by name")
def _():
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "corpus", "pack")
    of = lambda name: run("info", "--verify", os.path.join(folder, name))
    for name in "good", "leaves", "stubs", "textured", "about", "trained", "unknown-optional":
        assert of(name).returncode == 0, of(name).stderr
    for name, words in {"version-3": "farfield-bake", "version-4": "farfield-bake", "version-5": "farfield-bake", "version-6": "farfield-bake", "version-7": "farfield-bake", "version-8": "farfield-bake", "version-10": "newer", "unknown-needed": "MARK version 7 codec 9",
                        "about-control": "says of itself", "about-order": "says of itself", "about-cut": "says of itself"}.items():
        done = of(name)
        assert done.returncode == 1 and done.stderr.count("\n") == 1 and words in done.stderr, (name, done.stderr)


finish()
