/* Filling of voids: push-pull (Gortler et al. 1996, "The Lumigraph", section 3.4) with a few
 * relaxations a level.
 *
 * Averages of what is known go up a pyramid until nothing is void; on the way down every void
 * sample takes the bilinear interpolation of the coarser level, then moves towards the mean of its
 * neighbours. All levels are temporary files worked on row by row: memory is some rows, whatever
 * the size of raster and void.
 */
#ifndef BAKE_FILL_H
#define BAKE_FILL_H

#include "bake_grid.h"

/* Replaces every NaN of a float grid that has at least one number; numbers stay as they are. 0 or
 * -1 (said). */
int bake_fill_voids(bake_grid *grid);

#endif
