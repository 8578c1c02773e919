#include "ff_terrain.h"

#include "codec/ff_codec.h"

static int grid_ok(const ff_terrain_info *info)
{
    uint64_t edge_x, edge_y;

    if (info->tiles_x < 1 || info->tiles_y < 1 ||
        (uint64_t)info->tiles_x * info->tiles_y > FF_KEY_TILES_MAX)
        return 0;
    edge_x = (uint64_t)info->tiles_x << info->tile_log2;
    edge_y = (uint64_t)info->tiles_y << info->tile_log2;
    if (info->samples_x < 2 || info->samples_y < 2 || info->samples_x > edge_x + 1 ||
        info->samples_y > edge_y + 1)
        return 0;
    /* An edge of 43 bits times a spacing of 32 bits would overflow: so the spacing is compared with
     * the quotient. */
    return info->spacing_wu >= 1 && info->spacing_wu <= INT32_MAX / edge_x &&
           info->spacing_wu <= INT32_MAX / edge_y;
}

static int heights_ok(const ff_terrain_info *info)
{
    int64_t top_wu = (int64_t)info->hoffset_wu +
                     (int64_t)((UINT16_MAX * (uint64_t)info->hscale_q24) >> 16);

    return info->hscale_q24 >= 1 && info->hscale_q24 <= INT32_MAX && top_wu <= INT32_MAX &&
           info->height_min <= info->height_max && info->max_error <= INT16_MAX;
}

static int textures_ok(const ff_terrain_info *info)
{
    if (info->texture_log2 == 0) return info->texture_levels == 0;
    return info->texture_log2 >= 4 && info->texture_log2 <= 8 && info->texture_levels >= 1 &&
           info->texture_levels <= FF_KEY_LEVEL_MAX + 1;
}

int ff_terrain_check(const ff_terrain_info *info)
{
    int levels_ok = info->node_log2 >= 1 && info->node_log2 <= FF_NODE_LOG2_MAX &&
                    info->tile_log2 >= info->node_log2 && info->tile_log2 <= 15;
    int flags_ok = (info->flags & ~(FF_TERRAIN_DENSIFIED | FF_TERRAIN_LOSSY)) == 0;

    if (!levels_ok || !flags_ok || !grid_ok(info) || !heights_ok(info) || !textures_ok(info))
        return FF_ERR_RANGE;
    return ff_codec_name(info->codec) ? FF_OK : FF_ERR_UNSUPPORTED;
}

void ff_node_origin_wu(const ff_terrain_info *info, ff_key key, int32_t *x_wu, int32_t *y_wu)
{
    uint32_t tile = ff_key_tile(key), code = ff_key_code(key), level = ff_key_level(key);
    int32_t tile_edge_wu = ff_node_edge_wu(info, 0), edge_wu = ff_node_edge_wu(info, level);

    *x_wu = (int32_t)(tile % info->tiles_x) * tile_edge_wu + (int32_t)ff_morton_x(code) * edge_wu;
    *y_wu = (int32_t)(tile / info->tiles_x) * tile_edge_wu + (int32_t)ff_morton_y(code) * edge_wu;
}

int ff_terrain_has_node(const ff_terrain_info *info, ff_key key)
{
    uint32_t level = ff_key_level(key);

    return ff_key_tile(key) < (uint64_t)info->tiles_x * info->tiles_y &&
           level < ff_terrain_levels(info) && ((uint64_t)ff_key_code(key) >> (2 * level)) == 0;
}
