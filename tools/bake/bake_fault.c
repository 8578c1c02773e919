#include "bake_fault.h"

#include <inttypes.h>
#include <stdio.h>

/* Samples along so many tiles; of a tile's size out of range, which is told before, some number. */
static uint64_t product(uint32_t tiles, uint8_t tile_log2)
{
    return (uint64_t)(tiles ? tiles : 1) << (tile_log2 <= FF_TILE_LOG2_MAX ? tile_log2 : 0);
}

/* The least that a number of tiles holds, and the most. */
static int64_t samples_low(uint32_t tiles, uint8_t tile_log2)
{
    return (int64_t)(product(tiles, tile_log2) - product(1, tile_log2)) + 2;
}

static int64_t samples_high(uint32_t tiles, uint8_t tile_log2)
{
    return (int64_t)product(tiles, tile_log2) + 1;
}

int bake_fault(const ff_terrain_info *i, char *text, size_t room)
{
    uint32_t most_tiles = i->tiles_x > i->tiles_y ? i->tiles_x : i->tiles_y;
    uint8_t log2 = i->tile_log2;
    int64_t top_wu = (int64_t)i->hoffset_wu +
                     (int64_t)((UINT16_MAX * (uint64_t)i->hscale_q24) >> 16);
    int textures = i->texture_log2 != 0;
    const struct {
        const char *name;
        int64_t value, low, high;
    } field[] = {
        { "node_log2", i->node_log2, 1, FF_NODE_LOG2_MAX },
        { "tile_log2", log2, i->node_log2, i->node_log2 + (int64_t)FF_KEY_LEVEL_MAX },
        { "flags", i->flags, 0,
          textures ? FF_TERRAIN_FLAGS : FF_TERRAIN_FLAGS & ~FF_TERRAIN_PICTURES },
        { "tiles_x", i->tiles_x, 1, FF_KEY_TILES_MAX },
        { "tiles_y", i->tiles_y, 1, i->tiles_x ? FF_KEY_TILES_MAX / i->tiles_x : 0 },
        { "samples_x", i->samples_x, samples_low(i->tiles_x, log2),
          samples_high(i->tiles_x, log2) },
        { "samples_y", i->samples_y, samples_low(i->tiles_y, log2),
          samples_high(i->tiles_y, log2) },
        { "spacing_wu", i->spacing_wu, 1, INT32_MAX / (int64_t)product(most_tiles, log2) },
        { "hscale_q24", i->hscale_q24, 1, INT32_MAX },
        { "the height of step 65535 in wu", top_wu, INT32_MIN, INT32_MAX },
        { "height_min", i->height_min, 0, i->height_max },
        { "max_error", i->max_error, 0, INT16_MAX },
        { "curve_q60", i->curve_q60, 0, FF_CURVE_MAX },
        { "texture_log2", i->texture_log2, textures ? 4 : 0, 8 },
        { "texture_levels", i->texture_levels, textures, textures ? FF_KEY_LEVEL_MAX + 1 : 0 },
    };
    for (size_t f = 0; f < sizeof field / sizeof *field; f++)
        if (field[f].value < field[f].low || field[f].value > field[f].high) {
            snprintf(text, room, "%s %" PRId64 " is not from %" PRId64 " to %" PRId64,
                     field[f].name, field[f].value, field[f].low, field[f].high);
            return 1;
        }
    return 0;
}
