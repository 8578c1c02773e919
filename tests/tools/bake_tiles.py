"""Map tiles of encoded heights, run by bake_tiles.sh. Tiles are drawn from a surface that is known everywhere; the packs are compared with it."""
import gzip
import math
import os
import sqlite3
import struct
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "rig"))
from rasters import *

ZOOM = 9
BOX = "9.1,45.05,9.7,45.6"
RADIUS = 6378137.0


def surface(longitude, latitude):
    return 900 + 400 * np.sin(np.radians(longitude) * 500) * np.cos(np.radians(latitude) * 700)


def degrees(column, row, zoom):
    """Of a place in tiles."""
    return column / 2**zoom * 360 - 180, np.degrees(np.arctan(np.sinh(np.pi * (1 - 2 * row / 2**zoom))))


def tile(zoom, x, y, side=256, driver="PNG", encoding="terrarium"):
    """The image of a tile, as bytes."""
    place = (np.arange(side) + 0.5) / side
    longitude, latitude = degrees(x + place[None], y + place[:, None], zoom)
    heights = surface(longitude, latitude)
    number = np.round((heights + 32768) * 256 if encoding == "terrarium" else (heights + 10000) * 10).astype(int)
    image = gdal.GetDriverByName("MEM").Create("", side, side, 3)
    for band, shift in ((1, 16), (2, 8), (3, 0)):
        image.GetRasterBand(band).WriteArray((number >> shift & 255).astype(np.uint8))
    gdal.GetDriverByName(driver).CreateCopy("/vsimem/tile", image, options=["LOSSLESS=YES"] if driver == "WEBP" else [])
    file = gdal.VSIFOpenL("/vsimem/tile", "rb")
    data = gdal.VSIFReadL(1, 1 << 24, file)
    gdal.VSIFCloseL(file)
    return bytes(data)


def tiles_of(zoom, longitudes=(9.0, 9.9), latitudes=(45.0, 45.8)):
    column = [int((longitude + 180) / 360 * 2**zoom) for longitude in longitudes]
    row = [int((1 - math.asinh(math.tan(math.radians(latitude))) / math.pi) / 2 * 2**zoom) for latitude in reversed(latitudes)]
    return [(zoom, x, y) for x in range(column[0], column[1] + 1) for y in range(row[0], row[1] + 1)]


def curve(zoom):
    """Tiles of a zoom along the Hilbert curve, by its definition: four turned copies of the coarser one."""
    if zoom == 0:
        return [(0, 0)]
    coarse, half = curve(zoom - 1), 2 ** (zoom - 1)
    return ([(y, x) for x, y in coarse] + [(x, y + half) for x, y in coarse] + [(x + half, y + half) for x, y in coarse]
            + [(2 * half - 1 - y, half - 1 - x) for x, y in coarse])


numbers = {}


def number_of(zoom, x, y):
    if zoom not in numbers:
        numbers[zoom] = {place: (4**zoom - 1) // 3 + i for i, place in enumerate(curve(zoom))}
    return numbers[zoom][x, y]


def varint(value):
    out = b""
    while value > 127:
        out += bytes([value & 127 | 128])
        value >>= 7
    return out + bytes([value])


def directory(entries, packed=True):
    """(number, offset, bytes, run)"""
    out, last = varint(len(entries)), 0
    for number, _, _, _ in entries:
        out += varint(number - last)
        last = number
    out += b"".join(varint(entry[3]) for entry in entries) + b"".join(varint(entry[2]) for entry in entries)
    end = None
    for _, offset, size, _ in entries:
        out += varint(0 if offset == end else offset + 1)
        end = offset + size
    return gzip.compress(out) if packed else out


def pmtiles(name, tiles, metadata=b'{"name": "x", "encoding": "terrarium"}', leaves=0, packed=True, zooms=(0, ZOOM), box=(9.0, 45.0, 9.9, 45.8)):
    """tiles: {(zoom, x, y): bytes}; leaves: entries a leaf directory, 0: all in the root"""
    data, entries, known = b"", [], {}
    for number, key in sorted((number_of(*key), key) for key in tiles):
        image = tiles[key]
        if image not in known:
            known[image] = len(data)
            data += image
        entries.append((number, known[image], len(image), 1))
    leaf = b""
    root = entries
    if leaves:
        root = []
        for i in range(0, len(entries), leaves):
            part = directory(entries[i:i + leaves], packed)
            root.append((entries[i][0], len(leaf), len(part), 0))
            leaf += part
    root = directory(root, packed)
    metadata = gzip.compress(metadata) if packed else metadata
    parts, at = [], 127
    for part in (root, metadata, leaf, data):
        parts += [at, len(part)]
        at += len(part)
    head = b"PMTiles\x03" + struct.pack("<8Q", *parts) + struct.pack("<3Q", len(tiles), len(entries), len(known))
    head += bytes([1, 2 if packed else 1, 1, 2, *zooms]) + struct.pack("<4i", *(round(d * 1e7) for d in box)) + bytes([0]) + struct.pack("<2i", 0, 0)
    assert len(head) == 127
    path = os.path.join(work, name)
    with open(path, "wb") as out:
        out.write(head + root + metadata + leaf + data)
    return path


def worst(path, *options, system="EPSG:32632", inside=(9.12, 45.07, 9.68, 45.58)):
    """The largest distance of the pack from the surface, in metres, in a box in degrees; and what was said. System None: the baker chooses."""
    summary, said = bake(path, *(["--t-srs", system] if system else []), *options)
    assert summary, said
    system = system or "EPSG:%d" % summary["epsg"]
    heights, place = export()
    rows, columns = np.mgrid[0:heights.shape[0], 0:heights.shape[1]] + 0.5
    target, wgs84 = osr.SpatialReference(), osr.SpatialReference()
    target.SetFromUserInput(system)
    wgs84.ImportFromEPSG(4326)
    for reference in (target, wgs84):
        reference.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    points = np.stack([place[0] + columns.ravel() * place[1], place[3] + rows.ravel() * place[5]], 1)
    found = np.array(osr.CoordinateTransformation(target, wgs84).TransformPoints(points))
    error = abs(heights - surface(found[:, 0], found[:, 1]).reshape(heights.shape))
    longitude, latitude = found[:, 0].reshape(heights.shape), found[:, 1].reshape(heights.shape)
    looked_at = (longitude > inside[0]) & (latitude > inside[1]) & (longitude < inside[2]) & (latitude < inside[3])
    assert looked_at.any()
    return error[looked_at].max(), summary, said


images = {key: tile(*key) for zoom in (ZOOM - 1, ZOOM) for key in tiles_of(zoom)}


@case("PMTiles become the surface that they were drawn from: directories in one or in leaves, packed or not, --bbox and --zoom")
def _():
    for options in ({}, {"leaves": 2}, {"packed": False}, {"leaves": 1, "packed": False}):
        error, summary, said = worst(pmtiles("world.pmtiles", images, **options), "--bbox", BOX)
        assert error < 0.6 and summary["voids"] == 0 and "metadata says" in said, (options, error, summary, said)
        assert summary["samples_x"] < 300
    whole, summary_all, said = worst(pmtiles("world.pmtiles", images))
    assert whole < 0.6 and summary_all["samples_x"] > 400, (whole, summary_all)
    coarse, summary, _ = worst(pmtiles("world.pmtiles", images), "--zoom", ZOOM - 1)
    assert coarse < 6 and abs(summary["spacing_m"] / summary_all["spacing_m"] - 2) < 0.05, (coarse, summary)


@case("PMTiles whose header tells no bounds are read where --bbox says, and ask for it")
def _():
    path = pmtiles("bounds.pmtiles", images, box=(0, 0, 0, 0))
    error, summary, said = worst(path, "--bbox", BOX)
    assert error < 0.6 and summary["voids"] == 0, (error, summary, said)
    assert "give --bbox W,S,E,N" in refused(path)


@case("without --t-srs they are projected to the local UTM zone, true to scale, and told; with --no-project they stay")
def _():
    path = pmtiles("world.pmtiles", images)
    error, summary, said = worst(path, "--bbox", BOX, system=None)
    assert error < 0.6 and summary["epsg"] == 32632 and "Pseudo-Mercator shows a metre of this ground as 1.4" in said, (error, summary, said)
    pixel = 2 * math.pi * RADIUS / 2**ZOOM / 256
    assert abs(summary["spacing_m"] / (pixel * math.cos(math.radians(45.3))) - 1) < 0.005, summary
    error, summary, said = worst(path, "--bbox", BOX, "--no-project", system=None)
    assert error < 0.6 and summary["epsg"] == 3857 and abs(summary["spacing_m"] - pixel) < 0.01 and "kept" in said, (error, summary, said)


@case("MBTiles and folders do, of PNG and WebP, of 256 and 512 pixels, of both encodings")
def _():
    for trial, (side, driver, encoding) in enumerate(((256, "PNG", "terrarium"), (512, "WEBP", "mapbox"))):
        drawn = {key: tile(*key, side, driver, encoding) for key in tiles_of(ZOOM)}
        path = os.path.join(work, "land%d.mbtiles" % trial)
        table = sqlite3.connect(path)
        table.executescript("create table metadata (name text, value text); create table tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob)")
        table.execute("insert into metadata values ('encoding', ?)", (encoding,))
        folder = os.path.join(work, "folder%d" % trial)
        for (zoom, x, y), image in drawn.items():
            table.execute("insert into tiles values (?, ?, ?, ?)", (zoom, x, 2**zoom - 1 - y, image))
            os.makedirs("%s/%d/%d" % (folder, zoom, x), exist_ok=True)
            with open("%s/%d/%d/%d.%s" % (folder, zoom, x, y, driver.lower()), "wb") as out:
                out.write(image)
        table.commit()
        table.close()
        for source, options in ((path, []), (folder, ["--rgb", encoding])):
            error, summary, said = worst(source, "--bbox", BOX, *options)
            assert error < 0.6 and summary["voids"] == 0, (source, error, said)
    assert "--rgb" in refused(folder, "--bbox", BOX, "--t-srs", "EPSG:32632")


@case("name and attribution of tiles are those of the pack, without HTML")
def _():
    metadata = b'{"vector_layers": [{"name": "not this"}], "name": "L\\u00e4nd\\u002fer", "encoding": "terrarium", "attribution": "<a href=\\"https://x\\">&copy; Survey &amp; Sons</a>"}'
    path = os.path.join(work, "whose.mbtiles")
    table = sqlite3.connect(path)
    table.executescript("create table metadata (name text, value text); create table tiles (zoom_level integer, tile_column integer, tile_row integer, tile_data blob)")
    table.executemany("insert into metadata values (?, ?)", {"encoding": "terrarium", "name": "L\u00e4nd/er", "attribution": "<a href='x'>\u00a9 Survey & Sons</a>"}.items())
    table.executemany("insert into tiles values (?, ?, ?, ?)", [(zoom, x, 2**zoom - 1 - y, image) for (zoom, x, y), image in images.items()])
    table.commit()
    table.close()
    for source in pmtiles("whose.pmtiles", images, metadata=metadata), path:
        assert bake(source, "--bbox", BOX)[0]
        said = json.loads(run("info", "--json", "out.ffp").stdout)["about"]
        assert said["name"] == "L\u00e4nd/er" and said["attribution"] == "\u00a9 Survey & Sons", said


@case("a tile that is not there is void; a box across the antimeridian is one piece")
def _():
    holed = dict(images)
    del holed[tiles_of(ZOOM)[0]]
    summary, said = bake(pmtiles("holed.pmtiles", holed), "--t-srs", "EPSG:32632", "--rim-void-height", "0")
    assert summary["given"] == 256 * 256, summary
    seam = {(5, x, y): tile(5, x, y) for x in (0, 1, 30, 31) for y in range(16, 20)}
    path = pmtiles("seam.pmtiles", seam, zooms=(5, 5), box=(-180, -40, 180, 0))
    error, summary, said = worst(path, "--bbox", "176,-20,-178,-15", system="EPSG:32701", inside=(-179.9, -19, -178.2, -16))
    assert error < 60 and summary["voids"] == 0 and summary["samples_x"] < 400, (error, summary)  # pixels of 5 km


@case("what cannot be read is refused in one line: no tiles there, too many, other tiles, a part of another raster")
def _():
    path = pmtiles("world.pmtiles", images)
    assert "beside its tiles" in refused(path, "--bbox", "20,45,21,46")
    assert "no tile" in refused(path, "--zoom", "12")
    assert "too many" in refused(pmtiles("planet.pmtiles", images, zooms=(0, 9), box=(-180, -85, 180, 85)))
    assert "tiles of zoom 24 are too many" in refused(pmtiles("endless.pmtiles", {(0, 0, 0): images[tiles_of(ZOOM)[0]]}, zooms=(0, 24), box=(-180, -85, 180, 85)))
    assert "--rgb" in refused(pmtiles("plain.pmtiles", images, metadata=b"{}"), "--bbox", BOX)
    assert "map tiles" in refused(put("dem.tif", np.zeros((60, 80))), "--bbox", BOX)
    vector = pmtiles("vector.pmtiles", {key: b"\x1a\x02no picture" for key in tiles_of(ZOOM)})
    assert "no PNG or WebP" in refused(vector, "--bbox", BOX)
    mixed = dict(images)
    mixed[tiles_of(ZOOM)[1]] = tile(*tiles_of(ZOOM)[1], side=128)
    assert "unlike" in refused(pmtiles("mixed.pmtiles", mixed))
    for wrong in ("1,2,3", "9,46,10,45", "9,45,9,46", "a,b,c,d", "9,45,200,46"):
        assert run("bake", path, "-o", "out.ffp", "--bbox", wrong).returncode == 2, wrong


@case("damaged PMTiles end in one line: cut off, hostile numbers, packed without end (spoilt ones: test_pmtiles.c)")
def _():
    whole = open(pmtiles("world.pmtiles", images, leaves=2), "rb").read()
    path = os.path.join(work, "bad.pmtiles")

    def spoil(data):
        with open(path, "wb") as out:
            out.write(data)
        done = run("bake", path, "-o", "out.ffp", "--t-srs", "EPSG:32632", "--bbox", BOX, "--quiet")
        assert done.returncode in (0, 1) and done.stderr.count("\n") == (done.returncode != 0), (done.returncode, done.stderr)
        return done.stderr

    for end in (7, 50, 126, 127, 140, len(whole) // 2):
        assert spoil(whole[:end]), end
    for bomb in (varint(2**62), varint(1) + varint(5) + varint(0) + varint(2**40) + varint(1), varint(3) + b"\x01\x00\x00" + b"\x01" * 9, b"\xff" * 40, b""):
        root = gzip.compress(bomb)
        assert "damaged" in spoil(whole[:8] + struct.pack("<2Q", 127, len(root)) + whole[24:127] + root + whole[127 + len(root):])
    huge = gzip.compress(bytes(200 << 20))
    assert "damaged" in spoil(whole[:8] + struct.pack("<2Q", len(whole), len(huge)) + whole[24:] + huge)


finish()
