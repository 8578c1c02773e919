/* The client's own estimate of its picture's error: an estimate, not a bound (what selection goes
 * by is one).
 *
 * Every drawn node is looked at in squares that look no wider than a quarter of their distance,
 * down to a part of a cell where the ground is near. A square counts by the pixels it covers,
 * unless nearer ground hides it, and is off by a part of its node's geometric error, projected
 * where the square lies: more where its cell is rough among those of its node. Beyond the drawn
 * ground the terrain is taken as level; there the error is a panorama's parallax and the size of
 * its texels, or how far the drawn ground's edge would have to come; so it is where a tile has not
 * come. Some hundred squares a
 * picture; nothing is kept, so that only who asks pays.
 */
#ifndef FF_ESTIMATE_H
#define FF_ESTIMATE_H

#include "ff_tree.h"

/* The panorama that stands beyond the ground of the tree. */
typedef struct ff_beyond {
    uint16_t face_size;     /* 0: there is none */
    int32_t position_wu[3]; /* where it was taken, in the view's frame */
    int32_t back_wu;        /* how far it reaches, along its axes */
} ff_beyond;

/* The error, pixels Q8, that 95 % of the pixels that show ground likely do not pass, as the tree
 * was last selected; 0 where there are none. */
uint32_t ff_estimate_p95_q8(const ff_tree *tree, const ff_beyond *beyond);

/* Far ground in the picture: what a far set (client/far) could mend. */
#define FF_FAR_RUNGS  7
#define FF_FAR_NEARER 2 /* of those that begin nearer than front_wu */
typedef struct ff_far_ground {
    /* pixels of ground beyond front_wu * 2^((i - FF_FAR_NEARER)/2) of the eye, along x or y */
    uint32_t pixels[FF_FAR_RUNGS];
    uint32_t error_q8;         /* how far off those beyond front_wu are, pixels, mean */
    uint32_t skyline_q8;       /* and where they meet the sky, rms; 0: nowhere */
    uint32_t nodes, far_nodes; /* drawn, and of them beyond front_wu */
} ff_far_ground;

/* As the tree was last selected. An error counts as 50 pixels at most. */
void ff_estimate_far(const ff_tree *tree, int32_t front_wu, ff_far_ground *far);

#endif
