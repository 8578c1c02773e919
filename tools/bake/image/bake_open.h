/* Ground that an image does not cover: such texels get the ground's own colours, such nodes no
 * image.
 *
 * A texel counts as covered when half of its square is. Near that, up to BAKE_OPEN_NEAR texels
 * away, the nearest colour goes on: images that end with the ground lack a few texels along its
 * rim. A node is open when no texel inside it (those on its very edges belong to its neighbours as
 * well) is covered, and nothing below it: it then has no image, and the ground there shows what
 * ground without images shows. */
#ifndef BAKE_OPEN_H
#define BAKE_OPEN_H

#include "bake_image.h"
#include "bake_own.h"

#define BAKE_OPEN_NEAR 2u

/* Where texels of the finest lattice lie: `samples` apart, the first one (first_x, first_y) texels
 * from the south-west; those beyond the ground's last sample lie on it. */
typedef struct bake_texel_place {
    double samples, last_x, last_y;
    uint32_t first_x, first_y;
} bake_texel_place;

/* Fills the texels of the finest lattice that are not covered, and finds image->open.
 * `distance` as of bake_nearest_fill; it is used up. own NULL: the nearest colour goes on
 * everywhere. 0 or -1 (said). */
int bake_open_fill(bake_image *image, const ff_terrain_info *info, bake_own *own,
                   const bake_texel_place *place, const bake_grid *distance);
/* Fills the points of a coarser lattice, whose place is told, that do not lie on the finer one:
 * that begins `skip` of its points further on. 0 or -1 (said). */
int bake_open_beyond(bake_own *own, const bake_texel_place *place, const bake_grid *fine,
                     ff_sheet skip, const bake_grid *coarse);
/* The same of an image that covers nothing of it: image->open alone. */
int bake_open_all(bake_image *image, const ff_terrain_info *info);
/* 1: no image covers the node; 0; -1 (said). */
int bake_is_open(const bake_image *image, const ff_terrain_info *info, ff_key key);

#endif
