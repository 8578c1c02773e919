/* Places, depths and boxes as the horizon sees them: shared by its files. */
#ifndef FF_HORIZON_LOCAL_H
#define FF_HORIZON_LOCAL_H

#include "ff_horizon.h"

#define ONE         (1 << 16) /* slopes and places beyond are not told apart */
#define COLUMN_LOG2 11        /* of a place, Q16: 64 columns from -1 to 1 */
#define SLACK       8         /* more than places may be off */
#define NONE        (INT32_MIN / 2)
#define DEPTH_BITS  30
#define RING        (FF_HORIZON_WEDGES * FF_HORIZON_COLUMNS)

FF_STATIC_ASSERT(FF_HORIZON_COLUMNS << COLUMN_LOG2 == 2 * ONE);

enum wedge { EAST, NORTH, WEST, SOUTH };

/* ---- places ---- */

/* 2^(31+n) / depth, where depth is 2^n and more and less than 2^(n+1); and how far a length and its
 * product with it are shifted to become Q16 of the depth. */
typedef struct inverse {
    int32_t depth, reciprocal;
    uint8_t before, after;
} inverse;

void ff_horizon_invert(int32_t depth, inverse *to);

/* length / depth, Q16, off by 2 at most; no more than 2 either way. */
static inline int32_t by_depth(int32_t length, const inverse *of)
{
    if (length >= 2 * of->depth) return 2 * ONE;
    if (length <= -2 * of->depth) return -2 * ONE;
    /* shifted as unsigned: below 2^19 where it is shifted at all */
    int32_t shifted = (int32_t)((uint32_t)length << of->before);
    return (int32_t)(((int64_t)shifted * of->reciprocal) >> 32) >> of->after;
}

static inline int32_t slope_at_least(int32_t height, const inverse *of)
{
    return by_depth(height, of) - 2;
}
static inline int32_t slope_at_most(int32_t height, const inverse *of)
{
    return by_depth(height, of) + 2;
}

/* Cut off a little beyond the sides of a wedge. */
static inline int32_t place_of(int32_t across, const inverse *of)
{
    int32_t place = by_depth(across, of), most = ONE + (1 << COLUMN_LOG2) - 1;
    return place > most ? most : place < -most ? -most : place;
}

/* -1 to FF_HORIZON_COLUMNS. */
static inline int column_at(int32_t place)
{
    return ((place + ONE + (1 << COLUMN_LOG2)) >> COLUMN_LOG2) - 1;
}

static inline int32_t first_of(int column) { return column * (1 << COLUMN_LOG2) - ONE; }

/* ---- boxes ---- */

/* A box as a wedge sees it: depths, and distances across, of the part that lies in the wedge. */
typedef struct sector {
    int32_t near, far, low, high;
} sector;

/* 0: none of it does. */
static inline int in_wedge(enum wedge wedge, const ff_box *box, sector *to)
{
    unsigned axis = wedge == NORTH || wedge == SOUTH;
    int ahead = wedge == EAST || wedge == NORTH;
    to->near = (int32_t)(ahead ? box->lo[axis] : -box->hi[axis]);
    to->far = (int32_t)(ahead ? box->hi[axis] : -box->lo[axis]);
    to->low = (int32_t)box->lo[!axis];
    to->high = (int32_t)box->hi[!axis];
    int32_t aside = to->low > 0 ? to->low : to->high < 0 ? -to->high : 0;
    if (to->far <= 0 || aside > to->far) return 0;
    if (to->near < aside) to->near = aside;
    return 1;
}

/* Are all of its coordinates within the depths that are reckoned with? */
static inline int within_depths(const ff_box *box)
{
    for (unsigned axis = 0; axis < 3; axis++)
        if (box->lo[axis] <= -(1 << DEPTH_BITS) || box->hi[axis] >= 1 << DEPTH_BITS) return 0;
    return 1;
}

static inline const ff_node *node_of(const ff_tree *tree, uint64_t key)
{
    return &tree->node[key & (FF_NODES_MAX - 1)];
}

/* Of what is drawn of a node: it lies between its own heights, whatever its error. */
ff_box ff_horizon_drawn_box(const ff_tree *tree, const ff_horizon *horizon, const ff_node *node);

#endif
