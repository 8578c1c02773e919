/* Where a raster says that it lies. */
#ifndef BAKE_PLACE_H
#define BAKE_PLACE_H

#include "bake_source.h"

/* Reads geotransform and reference system of `set` into `ground`; a raster without a place gets a
 * grid of unit cells. 0 or -1 (said). */
int bake_place_read(const bake_options *options, GDALDatasetH set, bake_ground *ground);
/* Refuses a raster without a geotransform that is placed by other means, which a warp must undo
 * first. 0 or -1 (said). */
int bake_place_check(const char *path, GDALDatasetH set);

#endif
