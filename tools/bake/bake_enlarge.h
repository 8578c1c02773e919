/* How the image of a node shows the ground of a node below: enlarged, as clients filter it. */
#ifndef BAKE_ENLARGE_H
#define BAKE_ENLARGE_H

#include "../../protocol/ff_terrain.h"

/* `rgb` is the image of `image`, `enlarged` receives the part of it over `node`, which lies below:
 * both of (2^texture_log2)^2 texels, top row first. */
void bake_enlarge(const ff_terrain_info *info, const uint8_t *rgb, ff_key image, ff_key node,
                  uint8_t *enlarged);

#endif
