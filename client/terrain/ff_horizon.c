/* The horizon: begun for a view, and asked. */
#include "ff_horizon_local.h"

/* Where fewer nodes may be hidden, of those in view or for each one that may hide, the horizon
 * costs more than it saves: over three mountain terrains, 100 to 2000 m up, pictures of 240 and 640
 * pixels. */
#define HIDDEN_LEAST 4 /* one in so many */
#define WORTH_IT     2
#define WORTH_IT_OF  3
/* A node that is not drawn, and the children that are not asked for. */
#define LACKING_WORTH 4
/* To draw a node takes this many times what it takes to find what one hides; where less was found
 * hidden, the horizon rests for so many views. */
#define HIDING_LEAST 12
#define RESTS        15

void ff_horizon_invert(int32_t depth, inverse *to)
{
    unsigned bits = 0;
    FF_ASSERT(depth > 0 && depth < 1 << DEPTH_BITS);
    for (unsigned half = 16; half; half /= 2)
        if (depth >> bits >> half) bits += half;
    uint32_t reciprocal = c3d_divide_saturated(UINT64_C(1) << (31 + bits), (uint64_t)depth);
    to->depth = depth;
    to->reciprocal = (int32_t)(reciprocal < INT32_MAX ? reciprocal : INT32_MAX);
    to->before = (uint8_t)(bits < 17 ? 17 - bits : 0);
    to->after = (uint8_t)(bits > 17 ? bits - 17 : 0);
}

/* ---- the view ---- */

/* Columns in the order of a walk round the eye. */
static void column_on_ring(unsigned at, enum wedge *wedge, int *column)
{
    *wedge = (enum wedge)(at / FF_HORIZON_COLUMNS % FF_HORIZON_WEDGES);
    *column = (int)(at % FF_HORIZON_COLUMNS);
    if (*wedge == NORTH || *wedge == WEST) *column = FF_HORIZON_COLUMNS - 1 - *column;
}

static int ring_of(int64_t east, int64_t north)
{
    int64_t x = east < 0 ? -east : east, y = north < 0 ? -north : north;
    enum wedge wedge = x >= y ? (east >= 0 ? EAST : WEST) : (north >= 0 ? NORTH : SOUTH);
    int64_t across = x >= y ? north : east, depth = x >= y ? x : y;
    int column = (int)((across + depth) * (FF_HORIZON_COLUMNS / 2) / (depth ? depth : 1));
    column = column < FF_HORIZON_COLUMNS ? column : FF_HORIZON_COLUMNS - 1;
    if (wedge == NORTH || wedge == WEST) column = FF_HORIZON_COLUMNS - 1 - column;
    return (int)wedge * FF_HORIZON_COLUMNS + column;
}

/* 1 when the view holds what is straight above or below the eye, or nearly so. */
static int sees_pole(const ff_tree *tree)
{
    unsigned above = 0, below = 0;
    for (unsigned i = 0; i < FF_PLANES; i++) {
        above += tree->plane[i][2] >= 0;
        below += tree->plane[i][2] <= 0;
    }
    return above == FF_PLANES || below == FF_PLANES;
}

/* The columns between the corners of the picture: first on the ring, and how many. */
static int columns_in_view(const ff_tree *tree, int *first)
{
    const c3d_camera *camera = &tree->view.camera;
    c3d_rotation rotation;
    int start = 0, low = 0, high = 0;
    *first = 0;
    if (sees_pole(tree)) return RING;
    c3d_rotation_from_camera(camera, &rotation);
    for (unsigned corner = 0; corner < 4; corner++) {
        int64_t side_q8[2] = { camera->width * (corner & 1 ? 128 : -128),
                               camera->height * (corner >> 1 ? 128 : -128) },
                way[2];
        for (unsigned axis = 0; axis < 2; axis++)
            way[axis] = ((int64_t)rotation.m[2][axis] * camera->focal_q8 +
                         rotation.m[0][axis] * side_q8[0] + rotation.m[1][axis] * side_q8[1]) >>
                        16;
        int at = ring_of(way[0], way[1]);
        if (corner == 0) start = at;
        int turn = (at - start + RING + RING / 2) % RING - RING / 2;
        low = turn < low ? turn : low;
        high = turn > high ? turn : high;
    }
    if (high - low > RING * 7 / 16) return RING;
    *first = (start + low - 1 + RING) % RING;
    return high - low + 3;
}

/* ---- beginning ---- */

/* Ground this near is whole, and the eye above it; 0: it is not. */
static int32_t whole_ground_wu(const ff_tree *tree)
{
    const c3d_camera *camera = &tree->view.camera;
    int32_t ground_wu;
    int64_t reach = tree->whole_wu;
    for (unsigned axis = 0; axis < 3; axis++) {
        int64_t away = (int64_t)camera->pos_wu[axis] - tree->view.centre_wu[axis];
        away = away < 0 ? -away : away;
        reach = tree->whole_wu - away < reach ? tree->whole_wu - away : reach;
    }
    if (reach <= 0 ||
        !ff_tree_drawn_height(tree, camera->pos_wu[0], camera->pos_wu[1], &ground_wu) ||
        (int64_t)camera->pos_wu[2] - ground_wu <= 2 * (int64_t)camera->near_wu)
        return 0;
    return reach < 1 << DEPTH_BITS ? (int32_t)reach : (1 << DEPTH_BITS) - 1;
}

static void clear(const ff_tree *tree, ff_horizon *horizon)
{
    int ring_first, count = columns_in_view(tree, &ring_first);
    horizon->reach_wu = whole_ground_wu(tree);
    horizon->half_pixel = (int32_t)c3d_divide_saturated(UINT64_C(128) << 16,
                                                        (uint64_t)tree->view.camera.focal_q8) +
                          1;
    horizon->rounding_wu = 0;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        int32_t rounding_wu = ff_steps_wu(&tree->ground[g], 1) / 2 + 1;
        if (rounding_wu > horizon->rounding_wu) horizon->rounding_wu = rounding_wu;
    }
    for (unsigned wedge = 0; wedge < FF_HORIZON_WEDGES; wedge++) {
        horizon->first[wedge] = FF_HORIZON_COLUMNS;
        horizon->last[wedge] = -1;
    }
    for (int i = 0; i < RING; i++) {
        enum wedge wedge;
        int column, seen = i < count;
        column_on_ring((unsigned)(ring_first + i), &wedge, &column);
        ff_horizon_column *at = &horizon->column[wedge][column + 1];
        at->slope[0] = at->slope[1] = seen ? NONE : INT32_MAX;
        at->depth[0] = at->depth[1] = 0;
        at->part_slope = NONE;
        at->highest = NONE;
        at->lowest = INT32_MAX;
        if (seen && column < horizon->first[wedge]) horizon->first[wedge] = (int16_t)column;
        if (seen && column > horizon->last[wedge]) horizon->last[wedge] = (int16_t)column;
    }
}

/* The columns in view that a sector lies in, and its highest slope. */
typedef struct span {
    int first, last;
    int32_t top;
} span;

/* 0 when the sector reaches up to the eye. */
static int span_of(const ff_horizon *horizon, enum wedge wedge, const sector *part, int32_t top_wu,
                   span *to)
{
    inverse near, far;
    if (part->near <= 0) return 0;
    ff_horizon_invert(part->near, &near);
    ff_horizon_invert(part->far, &far);
    to->top = slope_at_most(top_wu, top_wu > 0 ? &near : &far);
    to->first = column_at(place_of(part->low, part->low > 0 ? &far : &near) - SLACK);
    to->last = column_at(place_of(part->high, part->high > 0 ? &near : &far) + SLACK);
    if (to->first < horizon->first[wedge]) to->first = horizon->first[wedge];
    if (to->last > horizon->last[wedge]) to->last = horizon->last[wedge];
    return 1;
}

ff_box ff_horizon_drawn_box(const ff_tree *tree, const ff_horizon *horizon, const ff_node *node)
{
    ff_box box;
    ff_node_box(tree, node, &box);
    box.hi[2] += horizon->rounding_wu - ff_steps_wu(ff_ground_of(tree, node->key),
                                                    ff_geometric_error_decode(node->error_code));
    return box;
}

/* ---- what may be hidden at all ---- */

/* The span in each wedge of a box that may be hidden, with first > last where it does not lie. 0:
 * it may not. */
static int spans_of(const ff_horizon *horizon, const ff_box *box, span to[FF_HORIZON_WEDGES])
{
    sector part;
    if (!within_depths(box)) return 0;
    for (unsigned wedge = 0; wedge < FF_HORIZON_WEDGES; wedge++) {
        to[wedge] = (span){ 0, -1, -ONE };
        if (horizon->first[wedge] > horizon->last[wedge] ||
            !in_wedge((enum wedge)wedge, box, &part))
            continue;
        if (!span_of(horizon, (enum wedge)wedge, &part, (int32_t)box->hi[2], &to[wedge]) ||
            to[wedge].top <= -ONE)
            return 0;
    }
    return 1;
}

/* Were all nodes as high as their boxes all over, would the nearer ones hide this one? */
static int may_be_hidden(ff_horizon *horizon, const span spans[FF_HORIZON_WEDGES])
{
    int hidden = 1;
    for (unsigned wedge = 0; wedge < FF_HORIZON_WEDGES; wedge++) {
        const span *of = &spans[wedge];
        for (int i = of->first; i <= of->last; i++) {
            ff_horizon_column *column = &horizon->column[wedge][i + 1];
            if (of->top < column->highest) continue;
            hidden = 0;
            column->highest = of->top;
        }
    }
    return hidden;
}

/* What a node's top must be higher than to hide any of those that may be hidden behind it; it is
 * one of them, or not. */
static int32_t need_of(ff_horizon *horizon, const span spans[FF_HORIZON_WEDGES], int may_be)
{
    int32_t need = INT32_MAX;
    for (unsigned wedge = 0; wedge < FF_HORIZON_WEDGES; wedge++) {
        const span *of = &spans[wedge];
        for (int i = of->first; i <= of->last; i++) {
            ff_horizon_column *column = &horizon->column[wedge][i + 1];
            if (column->lowest < need) need = column->lowest;
            if (may_be && of->top < column->lowest) column->lowest = of->top;
        }
    }
    return need;
}

static int32_t highest_top(const span spans[FF_HORIZON_WEDGES])
{
    int32_t top = NONE;
    for (unsigned wedge = 0; wedge < FF_HORIZON_WEDGES; wedge++)
        if (spans[wedge].first <= spans[wedge].last && spans[wedge].top > top)
            top = spans[wedge].top;
    return top;
}

/* Will it be asked for, if it is not hidden? */
static int lacks_children(const ff_node *node)
{
    return node->flags & FF_NODE_WANTED && !ff_node_has_children(node);
}

/* Marks in `word` the nodes that may be hidden; returns what that is worth. */
static uint32_t survey(const ff_tree *tree, ff_horizon *horizon, const uint64_t *keys,
                       uint32_t count, uint64_t *word)
{
    uint32_t found = 0;
    span spans[FF_HORIZON_WEDGES];
    for (uint32_t i = 0; i < count; i++) {
        const ff_node *node = node_of(tree, keys[i]);
        ff_box box = ff_horizon_drawn_box(tree, horizon, node);
        word[i] = spans_of(horizon, &box, spans) && may_be_hidden(horizon, spans);
        if (word[i]) found += lacks_children(node) ? LACKING_WORTH : 1;
    }
    return found;
}

/* Makes of the marks what each node has to be higher than to hide one of those behind it; returns
 * how many are. */
static uint32_t find_needs(const ff_tree *tree, ff_horizon *horizon, const uint64_t *keys,
                           uint32_t count, uint64_t *word)
{
    uint32_t raisers = 0;
    span spans[FF_HORIZON_WEDGES];
    for (uint32_t i = count; i-- > 0;) {
        ff_box box = ff_horizon_drawn_box(tree, horizon, node_of(tree, keys[i]));
        int32_t need = NONE, top = ONE; /* of one that reaches up to the eye */
        if (spans_of(horizon, &box, spans)) {
            need = need_of(horizon, spans, (int)word[i]);
            top = highest_top(spans);
        }
        raisers += top > need;
        word[i] = (uint32_t)need;
    }
    return raisers;
}

/* 1 when it may rest: nothing in view would be asked for that may be hidden, and what is hidden
 * leaves no room for finer ground. */
static int may_rest(const ff_tree *tree, const uint64_t *keys, uint32_t count)
{
    if (tree->limit_step || tree->whole_wu < tree->quality.view_wu) return 0;
    for (uint32_t i = 0; i < count; i++)
        if (lacks_children(node_of(tree, keys[i]))) return 0;
    return 1;
}

void ff_horizon_begin(const ff_tree *tree, ff_horizon *horizon, uint64_t *keys, uint32_t count,
                      int always)
{
    horizon->raisers = 0;
    if (!always && horizon->rests && may_rest(tree, keys, count)) {
        horizon->rests--;
        horizon->reach_wu = 0;
        return;
    }
    clear(tree, horizon);
    if (horizon->reach_wu == 0) return;
    uint32_t found = survey(tree, horizon, keys, count, keys + count);
    int worth_it = always || found * HIDDEN_LEAST >= count;
    if (worth_it) {
        horizon->raisers = find_needs(tree, horizon, keys, count, keys + count);
        worth_it = always || found * WORTH_IT_OF >= horizon->raisers * WORTH_IT;
    }
    if (!worth_it) horizon->reach_wu = 0;
}

void ff_horizon_end(const ff_tree *tree, ff_horizon *horizon)
{
    const ff_tree_stats *found = &tree->stats;
    uint32_t limit = tree->quality.triangles_max;
    if (horizon->raisers == 0) return;
    int fits = !limit || found->triangles + found->triangles_hidden <= limit - limit / 8;
    horizon->rests = fits && found->nodes_hidden * HIDING_LEAST < horizon->raisers ? RESTS : 0;
}

int ff_horizon_hides(const ff_horizon *horizon, const ff_box *box, enum ff_hides kind)
{
    sector part;
    span of;
    if (horizon->reach_wu == 0 || !within_depths(box)) return 0;
    for (unsigned wedge = 0; wedge < FF_HORIZON_WEDGES; wedge++) {
        if (horizon->first[wedge] > horizon->last[wedge] ||
            !in_wedge((enum wedge)wedge, box, &part))
            continue;
        if (!span_of(horizon, (enum wedge)wedge, &part, (int32_t)box->hi[2], &of)) return 0;
        of.top += horizon->half_pixel;
        if (of.top <= -ONE) return 0;
        for (int i = of.first; i <= of.last; i++) {
            const ff_horizon_column *column = &horizon->column[wedge][i + 1];
            if (column->slope[kind] <= of.top || column->depth[kind] > part.near) return 0;
        }
    }
    return 1;
}

int ff_horizon_hides_node(const ff_tree *tree, const ff_horizon *horizon, const ff_node *node)
{
    ff_box box = ff_horizon_drawn_box(tree, horizon, node);
    return ff_horizon_hides(horizon, &box, FF_HIDES_DRAWN);
}

int ff_horizon_hides_children(const ff_tree *tree, const ff_horizon *horizon, const ff_node *node)
{
    ff_box box;
    ff_node_box(tree, node, &box);
    return ff_horizon_hides(horizon, &box, FF_HIDES_DRAWN);
}

int ff_box_seen(const ff_tree *tree, const ff_box *box)
{
    return ff_box_in_view(tree, box) &&
           !(tree->horizon && ff_horizon_hides(tree->horizon, box, FF_HIDES_UNKNOWN));
}

int ff_node_seen(const ff_tree *tree, const ff_node *node, const ff_box *box)
{
    return !(node->flags & FF_NODE_HIDDEN) && ff_box_seen(tree, box);
}
