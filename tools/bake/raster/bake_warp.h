/* Resampling of a grid onto another plane, or another grid of the same one. */
#ifndef BAKE_WARP_H
#define BAKE_WARP_H

#include "bake_gdal.h"
#include "bake_grid.h"
#include "bake_shift.h"

/* Where samples come from and where they go. */
typedef struct bake_warp {
    OGRSpatialReferenceH srs, target; /* NULL: the same plane, or none */
    bake_shift shift;                 /* from the datum of `srs` to that of `target` */
    double from[6], to[6];            /* geotransforms, GDAL's */
    uint32_t width, height;           /* of the new grid */
    int jobs;
} bake_warp;

/* What became of the samples. */
typedef struct bake_warp_count {
    uint64_t outside; /* of the source's area: NaN */
    uint64_t beyond;  /* the source's range, by as much as beyond_m: kept to it */
    double beyond_m;
} bake_warp_count;

/* How far the image of one cell reaches, along its columns and along its rows. */
typedef struct bake_warp_cell {
    double x[2], y[2];
} bake_warp_cell;

/* What lies where after warping: the transformer that GDAL's functions take, from `source`, a data
 * set that has place and reference system. NULL after saying why. */
void *bake_warp_transform(GDALDatasetH source, OGRSpatialReferenceH target,
                          const bake_shift *shift);
/* The image of the cell in the middle of a grid: of the source, or, `to_source`, of the new grid in
 * cells of the source. 0, or -1: it has none. */
int bake_warp_measure(void *transform, int to_source, uint32_t width, uint32_t height,
                      bake_warp_cell *cell);
/* Tells the warper's filter, by options that are added to `list`, how much coarser the new grid is
 * in its middle. Left to itself the warper takes the ratio of each block to the upright window
 * round it in the source, and blurs whatever is turned. Returns the list. */
char **bake_warp_sharpness(char **list, void *transform, uint32_t width, uint32_t height);
/* A data set over `grid` as `warp` tells where it comes from. NULL after saying why. */
GDALDatasetH bake_warp_source(const bake_warp *warp, const bake_grid *grid);
/* Takes places of the new grid, in its columns and rows, back to those of the source. A place that
 * the source does not reach becomes NaN. 0 or -1 (said). */
int bake_warp_back(const bake_warp *warp, const bake_grid *grid, int count, double *column,
                   double *row);
/* Makes the image of a float grid as a new one, as bake_warp_grid does, but within no range. Of a
 * part of the image only that part is computed. 0 or -1 (said). */
int bake_warp_part(const bake_warp *warp, const bake_grid *grid, bake_grid *image,
                   bake_warp_count *out);
/* Replaces a float grid by its image: sharp, averaged only where the new grid is coarser, and
 * within the range of its source. Samples outside the source's area become NaN. 0 or -1 (said). */
int bake_warp_grid(const bake_warp *warp, bake_grid *grid, bake_warp_count *out);

#endif
