#include "bake_tileset.h"

#include "../bake_say.h"
#include "bake_json.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define PATH_BYTES    4096
#define MERCATOR_EDGE 85.0511287798066 /* degrees: the map is a square */
#define RADIANS       (M_PI / 180)

double bake_tiles_x(double longitude, uint32_t zoom)
{
    return (longitude + 180) / 360 * (double)(1u << zoom);
}

double bake_tiles_y(double latitude, uint32_t zoom)
{
    latitude = fmin(fmax(latitude, -MERCATOR_EDGE), MERCATOR_EDGE) * RADIANS;
    return (0.5 - asinh(tan(latitude)) / (2 * M_PI)) * (double)(1u << zoom);
}

/* ---- folders ---- */

/* A name that is a whole number up to its end or a dot, else -1. */
static int64_t number_of(const char *name)
{
    size_t digits = strspn(name, "0123456789");
    if (!digits || digits > 9 || (name[digits] && name[digits] != '.')) return -1;
    return strtoll(name, NULL, 10);
}

/* The least and the greatest number among the names in a folder; 0, or -1: there is none. */
static int numbers_in(const char *path, uint32_t *low, uint32_t *high)
{
    DIR *folder = opendir(path);
    int rc = -1;
    if (!folder) return -1;
    for (struct dirent *entry; (entry = readdir(folder));) {
        int64_t number = number_of(entry->d_name);
        if (number < 0) continue;
        if (rc || number < *low) *low = (uint32_t)number;
        if (rc || number > *high) *high = (uint32_t)number;
        rc = 0;
    }
    closedir(folder);
    return rc;
}

static int folder_area(const bake_tileset *set, uint32_t zoom, bake_tiles_area *area)
{
    char path[PATH_BYTES];
    int rc = -1;
    snprintf(path, sizeof path, "%s/%u", set->path, zoom);
    if (numbers_in(path, &area->west, &area->east)) return -1;
    if (area->east >> zoom) return -1;
    for (uint32_t x = area->west; x <= area->east; x++) {
        uint32_t low, high;
        snprintf(path, sizeof path, "%s/%u/%u", set->path, zoom, x);
        if (numbers_in(path, &low, &high)) continue;
        if (rc || low < area->north) area->north = low;
        if (rc || high > area->south) area->south = high;
        rc = 0;
    }
    return rc;
}

static int read_file(const char *path, uint8_t **bytes, size_t *count)
{
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    *bytes = size > 0 && size <= (long)BAKE_TILE_BYTES_MAX ? malloc((size_t)size) : NULL;
    *count = (size_t)size;
    int ok = *bytes && fread(*bytes, 1, *count, file) == *count;
    fclose(file);
    if (ok) return 1;
    free(*bytes);
    return bake_fail("%s: cannot be read, or is no tile", path);
}

static int folder_get(const bake_tileset *set, uint32_t zoom, uint32_t x, uint32_t y,
                      uint8_t **bytes, size_t *count)
{
    static const char *const endings[] = { "png", "webp", "PNG", "WEBP" };
    char path[PATH_BYTES];
    for (size_t e = 0; e < sizeof endings / sizeof *endings; e++) {
        snprintf(path, sizeof path, "%s/%u/%u/%u.%s", set->path, zoom, x, y, endings[e]);
        int found = read_file(path, bytes, count);
        if (found) return found;
    }
    return 0;
}

/* ---- MBTiles ---- */

/* The first row of what a query answers, whose layer is to be released after the feature; NULL:
 * none. */
static OGRFeatureH first_row(const bake_tileset *set, const char *query, OGRLayerH *layer)
{
    *layer = GDALDatasetExecuteSQL(set->table, query, NULL, NULL);
    return *layer ? OGR_L_GetNextFeature(*layer) : NULL;
}

static void release(const bake_tileset *set, OGRFeatureH row, OGRLayerH layer)
{
    if (row) OGR_F_Destroy(row);
    if (layer) GDALDatasetReleaseResultSet(set->table, layer);
}

static void table_text(const bake_tileset *set, const char *name, char *value, size_t room)
{
    char query[100];
    OGRLayerH layer;
    snprintf(query, sizeof query, "SELECT value FROM metadata WHERE name = '%s'", name);
    OGRFeatureH row = first_row(set, query, &layer);
    if (row) snprintf(value, room, "%s", OGR_F_GetFieldAsString(row, 0));
    release(set, row, layer);
}

static int open_table(bake_tileset *set)
{
    static const char *const drivers[] = { "SQLite", NULL };
    char name[PATH_BYTES];
    OGRLayerH layer;
    snprintf(name, sizeof name, "SQLITE:%s", set->path);
    CPLErrorReset();
    set->table = GDALOpenEx(name, GDAL_OF_VECTOR | GDAL_OF_READONLY, drivers, NULL, NULL);
    if (!set->table) return bake_fail_gdal("cannot read %s", set->path);
    OGRFeatureH row = first_row(set, "SELECT max(zoom_level) FROM tiles", &layer);
    int64_t zoom = row && OGR_F_IsFieldSetAndNotNull(row, 0) ? OGR_F_GetFieldAsInteger64(row, 0)
                                                             : -1;
    release(set, row, layer);
    if (zoom < 0 || zoom > BAKE_ZOOM_MAX) return bake_fail("%s: MBTiles without tiles", set->path);
    set->zoom_max = (uint32_t)zoom;
    table_text(set, "encoding", set->encoding, sizeof set->encoding);
    table_text(set, "name", set->name, sizeof set->name);
    table_text(set, "attribution", set->attribution, sizeof set->attribution);
    return 0;
}

/* Rows of MBTiles begin in the south. */
static int table_area(const bake_tileset *set, uint32_t zoom, bake_tiles_area *area)
{
    char query[200];
    OGRLayerH layer;
    int64_t found[4], last = (1 << zoom) - 1;
    snprintf(query, sizeof query,
             "SELECT min(tile_column), max(tile_column), min(tile_row), max(tile_row) FROM tiles "
             "WHERE zoom_level = %u",
             zoom);
    OGRFeatureH row = first_row(set, query, &layer);
    int ok = row && OGR_F_IsFieldSetAndNotNull(row, 0);
    for (int i = 0; i < 4; i++) {
        found[i] = ok ? OGR_F_GetFieldAsInteger64(row, i) : -1;
        ok = ok && found[i] >= 0 && found[i] <= last;
    }
    release(set, row, layer);
    if (!ok) return -1;
    *area = (bake_tiles_area){ (uint32_t)found[0], (uint32_t)(last - found[3]), (uint32_t)found[1],
                               (uint32_t)(last - found[2]) };
    return 0;
}

static int table_get(const bake_tileset *set, uint32_t zoom, uint32_t x, uint32_t y,
                     uint8_t **bytes, size_t *count)
{
    char query[200];
    OGRLayerH layer;
    int found = 0, size = 0;
    snprintf(query, sizeof query,
             "SELECT tile_data FROM tiles WHERE zoom_level = %u AND tile_column = %u AND "
             "tile_row = %u",
             zoom, x, (1u << zoom) - 1 - y);
    OGRFeatureH row = first_row(set, query, &layer);
    const uint8_t *blob = row ? OGR_F_GetFieldAsBinary(row, 0, &size) : NULL;
    if (blob && size > 0 && (unsigned)size <= BAKE_TILE_BYTES_MAX) {
        *bytes = malloc((size_t)size);
        *count = (size_t)size;
        if (*bytes) memcpy(*bytes, blob, *count);
        found = *bytes ? 1 : bake_fail("out of memory");
    }
    release(set, row, layer);
    return found;
}

/* ---- PMTiles ---- */

static int open_pmtiles(bake_tileset *set)
{
    if (bake_pmtiles_open(set->path, &set->pmtiles)) return -1;
    char *json = bake_pmtiles_metadata(&set->pmtiles);
    if (!json) return -1;
    bake_json_text(json, "encoding", set->encoding, sizeof set->encoding);
    bake_json_text(json, "name", set->name, sizeof set->name);
    bake_json_text(json, "attribution", set->attribution, sizeof set->attribution);
    free(json);
    set->zoom_max = set->pmtiles.head.zoom_max;
    return 0;
}

static uint32_t tile_at(double at, uint32_t zoom)
{
    return (uint32_t)fmin(fmax(floor(at), 0), (1u << zoom) - 1.0);
}

/* The header tells where tiles are; one whose bounds are none (many have zeros there): anywhere. */
static int pmtiles_area(const bake_pm_header *file, uint32_t zoom, bake_tiles_area *area)
{
    if (zoom < file->zoom_min || zoom > file->zoom_max) return -1;
    if (!(file->west < file->east && file->south < file->north)) {
        *area = (bake_tiles_area){ 0, 0, (1u << zoom) - 1, (1u << zoom) - 1 };
        return 0;
    }
    *area = (bake_tiles_area){ tile_at(bake_tiles_x(file->west, zoom), zoom),
                               tile_at(bake_tiles_y(file->north, zoom), zoom),
                               tile_at(bake_tiles_x(file->east, zoom) - 1e-9, zoom),
                               tile_at(bake_tiles_y(file->south, zoom) - 1e-9, zoom) };
    return 0;
}

/* ---- all of them ---- */

enum bake_tiles_kind bake_tileset_kind(const char *path)
{
    struct stat status;
    char below[PATH_BYTES];
    uint32_t low, high;
    size_t length = strlen(path);
    if (stat(path, &status)) return BAKE_TILES_NONE;
    if (S_ISDIR(status.st_mode)) {
        if (numbers_in(path, &low, &high)) return BAKE_TILES_NONE;
        snprintf(below, sizeof below, "%s/%u", path, high);
        return numbers_in(below, &low, &high) ? BAKE_TILES_NONE : BAKE_TILES_FOLDER;
    }
    if (bake_pmtiles_is(path)) return BAKE_TILES_PM;
    return length > 8 && EQUAL(path + length - 8, ".mbtiles") ? BAKE_TILES_MB : BAKE_TILES_NONE;
}

int bake_tileset_open(const char *path, enum bake_tiles_kind kind, bake_tileset *set)
{
    uint32_t low;
    int rc = 0;
    *set = (bake_tileset){ .kind = kind, .path = path, .pmtiles = { .fd = -1 } };
    if (kind == BAKE_TILES_PM) rc = open_pmtiles(set);
    if (kind == BAKE_TILES_MB) rc = open_table(set);
    if (kind == BAKE_TILES_FOLDER &&
        (numbers_in(path, &low, &set->zoom_max) || set->zoom_max > BAKE_ZOOM_MAX))
        rc = bake_fail("%s: its folders are no zooms up to %d", path, BAKE_ZOOM_MAX);
    if (rc) bake_tileset_close(set);
    return rc;
}

void bake_tileset_close(bake_tileset *set)
{
    bake_pmtiles_close(&set->pmtiles);
    if (set->table) GDALClose(set->table);
    set->table = NULL;
}

int bake_tileset_area(const bake_tileset *set, uint32_t zoom, bake_tiles_area *area)
{
    int rc = set->kind == BAKE_TILES_PM   ? pmtiles_area(&set->pmtiles.head, zoom, area)
             : set->kind == BAKE_TILES_MB ? table_area(set, zoom, area)
                                          : folder_area(set, zoom, area);
    if (rc || area->south >> zoom || area->east < area->west || area->south < area->north)
        return bake_fail("%s: no tiles at zoom %u; the finest is %u", set->path, zoom,
                         set->zoom_max);
    return 0;
}

int bake_tileset_get(bake_tileset *set, uint32_t zoom, uint32_t x, uint32_t y, uint8_t **bytes,
                     size_t *count)
{
    if (set->kind == BAKE_TILES_PM)
        return bake_pmtiles_get(&set->pmtiles, zoom, x, y, bytes, count);
    if (set->kind == BAKE_TILES_MB) return table_get(set, zoom, x, y, bytes, count);
    return folder_get(set, zoom, x, y, bytes, count);
}
