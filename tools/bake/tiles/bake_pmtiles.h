/* Reads PMTiles version 3: one file of map tiles (https://github.com/protomaps/PMTiles, spec/v3).
 *
 * A header of 127 bytes tells where the root directory, the metadata, the leaf directories and the
 * tiles lie. A directory maps numbers of tiles, which run along a Hilbert curve zoom by zoom, to
 * places in the file, or to leaf directories. Nothing of the file is trusted: all that is read is
 * bounded, and lies within the file.
 */
#ifndef BAKE_PMTILES_H
#define BAKE_PMTILES_H

#include "bake_pmtiles_format.h"

typedef struct bake_pm_directory {
    bake_pm_entry *entry;
    size_t count;
    uint64_t offset; /* among the leaf directories */
} bake_pm_directory;

typedef struct bake_pmtiles {
    int fd; /* -1: closed */
    const char *path;
    bake_pm_header head;
    bake_pm_directory root, leaf; /* the leaf that was read last */
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

#endif
