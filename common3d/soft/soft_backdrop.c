/* Backdrops: finds the open pixels, those that nothing has covered, and has the spans that fill
 * them, into RGB565 (inner loops: long functions of few branches). */
#include "soft_ramp.h"
#include "soft_sample.h"

#include <string.h>

#define STEADY_LOG2 6 /* at most 64 pixels get one colour */

FF_STATIC_ASSERT(C3D_SOFT_BACKDROP_VERTICES <= 1 << 16); /* indices */

/* ---- open parts of rows ---- */

/* 1 when one of eight pixels is open, that is has depth 0. Depths are below 2^31, so only 0 - 1 has
 * bit 31 set. */
static inline int may_be_open(const uint32_t *depth)
{
    uint32_t open = (depth[0] - 1) | (depth[1] - 1) | (depth[2] - 1) | (depth[3] - 1);
    return ((open | (depth[4] - 1) | (depth[5] - 1) | (depth[6] - 1) | (depth[7] - 1)) >> 31) != 0;
}

static const uint32_t *first_open(const uint32_t *depth, const uint32_t *end)
{
    C3D_ASSERT(depth <= end);
    for (;;) {
        while (end - depth >= 8 && !may_be_open(depth)) depth += 8;
        const uint32_t *stop = end - depth < 8 ? end : depth + 8;
        while (depth < stop && *depth) depth++;
        if (depth < stop || depth == end) return depth;
    }
}

/* Finds the open part of every row; most rows of ground have none. */
void soft_find_open_parts(soft_state *state)
{
    const uint32_t *depth = state->depth;
    int32_t width = state->width;
    state->open_end = 0;
    for (int32_t row = 0; row < state->height; row++, depth += width) {
        const uint32_t *from = depth, *to = depth + width;
        if (row >= state->top_row) {
            const soft_part *covered = &state->covered[row];
            C3D_ASSERT(covered->from <= covered->to && covered->to <= width);
            from = first_open(from, from + covered->from);
            if (from == depth + covered->from) from = first_open(depth + covered->to, to);
            while (to > from && to[-1]) to--;
        }
        C3D_ASSERT(from >= depth && from <= depth + width && to <= depth + width);
        if (from < to) state->open_end = row + 1;
        state->open_from[row] = (uint16_t)(from - depth);
        state->open_to[row] = (uint16_t)(to - depth);
    }
}

/* ---- the sky ---- */

/* Fills pixels with one colour, two to a word. */
static void fill(uint16_t *pixel, const uint16_t *end, uint32_t colour)
{
    C3D_ASSERT(pixel <= end && colour >> 16 == 0);
    uint32_t pair = colour | colour << 16;
    if (pixel < end && (uintptr_t)pixel & 2) *pixel++ = (uint16_t)colour;
    for (; end - pixel >= 8; pixel += 8) {
        memcpy(pixel, &pair, 4);
        memcpy(pixel + 2, &pair, 4);
        memcpy(pixel + 4, &pair, 4);
        memcpy(pixel + 6, &pair, 4);
    }
    while (pixel < end) *pixel++ = (uint16_t)colour;
}

/* Fills the open ones among `count` pixels with one colour, and marks them. */
static void fill_open(const soft_state *state, uint32_t first, uint32_t count, uint32_t colour)
{
    C3D_ASSERT(soft_in_frame(state, first, count) && colour >> 16 == 0);
    uint32_t *depth = state->depth + first, *end = depth + count, mark = !state->paint.unmarked;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + first;
    for (; depth < end; depth++, pixel++) {
        if (*depth) continue;
        *depth = mark;
        *pixel = (uint16_t)colour;
    }
}

/* log2 of the pixels over which no colour changes by more than half a step of RGB565: red and blue
 * have 32 steps, green 64. */
static int steady_log2(const soft_ramp *ramp)
{
    uint32_t change = (uint32_t)(ramp->dr < 0 ? -ramp->dr : ramp->dr) |
                      (uint32_t)(ramp->db < 0 ? -ramp->db : ramp->db);
    change |= (uint32_t)(ramp->dg < 0 ? -ramp->dg : ramp->dg) << 1;
    /* change below 2^(18 - log2): half a step is 2^18 */
    int log2 = soft_leading_zeros(change | 1) - 14;
    C3D_ASSERT(log2 >= -14 && log2 <= 17);
    return log2 > STEADY_LOG2 ? STEADY_LOG2 : log2;
}

static void ramp_open(const soft_state *state, const soft_segment *segment, const soft_ramp *ramp)
{
    C3D_ASSERT(state->paint.depth == SOFT_DEPTH_UNCOVERED);
    int32_t red = ramp->red, green = ramp->green, blue = ramp->blue;
    uint32_t *depth = state->depth + segment->first, *end = depth + segment->count,
             mark = !state->paint.unmarked;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++, red += ramp->dr, green += ramp->dg, blue += ramp->db) {
        if (*depth) continue;
        *depth = mark;
        *pixel = soft_colour_565(red, green, blue);
    }
}

/* The sky's colours hardly change along a row: it is filled by runs of one colour. */
void soft_span_backdrop(soft_state *state, const soft_segment *segment)
{
    C3D_ASSERT(soft_in_frame(state, segment->first, segment->count) && !state->wide);
    soft_ramp ramp;
    soft_make_ramp(&ramp, segment);
    int log2 = steady_log2(&ramp);
    if (log2 < 2) {
        ramp_open(state, segment, &ramp);
        return;
    }
    int open = state->paint.unmarked && segment->first < (uint32_t)state->open_rows * state->width;
    uint16_t *pixels = (uint16_t *)(void *)state->colour;
    for (uint32_t at = segment->first, left = segment->count, count; left;
         at += count, left -= count) {
        count = left >> log2 ? 1u << log2 : left;
        int32_t half = (int32_t)count / 2;
        uint32_t colour = soft_colour_565(ramp.red + ramp.dr * half, ramp.green + ramp.dg * half,
                                          ramp.blue + ramp.db * half);
        if (open)
            fill(pixels + at, pixels + at + count, colour);
        else
            fill_open(state, at, count, colour);
        ramp.red += ramp.dr * (int32_t)count, ramp.green += ramp.dg * (int32_t)count,
            ramp.blue += ramp.db * (int32_t)count;
    }
}

/* ---- a panorama ---- */

/* A panorama has holes: a pixel between four clear texels is not drawn at all. */
void soft_span_holes(soft_state *state, const soft_segment *segment)
{
    C3D_ASSERT(soft_in_frame(state, segment->first, segment->count) && !state->wide);
    C3D_ASSERT(state->paint.texture->format == C3D_RGBA5551);
    const soft_texture *texture = state->paint.texture;
    const uint16_t *texels = (const uint16_t *)(const void *)texture->texels + texture->stride + 1;
    int32_t stride = texture->stride, s = segment->value[SOFT_S], t = segment->value[SOFT_T];
    int32_t ds = segment->step[SOFT_S], dt = segment->step[SOFT_T];
    if (!soft_on_texture(texture, segment) || state->paint.depth != SOFT_DEPTH_UNCOVERED) {
        soft_segment_paint(state, segment);
        return;
    }
    uint32_t mark = !state->paint.unmarked;
    for (uint32_t at = segment->first, end = at + segment->count; at < end;
         at++, s += ds, t += dt) {
        if (state->depth[at]) continue;
        const uint16_t *texel = texels + (t >> 16) * stride + (s >> 16);
        if (!((texel[0] | texel[1] | texel[stride] | texel[stride + 1]) & 1)) continue;
        uint32_t pixel = soft_blend_5551(texel, (uint32_t)stride, (uint32_t)s >> 11 & 31,
                                         (uint32_t)t >> 11 & 31);
        if (pixel == SOFT_CLEAR) continue;
        state->depth[at] = mark;
        ((uint16_t *)(void *)state->colour)[at] = (uint16_t)pixel;
    }
}
