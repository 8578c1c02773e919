/* What textures will take, from some of them. */
#ifndef BAKE_IMAGE_SAMPLE_H
#define BAKE_IMAGE_SAMPLE_H

#include "bake_image.h"

typedef struct bake_image_guess {
    double bytes, deviation;    /* of all textures, and its standard deviation */
    double lattice_s, encode_s; /* processor time for all of them */
    double share;               /* of the textures that were made */
    double reach;               /* share of the ground's nodes that the image reaches into */
} bake_image_guess;

/* Makes the textures of a few parts of the ground, and of the padding beyond it, from the image of
 * `options`; sets info->texture_log2 and texture_levels. 0 or -1 (said). */
int bake_image_sample(const bake_options *options, const bake_ground *ground, ff_terrain_info *info,
                      bake_image_guess *guess);

#endif
