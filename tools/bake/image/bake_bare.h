/* Which images are left out, because they would show no more than one above them.
 *
 * A node's image is left out, and all below it, where the nearest one above that is stored, decoded
 * and enlarged as clients do it, is in every block of 8 x 8 texels about as near to the lattice as
 * the image's own JPEG would be, decoded: its mean square is at most 25/16 of the JPEG's, or at
 * most 4 (two steps of 255). So sea, lakes and ground without colours have an image at the level
 * where nothing changes any more. No image stands for one below it of ground that nothing covers
 * (bake_open.h). */
#ifndef BAKE_BARE_H
#define BAKE_BARE_H

#include "../../../protocol/ff_image.h"
#include "bake_image.h"

/* Finds them for all nodes of the image: fills image->bare. 0 or -1 (said). */
int bake_bare_find(bake_image *image, const ff_terrain_info *info, int quality);
/* 1: a node that has ground has an image, or is an open root; *marks: what stands before it. 0: it
 * has none. -1 (said). */
int bake_bare_of(const bake_image *image, const ff_terrain_info *info, ff_key key,
                 ff_image_marks *marks);

#endif
