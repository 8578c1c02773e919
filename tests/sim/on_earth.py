"""Places on Earth in programs, run by on_earth.sh: --at and --to of farfield-fly, -view and -handheld, the columns of a flight's CSV, corners
told by farfield-info, parts of packs, and packs whose places cannot be told. Judged by GDAL."""
import csv
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

HILLS = np.fromfunction(lambda y, x: 700 + 300 * np.sin(x / 23) * np.cos(y / 31), (257, 257))
SPACING = 40
GROUNDS = {32632: (500000, 5000000), 32719: (300000, 6400000), 2154: (700000, 6600000), 3031: (1200000, 1300000), 3395: (1000000, 100000)}


def degrees_of(epsg):
    """From x, y of a system to latitude, longitude on its datum."""
    system = osr.SpatialReference()
    system.ImportFromEPSG(epsg)
    degrees = system.CloneGeogCS()
    for one in (system, degrees):
        one.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    to = osr.CoordinateTransformation(system, degrees)

    def found(x, y):
        longitude, latitude, _ = to.TransformPoint(x, y)
        return latitude, longitude
    return found


def info(pack):
    done = run("info", "--json", pack)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def ground(epsg, name):
    x, y = GROUNDS[epsg]
    return bake_as(put("%s.tif" % name, HILLS, place=(x, SPACING, 0, y, 0, -SPACING), reference="EPSG:%d" % epsg), name, "--no-project")


def bake_as(raster, name, *options):
    done = run("bake", raster, *options, "-o", name + ".ffp")
    assert done.returncode == 0, done.stderr
    return name + ".ffp", done.stderr


def fly(pack, *options):
    """Rows of the CSV, and the summary."""
    done = run("fly", "--pack", pack, "--backend", "none", "--link", "umts", "--settle", 0, "--csv", "out.csv", "--json", *options)
    assert done.returncode == 0, done.stderr
    rows = [{key: float(value) for key, value in row.items() if key.endswith(("_deg", "_m", "t_s"))} for row in csv.DictReader(open(os.path.join(work, "out.csv")))]
    return rows, json.loads(done.stdout)


def refused(program, *options):
    """The line with which a program ends, after what it was told."""
    done = run(program, *options)
    lines = [line for line in done.stderr.splitlines() if ": seed " not in line]
    assert done.returncode == 1 and len(lines) == 1, (done.returncode, done.stderr)
    return lines[0]


def apart_m(a, b):
    return math.hypot(a[0] - b[0], (a[1] - b[1]) * math.cos(math.radians(a[0]))) * 111320


@case("a flight's rows tell latitude, longitude and heading, as GDAL does")
def _():
    for epsg in GROUNDS:
        pack, _ = ground(epsg, "ground%d" % epsg)
        told, degrees = info(pack), degrees_of(epsg)
        assert told["epsg"] == epsg, told["epsg"]
        x0, y0 = told["origin_x_mm"] / 1000, told["origin_y_mm"] / 1000
        rows, summary = fly(pack, "--seconds", 3, "--path", "circle")
        for row in rows:
            x, y = x0 + row["x_m"], y0 + row["y_m"]
            assert apart_m(degrees(x, y), (row["lat_deg"], row["lon_deg"])) < 0.02, (epsg, row, degrees(x, y))
            ahead = degrees(x, y + 50)
            north = math.degrees(math.atan2((ahead[1] - row["lon_deg"]) * math.cos(math.radians(ahead[0])), ahead[0] - row["lat_deg"]))
            # the yaw of a circle is what its places say: along the next row
            row["grid_north"] = north
        for one, next_one in zip(rows, rows[1:]):
            way = math.degrees(math.atan2(next_one["x_m"] - one["x_m"], next_one["y_m"] - one["y_m"]))
            off = (one["heading_true_deg"] - way - one["grid_north"] + 180) % 360 - 180
            assert abs(off) < 1.5, (epsg, off, one, way)  # a second on the circle is 1.6 degrees
        assert summary["first_place"] == {key: rows[0][key] for key in ("lat_deg", "lon_deg", "heading_true_deg")}, summary["first_place"]
        assert summary["last_place"]["lat_deg"] == rows[-1]["lat_deg"]


@case("--at is where a flight begins, --to where it ends, as high above ground as said")
def _():
    for epsg in GROUNDS:
        pack, degrees = "ground%d.ffp" % epsg, degrees_of(epsg)
        told = info(pack)
        x0, y0 = told["origin_x_mm"] / 1000, told["origin_y_mm"] / 1000
        at, to = degrees(x0 + 3000, y0 + 4000), degrees(x0 + 7000, y0 + 5500)
        rows, summary = fly(pack, "--at", "%.9f,%.9f,250" % at, "--to", "%.9f,%.9f,90" % to, "--speed", 1200)
        assert apart_m((rows[0]["lat_deg"], rows[0]["lon_deg"]), at) < 0.02 and math.hypot(rows[0]["x_m"] - 3000, rows[0]["y_m"] - 4000) < 0.01, (epsg, rows[0])
        assert abs(summary["seconds"] - math.hypot(4000, 1500) / (1200 / 3.6)) < 0.1, summary["seconds"]
        rows, summary = fly(pack, "--at", "%.9f,%.9f,250" % at, "--to", "%.9f,%.9f,90" % to, "--speed", 1200, "--seconds", 20)
        assert apart_m((rows[-1]["lat_deg"], rows[-1]["lon_deg"]), to) < 0.02 and rows[-1]["x_m"] == rows[-2]["x_m"], rows[-1]
        higher = [fly(pack, "--at", "%.9f,%.9f,%d" % (*at, height), "--seconds", 1)[0][0]["z_m"] for height in (100, 350)]
        assert abs(higher[1] - higher[0] - 250) < 0.01, higher
        assert fly(pack, "--at", "%.9f,%.9f" % at, "--height", 100, "--seconds", 1)[0][0]["z_m"] == higher[0]


@case("a recorded flight in degrees is the same flight, also over another pack of the place")
def _():
    rows, _ = fly("ground32632.ffp", "--path", "circle", "--seconds", 4, "--speed", 600)
    record = lambda names: open(os.path.join(work, "track.csv"), "w").write(",".join(names) + "\n" + "".join(",".join("%.9f" % row[name] for name in names) + "\n" for row in rows))
    record(["t_s", "lat_deg", "lon_deg", "z_m", "heading_true_deg"])
    again, _ = fly("ground32632.ffp", "--path", "track.csv", "--seconds", 4)
    for one, other in zip(rows, again):
        assert math.hypot(one["x_m"] - other["x_m"], one["y_m"] - other["y_m"]) < 0.03 and abs(one["heading_true_deg"] - other["heading_true_deg"]) < 0.02, (one, other)
    record(["t_s", "lat_deg", "lon_deg", "z_m"])
    again, _ = fly("ground32632.ffp", "--path", "track.csv", "--seconds", 4)
    assert abs(again[1]["heading_true_deg"] - rows[1]["heading_true_deg"]) < 5, (rows[1], again[1])  # towards the next row, not along the circle
    assert "projection of the ground does not show" in refused("fly", "--pack", "ground32719.ffp", "--backend", "none", "--path", "track.csv")


@case("a part of a pack has its places on Earth where the whole has them")
def _():
    degrees = degrees_of(32632)
    told = info("ground32632.ffp")
    x0, y0 = told["origin_x_mm"] / 1000, told["origin_y_mm"] / 1000
    (south, west), (north, east) = degrees(x0 + 2000, y0 + 2500), degrees(x0 + 8000, y0 + 9000)
    assert run("export", "ground32632.ffp", "--region", "%f,%f,%f,%f" % (west, south, east, north), "-o", "part.ffp").returncode == 0
    at = "%.9f,%.9f,300" % degrees(x0 + 5000, y0 + 5000)
    whole, part = fly("ground32632.ffp", "--at", at, "--seconds", 1)[0][0], fly("part.ffp", "--at", at, "--seconds", 1)[0][0]
    assert all(whole[key] == part[key] for key in ("lat_deg", "lon_deg", "z_m")), (whole, part)


@case("corners told by farfield-info are GDAL's to a millimetre")
def _():
    for epsg in GROUNDS:
        told, degrees = info("ground%d.ffp" % epsg), degrees_of(epsg)
        x0, y0, edge = told["origin_x_mm"] / 1000, told["origin_y_mm"] / 1000, 256 * SPACING
        for name, x, y in ("south-west", 0, 0), ("south-east", edge, 0), ("north-west", 0, edge), ("north-east", edge, edge):
            assert apart_m(told["corners"][name], degrees(x0 + x, y0 + y)) < 1e-3, (epsg, name, told["corners"])
        assert "corners         south-west %.6f,%.6f" % tuple(told["corners"]["south-west"]) in run("info", "ground%d.ffp" % epsg).stdout


@case("the emulator and the handheld begin and end there, too, over a pack and over a link")
def _():
    degrees = degrees_of(32632)
    told = info("ground32632.ffp")
    x0, y0 = told["origin_x_mm"] / 1000, told["origin_y_mm"] / 1000
    at, to = "%.9f,%.9f,250" % degrees(x0 + 3000, y0 + 4000), "%.9f,%.9f,400" % degrees(x0 + 3200, y0 + 3900)
    open(os.path.join(work, "still.txt"), "w").write("0 settle\n1 quit\n")
    open(os.path.join(work, "fly.txt"), "w").write("0 settle\n300 settle\n301 quit\n")
    view = lambda *options: json.loads(run("view", "ground32632.ffp", "--headless", "--backend", "soft", "--json", *options).stdout)
    for link in (), ("--link", "umts"):
        still = view("--at", at, "--script", "still.txt", *link)
        assert abs(still["x_m"] - 3000) < 0.06 and abs(still["y_m"] - 4000) < 0.06, still
    there = view("--at", at, "--to", to, "--script", "fly.txt")
    assert abs(there["x_m"] - 3200) < 0.06 and abs(there["y_m"] - 3900) < 0.06, there
    assert abs(view("--place", "3200,3900,400", "--script", "still.txt")["z_m"] - there["z_m"]) < 1
    hand = lambda *options: run("handheld", "--pack", "ground32632.ffp", "--frames", 5, "--hud", *options)
    assert hand("--at", at, "--to", to).returncode == 0 and hand("--at", at).stdout != hand().stdout


@case("what is no place there ends in one line")
def _():
    assert "outside the terrain" in refused("fly", "--pack", "ground32632.ffp", "--backend", "none", "--at", "10,10")
    assert "outside the terrain" in refused("view", "ground32632.ffp", "--headless", "--backend", "soft", "--at", "10,10")
    assert "outside the terrain" in refused("handheld", "--pack", "ground32632.ffp", "--at", "10,10")
    HILLS.astype("<u2").tofile(os.path.join(work, "plain.raw"))
    bake_as("plain.raw", "nowhere", "--raw", "257x257", "--spacing", "10")
    _, said = bake_as(put("areas.tif", HILLS, place=(4321000, SPACING, 0, 3210000, 0, -SPACING), reference="EPSG:3035"), "areas", "--no-project")
    assert "EPSG's method 9820" in said, said
    for pack, words in ("nowhere", "does not say where"), ("areas", "in the pack's projection"):
        assert words in refused("fly", "--pack", pack + ".ffp", "--backend", "none", "--at", "10,10")
        assert words in refused("view", pack + ".ffp", "--headless", "--backend", "soft", "--at", "10,10")
        assert words in refused("handheld", "--pack", pack + ".ffp", "--at", "10,10")
        rows, summary = fly(pack + ".ffp", "--seconds", 1)
        assert math.isnan(rows[0]["lat_deg"]) and summary["first_place"] is None, (rows[0], summary)
        assert info(pack + ".ffp")["corners"] is None
    assert "not told" in run("info", "areas.ffp").stdout


@case("--to without --at, and either with a path or a tape that goes elsewhere, is wrong usage")
def _():
    for program, *options in ("fly", "--pack", "ground32632.ffp", "--to", "1,1"), ("handheld", "--pack", "ground32632.ffp", "--to", "1,1"), \
            ("fly", "--pack", "ground32632.ffp", "--at", "1,1", "--to", "1,1", "--path", "circle"), ("fly", "--pack", "ground32632.ffp", "--at", "1,1", "--path", "out.csv"), \
            ("handheld", "--tape", "out.csv", "--at", "1,1"), ("fly", "--pack", "ground32632.ffp", "--at", "91,0"), ("fly", "--pack", "ground32632.ffp", "--at", "1,1,1,1"):
        done = run(program, *options)
        assert done.returncode == 2 and done.stderr.count("\n") == 1, (program, options, done.stderr)


finish()
