#include "export_fit.h"

#include "../bake/bake_say.h"

#include <math.h>
#include <stdlib.h>

#define SIDE        EXPORT_TILE_SIDE
#define EDGE_POINTS 16
#define PLACE_PX    0.002 /* how exactly samples are placed among pixels */

/* Columns and rows of the ground. */
typedef struct sample_range {
    uint32_t left, top, right, bottom; /* the last two do not belong to it */
} sample_range;

static uint32_t keep(double value, uint32_t high) { return (uint32_t)fmin(fmax(value, 0), high); }

/* What a tile may cover. 0, or -1: nothing. */
static int find_range(const export_view *view, sample_range *range)
{
    const bake_grid *cells = &view->ground->cells;
    double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
    for (int j = 0; j <= EDGE_POINTS; j++) {
        double x[EDGE_POINTS + 1], y[EDGE_POINTS + 1], z[EDGE_POINTS + 1] = { 0 };
        int ok[EDGE_POINTS + 1] = { 0 };
        for (int i = 0; i <= EDGE_POINTS; i++) {
            x[i] = (double)SIDE * i / EDGE_POINTS;
            y[i] = (double)SIDE * j / EDGE_POINTS;
        }
        GDALGenImgProjTransform(view->transform, TRUE, EDGE_POINTS + 1, x, y, z, ok);
        for (int i = 0; i <= EDGE_POINTS; i++) {
            if (!ok[i]) continue;
            low[0] = fmin(low[0], x[i]);
            high[0] = fmax(high[0], x[i]);
            low[1] = fmin(low[1], y[i]);
            high[1] = fmax(high[1], y[i]);
        }
    }
    if (!(low[0] < high[0])) return -1;
    range->left = keep(floor(low[0]) - 1, cells->width);
    range->right = keep(ceil(high[0]) + 1, cells->width);
    range->top = keep(floor(low[1]) - 1, cells->height);
    range->bottom = keep(ceil(high[1]) + 1, cells->height);
    return range->left < range->right && range->top < range->bottom ? 0 : -1;
}

static double painted(const export_paint *paint, const export_tile *tile, size_t at)
{
    uint8_t rgb[3];
    export_encode(paint->encoding, (double)tile->value[0][at], rgb);
    return export_decode(paint->encoding, rgb);
}

/* The tile's height between the centres of four pixels; NAN where one of them is no ground. */
static double height_at(const export_paint *paint, const export_tile *tile, double x, double y)
{
    double u = x - 0.5, v = y - 0.5;
    if (!(u >= 0 && v >= 0 && u < SIDE - 1 && v < SIDE - 1)) return NAN;
    size_t i = (size_t)u, j = (size_t)v, at = j * SIDE + i;
    const size_t four[4] = { at, at + 1, at + SIDE, at + SIDE + 1 };
    double height[4];
    for (int n = 0; n < 4; n++) {
        if (export_tile_is_void(paint, tile->mask[four[n]])) return NAN;
        height[n] = painted(paint, tile, four[n]);
    }
    u -= (double)i;
    v -= (double)j;
    return (1 - v) * ((1 - u) * height[0] + u * height[1]) +
           v * ((1 - u) * height[2] + u * height[3]);
}

typedef struct sample_row {
    uint16_t *steps;
    double *x, *y, *z;
    int *ok;
} sample_row;

static int judge_row(const export_view *view, const export_paint *paint, const export_tile *tile,
                     void *place, sample_row row, const sample_range *range, uint32_t j,
                     double map_cells, uint32_t stride, export_fit *fit)
{
    const export_ground *ground = view->ground;
    uint32_t count = 0, width = range->right - range->left;
    if (bake_grid_read(&ground->cells, j, range->left, width, row.steps)) return -1;
    for (uint32_t i = 0; i < width; i += stride) {
        row.x[count] = range->left + i + 0.5;
        row.y[count] = j + 0.5;
        row.z[count++] = 0;
    }
    GDALApproxTransform(place, FALSE, (int)count, row.x, row.y, row.z, row.ok);
    for (uint32_t n = 0; n < count; n++) {
        if (!row.ok[n]) continue;
        double x = row.x[n] - map_cells * nearbyint((row.x[n] - SIDE / 2.0) / map_cells);
        double off = height_at(paint, tile, x, row.y[n]) -
                     (row.steps[n * stride] * ground->scale + ground->offset);
        if (isnan(off)) continue;
        fit->count++;
        fit->sum += off * off;
        fit->worst_m = fmax(fit->worst_m, fabs(off));
    }
    return 0;
}

int export_fit_add(const export_view *view, const export_paint *paint, const export_tile *tile,
                   const double geotransform[6], double map_cells, uint32_t stride, export_fit *fit)
{
    sample_range range;
    GDALSetGenImgProjTransformerDstGeoTransform(view->transform, geotransform);
    if (find_range(view, &range)) return 0;
    uint32_t width = range.right - range.left;
    double *memory = malloc(width * (3 * sizeof *memory + sizeof(int) + sizeof(uint16_t)));
    if (!memory) return bake_fail("out of memory");
    sample_row row = { .x = memory, .y = memory + width, .z = memory + 2 * (size_t)width };
    row.ok = (int *)(memory + 3 * (size_t)width);
    row.steps = (uint16_t *)(row.ok + width);
    void *place = GDALCreateApproxTransformer(GDALGenImgProjTransform, view->transform, PLACE_PX);
    int rc = 0;
    uint32_t first = (range.top + stride - 1) / stride * stride;
    for (uint32_t j = first; !rc && j < range.bottom; j += stride)
        rc = judge_row(view, paint, tile, place, row, &range, j, map_cells, stride, fit);
    GDALDestroyApproxTransformer(place);
    free(memory);
    return rc;
}

double export_fit_rms(const export_fit *fit)
{
    return fit->count ? sqrt(fit->sum / (double)fit->count) : 0;
}
