/* The spans drawn most, into RGB565: a texture as it is, the same with holes, and colours. Everything else: soft_segment_paint. */
#include "soft_ramp.h"
#include "soft_sample.h"

/* A sample of a texture magnified: it keeps 5 - log2 bits below its last place, which with 2^log2 steps fill the room above each field,
 * and the half that rounds the sum of both. */
static inline uint32_t magnified_sample(const uint32_t *texels, int32_t stride, int32_t s, int32_t t, int log2)
{
    const uint32_t fields = (SOFT_SPREAD << (5 - log2)) | ((SOFT_SPREAD_ONE << (5 - log2)) - SOFT_SPREAD_ONE);
    const uint32_t *at = texels + (t >> 16) * stride + (s >> 16);
    return soft_blend_sum(at, (uint32_t)stride, (uint32_t)s << 16 >> 28, (uint32_t)t << 16 >> 28) >> log2 & fields;
}

/* One that may lie beyond the texture: then its edge is taken. */
static uint32_t sample_beyond(const soft_texture *texture, int32_t s, int32_t t, int log2)
{
    s = soft_within(s, texture->width << 16);
    t = soft_within(t, texture->height << 16);
    return magnified_sample(soft_texel_zero(texture), texture->stride, s, t, log2);
}

static uint16_t *ramp_part(uint16_t *pixel, int32_t count, uint32_t sum, uint32_t change)
{
    for (; count > 0; count--, sum += change) *pixel++ = soft_pixel_of(sum >> 5 & SOFT_SPREAD);
    return pixel;
}

static inline void ramp_four(uint16_t pixel[4], uint32_t sum, uint32_t change)
{
    pixel[0] = soft_pixel_of(sum >> 5 & SOFT_SPREAD), sum += change;
    pixel[1] = soft_pixel_of(sum >> 5 & SOFT_SPREAD), sum += change;
    pixel[2] = soft_pixel_of(sum >> 5 & SOFT_SPREAD), sum += change;
    pixel[3] = soft_pixel_of(sum >> 5 & SOFT_SPREAD);
}

/* A row of a texture magnified. Every 2^log2-th pixel of the frame is sampled (2 or 3); those between are blended of two samples, by adding
 * the same difference again and again. Columns of samples keep their places from row to row: neither edges of triangles nor rows show.
 * `skipped`: of them before the first pixel. */
static inline void magnified_run(const soft_texture *texture, uint16_t *pixel, int32_t left, const int32_t from[2], const int32_t step[2],
                                 int32_t skipped, const int log2)
{
    const uint32_t *texels = soft_texel_zero(texture);
    int32_t s = from[0] - step[0] * skipped, t = from[1] - step[1] * skipped, ds = step[0] * (1 << log2), dt = step[1] * (1 << log2);
    uint32_t last = sample_beyond(texture, s, t, log2), next;
    if (skipped) {
        int32_t count = left < (1 << log2) - skipped ? left : (1 << log2) - skipped;
        next = sample_beyond(texture, s += ds, t += dt, log2);
        pixel = ramp_part(pixel, count, (last << log2) + (next - last) * (uint32_t)skipped, next - last);
        last = next;
        left -= count;
    }
    for (; left > 1 << log2; left -= 1 << log2, pixel += 1 << log2, last = next) {
        next = magnified_sample(texels, texture->stride, s += ds, t += dt, log2);
        uint32_t sum = last << log2, change = next - last;
        ramp_four(pixel, sum, change);
        if (log2 > 2) ramp_four(pixel + 4, sum + 4 * change, change);
    }
    if (left) {
        next = sample_beyond(texture, s + ds, t + dt, log2);
        (void)ramp_part(pixel, left, last << log2, next - last);
    }
}

static void texture_run(const soft_state *state, uint32_t first, int32_t count, const int32_t from[2], const int32_t step[2])
{
    const soft_texture *texture = state->paint.texture;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + first;
    int log2 = count > 2 ? soft_sample_spacing(step) : 0;
    if (log2 == 3) {
        magnified_run(texture, pixel, count, from, step, (int32_t)(first & 7), 3);
        return;
    }
    if (log2 == 2) {
        magnified_run(texture, pixel, count, from, step, (int32_t)(first & 3), 2);
        return;
    }
    const uint32_t *texels = soft_texel_zero(texture);
    const uint16_t *end = pixel + count;
    int32_t stride = texture->stride, s = from[0], t = from[1];
    for (; pixel < end; pixel++, s += step[0], t += step[1]) *pixel = soft_pixel_of(soft_sample_565(texels, stride, s, t));
}

/* Marks depth up to the first hidden pixel: four at a time while all of them are nearer than what is there (the bits of four depths
 * together are no less than the greatest), as on ground not yet drawn. `least`: of w over the whole span. */
static uint32_t *mark_visible(uint32_t *depth, const uint32_t *end, uint32_t w, uint32_t dw, uint32_t least)
{
    for (;;) {
        for (; end - depth >= 4; depth += 4) {
            uint32_t a = depth[0], b = depth[1], c = depth[2], d = depth[3];
            if ((a | b | c | d) > least) break;
            a = w, b = a + dw, c = b + dw, d = c + dw;
            depth[0] = a, depth[1] = b, depth[2] = c, depth[3] = d;
            w = d + dw;
        }
        const uint32_t *stop = end - depth < 4 ? end : depth + 4;
        for (; depth < stop && w >= *depth; w += dw) *depth++ = w;
        if (depth == end || depth < stop) return depth;
    }
}

/* Runs of visible pixels, from pixel `at` on, which is hidden. */
static void texture_parts(soft_state *state, const soft_segment *segment, uint32_t at, uint32_t least)
{
    uint32_t *depth = state->depth + segment->first, count = segment->count;
    while (at < count) {
        uint32_t w = segment->w + segment->dw * at;
        for (; at < count && w < depth[at]; at++) w += segment->dw;
        uint32_t end = (uint32_t)(mark_visible(depth + at, depth + count, w, segment->dw, least) - depth);
        const int32_t from[2] = {segment->value[SOFT_S] + segment->step[SOFT_S] * (int32_t)at,
                                 segment->value[SOFT_T] + segment->step[SOFT_T] * (int32_t)at};
        texture_run(state, segment->first + at, (int32_t)(end - at), from, segment->step);
        at = end;
    }
}

/* RGB565 with the depth test: depth of a run of visible pixels first, then its colours. */
static void span_texture(soft_state *state, const soft_segment *segment)
{
    uint32_t *depth = state->depth + segment->first, w = segment->w, w_end = w + segment->dw * (segment->count - 1);
    if (!soft_on_texture(state->paint.texture, segment)) {
        soft_segment_paint(state, segment);
        return;
    }
    if (w_end > w) w_end = w;
    uint32_t visible = (uint32_t)(mark_visible(depth, depth + segment->count, w, segment->dw, w_end) - depth);
    texture_run(state, segment->first, (int32_t)visible, segment->value, segment->step); /* s and t come first */
    if (visible < segment->count) texture_parts(state, segment, visible, w_end);
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
