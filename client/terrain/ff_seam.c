/* Seams: which nodes are lowered, the grids that say by how much, and when they are made anew. */
#include "ff_seam.h"

#include <string.h>

#define HASH_PRIME      UINT64_C(0x100000001b3)
#define HASH_START      UINT64_C(0xcbf29ce484222325)
#define LOWEST_SLACK_WU (64 * FF_WU_PER_METRE) /* margins of several seams */

/* ---- what is kept ---- */

static ff_seam *held_seam(const ff_tree *tree, uint32_t slot)
{
    uint32_t number = tree->seams->of_slot[slot];
    ff_seam *seam = number ? &tree->seams->seam[number - 1] : NULL;
    return seam && seam->stamp && seam->slot == slot && seam->key == tree->node[slot].key ? seam
                                                                                          : NULL;
}

static uint16_t *grid_of(const ff_tree *tree, uint16_t *grids, const ff_seam *seam)
{
    return grids + (size_t)(seam - tree->seams->seam) * ff_heights_per_node(tree);
}

const uint16_t *ff_seam_drop(const ff_tree *tree, uint32_t slot, enum ff_lowered how)
{
    const ff_seam *seam = how == FF_LOWERED_NOT ? NULL : held_seam(tree, slot);
    if (!seam || seam->stamp != tree->seams->stamp) return NULL;
    if (how == FF_LOWERED_DIVED)
        return seam->dive_of ? grid_of(tree, tree->seams->dive, seam) : NULL;
    return seam->drop_of ? grid_of(tree, tree->seams->drop, seam) : NULL;
}

/* A seam is given up: its node, if it is held still, is drawn as it is held. */
static void release(ff_tree *tree, ff_seam *seam)
{
    if (held_seam(tree, seam->slot) == seam) {
        tree->seams->of_slot[seam->slot] = 0;
        ff_tree_reshape(tree, seam->slot);
    }
    memset(seam, 0, sizeof *seam);
}

/* One that is free, else one that this selection has not needed so far; NULL: there is none. */
static ff_seam *spare_seam(ff_tree *tree)
{
    ff_seams *seams = tree->seams;
    ff_seam *spare = NULL;
    for (uint32_t i = 0; i < seams->count; i++) {
        ff_seam *seam = &seams->seam[i];
        if (seam->stamp == 0) return seam;
        if (seam->stamp != seams->stamp) spare = seam;
    }
    if (spare) release(tree, spare);
    return spare;
}

/* The node's seam, or a new one; NULL when all are needed. */
static ff_seam *seam_of(ff_tree *tree, uint32_t slot)
{
    ff_seam *seam = held_seam(tree, slot);
    if (!seam) {
        seam = spare_seam(tree);
        if (!seam) return NULL;
        seam->key = tree->node[slot].key;
        seam->slot = slot;
        tree->seams->of_slot[slot] = (uint16_t)(seam - tree->seams->seam + 1);
    }
    seam->stamp = tree->seams->stamp;
    return seam;
}

/* ---- what it is made of ---- */

static uint64_t hash_word(uint64_t hash, uint64_t word) { return (hash ^ word) * HASH_PRIME; }

uint64_t ff_seam_hash(const ff_tree *tree, uint32_t ground, const ff_area *area,
                      enum ff_lowered how, uint64_t hash)
{
    ff_over over;
    ff_over_begin(&over, tree, ground, area);
    hash = hash_word(hash ? hash : HASH_START, ground);
    for (const ff_node *node; (node = ff_over_next(&over)) != NULL;) {
        const ff_seam *seam = held_seam(tree, ff_slot_of(tree, node));
        int left_out = node->parent != FF_SLOT_NONE && node->flags & FF_NODE_LEFT_OUT;
        hash = hash_word(hash, node->key);
        hash = hash_word(hash, left_out ? 1u << FF_SIDE_COUNT : ff_coarser_mask(tree, node));
        if (how != FF_LOWERED_NOT && seam && seam->stamp == tree->seams->stamp)
            hash = hash_word(hash, how == FF_LOWERED_DIVED ? seam->dive_of : seam->drop_of);
    }
    return hash;
}

uint32_t ff_seam_steps(const ff_terrain_info *info, int64_t length_wu)
{
    FF_ASSERT(length_wu > 0);
    uint64_t steps = (((uint64_t)length_wu << 16) + info->hscale_q24 - 1) / info->hscale_q24;
    return steps < UINT32_MAX ? (uint32_t)steps : UINT32_MAX;
}

int ff_seam_lower(uint16_t *vertex, uint32_t steps)
{
    int deep = steps > UINT16_MAX;
    if (deep) steps = UINT16_MAX;
    if (steps > *vertex) *vertex = (uint16_t)steps;
    return !deep;
}

/* ---- where ---- */

int ff_seam_touches(const ff_tree *tree, const ff_node *node)
{
    return ff_seam_dives(tree, node) || ff_seam_has_rim(tree, node);
}

int64_t ff_seam_lowest_wu(const ff_tree *tree)
{
    int64_t lowest_wu = INT64_MAX;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        int64_t height_wu[2];
        ff_terrain_range_wu(&tree->ground[g], height_wu);
        lowest_wu = height_wu[0] < lowest_wu ? height_wu[0] : lowest_wu;
    }
    return lowest_wu - LOWEST_SLACK_WU;
}

/* ---- a selection ---- */

static void dive(ff_tree *tree, uint32_t slot)
{
    const ff_node *node = &tree->node[slot];
    int dives = ff_seam_dives(tree, node);
    if (!dives && !ff_seam_has_rim(tree, node)) return;
    ff_seam *seam = seam_of(tree, slot);
    if (!seam) {
        tree->stats.seams_short++;
        return;
    }
    uint64_t of = dives ? ff_seam_dive_of(tree, node) : 1;
    if (of == seam->dive_of) return;
    uint16_t *grid = grid_of(tree, tree->seams->dive, seam);
    memset(grid, 0, ff_heights_per_node(tree) * sizeof *grid);
    if (dives && !ff_seam_dive(tree, node, grid)) tree->stats.seams_short++;
    seam->dive_of = of;
}

static void lower_rim(ff_tree *tree, uint32_t slot)
{
    ff_seam *seam = held_seam(tree, slot);
    if (!seam || seam->stamp != tree->seams->stamp) return;
    const ff_node *node = &tree->node[slot];
    int has_rim = ff_seam_has_rim(tree, node);
    uint64_t of = hash_word(seam->dive_of, has_rim ? ff_seam_rim_of(tree, node) : 1);
    if (of == seam->drop_of) return;
    uint16_t *grid = grid_of(tree, tree->seams->drop, seam);
    memcpy(grid, grid_of(tree, tree->seams->dive, seam), ff_heights_per_node(tree) * sizeof *grid);
    if (has_rim && !ff_seam_rim(tree, node, grid)) tree->stats.seams_short++;
    seam->drop_of = of;
    ff_tree_reshape(tree, slot);
}

static void each_in_view(ff_tree *tree, uint32_t ground, int rims)
{
    for (uint32_t i = 0; i < tree->view_count; i++) {
        const ff_drawn *drawn = &tree->drawn[i];
        if (ff_ground_number(tree, ff_key_tile(drawn->key)) != ground) continue;
        if (rims)
            lower_rim(tree, ff_slot_of(tree, drawn->node));
        else
            dive(tree, ff_slot_of(tree, drawn->node));
    }
}

void ff_seam_make(ff_tree *tree)
{
    ff_seams *seams = tree->seams;
    int none_held = tree->stats.seams == 0;
    tree->stats.seams = tree->stats.seams_short = 0;
    if (tree->cover->alone && none_held) return;
    if (++seams->stamp == 0) seams->stamp = 1;
    uint32_t count = tree->cover->alone ? 0 : tree->ground_count;
    for (uint32_t rank = 0; rank < count; rank++)
        each_in_view(tree, ff_ground_ranked(tree, rank), 0);
    for (uint32_t rank = count; rank-- > 0;) each_in_view(tree, ff_ground_ranked(tree, rank), 1);
    for (uint32_t i = 0; i < seams->count; i++) {
        ff_seam *seam = &seams->seam[i];
        if (seam->stamp && seam->stamp != seams->stamp) release(tree, seam);
        tree->stats.seams += seam->stamp != 0;
    }
}
