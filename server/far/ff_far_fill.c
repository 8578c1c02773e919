/* Pictures of half the size, and so on: what has no colour takes that of the smaller picture. */
#include "ff_far_fill.h"

static uint32_t half(uint32_t side) { return (side + 1) / 2; }

size_t ff_far_fill_texels(uint32_t width, uint32_t height)
{
    size_t texels = (size_t)width * height;
    while (width > 1 || height > 1) {
        width = half(width);
        height = half(height);
        texels += (size_t)width * height;
    }
    return texels;
}

/* The mean of four texels, or of fewer at the edge, by their weights. */
static ff_far_texel mean(const ff_far_texel *texel, uint32_t width, uint32_t height, uint32_t x,
                         uint32_t y)
{
    uint32_t sum[3] = { 0, 0, 0 }, weight = 0;
    ff_far_texel out = { { 0, 0, 0 }, 0 };
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t at_x = x + (i & 1u), at_y = y + (i >> 1);
        if (at_x >= width || at_y >= height) continue;
        const ff_far_texel *from = &texel[(size_t)at_y * width + at_x];
        for (int c = 0; c < 3; c++) sum[c] += (uint32_t)from->rgb_q8[c] * from->weight;
        weight += from->weight;
    }
    for (int c = 0; c < 3 && weight; c++) out.rgb_q8[c] = (uint16_t)(sum[c] / weight);
    out.weight = (uint16_t)(weight > 256 ? 256 : weight);
    return out;
}

static void shrink(const ff_far_texel *texel, uint32_t width, uint32_t height, ff_far_texel *out)
{
    for (uint32_t y = 0; y < height; y += 2)
        for (uint32_t x = 0; x < width; x += 2) *out++ = mean(texel, width, height, x, y);
}

static uint32_t within(int64_t at, uint32_t side)
{
    return at < 0 ? 0 : at >= (int64_t)side ? side - 1 : (uint32_t)at;
}

/* A texel from the picture of half the size, bilinear: it lies a quarter of a texel off. */
static void grow(ff_far_texel *texel, uint32_t x, uint32_t y, const ff_far_texel *small,
                 uint32_t width, uint32_t height)
{
    uint32_t near_x = x / 2, near_y = y / 2,
             far_x = within((int64_t)near_x + (x & 1u ? 1 : -1), width),
             far_y = within((int64_t)near_y + (y & 1u ? 1 : -1), height);
    const ff_far_texel *a = &small[(size_t)near_y * width + near_x],
                       *b = &small[(size_t)near_y * width + far_x],
                       *c = &small[(size_t)far_y * width + near_x],
                       *d = &small[(size_t)far_y * width + far_x];
    for (int i = 0; i < 3; i++)
        texel->rgb_q8[i] = (uint16_t)((9u * a->rgb_q8[i] + 3u * b->rgb_q8[i] + 3u * c->rgb_q8[i] +
                                       d->rgb_q8[i] + 8u) /
                                      16u);
}

void ff_far_fill(ff_far_texel *texel, uint32_t width, uint32_t height)
{
    if (width <= 1 && height <= 1) return;
    uint32_t small_width = half(width), small_height = half(height);
    ff_far_texel *small = texel + (size_t)width * height;
    shrink(texel, width, height, small);
    ff_far_fill(small, small_width, small_height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            ff_far_texel *at = &texel[(size_t)y * width + x];
            if (at->weight == 0) grow(at, x, y, small, small_width, small_height);
        }
}
