/* Triangles of a few rows, white and textured, into RGB565: most triangles of a terrain have one
 * row and four pixels. They get no planes and no walked edges. The line through a row's pixel
 * centres has one corner alone on its one side; two edges run from that corner to the line.
 * Attributes are interpolated along both edges up to the line, then along the line from one edge to
 * the other. So everything drawn lies between the corners, and on the texture, however thin the
 * triangle is.
 *
 * Perspective: w differs from that of a by at most 1/8. Linear interpolation then moves the texture
 * by at most (r - 1)/(r + 1) of an edge's length, r^2 = (9/8)/(7/8): by 2 pixels over 32 pixels, by
 * a fraction of a pixel where triangles are a few pixels large. */
#include "soft_meet.h"
#include "soft_sample.h"

#define ROWS  8 /* at most */
#define W_MAX (1u << 24)

FF_STATIC_ASSERT(ROWS <= SOFT_MEET_ROWS);
/* texels and w, times the 32 of paint_row: the difference of two differences */
FF_STATIC_ASSERT((SOFT_TINY_TEXELS + 2) * 65536 <= (1 << 28) / 32);
FF_STATIC_ASSERT(2 * (W_MAX / 8) * 32 < INT32_MAX);
FF_STATIC_ASSERT(SOFT_TINY_TEXELS + 2 <= 256); /* packed */

static inline int32_t least(int32_t a, int32_t b, int32_t c)
{
    if (b < a) a = b;
    return c < a ? c : a;
}

static inline int32_t most(int32_t a, int32_t b, int32_t c)
{
    if (b > a) a = b;
    return c > a ? c : a;
}

/* s and t in one word, each 8 bits and 8 of fraction, counted from the rim. A step is off by at
 * most 1/512 texel: by 1/16 after 32 pixels. */
static inline uint32_t packed(int32_t s, int32_t t)
{
    return ((uint32_t)((s + 128) >> 8) << 16) + (uint32_t)((t + 128) >> 8);
}

static inline void paint(soft_state *state, uint32_t first, int32_t count, uint32_t w, uint32_t dw,
                         uint32_t st, uint32_t dst)
{
    C3D_ASSERT(soft_in_frame(state, first, (uint32_t)count));
    const uint32_t *texels = (const uint32_t *)(const void *)state->paint.texture->texels;
    uint32_t stride = state->paint.texture->stride;
    uint32_t *depth = state->depth + first, *end = depth + count;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + first;
    do {
        if (w >= *depth) {
            *depth = w;
            const uint32_t *texel = texels + (st >> 8 & 255) * stride + (st >> 24);
            uint32_t x = st & 0xFF0000, y = st & 0xFF;
            *pixel = soft_pixel_of(
                soft_blend_sum(texel, stride, x >> 20, y >> 4, x * y >> 28) >> 5 & SOFT_SPREAD);
        }
        depth++, pixel++, w += dw, st += dst;
    } while (depth < end);
}

static inline void paint_row(soft_state *state, const soft_vertex *alone, const soft_meeting *left,
                             const soft_meeting *right, int32_t row)
{
    int32_t from = soft_first_row(left->x), to = soft_first_row(right->x);
    if (from < 0) from = 0;
    if (to > state->width) to = state->width;
    if (from >= to) return;
    C3D_ASSERT(right->x > left->x && right->x - left->x <= SOFT_MEET_WIDE_Q4);
    int32_t s = soft_along(alone->s, left->end->s, left->part),
            t = soft_along(alone->t, left->end->t, left->part);
    int32_t w = soft_along((int32_t)alone->w, (int32_t)left->end->w, left->part);
    int32_t reciprocal = state->edge_reciprocal[right->x - left->x],
            off = from * SOFT_ONE + SOFT_HALF - left->x;
    int32_t ds = soft_high((soft_along(alone->s, right->end->s, right->part) - s) * 32, reciprocal);
    int32_t dt = soft_high((soft_along(alone->t, right->end->t, right->part) - t) * 32, reciprocal);
    int32_t dw = soft_high(
        (soft_along((int32_t)alone->w, (int32_t)right->end->w, right->part) - w) * 32, reciprocal);
    s += (ds * off >> SOFT_SUB) + 65536, t += (dt * off >> SOFT_SUB) + 65536,
        w += dw * off >> SOFT_SUB;
    C3D_ASSERT(soft_between_on_texture(state->paint.texture, s - 65536, t - 65536,
                                       s - 65536 + ds * (to - from - 1),
                                       t - 65536 + dt * (to - from - 1)));
    paint(state, (uint32_t)(row * state->width + from), to - from, (uint32_t)w, (uint32_t)dw,
          packed(s, t), packed(ds, dt));
}

int soft_tiny(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    C3D_ASSERT(state->tiny_rows && !state->wide);
    int32_t row_a = soft_first_row(a->y), row_b = soft_first_row(b->y),
            row_c = soft_first_row(c->y);
    int32_t row = least(row_a, row_b, row_c), bottom = most(row_a, row_b, row_c);
    uint32_t change = soft_size_of((int32_t)(b->w - a->w)) | soft_size_of((int32_t)(c->w - a->w));
    if (bottom - row > ROWS || soft_size_of(b->x - a->x) >= SOFT_MEET_REACH_Q4 ||
        soft_size_of(c->x - a->x) >= SOFT_MEET_REACH_Q4)
        return 0;
    if (change > a->w >> 3 || a->w >= W_MAX) return 0;
    if (row < 0) row = 0;
    if (bottom > state->height) bottom = state->height;
    if (row < bottom && row < state->top_row) state->top_row = row;
    for (; row < bottom; row++) {
        const soft_vertex *alone = a, *next = b, *last = c;
        int32_t under_a = row - row_a, under_b = row - row_b, under_c = row - row_c;
        soft_meeting one, two;
        if ((under_a ^ under_b) >= 0)
            alone = c, next = a, last = b;
        else if ((under_a ^ under_c) >= 0)
            alone = b, next = c, last = a;
        soft_meet(state, alone, next, row * SOFT_ONE + SOFT_HALF, &one);
        soft_meet(state, alone, last, row * SOFT_ONE + SOFT_HALF, &two);
        if (one.x < two.x)
            paint_row(state, alone, &one, &two, row);
        else if (two.x < one.x)
            paint_row(state, alone, &two, &one, row);
    }
    return 1;
}
