"""Images of any make over the ground, run by bake_colours.sh: the texture of the pack shows their colours, and where they show nothing those
of ground without images, but for the nearest two texels."""
import os
import subprocess
import sys

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(here, "..", "rig"))
from rasters import *

y, x = np.mgrid[0:60, 0:80]
ground = put("ground.tif", 100 + x)
hole = (y >= 20) & (y < 40) & (x >= 30) & (x < 50)
west = x < 40  # one colour in the west, another in the east


def texture(image):
    """Colours at a place of the image: (row, column) -> (red, green, blue)."""
    summary, said = bake(ground, "--color", image, "--tile-log2", "7", "--texture-log2", "6", "--texture-levels", "1", "--texture-quality", "98", "--image-codec", "jpeg")
    assert summary, said
    jpeg = os.path.join(work, "texture.jpg")
    subprocess.run([sys.executable, os.path.join(here, "..", "whole_jpeg.py"), os.path.join(work, "out.ffp"), jpeg], check=True)
    texels = gdal.Open(jpeg).ReadAsArray().astype(float)
    return lambda row, column: texels[:, 63 - round((59 - row) * 63 / 128), round(column * 63 / 128)]


def shows(image, in_west, in_east, has_hole=True):
    """The colours in the west and the east; in the hole the ground's own, at its rim the nearest one."""
    at = texture(image)
    for row, column, colour in ((50, 10, in_west), (10, 10, in_west), (50, 70, in_east), (25, 31, in_west), (25, 48, in_east)) + has_hole * ((30, 40, own),):
        assert abs(at(row, column) - np.array(colour)).max() < 30, (image, row, column, at(row, column), colour)


corner = (y < 9) & (x < 9)
own = texture(put("corner.tif", [np.where(corner, 9, 0)] * 3 + [np.where(corner, 255, 0)], gdal.GDT_Byte, place=UTM_PLACE, reference="EPSG:32632", alpha=True))(30, 40)


def placed_or_not(name, bands, in_west, in_east, make=lambda path: path, **options):
    for place in (UTM_PLACE, None):
        shows(make(put(name, bands, gdal.GDT_Byte, place=place, reference="EPSG:32632" if place else None, **options)), in_west, in_east)


def palette(entries):
    def make(path):
        table = gdal.ColorTable()
        for index, entry in enumerate(entries):
            table.SetColorEntry(index, entry)
        raster = gdal.Open(path, gdal.GA_Update)
        raster.GetRasterBand(1).SetColorTable(table)
        return path
    return make


SAND, SEA = (200, 180, 90), (20, 90, 160)


@case("palettes show their colours, and nothing where an entry is transparent or the nodata value")
def _():
    indexes = np.where(hole, 2, np.where(west, 0, 1))
    placed_or_not("p.tif", indexes, SAND, SEA, palette([(*SAND, 255), (*SEA, 255), (255, 0, 255, 255)]), nodata=2)
    vrt, png = os.path.join(work, "p.vrt"), os.path.join(work, "p.png")
    gdal.Translate(vrt, palette([(*SAND, 255), (*SEA, 255), (255, 0, 255, 255)])(put("p.tif", indexes, gdal.GDT_Byte)), format="VRT")
    text = open(vrt).read()
    assert text.count('c1="255" c2="0" c3="255" c4="255"') == 1
    with open(vrt, "w") as out:
        out.write(text.replace('c1="255" c2="0" c3="255" c4="255"', 'c1="255" c2="0" c3="255" c4="0"'))
    gdal.Translate(png, vrt, format="PNG")
    shows(vrt, SAND, SEA)
    shows(png, SAND, SEA)


@case("alpha covers or not: beside a grey and beside colours")
def _():
    alpha = np.where(hole, 0, 255)
    placed_or_not("ga.tif", [np.where(hole, 9, np.where(west, 60, 200)), alpha], (60,) * 3, (200,) * 3, alpha=True)
    colours = [np.where(hole, 255, np.where(west, a, b)) for a, b in zip(SAND, SEA)]
    placed_or_not("rgba.tif", [*colours, alpha], SAND, SEA, alpha=True)
    shows(put("rgba.png", [*colours, alpha], gdal.GDT_Byte, driver="PNG", alpha=True), SAND, SEA)


@case("a mask or a nodata value covers or not; a colour with one band at its nodata value is a colour")
def _():
    colours = [np.where(hole, 0, np.where(west, a, b)) for a, b in zip((0, 200, 90), SEA)]
    placed_or_not("nodata.tif", colours, (0, 200, 90), SEA, nodata=0)
    placed_or_not("mask.tif", colours, (0, 200, 90), SEA, mask=np.where(hole, 0, 255))
    placed_or_not("grey.tif", np.where(hole, 0, np.where(west, 60, 200)), (60,) * 3, (200,) * 3, nodata=0)


@case("bits are black and white, greys and colours of few bits reach to white, beside alpha, too")
def _():
    for bits in (1, 2, 4):
        image = put("bits.tif", np.where(west, 0, 2**bits - 1), gdal.GDT_Byte, options=["NBITS=%d" % bits])
        shows(image, (0, 0, 0), (255, 255, 255), has_hole=False)
        png = os.path.join(work, "bits.png")
        gdal.Translate(png, image, format="PNG", creationOptions=["NBITS=%d" % bits])
        shows(png, (0, 0, 0), (255, 255, 255), has_hole=False)
    colours = [np.where(west, a, b) for a, b in ((0, 15), (15, 5), (5, 15))]
    shows(put("bits.tif", colours, gdal.GDT_Byte, options=["NBITS=4"]), (0, 255, 85), (255, 85, 255), has_hole=False)
    for bands in ([np.where(hole, 9, band) for band in colours], np.where(hole, 9, np.where(west, 0, 15))[None]):
        image = put("bits.tif", [*bands, np.where(hole, 0, 15)], gdal.GDT_Byte, options=["NBITS=4"], alpha=True)
        shows(image, (0, 255, 85) if len(bands) == 3 else (0, 0, 0), (255, 85, 255) if len(bands) == 3 else (255,) * 3)


finish()
