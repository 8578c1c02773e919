/* Which images are left out, because they would show no more than one above them.
 *
 * A node's image is left out, and all below it, where the nearest one above that is stored, decoded
 * and enlarged as clients do it, is in every block of 8 x 8 texels about as near to the lattice as
 * the image's own JPEG would be, decoded: its mean square is at most 25/16 of the JPEG's, or at
 * most 4 (two steps of 255). So sea, lakes and ground without colours have an image at the level
 * where nothing changes any more. */
#ifndef BAKE_BARE_H
#define BAKE_BARE_H

#include "bake_image.h"

/* Finds them for all nodes of the image: fills image->bare. 0 or -1 (said). */
int bake_bare_find(bake_image *image, const ff_terrain_info *info, int quality);
/* *bare: which children of a node that have ground have no image (ff_image.bare), or -1: the node
 * itself has none. 0 or -1 (said). */
int bake_bare_of(const bake_image *image, const ff_terrain_info *info, ff_key key, int *bare);

#endif
