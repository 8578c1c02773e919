#include "export_pyramid.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_area.h"
#include "../bake/tiles/bake_tileset.h"
#include "export_about.h"
#include "export_fit.h"
#include "export_store.h"
#include "export_view.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIDE          EXPORT_TILE_SIDE
#define RIM           1 /* of its neighbours' pixels, round a tile that is judged */
#define WIDE          (SIDE + 2 * RIM)
#define EDGE_M        20037508.342789244 /* of Web Mercator, from its middle */
#define EARTH_ROUND_M (2 * EDGE_M)
#define EPSG_MERCATOR 3857
#define LARGEST_PIXEL 1.1 /* of samples, at the finest zoom by default */
#define LATITUDE_MAX  85.0511287798066

/* All of one export of tiles. */
typedef struct pyramid {
    const export_ground *ground;
    export_view view;
    export_paint paint;
    export_store *store;
    export_tiles_about about;
    double west, north, east, south; /* the ground, in tiles of zoom 0; east may be beyond 1 */
    uint32_t zoom_low, zoom_high;
    export_tile *tile[EXPORT_ZOOM_MAX + 1]; /* one being made at each zoom */
    float wide[WIDE * WIDE]; /* the one of the finest zoom with a rim of its neighbours: heights */
    uint8_t wide_mask[WIDE * WIDE];
    export_fit fit[EXPORT_ZOOM_MAX + 1];
    uint64_t written, bytes, finest, finest_all; /* tiles; those of the finest zoom, about */
} pyramid;

/* ---- which tiles ---- */

/* 1 when a tile meets the box that holds the ground, which may go round the map's end. */
static int meets(const pyramid *p, uint32_t zoom, uint32_t x, uint32_t y)
{
    double size = 1 / (double)(1u << zoom), top = y * size, left = x * size;
    if (top >= p->south || top + size <= p->north) return 0;
    for (int turn = 0; turn <= 1; turn++)
        if (left + turn < p->east && left + size + turn > p->west) return 1;
    return 0;
}

static void place_tile(uint32_t zoom, uint32_t x, uint32_t y, double geotransform[6])
{
    double pixel = EARTH_ROUND_M / ((double)(1u << zoom) * SIDE);
    geotransform[0] = (double)x * SIDE * pixel - EDGE_M;
    geotransform[1] = pixel;
    geotransform[3] = EDGE_M - (double)y * SIDE * pixel;
    geotransform[5] = -pixel;
    geotransform[2] = geotransform[4] = 0;
}

/* ---- making tiles ---- */

static int measure_tile(pyramid *p, uint32_t zoom, const double geotransform[6])
{
    export_patch patch = { p->tile[zoom]->value[0], p->tile[zoom]->mask, SIDE, 0 };
    if (zoom == p->zoom_high) patch = (export_patch){ p->wide, p->wide_mask, WIDE, RIM };
    return export_fit_add(&p->view, &p->paint, &patch, geotransform,
                          (double)SIDE * (double)(1u << zoom), 1u << (p->zoom_high - zoom),
                          &p->fit[zoom]);
}

static int write_tile(pyramid *p, uint32_t zoom, uint32_t x, uint32_t y)
{
    double geotransform[6];
    size_t count;
    place_tile(zoom, x, y, geotransform);
    if (p->paint.encoding && measure_tile(p, zoom, geotransform)) return -1;
    uint8_t *bytes = export_tile_paint(&p->paint, p->tile[zoom], &count);
    if (!bytes) return -1;
    int rc = export_store_put(p->store, zoom, x, y, bytes, count);
    VSIFree(bytes);
    p->written++;
    p->bytes += count;
    return rc;
}

static int read_wide(pyramid *p, export_tile *tile, const double geotransform[6])
{
    double wide[6];
    memcpy(wide, geotransform, sizeof wide);
    wide[0] -= RIM * wide[1];
    wide[3] -= RIM * wide[5];
    if (export_view_read(&p->view, wide, WIDE, WIDE, p->wide, p->wide_mask) < 0) return -1;
    for (size_t j = 0; j < SIDE; j++) {
        size_t from = (j + RIM) * WIDE + RIM;
        memcpy(tile->value[0] + j * SIDE, p->wide + from, SIDE * sizeof *p->wide);
        memcpy(tile->mask + j * SIDE, p->wide_mask + from, SIDE);
    }
    return 0;
}

/* 1, or 0: the tile has no ground; -1 (said). */
static int project_tile(pyramid *p, export_tile *tile, const double geotransform[6])
{
    int rc = p->paint.encoding ? read_wide(p, tile, geotransform)
                               : export_view_read(&p->view, geotransform, SIDE, SIDE,
                                                  tile->value[0], tile->mask) < 0;
    if (rc) return -1;
    for (size_t i = 0; i < EXPORT_TILE_CELLS; i++)
        if (!export_tile_is_void(&p->paint, tile->mask[i])) return 1;
    return 0;
}

/* Makes and writes a tile and all below it. 1: it has ground; 0: it has none; -1 (said). */
static int make_tile(pyramid *p, uint32_t zoom, uint32_t x, uint32_t y);

/* Has all children made; at the zooms that are written their parent, too, which is what lies
 * nearest where a child has no ground. */
static int make_children(pyramid *p, uint32_t zoom, uint32_t x, uint32_t y)
{
    double geotransform[6];
    export_tile *tile = p->tile[zoom];
    int found = 0, have[4];
    for (uint32_t q = 0; q < 4; q++) {
        have[q] = make_tile(p, zoom + 1, 2 * x + (q & 1), 2 * y + (q >> 1));
        if (have[q] < 0) return -1;
        found |= have[q];
        if (zoom < p->zoom_low) continue;
        if (have[q])
            export_tile_shrink(&p->paint, p->tile[zoom + 1], (int)q, tile);
        else
            export_tile_clear(tile, (int)q);
    }
    if (!found || zoom < p->zoom_low) return found;
    place_tile(zoom, x, y, geotransform);
    if (export_view_reach(&p->view, geotransform, SIDE, SIDE, tile->value[0])) return -1;
    return found;
}

static int make_tile(pyramid *p, uint32_t zoom, uint32_t x, uint32_t y)
{
    double geotransform[6];
    int found;
    if (!meets(p, zoom, x, y)) return 0;
    if (zoom < p->zoom_high) {
        found = make_children(p, zoom, x, y);
    } else {
        place_tile(zoom, x, y, geotransform);
        found = project_tile(p, p->tile[zoom], geotransform);
        p->finest++;
        if (p->finest < p->finest_all) bake_progress("tiles", p->finest, p->finest_all);
    }
    if (found <= 0 || zoom < p->zoom_low) return found;
    return write_tile(p, zoom, x, y) ? -1 : 1;
}

/* ---- zooms and places ---- */

/* How large a point of the ground's lattice is in pixels of a zoom, in its middle. */
static double point_px(const pyramid *p, const export_bounds *b, uint32_t zoom)
{
    double latitude = fmin(fabs(b->south + b->north) / 2, LATITUDE_MAX);
    double pixel_m = EARTH_ROUND_M * cos(latitude * M_PI / 180) / ((double)(1u << zoom) * SIDE);
    return p->ground->lattice.spacing_m / pixel_m;
}

static int choose_zooms(const export_options *o, const export_bounds *b, pyramid *p)
{
    p->zoom_high = 0;
    while (p->zoom_high < EXPORT_ZOOM_MAX && point_px(p, b, p->zoom_high) * LARGEST_PIXEL < 1)
        p->zoom_high++;
    double extent = fmax(p->east - p->west, p->south - p->north);
    while (p->zoom_low < p->zoom_high && extent * (double)(2u << p->zoom_low) <= 1) p->zoom_low++;
    if (o->zooms.is_given) {
        p->zoom_low = o->zooms.low;
        p->zoom_high = o->zooms.high;
    }
    double across = (p->east - p->west) * (double)(1u << p->zoom_high),
           down = (p->south - p->north) * (double)(1u << p->zoom_high),
           all = ceil(across) * ceil(down);
    if (all * EXPORT_TILE_CELLS > BAKE_SAMPLES_MAX)
        return bake_fail("%.0f tiles of zoom %u are too many: give coarser ones by --zoom A-B, or "
                         "--region",
                         all, p->zoom_high);
    p->finest_all = (uint64_t)all;
    return 0;
}

static int choose_box(const export_options *o, pyramid *p)
{
    const double *gt = p->ground->geotransform;
    const export_bounds plane = { gt[0], gt[3] + gt[5] * p->ground->window.height,
                                  gt[0] + gt[1] * p->ground->window.width, gt[3] };
    export_bounds b;
    if (export_place_degrees(p->ground->srs, &plane, &b)) return -1;
    if (b.south >= LATITUDE_MAX || b.north <= -LATITUDE_MAX)
        return bake_fail("%s: too near a pole for map tiles of Web Mercator",
                         p->ground->unpack->path);
    p->west = bake_tiles_x(b.west, 0);
    p->east = bake_tiles_x(b.east, 0);
    p->north = bake_tiles_y(b.north, 0);
    p->south = bake_tiles_y(b.south, 0);
    if (choose_zooms(o, &b, p)) return -1;
    p->about.bounds = b;
    return 0;
}

/* Colours of Terrain-RGB pack a third smaller: they do where the pack's own steps are no finer. */
static const export_encoding *choose_encoding(const export_options *o, const ff_terrain_info *info)
{
    double step_m = ff_steps_wu(info, UINT16_MAX) / (double)FF_WU_PER_METRE / UINT16_MAX;
    int is_fine = step_m < export_encoding_mapbox.step_m;
    if (o->encoding == EXPORT_MAPBOX || (o->encoding == EXPORT_AUTO && !is_fine))
        return &export_encoding_mapbox;
    return &export_encoding_terrarium;
}

static void choose_paint(const export_options *o, const ff_terrain_info *info, export_paint *paint)
{
    *paint = (export_paint){ .jpeg_quality = (int)o->jpeg_quality };
    if (o->images) {
        paint->is_jpeg = o->picture == EXPORT_JPEG;
        paint->clear_beyond = !paint->is_jpeg;
        return;
    }
    paint->encoding = choose_encoding(o, info);
    paint->clear_beyond = paint->clear_filled = o->voids == EXPORT_VOIDS_NODATA;
}

int export_pyramid_check(const export_options *o, const ff_terrain_info *info)
{
    export_paint paint;
    int64_t range_wu[2];
    choose_paint(o, info, &paint);
    ff_terrain_range_wu(info, range_wu);
    double low = (double)range_wu[0] / FF_WU_PER_METRE,
           high = (double)(range_wu[1] + 1) / FF_WU_PER_METRE;
    if (!paint.encoding || export_encoding_holds(paint.encoding, low, high)) return 0;
    return bake_fail("heights of %.0f to %.0f m do not fit --encoding %s", low, high,
                     paint.encoding->name);
}

/* ---- what is said of them ---- */

/* The bound of the finest zoom, as far as it is measured; else no height is beyond the ground's. */
static void tell_error(pyramid *p)
{
    export_about *about = &p->about.about;
    const export_fit *fit = &p->fit[p->zoom_high];
    if (!p->paint.encoding) return;
    double quantised_m = p->paint.encoding->step_m / 2;
    about->error_m = fmax(p->ground->error.between_m, p->ground->error.samples_m) + quantised_m +
                     (fit->count ? fit->worst_m : p->ground->high - p->ground->low);
    export_about_add(about, "; encoded within %.2g m", quantised_m);
    export_fit_tell(p->fit, p->zoom_low, p->zoom_high, about);
}

static int open_view(pyramid *p)
{
    OGRSpatialReferenceH mercator = OSRNewSpatialReference(NULL);
    OSRImportFromEPSG(mercator, EPSG_MERCATOR);
    OSRSetAxisMappingStrategy(mercator, OAMS_TRADITIONAL_GIS_ORDER);
    int rc = export_view_open(p->ground, mercator, &p->view);
    OSRDestroySpatialReference(mercator);
    return rc;
}

static int make_tiles(const export_options *o, pyramid *p)
{
    int rc = 0;
    for (uint32_t z = 0; !rc && z <= p->zoom_high; z++) {
        p->tile[z] = malloc(sizeof **p->tile);
        if (!p->tile[z]) rc = bake_fail("out of memory");
        if (!rc) p->tile[z]->bands = p->ground->bands;
    }
    if (!rc) p->store = export_store_open(o->out_path, &p->about);
    if (!rc && !p->store) rc = -1;
    if (p->store) {
        rc = make_tile(p, 0, 0, 0) < 0 ? -1 : 0;
        if (!rc && !p->written)
            rc = bake_fail("zoom %u has no pixel on the ground: give finer ones by --zoom A-B",
                           p->zoom_high);
        bake_progress("tiles", p->finest_all, p->finest_all);
        tell_error(p);
        rc = export_store_close(p->store, rc);
    }
    for (uint32_t z = 0; z <= p->zoom_high; z++) free(p->tile[z]);
    return rc;
}

int export_pyramid_write(const export_options *o, const export_ground *ground)
{
    pyramid *p = calloc(1, sizeof *p);
    if (!p) return bake_fail("out of memory");
    p->ground = ground;
    choose_paint(o, &ground->unpack->pack.header.info, &p->paint);
    export_about_ground(ground, &p->about.about);
    int rc = open_view(p);
    if (!rc) rc = choose_box(o, p);
    p->about.format = p->paint.is_jpeg ? "jpg" : "png";
    p->about.encoding = p->paint.encoding ? p->paint.encoding->name : NULL;
    p->about.side = SIDE;
    p->about.zoom_min = p->zoom_low;
    p->about.zoom_max = p->zoom_high;
    if (!rc) rc = make_tiles(o, p);
    export_view_close(&p->view);
    if (!rc)
        bake_note("%s: %" PRIu64 " tiles of zooms %u to %u, %" PRIu64 " bytes%s%s", o->out_path,
                  p->written, p->zoom_low, p->zoom_high, p->bytes,
                  *p->about.about.error ? "; " : "", p->about.about.error);
    free(p);
    return rc;
}
