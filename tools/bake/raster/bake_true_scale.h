/* How long a projection shows a metre of the ground. */
#ifndef BAKE_TRUE_SCALE_H
#define BAKE_TRUE_SCALE_H

#include "bake_source.h"

typedef struct bake_scale {
    double least, most; /* metres of the plane for a metre of the ground */
} bake_scale;

/* Measures `projection` along all directions at the ground's corners, the middles of its edges and
 * its centre. 0, or -1 when it shows none of them. */
int bake_true_scale(const bake_ground *ground, OGRSpatialReferenceH projection, bake_scale *scale);
/* How far from true: 0 where a metre is a metre. */
double bake_scale_error(const bake_scale *scale);

#endif
