/* The spans drawn most, into RGB565: a texture as it is, the same with holes, and colours. Everything else: soft_segment_paint. */
#include "soft_sample.h"

#define SPREAD_TWO 0x00401002u  /* two of the last place of each field */
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

static inline int hidden(uint32_t *depth, uint32_t w, enum soft_depth mode)
{
    if (mode == SOFT_DEPTH_TEST ? w < *depth : *depth != 0) return 1;
    return 0;
}

/* The first of the pixels at depth .. end that is not hidden. */
static inline uint32_t *skip_hidden(uint32_t *depth, const uint32_t *end, uint32_t *w, uint32_t dw, enum soft_depth mode)
{
    for (; depth < end && hidden(depth, *w, mode); depth++) *w += dw;
    return depth;
}

/* Takes the pixels up to the next hidden one. */
static inline uint32_t *take_visible(uint32_t *depth, const uint32_t *end, uint32_t *w, uint32_t dw, enum soft_depth mode)
{
    for (; depth < end && !hidden(depth, *w, mode); depth++) {
        *depth = mode == SOFT_DEPTH_TEST ? *w : 1;
        *w += dw;
    }
    return depth;
}

/* Where four pixels lie within a texel every fourth is sampled, the three between are blended of these two. Leaves 1 to 4 pixels. */
static uint16_t *magnified_run(const uint16_t *texels, int32_t stride, uint16_t *pixel, const uint16_t *end, const int32_t from[2],
                               const int32_t step[2])
{
    int32_t s = from[0], t = from[1];
    uint32_t last = soft_sample_565(texels, stride, s, t);
    for (; end - pixel > 4; pixel += 4) {
        uint32_t next = soft_sample_565(texels, stride, s += 4 * step[0], t += 4 * step[1]);
        pixel[0] = soft_pixel_of(last);
        pixel[1] = soft_pixel_of((last * 3 + next + SPREAD_TWO) >> 2 & SOFT_SPREAD);
        pixel[2] = soft_pixel_of((last * 2 + next * 2 + SPREAD_TWO) >> 2 & SOFT_SPREAD);
        pixel[3] = soft_pixel_of((last + next * 3 + SPREAD_TWO) >> 2 & SOFT_SPREAD);
        last = next;
    }
    return pixel;
}

static void texture_run(const soft_texture *texture, uint16_t *pixel, const uint16_t *end, const int32_t from[2], const int32_t step[2])
{
    const uint16_t *texels = soft_texel_zero(texture);
    int32_t stride = texture->stride, s = from[0], t = from[1], ds = step[0], dt = step[1];
    if (end - pixel > 4 && (uint32_t)(ds + MAGNIFIED) <= 2 * MAGNIFIED && (uint32_t)(dt + MAGNIFIED) <= 2 * MAGNIFIED) {
        uint16_t *left = magnified_run(texels, stride, pixel, end, from, step);
        s += ds * (int32_t)(left - pixel);
        t += dt * (int32_t)(left - pixel);
        pixel = left;
    }
    for (; pixel < end; pixel++, s += ds, t += dt) *pixel = soft_pixel_of(soft_sample_565(texels, stride, s, t));
}

/* RGB565: depth of a run first, then its colours. Inlined with `mode` constant. */
static inline void texture_loop(soft_state *state, const soft_segment *segment, enum soft_depth mode)
{
    uint32_t *start = state->depth + segment->first, *depth = start, *end = depth + segment->count, w = segment->w;
    uint16_t *pixels = (uint16_t *)(void *)state->colour + segment->first;
    const int32_t *step = segment->step; /* s and t come first */
    while ((depth = skip_hidden(depth, end, &w, segment->dw, mode)) < end) {
        int32_t from = (int32_t)(depth - start);
        depth = take_visible(depth, end, &w, segment->dw, mode);
        const int32_t first[2] = {segment->value[SOFT_S] + step[0] * from, segment->value[SOFT_T] + step[1] * from};
        texture_run(state->paint.texture, pixels + from, pixels + (depth - start), first, step);
    }
}

static void span_texture(soft_state *state, const soft_segment *segment)
{
    if (!on_texture(state->paint.texture, segment))
        soft_segment_paint(state, segment);
    else if (state->paint.depth == SOFT_DEPTH_TEST)
        texture_loop(state, segment, SOFT_DEPTH_TEST);
    else
        texture_loop(state, segment, SOFT_DEPTH_UNCOVERED);
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
static inline void colour_loop(soft_state *state, const soft_segment *segment, enum soft_depth mode)
{
    const int32_t *value = segment->value, *step = segment->step;
    int32_t red = value[SOFT_R] - (value[SOFT_R] >> 5) + (4 << 16), dr = step[SOFT_R] - (step[SOFT_R] >> 5);
    int32_t green = value[SOFT_G] - (value[SOFT_G] >> 6) + (2 << 16), dg = step[SOFT_G] - (step[SOFT_G] >> 6);
    int32_t blue = value[SOFT_B] - (value[SOFT_B] >> 5) + (4 << 16), db = step[SOFT_B] - (step[SOFT_B] >> 5);
    int32_t count = (int32_t)segment->count;
    if (mode == SOFT_DEPTH_UNCOVERED && count <= 64 && is_even(dr * count) && is_even(dg * count * 2) && is_even(db * count)) {
        red += dr * (count / 2), green += dg * (count / 2), blue += db * (count / 2);
        fill(state, segment, (uint32_t)((red >> 8 & 0xF800) | (green >> 13 & 0x7E0) | (blue >> 19 & 0x1F)));
        return;
    }
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count, w = segment->w, dw = segment->dw;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++, w += dw, red += dr, green += dg, blue += db) {
        if (hidden(depth, w, mode)) continue;
        *depth = mode == SOFT_DEPTH_TEST ? w : 1;
        *pixel = (uint16_t)((red >> 8 & 0xF800) | (green >> 13 & 0x7E0) | (blue >> 19 & 0x1F));
    }
}

static void span_colour(soft_state *state, const soft_segment *segment)
{
    if (state->paint.depth == SOFT_DEPTH_TEST)
        colour_loop(state, segment, SOFT_DEPTH_TEST);
    else
        colour_loop(state, segment, SOFT_DEPTH_UNCOVERED);
}

void soft_choose_span(soft_state *state)
{
    const soft_paint *paint = &state->paint;
    const soft_texture *texture = paint->texture;
    state->span = soft_segment_paint;
    state->texture_rows = 0;
    if (state->wide || paint->depth == SOFT_DEPTH_NONE) return;
    if (!texture) state->span = span_colour;
    if (texture && paint->white && texture->format == C3D_RGB565) {
        state->span = span_texture;
        state->texture_rows = paint->depth == SOFT_DEPTH_TEST && !state->off_texture;
    }
    if (texture && paint->white && paint->alpha_test && texture->format == C3D_RGBA5551) state->span = span_holes;
}
