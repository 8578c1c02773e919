/* The restricted cut: edge neighbours differ by at most one level. Desire flows downward (a node
 * that wants to split makes its coarser neighbours want to), and a node splits only beside
 * neighbours that have come as far as itself. */
#include "ff_tree_local.h"

/* The parent of the node of the same level beyond `side`, when it is another one than the node's
 * own and in ground that is drawn, else FF_KEY_NONE. */
static ff_key parent_beside(const ff_tree *tree, const ff_node *node, enum ff_side side)
{
    static const uint8_t towards[FF_SIDE_COUNT] = { /* quadrants at that side, a bit each */
                                                    [FF_SIDE_SOUTH] = 0x3,
                                                    [FF_SIDE_EAST] = 0xa,
                                                    [FF_SIDE_NORTH] = 0xc,
                                                    [FF_SIDE_WEST] = 0x5
    };
    if (ff_key_level(node->key) == 0 || !(towards[side] >> ff_key_quadrant(node->key) & 1u))
        return FF_KEY_NONE;
    ff_key beside =
        ff_shape_neighbour(ff_ground_of(tree, node->key), ff_key_parent(node->key), side).key;
    FF_ASSERT(beside == FF_KEY_NONE || ff_key_level(beside) + 1 == ff_key_level(node->key));
    if (beside != FF_KEY_NONE && ff_left_out(tree, beside)) return FF_KEY_NONE;
    if (beside == FF_KEY_NONE || ff_key_tile(beside) == ff_key_tile(node->key)) return beside;
    uint32_t root = ff_tree_find(tree, ff_key_make(ff_key_tile(beside), 0, 0));
    return root != FF_SLOT_NONE && tree->node[root].flags & FF_NODE_ACTIVE ? beside : FF_KEY_NONE;
}

static int side_coarser(const ff_tree *tree, const ff_node *node, enum ff_side side)
{
    ff_key beside = parent_beside(tree, node, side);
    if (beside == FF_KEY_NONE) return 0;
    FF_ASSERT(beside != ff_key_parent(node->key));
    uint32_t parent = ff_tree_find(tree, beside);
    return parent == FF_SLOT_NONE || !(tree->node[parent].flags & FF_NODE_SPLIT);
}

unsigned ff_coarser_mask(const ff_tree *tree, const ff_node *node)
{
    unsigned mask = 0;
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        mask |= (unsigned)side_coarser(tree, node, (enum ff_side)side) << side;
    FF_ASSERT(!(mask & mask >> 2)); /* of opposite sides one lies inside the parent */
    return mask;
}

void ff_want(ff_tree *tree, uint32_t slot, uint32_t value)
{
    ff_node *node = &tree->node[slot];
    FF_ASSERT(value > FF_VALUE_ONE && ff_node_held(node));
    if (ff_node_is_stub(node)) return;
    if (node->flags & FF_NODE_WANTED) {
        if (value > node->value) node->value = value;
        return;
    }
    uint32_t level = ff_key_level(node->key);
    FF_ASSERT(level + 1 < ff_terrain_levels(ff_ground_of(tree, node->key)));
    node->flags = (uint8_t)((node->flags & ~FF_NODE_HIDDEN) | FF_NODE_WANTED);
    node->value = value;
    node->want_next = tree->want_head[level];
    tree->want_head[level] = slot;
}

/* Is a wanted node in view, or needed by one that is? */
static int is_needed_in_view(const ff_tree *tree, const ff_node *node)
{
    ff_box box;
    FF_ASSERT(node->flags & FF_NODE_WANTED);
    if (node->flags & FF_NODE_NEEDED) return 1;
    ff_node_box(tree, node, &box);
    return ff_box_in_view(tree, &box);
}

/* ---- new tiles ---- */

/* A root that comes for the reserve would at once forbid its neighbours in view to be more than a
 * level finer, and the picture would become coarser by what it gained. So out of view a new tile
 * joins the cut once all has come of it that nodes in view need. In view it joins at once: empty
 * ground is worse. */

static int is_new(const ff_node *root)
{
    return (root->flags & (FF_NODE_ACTIVE | FF_NODE_JOINED)) == FF_NODE_ACTIVE;
}

/* 1 when a tile lacks children that something in view needs. */
static int lacks_needed(const ff_tree *tree, uint32_t tile)
{
    for (uint32_t level = 0; level < FF_LEVELS_MAX; level++)
        for (uint32_t slot = tree->want_head[level]; slot != FF_SLOT_NONE;
             slot = tree->node[slot].want_next) {
            const ff_node *node = &tree->node[slot];
            if (ff_key_tile(node->key) == tile && node->flags & FF_NODE_NEEDED &&
                !ff_node_has_children(node))
                return 1;
        }
    return 0;
}

static int has_new_tiles(const ff_tree *tree)
{
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next)
        if (is_new(&tree->node[slot])) return 1;
    return 0;
}

static void join_tiles(ff_tree *tree, uint32_t g)
{
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        ff_node *root = &tree->node[slot];
        ff_box box;
        if (ff_ground_number(tree, ff_key_tile(root->key)) != g) continue;
        if (!(root->flags & FF_NODE_ACTIVE)) root->flags &= (uint8_t)~FF_NODE_JOINED;
        if (!is_new(root)) continue;
        if (tree->cover && !tree->cover->alone) { /* what is drawn is decided before */
            root->flags |= FF_NODE_JOINED;
            continue;
        }
        ff_node_box(tree, root, &box);
        if (!ff_box_in_view(tree, &box) && lacks_needed(tree, ff_key_tile(root->key))) {
            root->flags &= (uint8_t)~FF_NODE_ACTIVE;
            tree->tiles_wait = 1;
        } else {
            root->flags |= FF_NODE_JOINED;
        }
    }
}

int ff_tile_waits(const ff_tree *tree, const ff_node *node)
{
    if (!tree->tiles_wait) return 0;
    uint32_t root = ff_tree_find(tree, ff_key_make(ff_key_tile(node->key), 0, 0));
    FF_ASSERT(root != FF_SLOT_NONE);
    return !(tree->node[root].flags & FF_NODE_ACTIVE);
}

/* What is needed of tiles in the cut is found again once it is known what is hidden. */
static void forget_needs(ff_tree *tree)
{
    for (uint32_t level = 0; level < FF_LEVELS_MAX; level++)
        for (uint32_t slot = tree->want_head[level]; slot != FF_SLOT_NONE;
             slot = tree->node[slot].want_next) {
            ff_node *node = &tree->node[slot];
            if (!ff_tile_waits(tree, node)) node->flags &= (uint8_t)~FF_NODE_NEEDED;
        }
}

/* From the finest level up: what a level adds concerns coarser levels of the same ground only. What
 * nodes in view need is marked where there are new tiles, for them. */
void ff_want_close(ff_tree *tree, uint32_t g, const uint32_t before[FF_LEVELS_MAX])
{
    int through = has_new_tiles(tree);
    for (uint32_t level = FF_LEVELS_MAX; level-- > 1;) {
        for (uint32_t slot = tree->want_head[level]; slot != before[level];
             slot = tree->node[slot].want_next) {
            const ff_node *node = &tree->node[slot];
            FF_ASSERT(ff_key_level(node->key) == level);
            for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
                ff_key beside = parent_beside(tree, node, (enum ff_side)side);
                if (beside == FF_KEY_NONE) continue;
                uint32_t nearest = ff_tree_find_nearest(tree, beside);
                if (nearest == FF_SLOT_NONE) continue;
                FF_ASSERT(ff_key_level(tree->node[nearest].key) < level);
                ff_want(tree, nearest, node->value);
                if (through && !ff_node_is_stub(&tree->node[nearest]) &&
                    is_needed_in_view(tree, node))
                    tree->node[nearest].flags |= FF_NODE_NEEDED;
            }
        }
    }
    join_tiles(tree, g);
    if (through) forget_needs(tree);
}

void ff_need_beside(ff_tree *tree, const ff_node *node)
{
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        ff_key beside = parent_beside(tree, node, (enum ff_side)side);
        if (beside == FF_KEY_NONE) continue;
        uint32_t nearest = ff_tree_find_nearest(tree, beside);
        if (nearest == FF_SLOT_NONE) continue;
        if ((tree->node[nearest].flags & (FF_NODE_WANTED | FF_NODE_SPLIT)) == FF_NODE_WANTED)
            tree->node[nearest].flags |= FF_NODE_NEEDED;
    }
}

int ff_node_needed(const ff_tree *tree, const ff_node *node)
{
    ff_box box;
    FF_ASSERT(node->flags & FF_NODE_WANTED);
    if (node->flags & FF_NODE_NEEDED && !ff_tile_waits(tree, node)) return 1;
    ff_node_box(tree, node, &box);
    return ff_node_seen(tree, node, &box);
}
