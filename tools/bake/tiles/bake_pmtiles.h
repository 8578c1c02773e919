/* Reads PMTiles version 3: one file of map tiles (https://github.com/protomaps/PMTiles, spec/v3).
 *
 * A header of 127 bytes tells where the root directory, the metadata, the leaf directories and the
 * tiles lie. A directory maps numbers of tiles, which run along a Hilbert curve zoom by zoom, to
 * places in the file, or to leaf directories. Nothing of the file is trusted: all that is read is
 * bounded, and lies within the file.
 */
#ifndef BAKE_PMTILES_H
#define BAKE_PMTILES_H

#include <stddef.h>
#include <stdint.h>

#define BAKE_TILE_BYTES_MAX (32u << 20)
#define BAKE_ZOOM_MAX       24

typedef struct bake_pm_entry {
    uint64_t number; /* of the first tile */
    uint64_t offset;
    uint32_t bytes;
    uint32_t run; /* tiles that are all alike; 0: a leaf directory from `number` on */
} bake_pm_entry;

typedef struct bake_pm_directory {
    bake_pm_entry *entry;
    size_t count;
    uint64_t offset; /* among the leaf directories */
} bake_pm_directory;

typedef struct bake_pm_section {
    uint64_t offset, bytes;
} bake_pm_section;

typedef struct bake_pmtiles {
    int fd; /* -1: closed */
    const char *path;
    bake_pm_section root_at, metadata, leaves, tiles;
    int directories_packed, tiles_packed; /* by gzip */
    uint32_t zoom_min, zoom_max;
    double west, south, east, north; /* degrees */
    bake_pm_directory root, leaf;    /* the leaf that was read last */
} bake_pmtiles;

/* 1 when the file begins as PMTiles do. */
int bake_pmtiles_is(const char *path);
/* 0 or -1 (said). */
int bake_pmtiles_open(const char *path, bake_pmtiles *file);
void bake_pmtiles_close(bake_pmtiles *file);
/* The JSON that describes the tiles, in memory to be freed, or NULL (said). */
char *bake_pmtiles_metadata(const bake_pmtiles *file);
/* The image of a tile, in memory to be freed: 1; 0: there is none; -1 (said). */
int bake_pmtiles_get(bake_pmtiles *file, uint32_t zoom, uint32_t x, uint32_t y, uint8_t **bytes,
                     size_t *count);
/* Of a tile along the curve; x and y are below 2^zoom. */
uint64_t bake_pmtiles_number(uint32_t zoom, uint32_t x, uint32_t y);

#endif
