#include "ff_entry.h"

#include "shape/ff_shape.h"

/* Every tile of an entered terrain has an image where the whole has images. */
static uint32_t deepest(const ff_terrain_info *whole)
{
    uint32_t levels = ff_terrain_levels(whole);

    return whole->texture_log2 && whole->texture_levels < levels ? whole->texture_levels - 1u
                                                                 : levels - 1u;
}

uint32_t ff_entry_level(const ff_terrain_info *whole, int32_t reach_wu)
{
    uint32_t level = 0, most = deepest(whole);

    while (level < most) {
        ff_terrain_info next = ff_entry_terrain(whole, level + 1);
        if (ff_node_edge_wu(&next, 0) < 2 * (int64_t)reach_wu ||
            ff_shape_tiles(&next) > FF_ENTRY_TILES_MAX)
            break;
        level++;
    }
    return level;
}

ff_terrain_info ff_entry_terrain(const ff_terrain_info *whole, uint32_t level)
{
    ff_terrain_info info = *whole;
    ff_sheet samples = ff_shape_sheet_samples(whole);

    FF_ASSERT(level < ff_terrain_levels(whole) && !whole->entered);
    if (level == 0) return info;
    info.entered = (uint8_t)level;
    info.tile_log2 = (uint8_t)(info.tile_log2 - level);
    if (info.texture_log2) info.texture_levels = (uint8_t)(info.texture_levels - level);
    ff_shape_cover(&info, samples.x, samples.y);
    return info;
}

uint64_t ff_entry_nodes(const ff_terrain_info *whole, uint32_t level)
{
    ff_terrain_info info = *whole;
    ff_sheet samples = ff_shape_sheet_samples(whole), nodes;

    FF_ASSERT(level < ff_image_levels(whole) && level < whole->tile_log2);
    info.tile_log2 = (uint8_t)(info.tile_log2 - level);
    ff_shape_cover(&info, samples.x, samples.y);
    nodes = ff_shape_sheet_tiles(&info);
    return (uint64_t)nodes.x * nodes.y;
}

ff_key ff_entry_key(const ff_terrain_info *whole, const ff_terrain_info *entered, ff_key key)
{
    uint32_t level = entered->entered, within = (1u << level) - 1u;
    ff_sheet at = ff_shape_sheet(entered, ff_key_tile(key)),
             tile = { at.x >> level, at.y >> level };

    FF_ASSERT(ff_terrain_has_node(entered, key) || ff_terrain_has_image(entered, key));
    FF_ASSERT(!whole->entered);
    return ff_key_make(ff_shape_sheet_tile(whole, tile), level + ff_key_level(key),
                       ff_morton_encode(at.x & within, at.y & within) << 2 * ff_key_level(key) |
                           ff_key_code(key));
}
