/* Which samples of the ground were filled: void in the source, beyond its area, or made of such
 * ones by projection. */
#ifndef BAKE_VOIDS_H
#define BAKE_VOIDS_H

#include "bake_grid.h"

/* Marks the voids of a float grid: 1 in `marks`, float like the ground and of its size, which is
 * opened, all 0, when it is closed. 0 or -1 (said). */
int bake_voids_mark(const bake_grid *grid, bake_grid *marks);
/* What is left of the marks beside the heights of a pack: `filled` has a byte a sample, rows south
 * to north, 1 where a sample, or one that it was densified from, is marked. 0 or -1 (said). */
int bake_voids_finish(const bake_grid *marks, int north_up, uint32_t densify, bake_grid *filled);

#endif
