#include "bake_enlarge.h"

#include <stddef.h>

#define RGB 3

/* A channel of the point of an image that lies at (x, y) from its south-west texel, in parts of
 * 2^depth to a texel. */
static uint8_t channel_at(const uint8_t *rgb, uint32_t side, uint32_t depth, uint64_t x, uint64_t y,
                          unsigned channel)
{
    uint64_t one = UINT64_C(1) << depth, right = x & (one - 1), up = y & (one - 1), sum = 0;
    for (unsigned i = 0; i < 4; i++) {
        uint64_t weight = (i & 1 ? right : one - right) * (i >> 1 ? up : one - up);
        size_t column = (x >> depth) + (i & 1), row = side - 1 - (y >> depth) - (i >> 1);
        if (weight) sum += weight * rgb[(row * side + column) * RGB + channel];
    }
    return (uint8_t)((sum + one * one / 2) >> 2 * depth);
}

void bake_enlarge(const ff_terrain_info *info, const uint8_t *rgb, ff_key image, ff_key node,
                  uint8_t *enlarged)
{
    uint32_t side = 1u << info->texture_log2, depth = ff_key_level(node) - ff_key_level(image),
             within = (1u << depth) - 1;
    uint64_t west = (uint64_t)(ff_morton_x(ff_key_code(node)) & within) * (side - 1),
             south = (uint64_t)(ff_morton_y(ff_key_code(node)) & within) * (side - 1);
    for (uint32_t row = side; row-- > 0;)
        for (uint32_t i = 0; i < side; i++)
            for (unsigned channel = 0; channel < RGB; channel++)
                *enlarged++ = channel_at(rgb, side, depth, west + i, south + row, channel);
}
