/* Node slots: a free list, a hash from key to slot, links from parents to children and a list of
 * roots. */
#include "ff_tree_local.h"

#include <string.h>

FF_STATIC_ASSERT(FF_NODES_MAX <= 1u << 25); /* bits that hash_of leaves */

static uint32_t hash_of(const ff_tree *tree, ff_key key)
{
    uint32_t mixed = (uint32_t)(key >> 32) * 0x9E3779B1u ^ (uint32_t)key * 0x85EBCA77u;
    mixed ^= mixed >> 15;
    return (mixed * 0xC2B2AE3Du >> 7) & tree->hash_mask;
}

uint32_t ff_tree_find(const ff_tree *tree, ff_key key)
{
    uint32_t slot = tree->hash[hash_of(tree, key)];
    while (slot != FF_SLOT_NONE && tree->node[slot].key != key) slot = tree->node[slot].hash_next;
    return slot;
}

uint32_t ff_tree_find_nearest(const ff_tree *tree, ff_key key)
{
    FF_ASSERT(ff_terrain_has_node(ff_ground_of(tree, key), key));
    for (;;) {
        uint32_t slot = ff_tree_find(tree, key);
        if (slot != FF_SLOT_NONE || ff_key_level(key) == 0) return slot;
        key = ff_key_parent(key);
    }
}

uint32_t ff_tree_take_slot(ff_tree *tree, ff_key key, uint32_t parent)
{
    uint32_t slot = tree->free_head, bucket = hash_of(tree, key);
    FF_ASSERT(slot < tree->node_count && tree->free_count > 0);
    FF_ASSERT((parent == FF_SLOT_NONE) == (ff_key_level(key) == 0));
    ff_node *node = &tree->node[slot];
    FF_ASSERT(!ff_node_held(node));
    tree->free_head = node->hash_next;
    tree->free_count--;
    FF_ASSERT((tree->free_head == FF_SLOT_NONE) == (tree->free_count == 0));

    memset(node, 0, sizeof *node);
    node->key = key;
    node->parent = parent;
    for (unsigned q = 0; q < 4; q++) node->child[q] = FF_SLOT_NONE;
    /* who has none of the parent's refinement has none of its children's */
    if (tree->lacks) tree->lacks[slot] = parent == FF_SLOT_NONE ? 0 : tree->lacks[parent];
    node->placed = ff_shape_put(ff_ground_of(tree, key), &tree->view.frame, key);
    node->hash_next = tree->hash[bucket];
    tree->hash[bucket] = slot;
    if (parent == FF_SLOT_NONE) {
        node->list_next = tree->root_head;
        tree->root_head = slot;
    }
    uint32_t held = tree->node_count - tree->free_count;
    if (held > tree->stats.nodes_high) tree->stats.nodes_high = held;
    return slot;
}

static void forget_user(ff_tree *tree, ff_node *node)
{
    FF_ASSERT(ff_node_held(node));
    if (node->user && tree->on_evict) tree->on_evict(tree->evict_context, node->user);
    node->user = 0;
}

void ff_tree_reshade_beside(ff_tree *tree, ff_key key)
{
    const ff_terrain_info *info = ff_ground_of(tree, key);
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        ff_key beside = ff_shape_neighbour(info, key, (enum ff_side)side).key;
        FF_ASSERT(beside == FF_KEY_NONE || ff_key_level(beside) == ff_key_level(key));
        uint32_t slot = beside == FF_KEY_NONE ? FF_SLOT_NONE : ff_tree_find(tree, beside);
        if (slot != FF_SLOT_NONE) forget_user(tree, &tree->node[slot]);
    }
}

void ff_tree_reshape(ff_tree *tree, uint32_t slot) { forget_user(tree, &tree->node[slot]); }

void ff_tree_reshade(ff_tree *tree)
{
    for (uint32_t slot = 0; slot < tree->node_count; slot++)
        if (ff_node_held(&tree->node[slot])) forget_user(tree, &tree->node[slot]);
}

uint32_t ff_family_size(const ff_tree *tree, ff_key parent)
{
    const ff_terrain_info *info = ff_ground_of(tree, parent);
    uint32_t count = 0;
    for (uint32_t q = 0; q < 4; q++)
        count += ff_shape_has_ground(info, ff_key_child(parent, q)) != 0;
    FF_ASSERT(count > 0); /* of a node with ground */
    return count;
}

static void give_slot(ff_tree *tree, uint32_t slot)
{
    ff_node *node = &tree->node[slot];
    FF_ASSERT(!ff_node_has_children(node) && tree->free_count < tree->node_count);
    forget_user(tree, node);
    uint32_t *link = &tree->hash[hash_of(tree, node->key)];
    while (*link != slot) {
        FF_ASSERT(*link < tree->node_count); /* a held node is in its chain */
        link = &tree->node[*link].hash_next;
    }
    *link = node->hash_next;
    node->flags = 0;
    node->key = FF_KEY_NONE;
    node->hash_next = tree->free_head;
    tree->free_head = slot;
    tree->free_count++;
    tree->dirty = tree->dropped = 1;
}

void ff_tree_drop_children(ff_tree *tree, ff_node *parent)
{
    for (unsigned q = 0; q < 4; q++) {
        if (parent->child[q] == FF_SLOT_NONE) continue;
        FF_ASSERT(tree->node[parent->child[q]].parent == ff_slot_of(tree, parent));
        give_slot(tree, parent->child[q]);
        parent->child[q] = FF_SLOT_NONE;
    }
    parent->flags &= (uint8_t)~FF_NODE_SPLIT;
    if (tree->lacks) ff_node_settle(tree, ff_slot_of(tree, parent));
}

void ff_tree_drop_root(ff_tree *tree, ff_node *root)
{
    uint32_t *link = &tree->root_head;
    FF_ASSERT(ff_key_level(root->key) == 0 && root->parent == FF_SLOT_NONE);
    while (*link != ff_slot_of(tree, root)) {
        FF_ASSERT(*link < tree->node_count);
        link = &tree->node[*link].list_next;
    }
    *link = root->list_next;
    give_slot(tree, ff_slot_of(tree, root));
}
