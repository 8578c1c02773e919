/* Which images a node wears: over each part of it the level whose texels are about as large as
 * pixels.
 *
 * Images are a tree over the same keys as heights, and what is seen of them is a cut of its own:
 * rough ground is drawn in small nodes whose own images would have several texels to a pixel, and
 * wears those of their ancestors; a plain is drawn in large nodes, and where the viewer is near
 * squares of them wear images of finer levels. So much finer, at most (ff_image_depth), that each
 * lies on two cells or more each way: then no triangle of a border strip lies on two images.
 *
 * A texel counts as large as the square that covers as much of the picture: ground seen at a
 * grazing angle shows fewer texels, and its image is chosen as if it were farther away. The ground
 * may lean towards the viewer by as much as the node's lowest and highest heights allow. */
#ifndef FF_WEAR_H
#define FF_WEAR_H

#include "../terrain/ff_strips.h"
#include "../terrain/ff_tree.h"

/* What images are looked at from, and how well. */
typedef struct ff_texel_look {
    ff_frame frame;
    int32_t pos_wu[3]; /* in the frame */
    int32_t focal_q8;
    int32_t texel_px_q8; /* no finer level is wanted where texels are no larger */
    uint8_t across;      /* 1: texels count as large as they are across, however slanting */
} ff_texel_look;

/* Squares of a node, and the finest image that is wanted on them. */
typedef struct ff_wear {
    ff_key image;
    ff_squares squares; /* of a node that wears one image all */
} ff_wear;

#define FF_WEAR_MAX (1u << 2 * FF_IMAGE_DEPTH_MAX)

/* The squares of a node on which an image of its level or a finer one lies. */
ff_squares ff_wear_squares(unsigned node_log2, ff_key node, ff_key image);

/* Lists what a drawn node wears: how many, 0 when its ground has no images. No square is named
 * twice, and none is left out. */
unsigned ff_wear_list(const ff_tree *tree, const ff_drawn *drawn, const ff_texel_look *look,
                      ff_wear list[FF_WEAR_MAX]);

#endif
