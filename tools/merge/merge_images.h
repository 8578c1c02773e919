/* The images of packs, put together and made anew on the joint ground's own nodes. */
#ifndef MERGE_IMAGES_H
#define MERGE_IMAGES_H

#include "../bake/image/bake_image.h"
#include "../info/bake_unpack.h"
#include "merge_lattice.h"

/* Lays the packs' images over the joint ground, finer texels over coarser ones, else those of the
 * pack named first over others, what no image covers as a bake does (`heights`: the joint ground);
 * sets info->texture_log2 and texture_levels. Without images in any pack there are none. Close
 * `image` whatever comes back: 0 or -1 (said). */
int merge_images_make(const bake_unpack unpack[], uint32_t count, uint32_t quality,
                      const bake_samples *heights, merge_lattice *lattice, bake_image *image);

#endif
