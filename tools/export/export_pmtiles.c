/* PMTiles version 3, clustered: tiles come in any order, and are copied in that of their numbers
 * when all are there. */
#include "../bake/bake_say.h"
#include "../bake/raster/bake_grid.h"
#include "../bake/tiles/bake_pmtiles_format.h"
#include "export_gzip.h"
#include "export_store_local.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define LEAF_ENTRIES 4096

typedef struct growing {
    uint8_t *bytes;
    size_t count, room;
} growing;

typedef struct pmtiles {
    int fd; /* of tiles as they come */
    uint64_t bytes;
    bake_pm_entry *entry; /* a tile each, offsets in fd */
    size_t count, room;
} pmtiles;

/* What is written. */
typedef struct archive {
    const export_store *store;
    const pmtiles *tiles;
    FILE *file;
    bake_pm_header head;
    bake_pm_entry *entry; /* offsets among the tiles of the file */
    growing root, leaves;
} archive;

static int pmtiles_open(export_store *store)
{
    pmtiles *p = calloc(1, sizeof *p);
    if (!p) return bake_fail("out of memory");
    p->fd = bake_temp_open();
    store->own = p;
    if (p->fd >= 0) return 0;
    free(p);
    return -1;
}

static int pmtiles_put(export_store *store, uint32_t zoom, uint32_t x, uint32_t y,
                       const uint8_t *bytes, size_t count)
{
    pmtiles *p = store->own;
    if (p->count == p->room) {
        size_t room = p->room ? 2 * p->room : 1024;
        bake_pm_entry *grown = realloc(p->entry, room * sizeof *grown);
        if (!grown) return bake_fail("out of memory");
        p->entry = grown;
        p->room = room;
    }
    if (bake_pwrite(p->fd, bytes, count, p->bytes)) return -1;
    p->entry[p->count++] = (bake_pm_entry){ bake_pmtiles_number(zoom, x, y), p->bytes,
                                            (uint32_t)count, 1 };
    p->bytes += count;
    return 0;
}

static int by_number(const void *a, const void *b)
{
    const bake_pm_entry *one = a, *other = b;
    return one->number < other->number ? -1 : one->number > other->number;
}

/* ---- directories ---- */

/* Appends bytes, packed. 0 or -1 (said). */
static int add_packed(growing *to, const void *plain, size_t plain_count, uint32_t *bytes)
{
    size_t count = 0;
    uint8_t *packed = export_gzip(plain, plain_count, &count);
    uint8_t *grown = packed ? realloc(to->bytes, to->count + count) : NULL;
    if (!packed) return -1;
    if (grown) {
        memcpy(grown + to->count, packed, count);
        to->bytes = grown;
        to->count += count;
        *bytes = (uint32_t)count;
    }
    free(packed);
    return grown ? 0 : bake_fail("out of memory");
}

static int add_directory(growing *to, const bake_pm_entry *entry, size_t count, uint32_t *bytes)
{
    uint8_t *plain = malloc((count + 1) * BAKE_PM_ENTRY_MAX);
    int rc = plain ? add_packed(to, plain, bake_pm_directory_put(entry, count, plain), bytes)
                   : bake_fail("out of memory");
    free(plain);
    return rc;
}

/* Leaves of so many entries, and a root of leaves. */
static int make_leaves(archive *a, size_t leaf_entries)
{
    size_t all = a->head.entries, leaves = (all + leaf_entries - 1) / leaf_entries;
    bake_pm_entry *root = malloc(leaves * sizeof *root);
    uint32_t bytes;
    int rc = root ? 0 : bake_fail("out of memory");
    a->leaves.count = a->root.count = 0;
    for (size_t i = 0; !rc && i < leaves; i++) {
        const bake_pm_entry *first = a->entry + i * leaf_entries;
        size_t left = all - i * leaf_entries;
        root[i] = (bake_pm_entry){ first->number, a->leaves.count, 0, 0 };
        rc = add_directory(&a->leaves, first, left < leaf_entries ? left : leaf_entries,
                           &root[i].bytes);
    }
    if (!rc) rc = add_directory(&a->root, root, leaves, &bytes);
    free(root);
    return rc;
}

/* One directory when it fits in the first bytes, else leaves. */
static int make_directories(archive *a)
{
    const size_t most = BAKE_PM_FIRST_BYTES - BAKE_PM_HEADER_BYTES;
    uint32_t bytes;
    int rc = add_directory(&a->root, a->entry, a->head.entries, &bytes);
    for (size_t n = LEAF_ENTRIES; !rc && a->root.count > most; n *= 2) rc = make_leaves(a, n);
    return rc;
}

/* ---- tiles ---- */

/* Reads tile number `i` into memory that grows. 0 or -1 (said). */
static int read_tile(const pmtiles *p, size_t i, growing *into)
{
    if (p->entry[i].bytes > into->room) {
        uint8_t *grown = realloc(into->bytes, p->entry[i].bytes);
        if (!grown) return bake_fail("out of memory");
        into->bytes = grown;
        into->room = p->entry[i].bytes;
    }
    into->count = p->entry[i].bytes;
    return bake_pread(p->fd, into->bytes, into->count, p->entry[i].offset);
}

/* Places tiles in the order of their numbers; those that are like the one before them share its
 * bytes. */
static int place_tiles(archive *a)
{
    growing now = { 0 }, last = { 0 };
    int rc = 0;
    bake_pm_header *head = &a->head;
    for (size_t i = 0; !rc && i < a->tiles->count; i++) {
        bake_pm_entry *entry = head->entries ? &a->entry[head->entries - 1] : NULL,
                      *next = &a->entry[head->entries];
        rc = read_tile(a->tiles, i, &now);
        int same = !rc && entry && now.count == last.count &&
                   !memcmp(now.bytes, last.bytes, now.count);
        if (same && entry->number + entry->run == a->tiles->entry[i].number) {
            entry->run++;
            continue;
        }
        *next = (bake_pm_entry){ a->tiles->entry[i].number,
                                 same ? entry->offset : head->tiles.bytes, (uint32_t)now.count, 1 };
        head->entries++;
        if (!same) head->tiles.bytes += now.count;
        head->contents += !same;
        growing swap = last;
        last = now;
        now = swap;
    }
    free(now.bytes);
    free(last.bytes);
    return rc;
}

static int write_bytes(const archive *a, const void *bytes, size_t count)
{
    if (!count || fwrite(bytes, 1, count, a->file) == count) return 0;
    return bake_fail("cannot write %s: %s", a->store->whole.path, strerror(errno));
}

/* Copies what place_tiles placed: the first of those that are alike. */
static int write_tiles(const archive *a)
{
    growing tile = { 0 };
    uint64_t at = 0;
    int rc = 0;
    size_t e = 0;
    for (size_t i = 0; !rc && i < a->tiles->count; i++) {
        if (e >= a->head.entries || a->tiles->entry[i].number != a->entry[e].number) continue;
        if (a->entry[e++].offset < at) continue;
        rc = read_tile(a->tiles, i, &tile);
        if (!rc) rc = write_bytes(a, tile.bytes, tile.count);
        at += tile.count;
    }
    free(tile.bytes);
    return rc;
}

/* ---- the file ---- */

static void describe(archive *a, size_t metadata_bytes)
{
    const export_tiles_about *t = a->store->tiles;
    bake_pm_header *head = &a->head;
    head->version = BAKE_PM_VERSION;
    head->root = (bake_pm_section){ BAKE_PM_HEADER_BYTES, a->root.count };
    head->metadata = (bake_pm_section){ head->root.offset + head->root.bytes, metadata_bytes };
    head->leaves = (bake_pm_section){ head->metadata.offset + metadata_bytes, a->leaves.count };
    head->tiles.offset = head->leaves.offset + head->leaves.bytes;
    head->addressed = a->tiles->count;
    head->clustered = 1;
    head->directories_packed = BAKE_PM_GZIP;
    head->tiles_packed = BAKE_PM_PLAIN;
    head->kind = strcmp(t->format, "png") ? BAKE_PM_JPEG : BAKE_PM_PNG;
    head->zoom_min = head->zoom_middle = t->zoom_min;
    head->zoom_max = t->zoom_max;
    export_told_place place = export_facts_place(t);
    head->west = place.bounds.west;
    head->south = place.bounds.south;
    head->east = place.bounds.east;
    head->north = place.bounds.north;
    head->middle_x = place.middle_x;
    head->middle_y = place.middle_y;
}

static int write_archive(archive *a)
{
    uint8_t head[BAKE_PM_HEADER_BYTES];
    growing metadata = { 0 };
    uint32_t bytes;
    a->entry = malloc(a->tiles->count * sizeof *a->entry + 1);
    int rc = a->entry ? 0 : bake_fail("out of memory");
    if (!rc) rc = place_tiles(a);
    if (!rc) rc = make_directories(a);
    char *json = rc ? NULL : export_facts_json(a->store->tiles, NULL);
    if (!rc) rc = json ? add_packed(&metadata, json, strlen(json), &bytes) : -1;
    free(json);
    if (!rc) {
        describe(a, metadata.count);
        bake_pm_header_put(&a->head, head);
        rc = write_bytes(a, head, sizeof head) || write_bytes(a, a->root.bytes, a->root.count) ||
                     write_bytes(a, metadata.bytes, metadata.count) ||
                     write_bytes(a, a->leaves.bytes, a->leaves.count)
                 ? -1
                 : write_tiles(a);
    }
    free(metadata.bytes);
    free(a->entry);
    free(a->root.bytes);
    free(a->leaves.bytes);
    return rc;
}

static int pmtiles_close(export_store *store, int rc)
{
    pmtiles *p = store->own;
    bake_grid grid = { .fd = p->fd };
    if (!rc) {
        qsort(p->entry, p->count, sizeof *p->entry, by_number);
        archive a = { .store = store, .tiles = p, .file = fopen(store->whole.temp, "wb") };
        rc = a.file ? write_archive(&a)
                    : bake_fail("cannot write %s: %s", store->whole.path, strerror(errno));
        if (a.file && fclose(a.file) && !rc)
            rc = bake_fail("cannot write %s: %s", store->whole.path, strerror(errno));
    }
    bake_grid_close(&grid);
    free(p->entry);
    free(p);
    return rc;
}

const export_store_ops export_pmtiles_ops = { pmtiles_open, pmtiles_put, pmtiles_close };
