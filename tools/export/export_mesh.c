#include "export_mesh.h"

#include "../bake/bake_say.h"
#include "export_gzip.h"
#include "export_mesh_tile.h"
#include "export_store.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LAYER_BYTES      6000
#define ERROR_OF_SPACING (1.0 / 8) /* --mesh-error by default, of the spacing of samples */

/* What became of a zoom. */
typedef struct zoom_sum {
    uint64_t tiles, bytes, vertices;
} zoom_sum;

/* All of one export of meshes. */
typedef struct mesh_export {
    const export_options *options;
    const export_ground *ground;
    mesh_ground points;
    mesh_probes probes;
    double error_m; /* of the finest zoom's meshes */
    mesh_tile *tile;
    export_store *store;
    export_tiles_about about;
    char layer[LAYER_BYTES]; /* what layer.json says besides */
    size_t used;             /* of it */
    zoom_sum zoom[EXPORT_ZOOM_MAX + 1];
    export_fit fit[EXPORT_ZOOM_MAX + 1];
} mesh_export;

int export_mesh_check(const export_options *o)
{
    if (o->images) return bake_fail("--mesh makes heights, not --images");
    if (o->voids == EXPORT_VOIDS_NODATA)
        return bake_fail("--mesh has no voids: leave --voids nodata out");
    if (o->zooms.is_given && o->zooms.low)
        return bake_fail("--mesh begins at zoom 0: --zoom 0-%u", o->zooms.high);
    if (export_store_kind_of(o->out_path) == EXPORT_FOLDER) return 0;
    return bake_fail("%s: --mesh makes a folder: end its name in a slash", o->out_path);
}

/* ---- tiles ---- */

static double error_of(const mesh_export *m, uint32_t zoom)
{
    return ldexp(m->error_m, (int)(m->points.zoom - zoom));
}

static int put_tile(mesh_export *m, uint32_t zoom, uint32_t x, uint32_t y)
{
    const quantized_mesh *mesh = &m->tile->mesh;
    zoom_sum *sum = &m->zoom[zoom];
    uint8_t *bytes = malloc(quantized_mesh_room(mesh)), *packed = NULL;
    if (!bytes) return bake_fail("out of memory");
    size_t count = quantized_mesh_encode(mesh, bytes);
    if (m->options->gzip) packed = export_gzip(bytes, count, &count);
    int rc = m->options->gzip && !packed ? -1
                                         : export_store_put(m->store, zoom, x % (2u << zoom), y,
                                                            packed ? packed : bytes, count);
    free(packed);
    free(bytes);
    sum->tiles++;
    sum->bytes += count;
    sum->vertices += mesh->vertex_count;
    return rc;
}

static int make_tile(mesh_export *m, const mesh_range *range, uint32_t zoom, uint32_t x, uint32_t y)
{
    mesh_tile *tile = m->tile;
    if (mesh_tile_make(&m->points, range, zoom, x, y, (float)error_of(m, zoom), m->options->normals,
                       tile))
        return -1;
    mesh_surface surface = { tile->rtin.index, tile->rtin.triangle_count, tile->decoded,
                             tile->block };
    if (mesh_probes_measure(&m->probes, &m->points, zoom, x, y, &surface, &m->fit[zoom])) return -1;
    return put_tile(m, zoom, x, y);
}

static int make_zoom(mesh_export *m, uint32_t zoom)
{
    mesh_range range = mesh_ground_range(&m->points, zoom);
    for (uint32_t y = range.south; y <= range.north; y++) {
        for (uint32_t x = range.west; x <= range.east; x++)
            if (make_tile(m, &range, zoom, x, y)) return -1;
        bake_progress("meshes", y - range.south + 1, range.north - range.south + 1);
    }
    return 0;
}

/* ---- what is said ---- */

static void add(mesh_export *m, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add(mesh_export *m, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int count = vsnprintf(m->layer + m->used, sizeof m->layer - m->used, format, args);
    va_end(args);
    if (count > 0 && m->used + (size_t)count < sizeof m->layer) m->used += (size_t)count;
}

/* The tiles of a zoom that there are; those beyond 180 degrees are told apart. */
static void add_available(mesh_export *m, uint32_t zoom)
{
    mesh_range r = mesh_ground_range(&m->points, zoom);
    uint32_t round = 2u << zoom, east = r.east < round ? r.east : round - 1;
    add(m, "%s[{\"startX\": %u, \"startY\": %u, \"endX\": %u, \"endY\": %u}", zoom ? ", " : "",
        r.west, r.south, east, r.north);
    if (r.east >= round)
        add(m, ", {\"startX\": 0, \"startY\": %u, \"endX\": %u, \"endY\": %u}", r.south,
            r.east - round, r.north);
    add(m, "]");
}

/* How far a zoom's meshes are from the pack's source: measured at samples, else all that lies
 * between heights, of which 0 is one; and what the pack may be off itself. */
static double bound_of(const mesh_export *m, uint32_t zoom)
{
    const export_ground *ground = m->ground;
    double between_m = fmax(ground->high, 0) - fmin(ground->low, 0);
    return fmax(ground->error.between_m, ground->error.samples_m) +
           (m->fit[zoom].count ? m->fit[zoom].worst_m : between_m);
}

static void describe_layer(mesh_export *m)
{
    add(m, "\"version\": \"1.0.0\", \"scheme\": \"tms\", \"projection\": \"EPSG:4326\", ");
    if (m->options->normals) add(m, "\"extensions\": [\"octvertexnormals\"], ");
    if (m->options->gzip) add(m, "\"encoding\": \"gzip\", ");
    add(m, "\"errors_m\": [");
    for (uint32_t z = 0; z <= m->points.zoom; z++) {
        add(m, "%s", z ? ", " : "");
        if (m->fit[z].count)
            add(m, "%.4g", bound_of(m, z));
        else
            add(m, "null");
    }
    add(m, "], \"available\": [");
    for (uint32_t z = 0; z <= m->points.zoom; z++) add_available(m, z);
    add(m, "]");
    m->about.layer = m->layer;
}

static void tell_errors(mesh_export *m)
{
    export_about *about = &m->about.about;
    about->error_m = bound_of(m, m->points.zoom);
    export_fit_tell(m->fit, 0, m->points.zoom, about);
    describe_layer(m);
}

static void note(const mesh_export *m)
{
    uint64_t tiles = 0, bytes = 0, vertices = 0;
    for (uint32_t z = 0; z <= m->points.zoom; z++) {
        tiles += m->zoom[z].tiles;
        bytes += m->zoom[z].bytes;
        vertices += m->zoom[z].vertices;
    }
    bake_note("%s: %" PRIu64 " meshes of zooms 0 to %u, %" PRIu64 " vertices, %" PRIu64
              " bytes%s; %s",
              m->options->out_path, tiles, m->points.zoom, vertices, bytes,
              m->options->gzip ? " in gzip: serve them with Content-Encoding: gzip" : "",
              m->about.about.error);
}

/* ---- all of it ---- */

static void describe(mesh_export *m)
{
    export_about_ground(m->ground, &m->about.about);
    m->about.format = "terrain";
    m->about.layer = m->layer;
    m->about.zoom_max = m->points.zoom;
    m->about.bounds = m->points.bounds;
}

static int make_all(mesh_export *m)
{
    m->tile = malloc(sizeof *m->tile);
    if (!m->tile) return bake_fail("out of memory");
    m->store = export_store_open(m->options->out_path, &m->about);
    if (!m->store) return -1;
    int rc = 0;
    for (uint32_t z = 0; !rc && z <= m->points.zoom; z++) rc = make_zoom(m, z);
    if (!rc) tell_errors(m);
    return export_store_close(m->store, rc);
}

int export_mesh_write(const export_options *o, const export_ground *ground)
{
    mesh_export *m = calloc(1, sizeof *m);
    if (!m) return bake_fail("out of memory");
    m->options = o;
    m->ground = ground;
    m->error_m = o->mesh_error_m > 0
                     ? o->mesh_error_m
                     : fmax(ground->lattice.spacing_m * ERROR_OF_SPACING, ground->error.samples_m);
    uint32_t zoom = o->zooms.is_given ? o->zooms.high : mesh_ground_zoom(ground);
    int rc = mesh_ground_open(ground, zoom, &m->points);
    if (!rc) {
        rc = mesh_probes_open(&m->points, &m->probes);
        if (!rc) describe(m);
        if (!rc) rc = make_all(m);
        if (!rc) note(m);
        mesh_probes_close(&m->probes);
        mesh_ground_close(&m->points);
    }
    free(m->tile);
    free(m);
    return rc;
}
