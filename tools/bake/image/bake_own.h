/* The colours that ground without images has, at any place: what clients shade samples with
 * (client/terrain/ff_shade.h), and between samples in proportion, as they fill triangles; for
 * texels wider than samples their means. */
#ifndef BAKE_OWN_H
#define BAKE_OWN_H

#include "../../../protocol/ff_terrain.h"
#include "../bake_samples.h"

typedef struct bake_own bake_own;

/* Shades all samples, into temporary files. NULL (said). */
bake_own *bake_own_open(const ff_terrain_info *info, const bake_samples *heights);
void bake_own_close(bake_own *own);
/* Turns to places at y, samples from the south, of texels so many samples wide. 0 or -1 (said). */
int bake_own_row(bake_own *own, double y, double texel_samples);
/* The colour x samples from the west on that row. */
void bake_own_at(const bake_own *own, double x, uint8_t rgb[3]);

#endif
