/* Colours that change linearly along a row, into RGB565. */
#ifndef SOFT_RAMP_H
#define SOFT_RAMP_H

#include "soft_local.h"

/* Colours rounded as soft_put does: v * 31/256 + 1/2, and 63/256 for green. */
typedef struct soft_ramp {
    int32_t red, green, blue, dr, dg, db;
} soft_ramp;

static inline void soft_make_ramp(soft_ramp *ramp, const soft_segment *segment)
{
    const int32_t *value = segment->value, *step = segment->step;
    ramp->red = value[SOFT_R] - (value[SOFT_R] >> 5) + (4 << 16),
    ramp->dr = step[SOFT_R] - (step[SOFT_R] >> 5);
    ramp->green = value[SOFT_G] - (value[SOFT_G] >> 6) + (2 << 16),
    ramp->dg = step[SOFT_G] - (step[SOFT_G] >> 6);
    ramp->blue = value[SOFT_B] - (value[SOFT_B] >> 5) + (4 << 16),
    ramp->db = step[SOFT_B] - (step[SOFT_B] >> 5);
}

static inline uint16_t soft_colour_565(int32_t red, int32_t green, int32_t blue)
{
    return (uint16_t)((red >> 8 & 0xF800) | (green >> 13 & 0x7E0) | (blue >> 19 & 0x1F));
}

/* A vertex's colours as soft_make_ramp has them: below 2^24. */
static inline void soft_take_colours(int32_t out[3], const uint8_t rgba[4])
{
    out[0] = rgba[0] * 63488 + (4 << 16);
    out[1] = rgba[1] * 64512 + (2 << 16);
    out[2] = rgba[2] * 63488 + (4 << 16);
}
FF_STATIC_ASSERT(255 * 63488 + (4 << 16) < 1 << 24 && 255 * 64512 + (2 << 16) < 1 << 24);

#endif
