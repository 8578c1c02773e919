/* Colour of ground without images: hypsometric ramp and hill shading from heights alone, zero bytes
 * on the link. */
#ifndef FF_SHADE_H
#define FF_SHADE_H

#include "../../protocol/ff_terrain.h"

/* A node's grid with one more sample on every side, (ff_node_side()+2)^2 in all (its four corners
 * are not looked at): both sides of a node border see the same slopes there. */
typedef struct ff_shade_grid {
    const ff_terrain_info *info;
    ff_key key;
    int32_t cell_wu; /* between its samples */
    const uint16_t *framed;
    int32_t ramp[2]; /* the heights that colours span, in steps */
} ff_shade_grid;

/* rgba of the sample in column i, row j of the node's grid. Light from the north-west, 45 degrees
 * high. The lowest step of terrains touching zero is water. */
void ff_shade(const ff_shade_grid *grid, uint32_t i, uint32_t j, uint8_t rgba[4]);
/* rgba of a ridge at that height of which nothing else is known. */
void ff_shade_ridge(const ff_terrain_info *info, int32_t height_wu, uint8_t rgba[4]);

#endif
