#include "ff_terrain.h"

#include "codec/ff_codec.h"
#include "shape/ff_shape.h"

static int heights_ok(const ff_terrain_info *info)
{
    int64_t top_wu = (int64_t)info->hoffset_wu +
                     (int64_t)((UINT16_MAX * (uint64_t)info->hscale_q24) >> 16);

    return info->hscale_q24 >= 1 && info->hscale_q24 <= INT32_MAX && top_wu <= INT32_MAX &&
           info->height_min <= info->height_max && info->max_error <= INT16_MAX &&
           info->curve_q60 <= FF_CURVE_MAX;
}

static int textures_ok(const ff_terrain_info *info)
{
    if (info->texture_log2 == 0)
        return info->texture_levels == 0 && !(info->flags & FF_TERRAIN_PICTURES);
    return info->texture_log2 >= 4 && info->texture_log2 <= 8 && info->texture_levels >= 1 &&
           info->texture_levels <= FF_KEY_LEVEL_MAX + 1;
}

int ff_terrain_check(const ff_terrain_info *info)
{
    int levels_ok = info->node_log2 >= 1 && info->node_log2 <= FF_NODE_LOG2_MAX &&
                    info->tile_log2 >= info->node_log2 &&
                    info->tile_log2 <= info->node_log2 + FF_KEY_LEVEL_MAX;
    int flags_ok = (info->flags & ~FF_TERRAIN_FLAGS) == 0;

    if (!levels_ok || !flags_ok || !ff_shape_check(info) || !heights_ok(info) || !textures_ok(info))
        return FF_ERR_RANGE;
    return ff_codec_name(info->codec) ? FF_OK : FF_ERR_UNSUPPORTED;
}

int ff_terrain_same(const ff_terrain_info *a, const ff_terrain_info *b)
{
    return a->checksum == b->checksum && a->node_log2 == b->node_log2 &&
           a->tile_log2 == b->tile_log2 && a->codec == b->codec && a->tiles_x == b->tiles_x &&
           a->tiles_y == b->tiles_y && a->spacing_wu == b->spacing_wu &&
           a->hscale_q24 == b->hscale_q24 && a->hoffset_wu == b->hoffset_wu &&
           a->curve_q60 == b->curve_q60 && a->texture_log2 == b->texture_log2 &&
           a->texture_levels == b->texture_levels && a->entered == b->entered &&
           !((a->flags ^ b->flags) & FF_TERRAIN_PICTURES);
}

/* Millimetres as world units, to the nearest. */
static int64_t wu_of_mm(int64_t mm)
{
    int64_t doubled = mm * 2 * FF_WU_PER_METRE + 1000;

    return doubled >= 0 ? doubled / 2000 : -((1999 - doubled) / 2000);
}

int ff_terrain_join(ff_terrain_info *info, const ff_terrain_info *first,
                    const ff_terrain_info *last)
{
    const int64_t far_mm = INT64_C(8000000000); /* so that its own places fit as well */
    int64_t east_mm = info->origin_x_mm / 2 - first->origin_x_mm / 2,
            north_mm = info->origin_y_mm / 2 - first->origin_y_mm / 2;
    uint64_t tiles = (uint64_t)last->first_tile + ff_shape_tiles(last);

    if (!first->epsg || info->epsg != first->epsg || info->node_log2 != first->node_log2)
        return FF_ERR_UNSUPPORTED;
    if (east_mm < -far_mm / 2 || east_mm > far_mm / 2 || north_mm < -far_mm / 2 ||
        north_mm > far_mm / 2 || tiles + ff_shape_tiles(info) > FF_KEY_TILES_MAX)
        return FF_ERR_RANGE;
    info->first_tile = (uint32_t)tiles;
    info->west_wu = (int32_t)wu_of_mm(info->origin_x_mm - first->origin_x_mm);
    info->south_wu = (int32_t)wu_of_mm(info->origin_y_mm - first->origin_y_mm);
    return ff_terrain_check(info);
}

static int has_key(const ff_terrain_info *info, ff_key key, uint32_t levels)
{
    uint32_t level = ff_key_level(key);

    return ff_key_tile(key) - info->first_tile < ff_shape_tiles(info) && level < levels &&
           ((uint64_t)ff_key_code(key) >> (2 * level)) == 0;
}

int ff_terrain_has_node(const ff_terrain_info *info, ff_key key)
{
    return has_key(info, key, ff_terrain_levels(info));
}

int ff_terrain_has_image(const ff_terrain_info *info, ff_key key)
{
    return has_key(info, key, info->texture_levels);
}
