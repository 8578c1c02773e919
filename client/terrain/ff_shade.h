/* Colour of ground without images: hypsometric ramp and hill shading from heights alone, zero bytes
 * on the link. */
#ifndef FF_SHADE_H
#define FF_SHADE_H

#include "../../protocol/ff_terrain.h"

/* rgba of the sample in column i, row j of a node's grid; cell_wu the distance between its samples.
 * `framed` is that grid with one more sample on every side, (ff_node_side()+2)^2 in all (its four
 * corners are not looked at): both sides of a node border see the same slopes there. Light from the
 * north-west, 45 degrees high. The ramp spans the terrain's height_min..height_max; the lowest step
 * of terrains touching zero is water. */
void ff_shade(const ff_terrain_info *info, const uint16_t *framed, int32_t cell_wu, uint32_t i,
              uint32_t j, uint8_t rgba[4]);

#endif
