/* Textures in the block: a heap of units, first fit, and the bilinear sample of any format. */
#include "soft_local.h"

#include <string.h>

static uint32_t texel_bytes(enum c3d_texture_format format) { return format == C3D_RGBA8888 ? 4 : 2; }

static int log2_of(uint32_t power) { return 31 - soft_leading_zeros(power); }

/* First of so many units in a row, heap_units when there are none. */
static uint32_t find_units(const soft_state *state, uint32_t units)
{
    for (uint32_t first = 0, run = 0; first + run < state->heap_units;) {
        if (state->heap_used[first + run]) {
            first += run + 1;
            run = 0;
        } else if (++run == units) {
            return first;
        }
    }
    return state->heap_units;
}

static void copy_row(uint8_t *out, const uint8_t *in, uint32_t width, uint32_t bytes)
{
    memcpy(out, in, bytes);
    memcpy(out + bytes, in, width * bytes);
    memcpy(out + (width + 1) * bytes, in + (width - 1) * bytes, bytes);
}

uint32_t soft_texture_upload(void *opaque, enum c3d_texture_format format, uint32_t width, uint32_t height, const void *pixels)
{
    soft_state *state = opaque;
    uint32_t slot = 0, bytes = texel_bytes(format), row_bytes = (width + 2) * bytes;
    uint32_t units = (row_bytes * (height + 2) + SOFT_HEAP_UNIT - 1) / SOFT_HEAP_UNIT;
    while (slot < state->texture_count && state->textures[slot].units) slot++;
    uint32_t first = slot < state->texture_count ? find_units(state, units) : state->heap_units;
    if (first == state->heap_units) return 0;
    soft_texture *texture = &state->textures[slot];
    *texture = (soft_texture){.texels = state->heap + (size_t)first * SOFT_HEAP_UNIT, .first_unit = first, .units = units,
                              .width = (uint16_t)width, .height = (uint16_t)height, .stride = (uint16_t)(width + 2),
                              .format = (uint8_t)format, .width_log2 = (uint8_t)log2_of(width),
                              .height_log2 = (uint8_t)log2_of(height)};
    memset(state->heap_used + first, 1, units);
    for (uint32_t row = 0; row < height + 2; row++) {
        uint32_t from = row == 0 ? 0 : row > height ? height - 1 : row - 1;
        copy_row(texture->texels + row * row_bytes, (const uint8_t *)pixels + (size_t)from * width * bytes, width, bytes);
    }
    return slot + 1;
}

void soft_texture_free(void *opaque, uint32_t name)
{
    soft_state *state = opaque;
    soft_texture *texture = &state->textures[name - 1];
    memset(state->heap_used + texture->first_unit, 0, texture->units);
    texture->units = 0;
}

/* Adds a texel times a weight of at most 2^16. */
static void add_texel(const soft_texture *texture, int32_t column, int32_t row, int32_t weight, int32_t sum[4])
{
    size_t at = (size_t)(row + 1) * texture->stride + (size_t)(column + 1);
    int32_t channel[4];
    if (texture->format == C3D_RGBA8888) {
        for (int i = 0; i < 4; i++) channel[i] = texture->texels[at * 4 + (size_t)i];
    } else {
        uint32_t texel = ((const uint16_t *)(const void *)texture->texels)[at];
        int green_bits = texture->format == C3D_RGB565 ? 6 : 5;
        int32_t red = (int32_t)(texel >> 11), green = (int32_t)(texel >> (11 - green_bits)) & ((1 << green_bits) - 1);
        int32_t blue = (int32_t)(texture->format == C3D_RGB565 ? texel : texel >> 1) & 31;
        channel[0] = red << 3 | red >> 2;
        channel[1] = green_bits == 6 ? green << 2 | green >> 4 : green << 3 | green >> 2;
        channel[2] = blue << 3 | blue >> 2;
        channel[3] = texture->format == C3D_RGB565 || (texel & 1) ? 255 : 0;
    }
    for (int i = 0; i < 4; i++) sum[i] += channel[i] * weight;
}

static int32_t clamp_coordinate(int32_t at, int32_t size)
{
    int32_t low = -65536, high = (size << 16) - 1;
    return at < low ? low : at > high ? high : at;
}

void soft_sample(const soft_texture *texture, int32_t s, int32_t t, int32_t rgba[4])
{
    int32_t sum[4] = {32768, 32768, 32768, 32768};
    s = clamp_coordinate(s, texture->width);
    t = clamp_coordinate(t, texture->height);
    int32_t column = s >> 16, row = t >> 16, x = (s >> 8) & 255, y = (t >> 8) & 255;
    add_texel(texture, column, row, (256 - x) * (256 - y), sum);
    add_texel(texture, column + (x != 0), row, x * (256 - y), sum);
    add_texel(texture, column, row + (y != 0), (256 - x) * y, sum);
    add_texel(texture, column + (x != 0), row + (y != 0), x * y, sum);
    for (int i = 0; i < 4; i++) rgba[i] = sum[i] >> 16;
}
