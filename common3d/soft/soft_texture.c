/* Textures in the block: a heap of units, first fit, and the bilinear sample of any format. */
#include "soft_sample.h"

#include <string.h>

static uint32_t texel_bytes(enum c3d_texture_format format)
{
    return format == C3D_RGBA8888 ? 4 : 2;
}

/* Bytes of a texel in the block: RGB565 is kept spread over 32 bits. */
static uint32_t kept_bytes(enum c3d_texture_format format)
{
    return format == C3D_RGBA5551 ? 2 : 4;
}

/* The first of `units` free units in a row; heap_units when there is no such run. */
static uint32_t find_units(const soft_state *state, uint32_t units)
{
    C3D_ASSERT(units > 0);
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

/* Copies a row of texels, with a texel of rim on either side. */
static void copy_row(uint8_t *out, const uint8_t *in, uint32_t width,
                     enum c3d_texture_format format)
{
    C3D_ASSERT(width >= 1 && width <= 4096);
    uint32_t bytes = kept_bytes(format);
    if (format == C3D_RGB565)
        for (uint32_t x = 0; x < width; x++)
            ((uint32_t *)(void *)out)[x + 1] = soft_kept(((const uint16_t *)(const void *)in)[x]);
    else
        memcpy(out + bytes, in, width * bytes);
    memcpy(out, out + bytes, bytes);
    memcpy(out + (width + 1) * bytes, out + width * bytes, bytes);
}

uint32_t soft_texture_upload(void *opaque, enum c3d_texture_format format, uint32_t width,
                             uint32_t height, const void *pixels)
{
    soft_state *state = opaque;
    uint32_t slot = 0, in_bytes = texel_bytes(format), row_bytes = (width + 2) * kept_bytes(format);
    uint32_t units = (row_bytes * (height + 2) + SOFT_HEAP_UNIT - 1) / SOFT_HEAP_UNIT;
    while (slot < state->texture_count && state->textures[slot].units) slot++;
    uint32_t first = slot < state->texture_count ? find_units(state, units) : state->heap_units;
    if (first == state->heap_units) return 0;
    C3D_ASSERT(first + units <= state->heap_units);
    C3D_ASSERT((row_bytes * (height + 2) - 1) / SOFT_HEAP_UNIT == units - 1);
    soft_texture *texture = &state->textures[slot];
    *texture = (soft_texture){ .texels = state->heap + (size_t)first * SOFT_HEAP_UNIT,
                               .first_unit = first,
                               .units = units,
                               .width = (uint16_t)width,
                               .height = (uint16_t)height,
                               .stride = (uint16_t)(width + 2),
                               .format = (uint8_t)format,
                               .width_log2 = (uint8_t)soft_log2(width),
                               .height_log2 = (uint8_t)soft_log2(height) };
    C3D_ASSERT(1u << texture->width_log2 == width && 1u << texture->height_log2 == height);
    memset(state->heap_used + first, 1, units);
    for (uint32_t row = 0; row < height + 2; row++) {
        uint32_t from = row == 0 ? 0 : row > height ? height - 1 : row - 1;
        copy_row(texture->texels + row * row_bytes,
                 (const uint8_t *)pixels + (size_t)from * width * in_bytes, width, format);
    }
    return slot + 1;
}

void soft_texture_free(void *opaque, uint32_t name)
{
    C3D_ASSERT(name >= 1 && name <= ((soft_state *)opaque)->texture_count);
    soft_state *state = opaque;
    soft_texture *texture = &state->textures[name - 1];
    C3D_ASSERT(texture->units > 0 && texture->first_unit + texture->units <= state->heap_units);
    memset(state->heap_used + texture->first_unit, 0, texture->units);
    texture->units = 0;
}

static int32_t widened(uint32_t value, int bits)
{
    return (int32_t)(value << (8 - bits) | value >> (2 * bits - 8));
}

/* Adds a texel times a weight of at most 2^16. */
static void add_texel(const soft_texture *texture, int32_t column, int32_t row, int32_t weight,
                      int32_t sum[4])
{
    size_t at = (size_t)(row + 1) * texture->stride + (size_t)(column + 1);
    int32_t channel[4];
    if (texture->format == C3D_RGBA8888) {
        for (int i = 0; i < 4; i++) channel[i] = texture->texels[at * 4 + (size_t)i];
    } else if (texture->format == C3D_RGB565) {
        uint32_t texel = soft_pixel_of(((const uint32_t *)(const void *)texture->texels)[at] >> 1 &
                                       SOFT_SPREAD);
        channel[0] = widened(texel >> 11, 5), channel[1] = widened(texel >> 5 & 63, 6),
        channel[2] = widened(texel & 31, 5);
        channel[3] = 255;
    } else {
        uint32_t texel = ((const uint16_t *)(const void *)texture->texels)[at];
        for (int i = 0; i < 3; i++) channel[i] = widened(texel >> (11 - 5 * i) & 31, 5);
        channel[3] = texel & 1 ? 255 : 0;
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
    int32_t sum[4] = { 32768, 32768, 32768, 32768 };
    s = clamp_coordinate(s, texture->width);
    t = clamp_coordinate(t, texture->height);
    int32_t column = s >> 16, row = t >> 16, x = (s >> 8) & 255, y = (t >> 8) & 255;
    add_texel(texture, column, row, (256 - x) * (256 - y), sum);
    add_texel(texture, column + (x != 0), row, x * (256 - y), sum);
    add_texel(texture, column, row + (y != 0), (256 - x) * y, sum);
    add_texel(texture, column + (x != 0), row + (y != 0), x * y, sum);
    for (int i = 0; i < 4; i++) rgba[i] = sum[i] >> 16;
}
