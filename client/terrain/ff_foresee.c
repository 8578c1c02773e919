/* Prefetch: what a viewer further along the path, or turned further round, would see and wish for,
 * found without moving the cut (Shared: prefetch from predicted motion). The measures are asked as
 * if the camera stood there; the tree itself stays as it is. */
#include "ff_tree_local.h"
#include "ff_horizon.h"

/* How many tiles of the window ahead are looked at: more tiny tiles would cost more than they
 * bring. */
#define TILES_LOOKED_AT 256

typedef struct foresight {
    ff_tree ahead;
    ff_wish *list;
    uint32_t capacity, count;
    uint8_t looked; /* 1: the horizon ahead is known */
} foresight;

static void note(foresight *f, const ff_wish *wish)
{
    uint32_t at = f->count;
    FF_ASSERT(f->capacity > 0 && f->count <= f->capacity);
    if (at == f->capacity) {
        if (f->list[--at].priority >= wish->priority) return;
    } else {
        f->count++;
    }
    for (; at > 0 && f->list[at - 1].priority < wish->priority; at--) f->list[at] = f->list[at - 1];
    f->list[at] = *wish;
    FF_ASSERT(at + 1 == f->count || f->list[at + 1].priority < wish->priority);
}

static void note_root(foresight *f, uint32_t tile)
{
    const ff_wish wish = { .key = ff_key_make(tile, 0, 0),
                           .kind = FF_KIND_ROOT,
                           .priority = FF_VALUE_ONE };
    note(f, &wish);
}

static void note_children(foresight *f, const ff_node *node, uint32_t value)
{
    const ff_wish wish = { .key = node->key,
                           .kind = FF_KIND_REFINEMENT,
                           .lacks = ff_node_lacked(&f->ahead, node),
                           .priority = value };
    note(f, &wish);
}

/* The horizon there, of the ground that is drawn here, and in `order` 1 for every node in view
 * there of which nothing can be seen; made when somebody asks. */
static void look(const ff_tree *tree, foresight *f)
{
    ff_horizon *horizon = f->ahead.horizon;
    uint32_t count = 0;
    f->looked = 1;
    for (uint32_t i = 0; i < tree->cut_count; i++) {
        ff_box there;
        ff_node_box(&f->ahead, tree->drawn[i].node, &there);
        if (!ff_box_beyond_view(&f->ahead, &there) && ff_box_in_view(&f->ahead, &there))
            tree->sort[count++] = (uint64_t)ff_box_distance(&there) << FF_SLOT_BITS |
                                  ff_slot_of(tree, tree->drawn[i].node);
    }
    ff_sort_keys(tree->sort, count);
    ff_whole_make(&f->ahead);
    ff_horizon_begin(&f->ahead, horizon, tree->sort, count, 1);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t slot = (uint32_t)tree->sort[i] & (FF_NODES_MAX - 1);
        const ff_node *node = &tree->node[slot];
        tree->order[slot] = 0;
        if (!ff_horizon_hides_node(&f->ahead, horizon, node))
            ff_horizon_raise(&f->ahead, horizon, tree->sort, count, i, FF_COARSER_UNKNOWN);
        else
            tree->order[slot] = (uint32_t)ff_horizon_hides_children(&f->ahead, horizon, node);
    }
}

static int seen_here(const ff_tree *tree, uint32_t slot, const ff_box *here)
{
    return slot == FF_SLOT_NONE ? ff_box_seen(tree, here)
                                : ff_node_seen(tree, &tree->node[slot], here);
}

/* Of a node, or of a tile whose root is not held: `slot` FF_SLOT_NONE. Ground seen from here is
 * taken as seen from there, if it is in view: to know better would cost more than it brings. */
static int seen_there(const ff_tree *tree, foresight *f, uint32_t slot, const ff_box *here,
                      const ff_box *there)
{
    if (!ff_box_in_view(&f->ahead, there)) return 0;
    if (!f->ahead.horizon || seen_here(tree, slot, here)) return 1;
    if (!f->looked) look(tree, f);
    if (slot != FF_SLOT_NONE && tree->order[slot]) return 0;
    return ff_box_seen(&f->ahead, there);
}

/* 1 when a box is seen from there, and not from here. */
static int comes_into_view(const ff_tree *tree, foresight *f, uint32_t slot, const ff_box *here,
                           const ff_box *there)
{
    FF_ASSERT(here->hi[0] - here->lo[0] == there->hi[0] - there->lo[0]);
    return (ff_box_beyond_view(tree, here) || !seen_here(tree, slot, here)) &&
           seen_there(tree, f, slot, here, there);
}

/* Notes roots of a ground that are not held, of tiles that will come into view. */
static void foresee_roots(const ff_tree *tree, uint32_t g, foresight *f)
{
    const ff_terrain_info *info = &tree->ground[g];
    ff_walk walk = ff_shape_walk(info, &f->ahead.window[g]);
    uint32_t tile;
    for (unsigned i = 0; i < TILES_LOOKED_AT && ff_shape_next(info, &walk, &tile); i++) {
        ff_key root = ff_key_make(tile, 0, 0);
        if (ff_tree_find(tree, root) != FF_SLOT_NONE || ff_left_out_ahead(tree, root)) continue;
        ff_box here, there;
        ff_tile_box(tree, tile, &here);
        ff_tile_box(&f->ahead, tile, &there);
        if (comes_into_view(tree, f, FF_SLOT_NONE, &here, &there)) note_root(f, tile);
    }
}

static void foresee_children_of(const ff_tree *tree, foresight *f, const ff_node *node)
{
    FF_ASSERT(!ff_node_has_children(node));
    if (!ff_has_level(tree, ff_ground_of(tree, node->key), ff_key_level(node->key) + 1) ||
        node->flags & FF_NODE_LEAF || ff_node_is_stub(node) || node->error_code == 0)
        return;
    if (node->flags & FF_NODE_NEEDED) { /* wished for already, unless its tile waits for it */
        if (ff_tile_waits(tree, node)) note_children(f, node, node->value);
        return;
    }
    uint32_t value = ff_value_of_split(&f->ahead, node);
    if (value < tree->wish_value) return;
    ff_box here, there;
    uint32_t slot = ff_slot_of(tree, node);
    ff_node_box(tree, node, &here);
    ff_node_box(&f->ahead, node, &there);
    if (!ff_box_beyond_view(&f->ahead, &there) &&
        (node->flags & FF_NODE_WANTED ? comes_into_view(tree, f, slot, &here, &there)
                                      : seen_there(tree, f, slot, &here, &there)))
        note_children(f, node, value);
}

static void foresee_cut(const ff_tree *tree, foresight *f)
{
    FF_ASSERT(tree->cut_count <= tree->node_count);
    for (uint32_t i = 0; i < tree->cut_count; i++)
        if (!ff_node_has_children(tree->drawn[i].node))
            foresee_children_of(tree, f, tree->drawn[i].node);
}

/* Notes refinements of held tiles that are not in the cut: those that will come into the window of
 * tiles, and those that wait to join. As bare roots they would keep the ground beside them coarse
 * until they are refined. */
static void foresee_tiles(const ff_tree *tree, foresight *f)
{
    uint32_t stack[3 * FF_LEVELS_MAX + 1];
    for (uint32_t root = tree->root_head; root != FF_SLOT_NONE; root = tree->node[root].list_next) {
        uint32_t tile = ff_key_tile(tree->node[root].key), depth = 0;
        if (tree->node[root].flags & FF_NODE_ACTIVE || !ff_tile_active(&f->ahead, tile) ||
            ff_left_out_ahead(tree, tree->node[root].key))
            continue;
        for (stack[depth++] = root; depth > 0;) {
            const ff_node *node = &tree->node[stack[--depth]];
            if (!ff_node_has_children(node)) {
                foresee_children_of(tree, f, node);
                continue;
            }
            FF_ASSERT(depth + 4 <= sizeof stack / sizeof stack[0]);
            for (unsigned q = 0; q < 4; q++)
                if (node->child[q] != FF_SLOT_NONE) stack[depth++] = node->child[q];
        }
    }
}

uint32_t ff_tree_foresee(const ff_tree *tree, const int32_t pos_wu[3], int32_t yaw, int32_t pitch,
                         ff_wish *list, uint32_t capacity)
{
    foresight f = { .ahead = *tree, .list = list, .capacity = capacity };
    if (!tree->has_view || !capacity) return 0;
    for (int axis = 0; axis < 3; axis++)
        f.ahead.view.camera.pos_wu[axis] = f.ahead.view.centre_wu[axis] = pos_wu[axis];
    f.ahead.horizon = tree->horizon_ahead;
    f.ahead.window = tree->window_ahead;
    f.ahead.view.camera.yaw = (f.ahead.view.camera.yaw + yaw) & 0xFFFF;
    f.ahead.view.camera.pitch = (f.ahead.view.camera.pitch + pitch) & 0xFFFF;
    ff_window_make(&f.ahead);
    ff_pyramid_make(&f.ahead);
    for (uint32_t g = 0; g < tree->ground_count; g++) foresee_roots(tree, g, &f);
    foresee_cut(tree, &f);
    foresee_tiles(tree, &f);

    ff_room room = ff_room_make(tree, tree->sort, 0, 4 * f.count);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < f.count; i++) {
        const ff_wish *wish = &list[i];
        FF_ASSERT((ff_tree_find(tree, wish->key) == FF_SLOT_NONE) == (wish->kind == FF_KIND_ROOT));
        int fits = wish->kind == FF_KIND_REFINEMENT
                       ? ff_room_take(tree, &room, &tree->node[ff_tree_find(tree, wish->key)])
                       : room.free > 0;
        if (fits) list[kept++] = *wish;
    }
    return kept;
}
