/* Several grounds in one tree, and several sources of each. */
#include "ff_tree_local.h"

const uint8_t ff_grounds_built = 1;

/* ---- grounds ---- */

uint32_t ff_ground_search(const ff_tree *tree, uint32_t tile)
{
    ff_cover *cover = tree->cover;
    uint32_t g = tree->ground_count - 1;
    cover->end_tile = FF_KEY_TILES_MAX;
    for (; g > 0 && tile < tree->ground[g].first_tile; g--)
        cover->end_tile = tree->ground[g].first_tile;
    cover->first_tile = tree->ground[g].first_tile;
    return cover->found = g;
}

int ff_tree_add_ground(ff_tree *tree, const ff_terrain_info *info)
{
    const ff_terrain_info *last = &tree->ground[tree->ground_count - 1];
    int rc = ff_terrain_check(info);
    if (rc < 0) return rc;
    if (info->node_log2 != last->node_log2) return FF_ERR_UNSUPPORTED;
    if (info->first_tile < last->first_tile + ff_shape_tiles(last)) return FF_ERR_RANGE;
    if (tree->ground_count == tree->ground_max) return FF_ERR_FULL;
    uint32_t g = tree->ground_count++;
    tree->ground[g] = *info;
    tree->ground[g].curve_q60 = tree->ground->curve_q60;
    tree->cover->end_tile = 0; /* what was found last may have been of no ground */
    ff_cover_rank(tree);
    ff_tree_reshade(tree);
    tree->dirty = 1;
    return (int)g;
}

/* The height of a place, in a ground's steps. */
static int32_t steps_at(const ff_terrain_info *info, int32_t height_wu)
{
    int64_t steps = (((int64_t)height_wu - info->hoffset_wu) * 65536) / info->hscale_q24;
    int64_t most = INT32_MAX / 2; /* the difference of two of them fits */
    return (int32_t)(steps > most ? most : steps < -most ? -most : steps);
}

void ff_grounds_ramp(const ff_tree *tree, const ff_terrain_info *info, int32_t ramp[2])
{
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        const ff_terrain_info *other = &tree->ground[g];
        if (other == info) continue;
        int32_t low = steps_at(info, ff_height_wu(other, other->height_min)),
                high = steps_at(info, ff_height_wu(other, other->height_max));
        ramp[0] = low < ramp[0] ? low : ramp[0];
        ramp[1] = high > ramp[1] ? high : ramp[1];
    }
}

/* ---- sources ---- */

/* Children that are held are drawn, whoever could still send them. */
void ff_node_settle(ff_tree *tree, uint32_t slot)
{
    ff_node *node = &tree->node[slot];
    uint8_t mask = tree->sources[ff_ground_number(tree, ff_key_tile(node->key))];
    int stub = (tree->lacks[slot] & mask) == mask && !(node->flags & FF_NODE_LEAF) &&
               !ff_node_has_children(node);
    if (stub == ff_node_is_stub(node)) return;
    /* it may be in a list of wanted nodes */
    if (node->flags & FF_NODE_WANTED) tree->dropped = 1;
    node->flags &= ~FF_NODE_WANTED & UINT8_MAX;
    node->want_next = stub ? FF_SLOT_NEVER : FF_SLOT_NONE;
    tree->dirty = 1;
}

void ff_node_lacks(ff_tree *tree, uint32_t slot, unsigned source)
{
    FF_ASSERT(source < tree->source_max);
    tree->lacks[slot] |= (uint8_t)(1u << source);
    ff_node_settle(tree, slot);
}

void ff_tree_lacks(ff_tree *tree, ff_key key, unsigned source)
{
    uint32_t slot = tree->lacks ? ff_tree_find(tree, key) : FF_SLOT_NONE;
    if (slot == FF_SLOT_NONE) return;
    ff_node_lacks(tree, slot, source);
    tree->dirty = 1; /* its wish says so */
}

void ff_tree_set_checksum(ff_tree *tree, uint32_t ground, uint32_t checksum)
{
    FF_ASSERT(ground < tree->ground_count);
    tree->ground[ground].checksum = checksum;
}

void ff_tree_set_sources(ff_tree *tree, uint32_t ground, uint8_t mask)
{
    FF_ASSERT(ground < tree->ground_count);
    if (!tree->lacks) return;
    tree->sources[ground] = mask;
    /* one of them may lack an image that another has, and their answers overtake each other */
    if (mask & (mask - 1)) tree->ground[ground].images_whole = 0;
    for (uint32_t slot = 0; slot < tree->node_count; slot++) {
        const ff_node *node = &tree->node[slot];
        if (ff_node_held(node) && ff_terrain_has_node(&tree->ground[ground], node->key))
            ff_node_settle(tree, slot);
    }
}
