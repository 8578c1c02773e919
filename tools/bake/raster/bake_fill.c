#include "bake_fill.h"

#include "../bake_say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEVELS_MAX  32
#define RELAXATIONS 6

typedef struct fill_rows { /* rows of working memory, each as wide as the finest level */
    float *a, *b, *c, *d;
} fill_rows;

static uint32_t halved(uint32_t size) { return (size + 1) / 2; }

/* Mean of those among up to four values that are known, NaN when none is. */
static float mean_known(const float *values, int count)
{
    double sum = 0;
    int known = 0;
    for (int i = 0; i < count; i++)
        if (!isnan(values[i])) {
            sum += values[i];
            known++;
        }
    return known ? (float)(sum / known) : NAN;
}

/* Pull: makes the next coarser level. *voids receives how many of its samples are still void. */
static int pull(const bake_grid *fine, const bake_grid *coarse, const fill_rows *rows,
                uint64_t *voids)
{
    *voids = 0;
    for (uint32_t row = 0; row < coarse->height; row++) {
        uint32_t second = 2 * row + 1 < fine->height ? 2 * row + 1 : 2 * row;
        if (bake_grid_read(fine, 2 * row, 0, fine->width, rows->a)) return -1;
        if (bake_grid_read(fine, second, 0, fine->width, rows->b)) return -1;
        for (uint32_t i = 0; i < coarse->width; i++) {
            uint32_t east = 2 * i + 1 < fine->width ? 2 * i + 1 : 2 * i;
            float four[4] = { rows->a[2 * i], rows->a[east], rows->b[2 * i], rows->b[east] };
            rows->c[i] = mean_known(four, 4);
            *voids += isnan(rows->c[i]) != 0;
        }
        if (bake_grid_write(coarse, row, 0, coarse->width, rows->c)) return -1;
    }
    return 0;
}

/* Value of the coarse level at the centre of fine sample (column, row); near and far are the coarse
 * rows around it. */
static float bilinear(const float *near_row, const float *far_row, uint32_t column,
                      uint32_t coarse_width)
{
    uint32_t i = column / 2, next = column % 2 ? i + 1 : i - 1;
    if (i == 0 && column % 2 == 0) next = 0;
    if (next >= coarse_width) next = coarse_width - 1;
    float near_value = 0.75f * near_row[i] + 0.25f * near_row[next];
    float far_value = 0.75f * far_row[i] + 0.25f * far_row[next];
    return 0.75f * near_value + 0.25f * far_value;
}

/* Push: fills the voids of `fine` from the complete `coarse`. `mask` (a byte a sample) remembers
 * what was void. */
static int push(const bake_grid *fine, const bake_grid *mask, const bake_grid *coarse,
                const fill_rows *rows)
{
    uint8_t *was_void = (uint8_t *)rows->d;
    for (uint32_t row = 0; row < fine->height; row++) {
        int any = 0;
        if (bake_grid_read(fine, row, 0, fine->width, rows->a)) return -1;
        for (uint32_t i = 0; i < fine->width; i++) any |= was_void[i] = isnan(rows->a[i]) != 0;
        if (bake_grid_write(mask, row, 0, fine->width, was_void)) return -1;
        if (!any) continue;
        uint32_t near_row = row / 2, far_row = row % 2 ? near_row + 1 : near_row - (near_row > 0);
        if (far_row >= coarse->height) far_row = coarse->height - 1;
        if (bake_grid_read(coarse, near_row, 0, coarse->width, rows->b)) return -1;
        if (bake_grid_read(coarse, far_row, 0, coarse->width, rows->c)) return -1;
        for (uint32_t i = 0; i < fine->width; i++)
            if (was_void[i]) rows->a[i] = bilinear(rows->b, rows->c, i, coarse->width);
        if (bake_grid_write(fine, row, 0, fine->width, rows->a)) return -1;
    }
    return 0;
}

static void relax_row(const float *above, float *row, const float *below, const uint8_t *was_void,
                      uint32_t width)
{
    for (uint32_t i = 0; i < width; i++) {
        if (!was_void[i]) continue;
        float west = row[i ? i - 1 : i], east = row[i + 1 < width ? i + 1 : i];
        row[i] = 0.25f * (west + east + above[i] + below[i]);
    }
}

/* One sweep of Gauss-Seidel over the void samples. */
static int relax(const bake_grid *fine, const bake_grid *mask, const fill_rows *rows)
{
    uint8_t *was_void = (uint8_t *)rows->d;
    for (uint32_t row = 0; row < fine->height; row++) {
        if (bake_grid_read(mask, row, 0, fine->width, was_void)) return -1;
        if (!memchr(was_void, 1, fine->width)) continue;
        uint32_t above = row ? row - 1 : row, below = row + 1 < fine->height ? row + 1 : row;
        if (bake_grid_read(fine, above, 0, fine->width, rows->a)) return -1;
        if (bake_grid_read(fine, row, 0, fine->width, rows->b)) return -1;
        if (bake_grid_read(fine, below, 0, fine->width, rows->c)) return -1;
        relax_row(rows->a, rows->b, rows->c, was_void, fine->width);
        if (bake_grid_write(fine, row, 0, fine->width, rows->b)) return -1;
    }
    return 0;
}

static int push_and_relax(const bake_grid *fine, const bake_grid *coarse, const fill_rows *rows)
{
    bake_grid mask;
    if (bake_grid_open(&mask, fine->width, fine->height, 1)) return -1;
    int rc = push(fine, &mask, coarse, rows);
    for (int i = 0; !rc && i < RELAXATIONS; i++) rc = relax(fine, &mask, rows);
    bake_grid_close(&mask);
    return rc;
}

static int fill_levels(bake_grid *level, const fill_rows *rows)
{
    int top = 0, rc = 0;
    for (uint64_t voids = 1; !rc && voids; top++) {
        rc = bake_grid_open(&level[top + 1], halved(level[top].width), halved(level[top].height),
                            sizeof(float));
        if (!rc) rc = pull(&level[top], &level[top + 1], rows, &voids);
    }
    for (int i = top; i > 0; i--) {
        if (!rc) rc = push_and_relax(&level[i - 1], &level[i], rows);
        bake_progress("filling", (uint64_t)(top - i + 1), (uint64_t)top);
        bake_grid_close(&level[i]);
    }
    return rc;
}

int bake_fill_voids(bake_grid *grid)
{
    bake_grid level[LEVELS_MAX + 1] = { *grid };
    size_t row_bytes = grid->width * sizeof(float);
    char *memory = malloc(4 * row_bytes);
    if (!memory) return bake_fail("out of memory");
    fill_rows rows = { (float *)memory, (float *)(memory + row_bytes),
                       (float *)(memory + 2 * row_bytes), (float *)(memory + 3 * row_bytes) };
    int rc = fill_levels(level, &rows);
    free(memory);
    return rc;
}
