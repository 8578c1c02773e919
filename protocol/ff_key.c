#include "ff_key.h"

/* 16 bits to every second bit of 32, halving the gap each time. */
static uint32_t spread(uint32_t v)
{
    v &= 0xffffu;
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & FF_KEY_X_BITS;
}

static uint32_t gather(uint32_t v)
{
    v &= FF_KEY_X_BITS;
    v = (v | (v >> 1)) & 0x33333333u;
    v = (v | (v >> 2)) & 0x0f0f0f0fu;
    v = (v | (v >> 4)) & 0x00ff00ffu;
    return (v | (v >> 8)) & 0xffffu;
}

uint32_t ff_morton_encode(uint32_t x, uint32_t y)
{
    FF_ASSERT(x <= UINT16_MAX && y <= UINT16_MAX);
    return spread(x) | (spread(y) << 1);
}

uint32_t ff_morton_x(uint32_t code) { return gather(code); }
uint32_t ff_morton_y(uint32_t code) { return gather(code >> 1); }
