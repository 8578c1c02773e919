#include "ff_texture_map.h"
#include "../../protocol/ff_assert.h"

/* s = (u*(T-1) + 1/2) / T for the fraction u of the textured node's edge; u = (place + vertex/2^k)
 * / 2^depth under one above, vertex/2^k * 2^depth - place under one below. */
static void map_axis(const ff_terrain_info *info, uint32_t place, uint32_t depth,
                     int32_t *scale_q16, int32_t *offset_q16)
{
    int64_t span_q16 = (((int64_t)1 << info->texture_log2) - 1) << 16;
    uint32_t shift = info->texture_log2 + depth; /* divides by 2^shift, rounded */
    int64_t half = (int64_t)1 << shift >> 1;
    FF_ASSERT(depth <= FF_KEY_LEVEL_MAX && place < 1u << depth);
    *scale_q16 = (int32_t)(((span_q16 >> info->node_log2) + half) >> shift);
    *offset_q16 = (int32_t)((span_q16 * place + half) >> shift) + ((1 << 15) >> info->texture_log2);
    FF_ASSERT(*scale_q16 >= 0 && *offset_q16 >= 0);
    FF_ASSERT(*offset_q16 + (*scale_q16 << info->node_log2) <= 1 << 16);
}

static void map_axis_below(const ff_terrain_info *info, uint32_t place, uint32_t depth,
                           int32_t *scale_q16, int32_t *offset_q16)
{
    int64_t span_q16 = (((int64_t)1 << info->texture_log2) - 1) << 16;
    FF_ASSERT(depth <= info->node_log2 && place < 1u << depth);
    *scale_q16 = (int32_t)((span_q16 << depth) >> (info->node_log2 + info->texture_log2));
    *offset_q16 = (int32_t)(((1 << 15) >> info->texture_log2) -
                            ((span_q16 * place) >> info->texture_log2));
}

static void map_below(const ff_terrain_info *info, ff_key node, ff_key texture,
                      int32_t scale_q16[2], int32_t offset_q16[2])
{
    uint32_t depth = ff_key_level(texture) - ff_key_level(node), within = (1u << depth) - 1;
    uint32_t x = ff_morton_x(ff_key_code(texture)) & within,
             y = ff_morton_y(ff_key_code(texture)) & within;
    map_axis_below(info, x, depth, &scale_q16[0], &offset_q16[0]);
    map_axis_below(info, y, depth, &scale_q16[1], &offset_q16[1]);
}

void ff_texture_map(const ff_terrain_info *info, ff_key node, ff_key texture, int32_t scale_q16[2],
                    int32_t offset_q16[2])
{
    FF_ASSERT(ff_key_tile(texture) == ff_key_tile(node));
    if (ff_key_level(texture) > ff_key_level(node)) {
        map_below(info, node, texture, scale_q16, offset_q16);
        return;
    }
    uint32_t depth = ff_key_level(node) - ff_key_level(texture);
    uint32_t within = (1u << depth) - 1; /* the bits of the place below the textured node */
    map_axis(info, ff_morton_x(ff_key_code(node)) & within, depth, &scale_q16[0], &offset_q16[0]);
    map_axis(info, ff_morton_y(ff_key_code(node)) & within, depth, &scale_q16[1], &offset_q16[1]);
}

void ff_texture_texels(const ff_terrain_info *info, const uint8_t *rgb, uint16_t *texels)
{
    uint32_t size = 1u << info->texture_log2;
    FF_ASSERT(info->texture_log2 <= 8);
    for (uint32_t row = 0; row < size; row++) {
        const uint8_t *from = rgb + (size_t)3 * size * (size - 1 - row);
        for (uint32_t i = 0; i < size; i++, from += 3)
            *texels++ = (uint16_t)((from[0] >> 3) << 11 | (from[1] >> 2) << 5 | from[2] >> 3);
    }
}
