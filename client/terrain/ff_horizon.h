/* The horizon: in every direction how steeply near ground stands before what lies behind it. Ground
 * all of which lies lower is hidden: it is not drawn, and not asked for.
 *
 * The plane round the eye is cut into four wedges, to the east, north, west and south, each of them
 * into columns. In a wedge a point has a depth (the distance along its axis), a place (the distance
 * across it, by the depth) and a slope (its height over the eye, by the depth): a straight line is
 * seen straight, and between two of its points no lower than the lower one. What raises a column is
 * a row or column of vertices that runs across the wedge: whatever is deeper, and seen lower, is
 * behind the ground that leads up to it. So no roll or pitch matters, and what is left out changes
 * no pixel: the horizon is made from what is drawn.
 *
 * Each column has two slopes. Drawn ground, and what may come of it, is hidden by FF_HIDES_DRAWN:
 * should finer data lower what hides it, it is asked for then. Tiles of which nothing is here, and
 * would leave a hole, are hidden by FF_HIDES_UNKNOWN, lower by the geometric error of the nodes
 * that hide: finer data may lower them so far.
 *
 * The horizon knows the steepest line of a column only, and whatever is nearer than that line is
 * not hidden by it. So a node is asked about while the horizon holds exactly what is nearer. */
#ifndef FF_HORIZON_H
#define FF_HORIZON_H

#include "ff_tree_local.h"

#define FF_HORIZON_WEDGES  4
#define FF_HORIZON_COLUMNS 64 /* of a wedge */

enum ff_hides { FF_HIDES_DRAWN, FF_HIDES_UNKNOWN, FF_HIDES_KINDS };

/* Slopes are Q16, places in the column, Q11, depths wu. */
typedef struct ff_horizon_column {
    int32_t slope[FF_HIDES_KINDS], depth[FF_HIDES_KINDS];
    /* the highest line that fills only a part of the column, from one side up to `part_at` */
    int32_t part_slope, part_error, part_depth;
    int16_t part_at;
    uint8_t part_side;
    int32_t highest, lowest; /* the tops of nodes, before it is known what they hide */
} ff_horizon_column;

struct ff_horizon {
    int32_t reach_wu;   /* ground nearer than this, along both axes, is whole: it may hide others */
    int32_t half_pixel; /* slope of half a pixel */
    int32_t rounding_wu; /* of drawn heights */
    uint32_t raisers;    /* nodes that may hide others */
    uint8_t rests;       /* views before it is tried again whether it pays */
    /* columns of each wedge that are in view; none: first > last */
    int16_t first[FF_HORIZON_WEDGES], last[FF_HORIZON_WEDGES];
    /* and one beside each end, which nobody reads */
    ff_horizon_column column[FF_HORIZON_WEDGES][FF_HORIZON_COLUMNS + 2];
};

/* Nothing hides yet. For the tree's view; what is out of it counts as hidden. `keys`: the nodes in
 * view from the nearest to the farthest, slots in the lower FF_SLOT_BITS; behind them this leaves
 * as many words for ff_horizon_raise. `always` 0: nothing hides where finding it would cost more
 * than drawing it, by what may be hidden, and what lately was; what lacks children may always be,
 * or they would be asked for. */
void ff_horizon_begin(const ff_tree *tree, ff_horizon *horizon, uint64_t *keys, uint32_t count,
                      int always);
/* The tree's figures say what was found hidden: where it was too little, it rests for some views.
 */
void ff_horizon_end(const ff_tree *tree, ff_horizon *horizon);
/* What node `i` of them hides. From the nearest on, or less is found. `coarser` as of ff_drawn, or
 * FF_COARSER_UNKNOWN. */
void ff_horizon_raise(const ff_tree *tree, ff_horizon *horizon, const uint64_t *keys,
                      uint32_t count, uint32_t i, unsigned coarser);
/* 1 when nothing of the box can be seen. */
int ff_horizon_hides(const ff_horizon *horizon, const ff_box *box, enum ff_hides kind);
/* The same of what is drawn of a node. */
int ff_horizon_hides_node(const ff_tree *tree, const ff_horizon *horizon, const ff_node *node);
/* And of whatever finer data may make of it. */
int ff_horizon_hides_children(const ff_tree *tree, const ff_horizon *horizon, const ff_node *node);

#endif
