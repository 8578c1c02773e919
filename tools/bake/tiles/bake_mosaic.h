/* Map tiles of a box become one raster of colours in Web Mercator. */
#ifndef BAKE_MOSAIC_H
#define BAKE_MOSAIC_H

#include "../bake_options.h"
#include "../raster/bake_gdal.h"
#include "../raster/bake_grid.h"

typedef struct bake_mosaic {
    bake_grid grid; /* red, green, blue, alpha; 0 where there is no tile */
    GDALDatasetH
        set; /* the grid with its place, and the metadata "encoding" where the tiles tell */
} bake_mosaic;

/* 1 when HEIGHTS is a set of tiles: PMTiles, MBTiles, or a folder {zoom}/{x}/{y}.png or .webp. */
int bake_mosaic_wanted(const bake_options *options);
/* Reads the tiles of --zoom, by default the finest, that --bbox meets, by default all. 0 or -1
 * (said). */
int bake_mosaic_open(const bake_options *options, bake_mosaic *mosaic);
void bake_mosaic_close(bake_mosaic *mosaic);

#endif
