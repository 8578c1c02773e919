/* Private to export_store.c and what it is made of: one kind of store each. */
#ifndef EXPORT_STORE_LOCAL_H
#define EXPORT_STORE_LOCAL_H

#include "export_store.h"

#include <stdio.h>

typedef struct export_store_ops {
    /* Begins in store->whole.temp; leaves store->own. 0 or -1 (said), with nothing to close. */
    int (*open)(export_store *store);
    int (*put)(export_store *store, uint32_t zoom, uint32_t x, uint32_t y, const uint8_t *bytes,
               size_t count);
    /* Writes what comes last when `rc` is 0; frees store->own. 0 or -1 (said). */
    int (*close)(export_store *store, int rc);
} export_store_ops;

struct export_store {
    const export_store_ops *ops;
    const export_tiles_about *tiles;
    export_whole whole;
    void *own;
};

extern const export_store_ops export_folder_ops, export_mbtiles_ops, export_pmtiles_ops;

/* ---- what is said of the tiles, as JSON and as rows ---- */

/* Where the tiles lie, as formats have it: within +-180, and all around where ground goes beyond;
 * its middle is its own. */
typedef struct export_told_place {
    export_bounds bounds;
    double middle_x, middle_y;
} export_told_place;
export_told_place export_facts_place(const export_tiles_about *tiles);
/* Calls `put` for each name and value; `is_text`: the value is no number and no JSON. */
typedef int (*export_fact_fn)(void *context, const char *name, const char *value, int is_text);
int export_facts(const export_tiles_about *tiles, export_fact_fn put, void *context);
/* An object of them, TileJSON when `pattern` says where the tiles are (NULL: nowhere). Memory to be
 * freed, or NULL (said). */
char *export_facts_json(const export_tiles_about *tiles, const char *pattern);

#endif
