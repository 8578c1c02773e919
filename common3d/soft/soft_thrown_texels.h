/* Texels of a thrown picture, RGBA5551, blended into RGB565. */
#ifndef SOFT_THROWN_TEXELS_H
#define SOFT_THROWN_TEXELS_H

#include "soft_sample.h"

/* A texel's fields spread over 32 bits: ggggg000000rrrrr00000bbbbb0, five bits of room or more
 * above each: so four texels are blended with weights that add up to 32. Alpha falls away. */
#define SOFT_THROWN_SPREAD 0x07C0F83Eu
#define SOFT_THROWN_HALF   (16u << 1 | 16u << 11 | 8u << 22) /* green is rounded to 6 bits */

static inline uint32_t soft_thrown_spread(uint32_t texel)
{
    return (texel | texel << 16) & SOFT_THROWN_SPREAD;
}

/* Blends four texels, `texel` being the upper left one, x and y in 1/32 texel: RGB565. All of them
 * count in full, opaque or not. */
static inline uint16_t soft_thrown_blend(const uint16_t *texel, uint32_t stride, uint32_t x,
                                         uint32_t y)
{
    uint32_t xy = x * y >> 5, right = x - xy, below = y - xy;
    uint32_t sum = soft_thrown_spread(texel[0]) * (32 - right - y) +
                   soft_thrown_spread(texel[1]) * right;
    texel += stride;
    sum += soft_thrown_spread(texel[0]) * below + soft_thrown_spread(texel[1]) * xy +
           SOFT_THROWN_HALF;
    uint32_t green = sum >> 26;
    return (uint16_t)((sum >> 5 & 0xF800) | (green + (green >> 5)) << 5 | (sum >> 6 & 0x1F));
}

/* 1 when the texels round a place are opaque by more than half. */
static inline int soft_thrown_opaque(const uint16_t *texel, uint32_t stride, uint32_t x, uint32_t y)
{
    uint32_t a = texel[0], b = texel[1], c = texel[stride], d = texel[stride + 1];
    if (a & b & c & d & 1) return 1;
    if (!((a | b | c | d) & 1)) return 0;
    uint32_t xy = x * y >> 5, right = x - xy, below = y - xy;
    return (a & 1) * (32 - right - y) + (b & 1) * right + (c & 1) * below + (d & 1) * xy >= 16;
}

/* Lets the 32ths of a pixel that is there show through. */
static inline uint16_t soft_thrown_through(uint16_t below, uint16_t pixel, uint32_t of_32)
{
    return soft_pixel_of(
        (soft_spread(below) * of_32 + soft_spread(pixel) * (32 - of_32) + 16 * SOFT_SPREAD_ONE) >>
            5 &
        SOFT_SPREAD);
}
static inline uint32_t soft_thrown_of_32(const soft_paint *paint)
{
    return (paint->through + 4u) >> 3;
}

#endif
