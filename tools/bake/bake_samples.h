/* The samples that tiles are made of: all of one raster, or of several of unlike spacing, which
 * then have places without a sample between them. Rows run south to north. */
#ifndef BAKE_SAMPLES_H
#define BAKE_SAMPLES_H

#include "raster/bake_grid.h"

enum bake_mark {
    BAKE_FILLED = 1, /* the source did not have the sample: it was filled */
    BAKE_BETWEEN = 2 /* there is none: the height there is what decoders predict */
};

typedef struct bake_samples {
    uint32_t width, height;
    int has_marks; /* 0: all are measured */
    /* Reads `count` samples of a row, and their marks, bits of enum bake_mark, unless `marks` is
     * NULL. May be called by several threads at once. 0 or -1 (said). */
    int (*read)(const struct bake_samples *samples, uint32_t row, uint32_t column, uint32_t count,
                uint16_t *heights, uint8_t *marks);
    /* In the window from a column and row on, 2^side_log2 places further each way, all samples
     * stand at columns and rows that are multiples of two to the power of what this tells; so do
     * the last column and row of all. NULL: 0. */
    uint32_t (*apart_log2)(const struct bake_samples *samples, uint32_t column, uint32_t row,
                           uint32_t side_log2);
} bake_samples;

/* Samples of a grid (uint16), and a byte beside each in another: 1 where it was filled; closed:
 * none was. */
typedef struct bake_grid_samples {
    bake_samples samples;
    const bake_grid *heights, *filled;
} bake_grid_samples;

/* Reads the samples of a row that are 2^apart_log2 columns apart, `count` of them; the row's last
 * sample stands for those beyond it. `marks` NULL: they are not wanted. 0 or -1 (said). */
int bake_samples_pick(const bake_samples *samples, uint32_t row, uint32_t column,
                      uint32_t apart_log2, size_t count, uint16_t *heights, uint8_t *marks);

bake_grid_samples bake_samples_of(const bake_grid *heights, const bake_grid *filled);

#endif
