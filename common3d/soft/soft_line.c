/* Lines one pixel wide: along its longer direction a line has one pixel for each pixel centre from
 * its first end up to, but not including, the other end. */
#include "soft_local.h"

static uint32_t w_between(uint32_t a, uint32_t b, int32_t part, int32_t whole)
{
    C3D_ASSERT(whole > 0 && part >= 0 && part < whole);
    return (uint32_t)((int64_t)a + ((int64_t)b - (int64_t)a) * part / whole);
}

static void paint_pixel(soft_state *state, int32_t x, int32_t y, const soft_vertex *a,
                        const soft_vertex *b, int32_t part, int32_t whole)
{
    if (x < 0 || y < 0 || x >= state->width || y >= state->height) return;
    soft_segment segment = { .first = (uint32_t)(y * state->width + x),
                             .count = 1,
                             .w = w_between(a->w, b->w, part, whole) };
    for (int i = 0; i < 3; i++)
        segment.value[SOFT_R + i] = (a->rgba[i] << 16) +
                                    (int32_t)((int64_t)(b->rgba[i] - a->rgba[i]) * 65536 * part /
                                              whole);
    segment.value[SOFT_F] =
        (a->fog_q8 + (int32_t)((int64_t)(b->fog_q8 - a->fog_q8) * part / whole)) * 65536;
    soft_segment_paint(state, &segment);
}

static void draw_line(soft_state *state, const soft_vertex *a, const soft_vertex *b)
{
    C3D_ASSERT(!((a->out | b->out) & SOFT_MUST_CLIP));
    int32_t dx = b->x - a->x, dy = b->y - a->y, wide = dx < 0 ? -dx : dx, high = dy < 0 ? -dy : dy;
    int steep = high > wide;
    if ((a->out & b->out) != 0 || (!wide && !high)) return;
    if (steep ? dy < 0 : dx < 0) {
        draw_line(state, b, a);
        return;
    }
    int32_t start = steep ? a->y : a->x, whole = steep ? dy : dx,
            last = steep ? state->height : state->width;
    C3D_ASSERT(whole > 0 && whole < 1 << 17);
    int32_t first = (start + SOFT_HALF - 1) >> SOFT_SUB,
            end = (start + whole + SOFT_HALF - 1) >> SOFT_SUB;
    for (int32_t at = first < 0 ? 0 : first; at < end && at < last; at++) {
        int32_t part = at * SOFT_ONE + SOFT_HALF - start;
        if (steep)
            paint_pixel(state, (a->x + (int32_t)((int64_t)dx * part / whole)) >> SOFT_SUB, at, a, b,
                        part, whole);
        else
            paint_pixel(state, at, (a->y + (int32_t)((int64_t)dy * part / whole)) >> SOFT_SUB, a, b,
                        part, whole);
    }
}

void soft_lines(soft_state *state, const uint16_t *indices, uint32_t count)
{
    C3D_ASSERT(count % 2 == 0);
    state->top_row = 0;
    for (uint32_t i = 0; i + 1 < count; i += 2) {
        const soft_vertex *a = &state->vertices[indices[i]], *b = &state->vertices[indices[i + 1]];
        soft_vertex cut[2];
        if (a->out & b->out) continue;
        if (!((a->out | b->out) & SOFT_MUST_CLIP))
            draw_line(state, a, b);
        else if (soft_clip_line(state, a, b, cut))
            draw_line(state, &cut[0], &cut[1]);
    }
}
