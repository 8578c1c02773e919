#include "mesh_probes.h"

#include "../bake/bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PROBES_MAX 400000.0
#define OUTSIDE    1e-6 /* of a triangle: still in it */

/* ---- taking them ---- */

/* Brings the samples of a row among the points of the finest zoom. */
static int place_row(const mesh_ground *g, uint32_t row, uint32_t stride, uint32_t count, double *x,
                     double *y, int *ok)
{
    double round = 360 / mesh_ground_cell(g->zoom);
    double *z = calloc(count, sizeof *z);
    if (!z) return bake_fail("out of memory");
    for (uint32_t i = 0; i < count; i++) {
        x[i] = i * stride + 0.5;
        y[i] = row + 0.5;
    }
    GDALGenImgProjTransform(g->view.transform, FALSE, (int)count, x, y, z, ok);
    for (uint32_t i = 0; i < count; i++) {
        x[i] -= 0.5 + round * floor((x[i] + round / 4) / round);
        y[i] = g->points.height - 0.5 - y[i];
    }
    free(z);
    return 0;
}

/* Tells the view that its cells are the points of the finest zoom. */
static void aim(const mesh_ground *g)
{
    double cell = mesh_ground_cell(g->zoom);
    double to[6] = { -180 + cell * (g->range.west * (double)MESH_CELLS - 0.5),       cell, 0,
                     -90 + cell * ((g->range.north + 1) * (double)MESH_CELLS + 0.5), 0,    -cell };
    GDALSetGenImgProjTransformerDstGeoTransform(g->view.transform, to);
}

static int take_row(const mesh_ground *g, uint32_t row, uint32_t stride, uint32_t count,
                    mesh_probe *probe, uint32_t *taken)
{
    const export_ground *ground = g->view.ground;
    double *x = malloc(2 * count * sizeof *x);
    int *ok = calloc(count, sizeof *ok);
    uint16_t *steps = malloc(ground->cells.width * sizeof *steps);
    int rc = x && ok && steps ? 0 : bake_fail("out of memory");
    if (!rc) rc = place_row(g, row, stride, count, x, x + count, ok);
    if (!rc) rc = bake_grid_read(&ground->cells, row, 0, ground->cells.width, steps);
    for (uint32_t i = 0; !rc && i < count; i++) {
        double px = x[i], py = x[count + i];
        if (!ok[i] ||
            !(px >= 0 && py >= 0 && px < g->points.width - 1 && py < g->points.height - 1))
            continue;
        probe[(*taken)++] =
            (mesh_probe){ px, py, (float)(steps[i * stride] * ground->scale + ground->offset) };
    }
    free(x);
    free(ok);
    free(steps);
    return rc;
}

static uint32_t tile_of(const mesh_probes *p, const mesh_probe *probe)
{
    return (uint32_t)(probe->y / MESH_CELLS) * p->columns + (uint32_t)(probe->x / MESH_CELLS);
}

/* Puts them in the order of their tiles. */
static int sort(mesh_probes *p, uint32_t count)
{
    uint32_t tiles = p->columns * p->rows;
    mesh_probe *sorted = malloc((count + 1) * sizeof *sorted);
    p->first = calloc(tiles + 2, sizeof *p->first);
    if (!sorted || !p->first) {
        free(sorted);
        return bake_fail("out of memory");
    }
    for (uint32_t i = 0; i < count; i++) p->first[tile_of(p, &p->probe[i]) + 2]++;
    for (uint32_t t = 2; t < tiles + 2; t++) p->first[t] += p->first[t - 1];
    for (uint32_t i = 0; i < count; i++)
        sorted[p->first[tile_of(p, &p->probe[i]) + 1]++] = p->probe[i];
    free(p->probe);
    p->probe = sorted;
    return 0;
}

int mesh_probes_open(const mesh_ground *g, mesh_probes *p)
{
    const bake_grid *cells = &g->view.ground->cells;
    double samples = (double)cells->width * cells->height;
    uint32_t stride = (uint32_t)ceil(sqrt(fmax(1, samples / PROBES_MAX))), taken = 0,
             columns = (cells->width - 1) / stride + 1, rows = (cells->height - 1) / stride + 1;
    *p = (mesh_probes){ .columns = g->range.east - g->range.west + 1,
                        .rows = g->range.north - g->range.south + 1 };
    p->probe = malloc((size_t)columns * rows * sizeof *p->probe);
    int rc = p->probe ? 0 : bake_fail("out of memory");
    aim(g);
    for (uint32_t j = 0; !rc && j < rows; j++)
        rc = take_row(g, j * stride, stride, columns, p->probe, &taken);
    if (!rc) rc = sort(p, taken);
    if (rc) mesh_probes_close(p);
    return rc;
}

void mesh_probes_close(mesh_probes *p)
{
    free(p->probe);
    free(p->first);
    *p = (mesh_probes){ 0 };
}

/* ---- measuring ---- */

/* Those of a tile. */
typedef struct tile_probes {
    mesh_probe *probe; /* in points of the tile, by cells */
    uint32_t first[MESH_CELLS * MESH_CELLS + 2];
    uint32_t count;
} tile_probes;

static int has_ground(const float *block, int column, int row)
{
    const float *at = block + (row + 1) * MESH_BLOCK_SIDE + column + 1;
    return !isnan(at[0] + at[1] + at[MESH_BLOCK_SIDE] + at[MESH_BLOCK_SIDE + 1]);
}

static uint32_t cell_of(const mesh_probe *probe)
{
    return (uint32_t)probe->y * MESH_CELLS + (uint32_t)probe->x;
}

/* The probes of a tile, in its own points, whose cells have ground. */
static void gather(const mesh_probes *p, const mesh_ground *g, uint32_t zoom, uint32_t x,
                   uint32_t y, const float *block, tile_probes *out)
{
    uint32_t down = g->zoom - zoom;
    int64_t west = ((int64_t)x << down) - g->range.west,
            south = ((int64_t)y << down) - g->range.south;
    double size = 1u << down;
    out->count = 0;
    for (int64_t j = south < 0 ? 0 : south; j < south + (1 << down) && j < p->rows; j++) {
        int64_t left = west < 0 ? 0 : west, right = west + (1 << down);
        if (right > p->columns) right = p->columns;
        if (left >= right) continue;
        for (uint32_t n = p->first[j * p->columns + left]; n < p->first[j * p->columns + right];
             n++) {
            mesh_probe at = p->probe[n];
            at.x = (at.x - (double)west * MESH_CELLS) / size;
            at.y = (at.y - (double)south * MESH_CELLS) / size;
            if (!(at.x >= 0 && at.y >= 0 && at.x < MESH_CELLS && at.y < MESH_CELLS)) continue;
            if (has_ground(block, (int)at.x, (int)at.y)) out->probe[out->count++] = at;
        }
    }
}

static int by_cell(const void *a, const void *b)
{
    uint32_t x = cell_of(a), y = cell_of(b);
    return (x > y) - (x < y);
}

static void index_cells(tile_probes *t)
{
    qsort(t->probe, t->count, sizeof *t->probe, by_cell);
    memset(t->first, 0, sizeof t->first);
    for (uint32_t i = 0; i < t->count; i++) t->first[cell_of(&t->probe[i]) + 1]++;
    for (uint32_t c = 1; c < MESH_CELLS * MESH_CELLS + 1; c++) t->first[c] += t->first[c - 1];
}

/* A probe that a triangle has measured is taken out, since its neighbour may hold it, too. */
static void measure_probe(const double x[3], const double y[3], const double h[3],
                          mesh_probe *probe, export_fit *fit)
{
    if (isnan(probe->height_m)) return;
    double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    double b = ((probe->x - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (probe->y - y[0])) / area,
           c = ((x[1] - x[0]) * (probe->y - y[0]) - (probe->x - x[0]) * (y[1] - y[0])) / area;
    if (b < -OUTSIDE || c < -OUTSIDE || b + c > 1 + OUTSIDE) return;
    double off = h[0] + b * (h[1] - h[0]) + c * (h[2] - h[0]) - probe->height_m;
    export_fit_take(fit, off);
    probe->height_m = NAN;
}

static void measure_triangle(const mesh_surface *s, uint32_t number, tile_probes *t,
                             export_fit *fit)
{
    double x[3], y[3], h[3];
    for (int i = 0; i < 3; i++) {
        uint32_t point = s->index[3 * (size_t)number + (size_t)i];
        x[i] = point % MESH_SIDE;
        y[i] = point / MESH_SIDE;
        h[i] = s->height[point];
    }
    int left = (int)fmin(fmin(x[0], x[1]), x[2]), right = (int)fmax(fmax(x[0], x[1]), x[2]),
        bottom = (int)fmin(fmin(y[0], y[1]), y[2]), top = (int)fmax(fmax(y[0], y[1]), y[2]);
    for (int j = bottom; j < top; j++)
        for (uint32_t n = t->first[j * MESH_CELLS + left]; n < t->first[j * MESH_CELLS + right];
             n++)
            measure_probe(x, y, h, &t->probe[n], fit);
}

int mesh_probes_measure(const mesh_probes *p, const mesh_ground *g, uint32_t zoom, uint32_t x,
                        uint32_t y, const mesh_surface *s, export_fit *fit)
{
    tile_probes *t = malloc(sizeof *t);
    uint32_t all = p->first[p->columns * p->rows];
    if (t) t->probe = malloc((all + 1) * sizeof *t->probe);
    if (!t || !t->probe) {
        free(t);
        return bake_fail("out of memory");
    }
    gather(p, g, zoom, x, y, s->block, t);
    if (t->count) {
        index_cells(t);
        for (uint32_t i = 0; i < s->triangle_count; i++) measure_triangle(s, i, t, fit);
    }
    free(t->probe);
    free(t);
    return 0;
}
