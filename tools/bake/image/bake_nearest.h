/* Texels that nothing covers take the colour of the nearest one that is covered. */
#ifndef BAKE_NEAREST_H
#define BAKE_NEAREST_H

#include "../raster/bake_grid.h"

#define BAKE_NEAREST_FAR UINT32_MAX

/* `colour` holds RGB; `distance` holds uint32, 0 where covered, 1 where a little is, which keeps
 * its colour, BAKE_NEAREST_FAR elsewhere; both of the same size, with at least one covered texel.
 * Two passes by rows (city-block distance transform, Rosenfeld and Pfaltz 1966). 0 or -1 (said). */
int bake_nearest_fill(const bake_grid *colour, const bake_grid *distance);

#endif
