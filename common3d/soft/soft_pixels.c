/* Pixels one by one: any paint into any format. What is drawn most has faster ways (soft_spans.c,
 * soft_tiny.c, soft_sample.h). */
#include "soft_sample.h"

/* 255 * 31/256 and 255 * 63/256 round to all ones, and no more */
FF_STATIC_ASSERT((255 * 31 + 128) >> 8 == 31 && (255 * 63 + 128) >> 8 == 63);
static int32_t to_byte(int32_t value_q16)
{
    int32_t value = (value_q16 + 32768) >> 16;
    return value < 0 ? 0 : value > 255 ? 255 : value;
}

/* Rounds to the format: 0..255 to 0..31 and 0..63. */
void soft_put(soft_state *state, uint32_t at, int32_t red, int32_t green, int32_t blue)
{
    if (state->wide) {
        uint8_t *pixel = state->colour + (size_t)at * 4;
        pixel[0] = (uint8_t)red;
        pixel[1] = (uint8_t)green;
        pixel[2] = (uint8_t)blue;
        pixel[3] = 255;
    } else {
        ((uint16_t *)(void *)state->colour)[at] = (uint16_t)(((red * 31 + 128) >> 8) << 11 |
                                                             ((green * 63 + 128) >> 8) << 5 |
                                                             ((blue * 31 + 128) >> 8));
    }
}

void soft_get(const soft_state *state, uint32_t at, uint8_t rgb[3])
{
    if (state->wide) {
        for (int i = 0; i < 3; i++) rgb[i] = state->colour[(size_t)at * 4 + (size_t)i];
    } else {
        uint32_t pixel = ((const uint16_t *)(const void *)state->colour)[at];
        uint32_t red = pixel >> 11, green = pixel >> 5 & 63, blue = pixel & 31;
        rgb[0] = (uint8_t)(red << 3 | red >> 2);
        rgb[1] = (uint8_t)(green << 2 | green >> 4);
        rgb[2] = (uint8_t)(blue << 3 | blue >> 2);
    }
}

/* 1 when the paint's depth test lets the pixel be drawn. */
static int take_pixel(const soft_state *state, uint32_t at, uint32_t w)
{
    switch (state->paint.depth) {
        case SOFT_DEPTH_TEST: return w >= state->depth[at];
        case SOFT_DEPTH_UNCOVERED: return state->depth[at] == 0;
        default: return 1;
    }
}

static void mark_pixel(soft_state *state, uint32_t at, uint32_t w)
{
    if (state->paint.depth == SOFT_DEPTH_TEST) {
        if (w > state->depth[at]) state->depth[at] = w;
    } else if (state->paint.depth == SOFT_DEPTH_UNCOVERED && !state->paint.unmarked) {
        state->depth[at] = 1;
    }
}

/* The pixel's colour before fog; 0 when the alpha test leaves it out. */
static int shade(const soft_paint *paint, const int32_t value[SOFT_ATTRIBUTES], int32_t rgb[3])
{
    for (int i = 0; i < 3; i++) rgb[i] = to_byte(value[SOFT_R + i]);
    if (!paint->texture) return 1;
    int32_t texel[4];
    soft_sample(paint->texture, value[SOFT_S], value[SOFT_T], texel);
    if (texel[3] < 128 && (paint->alpha_test || paint->thrown)) return !paint->alpha_test;
    if (paint->thrown) {
        for (int i = 0; i < 3; i++) rgb[i] = texel[i];
        return 1;
    }
    for (int i = 0; i < 3; i++)
        rgb[i] = paint->white ? texel[i] : (texel[i] * rgb[i] * 257 + 32768) >> 16;
    return 1;
}

/* Lets what is drawn at a pixel show through. */
static void let_through(const soft_state *state, uint32_t at, int32_t rgb[3])
{
    int32_t through = state->paint.through;
    uint8_t below[3];
    soft_get(state, at, below);
    for (int i = 0; i < 3; i++) rgb[i] = (below[i] * through + rgb[i] * (256 - through) + 128) >> 8;
}

void soft_segment_paint(soft_state *state, const soft_segment *segment)
{
    C3D_ASSERT(soft_in_frame(state, segment->first, segment->count));
    const soft_paint *paint = &state->paint;
    int32_t value[SOFT_ATTRIBUTES], rgb[3];
    uint32_t w = segment->w, fog_colour = state->frame.fog_colour, bias = 0;
    int shift = segment->w_shift;
    if (paint->thrown && paint->alpha_test)
        bias = soft_thrown_bias(w >> shift, (int32_t)segment->dw >> shift);
    for (int i = 0; i < SOFT_ATTRIBUTES; i++) value[i] = segment->value[i];
    for (uint32_t at = segment->first, end = at + segment->count; at < end;
         at++, w += segment->dw) {
        if (take_pixel(state, at, (w >> shift) + bias) && shade(paint, value, rgb)) {
            int32_t clear = value[SOFT_F] >> 8; /* Q16: 65536 is clear */
            clear = clear < 0 ? 0 : clear > 65536 ? 65536 : clear;
            for (int i = 0; paint->fog && i < 3; i++) {
                int32_t fog = (int32_t)(fog_colour >> (8 * i) & 255);
                rgb[i] = fog + (((rgb[i] - fog) * clear + 32768) >> 16);
            }
            if (paint->through) let_through(state, at, rgb);
            mark_pixel(state, at, w >> shift);
            soft_put(state, at, rgb[0], rgb[1], rgb[2]);
        }
        for (int i = 0; i < SOFT_ATTRIBUTES; i++)
            value[i] = (int32_t)((uint32_t)value[i] + (uint32_t)segment->step[i]);
    }
}

/* RGBA5551 to RGB565, spread: green's highest bit is repeated as its lowest, alpha falls away. */
static inline uint32_t spread_5551(uint32_t texel)
{
    uint32_t colour = (texel & 0xFFC0) | (texel >> 5 & 0x20) | (texel >> 1 & 0x1F);
    return soft_spread(colour);
}

uint32_t soft_blend_5551(const uint16_t *texel, uint32_t stride, uint32_t x, uint32_t y)
{
    uint32_t a = texel[0], b = texel[1], c = texel[stride], d = texel[stride + 1];
    uint32_t xy = x * y >> 5, right = x - xy, below = y - xy, upper = 32 - x - below;
    if ((a & 1) * upper + (b & 1) * right + (c & 1) * below + (d & 1) * xy < 16) return SOFT_CLEAR;
    uint32_t sum = spread_5551(a) * upper + spread_5551(b) * right + spread_5551(c) * below +
                   spread_5551(d) * xy + 16 * SOFT_SPREAD_ONE;
    return soft_pixel_of(sum >> 5 & SOFT_SPREAD);
}
