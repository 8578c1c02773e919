/* Who is drawn where several grounds lie. Grounds are in order: finer spacing first, else the one
 * that came first. A ground stands in the rectangle of its tiles that are held round the viewer;
 * there those after it are left out, node by node, but for a ring inside its rim, where both are
 * drawn and the seam is made. Where it does not stand, they are drawn as if it were not there. */
#include "ff_cover.h"

#define SMALL_PX 16 /* a ground that shows as less is not drawn */

/* Vertices of a rim are moved for the seam: so are triangles up to two cells inside of it. */
#define RIM_CELLS 2
/* What is drawn beside a node that is left out has cells up to twice as large: they go down deep,
 * and are to lie inside of those triangles. */
#define BESIDE_CELLS 2

/* ---- areas ---- */

static ff_area key_area(const ff_tree *tree, ff_key key)
{
    ff_placed placed = ff_shape_put(ff_ground_of(tree, key), &tree->view.frame, key);
    return ff_area_of(tree, key, &placed);
}

/* 1 when all of an area, and what lies within `margin_wu` of it, is inside another. */
static int lies_inside(const ff_area *area, int64_t margin_wu, const ff_area *other)
{
    for (unsigned axis = 0; axis < 2; axis++)
        if (area->lo[axis] - margin_wu < other->lo[axis] ||
            area->hi[axis] + margin_wu > other->hi[axis])
            return 0;
    return 1;
}

/* ---- order ---- */

void ff_cover_rank(ff_tree *tree)
{
    ff_cover *cover = tree->cover;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        uint32_t at = g;
        for (; at > 0; at--) {
            if (tree->ground[cover->ranked[at - 1]].spacing_wu <= tree->ground[g].spacing_wu) break;
            cover->ranked[at] = cover->ranked[at - 1];
        }
        cover->ranked[at] = (uint8_t)g;
    }
    for (uint32_t rank = 0; rank < tree->ground_count; rank++) {
        FF_ASSERT(cover->ranked[rank] < tree->ground_count);
        cover->rank[cover->ranked[rank]] = (uint8_t)rank;
    }
}

/* ---- where grounds stand ---- */

int ff_cover_is_small(const ff_tree *tree, uint32_t ground)
{
    int64_t height_wu[2];
    ff_terrain_range_wu(&tree->ground[ground], height_wu);
    ff_box box = ff_shape_bounds(&tree->ground[ground], &tree->view.frame, height_wu,
                                 tree->view.centre_wu);
    int64_t away_wu = ff_box_distance(&box),
            wide_wu = c3d_length64(box.hi[0] - box.lo[0], box.hi[1] - box.lo[1],
                                   box.hi[2] - box.lo[2]);
    return wide_wu * (tree->view.camera.focal_q8 / 256) < away_wu * SMALL_PX;
}

static int is_active(const ff_tree *tree, uint32_t tile)
{
    uint32_t slot = ff_tree_find(tree, ff_key_make(tile, 0, 0));
    return slot != FF_SLOT_NONE && tree->node[slot].flags & FF_NODE_ACTIVE;
}

/* 1 when all tiles of an area, which begins with a tile's corner, are active. */
static int all_active(const ff_tree *tree, uint32_t ground, const ff_area *area)
{
    const ff_terrain_info *info = &tree->ground[ground];
    int64_t edge_wu = ff_node_edge_wu(info, 0);
    for (int64_t y = area->lo[1]; y < area->hi[1]; y += edge_wu)
        for (int64_t x = area->lo[0]; x < area->hi[0]; x += edge_wu) {
            const int32_t place_wu[3] = { (int32_t)x + 1, (int32_t)y + 1, 0 };
            ff_spot spot;
            if (!ff_shape_locate(info, &tree->view.frame, place_wu, &spot) ||
                !is_active(tree, spot.tile))
                return 0;
        }
    return 1;
}

/* Moves one side of an area a tile's edge outwards, as far as the ground's window reaches, when all
 * there is active: 1. */
static int grow(const ff_tree *tree, uint32_t ground, const ff_area *window, ff_area *area,
                unsigned side)
{
    ff_area added = *area;
    int64_t edge_wu = ff_node_edge_wu(&tree->ground[ground], 0);
    unsigned axis = side & 1;
    if (side & 2) {
        int64_t end_wu = area->hi[axis] + edge_wu;
        if (area->hi[axis] == window->hi[axis]) return 0;
        added.lo[axis] = area->hi[axis];
        added.hi[axis] = (int32_t)(end_wu < window->hi[axis] ? end_wu : window->hi[axis]);
    } else {
        if (area->lo[axis] == window->lo[axis]) return 0;
        added.hi[axis] = area->lo[axis];
        added.lo[axis] = (int32_t)(area->lo[axis] - edge_wu);
    }
    if (!all_active(tree, ground, &added)) return 0;
    if (side & 2)
        area->hi[axis] = added.hi[axis];
    else
        area->lo[axis] = added.lo[axis];
    return 1;
}

/* The tiles of a ground's window, and the nearest one to its middle. 0: there are none. */
static int window_of(const ff_tree *tree, uint32_t ground, ff_area *window, ff_area *nearest)
{
    const ff_terrain_info *info = &tree->ground[ground];
    ff_walk walk = ff_shape_walk_out(info, &tree->view.frame, &tree->window[ground],
                                     tree->view.centre_wu);
    uint32_t tile;
    int any = 0;
    for (; ff_shape_next(info, &walk, &tile); any = 1) {
        ff_area of = key_area(tree, ff_key_make(tile, 0, 0));
        if (!any) *window = *nearest = of;
        for (unsigned axis = 0; axis < 2; axis++) {
            if (of.lo[axis] < window->lo[axis]) window->lo[axis] = of.lo[axis];
            if (of.hi[axis] > window->hi[axis]) window->hi[axis] = of.hi[axis];
        }
    }
    return any;
}

static void stand(ff_tree *tree, uint32_t ground)
{
    static const ff_area nowhere = { { 1, 1 }, { 0, 0 } };
    ff_area window, *area = &tree->cover->stands[ground];
    if (!window_of(tree, ground, &window, area) || !all_active(tree, ground, area)) {
        *area = nowhere;
        return;
    }
    for (unsigned grown = 1; grown;) {
        grown = 0;
        for (unsigned side = 0; side < 4; side++)
            grown |= (unsigned)grow(tree, ground, &window, area, side);
    }
}

/* 1 when all of an area is where one of the grounds after some stands. */
static int stands_after(const ff_tree *tree, uint32_t rank, const ff_area *area)
{
    while (++rank < tree->ground_count)
        if (lies_inside(area, 0, &tree->cover->stands[tree->cover->ranked[rank]])) return 1;
    return 0;
}

void ff_cover_stand(ff_tree *tree)
{
    for (uint32_t g = 0; g < tree->ground_count; g++) stand(tree, g);
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        ff_node *root = &tree->node[slot];
        uint32_t g = ff_ground_number(tree, ff_key_tile(root->key));
        ff_area area = ff_area_of(tree, root->key, &root->placed);
        if (root->flags & FF_NODE_ACTIVE && !lies_inside(&area, 0, &tree->cover->stands[g]) &&
            stands_after(tree, tree->cover->rank[g], &area))
            root->flags &= ~FF_NODE_ACTIVE & UINT8_MAX;
    }
}

/* ---- what is left out ---- */

void ff_over_begin(ff_over *over, const ff_tree *tree, uint32_t ground, const ff_area *area)
{
    over->tree = tree;
    over->area = *area;
    over->info = &tree->ground[ground];
    over->root = tree->root_head;
    over->depth = 0;
}

static int touches(const ff_over *over, const ff_node *node)
{
    ff_area of = ff_area_in(over->info, node->key, &node->placed);
    return of.lo[0] <= over->area.hi[0] && of.hi[0] >= over->area.lo[0] &&
           of.lo[1] <= over->area.hi[1] && of.hi[1] >= over->area.lo[1];
}

/* The next root to descend from; FF_SLOT_NONE: there is none. */
static uint32_t next_root(ff_over *over)
{
    const ff_tree *tree = over->tree;
    while (over->root != FF_SLOT_NONE) {
        uint32_t slot = over->root;
        const ff_node *root = &tree->node[slot];
        over->root = root->list_next;
        if (root->flags & FF_NODE_ACTIVE && ff_terrain_has_node(over->info, root->key) &&
            touches(over, root))
            return slot;
    }
    return FF_SLOT_NONE;
}

const ff_node *ff_over_next(ff_over *over)
{
    const ff_tree *tree = over->tree;
    for (;;) {
        uint32_t slot = over->depth ? over->stack[--over->depth] : next_root(over);
        if (slot == FF_SLOT_NONE) return NULL;
        const ff_node *node = &tree->node[slot];
        if (!(node->flags & FF_NODE_SPLIT)) return node;
        FF_ASSERT(over->depth + 4 <= sizeof over->stack / sizeof over->stack[0]);
        for (unsigned q = 0; q < 4; q++)
            if (node->child[q] != FF_SLOT_NONE && touches(over, &tree->node[node->child[q]]))
                over->stack[over->depth++] = node->child[q];
    }
}

/* The largest cell of a ground's cut along one side of where it stands, as far as an area goes. */
static int32_t rim_cell(const ff_tree *tree, uint32_t ground, unsigned side, ff_area along)
{
    const ff_area *stands = &tree->cover->stands[ground];
    int32_t largest_wu = 0;
    if (stands->lo[0] > stands->hi[0]) return 0; /* nowhere */
    along.lo[side & 1] = along.hi[side & 1] = side & 2 ? stands->hi[side & 1]
                                                       : stands->lo[side & 1];
    ff_over over;
    ff_over_begin(&over, tree, ground, &along);
    for (const ff_node *node; (node = ff_over_next(&over)) != NULL;) {
        int32_t cell_wu = ff_node_cell_wu(&tree->ground[ground], ff_key_level(node->key));
        largest_wu = cell_wu > largest_wu ? cell_wu : largest_wu;
    }
    return largest_wu;
}

void ff_cover_rims(ff_tree *tree, uint32_t ground)
{
    for (unsigned side = 0; side < 4; side++)
        tree->cover->rim_cell_wu[ground][side] = rim_cell(tree, ground, side,
                                                          tree->cover->stands[ground]);
}

/* 1 when an area is reached by the cells inside the rim of a ground's cut that the seam moves. */
static int rim_reaches(const ff_tree *tree, uint32_t ground, const ff_area *area)
{
    const ff_area *stands = &tree->cover->stands[ground];
    for (unsigned side = 0; side < 4; side++) {
        unsigned axis = side & 1;
        int64_t away_wu = side & 2 ? (int64_t)stands->hi[axis] - area->hi[axis]
                                   : (int64_t)area->lo[axis] - stands->lo[axis];
        if (away_wu <= RIM_CELLS * (int64_t)tree->cover->rim_cell_wu[ground][side] &&
            away_wu <= RIM_CELLS * (int64_t)rim_cell(tree, ground, side, *area))
            return 1;
    }
    return 0;
}

int ff_cover_hides(const ff_tree *tree, ff_key key)
{
    const ff_cover *cover = tree->cover;
    uint32_t g = ff_ground_number(tree, ff_key_tile(key));
    if (cover->rank[g] == 0) return 0;
    ff_area area = key_area(tree, key);
    int64_t margin_wu = BESIDE_CELLS *
                        (int64_t)ff_node_cell_wu(&tree->ground[g], ff_key_level(key));
    ff_area wide = ff_area_widened(area, margin_wu);
    for (uint32_t rank = 0; rank < cover->rank[g]; rank++) {
        uint32_t f = cover->ranked[rank];
        if (lies_inside(&wide, 0, &cover->stands[f]) && !rim_reaches(tree, f, &wide)) return 1;
    }
    return 0;
}

void ff_cover_roots(ff_tree *tree, uint32_t ground)
{
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        ff_node *root = &tree->node[slot];
        if (root->flags & FF_NODE_ACTIVE &&
            ff_ground_number(tree, ff_key_tile(root->key)) == ground &&
            ff_cover_hides(tree, root->key))
            root->flags &= ~FF_NODE_ACTIVE & UINT8_MAX;
    }
}

int ff_cover_fills(const ff_tree *tree, uint32_t tile)
{
    uint32_t ground = ff_ground_number(tree, tile);
    ff_area area = key_area(tree, ff_key_make(tile, 0, 0));
    for (uint32_t g = 0; g < tree->ground_count; g++)
        if (g != ground && lies_inside(&area, 0, &tree->cover->stands[g])) return 1;
    return 0;
}
