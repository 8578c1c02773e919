/* Who makes room when the pool is full. Roots in the window come before all refinements, nearer
 * before farther; refinements by the value of their split. Something is dropped only for something
 * strictly more valuable, so under a still camera every exchange raises the value of what is held:
 * a full pool settles. What is not seen, out of view or hidden, drives out only what nobody
 * wants. */
#include "ff_tree_local.h"

#define IDLE_SHIFT 8 /* what takes no part has children worth 1/256 of what they would be */

/* Is it in the window, and no other ground drawn there? */
static int takes_part(const ff_tree *tree, const ff_node *node)
{
    return ff_tile_active(tree, ff_key_tile(node->key)) && !ff_left_out(tree, node->key);
}

static int is_idle_root(const ff_tree *tree, const ff_node *node)
{
    FF_ASSERT((node->parent == FF_SLOT_NONE) == (ff_key_level(node->key) == 0));
    return node->parent == FF_SLOT_NONE && !ff_node_has_children(node) && !takes_part(tree, node);
}

static int has_leaf_family(const ff_tree *tree, const ff_node *node)
{
    if (!ff_node_has_children(node)) return 0;
    for (unsigned q = 0; q < 4; q++) {
        if (node->child[q] == FF_SLOT_NONE) continue;
        FF_ASSERT(node->child[q] < tree->node_count);
        if (ff_node_has_children(&tree->node[node->child[q]])) return 0;
    }
    return 1;
}

/* What the children of `node` are worth now. Children that nobody wants are a cache, worth 1/f of
 * `node` and never more than 1. */
static uint32_t split_worth(const ff_tree *tree, const ff_node *node)
{
    FF_ASSERT(!(node->flags & FF_NODE_WANTED) || node->value > FF_VALUE_ONE);
    if (node->flags & FF_NODE_WANTED) return node->value;
    uint32_t value = ff_value_of_split(tree, node);
    if (value > FF_VALUE_ONE) value = FF_VALUE_ONE;
    return takes_part(tree, node) ? value : value >> IDLE_SHIFT;
}

/* What a leaf family, the children of `parent`, is worth: the value of splitting `parent`, or
 * of splitting a member when that is more, because a member's refinement is of no use without it.
 */
static uint32_t family_worth(const ff_tree *tree, const ff_node *parent)
{
    uint32_t worth = split_worth(tree, parent);
    for (unsigned q = 0; q < 4; q++) {
        if (parent->child[q] == FF_SLOT_NONE) continue;
        const ff_node *child = &tree->node[parent->child[q]];
        FF_ASSERT(child->key == ff_key_child(parent->key, q));
        if (child->flags & FF_NODE_WANTED && child->value > worth) worth = child->value;
    }
    return worth;
}

uint32_t ff_evict_limit(const ff_tree *tree, const ff_node *node)
{
    uint32_t worth = split_worth(tree, node);
    if (node->flags & FF_NODE_WANTED) return ff_node_needed(tree, node) ? worth : FF_VALUE_ONE;
    if (tree->quality.sigma_q8 <= 256) return worth;
    uint32_t cached = (uint32_t)((FF_VALUE_ONE << 8) / (uint32_t)tree->quality.sigma_q8);
    FF_ASSERT(cached < FF_VALUE_ONE);
    return worth < cached ? worth : cached;
}

uint32_t ff_evict_candidates(const ff_tree *tree, uint64_t *keys)
{
    uint32_t count = 0;
    for (uint32_t slot = 0; slot < tree->node_count; slot++) {
        const ff_node *node = &tree->node[slot];
        if (!ff_node_held(node)) continue;
        if (is_idle_root(tree, node))
            keys[count++] = slot;
        else if (has_leaf_family(tree, node))
            keys[count++] = (uint64_t)family_worth(tree, node) << FF_SLOT_BITS | slot;
    }
    FF_ASSERT(count <= tree->node_count - tree->free_count);
    return count;
}

ff_room ff_room_make(const ff_tree *tree, uint64_t *victim, uint32_t taken, uint64_t needed)
{
    ff_room room = { victim, 0, 0, tree->free_count > taken ? tree->free_count - taken : 0 };
    if (room.free < needed) {
        room.victims = ff_evict_candidates(tree, victim);
        ff_sort_keys(victim, room.victims);
    }
    return room;
}

int ff_room_take_slots(const ff_tree *tree, ff_room *room, uint32_t needed, uint32_t limit)
{
    FF_ASSERT(room->next <= room->victims && room->free <= tree->node_count);
    while (room->free < needed && room->next < room->victims &&
           room->victim[room->next] >> FF_SLOT_BITS < limit) {
        uint32_t slot = (uint32_t)room->victim[room->next++] & (FF_NODES_MAX - 1);
        uint32_t family = ff_node_children(&tree->node[slot]);
        room->free += family ? family : 1;
    }
    if (room->free < needed) return 0;
    room->free -= needed;
    return 1;
}

int ff_room_take(const ff_tree *tree, ff_room *room, const ff_node *node)
{
    uint32_t needed = ff_family_size(tree, node->key);
    return ff_room_take_slots(tree, room, needed,
                              room->free < needed ? ff_evict_limit(tree, node) : 0);
}

/* Drops the least valuable thing worth less than `below`, sparing `keep` and the family it is
 * in. */
static int drop_one(ff_tree *tree, uint32_t keep, uint64_t below)
{
    uint32_t keep_parent = keep == FF_SLOT_NONE ? FF_SLOT_NONE : tree->node[keep].parent,
             victim = FF_SLOT_NONE;
    FF_ASSERT(tree->free_count < 4);
    FF_ASSERT(keep == FF_SLOT_NONE || ff_node_held(&tree->node[keep]));
    for (uint32_t slot = 0; slot < tree->node_count; slot++) {
        const ff_node *node = &tree->node[slot];
        if (!ff_node_held(node) || slot == keep || slot == keep_parent) continue;
        uint64_t worth;
        if (is_idle_root(tree, node))
            worth = 0;
        else if (has_leaf_family(tree, node))
            worth = family_worth(tree, node);
        else
            continue;
        if (worth < below) {
            below = worth;
            victim = slot;
        }
    }
    if (victim == FF_SLOT_NONE) return 0;
    ff_node *node = &tree->node[victim];
    if (ff_node_has_children(node))
        ff_tree_drop_children(tree, node);
    else
        ff_tree_drop_root(tree, node);
    return 1;
}

int ff_evict_for_children(ff_tree *tree, uint32_t keep)
{
    uint32_t limit = ff_evict_limit(tree, &tree->node[keep]),
             needed = ff_family_size(tree, tree->node[keep].key);
    FF_ASSERT(!ff_node_has_children(&tree->node[keep]));
    while (tree->free_count < needed) {
        if (!tree->has_view || !drop_one(tree, keep, limit)) return 0;
    }
    return 1;
}

int ff_evict_for_root(ff_tree *tree, uint32_t tile)
{
    if (tree->free_count > 0) return 1;
    if (!tree->has_view || !ff_tile_active(tree, tile)) return 0;
    ff_box box;
    ff_tile_box(tree, tile, &box);
    if (drop_one(tree, FF_SLOT_NONE, ff_box_seen(tree, &box) ? UINT64_MAX : FF_VALUE_ONE)) return 1;
    int64_t farthest = ff_tile_distance(tree, tile);
    uint32_t victim = FF_SLOT_NONE;
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        /* what is not seen was refused this family */
        if (ff_node_has_children(&tree->node[slot])) return 0;
        int64_t distance = ff_tile_distance(tree, ff_key_tile(tree->node[slot].key));
        if (distance > farthest) {
            farthest = distance;
            victim = slot;
        }
    }
    if (victim == FF_SLOT_NONE) return 0;
    ff_tree_drop_root(tree, &tree->node[victim]);
    return 1;
}
