#include "whole_tile.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* after the four above: */
#include <cmocka.h>

void whole_tile_open(whole_tile *tile, const ff_terrain_info *info, const bake_grid *grid,
                     const bake_grid *filled, uint32_t number)
{
    bake_grid_samples samples = bake_samples_of(grid, filled);
    *tile = (whole_tile){ .number = number };
    assert_int_equal(bake_top_open(&tile->top, info, info->tile_log2), 0);
    assert_int_equal(bake_block_open(&tile->block, &tile->top), 0);
    assert_int_equal(bake_top_load(&tile->top, &samples.samples, number), 0);
    assert_int_equal(bake_block_load(&tile->block, &samples.samples, ff_key_make(number, 0, 0)), 0);
    tile->source = tile->block.levels.source;
    tile->decoded = tile->block.levels.decoded;
}

void whole_tile_encode(whole_tile *tile)
{
    assert_int_equal(bake_block_encode(&tile->block, &tile->top), 0);
    assert_int_equal(bake_top_encode(&tile->top, tile->block.above), 0);
    for (uint32_t l = 0; l < BAKE_LEVELS_MAX; l++)
        tile->level[l] = l ? tile->block.levels.level[l] : tile->top.levels.level[0];
}

void whole_tile_close(whole_tile *tile)
{
    bake_block_close(&tile->block);
    bake_top_close(&tile->top);
}
