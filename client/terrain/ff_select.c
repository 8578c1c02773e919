/* Selection: which nodes want to split, which may, and which of the resulting cut can be seen. */
#include "ff_tree_local.h"
#include "ff_horizon.h"
#include "ff_strips.h"

#include <string.h>

#define C_Q8_MAX (1 << 24)

static int same_view(const ff_view *a, const ff_view *b)
{
    const c3d_camera *ca = &a->camera, *cb = &b->camera;
    for (unsigned axis = 0; axis < 3; axis++) {
        if (ca->pos_wu[axis] != cb->pos_wu[axis] || a->centre_wu[axis] != b->centre_wu[axis])
            return 0;
    }
    return ca->yaw == cb->yaw && ca->pitch == cb->pitch && ca->roll == cb->roll &&
           ca->focal_q8 == cb->focal_q8 && ca->width == cb->width && ca->height == cb->height;
}

static int same_quality(const ff_quality *a, const ff_quality *b)
{
    return a->measure == b->measure && a->c_q8 == b->c_q8 && a->error_px_q8 == b->error_px_q8 &&
           a->depth_max == b->depth_max && a->sigma_q8 == b->sigma_q8 && a->view_wu == b->view_wu &&
           a->hole_wu == b->hole_wu && a->triangles_max == b->triangles_max &&
           a->fine_wu == b->fine_wu && a->coarse == b->coarse;
}

static int32_t within(int32_t value, int32_t lo, int32_t hi)
{
    FF_ASSERT(lo <= hi);
    return value < lo ? lo : value > hi ? hi : value;
}

/* Takes view and quality, which come from outside, into the range the arithmetic is made for. */
static void set_view(ff_tree *tree, const ff_view *view, const ff_quality *quality)
{
    tree->view = *view;
    tree->view.camera.focal_q8 = within(view->camera.focal_q8, 1, INT32_MAX);
    tree->quality = *quality;
    tree->quality.c_q8 = within(quality->c_q8, 0, C_Q8_MAX);
    tree->quality.error_px_q8 = within(quality->error_px_q8, 1, INT32_MAX);
    tree->quality.view_wu = within(quality->view_wu, 0, INT32_MAX);
    int32_t horizon_wu = 0;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        int32_t of_wu = ff_shape_horizon_wu(&tree->ground[g], &view->frame, view->centre_wu);
        horizon_wu = of_wu > horizon_wu ? of_wu : horizon_wu;
    }
    if (tree->quality.view_wu > horizon_wu) tree->quality.view_wu = horizon_wu;
    if (tree->quality.triangles_max && tree->quality.triangles_max < FF_TRIANGLES_MIN)
        tree->quality.triangles_max = FF_TRIANGLES_MIN;
    tree->finest = tree->quality;
    ff_window_make(tree);
    ff_pyramid_make(tree);
}

/* Places the held nodes anew when the view comes in another frame. */
static void enter_frame(ff_tree *tree, const ff_frame *frame)
{
    if (ff_shape_same_frame(tree->ground, frame, &tree->view.frame)) return;
    for (uint32_t slot = 0; slot < tree->node_count; slot++) {
        ff_node *node = &tree->node[slot];
        if (!ff_node_held(node)) continue;
        node->placed = ff_shape_put(ff_ground_of(tree, node->key), frame, node->key);
    }
    tree->dirty = 1;
}

/* Sets all flags back to what they were before any selection. */
static void forget_flags(ff_tree *tree)
{
    for (uint32_t slot = 0; tree->dropped && slot < tree->node_count; slot++)
        tree->node[slot].flags &= FF_NODE_KEPT;
    for (uint32_t level = 0; level < FF_LEVELS_MAX; level++) {
        for (uint32_t slot = tree->want_head[level]; !tree->dropped && slot != FF_SLOT_NONE;
             slot = tree->node[slot].want_next) {
            FF_ASSERT(tree->node[slot].flags & FF_NODE_WANTED);
            tree->node[slot].flags &= FF_NODE_KEPT;
        }
        tree->want_head[level] = FF_SLOT_NONE;
    }
    tree->dropped = 0;
}

static void mark_active_roots(ff_tree *tree)
{
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        ff_node *root = &tree->node[slot];
        FF_ASSERT(ff_node_held(root) && ff_key_level(root->key) == 0);
        root->flags = (root->flags & FF_NODE_KEPT) |
                      (ff_tile_active(tree, ff_key_tile(root->key)) ? FF_NODE_ACTIVE : 0);
    }
}

/* Queues a ground's active roots behind the leaves of the cut so far. */
static uint32_t push_active_roots(ff_tree *tree, uint32_t g)
{
    uint32_t count = tree->cut_count;
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        const ff_node *root = &tree->node[slot];
        if (!(root->flags & FF_NODE_ACTIVE) || ff_ground_number(tree, ff_key_tile(root->key)) != g)
            continue;
        FF_ASSERT(count < tree->node_count - tree->free_count); /* or the list runs in a circle */
        tree->order[count++] = slot;
    }
    return count;
}

static int is_left_out(ff_tree *tree, uint32_t slot)
{
    ff_node *node = &tree->node[slot];
    node->flags &= ~FF_NODE_LEFT_OUT & UINT8_MAX;
    if (!ff_left_out(tree, node->key)) return 0;
    node->flags |= FF_NODE_LEFT_OUT;
    return 1;
}

static uint32_t push_children(ff_tree *tree, const ff_node *node, uint32_t count)
{
    for (unsigned q = 0; q < 4; q++) {
        uint32_t slot = node->child[q];
        if (slot == FF_SLOT_NONE || (tree->cover && is_left_out(tree, slot))) continue;
        tree->order[count++] = slot;
    }
    FF_ASSERT(count <= tree->node_count - tree->free_count); /* a node is pushed once */
    return count;
}

/* The value by the measure alone, without regard to neighbours; 0: the node does not want to
 * split. */
static uint32_t own_value(ff_tree *tree, const ff_node *node)
{
    if (!ff_has_level(tree, ff_ground_of(tree, node->key), ff_key_level(node->key) + 1)) return 0;
    uint32_t value = ff_value_of_split(tree, node);
    if (value <= FF_VALUE_ONE) return 0;
    if (ff_node_is_stub(node)) {
        tree->stats.stubs++;
        return 0;
    }
    if (ff_node_is_exact(tree, node)) { /* finer nodes would show the same */
        tree->stats.flat++;
        return 0;
    }
    ff_box box;
    ff_node_box(tree, node, &box);
    return ff_box_beyond_view(tree, &box) || ff_box_in_hole(tree, &box) ? 0 : value;
}

static void want_by_measure(ff_tree *tree, uint32_t g)
{
    uint32_t count = push_active_roots(tree, g);
    for (uint32_t i = tree->cut_count; i < count; i++) {
        const ff_node *node = &tree->node[tree->order[i]];
        uint32_t value = own_value(tree, node);
        if (value == 0) continue;
        ff_want(tree, tree->order[i], value);
        if (ff_node_has_children(node)) count = push_children(tree, node, count);
    }
}

/* Decides who of a ground splits, level by level from the roots, so that all decisions about a
 * level are made before the next level looks at them. The leaves of the cut stay behind in
 * `order`. */
static void split_cut(ff_tree *tree, uint32_t g)
{
    uint32_t count = push_active_roots(tree, g), leaves = tree->cut_count;
    for (uint32_t i = tree->cut_count; i < count; i++) {
        ff_node *node = &tree->node[tree->order[i]];
        if (node->flags & FF_NODE_WANTED && ff_node_has_children(node) &&
            ff_coarser_mask(tree, node) == 0) {
            FF_ASSERT(ff_key_level(node->key) + 1 <
                      ff_terrain_levels(ff_ground_of(tree, node->key)));
            node->flags |= FF_NODE_SPLIT;
            count = push_children(tree, node, count);
        }
    }
    for (uint32_t i = tree->cut_count; i < count; i++) {
        if (!(tree->node[tree->order[i]].flags & FF_NODE_SPLIT))
            tree->order[leaves++] = tree->order[i];
    }
    FF_ASSERT(leaves > 0 || count == 0 || tree->cover); /* who splits has pushed children */
    tree->cut_count = leaves;
}

/* A ground is cut once those before it are: what they cover of it is left out. */
static void make_cut(ff_tree *tree)
{
    uint32_t before[FF_LEVELS_MAX];
    forget_flags(tree);
    mark_active_roots(tree);
    if (tree->cover) ff_cover_stand(tree);
    tree->stats.flat = tree->stats.stubs = 0;
    tree->cut_count = tree->tiles_wait = 0;
    for (uint32_t rank = 0; rank < tree->ground_count; rank++) {
        uint32_t g = ff_ground_ranked(tree, rank);
        if (tree->cover) ff_cover_roots(tree, g);
        memcpy(before, tree->want_head, sizeof before);
        want_by_measure(tree, g);
        ff_want_close(tree, g, before);
        split_cut(tree, g);
        if (tree->cover) ff_cover_rims(tree, g);
    }
}

static void fill_drawn(const ff_tree *tree, uint32_t slot, unsigned coarser, ff_drawn *drawn)
{
    const ff_node *node = &tree->node[slot];
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    FF_ASSERT(ff_node_held(node) && !(node->flags & FF_NODE_SPLIT));
    drawn->key = node->key;
    drawn->node = node;
    drawn->heights = tree->heights + slot * ff_heights_per_node(tree);
    drawn->coarser = (uint8_t)coarser;
    drawn->filled = (node->flags & FF_NODE_FILLED) != 0;
    drawn->stub = (uint8_t)ff_node_is_stub(node);
    ff_shape_place(info, node->key, &node->placed, 0, 0, 32768, drawn->origin_wu);
    drawn->cell_wu = ff_node_cell_wu(info, ff_key_level(node->key));
    FF_ASSERT(drawn->cell_wu > 0);
}

/* Triangles of a node's strips (ff_strips.h), degenerate ones not counted: those of padding are. */
static uint32_t triangles_of(const ff_tree *tree, const ff_drawn *drawn)
{
    ff_extent cells = ff_drawn_cells(tree, drawn->key);
    uint32_t count = 2 * cells.columns * cells.rows;
    FF_ASSERT(drawn->coarser < 1u << FF_SIDE_COUNT);
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        uint32_t along = side == FF_SIDE_SOUTH || side == FF_SIDE_NORTH ? cells.columns
                                                                        : cells.rows;
        if (drawn->coarser >> side & 1u) count -= along / 2;
    }
    return count;
}

static void count_drawn(ff_tree *tree, const ff_drawn *drawn)
{
    tree->stats.triangles += triangles_of(tree, drawn);
    tree->stats.stitched += drawn->coarser != 0;
    FF_ASSERT(tree->stats.stitched <= tree->view_count);
}

static uint32_t slot_in_view(const ff_tree *tree, uint32_t i)
{
    uint32_t slot = (uint32_t)tree->sort[i] & (FF_NODES_MAX - 1);
    FF_ASSERT(i < tree->view_count && slot < tree->node_count);
    FF_ASSERT(i == 0 || tree->sort[i - 1] < tree->sort[i]);
    return slot;
}

/* Is a node in view hidden? If not, it may hide others. */
static int is_hidden(ff_tree *tree, uint32_t i, const ff_drawn *drawn)
{
    ff_node *node = &tree->node[slot_in_view(tree, i)];
    node->flags &= ~FF_NODE_HIDDEN & UINT8_MAX;
    if (!tree->horizon) return 0;
    if (!ff_horizon_hides_node(tree, tree->horizon, node)) {
        ff_horizon_raise(tree, tree->horizon, tree->sort, tree->view_count, i, drawn->coarser);
        return 0;
    }
    if (ff_horizon_hides_children(tree, tree->horizon, node)) node->flags |= FF_NODE_HIDDEN;
    return 1;
}

/* Lists what is in view, from `sort`: what can be seen first, nearest first, and from the other end
 * what is hidden. */
static void list_view(ff_tree *tree)
{
    uint32_t seen = 0;
    tree->stats.triangles = tree->stats.stitched = 0;
    tree->stats.nodes_hidden = tree->stats.triangles_hidden = 0;
    if (tree->horizon) ff_horizon_begin(tree, tree->horizon, tree->sort, tree->view_count, 0);
    for (uint32_t i = 0; i < tree->view_count; i++) {
        uint32_t slot = slot_in_view(tree, i);
        ff_drawn drawn;
        fill_drawn(tree, slot, ff_coarser_mask(tree, &tree->node[slot]), &drawn);
        int hidden = is_hidden(tree, i, &drawn);
        if (hidden) {
            tree->drawn[tree->view_count - ++tree->stats.nodes_hidden] = drawn;
            tree->stats.triangles_hidden += triangles_of(tree, &drawn);
        } else {
            tree->drawn[seen++] = drawn;
        }
        if (!hidden || tree->hidden == FF_HIDDEN_DRAWN) count_drawn(tree, &drawn);
    }
    if (tree->horizon) ff_horizon_end(tree, tree->horizon);
    FF_ASSERT(seen + tree->stats.nodes_hidden == tree->view_count);
    tree->drawn_count = tree->hidden == FF_HIDDEN_DRAWN ? tree->view_count : seen;
}

/* Lists the cut: first the nodes that are in view, then the others. */
static void list_cut(ff_tree *tree)
{
    uint32_t seen = 0, unseen = 0;
    for (uint32_t i = 0; i < tree->cut_count; i++) {
        uint32_t slot = tree->order[i];
        ff_box box;
        ff_node_box(tree, &tree->node[slot], &box);
        int64_t lowest_wu = box.lo[2];
        if (tree->cover && !tree->cover->alone && ff_seam_touches(tree, &tree->node[slot]))
            box.lo[2] = ff_seam_lowest_wu(tree) - tree->view.camera.pos_wu[2];
        if (ff_box_beyond_view(tree, &box) || !ff_box_in_view(tree, &box)) {
            tree->order[unseen++] = slot;
            continue;
        }
        box.lo[2] = lowest_wu; /* a seam does not bring a node nearer */
        tree->sort[seen++] = (uint64_t)ff_box_distance(&box) << FF_SLOT_BITS | slot;
    }
    FF_ASSERT(tree->cut_count <= tree->node_count - tree->free_count);
    ff_sort_keys(tree->sort, seen);
    tree->view_count = seen;
    list_view(tree);
    for (uint32_t i = 0; i < unseen; i++)
        fill_drawn(tree, tree->order[i], FF_COARSER_UNKNOWN, &tree->drawn[seen + i]);
}

int ff_tree_select(ff_tree *tree, const ff_view *view, const ff_quality *quality)
{
    enter_frame(tree, &view->frame);
    ff_tree_make_children(tree);
    if (tree->has_view && !tree->dirty && same_view(view, &tree->asked_view) &&
        same_quality(quality, &tree->asked_quality)) {
        tree->stats.selects_skipped++;
        return 0;
    }
    tree->asked_view = *view;
    tree->asked_quality = *quality;
    set_view(tree, view, quality);
    tree->has_view = 1;
    tree->dirty = 0;
    tree->stats.selects++;
    ff_limit_search search;
    ff_limit_begin(tree, &search);
    do {
        make_cut(tree);
        ff_whole_make(tree);
        list_cut(tree);
    } while (ff_limit_again(tree, &search));
    if (tree->seams) ff_seam_make(tree);
    ff_limit_wishes(tree);
    ff_wish_make(tree);
    FF_ASSERT(tree->wish_count <= tree->wish_capacity);
    return 1;
}
