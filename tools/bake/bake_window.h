/* A window of the ground, made as the bake makes all of it, to be counted and thrown away. */
#ifndef BAKE_WINDOW_H
#define BAKE_WINDOW_H

#include "raster/bake_project.h"
#include "bake_run_local.h"

typedef struct bake_window {
    uint32_t column, row;   /* its first sample in the new grid, row 0 as the grid's */
    uint32_t width, height; /* samples, before any is invented */
} bake_window;

typedef struct bake_window_count {
    uint32_t levels;                   /* sections: roots, then refinements */
    uint64_t records[BAKE_LEVELS_MAX]; /* of each, that are stored */
    uint64_t bytes[BAKE_LEVELS_MAX];
    uint64_t index_bytes;      /* of all sections */
    double ground_s, encode_s; /* processor time */
    double roughness;          /* of the source there: bake_roughness */
} bake_window_count;

/* Makes the window in tiles of 2^tile_log2 and counts. 0 or -1 (said). */
int bake_window_make(const bake *b, const bake_plan *plan, const bake_window *window,
                     uint32_t tile_log2, bake_window_count *count);

/* A part of a grid, both ends within. */
typedef struct bake_part {
    uint32_t west, north, east, south;
} bake_part;

/* Mean of log2(1 + e / quantum) over every `stride`-th row of a float grid without voids, e: how
 * far a sample is from the middle of its neighbours in the row. 0 or -1 (said). */
int bake_roughness(const bake_grid *grid, const bake_part *part, uint32_t stride, double quantum_m,
                   double *roughness);

#endif
