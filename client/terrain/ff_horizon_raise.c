/* The horizon raised: by lines of vertices of drawn nodes. */
#include "ff_horizon_local.h"

#define LINE_STEP 2 /* every line would hide 1 % more, and cost twice as much */

enum part_side { FROM_FIRST, FROM_LAST };

/* A line of vertices across a wedge, in the order of its places. */
typedef struct line {
    unsigned last;
    int32_t place[(1 << FF_NODE_LOG2_MAX) + 1], slope[(1 << FF_NODE_LOG2_MAX) + 1];
    int32_t depth, error; /* the largest depth; the error as a slope */
} line;

static inline int32_t lower(int32_t a, int32_t b) { return a < b ? a : b; }
static inline int32_t higher(int32_t a, int32_t b) { return a > b ? a : b; }

static inline void raise_column(ff_horizon_column *column, int32_t slope, int32_t error,
                                int32_t depth)
{
    if (slope > column->slope[FF_HIDES_DRAWN]) {
        column->slope[FF_HIDES_DRAWN] = slope;
        column->depth[FF_HIDES_DRAWN] = depth;
    }
    if (slope - error > column->slope[FF_HIDES_UNKNOWN]) {
        column->slope[FF_HIDES_UNKNOWN] = slope - error;
        column->depth[FF_HIDES_UNKNOWN] = depth;
    }
}

/* A line that ends in the column. Another one may go on where it ends: the next node's. */
static void raise_part(ff_horizon_column *column, const line *of, int32_t slope, int32_t at,
                       enum part_side side)
{
    if (slope <= NONE) return;
    int meets = column->part_side != side &&
                (side == FROM_FIRST ? at >= column->part_at : at <= column->part_at);
    if (column->part_slope > NONE && meets)
        raise_column(column, lower(slope, column->part_slope),
                     higher(of->error, column->part_error), higher(of->depth, column->part_depth));
    if (slope <= column->part_slope) return;
    column->part_slope = slope;
    column->part_error = of->error;
    column->part_depth = of->depth;
    column->part_at = (int16_t)at;
    column->part_side = (uint8_t)side;
}

/* Raises the columns that the line fills, or a part of which: one that ends at the border of two
 * columns, as nearly as places are known, is a part of both. */
static void raise_by(ff_horizon_column *wedge, const line *of)
{
    int32_t start = of->place[0], end = of->place[of->last],
            first = lower(of->slope[0], of->slope[1]), low = INT32_MAX;
    int column = column_at(start);
    if (start - first_of(column) < SLACK && column >= 0)
        raise_part(&wedge[column], of, first, start - first_of(column - 1), FROM_LAST);
    for (unsigned i = 0; i < of->last; i++) {
        int32_t slope = lower(of->slope[i], of->slope[i + 1]);
        low = lower(low, slope);
        while (of->place[i + 1] >= first_of(column + 1) + SLACK) {
            ff_horizon_column *at = &wedge[column + 1];
            FF_ASSERT(column >= -1 && column <= FF_HORIZON_COLUMNS);
            if (start <= first_of(column) - SLACK)
                raise_column(at, low, of->error, of->depth);
            else
                raise_part(at, of, low, start - first_of(column), FROM_LAST);
            low = slope;
            column++;
        }
    }
    if (start <= first_of(column) - SLACK)
        raise_part(&wedge[column + 1], of, low, end - first_of(column), FROM_FIRST);
    if (first_of(column + 1) - end < SLACK && column < FF_HORIZON_COLUMNS)
        raise_part(&wedge[column + 2], of, lower(of->slope[of->last - 1], of->slope[of->last]),
                   end - first_of(column + 1), FROM_FIRST);
}

/* A node as a wedge sees it. */
typedef struct aspect {
    const ff_tree *tree;
    const ff_horizon *horizon;
    const ff_node *node;
    const ff_terrain_info *info;
    const uint16_t *heights;
    enum wedge wedge;
    unsigned cells, coarser;
    int by_columns; /* 1: lines run along a column: row by row */
    int32_t error_wu, need;
} aspect;

/* A vertex from the eye: ahead, across, up. */
typedef struct vertex {
    int32_t ahead, across, up;
} vertex;

static inline uint32_t height_at(const aspect *of, unsigned column, unsigned row)
{
    return of->heights[row * (of->cells + 1) + column];
}

/* No more than the height drawn, nor than the node's own: at a side beside a coarser node every
 * second vertex is left out until that node is finer. */
static uint32_t drawn_height_at(const aspect *of, unsigned column, unsigned row)
{
    unsigned coarser = of->coarser, last = of->cells;
    int along_row = (row == 0 && coarser >> FF_SIDE_SOUTH & 1u) ||
                    (row == last && coarser >> FF_SIDE_NORTH & 1u),
        along_column = (column == 0 && coarser >> FF_SIDE_WEST & 1u) ||
                       (column == last && coarser >> FF_SIDE_EAST & 1u);
    uint32_t own = height_at(of, column, row), drawn = own;
    if (along_row && column & 1)
        drawn = (height_at(of, column - 1, row) + height_at(of, column + 1, row)) / 2;
    else if (along_column && row & 1)
        drawn = (height_at(of, column, row - 1) + height_at(of, column, row + 1)) / 2;
    return drawn < own ? drawn : own;
}

static inline vertex vertex_at(const aspect *of, unsigned number, unsigned along)
{
    const int32_t *eye_wu = of->tree->view.camera.pos_wu;
    unsigned column = of->by_columns ? number : along, row = of->by_columns ? along : number;
    uint32_t height = of->coarser ? drawn_height_at(of, column, row) : height_at(of, column, row);
    int32_t place_wu[3];
    ff_shape_place(of->info, of->node->key, &of->node->placed, column, row, height, place_wu);
    /* the node's box is within the depths */
    int32_t east = place_wu[0] - eye_wu[0], north = place_wu[1] - eye_wu[1],
            up = place_wu[2] - eye_wu[2];
    switch (of->wedge) {
        case EAST: return (vertex){ east, north, up };
        case NORTH: return (vertex){ north, east, up };
        case WEST: return (vertex){ -east, north, up };
        default: return (vertex){ -north, east, up };
    }
}

/* How much lower than its height says ground may be drawn. */
static int32_t lowered_wu(const aspect *of, const vertex *at)
{
    int64_t across = at->across < 0 ? -(int64_t)at->across : at->across;
    return ff_shape_drop_wu(of->info, at->ahead + (int64_t)FF_SHAPE_DROP_SLACK_WU,
                            across + FF_SHAPE_DROP_SLACK_WU);
}

/* The line's highest vertex, over the eye. */
static int32_t highest_of(const aspect *of, unsigned number)
{
    unsigned step = of->by_columns ? of->cells + 1 : 1;
    const uint16_t *height = of->heights + (of->by_columns ? number : number * (of->cells + 1));
    uint32_t highest = 0;
    for (unsigned i = 0; i <= of->cells; i++, height += step)
        if (*height > highest) highest = *height;
    return ff_height_wu(of->info, highest) - of->tree->view.camera.pos_wu[2];
}

/* 1 when a line between two vertices may hide something: it is before the eye, in whole ground, in
 * the columns in view, and may be seen high enough. */
static int worth_a_look(const aspect *of, unsigned number, const vertex *start, const vertex *end,
                        inverse *near)
{
    inverse far;
    int32_t nearest = lower(start->ahead, end->ahead), farthest = higher(start->ahead, end->ahead),
            low = lower(start->across, end->across), high = higher(start->across, end->across);
    if (nearest <= 0 || farthest > of->horizon->reach_wu) return 0;
    ff_horizon_invert(nearest, near);
    far = *near;
    if (farthest != nearest) ff_horizon_invert(farthest, &far);
    int32_t up = highest_of(of, number);
    return slope_at_most(up, up > 0 ? near : &far) > of->need &&
           column_at(place_of(high, high > 0 ? near : &far)) >= of->horizon->first[of->wedge] &&
           column_at(place_of(low, low > 0 ? &far : near)) <= of->horizon->last[of->wedge];
}

/* 1, or 0 when the line hides nothing. */
static int see_line(const aspect *of, unsigned number, line *to)
{
    inverse depth;
    const vertex start = vertex_at(of, number, 0), end = vertex_at(of, number, of->cells);
    if (!worth_a_look(of, number, &start, &end, &depth)) return 0;
    int32_t drop_wu = higher(lowered_wu(of, &start), lowered_wu(of, &end)) +
                      of->horizon->rounding_wu;
    unsigned reversed = end.across < start.across ? of->cells : 0;
    to->last = of->cells;
    to->depth = depth.depth;
    to->error = slope_at_most(of->error_wu, &depth);
    for (unsigned i = 0; i <= of->cells; i++) {
        const vertex at = i == 0 ? start : i == of->cells ? end : vertex_at(of, number, i);
        unsigned order = reversed ? reversed - i : i;
        if (at.ahead != depth.depth) {
            if (at.ahead <= 0) return 0;
            ff_horizon_invert(at.ahead, &depth);
            to->depth = higher(to->depth, at.ahead);
            to->error = higher(to->error, slope_at_most(of->error_wu, &depth));
        }
        int32_t slope = slope_at_least(at.up - drop_wu, &depth);
        to->place[order] = place_of(at.across, &depth);
        to->slope[order] = slope < -ONE ? NONE : lower(slope, ONE);
    }
    return 1;
}

/* Do lines along the node's columns run across the wedge, rather than those along its rows? */
static int columns_run_across(const aspect *of)
{
    aspect columns = *of;
    columns.by_columns = 1;
    vertex from = vertex_at(&columns, 0, 0), to = vertex_at(&columns, 0, of->cells);
    int64_t across = (int64_t)to.across - from.across, ahead = (int64_t)to.ahead - from.ahead;
    return across * across > ahead * ahead;
}

void ff_horizon_raise(const ff_tree *tree, ff_horizon *horizon, const uint64_t *keys,
                      uint32_t count, uint32_t i, unsigned coarser)
{
    const ff_node *node = node_of(tree, keys[i]);
    aspect of = { .tree = tree,
                  .horizon = horizon,
                  .node = node,
                  .info = ff_ground_of(tree, node->key),
                  .heights = tree->heights + ff_slot_of(tree, node) * ff_heights_per_node(tree),
                  .cells = ff_node_side(tree->ground) - 1,
                  .need = (int32_t)(uint32_t)keys[count + i],
                  .coarser = coarser };
    sector part;
    line l;
    if (horizon->reach_wu == 0 || of.need >= ONE) return;
    if (tree->cover && ff_seam_touches(tree, node)) return; /* it may be drawn lower */
    ff_box box = ff_horizon_drawn_box(tree, horizon, node);
    if (!within_depths(&box)) return;
    of.error_wu = ff_steps_wu(of.info, ff_geometric_error_decode(node->error_code));
    if (coarser == FF_COARSER_UNKNOWN) of.coarser = ff_coarser_mask(tree, node);
    for (unsigned wedge = 0; wedge < FF_HORIZON_WEDGES; wedge++) {
        if (horizon->first[wedge] > horizon->last[wedge] ||
            !in_wedge((enum wedge)wedge, &box, &part) || part.near > horizon->reach_wu)
            continue;
        of.wedge = (enum wedge)wedge;
        of.by_columns = columns_run_across(&of);
        for (unsigned number = 0; number <= of.cells; number += LINE_STEP)
            if (see_line(&of, number, &l)) raise_by(horizon->column[wedge], &l);
    }
}
