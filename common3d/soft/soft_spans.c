/* The spans drawn most, into RGB565: a texture as it is, the same with holes, and colours. Everything else: soft_segment_paint. */
#include "soft_sample.h"

#define SPREAD_ONE 0x00200801u  /* the last place of each field */
#define MAGNIFIED 16384         /* texels a pixel, Q16 */
/* The weighted sum of four spread texels, as a pixel. */
static inline uint32_t blend(uint32_t a, uint32_t b, uint32_t c, uint32_t d, uint32_t x, uint32_t y)
{
    uint32_t xy = x * y >> 5;
    uint32_t sum = a * (32 - x - y + xy) + b * (x - xy) + c * (y - xy) + d * xy + SOFT_SPREAD_HALF;
    sum = sum >> 5 & SOFT_SPREAD;
    return (sum | sum >> 16) & 0xFFFF;
}

/* 1 when both ends of the segment lie on the texture and its rim: then all between does. */
static int on_texture(const soft_texture *texture, const soft_segment *segment)
{
    int32_t pixels = (int32_t)segment->count - 1;
    uint32_t s = (uint32_t)segment->value[SOFT_S] + 65536, t = (uint32_t)segment->value[SOFT_T] + 65536;
    uint32_t s_end = s + (uint32_t)(segment->step[SOFT_S] * pixels), t_end = t + (uint32_t)(segment->step[SOFT_T] * pixels);
    uint32_t width = ((uint32_t)texture->width + 1) << 16, height = ((uint32_t)texture->height + 1) << 16;
    return s < width && s_end < width && t < height && t_end < height;
}

/* Where 2^log2 pixels lie within a texel only the first of them is sampled; those up to the next sample are blended of both, by adding
 * the same difference again and again. Leaves 1 to 2^log2 pixels. */
static inline uint16_t *magnified_run(const uint16_t *texels, int32_t stride, uint16_t *pixel, const uint16_t *end,
                                      const int32_t from[2], const int32_t step[2], int log2)
{
    int32_t s = from[0], t = from[1], ds = step[0] * (1 << log2), dt = step[1] * (1 << log2);
    uint32_t last = soft_sample_565(texels, stride, s, t);
    while (end - pixel > 1 << log2) {
        uint32_t next = soft_sample_565(texels, stride, s += ds, t += dt);
        uint32_t sum = (last << log2) + (SPREAD_ONE << log2 >> 1), change = next - last;
        for (int i = 0; i < 1 << log2; i++, sum += change) *pixel++ = soft_pixel_of(sum >> log2 & SOFT_SPREAD);
        last = next;
    }
    return pixel;
}

static int slower_than(const int32_t step[2], int32_t limit)
{
    return (uint32_t)(step[0] + limit) <= 2 * (uint32_t)limit && (uint32_t)(step[1] + limit) <= 2 * (uint32_t)limit;
}

static void texture_run(const soft_texture *texture, uint16_t *pixel, const uint16_t *end, const int32_t from[2], const int32_t step[2])
{
    const uint16_t *texels = soft_texel_zero(texture);
    uint16_t *left = pixel;
    int32_t stride = texture->stride;
    if (end - pixel > 8 && slower_than(step, MAGNIFIED / 2))
        left = magnified_run(texels, stride, pixel, end, from, step, 3);
    else if (end - pixel > 4 && slower_than(step, MAGNIFIED))
        left = magnified_run(texels, stride, pixel, end, from, step, 2);
    int32_t s = from[0] + step[0] * (int32_t)(left - pixel), t = from[1] + step[1] * (int32_t)(left - pixel);
    for (; left < end; left++, s += step[0], t += step[1]) *left = soft_pixel_of(soft_sample_565(texels, stride, s, t));
}

/* RGB565 with the depth test: depth of a run of visible pixels first, then its colours. */
static void span_texture(soft_state *state, const soft_segment *segment)
{
    uint32_t *start = state->depth + segment->first, *depth = start, *end = depth + segment->count, w = segment->w, dw = segment->dw;
    uint16_t *pixels = (uint16_t *)(void *)state->colour + segment->first;
    const int32_t *step = segment->step; /* s and t come first */
    if (!on_texture(state->paint.texture, segment)) {
        soft_segment_paint(state, segment);
        return;
    }
    while (depth < end) {
        for (; depth < end && w < *depth; depth++) w += dw;
        int32_t from = (int32_t)(depth - start);
        for (; depth < end && w >= *depth; w += dw) *depth++ = w;
        const int32_t first[2] = {segment->value[SOFT_S] + step[0] * from, segment->value[SOFT_T] + step[1] * from};
        texture_run(state->paint.texture, pixels + from, pixels + (depth - start), first, step);
    }
}

/* RGBA5551 to the green of RGB565 with its highest bit repeated; the bit of alpha falls away. */
static inline uint32_t spread_5551(uint32_t texel)
{
    uint32_t colour = (texel & 0xFFC0) | (texel >> 5 & 0x20) | (texel >> 1 & 0x1F);
    return soft_spread(colour);
}

/* RGBA5551 with the alpha test, where nothing was drawn: a panorama. Between four clear texels nothing is drawn at all. */
static void span_holes(soft_state *state, const soft_segment *segment)
{
    const soft_texture *texture = state->paint.texture;
    const uint16_t *texels = soft_texel_zero(texture);
    int32_t stride = texture->stride, s = segment->value[SOFT_S], t = segment->value[SOFT_T];
    int32_t ds = segment->step[SOFT_S], dt = segment->step[SOFT_T];
    if (!on_texture(texture, segment) || state->paint.depth != SOFT_DEPTH_UNCOVERED) {
        soft_segment_paint(state, segment);
        return;
    }
    for (uint32_t at = segment->first, end = at + segment->count; at < end; at++, s += ds, t += dt) {
        if (state->depth[at]) continue;
        const uint16_t *texel = texels + (t >> 16) * stride + (s >> 16);
        uint32_t a = texel[0], b = texel[1], c = texel[stride], d = texel[stride + 1];
        if (!((a | b | c | d) & 1)) continue;
        uint32_t x = (uint32_t)s >> 11 & 31, y = (uint32_t)t >> 11 & 31, xy = x * y >> 5;
        uint32_t alpha = (a & 1) * (32 - x - y + xy) + (b & 1) * (x - xy) + (c & 1) * (y - xy) + (d & 1) * xy;
        if (alpha < 16) continue;
        state->depth[at] = 1;
        ((uint16_t *)(void *)state->colour)[at] =
            (uint16_t)blend(spread_5551(a), spread_5551(b), spread_5551(c), spread_5551(d), x, y);
    }
}

/* One colour for all: where it changes by less than half of a step of red. */
static void fill(soft_state *state, const soft_segment *segment, uint32_t colour)
{
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++) {
        if (*depth) continue;
        *depth = 1;
        *pixel = (uint16_t)colour;
    }
}

static int is_even(int32_t change) { return change < 1 << 18 && change > -(1 << 18); }

/* Colours rounded as soft_put does: v * 31/256 + 1/2, and 63/256 for green. */
typedef struct soft_ramp { int32_t red, green, blue, dr, dg, db; } soft_ramp;

static void make_ramp(soft_ramp *ramp, const soft_segment *segment)
{
    const int32_t *value = segment->value, *step = segment->step;
    ramp->red = value[SOFT_R] - (value[SOFT_R] >> 5) + (4 << 16), ramp->dr = step[SOFT_R] - (step[SOFT_R] >> 5);
    ramp->green = value[SOFT_G] - (value[SOFT_G] >> 6) + (2 << 16), ramp->dg = step[SOFT_G] - (step[SOFT_G] >> 6);
    ramp->blue = value[SOFT_B] - (value[SOFT_B] >> 5) + (4 << 16), ramp->db = step[SOFT_B] - (step[SOFT_B] >> 5);
}

static inline uint16_t colour_565(int32_t red, int32_t green, int32_t blue)
{
    return (uint16_t)((red >> 8 & 0xF800) | (green >> 13 & 0x7E0) | (blue >> 19 & 0x1F));
}

static void span_colour(soft_state *state, const soft_segment *segment)
{
    soft_ramp ramp;
    make_ramp(&ramp, segment);
    int32_t red = ramp.red, green = ramp.green, blue = ramp.blue;
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count, w = segment->w, dw = segment->dw;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++, w += dw, red += ramp.dr, green += ramp.dg, blue += ramp.db) {
        if (w < *depth) continue;
        *depth = w;
        *pixel = colour_565(red, green, blue);
    }
}

/* Where nothing was drawn: the sky. Its colours hardly change along a row. */
static void span_backdrop(soft_state *state, const soft_segment *segment)
{
    soft_ramp ramp;
    make_ramp(&ramp, segment);
    int32_t red = ramp.red, green = ramp.green, blue = ramp.blue, count = (int32_t)segment->count;
    if (count <= 64 && is_even(ramp.dr * count) && is_even(ramp.dg * count * 2) && is_even(ramp.db * count)) {
        count /= 2;
        fill(state, segment, colour_565(red + ramp.dr * count, green + ramp.dg * count, blue + ramp.db * count));
        return;
    }
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++, red += ramp.dr, green += ramp.dg, blue += ramp.db) {
        if (*depth) continue;
        *depth = 1;
        *pixel = colour_565(red, green, blue);
    }
}

void soft_choose_span(soft_state *state)
{
    const soft_paint *paint = &state->paint;
    const soft_texture *texture = paint->texture;
    state->span = soft_segment_paint;
    state->texture_rows = 0;
    if (state->wide || paint->depth == SOFT_DEPTH_NONE) return;
    int test = paint->depth == SOFT_DEPTH_TEST;
    if (!texture) state->span = test ? span_colour : span_backdrop;
    if (texture && paint->white && texture->format == C3D_RGB565 && test) {
        state->span = span_texture;
        state->texture_rows = !state->off_texture;
    }
    if (texture && paint->white && paint->alpha_test && texture->format == C3D_RGBA5551) state->span = span_holes;
}
