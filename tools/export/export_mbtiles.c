/* MBTiles 1.3: tiles as rows of an SQLite table. */
#include "../bake/bake_say.h"
#include "export_store_local.h"

#include <sqlite3.h>
#include <stdlib.h>

typedef struct mbtiles {
    sqlite3 *file;
    sqlite3_stmt *tile, *fact;
} mbtiles;

static int fail_table(const export_store *store, const mbtiles *m)
{
    return bake_fail("cannot write %s: %s", store->whole.path, sqlite3_errmsg(m->file));
}

static int run(const export_store *store, const mbtiles *m, const char *words)
{
    return sqlite3_exec(m->file, words, NULL, NULL, NULL) == SQLITE_OK ? 0 : fail_table(store, m);
}

static void free_table(mbtiles *m)
{
    sqlite3_finalize(m->tile);
    sqlite3_finalize(m->fact);
    sqlite3_close(m->file);
    free(m);
}

/* The file is nobody's until it has its name: it needs no journal. */
static int make_tables(const export_store *store, mbtiles *m)
{
    if (sqlite3_open(store->whole.temp, &m->file) != SQLITE_OK) return fail_table(store, m);
    if (run(store, m,
            "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;"
            "CREATE TABLE metadata (name TEXT, value TEXT);"
            "CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER,"
            " tile_data BLOB); BEGIN"))
        return -1;
    if (sqlite3_prepare_v2(m->file, "INSERT INTO tiles VALUES (?, ?, ?, ?)", -1, &m->tile, NULL) ||
        sqlite3_prepare_v2(m->file, "INSERT INTO metadata VALUES (?, ?)", -1, &m->fact, NULL))
        return fail_table(store, m);
    return 0;
}

static int mbtiles_open(export_store *store)
{
    mbtiles *m = calloc(1, sizeof *m);
    if (!m) return bake_fail("out of memory");
    store->own = m;
    if (!make_tables(store, m)) return 0;
    free_table(m);
    return -1;
}

/* Rows begin in the south. */
static int mbtiles_put(export_store *store, uint32_t zoom, uint32_t x, uint32_t y,
                       const uint8_t *bytes, size_t count)
{
    const mbtiles *m = store->own;
    sqlite3_reset(m->tile);
    sqlite3_bind_int64(m->tile, 1, zoom);
    sqlite3_bind_int64(m->tile, 2, x);
    sqlite3_bind_int64(m->tile, 3, (int64_t)(1u << zoom) - 1 - y);
    sqlite3_bind_blob64(m->tile, 4, bytes, count, SQLITE_STATIC);
    return sqlite3_step(m->tile) == SQLITE_DONE ? 0 : fail_table(store, m);
}

static int put_fact(void *context, const char *name, const char *value, int is_text)
{
    const export_store *store = context;
    const mbtiles *m = store->own;
    (void)is_text;
    sqlite3_reset(m->fact);
    sqlite3_bind_text(m->fact, 1, name, -1, SQLITE_STATIC);
    sqlite3_bind_text(m->fact, 2, value, -1, SQLITE_STATIC);
    return sqlite3_step(m->fact) == SQLITE_DONE ? 0 : fail_table(store, m);
}

static int mbtiles_close(export_store *store, int rc)
{
    mbtiles *m = store->own;
    if (!rc) rc = export_facts(store->tiles, put_fact, store);
    sqlite3_reset(m->tile);
    sqlite3_reset(m->fact);
    if (!rc)
        rc = run(store, m,
                 "CREATE UNIQUE INDEX tile_index ON tiles (zoom_level, tile_column, tile_row);"
                 "COMMIT");
    free_table(m);
    return rc;
}

const export_store_ops export_mbtiles_ops = { mbtiles_open, mbtiles_put, mbtiles_close };
