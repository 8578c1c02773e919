/* Which plane the ground is projected to. */
#ifndef BAKE_TARGET_H
#define BAKE_TARGET_H

#include "bake_source.h"

/* Chooses the projection: as told; else, for degrees, other units than metres planes not true to
 * scale and planes with an axis that points west, the UTM zone round the ground's middle (on other
 * bodies a transverse Mercator there). A note tells of such a plane, and what becomes of it.
 * *target (owned) is NULL when the ground stays in its plane. 0 or -1 (said). */
int bake_target_choose(const bake_options *options, const bake_ground *ground,
                       OGRSpatialReferenceH *target);
/* Whether ground can be projected to the system of an EPSG code: a plane in metres whose axes point
 * east and north. */
int bake_target_suits(int epsg);
/* Says so when the ground is not true to scale in `target` either. */
void bake_target_note(const bake_ground *ground, OGRSpatialReferenceH target);

#endif
