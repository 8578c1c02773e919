/* Bilinear samples of RGB565 textures. A texel's fields are spread over 32 bits:
 * 00000gggggg00000rrrrr000000bbbbb. They are kept twice as large and with a half,
 * 0000ggggggG0000rrrrrR00000bbbbbB, each with four bits of room above it. So four texels are
 * blended with weights that add up to 16 by four multiplications for all three colours: no sum
 * reaches the next field, and the half rounds it. */
#ifndef SOFT_SAMPLE_H
#define SOFT_SAMPLE_H

#include "soft_local.h"

#define SOFT_SPREAD         0x07E0F81Fu
#define SOFT_SPREAD_ONE     0x00200801u /* the last place of each field */
#define SOFT_MAGNIFIED_LOG2 3           /* at most 8 pixels between samples */

/* of the two bytes between a texel's fields, kept twice as large, four bits are free above each */
FF_STATIC_ASSERT((SOFT_SPREAD & SOFT_SPREAD_ONE) == SOFT_SPREAD_ONE);
FF_STATIC_ASSERT((16 * (uint64_t)(2 * SOFT_SPREAD + SOFT_SPREAD_ONE)) >> 32 == 0);

static inline uint32_t soft_spread(uint32_t texel) { return (texel | texel << 16) & SOFT_SPREAD; }

static inline uint32_t soft_kept(uint32_t texel)
{
    return 2 * soft_spread(texel) + SOFT_SPREAD_ONE;
}

/* Texel (0, 0) of a texture in RGB565. */
static inline const uint32_t *soft_texel_zero(const soft_texture *texture)
{
    return (const uint32_t *)(const void *)texture->texels + texture->stride + 1;
}

/* Blends four texels, `at` being the upper left one; x, y and xy = x * y in 1/16 texel, xy no
 * greater than x and y. The fields of the sum are 32 times the colour's, and a half. */
static inline uint32_t soft_blend_sum(const uint32_t *at, uint32_t stride, uint32_t x, uint32_t y,
                                      uint32_t xy)
{
    uint32_t right = x - xy, below = y - xy;
    uint32_t sum = at[0] * (16 - right - y);
    sum += at[1] * right;
    at += stride;
    sum += at[0] * below;
    return sum + at[1] * xy;
}

/* The sum for a place; `texels` is the texel at which s and t are 0. */
static inline uint32_t soft_sample_sum(const uint32_t *texels, uint32_t stride, int32_t s,
                                       int32_t t)
{
    uint32_t x = (uint16_t)s, y = (uint16_t)t;
    return soft_blend_sum(texels + (t >> 16) * (int32_t)stride + (s >> 16), stride, x >> 12,
                          y >> 12, x * y >> 28);
}

static inline uint16_t soft_pixel_of(uint32_t spread_pixel)
{
    return (uint16_t)(spread_pixel | spread_pixel >> 16);
}

/* Draws a segment of a texture as it is, into RGB565 with the depth test; an inner loop. All pixels
 * lie on the texture and its rim. */
static inline void soft_sample_row(const soft_state *state, const soft_segment *segment)
{
    C3D_ASSERT(soft_in_frame(state, segment->first, segment->count));
    C3D_ASSERT(!state->wide && state->paint.texture->format == C3D_RGB565);
    const soft_texture *texture = state->paint.texture;
    const uint32_t *texels = soft_texel_zero(texture);
    uint32_t stride = texture->stride;
    int32_t s = segment->value[SOFT_S], t = segment->value[SOFT_T], ds = segment->step[SOFT_S],
            dt = segment->step[SOFT_T];
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count, w = segment->w,
             dw = segment->dw;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++, w += dw, s += ds, t += dt) {
        if (w < *depth) continue;
        *depth = w;
        *pixel = soft_pixel_of(soft_sample_sum(texels, stride, s, t) >> 5 & SOFT_SPREAD);
    }
}

/* 1 when both ends of a straight line lie on the texture and its rim: then the whole line does. */
static inline int soft_between_on_texture(const soft_texture *texture, int32_t s, int32_t t,
                                          int32_t s_end, int32_t t_end)
{
    uint32_t width = ((uint32_t)texture->width + 1) << 16, height = ((uint32_t)texture->height + 1)
                                                                    << 16;
    return (uint32_t)s + 65536 < width && (uint32_t)s_end + 65536 < width &&
           (uint32_t)t + 65536 < height && (uint32_t)t_end + 65536 < height;
}

static inline int soft_on_texture(const soft_texture *texture, const soft_segment *segment)
{
    int32_t pixels = (int32_t)segment->count - 1, s = segment->value[SOFT_S],
            t = segment->value[SOFT_T];
    return soft_between_on_texture(texture, s, t, s + segment->step[SOFT_S] * pixels,
                                   t + segment->step[SOFT_T] * pixels);
}

/* log2 of the pixels from one sample to the next: as many as a texel is wide, at most 8; 0 (each
 * pixel is sampled) where a texel is less than 4 pixels wide. */
static inline int soft_sample_spacing(int32_t ds, int32_t dt)
{
    uint32_t most = (uint32_t)((ds ^ ds >> 31) | (dt ^ dt >> 31) | 1);
    int log2 = soft_leading_zeros(most) - 16;
    C3D_ASSERT(log2 >= -16 && log2 <= 15);
    return log2 > SOFT_MAGNIFIED_LOG2 ? SOFT_MAGNIFIED_LOG2 : log2 < 2 ? 0 : log2;
}

#endif
