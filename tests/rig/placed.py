#!/usr/bin/env python3
"""placed.py FROM.raw SIZE COLUMN,ROW,COLUMNS,ROWS STEP SPACING EPSG OUT.vrt: every STEP-th sample of a part of a raster of hills.py, COLUMNS x
ROWS of them, with a place that GDAL reads: the whole raster's samples are SPACING m apart, its north-west one at 500000, 5000000 of
EPSG:EPSG. So parts of one raster lie as they do in it, whatever their steps."""
import sys

source, size, part, step, spacing, epsg, out = sys.argv[1:]
size, step, spacing = int(size), int(step), float(spacing)
column, row, columns, rows = map(int, part.split(","))
heights = open(source, "rb").read()
with open(out + ".raw", "wb") as raw:
    for j in range(row, row + rows * step, step):
        raw.write(b"".join(heights[2 * (j * size + i):2 * (j * size + i) + 2] for i in range(column, column + columns * step, step)))
cell = spacing * step
with open(out, "w") as vrt:
    vrt.write(f"""<VRTDataset rasterXSize="{columns}" rasterYSize="{rows}"><SRS>EPSG:{epsg}</SRS>
<GeoTransform>{500000 + column * spacing - cell / 2}, {cell}, 0, {5000000 - row * spacing + cell / 2}, 0, {-cell}</GeoTransform>
<VRTRasterBand dataType="UInt16" band="1" subClass="VRTRawRasterBand"><SourceFilename relativeToVRT="1">{out.split("/")[-1]}.raw</SourceFilename>
<PixelOffset>2</PixelOffset><LineOffset>{2 * columns}</LineOffset><ByteOrder>LSB</ByteOrder></VRTRasterBand></VRTDataset>
""")
