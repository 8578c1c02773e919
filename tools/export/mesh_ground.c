#include "mesh_ground.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_area.h"
#include "export_options.h"

#include <math.h>
#include <stdlib.h>

#define LARGEST_CELL 1.1         /* of samples, at the finest zoom */
#define DEGREE_M     111194.9266 /* of a meridian */
#define EPSG_WGS84   4326

double mesh_ground_cell(uint32_t zoom) { return 180 / ldexp(MESH_CELLS, (int)zoom); }

uint32_t mesh_ground_zoom(const export_ground *ground)
{
    uint32_t zoom = 0;
    while (zoom < EXPORT_ZOOM_MAX &&
           mesh_ground_cell(zoom) * DEGREE_M > LARGEST_CELL * ground->lattice.spacing_m)
        zoom++;
    return zoom;
}

/* ---- projecting ---- */

static void place_tile(uint32_t zoom, uint32_t x, uint32_t y, double geotransform[6])
{
    double cell = mesh_ground_cell(zoom);
    geotransform[0] = -180 + cell * ((double)x * MESH_CELLS - 0.5);
    geotransform[1] = cell;
    geotransform[3] = -90 + cell * ((double)(y + 1) * MESH_CELLS + 0.5);
    geotransform[5] = -cell;
    geotransform[2] = geotransform[4] = 0;
}

static int project_tile(mesh_ground *g, uint32_t x, uint32_t y)
{
    static float height[MESH_POINTS];
    static uint8_t mask[MESH_POINTS];
    double geotransform[6];
    place_tile(g->zoom, x, y, geotransform);
    if (export_view_read(&g->view, geotransform, MESH_SIDE, MESH_SIDE, height, mask) < 0) return -1;
    for (int i = 0; i < MESH_POINTS; i++)
        if (mask[i] == EXPORT_BEYOND) height[i] = NAN;
    for (uint32_t row = 0; row < MESH_SIDE; row++)
        if (bake_grid_write(&g->points, (y - g->range.south) * MESH_CELLS + MESH_CELLS - row,
                            (x - g->range.west) * MESH_CELLS, MESH_SIDE, height + row * MESH_SIDE))
            return -1;
    return 0;
}

static int project_all(mesh_ground *g)
{
    uint32_t rows = g->range.north - g->range.south + 1;
    for (uint32_t y = g->range.south; y <= g->range.north; y++) {
        for (uint32_t x = g->range.west; x <= g->range.east; x++)
            if (project_tile(g, x, y)) return -1;
        bake_progress("projecting", y - g->range.south + 1, rows);
    }
    return 0;
}

/* Which tiles of the finest zoom the bounds meet. 0 or -1 (said). */
static int find_range(mesh_ground *g)
{
    double tile = 180 / ldexp(1, (int)g->zoom), most = ldexp(1, (int)g->zoom);
    double west = floor((g->bounds.west + 180) / tile), east = floor((g->bounds.east + 180) / tile),
           south = floor((g->bounds.south + 90) / tile),
           north = floor((g->bounds.north + 90) / tile);
    east = fmin(east, west + 2 * most - 1);
    double points = (east - west + 1) * (north - south + 1) * MESH_POINTS;
    if (points > BAKE_SAMPLES_MAX)
        return bake_fail("%.3g points of zoom %u are too many: give a coarser --zoom 0-B, or "
                         "--region",
                         points, g->zoom);
    g->range = (mesh_range){ (uint32_t)west, (uint32_t)fmax(south, 0), (uint32_t)east,
                             (uint32_t)fmin(north, most - 1) };
    return 0;
}

static int open_view(const export_ground *ground, export_view *view)
{
    OGRSpatialReferenceH degrees = OSRNewSpatialReference(NULL);
    OSRImportFromEPSG(degrees, EPSG_WGS84);
    OSRSetAxisMappingStrategy(degrees, OAMS_TRADITIONAL_GIS_ORDER);
    int rc = export_view_open(ground, degrees, view);
    OSRDestroySpatialReference(degrees);
    return rc;
}

int mesh_ground_open(const export_ground *ground, uint32_t zoom, mesh_ground *g)
{
    const double *gt = ground->geotransform;
    export_bounds plane = { gt[0], gt[3] + gt[5] * ground->window.height,
                            gt[0] + gt[1] * ground->window.width, gt[3] };
    *g = (mesh_ground){ .zoom = zoom, .points = BAKE_GRID_CLOSED };
    if (open_view(ground, &g->view)) return -1;
    int rc = export_place_degrees(ground->srs, &plane, &g->bounds);
    if (!rc) rc = find_range(g);
    if (!rc)
        rc = bake_grid_open(&g->points, (g->range.east - g->range.west + 1) * MESH_CELLS + 1,
                            (g->range.north - g->range.south + 1) * MESH_CELLS + 1, sizeof(float));
    if (!rc) rc = project_all(g);
    if (rc) mesh_ground_close(g);
    return rc;
}

void mesh_ground_close(mesh_ground *g)
{
    bake_grid_close(&g->points);
    export_view_close(&g->view);
}

/* ---- reading ---- */

mesh_range mesh_ground_range(const mesh_ground *g, uint32_t zoom)
{
    uint32_t down = g->zoom - zoom;
    mesh_range range = { g->range.west >> down, g->range.south >> down, g->range.east >> down,
                         g->range.north >> down };
    uint32_t round = 2u << zoom;
    if (!zoom) range.east = range.west + 1;
    if (range.east >= range.west + round) range.east = range.west + round - 1;
    return range;
}

/* One row of a block, from the row of points that it is part of. */
static int read_row(const mesh_ground *g, uint32_t down, int64_t first, int64_t row, float *room,
                    float *out)
{
    int64_t width = g->points.width;
    for (int i = 0; i < MESH_BLOCK_SIDE; i++) out[i] = NAN;
    int64_t low = first < 0 ? 0 : first, high = first + ((int64_t)(MESH_BLOCK_SIDE - 1) << down);
    if (high > width - 1) high = width - 1;
    if (row < 0 || row >= g->points.height || low > high) return 0;
    if (bake_grid_read(&g->points, (uint32_t)row, (uint32_t)low, (uint32_t)(high - low + 1), room))
        return -1;
    for (int i = 0; i < MESH_BLOCK_SIDE; i++) {
        int64_t column = first + ((int64_t)i << down);
        if (column >= low && column <= high) out[i] = room[column - low];
    }
    return 0;
}

int mesh_ground_read(const mesh_ground *g, uint32_t zoom, uint32_t x, uint32_t y,
                     float block[MESH_BLOCK_SIDE * MESH_BLOCK_SIDE])
{
    uint32_t down = g->zoom - zoom;
    int64_t apart = (int64_t)1 << down;
    int64_t left = ((int64_t)x * MESH_CELLS - 1) * apart - (int64_t)g->range.west * MESH_CELLS,
            bottom = ((int64_t)y * MESH_CELLS - 1) * apart - (int64_t)g->range.south * MESH_CELLS;
    float *room = malloc(g->points.width * sizeof *room);
    int rc = room ? 0 : bake_fail("out of memory");
    for (int j = 0; !rc && j < MESH_BLOCK_SIDE; j++)
        rc = read_row(g, down, left, bottom + j * apart, room, block + j * MESH_BLOCK_SIDE);
    free(room);
    return rc;
}
