/* How the ground falls away: the curvature a pack carries (protocol/ff_terrain.h, curve_q60). */
#ifndef BAKE_CURVE_H
#define BAKE_CURVE_H

#include "../bake_options.h"
#include "bake_source.h"

/* From the mean radius of the reference system's ellipsoid, the Earth's without one, and the
 * refraction asked for: by default 0.13 on the Earth, 0 elsewhere. 0 when --flat says so. On a
 * pack's lattice the pack's. */
uint32_t bake_curve_q60(const bake_options *options, const bake_ground *ground);

#endif
