/* Wishes: the keys that would make the picture better and for which the pool has room. Roots come
 * before refinements; roots are ordered by distance, refinements by value. Within each, the nodes
 * in view come first, together with the neighbours without which a node in view cannot split. The
 * tree does not wish for what its pool would refuse: a full tree asks for nothing. */
#include "ff_tree_local.h"

#define SLOT_MASK    (FF_NODES_MAX - 1)
#define OUT_OF_VIEW  ((uint64_t)1 << 60)
#define TILE_BITS    28
#define ONE_Q8       256u
#define UNSEEN_SHARE 4 /* of the list, at most, for roots out of view */

FF_STATIC_ASSERT(FF_KEY_TILES_MAX == 1u << TILE_BITS);
/* What stands below OUT_OF_VIEW in a sort key: the number of a root found and its tile, or a value
 * and a slot. */
FF_STATIC_ASSERT((uint64_t)2 * FF_NODES_MAX << TILE_BITS <= OUT_OF_VIEW);
FF_STATIC_ASSERT((uint64_t)FF_VALUE_MAX << FF_SLOT_BITS < OUT_OF_VIEW);

static uint32_t times_q16(uint32_t value_q16, uint32_t factor)
{
    FF_ASSERT(value_q16 > FF_VALUE_ONE && factor > 0);
    uint64_t product = (uint64_t)value_q16 * factor >> 16;
    return product > UINT32_MAX ? UINT32_MAX : (uint32_t)product;
}

/* ---- roots ---- */

/* Adds at most `limit` missing roots of a ground, as they lie from the window's middle outwards, to
 * the `count` found in others; returns how many there are then. Grounds take turns. */
static uint32_t missing_of(ff_tree *tree, uint32_t g, uint32_t count, uint32_t limit)
{
    const ff_terrain_info *info = &tree->ground[g];
    uint32_t found = 0, tile;
    ff_walk walk = ff_shape_walk_out(info, &tree->view.frame, &tree->window[g],
                                     tree->view.centre_wu);
    while (found < limit && ff_shape_next(info, &walk, &tile)) {
        ff_key root = ff_key_make(tile, 0, 0);
        if (ff_tree_find(tree, root) != FF_SLOT_NONE || ff_left_out(tree, root)) continue;
        ff_box box;
        ff_tile_box(tree, tile, &box);
        uint64_t unseen = ff_box_seen(tree, &box) ? 0 : OUT_OF_VIEW,
                 turn = (uint64_t)found * tree->ground_count + g;
        tree->sort[count + found++] = unseen | turn << TILE_BITS | tile;
    }
    return count + found;
}

/* Looks for missing roots in the windows of tiles, and puts them into `sort`, those in view
 * first. */
static uint32_t missing_roots(ff_tree *tree)
{
    uint32_t limit = tree->wish_capacity < tree->node_count / 2 ? 4 * tree->wish_capacity
                                                                : 2 * tree->node_count;
    uint32_t found = 0;
    FF_ASSERT(limit <= 2 * tree->node_count);
    for (uint32_t g = 0; g < tree->ground_count; g++)
        found = missing_of(tree, g, found, limit / tree->ground_count);
    ff_sort_keys(tree->sort, found);
    return found;
}

/* How many roots in the window of tiles are held, and how far the farthest of them is. */
static uint32_t active_roots(const ff_tree *tree, int64_t *farthest)
{
    uint32_t count = 0;
    *farthest = 0;
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        uint32_t tile = ff_key_tile(tree->node[slot].key);
        if (!ff_tile_active(tree, tile)) continue;
        count++;
        int64_t distance = ff_tile_distance(tree, tile);
        *farthest = distance > *farthest ? distance : *farthest;
    }
    FF_ASSERT(count <= tree->node_count - tree->free_count);
    return count;
}

/* Q16: a node's edge by its distance. */
static uint32_t nearness(const ff_terrain_info *info, uint32_t level, const ff_box *box)
{
    uint64_t reach = (uint64_t)ff_node_edge_wu(info, level) << 16;
    FF_ASSERT(reach > 0 && reach <= (uint64_t)INT32_MAX << 16);
    uint64_t priority = reach / ((uint64_t)ff_box_distance(box) + 1);
    return priority > UINT32_MAX ? UINT32_MAX : (uint32_t)priority;
}

static uint32_t root_priority(const ff_tree *tree, uint32_t tile)
{
    ff_box box;
    ff_tile_box(tree, tile, &box);
    return nearness(ff_ground_of_tile(tree, tile), 0, &box);
}

static void wish_roots(ff_tree *tree)
{
    int64_t farthest;
    if (!tree->roots_missing) return;
    uint32_t held = active_roots(tree, &farthest), missing = missing_roots(tree);
    for (uint32_t i = 0; i < missing && tree->wish_count < tree->wish_capacity; i++) {
        uint32_t tile = (uint32_t)(tree->sort[i] & (FF_KEY_TILES_MAX - 1));
        if (tree->sort[i] & OUT_OF_VIEW && tree->wish_count >= tree->wish_capacity / UNSEEN_SHARE)
            break; /* refinements in view need the rest */
        if (held + tree->wish_count >= tree->node_count && ff_tile_distance(tree, tile) >= farthest)
            continue;
        FF_ASSERT(ff_tree_find(tree, ff_key_make(tile, 0, 0)) == FF_SLOT_NONE);
        ff_wish *wish = &tree->wish[tree->wish_count++];
        *wish = (ff_wish){ .key = ff_key_make(tile, 0, 0),
                           .kind = FF_KIND_ROOT,
                           .in_view = !(tree->sort[i] & OUT_OF_VIEW),
                           .priority = root_priority(tree, tile) };
    }
}

/* ---- refinements ---- */

/* Puts wanted nodes without children into `sort`, the most valuable first. From the finest level
 * up: what a node that is seen needs beside it is coarser, so its own need is known before its
 * turn. */
static uint32_t missing_children(ff_tree *tree)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < tree->view_count - tree->stats.nodes_hidden; i++)
        if (tree->drawn[i].coarser) ff_need_beside(tree, tree->drawn[i].node);
    for (uint32_t level = FF_LEVELS_MAX; level-- > 0;) {
        for (uint32_t slot = tree->want_head[level]; slot != FF_SLOT_NONE;
             slot = tree->node[slot].want_next) {
            const ff_node *node = &tree->node[slot];
            FF_ASSERT(node->flags & FF_NODE_WANTED && ff_key_level(node->key) == level);
            if (node->flags & FF_NODE_SPLIT) continue;
            int needed = ff_node_needed(tree, node);
            if (needed && !ff_tile_waits(tree, node)) ff_need_beside(tree, node);
            if (ff_node_has_children(node)) continue;
            uint64_t unseen = needed ? 0 : OUT_OF_VIEW;
            if (!unseen && node->value < tree->wish_value) continue;
            tree->sort[count++] = unseen | (uint64_t)(FF_VALUE_MAX - node->value) << FF_SLOT_BITS |
                                  slot;
        }
    }
    ff_sort_keys(tree->sort, count);
    return count;
}

static void wish_children(ff_tree *tree)
{
    uint32_t missing = missing_children(tree), roots = tree->wish_count;
    ff_room room = ff_room_make(tree, tree->sort + missing, roots, 4 * (uint64_t)missing);
    /* who lacks children is not among the victims */
    FF_ASSERT(missing + room.victims <= tree->node_count - tree->free_count);
    for (uint32_t i = 0; i < missing && tree->wish_count < tree->wish_capacity; i++) {
        const ff_node *node = &tree->node[tree->sort[i] & SLOT_MASK];
        if (node->flags & FF_NODE_LEAF && tree->made_count == FF_MADE_MAX) continue;
        if (!ff_room_take(tree, &room, node)) continue;
        if (node->flags & FF_NODE_LEAF) {
            tree->made[tree->made_count++] = node->key;
            continue;
        }
        ff_wish *wish = &tree->wish[tree->wish_count++];
        wish->key = node->key;
        wish->kind = FF_KIND_REFINEMENT;
        wish->in_view = !(tree->sort[i] & OUT_OF_VIEW);
        wish->lacks = ff_node_lacked(tree, node);
        wish->priority = times_q16(node->value, tree->quality.measure == FF_MEASURE_PIXELS
                                                    ? (uint32_t)tree->quality.error_px_q8
                                                    : ONE_Q8);
    }
}

void ff_wish_make(ff_tree *tree)
{
    tree->wish_count = tree->made_count = 0;
    wish_roots(tree);
    wish_children(tree);
}

/* ---- the edge ---- */

static int ends_there(const ff_tree *tree, const ff_node *node)
{
    const ff_terrain_info *info = ff_tree_ground(tree, node->key);
    return !ff_node_has_children(node) && !(node->flags & FF_NODE_LEAF) &&
           node->want_next != FF_SLOT_NEVER &&
           ff_has_level(tree, info, ff_key_level(node->key) + 1);
}

uint32_t ff_tree_edge(const ff_tree *tree, ff_wish *list, uint32_t capacity)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < tree->cut_count; i++) {
        const ff_node *node = tree->drawn[i].node;
        if (!ends_there(tree, node)) continue;
        ff_box box;
        ff_node_box(tree, node, &box);
        const ff_wish wish = { .key = node->key,
                               .kind = FF_KIND_REFINEMENT,
                               .lacks = ff_node_lacked(tree, node),
                               .priority = nearness(ff_tree_ground(tree, node->key),
                                                    ff_key_level(node->key), &box) };
        uint32_t at = count < capacity ? count++ : capacity;
        for (; at > 0 && list[at - 1].priority < wish.priority; at--)
            if (at < capacity) list[at] = list[at - 1];
        if (at < capacity) list[at] = wish;
    }
    return count;
}
