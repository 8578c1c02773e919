/* Map tiles {zoom}/{x}/{y} on the disk: PMTiles, MBTiles, or a folder of images. */
#ifndef BAKE_TILESET_H
#define BAKE_TILESET_H

#include "../raster/bake_gdal.h"
#include "bake_pmtiles.h"

enum bake_tiles_kind { BAKE_TILES_NONE, BAKE_TILES_PM, BAKE_TILES_MB, BAKE_TILES_FOLDER };

typedef struct bake_tileset {
    enum bake_tiles_kind kind;
    const char *path;
    bake_pmtiles pmtiles;
    GDALDatasetH table; /* MBTiles, as SQLite */
    uint32_t zoom_max;
    char encoding[16];                 /* "mapbox", "terrarium", or "" */
    char name[512], attribution[2048]; /* whose they are, or "" */
} bake_tileset;

/* Columns and rows of tiles, row 0 north; both ends belong to it. */
typedef struct bake_tiles_area {
    uint32_t west, north, east, south;
} bake_tiles_area;

/* By what lies there: a folder with folders of numbers in it, or what a file begins with. */
enum bake_tiles_kind bake_tileset_kind(const char *path);
/* 0 or -1 (said). */
int bake_tileset_open(const char *path, enum bake_tiles_kind kind, bake_tileset *set);
void bake_tileset_close(bake_tileset *set);
/* Where there are tiles at a zoom, at most. 0 or -1 (said): nowhere. */
int bake_tileset_area(const bake_tileset *set, uint32_t zoom, bake_tiles_area *area);
/* The image of a tile, in memory to be freed: 1; 0: there is none; -1 (said). */
int bake_tileset_get(bake_tileset *set, uint32_t zoom, uint32_t x, uint32_t y, uint8_t **bytes,
                     size_t *count);

/* A place in tiles of a zoom, from the west and north end of the map. */
double bake_tiles_x(double longitude, uint32_t zoom);
double bake_tiles_y(double latitude, uint32_t zoom);

#endif
