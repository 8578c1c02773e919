/* The cut of a ground, by places. */
#ifndef FF_COVER_H
#define FF_COVER_H

#include "ff_tree_local.h"

static inline ff_area ff_area_widened(ff_area area, int64_t by_wu)
{
    for (unsigned axis = 0; axis < 2; axis++) {
        int64_t lo = area.lo[axis] - by_wu, hi = area.hi[axis] + by_wu;
        area.lo[axis] = (int32_t)(lo < INT32_MIN ? INT32_MIN : lo);
        area.hi[axis] = (int32_t)(hi > INT32_MAX ? INT32_MAX : hi);
    }
    return area;
}

/* A walk over the nodes of a ground's cut, and those left out, that touch an area. */
typedef struct ff_over {
    const ff_tree *tree;
    const ff_terrain_info *info;
    ff_area area;
    uint32_t root, depth;
    uint32_t stack[3 * FF_LEVELS_MAX + 1];
} ff_over;

void ff_over_begin(ff_over *over, const ff_tree *tree, uint32_t ground, const ff_area *area);
/* NULL: there are no more. */
const ff_node *ff_over_next(ff_over *over);

#endif
