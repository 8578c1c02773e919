"""What farfield-export writes, run by export.sh. Ground is a surface that is known everywhere; rasters and map tiles are compared with it."""
import json
import math
import os
import re
import signal
import sqlite3
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

SPACING = 30
PLACE = (500000 - SPACING / 2, SPACING, 0, 5100000 + SPACING / 2, 0, -SPACING)


def surface(x, y):
    """Of metres of UTM zone 32, in metres."""
    return 900 + 300 * np.sin(x / 1900) * np.cos(y / 2300) + (x - 500000) / 50


def ground(name="land.ffp", width=300, height=260, place=PLACE, reference="EPSG:32632", holes=(), options=(), wave=surface):
    """Bakes the surface; holes: (column, row, width, height)."""
    rows, columns = np.mgrid[0:height, 0:width] + 0.5
    heights = wave(place[0] + columns * place[1], place[3] + rows * place[5]).astype(np.float32)
    for column, row, wide, high in holes:
        heights[row:row + high, column:column + wide] = -9999
    path = put(name + ".tif", heights, place=place, reference=reference, nodata=-9999)
    done = run("bake", path, "-o", name, "--tile-log2", 7, *options)
    assert done.returncode == 0, done.stderr
    return heights


def write(pack, out, *options):
    done = run("export", pack, "-o", out, *options)
    assert done.returncode == 0, done.stderr
    return done.stderr


def refused_export(pack, out, *options, code=1):
    done = run("export", pack, "-o", out, *options)
    assert done.returncode == code and done.stderr.count("\n") == 1, (done.returncode, done.stderr)
    assert not os.path.exists(os.path.join(work, out.rstrip("/"))) or os.path.isdir(os.path.join(work, out)), out
    return done.stderr


def metres(name):
    raster = gdal.Open(os.path.join(work, name))
    band = raster.GetRasterBand(1)
    return band.ReadAsArray().astype(float) * (band.GetScale() or 1) + (band.GetOffset() or 0), raster.GetGeoTransform()


def is_nodata(name):
    raster = gdal.Open(os.path.join(work, name))
    band = raster.GetRasterBand(1)
    return band.ReadAsArray() == band.GetNoDataValue()


def picture(data):
    """Bands x rows x columns of an image file's bytes."""
    gdal.FileFromMemBuffer("/vsimem/read", bytes(data))
    bands = gdal.Open("/vsimem/read").ReadAsArray().astype(int)
    gdal.Unlink("/vsimem/read")
    return bands


def decode(bands, encoding):
    number = bands[0] * 65536 + bands[1] * 256 + bands[2]
    return number / 256 - 32768 if encoding == "terrarium" else number / 10 - 10000


def folder_tiles(name):
    root, found = os.path.join(work, name), {}
    for where, _, files in os.walk(root):
        for file in files:
            if file != "tiles.json":
                zoom, x = os.path.relpath(where, root).split("/")
                found[int(zoom), int(x), int(file.split(".")[0])] = open(os.path.join(where, file), "rb").read()
    return found, json.load(open(os.path.join(root, "tiles.json")))


def table_tiles(name):
    table = sqlite3.connect(os.path.join(work, name))
    return ({(z, x, 2**z - 1 - y): data for z, x, y, data in table.execute("select zoom_level, tile_column, tile_row, tile_data from tiles")},
            dict(table.execute("select name, value from metadata")))


def transformation(*codes):
    systems = []
    for code in codes:
        systems.append(osr.SpatialReference())
        systems[-1].SetFromUserInput(code)
        systems[-1].SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return osr.CoordinateTransformation(*systems)


def utm(zoom, x, y, reference="EPSG:32632", side=256):
    """Where the pixels of a tile lie in the ground's plane: two arrays."""
    edge = 20037508.342789244
    pixel = 2 * edge / 2**zoom / side
    columns, rows = np.meshgrid(np.arange(side) + 0.5, np.arange(side) + 0.5)
    points = np.stack([(x * side + columns.ravel()) * pixel - edge, edge - (y * side + rows.ravel()) * pixel], 1)
    found = np.array(transformation("EPSG:3857", reference).TransformPoints(points))
    return found[:, 0].reshape(side, side), found[:, 1].reshape(side, side)


def inside(px, py, width=300, height=260, place=PLACE, rim=2):
    return ((px > place[0] + rim * place[1]) & (px < place[0] + (width - rim) * place[1]) & (py < place[3] + rim * place[5]) & (py > place[3] + (height - rim) * place[5]))


@case("a level is every 2^n-th sample, a region is a part of it: both lie where the whole does; GeoTIFFs are cloud-optimised")
def _():
    heights = ground()
    said = write("land.ffp", "all.tif")
    whole, place = metres("all.tif")
    assert "those the pack was made from" in said and whole.shape == (260, 300), (said, whole.shape)
    assert abs(whole - heights).max() < 0.01 and np.allclose(place, PLACE), (abs(whole - heights).max(), place)
    info = gdal.Open(os.path.join(work, "all.tif"))
    assert info.GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE") == "COG" and info.GetMetadataItem("name") == "land" and float(info.GetMetadataItem("error_m")) == 0
    said = write("land.ffp", "coarse.tif", "--level", 2)
    coarse, place = metres("coarse.tif")
    assert np.array_equal(coarse[::-1], whole[::-1][::4, ::4]) and abs(place[0] - (500000 - 60)) < 1e-6 and place[1] == 120, (place, coarse.shape)
    bound = float(said.split("between them within ")[1].split()[0])
    fine = np.add.outer(np.linspace(0, 1, 5), np.zeros(5)), np.add.outer(np.zeros(5), np.linspace(0, 1, 5))
    south = coarse[::-1]
    worst = 0
    for j in range(coarse.shape[0] - 1):  # the two triangles of each cell, cut from south-west to north-east
        for i in range(coarse.shape[1] - 1):
            a, b, c, d = south[j, i], south[j, i + 1], south[j + 1, i], south[j + 1, i + 1]
            v, u = fine
            plane = np.where(u >= v, a + u * (b - a) + v * (d - b), a + v * (c - a) + u * (d - c))
            worst = max(worst, abs(plane - whole[::-1][4 * j:4 * j + 5, 4 * i:4 * i + 5]).max())
    assert worst <= bound <= worst * 1.2 + 0.02, (worst, bound)
    write("land.ffp", "part.tif", "--region", "9.02,46.01,9.05,46.03")
    part, place = metres("part.tif")
    column, row = round((place[0] - PLACE[0]) / SPACING), round((place[3] - PLACE[3]) / -SPACING)
    assert 0 < column < 100 and 0 < row and part.shape < (200, 120) and np.array_equal(part, whole[row:row + part.shape[0], column:column + part.shape[1]]), (column, row, part.shape)
    write("land.ffp", "all.png")
    write("land.ffp", "all.r16")
    raw = np.fromfile(os.path.join(work, "all.r16"), "<u2").reshape(260, 300)
    assert np.array_equal(raw, gdal.Open(os.path.join(work, "all.png")).ReadAsArray()) and not os.path.exists(os.path.join(work, "all.png.aux.xml"))


@case("the last row and column are the source's, wherever in a node of whichever level they lie")
def _():
    heights = np.random.default_rng(1).integers(0, 65536, (65, 65)).astype("<u2")
    for side in range(33, 66, 4):
        for node_log2 in 1, 2, 3:
            part = heights[:side, :98 - side]
            part.tofile(os.path.join(work, "rim.raw"))
            done = run("bake", "rim.raw", "--raw", "%dx%d" % part.shape[::-1], "--spacing", 30, "--tile-log2", 5, "--node-log2", node_log2, "-o", "rim.ffp")
            assert done.returncode == 0, done.stderr
            write("rim.ffp", "rim.r16")
            back = np.fromfile(os.path.join(work, "rim.r16"), "<u2").reshape(part.shape)
            assert np.array_equal(back, part), (part.shape, node_log2, np.argwhere(back != part)[:3].tolist())


@case("folder, MBTiles and PMTiles hold the same tiles, say what they are, and nothing of what is not ground")
def _():
    write("land.ffp", "tiles/", "--zoom", "9-12")
    write("land.ffp", "tiles.mbtiles", "--zoom", "9-12")
    write("land.ffp", "tiles.pmtiles", "--zoom", "9-12")
    tiles, told = folder_tiles("tiles")
    rows, facts = table_tiles("tiles.mbtiles")
    assert tiles == rows and len(tiles) >= 6, (len(tiles), len(rows))
    assert told["tiles"] == ["{z}/{x}/{y}.png"] and told["minzoom"] == 9 and told["maxzoom"] == 12 and told["encoding"] == "terrarium" and told["tileSize"] == 256, told
    for name in ("format", "encoding", "minzoom", "maxzoom", "name", "description", "error_m"):
        assert str(told[name]) == facts[name], (name, told[name], facts[name])
    west, south, east, north = told["bounds"]
    assert facts["bounds"] == "%.7f,%.7f,%.7f,%.7f" % (west, south, east, north) and 8.99 < west < 9.0 < 9.11 < east < 9.13 and 45.97 < south < 46.05 < north < 46.06, told
    for zoom, x, y in tiles:  # each meets the ground
        px, py = utm(zoom, x, y)
        assert inside(px, py, rim=-0.5).any() or zoom < 12, (zoom, x, y)
    done = run("bake", "tiles.pmtiles", "-o", "back.ffp", "--t-srs", "EPSG:32632", "--json")
    again = run("bake", "tiles", "-o", "folder.ffp", "--rgb", "terrarium", "--t-srs", "EPSG:32632", "--json")
    assert done.returncode == 0 and again.returncode == 0, done.stderr + again.stderr
    write("back.ffp", "back.r16")
    write("folder.ffp", "folder.r16")
    assert open(os.path.join(work, "back.r16"), "rb").read() == open(os.path.join(work, "folder.r16"), "rb").read()


@case("tiles are the surface: no shift, no other scale, the error that is told is the error; both encodings")
def _():
    for encoding, step in (("terrarium", 1 / 256), ("mapbox", 0.1)):
        write("land.ffp", encoding + "/", "--encoding", encoding, "--zoom", 13)
        tiles, told = folder_tiles(encoding)
        sums, wanted, found = np.zeros((4, 4)), np.zeros(4), []
        for zoom, x, y in tiles:
            px, py = utm(zoom, x, y)
            here = inside(px, py)
            if not here.any():
                continue
            off = (decode(picture(tiles[zoom, x, y]), encoding) - surface(px, py))[here]
            found.append(off)
            slope_x = (surface(px + 1, py) - surface(px - 1, py))[here] / 2 * SPACING
            slope_y = (surface(px, py + 1) - surface(px, py - 1))[here] / 2 * SPACING
            terms = np.stack([slope_x, slope_y, np.ones(here.sum()), surface(px, py)[here] - 900])
            sums += terms @ terms.T
            wanted += terms @ off
        shift_x, shift_y, bias, scale = np.linalg.solve(sums, wanted)
        off = np.concatenate(found)
        assert max(abs(shift_x), abs(shift_y)) < 0.02 and abs(scale) < 2e-5 and abs(bias) < 0.01, (encoding, shift_x, shift_y, bias, scale)
        assert told["encoding"] == encoding and abs(off).max() <= told["error_m"] + 0.01, (abs(off).max(), told)
        assert told["error_m"] < 1 and "rms" in told["description"] and "%.2g m" % (step / 2) in told["description"], told


@case("the error is measured at the pack's samples, tile borders and all: number, mean and largest are those of a second reckoning")
def _():
    said = write("land.ffp", "judged.mbtiles", "--zoom", 11, "--voids", "nodata", "--encoding", "terrarium")
    told = [float(word) for word in re.search(r"measured at (\d+) samples: (\S+) m rms, (\S+) m at most", said).groups()]
    tiles = table_tiles("judged.mbtiles")[0]
    left, top = min(x for _, x, _ in tiles), min(y for _, _, y in tiles)
    sheet = np.zeros((2, 256 * (max(y for _, _, y in tiles) - top + 1), 256 * (max(x for _, x, _ in tiles) - left + 1)))
    for (_, x, y), data in tiles.items():
        bands = picture(data)
        sheet[:, 256 * (y - top):256 * (y - top) + 256, 256 * (x - left):256 * (x - left) + 256] = decode(bands, "terrarium"), bands[3] if len(bands) > 3 else 255
    heights, place = metres("all.tif")
    rows, columns = np.mgrid[0:heights.shape[0], 0:heights.shape[1]] + 0.5
    points = np.stack([place[0] + columns.ravel() * place[1], place[3] + rows.ravel() * place[5]], 1)
    edge = 20037508.342789244
    found = np.array(transformation("EPSG:32632", "EPSG:3857").TransformPoints(points))
    pixel = 2 * edge / 2**11 / 256
    u, v = (found[:, 0] + edge) / pixel - 256 * left - 0.5, (edge - found[:, 1]) / pixel - 256 * top - 0.5
    i, j = np.floor(u).astype(int).clip(0, sheet.shape[2] - 2), np.floor(v).astype(int).clip(0, sheet.shape[1] - 2)
    u, v = u - i, v - j
    four = [sheet[:, j + b, i + a] for b in (0, 1) for a in (0, 1)]
    is_ground = np.minimum.reduce([cell[1] for cell in four]) > 0
    off = ((1 - v) * ((1 - u) * four[0][0] + u * four[1][0]) + v * ((1 - u) * four[2][0] + u * four[3][0]) - heights.ravel())[is_ground]
    second = is_ground.sum(), (off**2).mean()**0.5, abs(off).max()
    assert abs(told[0] - second[0]) <= 3 and abs(told[1] / second[1] - 1) < 0.01 and abs(told[2] / second[2] - 1) < 0.01, (told, second)


@case("a coarser tile is the mean of its four children; beyond the ground it has the height of the nearest ground")
def _():
    tiles, _ = folder_tiles("tiles")
    parents = 0
    for zoom, x, y in tiles:
        if zoom == 12:
            continue
        high = decode(picture(tiles[zoom, x, y]), "terrarium")
        px, py = utm(zoom, x, y)
        for q in range(4):
            child = tiles.get((zoom + 1, 2 * x + q % 2, 2 * y + q // 2))
            if child is None:
                continue
            four = decode(picture(child), "terrarium").reshape(128, 2, 128, 2)
            quadrant = (slice(128 * (q // 2), 128 * (q // 2) + 128), slice(128 * (q % 2), 128 * (q % 2) + 128))
            here = inside(px[quadrant], py[quadrant], rim=12)
            assert abs(high[quadrant] - four.mean((1, 3)))[here].max(initial=0) <= 1 / 256 + 1e-9, (zoom, x, y, q)
            parents += here.any()
        east, top = PLACE[0] + 299.5 * SPACING, PLACE[3]
        beyond = (px > east + 3000) & (py < top - 30 * SPACING) & (py > top - 230 * SPACING)
        if beyond.any():  # what lies beyond repeats the rim; heights there are as high as the rim's
            wrong = abs(high - surface(east - SPACING / 2, py))[beyond].max()
            assert wrong < 12, (zoom, x, y, wrong)
    assert parents > 4
    for data in tiles.values():
        assert len(picture(data)) == 3  # no alpha


@case("exported, baked and exported again it is the same ground, within what was told")
def _():
    write("land.ffp", "land.pmtiles")
    write("land.ffp", "land2.mbtiles", "--voids", "nodata")
    told = table_tiles("land2.mbtiles")[1]
    for source in ("land.pmtiles", "land2.mbtiles"):
        done = run("bake", source, "-o", "again.ffp", "--t-srs", "EPSG:32632", "--spacing", 30)
        assert done.returncode == 0, done.stderr
        write("again.ffp", "again.tif")
        heights, place = metres("again.tif")
        rows, columns = np.mgrid[0:heights.shape[0], 0:heights.shape[1]] + 0.5
        px, py = place[0] + columns * place[1], place[3] + rows * place[5]
        off = abs(heights - surface(px, py))[inside(px, py, rim=3)]
        assert off.max() < 2 * float(told["error_m"]) + 0.02, (source, off.max(), told["error_m"])
    assert " are void" in done.stderr, done.stderr  # of the last: what lay beyond the ground was clear


@case("--voids nodata marks what was filled, in GeoTIFF and in tiles; without it nothing is clear")
def _():
    holes = ((60, 80, 40, 30), (200, 10, 9, 9))
    heights = ground("holes.ffp", holes=holes)
    write("holes.ffp", "holes.tif", "--voids", "nodata")
    marked, void = is_nodata("holes.tif"), heights == -9999
    def on(index):  # the nodes of 8 x 8 cells, from the south-west, that a sample lies on
        return slice(max((index + 7) // 8 - 1, 0), index // 8 + 1)
    touched = np.zeros((34, 39), bool)
    for j, i in zip(*np.nonzero(void[::-1])):
        touched[on(j), on(i)] = True
    wanted = np.array([[touched[on(j), on(i)].all() for i in range(300)] for j in range(260)])[::-1]
    assert np.array_equal(marked, wanted) and (marked | ~void).all(), (void.sum(), marked.sum(), wanted.sum())
    write("holes.ffp", "coarse.tif", "--voids", "nodata", "--level", 2)
    assert np.array_equal(is_nodata("coarse.tif")[::-1], marked[::-1][::4, ::4])
    for voids in ("keep", "nodata"):
        write("holes.ffp", voids + ".mbtiles", "--voids", voids, "--zoom", "10-13")
        clear = 0
        for (zoom, x, y), data in table_tiles(voids + ".mbtiles")[0].items():
            bands = picture(data)
            assert voids == "nodata" or len(bands) == 3
            if len(bands) == 3:
                continue
            px, py = utm(zoom, x, y)
            column, row = ((px - PLACE[0]) / SPACING).astype(int), ((PLACE[3] - py) / SPACING).astype(int)
            here = inside(px, py, rim=8)
            is_marked = marked[row.clip(0, 259), column.clip(0, 299)]
            if zoom == 13:
                wrong = (is_marked & here) != ((bands[3] == 0) & here)
                assert wrong.sum() <= 0.002 * here.sum(), (zoom, x, y, wrong.sum())
            assert (bands[3][here & ~is_marked] == 255).mean() > 0.99 if (here & ~is_marked).any() else True
            assert (bands[3][~inside(px, py, rim=-4)] == 0).all(), "beyond the ground"
            clear += (bands[3] == 0).sum()
        assert (clear > 0) == (voids == "nodata")
    for out in ("x.png", "x.r16"):
        assert "cannot mark voids" in refused_export("holes.ffp", out, "--voids", "nodata")


@case("--images writes the textures where they lie: GeoTIFF, PNG, JPEG, tiles of JPEG and of PNG")
def _():
    rows, columns = np.mgrid[0:520, 0:600]
    image = np.stack([columns * 255 // 599, rows * 255 // 519, np.full(rows.shape, 90)]).astype(np.uint8)
    colour = put("colour.tif", image, gdal.GDT_Byte, (PLACE[0], 15, 0, PLACE[3], 0, -15))
    ground("green.ffp", options=("--color", colour, "--texture-quality", 95))
    def wanted(px, py):
        return np.stack([(px - PLACE[0]) / 9000 * 255, (PLACE[3] - py) / 7800 * 255, np.full(px.shape, 90.0)])
    for out in ("green.tif", "green.png", "green.jpg"):
        write("green.ffp", out, "--images")
        bands = gdal.Open(os.path.join(work, out)).ReadAsArray().astype(float)
        if out == "green.tif":
            place = gdal.Open(os.path.join(work, out)).GetGeoTransform()
        j, i = np.mgrid[0:bands.shape[1], 0:bands.shape[2]] + 0.5
        px, py = place[0] + i * place[1], place[3] + j * place[5]
        here = inside(px, py)
        assert len(bands) == 3 and abs(bands - wanted(px, py))[:, here].mean() < 3, (out, bands.shape, abs(bands - wanted(px, py))[:, here].mean())
    for kind, ending in (("jpeg", "jpg"), ("png", "png")):
        write("green.ffp", kind + "/", "--images", "--tile-images", kind, "--zoom", "11-12", "--region", "9.0,46.0,9.09,46.04")
        tiles, told = folder_tiles(kind)
        assert told["format"] == ending and "encoding" not in told and "error_m" not in told, told
        for (zoom, x, y), data in tiles.items():
            bands = picture(data)
            px, py = utm(zoom, x, y)
            here = inside(px, py) & (px > 500300) & (px < 506500) & (py < 5098000) & (py > 5094500)
            if here.any():
                assert abs(bands[:3] - wanted(px, py))[:, here].mean() < 5, (kind, zoom, x, y, abs(bands[:3] - wanted(px, py))[:, here].mean())
            if kind == "png":
                assert (bands[3][~inside(px, py, rim=-4)] == 0).all()
    write("green.ffp", "one.tif", "--images", "--level", 0)
    assert "levels 0 to" in refused_export("green.ffp", "x.tif", "--images", "--level", 9)
    assert "has none" in refused_export("land.ffp", "x.tif", "--images")
    assert "do not fit a JPEG" in refused_export("land.ffp", "x.jpg")


@case("attributions are text, not HTML that a page would run; they come back as they were")
def _():
    text = 'Survey & <img src=x onerror="x"> &copy; ' + "&" * 300
    ground("theirs.ffp", 60, 50, options=("--attribution", text))
    shown = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    write("theirs.ffp", "theirs/")
    write("theirs.ffp", "meshes/", "--mesh")
    assert folder_tiles("theirs")[1]["attribution"] == shown == json.load(open(os.path.join(work, "meshes/layer.json")))["attribution"]
    for out in ("theirs.mbtiles", "theirs.pmtiles"):
        write("theirs.ffp", out)
        assert run("bake", out, "-o", "mine.ffp").returncode == 0
        assert json.loads(run("info", "--json", "mine.ffp").stdout)["about"]["attribution"] == text, out
    assert table_tiles("theirs.mbtiles")[1]["attribution"] == shown


@case("ground across the antimeridian has tiles at both ends of the map")
def _():
    place = (800000, 300, 0, -1800000, 0, -300)  # UTM zone 60 goes on beyond 180 degrees
    def wave(x, y):
        return 500 + 200 * np.sin(x / 9000) * np.cos(y / 11000)
    ground("seam.ffp", 200, 120, tuple(place), "EPSG:32660", wave=wave, options=("--no-project",))
    write("seam.ffp", "seam/", "--zoom", "0-9")
    tiles, told = folder_tiles("seam")
    columns = {x for zoom, x, _ in tiles if zoom == 9}
    assert 0 in columns and 511 in columns and told["bounds"][0] == -180 and told["bounds"][2] == 180 and len(columns) < 8, (columns, told)
    worst = 0
    for (zoom, x, y), data in tiles.items():
        if zoom == 9:
            px, py = utm(zoom, x, y, "EPSG:32660")
            here = inside(px, py, 200, 120, place)
            worst = max(worst, abs(decode(picture(data), told["encoding"]) - wave(px, py))[here].max(initial=0))
    assert 0 < worst <= told["error_m"] + 0.1, (worst, told)
    write("seam.ffp", "seam.tif", "--region", "179.9,-17,-179.5,-16.5")
    part, _ = metres("seam.tif")
    assert part.shape[1] < 200, part.shape
    centre = told["center"]
    assert any((zoom, x, y) == (9, int((centre[0] + 180) / 360 * 512), y) for zoom, x, y in tiles) and -18 < centre[1] < -16, centre
    write("seam.ffp", "seam.pmtiles", "--zoom", 9)
    head = open(os.path.join(work, "seam.pmtiles"), "rb").read(127)
    assert abs(int.from_bytes(head[119:123], "little", signed=True) / 1e7 - centre[0]) < 1e-6, centre
    for region in ("-180,-90,180,90", "-180,-30,179.99,0"):  # both ends of the map are all of it
        write("seam.ffp", "seam.tif", "--region", region)
        assert metres("seam.tif")[0].shape == (120, 200), region


@case("what cannot be done is refused in one line")
def _():
    np.fromfunction(lambda j, i: 100 + i + j, (60, 80)).astype("<u2").tofile(os.path.join(work, "plain.r16"))
    assert run("bake", "plain.r16", "--raw", "80x60", "--spacing", 10, "-o", "plain.ffp").returncode == 0
    for pack, out, options, words in (("plain.ffp", "x.pmtiles", (), "no reference system"), ("plain.ffp", "x.tif", ("--region", "1,2,3,4"), "--region needs"),
                                      ("land.ffp", "x.tif", ("--region", "1,2,3,4"), "beside the pack, which covers 9.0"), ("land.ffp", "x.txt", (), "ending must be"),
                                      ("land.ffp", "x.pmtiles", ("--zoom", "22"), "too many"), ("land.ffp", "nowhere/x.tif", (), "cannot"), ("land.ffp", "nowhere/x/", (), "cannot"),
                                      ("land.ffp", "tiles/", (), "there already"), ("land.ffp.tif", "x.tif", (), "not a Farfield file")):
        said = refused_export(pack, out, *options)
        assert words in said, (out, options, said)
    for options in (("--zoom", "5-4"), ("--zoom", "25"), ("--region", "1,2,3"), ("--region", "9,46,8.9,45"), ("--encoding", "none"), ("--voids", "x")):
        refused_export("land.ffp", "x.tif", *options, code=2)
    ground("deep.ffp", wave=lambda x, y: -10500 + 500 * np.sin(x / 3000), options=("--hscale", 0.5))
    assert "do not fit --encoding mapbox" in refused_export("deep.ffp", "x.pmtiles", "--encoding", "mapbox")
    write("deep.ffp", "deep.pmtiles", "--encoding", "terrarium", "--zoom", 9)


@case("zooms that show no ground are refused, those that cannot be measured say so")
def _():
    ground("tiny.ffp", 2, 2, wave=lambda x, y: 100 + (x - 500000) / 2)
    for out in ("x.pmtiles", "x/"):
        assert "no pixel on the ground" in refused_export("tiny.ffp", out, "--zoom", 0)
    assert "zoom 11 too coarse to be measured" in write("tiny.ffp", "tiny/", "--zoom", 11)
    assert 15 < folder_tiles("tiny")[1]["error_m"] < 17, folder_tiles("tiny")[1]  # all that lies between its heights
    assert "zoom 0 too coarse to be measured" in write("tiny.ffp", "flat/", "--mesh", "--zoom", 0)
    assert json.load(open(os.path.join(work, "flat/layer.json")))["error_m"] > 115


@case("outputs appear whole or not at all, whatever kills the run; the next run cleans up")
def _():
    for out in ("kill/", "kill.pmtiles", "kill.mbtiles", "kill.tif"):
        for pause in (0.02, 0.1, 0.3):
            child = subprocess.Popen([os.path.join(programs, "farfield-export"), "land.ffp", "-o", out, "--quiet"], cwd=work, stderr=subprocess.DEVNULL)
            time.sleep(pause)
            child.send_signal(signal.SIGKILL)
            child.wait()
            done = os.path.join(work, out.rstrip("/"))
            if os.path.isdir(done):
                assert folder_tiles(out)[1]["tilejson"], out
                shutil.rmtree(done)
            elif os.path.exists(done):
                assert os.path.getsize(done) > 1000, out
        write("land.ffp", out)
    for name in ("odd[12].tif", "*.tif", "odd[12].ffp"):  # characters that stand for others in patterns
        for text in (name, name.replace("[12]", "1").replace("*", "x")):
            open(os.path.join(work, text + ".tmp-99999999"), "w").close()
    write("land.ffp", "odd[12].tif")
    write("land.ffp", "*.tif")
    assert run("bake", "land.ffp.tif", "-o", "odd[12].ffp", "--quiet").returncode == 0
    others = sorted(name for name in os.listdir(work) if ".tmp-" in name)
    assert others == ["odd1.ffp.tmp-99999999", "odd1.tif.tmp-99999999", "x.tif.tmp-99999999"], others
    for name in others:
        os.remove(os.path.join(work, name))
    left = [name for name in os.listdir(work) if ".tmp-" in name or name.startswith(".farfield")]
    assert not left, left


finish()
