#include "bake_block.h"

#include "../../protocol/shape/ff_shape.h"
#include "bake_error.h"
#include "bake_say.h"

#include <string.h>

/* ---- what is known of nodes ---- */

/* How far a node's ground reaches in the lattice. */
static ff_extent extent_of(const bake_block *block, ff_key key)
{
    ff_extent extent = ff_shape_extent(block->levels.info, key);
    return (ff_extent){ extent.columns >> block->apart_log2, extent.rows >> block->apart_log2 };
}

/* 1 when a sample of a node's ground was filled. */
static uint8_t is_filled(const bake_block *block, size_t at, ff_extent extent)
{
    const uint8_t *row = block->levels.marks + at;
    if (!block->levels.marks) return 0;
    for (uint32_t j = 0; j <= extent.rows; j++, row += block->levels.pitch)
        for (uint32_t i = 0; i <= extent.columns; i++)
            if (row[i] & BAKE_FILLED) return 1;
    return 0;
}

/* The levels are the first part of a block. Nodes of padding have no error. */
static bake_known know(const bake_levels *levels, ff_key key, size_t at, uint32_t cell)
{
    const bake_block *block = (const bake_block *)levels;
    ff_extent extent = extent_of(block, key);
    if (!extent.columns || !extent.rows) return (bake_known){ .leaf = 1 };
    uint32_t error = bake_node_error(levels->source + at, levels->marks ? levels->marks + at : NULL,
                                     levels->decoded + at, levels->pitch, extent, cell);
    return (bake_known){ .code = ff_geometric_error_encode(error),
                         .filled = is_filled(block, at, extent),
                         .leaf = 1 };
}

/* What the block tells of its node and of those above. */
static void know_above(bake_block *block, const bake_top *top)
{
    const bake_levels *levels = &block->levels;
    uint32_t block_log2 = block->side_log2 - block->apart_log2, code = ff_key_code(block->key);
    ff_extent size = extent_of(block, block->key);
    uint8_t filled = is_filled(block, 0, size);
    ff_key key = block->key;
    for (uint32_t level = bake_top_bottom(top);; level--, key = ff_key_parent(key)) {
        uint32_t up = bake_top_bottom(top) - level, inside = (1u << up) - 1;
        ff_extent first = { (ff_morton_x(code) & inside) << block_log2, (ff_morton_y(code) & inside)
                                                                            << block_log2 };
        bake_patch patch = { levels->source, levels->marks, levels->pitch, first, size };
        bake_drawn drawn = { .vertex = bake_top_decoded(top, key),
                             .east = (size_t)1 << up,
                             .north = top->levels.pitch << up,
                             .cell = 1u << (top->stride_log2 - block->apart_log2 + up),
                             .extent = extent_of(block, key) };
        block->above[level] = (bake_known){
            .code = ff_geometric_error_encode(bake_patch_error(&patch, &drawn)), .filled = filled
        };
        if (!level) return;
    }
}

/* ---- one block ---- */

int bake_block_open(bake_block *block, const bake_top *top)
{
    const ff_terrain_info *info = top->levels.info;
    *block = (bake_block){ .side_log2 = bake_top_block_log2(top) };
    int rc = bake_levels_open(&block->levels, info, ff_terrain_levels(info) - 1,
                              ((size_t)1 << block->side_log2) + 1);
    block->levels.know = know;
    return rc;
}

void bake_block_close(bake_block *block) { bake_levels_close(&block->levels); }

/* Makes the lattices as wide as samples are apart there, and no wider than the vertices of the
 * block's node are. */
static void choose_lattice(bake_block *block, const bake_samples *samples, ff_sheet first)
{
    const ff_terrain_info *info = block->levels.info;
    uint32_t most = block->side_log2 - info->node_log2;
    block->apart_log2 = samples->apart_log2
                            ? samples->apart_log2(samples, first.x, first.y, block->side_log2)
                            : 0;
    if (block->apart_log2 > most) block->apart_log2 = most;
    block->levels.bottom = ff_terrain_levels(info) - 1 - block->apart_log2;
    block->levels.pitch = ((size_t)1 << (block->side_log2 - block->apart_log2)) + 1;
}

int bake_block_load(bake_block *block, const bake_samples *samples, ff_key key)
{
    bake_levels *levels = &block->levels;
    const ff_terrain_info *info = levels->info;
    uint32_t edge_log2 = info->tile_log2 - ff_key_level(key), code = ff_key_code(key);
    ff_sheet first = ff_shape_sheet(info, ff_key_tile(key));
    first.x = (first.x << info->tile_log2) + (ff_morton_x(code) << edge_log2);
    first.y = (first.y << info->tile_log2) + (ff_morton_y(code) << edge_log2);
    block->key = key;
    if (samples->has_marks && bake_levels_mark(levels, ((size_t)1 << block->side_log2) + 1))
        return -1;
    choose_lattice(block, samples, first);
    /* It has ground, so it has at least one column and one row. */
    for (size_t row = 0, pitch = levels->pitch; row < pitch; row++) {
        uint16_t *to = levels->source + row * pitch;
        uint8_t *marks = levels->marks ? levels->marks + row * pitch : NULL;
        uint64_t at = first.y + ((uint64_t)row << block->apart_log2);
        if (at >= samples->height) {
            memcpy(to, to - pitch, pitch * sizeof *to);
            if (marks) memcpy(marks, marks - pitch, pitch);
        } else if (bake_samples_pick(samples, (uint32_t)at, first.x, block->apart_log2, pitch, to,
                                     marks)) {
            return -1;
        }
    }
    return 0;
}

/* The heights that its node has by the top's levels. */
static void start(bake_block *block, const bake_top *top)
{
    const uint16_t *from = bake_top_decoded(top, block->key);
    uint32_t side = ff_node_side(block->levels.info);
    for (size_t j = 0; j < side; j++)
        for (size_t i = 0; i < side; i++)
            block->levels
                .decoded[(j * block->levels.pitch + i) << (top->stride_log2 - block->apart_log2)] =
                from[j * top->levels.pitch + i];
}

/* Below the last level that the lattice has, nodes that it made have no records. */
static int end_records(bake_block *block)
{
    bake_levels *levels = &block->levels;
    uint32_t above = levels->bottom;
    if (above + 1 >= ff_terrain_levels(levels->info)) return 0;
    size_t count = above == ff_key_level(block->key) ? 1 : 4 * levels->level[above].record_count;
    while (count--)
        if (bake_blob_add(&levels->level[above + 1], NULL, 0)) return -1;
    return 0;
}

bake_off bake_block_off(const bake_block *block)
{
    const bake_levels *levels = &block->levels;
    ff_extent size = extent_of(block, block->key);
    bake_off off = { 0, 0 };
    for (size_t row = 0; row <= size.rows; row++)
        for (size_t i = row * levels->pitch, end = i + size.columns; i <= end; i++) {
            if (levels->marks && levels->marks[i] & BAKE_BETWEEN) continue;
            double by = levels->decoded[i] - levels->source[i];
            off.squares += by * by;
            off.samples++;
        }
    return off;
}

int bake_block_encode(bake_block *block, const bake_top *top)
{
    bake_known *node = &block->above[bake_top_bottom(top)];
    know_above(block, top);
    start(block, top);
    node->leaf = 1; /* where nothing is finer */
    return bake_levels_encode_below(&block->levels, block->key, node) || end_records(block) ? -1
                                                                                            : 0;
}
