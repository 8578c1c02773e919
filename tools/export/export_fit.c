#include "export_fit.h"

#include "../bake/bake_say.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#define SIDE        EXPORT_TILE_SIDE
#define EDGE_POINTS 16
#define PLACE_PX    0.0002 /* how exactly samples are placed among pixels */
#define ZOOMS_TOLD  3      /* the finest */

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

/* One tile judged. */
typedef struct tile_judge {
    const export_view *view;
    const export_paint *paint;
    const export_patch *patch;
    void *place; /* from samples to pixels */
    double map_px;
    uint32_t stride;
    sample_range range;
    export_fit *fit;
} tile_judge;

static double painted(const tile_judge *judge, size_t at)
{
    uint8_t rgb[3];
    export_encode(judge->paint->encoding, (double)judge->patch->metres[at], rgb);
    return export_decode(judge->paint->encoding, rgb);
}

/* The height at a place in the tile's pixels, between the centres of four; NAN where one of them is
 * no ground or not known, or where the place is not the tile's. */
static double height_at(const tile_judge *judge, double x, double y)
{
    const export_patch *patch = judge->patch;
    if (!(x >= 0 && y >= 0 && x < SIDE && y < SIDE)) return NAN;
    double u = x + patch->margin - 0.5, v = y + patch->margin - 0.5;
    if (u < 0 || v < 0 || u >= patch->side - 1 || v >= patch->side - 1) return NAN;
    size_t i = (size_t)u, j = (size_t)v, at = j * patch->side + i;
    const size_t four[4] = { at, at + 1, at + patch->side, at + patch->side + 1 };
    double height[4];
    for (int n = 0; n < 4; n++) {
        if (export_tile_is_void(judge->paint, patch->mask[four[n]])) return NAN;
        height[n] = painted(judge, four[n]);
    }
    u -= (double)i;
    v -= (double)j;
    return (1 - v) * ((1 - u) * height[0] + u * height[1]) +
           v * ((1 - u) * height[2] + u * height[3]);
}

/* Memory for a row of samples. */
typedef struct sample_row {
    uint16_t *steps;
    double *x, *y, *z;
    int *ok;
} sample_row;

static int judge_row(const tile_judge *judge, const sample_row *row, uint32_t j)
{
    const export_ground *ground = judge->view->ground;
    uint32_t left = judge->range.left, width = judge->range.right - left, count = 0,
             skipped = (judge->stride - left % judge->stride) % judge->stride;
    if (bake_grid_read(&ground->cells, j, left, width, row->steps)) return -1;
    for (uint32_t i = skipped; i < width; i += judge->stride) {
        row->x[count] = left + i + 0.5;
        row->y[count] = j + 0.5;
        row->z[count++] = 0;
    }
    GDALApproxTransform(judge->place, FALSE, (int)count, row->x, row->y, row->z, row->ok);
    for (uint32_t n = 0; n < count; n++) {
        if (!row->ok[n]) continue;
        double x = row->x[n] - judge->map_px * nearbyint((row->x[n] - SIDE / 2.0) / judge->map_px);
        double off = height_at(judge, x, row->y[n]) -
                     (row->steps[skipped + n * judge->stride] * ground->scale + ground->offset);
        if (isnan(off)) continue;
        export_fit_take(judge->fit, off);
    }
    return 0;
}

int export_fit_add(const export_view *view, const export_paint *paint, const export_patch *patch,
                   const double geotransform[6], double map_px, uint32_t stride, export_fit *fit)
{
    tile_judge judge = { view, paint, patch, NULL, map_px, stride, { 0 }, fit };
    GDALSetGenImgProjTransformerDstGeoTransform(view->transform, geotransform);
    if (find_range(view, &judge.range)) return 0;
    size_t width = judge.range.right - judge.range.left;
    double *memory = malloc(width * (3 * sizeof *memory + sizeof(int) + sizeof(uint16_t)));
    if (!memory) return bake_fail("out of memory");
    sample_row row = { .x = memory, .y = memory + width, .z = memory + 2 * width };
    row.ok = (int *)(memory + 3 * width);
    row.steps = (uint16_t *)(row.ok + width);
    judge.place = GDALCreateApproxTransformer(GDALGenImgProjTransform, view->transform, PLACE_PX);
    int rc = 0;
    uint32_t first = (judge.range.top + stride - 1) / stride * stride;
    for (uint32_t j = first; !rc && j < judge.range.bottom; j += stride)
        rc = judge_row(&judge, &row, j);
    GDALDestroyApproxTransformer(judge.place);
    free(memory);
    return rc;
}

void export_fit_take(export_fit *fit, double off_m)
{
    fit->count++;
    fit->sum += off_m * off_m;
    fit->worst_m = fmax(fit->worst_m, fabs(off_m));
}

void export_fit_tell(const export_fit *fit, uint32_t low, uint32_t high, export_about *about)
{
    for (uint32_t z = high + 1; z-- > low && z + ZOOMS_TOLD > high;)
        if (fit[z].count)
            export_about_add(
                about, "; zoom %u measured at %" PRIu64 " samples: %.3g m rms, %.4g m at most", z,
                fit[z].count, sqrt(fit[z].sum / (double)fit[z].count), fit[z].worst_m);
        else
            export_about_add(about, "; zoom %u too coarse to be measured", z);
}
