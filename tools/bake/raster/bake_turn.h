/* Grids whose rows run along the wrong axis, or the wrong way, are turned sample by sample. */
#ifndef BAKE_TURN_H
#define BAKE_TURN_H

#include "bake_grid.h"

/* Makes the rows of a float grid run from west to east when its geotransform (GDAL's, which
 * follows) exchanges rows and columns or runs westwards; any other turn is left to resampling. 0 or
 * -1 (said). */
int bake_turn(bake_grid *grid, double *geotransform);

#endif
