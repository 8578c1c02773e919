/* The second judge of whole ground, slow on purpose: it forms every triangle that is drawn and
 * looks every edge and vertex up in hash tables; sim/judge/sim_watertight.c looks only at the rims
 * that nodes share. Same contract as sim_watertight_check(). */
#ifndef SLOW_WATERTIGHT_H
#define SLOW_WATERTIGHT_H

#include "../../client/terrain/ff_tree.h"

int slow_watertight_check(const ff_terrain_info *info, const ff_drawn *list, uint32_t count,
                          char *why, size_t why_bytes);

#endif
