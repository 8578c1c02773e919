/* Triangles of a few rows under a projector, edge to edge as in soft_tiny.c: most of those that a
 * picture is thrown on. */
#include "soft_meet.h"
#include "soft_ramp.h"
#include "soft_thrown_texels.h"

#define TEXELS_MAX 64 /* between two corners */
#define W_MAX      (1u << 24)

/* texels and w, times the 32 of paint_row: the difference of two differences */
FF_STATIC_ASSERT(2 * TEXELS_MAX * 65536 <= (1 << 28) / 32);
FF_STATIC_ASSERT(2 * (int64_t)W_MAX * 32 <= INT32_MAX);
FF_STATIC_ASSERT(TEXELS_MAX + 4 <= 256); /* packed */

/* The part of the texture that a triangle can reach, and what it shows where that is open. */
typedef struct part {
    const uint16_t *texels;
    uint32_t stride;
    int32_t s, t; /* of its first texel */
    uint16_t colour;
} part;

static int32_t least_of(int32_t a, int32_t b, int32_t c)
{
    int32_t least = a < b ? a : b;
    return c < least ? c : least;
}

static int32_t range_of(int32_t a, int32_t b, int32_t c)
{
    int32_t most = a > b ? a : b;
    return (c > most ? c : most) - least_of(a, b, c);
}

/* s and t in one word, each 8 bits and 8 of fraction, counted from the part's first texel. A step
 * is off by at most 1/512 texel: by 1/16 after 32 pixels. */
static inline uint32_t packed(int32_t s, int32_t t)
{
    return ((uint32_t)((s + 128) >> 8) << 16) + (uint32_t)((t + 128) >> 8);
}

/* An inner loop. */
static inline void paint(soft_state *state, const part *picture, uint32_t first, int32_t count,
                         uint32_t w, uint32_t dw, uint32_t st, uint32_t dst)
{
    C3D_ASSERT(soft_in_frame(state, first, (uint32_t)count));
    uint32_t over = state->paint.alpha_test, stride = picture->stride,
             bias = over ? soft_thrown_bias(w, (int32_t)dw) : 0,
             through = soft_thrown_of_32(&state->paint);
    uint32_t *depth = state->depth + first, *end = depth + count;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + first;
    for (; depth < end; depth++, pixel++, w += dw, st += dst) {
        if (w + bias < *depth) continue;
        const uint16_t *texel = picture->texels + (st >> 8 & 255) * stride + (st >> 24);
        uint32_t x = st >> 19 & 31, y = st >> 3 & 31;
        if (soft_thrown_opaque(texel, stride, x, y)) {
            uint16_t colour = soft_thrown_blend(texel, stride, x, y);
            *pixel = through ? soft_thrown_through(*pixel, colour, through) : colour;
        } else if (!over)
            *pixel = picture->colour;
        else
            continue;
        if (w > *depth) *depth = w;
    }
}

static inline void paint_row(soft_state *state, const part *picture, const soft_vertex *alone,
                             const soft_meeting *left, const soft_meeting *right, int32_t row)
{
    int32_t from = soft_first_row(left->x), to = soft_first_row(right->x);
    if (from < 0) from = 0;
    if (to > state->width) to = state->width;
    if (from >= to) return;
    C3D_ASSERT(right->x > left->x && right->x - left->x <= SOFT_MEET_WIDE_Q4);
    int32_t s = soft_along(alone->s, left->end->s, left->part),
            t = soft_along(alone->t, left->end->t, left->part),
            w = soft_along((int32_t)alone->w, (int32_t)left->end->w, left->part);
    int32_t s_end = soft_along(alone->s, right->end->s, right->part),
            t_end = soft_along(alone->t, right->end->t, right->part),
            w_end = soft_along((int32_t)alone->w, (int32_t)right->end->w, right->part);
    int32_t reciprocal = state->edge_reciprocal[right->x - left->x],
            off = from * SOFT_ONE + SOFT_HALF - left->x;
    int32_t ds = soft_high((s_end - s) * 32, reciprocal),
            dt = soft_high((t_end - t) * 32, reciprocal),
            dw = soft_high((w_end - w) * 32, reciprocal);
    s += (ds * off >> SOFT_SUB) - picture->s, t += (dt * off >> SOFT_SUB) - picture->t;
    w += dw * off >> SOFT_SUB;
    C3D_ASSERT(s >= 0 && t >= 0 && s < 255 << 16 && t < 255 << 16);
    paint(state, picture, (uint32_t)(row * state->width + from), to - from, (uint32_t)w,
          (uint32_t)dw, packed(s, t), packed(ds, dt));
}

/* 1 when a triangle's differences are small enough. */
static int is_tiny(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    return soft_first_row(c->y) - soft_first_row(a->y) <= SOFT_MEET_ROWS &&
           soft_size_of(b->x - a->x) < SOFT_MEET_REACH_Q4 &&
           soft_size_of(c->x - a->x) < SOFT_MEET_REACH_Q4 && (a->w | b->w | c->w) < W_MAX &&
           range_of(a->s, b->s, c->s) < TEXELS_MAX << 16 &&
           range_of(a->t, b->t, c->t) < TEXELS_MAX << 16;
}

static void find_part(const soft_state *state, part *picture, const soft_vertex *a,
                      const soft_vertex *b, const soft_vertex *c)
{
    const soft_texture *texture = state->paint.texture;
    /* one texel before the least, which rounding may miss: the rim at the outside */
    int32_t column = (least_of(a->s, b->s, c->s) >> 16) - 1,
            row = (least_of(a->t, b->t, c->t) >> 16) - 1;
    C3D_ASSERT(column >= -1 && row >= -1);
    picture->stride = texture->stride;
    picture->texels = (const uint16_t *)(const void *)texture->texels +
                      (row + 1) * texture->stride + column + 1;
    picture->s = column * 65536;
    picture->t = row * 65536;
    picture->colour = soft_flat_565(a->rgba);
}

int soft_thrown_tiny(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                     const soft_vertex *c)
{
    C3D_ASSERT(!state->wide && a->y <= b->y && b->y <= c->y);
    if (!is_tiny(a, b, c)) return 0;
    int32_t row = soft_first_row(a->y), middle = soft_first_row(b->y),
            bottom = soft_first_row(c->y);
    part picture;
    find_part(state, &picture, a, b, c);
    if (row < 0) row = 0;
    if (bottom > state->height) bottom = state->height;
    if (row < bottom && row < state->top_row) state->top_row = row;
    for (; row < bottom; row++) {
        const soft_vertex *alone = row < middle ? a : c;
        soft_meeting one, two;
        soft_meet(state, alone, b, row * SOFT_ONE + SOFT_HALF, &one);
        soft_meet(state, alone, row < middle ? c : a, row * SOFT_ONE + SOFT_HALF, &two);
        if (one.x < two.x)
            paint_row(state, &picture, alone, &one, &two, row);
        else if (two.x < one.x)
            paint_row(state, &picture, alone, &two, &one, row);
    }
    return 1;
}
