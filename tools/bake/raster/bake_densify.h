/* Invented detail between samples (--densify), for flights over finer ground than was ever
 * measured.
 *
 * Each doubling puts new samples half-way, by 4-point interpolation plus noise, first along rows,
 * then along columns (midpoint displacement; Fournier, Fussell, Carpenter 1982). The noise is as
 * strong as the ground around it is rough: the local residual of the same interpolation among the
 * existing samples, times the factor by which that residual shrinks from one spacing to the next in
 * this very raster. Flat water stays flat. Samples that were there stay exactly as they were, and
 * the same raster always gets the same detail.
 */
#ifndef BAKE_DENSIFY_H
#define BAKE_DENSIFY_H

#include "bake_grid.h"

/* Densifies a float grid without voids `factor` times along each axis, a power of two;
 * `geotransform` (GDAL's, of the grid) follows. 0 or -1 (said). */
int bake_densify(bake_grid *grid, double *geotransform, uint32_t factor);

#endif
