/* The tree as its users see it: creation in one block, arrival of nodes, answers to questions. */
#include "ff_tree_local.h"
#include "ff_horizon.h"
#include "ff_seam.h"

#include <string.h>

#define BLOCK_ALIGN 16u

/* Hands out parts of a block; with base NULL it only counts. */
typedef struct block {
    uint8_t *base;
    size_t used;
} block;

static void *take(block *from, size_t bytes)
{
    void *part = from->base ? from->base + from->used : NULL;
    FF_ASSERT((uintptr_t)part % BLOCK_ALIGN == 0);
    from->used += (bytes + BLOCK_ALIGN - 1) & ~(size_t)(BLOCK_ALIGN - 1);
    return part;
}

static uint32_t hash_size(uint32_t node_count)
{
    uint32_t size = 8;
    FF_ASSERT(node_count <= FF_NODES_MAX);
    while (size < node_count) size *= 2;
    return size;
}

static uint32_t grounds_of(const ff_tree_desc *desc)
{
    return desc->ground_max ? desc->ground_max : 1;
}
static uint32_t sources_of(const ff_tree_desc *desc)
{
    return desc->source_max ? desc->source_max : 1;
}

static ff_seams *carve_seams(const ff_tree_desc *desc, block *from)
{
    size_t side = ff_node_side(&desc->info);
    ff_seams *seams = take(from, sizeof *seams);
    ff_seams parts = { .count = desc->seam_max ? desc->seam_max : desc->node_count / 8 };
    if (parts.count >= UINT16_MAX) parts.count = UINT16_MAX - 1;
    parts.of_slot = take(from, desc->node_count * sizeof *parts.of_slot);
    parts.seam = take(from, parts.count * sizeof *parts.seam);
    parts.dive = take(from, parts.count * side * side * sizeof *parts.dive);
    parts.drop = take(from, parts.count * side * side * sizeof *parts.drop);
    if (seams) *seams = parts;
    return seams;
}

static ff_tree *carve(const ff_tree_desc *desc, block *from)
{
    size_t n = desc->node_count, side = ff_node_side(&desc->info),
           refined = ff_refined_side(&desc->info), sort = 2 * n * sizeof(uint64_t),
           room = ff_codec_room(&desc->info);
    FF_ASSERT(side * side <= FF_NODE_HEIGHTS_MAX && refined * refined <= FF_REFINED_HEIGHTS_MAX);
    ff_tree *tree = take(from, sizeof *tree);
    ff_tree parts = { .ground_max = grounds_of(desc), .source_max = sources_of(desc) };
    parts.ground = take(from, parts.ground_max * sizeof *parts.ground);
    parts.window = take(from, 2 * parts.ground_max * sizeof *parts.window);
    parts.node = take(from, n * sizeof *parts.node);
    parts.heights = take(from, n * side * side * sizeof *parts.heights);
    parts.hash = take(from, hash_size(desc->node_count) * sizeof *parts.hash);
    parts.order = take(from, n * sizeof *parts.order);
    parts.room = parts.sort = take(from, sort > room ? sort : room);
    parts.drawn = take(from, n * sizeof *parts.drawn);
    parts.wish = take(from, desc->wish_count * sizeof *parts.wish);
    parts.refined = take(from, refined * refined * sizeof *parts.refined);
    if (desc->hidden != FF_HIDDEN_FETCHED) {
        parts.horizon = take(from, sizeof *parts.horizon);
        parts.horizon_ahead = take(from, sizeof *parts.horizon);
    }
    if (parts.ground_max > 1) {
        parts.cover = take(from, sizeof *parts.cover);
        parts.seams = carve_seams(desc, from);
    }
    if (parts.source_max > 1) {
        parts.sources = take(from, parts.ground_max);
        parts.lacks = take(from, n);
    }
    if (tree) *tree = parts;
    return tree;
}

static int desc_ok(const ff_tree_desc *desc)
{
    return desc->node_count >= 8 && desc->node_count <= FF_NODES_MAX &&
           desc->wish_count <= FF_NODES_MAX && ff_terrain_check(&desc->info) >= 0 &&
           desc->seam_max < UINT16_MAX &&
           grounds_of(desc) <= (ff_grounds_built ? FF_GROUNDS_MAX : 1) &&
           sources_of(desc) <= (ff_grounds_built ? FF_SOURCES_MAX : 1);
}

size_t ff_tree_bytes(const ff_tree_desc *desc)
{
    block count = { NULL, BLOCK_ALIGN }; /* room to align a block that is not */
    if (!desc_ok(desc)) return 0;
    carve(desc, &count);
    return count.used;
}

ff_tree *ff_tree_create(const ff_tree_desc *desc, void *memory, size_t bytes)
{
    if (!memory || !desc_ok(desc) || bytes < ff_tree_bytes(desc)) return NULL;
    block from = { memory, (BLOCK_ALIGN - (uintptr_t)memory % BLOCK_ALIGN) % BLOCK_ALIGN };
    ff_tree *tree = carve(desc, &from);
    FF_ASSERT(from.used <= bytes);
    tree->window_ahead = tree->window + tree->ground_max;
    memset(tree->window, 0, 2 * tree->ground_max * sizeof *tree->window);
    tree->ground[0] = desc->info;
    tree->ground_count = 1;
    if (tree->lacks) memset(tree->sources, 1, tree->ground_max);
    tree->node_count = tree->free_count = desc->node_count;
    tree->wish_capacity = desc->wish_count;
    if (tree->cover) {
        memset(tree->cover, 0, sizeof *tree->cover);
        ff_cover_rank(tree);
        memset(tree->seams->of_slot, 0, tree->node_count * sizeof *tree->seams->of_slot);
        memset(tree->seams->seam, 0, tree->seams->count * sizeof *tree->seams->seam);
    }
    tree->hidden = desc->hidden;
    if (tree->horizon) {
        memset(tree->horizon, 0, sizeof *tree->horizon);
        memset(tree->horizon_ahead, 0, sizeof *tree->horizon_ahead);
    }
    tree->hash_mask = hash_size(desc->node_count) - 1;
    FF_ASSERT((tree->hash_mask & (tree->hash_mask + 1)) == 0);
    memset(tree->hash, 0xFF, (tree->hash_mask + 1) * sizeof *tree->hash);
    memset(tree->node, 0, tree->node_count * sizeof *tree->node);
    for (uint32_t slot = 0; slot < tree->node_count; slot++) {
        tree->node[slot].key = FF_KEY_NONE;
        tree->node[slot].hash_next = slot + 1 < tree->node_count ? slot + 1 : FF_SLOT_NONE;
    }
    tree->root_head = FF_SLOT_NONE;
    memset(tree->want_head, 0xFF, sizeof tree->want_head);
    tree->stats.nodes_capacity = tree->node_count;
    return tree;
}

FF_STATIC_ASSERT(FF_NODE_HEIGHTS_MAX <= UINT32_MAX / UINT16_MAX); /* a sum of heights */

/* Of a node whose heights are there: what the payload says of it, and what its heights say. */
static void take_node(ff_tree *tree, uint32_t slot, const ff_residuals *residuals, uint32_t q,
                      unsigned source)
{
    const uint16_t *height = ff_heights_of(tree, slot);
    size_t count = ff_heights_per_node(tree);
    uint32_t sum = 0;
    uint16_t lowest = UINT16_MAX, highest = 0;
    for (size_t i = 0; i < count; i++) {
        lowest = height[i] < lowest ? height[i] : lowest;
        highest = height[i] > highest ? height[i] : highest;
        sum += height[i];
    }
    ff_node *node = &tree->node[slot];
    node->height_min = lowest;
    node->height_max = highest;
    node->height_mean = (uint16_t)(sum / count);
    node->error_code = residuals->child_error[q];
    if (residuals->filled >> q & 1u) node->flags |= FF_NODE_FILLED;
    if (residuals->leaf >> q & 1u) node->flags |= FF_NODE_LEAF;
    if (residuals->stub >> q & 1u) {
        if (tree->lacks)
            ff_node_lacks(tree, slot, source);
        else
            node->want_next = FF_SLOT_NEVER;
    }
    FF_ASSERT(!(ff_node_is_stub(node) && node->flags & FF_NODE_LEAF));
    FF_ASSERT(node->height_min <= node->height_mean && node->height_mean <= node->height_max);
    FF_ASSERT(ff_geometric_error_decode(node->error_code) <= 65536);
}

int ff_tree_deliver_root(ff_tree *tree, uint32_t tile, unsigned source,
                         const ff_residuals *residuals)
{
    ff_key key = ff_key_make(tile, 0, 0);
    const ff_terrain_info *info = ff_ground_of_tile(tree, tile);
    FF_ASSERT(source < tree->source_max);
    if (!ff_terrain_has_node(info, key)) return FF_ERR_RANGE;
    if (ff_tree_find(tree, key) != FF_SLOT_NONE) return FF_OK;
    if (!ff_evict_for_root(tree, tile)) {
        tree->stats.pool_full++;
        return FF_ERR_FULL;
    }
    FF_ASSERT(tree->free_count > 0);
    uint32_t slot = ff_tree_take_slot(tree, key, FF_SLOT_NONE);
    int rc = ff_reconstruct_root(info, residuals, ff_heights_of(tree, slot), tree->room);
    if (rc != FF_OK) {
        ff_tree_drop_root(tree, &tree->node[slot]);
        return rc;
    }
    take_node(tree, slot, residuals, 0, source);
    ff_tree_reshade_beside(tree, key);
    tree->dirty = 1;
    return FF_OK;
}

/* Room for the children of a node that has none. FF_OK or FF_ERR_FULL. */
static int make_room(ff_tree *tree, uint32_t slot)
{
    if (!ff_evict_for_children(tree, slot)) {
        tree->stats.pool_full++;
        return FF_ERR_FULL;
    }
    return FF_OK;
}

/* Takes the children of a node out of tree->refined into slots, for which there is room. */
static void take_children(ff_tree *tree, uint32_t slot, const ff_residuals *residuals,
                          unsigned source)
{
    const ff_terrain_info *info = ff_ground_of(tree, tree->node[slot].key);
    for (uint32_t q = 0; q < 4; q++) {
        ff_key key = ff_key_child(tree->node[slot].key, q);
        if (!ff_shape_has_ground(info, key)) continue;
        uint32_t child = ff_tree_take_slot(tree, key, slot);
        ff_refined_child(info, tree->refined, q, ff_heights_of(tree, child));
        take_node(tree, child, residuals, q, source);
        tree->node[slot].child[q] = child;
        ff_tree_reshade_beside(tree, key);
    }
    tree->dirty = 1;
}

int ff_tree_deliver_children(ff_tree *tree, ff_key key, unsigned source,
                             const ff_residuals *residuals)
{
    const ff_terrain_info *info = ff_ground_of(tree, key);
    FF_ASSERT(source < tree->source_max);
    if (!ff_terrain_has_node(info, key) || ff_key_level(key) + 1 >= ff_terrain_levels(info))
        return FF_ERR_RANGE;
    uint32_t slot = ff_tree_find(tree, key);
    if (slot == FF_SLOT_NONE) {
        tree->stats.orphans++;
        return FF_ERR_NOT_FOUND;
    }
    if (ff_node_has_children(&tree->node[slot])) return FF_OK;
    if (ff_node_is_stub(&tree->node[slot])) return FF_ERR_NOT_FOUND; /* nobody asked */
    if (!ff_tree_take_sides(tree, key, residuals->sides)) {
        tree->stats.sides_gone++;
        return FF_ERR_NOT_FOUND; /* it is wished for again, as a whole */
    }
    int rc = make_room(tree, slot); /* what is beside it may go for that */
    if (rc != FF_OK) return rc;
    FF_ASSERT(tree->node[slot].key == key); /* it was spared itself */
    rc = ff_reconstruct_beside(info, ff_heights_of(tree, slot), residuals, tree->refined,
                               tree->room);
    if (rc != FF_OK) return rc;
    take_children(tree, slot, residuals, source);
    return FF_OK;
}

void ff_tree_make_children(ff_tree *tree)
{
    for (uint32_t i = 0; i < tree->made_count; i++) {
        uint32_t slot = ff_tree_find(tree, tree->made[i]);
        const ff_node *node = slot == FF_SLOT_NONE ? NULL : &tree->node[slot];
        /* it may have gone meanwhile, and come again as a server that errs now tells it */
        if (!node || !(node->flags & FF_NODE_LEAF) || ff_node_has_children(node) ||
            make_room(tree, slot) != FF_OK)
            continue;
        const ff_terrain_info *info = ff_ground_of(tree, node->key);
        ff_residuals all = ff_leaf_residuals(info, node->error_code, node->flags & FF_NODE_FILLED);
        FF_ASSERT(ff_key_level(node->key) + 1 < ff_terrain_levels(info));
        ff_predict_children(info, ff_shape_cells(info, node->key, 1), ff_heights_of(tree, slot),
                            tree->refined, tree->room);
        take_children(tree, slot, &all, 0);
    }
    tree->made_count = 0;
}

uint32_t ff_tree_to_make(const ff_tree *tree) { return tree->made_count; }

uint32_t ff_tree_drawn(const ff_tree *tree, const ff_drawn **list)
{
    *list = tree->drawn;
    return tree->drawn_count;
}

uint32_t ff_tree_in_view(const ff_tree *tree, const ff_drawn **list)
{
    *list = tree->drawn;
    return tree->view_count;
}

uint32_t ff_tree_cut(const ff_tree *tree, const ff_drawn **list)
{
    FF_ASSERT(tree->drawn_count <= tree->view_count && tree->view_count <= tree->cut_count);
    for (uint32_t i = tree->view_count; i < tree->cut_count; i++) {
        if (tree->drawn[i].coarser == FF_COARSER_UNKNOWN)
            tree->drawn[i].coarser = (uint8_t)ff_coarser_mask(tree, tree->drawn[i].node);
    }
    *list = tree->drawn;
    return tree->cut_count;
}

const ff_terrain_info *ff_tree_ground(const ff_tree *tree, ff_key key)
{
    return ff_ground_of(tree, key);
}

void ff_tree_show_images(ff_tree *tree, uint32_t ground, const ff_terrain_info *told,
                         uint32_t levels)
{
    FF_ASSERT(ground < tree->ground_count);
    ff_terrain_show_images(&tree->ground[ground], told, levels);
}

const ff_terrain_info *ff_tree_grounds(const ff_tree *tree, uint32_t *count)
{
    *count = tree->ground_count;
    return tree->ground;
}

const ff_frame *ff_tree_frame(const ff_tree *tree) { return &tree->view.frame; }

const ff_quality *ff_tree_quality(const ff_tree *tree) { return &tree->quality; }

const ff_placed *ff_tree_placed(const ff_node *node) { return &node->placed; }

int64_t ff_tree_error_wu(const ff_terrain_info *info, const ff_node *node)
{
    return ff_steps_wu(info, ff_geometric_error_decode(node->error_code));
}

uint32_t ff_tree_wishes(const ff_tree *tree, const ff_wish **list)
{
    *list = tree->wish;
    return tree->wish_count;
}

uint32_t *ff_tree_user(ff_tree *tree, const ff_node *node)
{
    return &tree->node[ff_slot_of(tree, node)].user;
}

void ff_tree_on_evict(ff_tree *tree, void (*on_evict)(void *context, uint32_t user), void *context)
{
    tree->on_evict = on_evict;
    tree->evict_context = context;
}

void ff_tree_get_stats(const ff_tree *tree, ff_tree_stats *stats)
{
    *stats = tree->stats;
    stats->nodes_held = tree->node_count - tree->free_count;
    FF_ASSERT(stats->nodes_held <= stats->nodes_high && stats->nodes_high <= tree->node_count);
    stats->nodes_cut = tree->cut_count;
    stats->nodes_drawn = tree->drawn_count;
}
