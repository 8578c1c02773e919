/* Where map tiles go: a folder {z}/{x}/{y} with tiles.json (of meshes layer.json), MBTiles, or
 * PMTiles version 3. Whatever it is appears whole or not at all. */
#ifndef EXPORT_STORE_H
#define EXPORT_STORE_H

#include "export_about.h"
#include "export_whole.h"

#include <stddef.h>
#include <stdint.h>

enum export_store_kind { EXPORT_STORE_NONE, EXPORT_FOLDER, EXPORT_MBTILES, EXPORT_PMTILES };

/* What is said of all tiles. */
typedef struct export_tiles_about {
    export_about about;
    const char *format;   /* "png", "jpg" or "terrain" */
    const char *encoding; /* of heights; NULL: colours */
    uint32_t side;        /* of a tile in pixels */
    const char *layer;    /* of meshes: what layer.json says besides, as members of its object */
    uint32_t zoom_min, zoom_max;
    export_bounds bounds; /* of the ground */
} export_tiles_about;

typedef struct export_store export_store;

/* By the path: its ending, or a slash in the end. */
enum export_store_kind export_store_kind_of(const char *path);
/* `tiles` stays with the caller, and is complete when the store is finished. NULL (said). */
export_store *export_store_open(const char *path, const export_tiles_about *tiles);
/* Tiles come in any order, each once. 0 or -1 (said). */
int export_store_put(export_store *store, uint32_t zoom, uint32_t x, uint32_t y,
                     const uint8_t *bytes, size_t count);
/* Finishes when `rc` is 0, else removes what was written; frees the store. 0 or -1 (said). */
int export_store_close(export_store *store, int rc);

#endif
