/* Voids that are given a height, instead of being filled from around them. */
#ifndef BAKE_GIVEN_H
#define BAKE_GIVEN_H

#include "bake_source.h"

/* Gives the voids of the grid the heights of --void-height and --rim-void-height, and counts them
 * in ground->given instead of ground->voids. A void touches the rim when its samples are joined
 * to the first or last row or column by side or corner. Memory: 4 bytes a stretch of void samples
 * in a row. 0 or -1 (said). */
int bake_given_heights(const bake_options *options, bake_ground *ground);

#endif
