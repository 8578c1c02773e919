/* Sides of a node's children that its neighbours' children have: they need not come again. */
#include "ff_tree_local.h"

/* Child 0 or 1 along a side of a node, from its lower end. */
static uint32_t child_at(const ff_tree *tree, uint32_t slot, enum ff_side side, uint32_t along)
{
    static const uint8_t first[FF_SIDE_COUNT] = { 0, 1, 2, 0 },
                         apart[FF_SIDE_COUNT] = { 1, 2, 1, 2 };
    FF_ASSERT((unsigned)side < FF_SIDE_COUNT && along < 2);
    return tree->node[slot].child[first[side] + along * apart[side]];
}

/* The node across, when its children are held. */
static uint32_t find_beside(const ff_tree *tree, ff_key key, enum ff_side side, ff_beside *beside)
{
    *beside = ff_shape_neighbour(ff_ground_of(tree, key), key, side);
    uint32_t slot = beside->key == FF_KEY_NONE ? FF_SLOT_NONE : ff_tree_find(tree, beside->key);
    FF_ASSERT(slot == FF_SLOT_NONE || tree->node[slot].key == beside->key);
    return slot != FF_SLOT_NONE && ff_node_has_children(&tree->node[slot]) ? slot : FF_SLOT_NONE;
}

unsigned ff_tree_sides(const ff_tree *tree, ff_key key)
{
    ff_beside beside;
    unsigned sides = 0;
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        if (find_beside(tree, key, (enum ff_side)side, &beside) != FF_SLOT_NONE)
            sides |= 1u << side;
    FF_ASSERT(sides >> FF_SIDE_COUNT == 0);
    return sides;
}

/* A side of a grid of `across` points each way: its first point, and how far apart they lie. */
static uint32_t first_of(enum ff_side side, uint32_t across, uint32_t *stride)
{
    *stride = side == FF_SIDE_SOUTH || side == FF_SIDE_NORTH ? 1 : across;
    return side == FF_SIDE_EAST ? across - 1 : side == FF_SIDE_NORTH ? (across - 1) * across : 0;
}

/* Where the ground ends along a side, the child there has none and is not held, and points beyond
 * are made like all others that have none (ff_reconstruct_beside). */
static void copy_side(ff_tree *tree, uint32_t slot, const ff_beside *beside, enum ff_side side)
{
    const ff_terrain_info *info = ff_ground_of(tree, tree->node[slot].key);
    uint32_t across = ff_node_side(info), last = across - 1, stride, own_stride,
             from = first_of(beside->side, across, &stride),
             to = first_of(side, ff_refined_side(info), &own_stride);
    FF_ASSERT(2 * last + 1 == ff_refined_side(info));
    for (uint32_t i = 0; i <= 2 * last; i++) {
        uint32_t along = ff_beside_along(beside, i, 2 * last), half = along > last,
                 child = child_at(tree, slot, beside->side, half);
        FF_ASSERT(along - half * last <= last);
        if (child == FF_SLOT_NONE) continue;
        tree->refined[to + i * own_stride] = ff_heights_of(
            tree, child)[from + (along - half * last) * stride];
    }
}

int ff_tree_take_sides(ff_tree *tree, ff_key key, unsigned sides)
{
    ff_beside beside;
    FF_ASSERT(sides >> FF_SIDE_COUNT == 0);
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        if (!(sides >> side & 1u)) continue;
        uint32_t slot = find_beside(tree, key, (enum ff_side)side, &beside);
        if (slot == FF_SLOT_NONE) return 0;
        copy_side(tree, slot, &beside, (enum ff_side)side);
    }
    return 1;
}
