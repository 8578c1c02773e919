/* Resampling of a grid onto another plane, or another grid of the same one. */
#ifndef BAKE_WARP_H
#define BAKE_WARP_H

#include "bake_gdal.h"
#include "bake_grid.h"

/* Where samples come from and where they go. */
typedef struct bake_warp {
    OGRSpatialReferenceH srs, target; /* NULL: the same plane, or none */
    double from[6], to[6];            /* geotransforms, GDAL's */
    uint32_t width, height;           /* of the new grid */
    int jobs;
} bake_warp;

/* What lies where after warping: the transformer that GDAL's functions take, from `source`, a data
 * set that has place and reference system. NULL after saying why. */
void *bake_warp_transform(GDALDatasetH source, OGRSpatialReferenceH target);
/* A data set over `grid` as `warp` tells where it comes from. NULL after saying why. */
GDALDatasetH bake_warp_source(const bake_warp *warp, const bake_grid *grid);
/* Replaces a float grid by its image. Samples outside the source's area become NaN, counted in
 * *outside. 0 or -1 (said). */
int bake_warp_grid(const bake_warp *warp, bake_grid *grid, uint64_t *outside);

#endif
