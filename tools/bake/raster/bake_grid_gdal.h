/* Temporary grids as GDAL data sets. */
#ifndef BAKE_GRID_GDAL_H
#define BAKE_GRID_GDAL_H

#include "bake_gdal.h"
#include "bake_grid.h"

/* A GDAL data set over a grid's temporary file, valid while the grid is open: bands of `type`,
 * interleaved by cell. NULL after saying why. */
GDALDatasetH bake_grid_dataset(const bake_grid *grid, GDALDataType type, int band_count);

#endif
