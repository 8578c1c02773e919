#include "bake_block.h"

#include "../../protocol/shape/ff_shape.h"
#include "bake_error.h"
#include "bake_say.h"

#include <stdlib.h>
#include <string.h>

/* ---- what is known of nodes ---- */

/* 1 when a sample of a node's ground was filled. */
static uint8_t is_filled(const bake_block *block, size_t at, ff_extent extent)
{
    if (!block->filled) return 0;
    for (uint32_t row = 0; row <= extent.rows; row++)
        if (memchr(block->filled + at + row * block->levels.pitch, 1, extent.columns + 1)) return 1;
    return 0;
}

/* The levels are the first part of a block. Nodes of padding have no error. */
static bake_known know(const bake_levels *levels, ff_key key, size_t at, uint32_t cell)
{
    ff_extent extent = ff_shape_extent(levels->info, key);
    if (!extent.columns || !extent.rows) return (bake_known){ .leaf = 1 };
    uint32_t error = bake_node_error(levels->source + at, levels->decoded + at, levels->pitch,
                                     extent, cell);
    return (bake_known){ .code = ff_geometric_error_encode(error),
                         .filled = is_filled((const bake_block *)levels, at, extent),
                         .leaf = 1 };
}

/* What the block tells of its node and of those above. */
static void know_above(bake_block *block, const bake_top *top)
{
    const ff_terrain_info *info = block->levels.info;
    uint32_t block_log2 = bake_top_block_log2(top), code = ff_key_code(block->key);
    ff_extent size = ff_shape_extent(info, block->key);
    uint8_t filled = is_filled(block, 0, size);
    ff_key key = block->key;
    for (uint32_t level = bake_top_bottom(top);; level--, key = ff_key_parent(key)) {
        uint32_t up = bake_top_bottom(top) - level, inside = (1u << up) - 1;
        ff_extent first = { (ff_morton_x(code) & inside) << block_log2, (ff_morton_y(code) & inside)
                                                                            << block_log2 };
        bake_patch patch = { block->levels.source, block->levels.pitch, first, size };
        bake_drawn drawn = { .vertex = bake_top_decoded(top, key),
                             .east = (size_t)1 << up,
                             .north = top->levels.pitch << up,
                             .cell = 1u << (top->stride_log2 + up),
                             .extent = ff_shape_extent(info, key) };
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
    *block = (bake_block){ .filled = NULL };
    int rc = bake_levels_open(&block->levels, info, ff_terrain_levels(info) - 1,
                              ((size_t)1 << bake_top_block_log2(top)) + 1);
    block->levels.know = know;
    return rc;
}

void bake_block_close(bake_block *block)
{
    bake_levels_close(&block->levels);
    free(block->filled);
    block->filled = NULL;
}

/* The part of the block that is ground; 0 beyond it. */
static int load_filled(bake_block *block, const bake_grid *filled, ff_sheet first, uint32_t columns)
{
    size_t pitch = block->levels.pitch;
    if (!block->filled) block->filled = malloc(pitch * pitch);
    if (!block->filled) return bake_fail("out of memory");
    memset(block->filled, 0, pitch * pitch);
    for (size_t row = 0; row < pitch && first.y + row < filled->height; row++)
        if (bake_grid_read(filled, first.y + (uint32_t)row, first.x, columns,
                           block->filled + row * pitch))
            return -1;
    return 0;
}

int bake_block_load(bake_block *block, const bake_grid *grid, const bake_grid *filled, ff_key key)
{
    const ff_terrain_info *info = block->levels.info;
    size_t pitch = block->levels.pitch;
    uint32_t edge_log2 = info->tile_log2 - ff_key_level(key), code = ff_key_code(key);
    ff_sheet first = ff_shape_sheet(info, ff_key_tile(key));
    first.x = (first.x << info->tile_log2) + (ff_morton_x(code) << edge_log2);
    first.y = (first.y << info->tile_log2) + (ff_morton_y(code) << edge_log2);
    block->key = key;
    /* It has ground, so it has at least one column and one row. */
    uint32_t columns = grid->width - first.x < pitch ? grid->width - first.x : (uint32_t)pitch;
    for (size_t row = 0; row < pitch; row++) {
        uint16_t *to = block->levels.source + row * pitch;
        if (first.y + row >= grid->height) {
            memcpy(to, to - pitch, pitch * sizeof *to);
            continue;
        }
        if (bake_grid_read(grid, first.y + (uint32_t)row, first.x, columns, to)) return -1;
        for (size_t i = columns; i < pitch; i++) to[i] = to[columns - 1];
    }
    return filled->fd < 0 ? 0 : load_filled(block, filled, first, columns);
}

/* The heights that its node has by the top's levels. */
static void start(bake_block *block, const bake_top *top)
{
    const uint16_t *from = bake_top_decoded(top, block->key);
    uint32_t side = ff_node_side(block->levels.info);
    for (size_t j = 0; j < side; j++)
        for (size_t i = 0; i < side; i++)
            block->levels.decoded[(j * block->levels.pitch + i) << top->stride_log2] =
                from[j * top->levels.pitch + i];
}

int bake_block_encode(bake_block *block, const bake_top *top)
{
    bake_known *node = &block->above[bake_top_bottom(top)];
    know_above(block, top);
    start(block, top);
    node->leaf = 1; /* where nothing is finer */
    return bake_levels_encode_below(&block->levels, block->key, node);
}
