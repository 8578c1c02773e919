#include "export_store.h"

#include "../bake/bake_say.h"
#include "export_store_local.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const export_store_ops *const ops_of[] = {
    [EXPORT_FOLDER] = &export_folder_ops,
    [EXPORT_MBTILES] = &export_mbtiles_ops,
    [EXPORT_PMTILES] = &export_pmtiles_ops,
};

static int ends_in(const char *path, const char *ending)
{
    size_t length = strlen(path), count = strlen(ending);
    return length > count && !strcmp(path + length - count, ending);
}

enum export_store_kind export_store_kind_of(const char *path)
{
    if (ends_in(path, "/")) return EXPORT_FOLDER;
    if (ends_in(path, ".mbtiles")) return EXPORT_MBTILES;
    return ends_in(path, ".pmtiles") ? EXPORT_PMTILES : EXPORT_STORE_NONE;
}

export_store *export_store_open(const char *path, const export_tiles_about *tiles)
{
    enum export_store_kind kind = export_store_kind_of(path);
    export_store *store = calloc(1, sizeof *store);
    if (!store) {
        bake_fail("out of memory");
        return NULL;
    }
    store->ops = ops_of[kind];
    store->tiles = tiles;
    if (!export_whole_begin(path, kind == EXPORT_FOLDER, &store->whole)) {
        if (!store->ops->open(store)) return store;
        export_whole_end(&store->whole, -1);
    }
    free(store);
    return NULL;
}

int export_store_put(export_store *store, uint32_t zoom, uint32_t x, uint32_t y,
                     const uint8_t *bytes, size_t count)
{
    return store->ops->put(store, zoom, x, y, bytes, count);
}

int export_store_close(export_store *store, int rc)
{
    rc = store->ops->close(store, rc);
    rc = export_whole_end(&store->whole, rc);
    free(store);
    return rc;
}

/* ---- a folder ---- */

static int write_file(const export_store *store, const char *path, const void *bytes, size_t count)
{
    FILE *file = fopen(path, "wb");
    int failed = !file || fwrite(bytes, 1, count, file) != count;
    if (file && fclose(file)) failed = 1;
    return failed ? bake_fail("cannot write %s: %s", store->whole.path, strerror(errno)) : 0;
}

static int folder_open(export_store *store)
{
    (void)store;
    return 0;
}

static int folder_put(export_store *store, uint32_t zoom, uint32_t x, uint32_t y,
                      const uint8_t *bytes, size_t count)
{
    char path[sizeof store->whole.temp + 64];
    int used = snprintf(path, sizeof path, "%s/%u", store->whole.temp, zoom);
    mkdir(path, 0777);
    used += snprintf(path + used, sizeof path - (size_t)used, "/%u", x);
    mkdir(path, 0777);
    snprintf(path + used, sizeof path - (size_t)used, "/%u.%s", y, store->tiles->format);
    return write_file(store, path, bytes, count);
}

static int folder_close(export_store *store, int rc)
{
    char path[sizeof store->whole.temp + 64], pattern[64];
    if (rc) return rc;
    snprintf(path, sizeof path, "%s/%s.json", store->whole.temp,
             store->tiles->layer ? "layer" : "tiles");
    snprintf(pattern, sizeof pattern, "{z}/{x}/{y}.%s", store->tiles->format);
    char *json = export_facts_json(store->tiles, pattern);
    rc = json ? write_file(store, path, json, strlen(json)) : -1;
    free(json);
    return rc;
}

const export_store_ops export_folder_ops = { folder_open, folder_put, folder_close };
