/* Rasters of degrees that are cut at 180 degrees are joined there. */
#ifndef BAKE_SEAM_H
#define BAKE_SEAM_H

#include "bake_gdal.h"

/* A raster of degrees all round the Earth with nothing in more than half of its columns is one that
 * lies across 180 degrees: returns a view of it that begins behind the empty columns, and takes
 * `set` over; else `set` itself. NULL after saying why. */
GDALDatasetH bake_seam_join(const char *path, GDALDatasetH set);

#endif
