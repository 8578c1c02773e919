/* The spans drawn most, into RGB565: a texture as it is, the same with holes, and colours. Everything else: soft_segment_paint. */
#include "soft_ramp.h"
#include "soft_sample.h"

/* A sample of a texture magnified: it keeps 5 - log2 bits below its last place, which with 2^log2 steps fill the room above each field,
 * and the half that rounds the sum of both. */
static inline uint32_t magnified_sample(const uint32_t *texels, uint32_t stride, int32_t s, int32_t t, const int log2)
{
    const uint32_t fields = (SOFT_SPREAD << (5 - log2)) | ((SOFT_SPREAD_ONE << (5 - log2)) - SOFT_SPREAD_ONE);
    const uint32_t *at = texels + (t >> 16) * (int32_t)stride + (s >> 16);
    return soft_blend_sum(at, stride, (uint32_t)s << 16 >> 28, (uint32_t)t << 16 >> 28) >> log2 & fields;
}

static inline uint16_t *ramp_part(uint16_t *pixel, const uint16_t *end, uint32_t sum, uint32_t change)
{
    for (; pixel < end; sum += change) *pixel++ = soft_pixel_of(sum >> 5 & SOFT_SPREAD);
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
static SOFT_INLINE void magnified_run(const soft_texture *texture, uint16_t *pixel, const uint16_t *end, int32_t s, int32_t t,
                                      int32_t ds, int32_t dt, int32_t skipped, const int log2)
{
    const uint32_t *texels = soft_texel_zero(texture);
    uint32_t stride = texture->stride;
    s -= ds * skipped, t -= dt * skipped, ds *= 1 << log2, dt *= 1 << log2;
    uint32_t last = magnified_sample(texels, stride, s, t, log2), next;
    if (skipped) {
        const uint16_t *stop = end - pixel < (1 << log2) - skipped ? end : pixel + ((1 << log2) - skipped);
        s += ds, t += dt;
        next = magnified_sample(texels, stride, s, t, log2);
        pixel = ramp_part(pixel, stop, (last << log2) + (next - last) * (uint32_t)skipped, next - last);
        last = next;
    }
    for (; end - pixel >= 1 << log2; pixel += 1 << log2, last = next) {
        s += ds, t += dt;
        next = magnified_sample(texels, stride, s, t, log2);
        uint32_t sum = last << log2, change = next - last;
        ramp_four(pixel, sum, change);
        if (log2 > 2) ramp_four(pixel + 4, sum + 4 * change, change);
    }
    if (pixel < end) {
        next = magnified_sample(texels, stride, s + ds, t + dt, log2);
        (void)ramp_part(pixel, end, last << log2, next - last);
    }
}

/* A run of visible pixels. `log2`: see soft_sample_spacing. */
static inline void texture_run(const soft_state *state, uint32_t first, uint32_t count, int32_t s, int32_t t, const int32_t step[2], int log2)
{
    const soft_texture *texture = state->paint.texture;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + first;
    const uint16_t *end = pixel + count;
    if (log2 == 3) {
        magnified_run(texture, pixel, end, s, t, step[0], step[1], (int32_t)(first & 7), 3);
    } else if (log2 == 2) {
        magnified_run(texture, pixel, end, s, t, step[0], step[1], (int32_t)(first & 3), 2);
    } else {
        const uint32_t *texels = soft_texel_zero(texture);
        int32_t stride = texture->stride, ds = step[0], dt = step[1];
        for (; pixel < end; pixel++, s += ds, t += dt) *pixel = soft_pixel_of(soft_sample_565(texels, stride, s, t));
    }
}

/* Pixels between samples, as a power of two; -1 where pixels lie beyond the texture. All samples lie on it. */
static inline int sample_spacing(const soft_texture *texture, const soft_segment *segment)
{
    int32_t s = segment->value[SOFT_S], t = segment->value[SOFT_T], ds = segment->step[SOFT_S], dt = segment->step[SOFT_T];
    int32_t pixels = (int32_t)segment->count - 1;
    int log2 = pixels < 2 ? 0 : soft_sample_spacing(ds, dt);
    if (log2) {
        int32_t before = (int32_t)(segment->first & ((1u << log2) - 1)), all = (before + pixels) | ((1 << log2) - 1);
        int32_t s_first = s - ds * before, t_first = t - dt * before;
        if (soft_between_on_texture(texture, s_first, t_first, s_first + ds * (all + 1), t_first + dt * (all + 1))) return log2;
    }
    return soft_between_on_texture(texture, s, t, s + ds * pixels, t + dt * pixels) ? 0 : -1;
}

/* Marks depth up to the first hidden pixel: eight at a time while all of them are nearer than what is there (the bits of eight depths
 * together are no less than the greatest), as on ground not yet drawn. `least`: of w over the whole span. */
static uint32_t *mark_visible(uint32_t *depth, uint32_t count, uint32_t w, uint32_t dw, uint32_t least)
{
    for (;;) {
        uint32_t *end;
        for (; count >= 8; count -= 8, depth += 8) {
            uint32_t any = depth[0] | depth[1] | depth[2] | depth[3];
            if ((any | depth[4] | depth[5] | depth[6] | depth[7]) > least) break;
            depth[0] = w, w += dw, depth[1] = w, w += dw, depth[2] = w, w += dw, depth[3] = w, w += dw;
            depth[4] = w, w += dw, depth[5] = w, w += dw, depth[6] = w, w += dw, depth[7] = w, w += dw;
        }
        for (end = depth + (count < 8 ? count : 8); depth < end; w += dw) {
            if (w < *depth) return depth;
            *depth++ = w;
        }
        if (count <= 8) return depth;
        count -= 8;
    }
}

/* RGB565 with the depth test: depth of a run of visible pixels first, then its colours. */
static void span_texture(soft_state *state, const soft_segment *segment)
{
    uint32_t *row = state->depth + segment->first, *depth = row, *end = row + segment->count;
    uint32_t w = segment->w, dw = segment->dw, least = w + dw * (segment->count - 1);
    int log2 = sample_spacing(state->paint.texture, segment);
    if (log2 < 0) {
        soft_segment_paint(state, segment);
        return;
    }
    if (least > w) least = w;
    do {
        uint32_t *visible = depth;
        depth = mark_visible(visible, (uint32_t)(end - visible), w, dw, least);
        if (depth > visible) {
            int32_t at = (int32_t)(visible - row);
            texture_run(state, segment->first + (uint32_t)at, (uint32_t)(depth - visible), segment->value[SOFT_S] + segment->step[SOFT_S] * at,
                        segment->value[SOFT_T] + segment->step[SOFT_T] * at, segment->step, log2); /* s and t come first */
        }
        for (w = segment->w + dw * (uint32_t)(depth - row); depth < end && w < *depth; depth++) w += dw;
    } while (depth < end);
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
