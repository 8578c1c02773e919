/* The spans drawn most, into RGB565: a texture as it is, the same with holes, and colours. Everything else: soft_segment_paint. */
#include "soft_ramp.h"
#include "soft_sample.h"

#define MAGNIFIED 16384         /* texels a pixel, Q16 */

/* Where 2^log2 pixels lie within a texel only the first of them is sampled; those up to the next sample are blended of both, by adding
 * the same difference again and again. Leaves 1 to 2^log2 pixels. */
static inline uint16_t *magnified_run(const uint32_t *texels, int32_t stride, uint16_t *pixel, const uint16_t *end,
                                      const int32_t from[2], const int32_t step[2], int log2)
{
    int32_t s = from[0], t = from[1], ds = step[0] * (1 << log2), dt = step[1] * (1 << log2);
    uint32_t last = soft_sample_565(texels, stride, s, t);
    while (end - pixel > 1 << log2) {
        uint32_t next = soft_sample_565(texels, stride, s += ds, t += dt);
        uint32_t sum = (last << log2) + (SOFT_SPREAD_ONE << log2 >> 1), change = next - last;
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
    const uint32_t *texels = soft_texel_zero(texture);
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
    if (!soft_on_texture(state->paint.texture, segment)) {
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

static void span_colour(soft_state *state, const soft_segment *segment)
{
    soft_ramp ramp;
    soft_make_ramp(&ramp, segment);
    int32_t red = ramp.red, green = ramp.green, blue = ramp.blue;
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count, w = segment->w, dw = segment->dw;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++, w += dw, red += ramp.dr, green += ramp.dg, blue += ramp.db) {
        if (w < *depth) continue;
        *depth = w;
        *pixel = soft_colour_565(red, green, blue);
    }
}

void soft_choose_span(soft_state *state)
{
    const soft_paint *paint = &state->paint;
    const soft_texture *texture = paint->texture;
    state->span = soft_segment_paint;
    state->texture_rows = state->tiny_rows = 0;
    if (state->wide || paint->depth == SOFT_DEPTH_NONE) return;
    int test = paint->depth == SOFT_DEPTH_TEST;
    if (!texture) state->span = test ? span_colour : soft_span_backdrop;
    if (texture && paint->white && texture->format == C3D_RGB565 && test) {
        state->span = span_texture;
        state->texture_rows = !state->off_texture;
        state->tiny_rows = state->texture_rows && texture->width <= SOFT_TINY_TEXELS && texture->height <= SOFT_TINY_TEXELS && !paint->fog;
    }
    if (texture && paint->white && paint->alpha_test && texture->format == C3D_RGBA5551) state->span = soft_span_holes;
}
