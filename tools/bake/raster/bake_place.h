/* Where a raster says that it lies. */
#ifndef BAKE_PLACE_H
#define BAKE_PLACE_H

#include "bake_source.h"

/* Reads geotransform and reference system of `set` into `ground`; a raster without a place gets a
 * grid of unit cells. 0 or -1 (said). */
int bake_place_read(const bake_options *options, GDALDatasetH set, bake_ground *ground);
/* 1 when the corners of a raster without a reference system are degrees: it is taken as WGS84
 * longitude and latitude. */
int bake_place_looks_geographic(const double *geotransform, uint32_t width, uint32_t height);
/* Refuses a raster without a geotransform that is placed by other means, which a warp must undo
 * first. 0 or -1 (said). */
int bake_place_check(const char *path, GDALDatasetH set);

#endif
