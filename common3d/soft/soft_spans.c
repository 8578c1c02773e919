/* The spans drawn most, into RGB565: a texture as it is, the same with holes, and colours.
 * Everything else: soft_segment_paint. */
#include "soft_ramp.h"
#include "soft_sample.h"

FF_STATIC_ASSERT(SOFT_MAGNIFIED_LOG2 == 3); /* magnified_row: 2 or 3 */

/* A sample of a magnified texture. Each field keeps 5 - log2 fraction bits, among them the half
 * that rounds: 2^log2 steps from one sample to the next then need the 5 bits of room that a field
 * has, and no more. s and t are counted from the rim. */
static inline uint32_t magnified_sample(const uint32_t *texels, uint32_t stride, int32_t s,
                                        int32_t t, const int log2)
{
    const uint32_t fields = (SOFT_SPREAD << (5 - log2)) |
                            ((SOFT_SPREAD_ONE << (5 - log2)) - SOFT_SPREAD_ONE);
    return soft_sample_sum(texels, stride, s, t) >> log2 & fields;
}

static inline void ramp_four(uint16_t pixel[4], uint32_t sum, uint32_t change)
{
    pixel[0] = soft_pixel_of(sum >> 5 & SOFT_SPREAD), sum += change;
    pixel[1] = soft_pixel_of(sum >> 5 & SOFT_SPREAD), sum += change;
    pixel[2] = soft_pixel_of(sum >> 5 & SOFT_SPREAD), sum += change;
    pixel[3] = soft_pixel_of(sum >> 5 & SOFT_SPREAD);
}

static inline uint32_t any_of_four(const uint32_t depth[4])
{
    return depth[0] | depth[1] | depth[2] | depth[3];
}

static inline uint32_t mark_four(uint32_t depth[4], uint32_t w, uint32_t dw)
{
    depth[0] = w, w += dw;
    depth[1] = w, w += dw;
    depth[2] = w, w += dw;
    depth[3] = w;
    return w + dw;
}

/* Draws a segment of a magnified texture. Every 2^log2-th pixel of the frame is sampled (log2 is 2
 * or 3); the pixels between are blended of two samples, by adding the same difference again and
 * again. Columns of samples keep their places from row to row, so that neither edges of triangles
 * nor rows show. The pixels from one sample to the next are drawn together when all of them are
 * nearer than what is there. One comparison finds that out: the old depths, joined by OR, give a
 * number that is at least the greatest of them. Returns 0, with nothing drawn, when some sample
 * would lie beyond the texture. */
static SOFT_INLINE int magnified_row(const soft_state *state, const soft_segment *segment,
                                     const int log2)
{
    C3D_ASSERT(log2 >= 2 && log2 <= SOFT_MAGNIFIED_LOG2);
    C3D_ASSERT(soft_in_frame(state, segment->first, segment->count));
    const soft_texture *texture = state->paint.texture;
    const uint32_t size = 1u << log2, before = segment->first & (size - 1),
                   stride = texture->stride;
    const int32_t ds = segment->step[SOFT_S] * (int32_t)size,
                  dt = segment->step[SOFT_T] * (int32_t)size;
    int32_t s = segment->value[SOFT_S] - segment->step[SOFT_S] * (int32_t)before,
            t = segment->value[SOFT_T] - segment->step[SOFT_T] * (int32_t)before;
    int32_t blocks = (int32_t)((before + segment->count + size - 1) >> log2);
    C3D_ASSERT(blocks >= 1 && before < size);
    if (!soft_between_on_texture(texture, s, t, s + ds * blocks, t + dt * blocks)) return 0;
    const uint32_t *texels = (const uint32_t *)(const void *)texture->texels;
    uint32_t *first = state->depth + segment->first, *end = first + segment->count,
             *depth = first - before;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first - before;
    uint32_t dw = segment->dw, w = segment->w - dw * before,
             least = segment->w + dw * (segment->count - 1);
    s += 65536, t += 65536; /* from the rim */
    uint32_t last = magnified_sample(texels, stride, s, t, log2);
    if (least > segment->w) least = segment->w;
    do {
        s += ds, t += dt;
        uint32_t next = magnified_sample(texels, stride, s, t, log2), sum = last << log2,
                 change = next - last;
        if (depth >= first && depth + size <= end &&
            (any_of_four(depth) | any_of_four(depth + size - 4)) <= least) {
            w = mark_four(depth, w, dw);
            if (log2 > 2) w = mark_four(depth + 4, w, dw);
            ramp_four(pixel, sum, change);
            if (log2 > 2) ramp_four(pixel + 4, sum + 4 * change, change);
        } else {
            int32_t i = depth < first ? (int32_t)before : 0,
                    stop = depth + size <= end ? (int32_t)size : (int32_t)(end - depth);
            uint32_t w_here = w + dw * (uint32_t)i;
            sum += change * (uint32_t)i;
            for (; i < stop; i++, w_here += dw, sum += change) {
                if (w_here < depth[i]) continue;
                depth[i] = w_here;
                pixel[i] = soft_pixel_of(sum >> 5 & SOFT_SPREAD);
            }
            w += dw << log2;
        }
        depth += size, pixel += size, last = next;
    } while (depth < end);
    return 1;
}

/* A texture as it is, with the depth test. */
static void span_texture(soft_state *state, const soft_segment *segment)
{
    int log2 = segment->count > 2
                   ? soft_sample_spacing(segment->step[SOFT_S], segment->step[SOFT_T])
                   : 0;
    if (log2 == 3 && magnified_row(state, segment, 3)) return;
    if (log2 == 2 && magnified_row(state, segment, 2)) return;
    if (soft_on_texture(state->paint.texture, segment))
        soft_sample_row(state, segment);
    else
        soft_segment_paint(state, segment);
}

static void span_colour(soft_state *state, const soft_segment *segment)
{
    C3D_ASSERT(soft_in_frame(state, segment->first, segment->count) && !state->wide);
    soft_ramp ramp;
    soft_make_ramp(&ramp, segment);
    int32_t red = ramp.red, green = ramp.green, blue = ramp.blue;
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count, w = segment->w,
             dw = segment->dw;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end;
         depth++, pixel++, w += dw, red += ramp.dr, green += ramp.dg, blue += ramp.db) {
        if (w < *depth) continue;
        *depth = w;
        *pixel = soft_colour_565(red, green, blue);
    }
}

void soft_choose_span(soft_state *state)
{
    const soft_paint *paint = &state->paint;
    const soft_texture *texture = paint->texture;
    C3D_ASSERT(!texture || (texture->width <= 4096 && texture->height <= 4096));
    state->span = soft_segment_paint;
    state->texture_rows = state->tiny_rows = state->tiny_colours = 0;
    state->segment.w_shift = 0;
    if (state->wide || paint->depth == SOFT_DEPTH_NONE) return;
    int test = paint->depth == SOFT_DEPTH_TEST;
    if (paint->thrown) {
        if (texture->format == C3D_RGBA5551 && test) state->span = soft_span_thrown;
        return;
    }
    if (!texture) state->span = test ? span_colour : soft_span_backdrop;
    state->tiny_colours = !texture && test && !paint->fog;
    if (texture && paint->white && texture->format == C3D_RGB565 && test) {
        state->span = span_texture;
        state->texture_rows = !state->off_texture;
        state->tiny_rows = state->texture_rows && texture->width <= SOFT_TINY_TEXELS &&
                           texture->height <= SOFT_TINY_TEXELS && !paint->fog;
    }
    if (texture && paint->white && paint->alpha_test && texture->format == C3D_RGBA5551)
        state->span = soft_span_holes;
}
