#include "bake_densify.h"

#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Ground rougher or smoother than SHRINK_MIN .. SHRINK_MAX was never measured: then the
 * estimate is what is wrong. */
#define SHRINK_MIN     0.35
#define SHRINK_MAX     0.85
#define SHRINK_DEFAULT 0.6

static uint32_t clamped(int64_t at, uint32_t size)
{
    return at < 0 ? 0 : at >= size ? size - 1 : (uint32_t)at;
}

static float interpolate(float a, float b, float c, float d)
{
    return (9 * (b + c) - (a + d)) * (1.0f / 16);
}

/* Noise of mean magnitude 1, from -3 to 3, a function of place and doubling alone. */
static float noise_at(uint64_t column, uint64_t row, uint32_t doubling)
{
    uint64_t x = (row << 32 ^ column) + (doubling + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    x ^= x >> 31;
    double sum = (double)(uint32_t)x / 4294967296.0 + (double)(x >> 32) / 4294967296.0;
    return (float)(3 * (sum - 1));
}

/* How far 4-point interpolation, between samples `step` and 3 * `step` away, misses column i of a
 * row. */
static float missed_along(const float *row, uint32_t i, uint32_t width, int64_t step)
{
    return fabsf(row[i] - interpolate(row[clamped(i - 3 * step, width)],
                                      row[clamped(i - step, width)], row[clamped(i + step, width)],
                                      row[clamped(i + 3 * step, width)]));
}

/* ---- roughness ---- */

/* Measures, over the rows of the whole raster, how much the residual shrinks when the spacing
 * halves. */
static int measure_shrink(const bake_grid *grid, float *row, float *shrink)
{
    double fine = 0, coarse = 0;
    for (uint32_t j = 0; j < grid->height; j++) {
        if (bake_grid_read(grid, j, 0, grid->width, row)) return -1;
        for (uint32_t i = 6; i + 6 < grid->width; i++) {
            fine += missed_along(row, i, grid->width, 1);
            coarse += missed_along(row, i, grid->width, 2);
        }
    }
    double ratio = coarse > 0 ? fine / coarse : SHRINK_DEFAULT;
    *shrink = (float)fmin(fmax(ratio, SHRINK_MIN), SHRINK_MAX);
    return 0;
}

/* Measures the roughness of row j: the mean residual along row and column, averaged over three
 * neighbours. `rows` are seven rows of the grid and two of working memory; the last one receives
 * the answer. */
static int measure_row(const bake_grid *grid, uint32_t j, float *const rows[9])
{
    for (int r = 0; r < 7; r++)
        if (bake_grid_read(grid, clamped((int64_t)j + r - 3, grid->height), 0, grid->width,
                           rows[r]))
            return -1;
    for (uint32_t i = 0; i < grid->width; i++) {
        float along = missed_along(rows[3], i, grid->width, 1);
        float across = fabsf(rows[3][i] -
                             interpolate(rows[0][i], rows[2][i], rows[4][i], rows[6][i]));
        rows[7][i] = 0.5f * (along + across);
    }
    for (uint32_t i = 0; i < grid->width; i++)
        rows[8][i] = (rows[7][clamped((int64_t)i - 1, grid->width)] + rows[7][i] +
                      rows[7][clamped(i + 1, grid->width)]) /
                     3;
    return 0;
}

static int measure_roughness(const bake_grid *grid, const bake_grid *roughness, float *memory)
{
    float *rows[9];
    for (int r = 0; r < 9; r++) rows[r] = memory + (size_t)r * grid->width;
    for (uint32_t j = 0; j < grid->height; j++)
        if (measure_row(grid, j, rows) || bake_grid_write(roughness, j, 0, grid->width, rows[8]))
            return -1;
    return 0;
}

/* ---- one doubling ---- */

typedef struct doubling {
    bake_grid coarse, roughness, fine;
    uint32_t number;
    float shrink;
    float *memory; /* nine coarse rows; reused as four fine ones and two of roughness */
} doubling;

/* Makes an even row: the old samples, and new ones half-way along the row. */
static int double_row(const doubling *d, uint32_t j)
{
    uint32_t width = d->coarse.width;
    float *old = d->memory, *rough = old + width, *new = rough + width;
    if (bake_grid_read(&d->coarse, j, 0, width, old) ||
        bake_grid_read(&d->roughness, j, 0, width, rough))
        return -1;
    for (uint32_t i = 0; i < width; i++) {
        new[2 * (size_t)i] = old[i];
        if (i + 1 == width) break;
        float middle = interpolate(old[clamped((int64_t)i - 1, width)], old[i], old[i + 1],
                                   old[clamped(i + 2, width)]);
        float strength = d->shrink * 0.5f * (rough[i] + rough[i + 1]);
        new[2 * (size_t)i + 1] = middle + strength *noise_at(2 * (uint64_t)i + 1, 2 * (uint64_t)j,
                                                             d->number);
    }
    return bake_grid_write(&d->fine, 2 * j, 0, d->fine.width, new);
}

/* Makes an odd row: half-way between the even rows j and j+1. */
static int insert_row(const doubling *d, uint32_t j)
{
    uint32_t width = d->fine.width, coarse_width = d->coarse.width;
    float *rows[4], *rough[2], *new = d->memory + 4 * (size_t)width + 2 * (size_t)coarse_width;
    for (int r = 0; r < 4; r++) {
        rows[r] = d->memory + (size_t)r * width;
        if (bake_grid_read(&d->fine, 2 * clamped((int64_t)j + r - 1, d->coarse.height), 0, width,
                           rows[r]))
            return -1;
    }
    for (uint32_t r = 0; r < 2; r++) {
        rough[r] = d->memory + 4 * (size_t)width + r * (size_t)coarse_width;
        if (bake_grid_read(&d->roughness, j + r, 0, coarse_width, rough[r])) return -1;
    }
    for (uint32_t i = 0; i < width; i++) {
        uint32_t west = i / 2, east = clamped((i + 1) / 2, coarse_width);
        float strength = d->shrink * 0.25f *
                         (rough[0][west] + rough[0][east] + rough[1][west] + rough[1][east]);
        new[i] = interpolate(rows[0][i], rows[1][i], rows[2][i], rows[3][i]) +
                 strength *noise_at(i, 2 * (uint64_t)j + 1, d->number);
    }
    return bake_grid_write(&d->fine, 2 * j + 1, 0, width, new);
}

static int double_grid(doubling *d)
{
    if (bake_grid_open(&d->roughness, d->coarse.width, d->coarse.height, sizeof(float)) ||
        bake_grid_open(&d->fine, 2 * d->coarse.width - 1, 2 * d->coarse.height - 1,
                       sizeof(float)) ||
        measure_roughness(&d->coarse, &d->roughness, d->memory))
        return -1;
    for (uint32_t j = 0; j < d->coarse.height; j++)
        if (double_row(d, j)) return -1;
    for (uint32_t j = 0; j + 1 < d->coarse.height; j++) {
        if (insert_row(d, j)) return -1;
        bake_progress("densifying", j + 2, d->coarse.height);
    }
    return 0;
}

/* Halves the spacing; the first and the last sample stay where they are. */
static void halve_geotransform(double *gt)
{
    gt[0] += gt[1] / 4;
    gt[3] += gt[5] / 4;
    gt[1] /= 2;
    gt[5] /= 2;
}

static int densify_once(bake_grid *grid, uint32_t number, float *shrink)
{
    doubling d = {
        .coarse = *grid, .roughness = BAKE_GRID_CLOSED, .fine = BAKE_GRID_CLOSED, .number = number
    };
    if (grid->width > 1u << 28 || grid->height > 1u << 28)
        return bake_fail("--densify: too many samples");
    d.memory = malloc(12 * (size_t)grid->width * sizeof *d.memory);
    int rc = d.memory ? 0 : bake_fail("out of memory");
    if (!rc && number == 0) rc = measure_shrink(grid, d.memory, shrink);
    d.shrink = *shrink;
    if (!rc) rc = double_grid(&d);
    free(d.memory);
    bake_grid_close(&d.roughness);
    if (rc) {
        bake_grid_close(&d.fine);
        return rc;
    }
    bake_grid_close(grid);
    *grid = d.fine;
    return 0;
}

int bake_densify(bake_grid *grid, double *geotransform, uint32_t factor)
{
    float shrink = SHRINK_DEFAULT;
    uint32_t number = 0;
    for (; factor > 1; factor /= 2, number++) {
        if (densify_once(grid, number, &shrink)) return -1;
        halve_geotransform(geotransform);
    }
    return 0;
}
