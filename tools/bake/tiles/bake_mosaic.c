#include "bake_mosaic.h"

#include "../bake_say.h"
#include "../raster/bake_colour.h"
#include "../raster/bake_grid_gdal.h"
#include "../raster/bake_rgb.h"
#include "bake_tileset.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RGBA        4
#define SAMPLES_MAX (1e9)           /* 4 GB on the disk */
#define EDGE_M      20037508.342789 /* of Web Mercator, from its middle */
/* The same map with the antimeridian in its middle: what lies beyond the east end of the other one
 * would be looked for at its west end. */
#define MERCATOR_180  "+proj=webmerc +lon_0=180 +datum=WGS84 +units=m +no_defs"
#define TILE_FILE     "/vsimem/farfield-tile"
#define TILE_SIDE_MAX 4096
#define TILE_SIDE_MIN 32 /* of smaller ones a bake takes fewer */

/* What is being put together: pixels of a zoom, from the map's west and north end. */
typedef struct patchwork {
    bake_tileset tiles;
    uint32_t zoom, side;             /* of a tile in pixels; 0: not known yet */
    double west, north, east, south; /* tiles; east may lie beyond the map's east end */
    int64_t left, top;               /* pixels */
    bake_grid *grid;
    uint8_t *pixels; /* of a tile */
    uint64_t found;
} patchwork;

/* ---- one tile ---- */

/* Reads an image of any make, as long as all are of one size. 0 or -1. */
static int read_pixels(patchwork *p, GDALDatasetH set)
{
    int side = GDALGetRasterXSize(set);
    if (side != GDALGetRasterYSize(set) || side > TILE_SIDE_MAX ||
        (p->side && (int)p->side != side))
        return -1;
    p->side = (uint32_t)side;
    if (!p->pixels) p->pixels = malloc((size_t)RGBA * p->side * p->side);
    return p->pixels ? bake_colour_read(set, 0, side, p->pixels) : -1;
}

static int decode(patchwork *p, uint8_t *bytes, size_t count)
{
    static const char *const drivers[] = { "PNG", "WEBP", NULL };
    GDALDatasetH view[1 + BAKE_COLOUR_VIEWS_MAX] = { NULL };
    VSIFCloseL(VSIFileFromMemBuffer(TILE_FILE, bytes, count, FALSE));
    view[0] = GDALOpenEx(TILE_FILE, GDAL_OF_RASTER | GDAL_OF_READONLY, drivers, NULL, NULL);
    int views = view[0] ? bake_colour_views(view[0], TILE_FILE, view + 1) : -1;
    int rc = views < 0 ? -1 : read_pixels(p, view[views]);
    for (int i = views; i > 0; i--) GDALClose(view[i]);
    if (view[0]) GDALClose(view[0]);
    VSIUnlink(TILE_FILE);
    return rc;
}

/* 1: the tile is in p->pixels; 0: there is none; -1 (said). */
static int read_tile(patchwork *p, int64_t x, int64_t y)
{
    uint8_t *bytes = NULL;
    size_t count;
    uint32_t column = (uint32_t)(x & ((1 << p->zoom) - 1));
    int found = bake_tileset_get(&p->tiles, p->zoom, column, (uint32_t)y, &bytes, &count);
    if (found <= 0) return found;
    int rc = decode(p, bytes, count);
    free(bytes);
    if (rc)
        return bake_fail(
            "%s: tile %u/%u/%u is damaged, no PNG or WebP, or unlike the others in size",
            p->tiles.path, p->zoom, column, (unsigned)y);
    p->found++;
    return 1;
}

/* ---- the whole ---- */

static int choose_area(const bake_options *o, patchwork *p)
{
    bake_tiles_area area;
    p->zoom = o->zoom ? o->zoom : p->tiles.zoom_max;
    if (bake_tileset_area(&p->tiles, p->zoom, &area)) return -1;
    p->west = area.west;
    p->north = area.north;
    p->east = area.east + 1.0;
    p->south = area.south + 1.0;
    if (!o->bbox.is_given) return 0;
    double map = (double)(1u << p->zoom), west = bake_tiles_x(o->bbox.west, p->zoom),
           east = bake_tiles_x(o->bbox.east, p->zoom);
    if (east <= west) east += map;
    if (p->east - p->west < map && east <= map) { /* else it may go round */
        west = fmax(west, p->west);
        east = fmin(east, p->east);
    }
    p->west = west;
    p->east = east;
    p->north = fmax(p->north, bake_tiles_y(o->bbox.north, p->zoom));
    p->south = fmin(p->south, bake_tiles_y(o->bbox.south, p->zoom));
    if (p->west < p->east && p->north < p->south) return 0;
    return bake_fail("%s: --bbox lies beside its tiles", o->heights_path);
}

/* Refuses, before they are looked for, more tiles than all samples make. 0 or -1 (said). */
static int check_tiles(const patchwork *p)
{
    double columns = ceil(p->east) - floor(p->west), rows = ceil(p->south) - floor(p->north);
    if (columns * rows <= SAMPLES_MAX / (TILE_SIDE_MIN * TILE_SIDE_MIN)) return 0;
    return bake_fail("%s: %.0f x %.0f tiles of zoom %u are too many: give --bbox W,S,E,N or a "
                     "coarser --zoom",
                     p->tiles.path, columns, rows, p->zoom);
}

/* The first tile that is there tells the size of all. */
static int find_side(patchwork *p)
{
    for (int64_t y = (int64_t)p->north; y < ceil(p->south); y++)
        for (int64_t x = (int64_t)floor(p->west); x < ceil(p->east); x++) {
            int found = read_tile(p, x, y);
            if (found) return found < 0 ? -1 : 0;
        }
    return bake_fail("%s: no tile at zoom %u there; --zoom takes coarser ones", p->tiles.path,
                     p->zoom);
}

static int open_grid(patchwork *p)
{
    double left = floor(p->west * p->side), top = floor(p->north * p->side),
           columns = ceil(p->east * p->side) - left, rows = ceil(p->south * p->side) - top;
    if (columns * rows > SAMPLES_MAX)
        return bake_fail("%s: %.0f x %.0f samples at zoom %u are too many: give --bbox W,S,E,N or "
                         "a coarser --zoom",
                         p->tiles.path, columns, rows, p->zoom);
    p->left = (int64_t)left;
    p->top = (int64_t)top;
    if (bake_grid_open(p->grid, (uint32_t)columns, (uint32_t)rows, RGBA)) return -1;
    if (!ftruncate(p->grid->fd, (off_t)(columns * rows * RGBA))) return 0;
    return bake_fail("cannot make a temporary file: %s", strerror(errno));
}

/* Puts the part of a tile that lies in the grid there. */
static int lay_tile(const patchwork *p, int64_t x, int64_t y)
{
    int64_t left = x * p->side - p->left, top = y * p->side - p->top, first = left < 0 ? -left : 0,
            end = left + p->side > p->grid->width ? p->grid->width - left : p->side;
    for (int64_t j = 0; j < p->side; j++) {
        if (top + j < 0 || top + j >= p->grid->height) continue;
        if (bake_grid_write(p->grid, (uint32_t)(top + j), (uint32_t)(left + first),
                            (uint32_t)(end - first), p->pixels + RGBA * (j * p->side + first)))
            return -1;
    }
    return 0;
}

static int lay_tiles(patchwork *p)
{
    int64_t north = (int64_t)p->north, south = (int64_t)ceil(p->south),
            west = (int64_t)floor(p->west), east = (int64_t)ceil(p->east);
    for (int64_t y = north; y < south; y++) {
        for (int64_t x = west; x < east; x++) {
            int found = read_tile(p, x, y);
            if (found < 0 || (found && lay_tile(p, x, y))) return -1;
        }
        bake_progress("reading", (uint64_t)(y + 1 - north), (uint64_t)(south - north));
    }
    return 0;
}

static int make_set(const patchwork *p, bake_mosaic *mosaic)
{
    mosaic->set = bake_grid_dataset(p->grid, GDT_Byte, RGBA);
    if (!mosaic->set) return -1;
    double pixel = 2 * EDGE_M / (1u << p->zoom) / p->side;
    int crosses = p->east > (double)(1u << p->zoom);
    double west = (double)p->left * pixel - (crosses ? 2 : 1) * EDGE_M;
    double gt[6] = { west, pixel, 0, EDGE_M - (double)p->top * pixel, 0, -pixel };
    OGRSpatialReferenceH srs = OSRNewSpatialReference(NULL);
    if (crosses)
        OSRImportFromProj4(srs, MERCATOR_180);
    else
        OSRImportFromEPSG(srs, 3857);
    GDALSetGeoTransform(mosaic->set, gt);
    GDALSetSpatialRef(mosaic->set, srs);
    OSRDestroySpatialReference(srs);
    GDALSetRasterColorInterpretation(GDALGetRasterBand(mosaic->set, RGBA), GCI_AlphaBand);
    if (*p->tiles.encoding) GDALSetMetadataItem(mosaic->set, "encoding", p->tiles.encoding, NULL);
    if (*p->tiles.name) GDALSetMetadataItem(mosaic->set, "name", p->tiles.name, NULL);
    if (*p->tiles.attribution)
        GDALSetMetadataItem(mosaic->set, "attribution", p->tiles.attribution, NULL);
    return 0;
}

int bake_mosaic_wanted(const bake_options *o)
{
    return !o->raw.width && bake_tileset_kind(o->heights_path) != BAKE_TILES_NONE;
}

int bake_mosaic_open(const bake_options *o, bake_mosaic *mosaic)
{
    *mosaic = (bake_mosaic){ .grid = BAKE_GRID_CLOSED };
    patchwork p = { .grid = &mosaic->grid };
    if (bake_tileset_open(o->heights_path, bake_tileset_kind(o->heights_path), &p.tiles)) return -1;
    int rc = bake_rgb_told(o, p.tiles.encoding) < 0 || choose_area(o, &p) || check_tiles(&p) ||
                     find_side(&p) || open_grid(&p)
                 ? -1
                 : 0;
    p.found = 0;
    if (!rc) rc = lay_tiles(&p);
    if (!rc) rc = make_set(&p, mosaic);
    if (!rc)
        bake_note("%s: %" PRIu64 " tiles of zoom %u, %u x %u samples", o->heights_path, p.found,
                  p.zoom, mosaic->grid.width, mosaic->grid.height);
    free(p.pixels);
    bake_tileset_close(&p.tiles);
    if (rc) bake_mosaic_close(mosaic);
    return rc;
}

void bake_mosaic_close(bake_mosaic *mosaic)
{
    if (mosaic->set) GDALClose(mosaic->set);
    bake_grid_close(&mosaic->grid);
    mosaic->set = NULL;
}
