/* Triangles of a few rows, white and textured, into RGB565: most triangles of a terrain have one
 * row and four pixels. They get no planes and no walked edges. The line through a row's pixel
 * centres has one corner alone on its one side; two edges run from that corner to the line.
 * Attributes are interpolated along both edges up to the line, then along the line from one edge to
 * the other. So everything drawn lies between the corners, and on the texture, however thin the
 * triangle is.
 *
 * Exact edges: an edge meets the line dx * k/dy sixteenths right of its corner. With v = -dx * k,
 * floor(v/dy) is the upper word of (2v + 1) * floor((2^31 - 1)/dy): the 1 puts the product ahead by
 * 1/(2 dy), and with |v| < 2^17 and dy < 2^9 the rounded reciprocal takes away less than that.
 * Perspective: w differs from that of a by at most 1/8. Linear interpolation then moves the texture
 * by at most (r - 1)/(r + 1) of an edge's length, r^2 = (9/8)/(7/8): by 2 pixels over 32 pixels, by
 * a fraction of a pixel where triangles are a few pixels large. */
#include "soft_edge.h"
#include "soft_sample.h"

#define ROWS     8   /* at most */
#define REACH_Q4 256 /* how far b and c may lie from a, sideways */
#define W_MAX    (1u << 24)
#define HIGH_Q4  ((ROWS + 1) * SOFT_ONE) /* dy stays below */
#define WIDE_Q4  (2 * REACH_Q4)          /* and dx */

FF_STATIC_ASSERT(HIGH_Q4 < 1 << 9 && HIGH_Q4 * WIDE_Q4 < 1 << 17);
FF_STATIC_ASSERT(HIGH_Q4 < SOFT_EDGE_TABLE && WIDE_Q4 < SOFT_EDGE_TABLE);
/* texels and w, times the 32 of paint_row: the difference of two differences */
FF_STATIC_ASSERT((SOFT_TINY_TEXELS + 2) * 65536 <= (1 << 28) / 32);
FF_STATIC_ASSERT(2 * (W_MAX / 8) * 32 < INT32_MAX);
FF_STATIC_ASSERT(SOFT_TINY_TEXELS + 2 <= 256); /* packed */

/* Where an edge from the corner that is alone meets the line. */
typedef struct meeting {
    const soft_vertex *end;
    int32_t x;    /* Q4, rounded up */
    int32_t part; /* of the way from the corner to `end`, Q31 */
} meeting;

/* |n|; one less for negative n. */
static inline uint32_t size_of(int32_t n) { return (uint32_t)(n ^ n >> 31); }

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

static inline int32_t high(int32_t a, int32_t b) { return (int32_t)(((int64_t)a * b) >> 32); }

/* k leads from the corner to the line, dy from the corner to the end: both down, or both up. */
static inline void meet(const soft_state *state, const soft_vertex *alone, const soft_vertex *end,
                        int32_t y, meeting *at)
{
    int32_t k = y - alone->y, dy = end->y - alone->y;
    if (k < 0) k = -k, dy = -dy;
    C3D_ASSERT(k >= 0 && k <= dy && dy > 0 && dy < HIGH_Q4);
    C3D_ASSERT(end->x - alone->x > -WIDE_Q4 && end->x - alone->x < WIDE_Q4);
    int32_t reciprocal = state->edge_reciprocal[dy];
    at->end = end;
    at->part = k * reciprocal;
    at->x = alone->x - high(1 - 2 * k * (end->x - alone->x), reciprocal);
}

static inline int32_t along(int32_t from, int32_t to, int32_t part)
{
    return from + 2 * high(to - from, part);
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

static inline void paint_row(soft_state *state, const soft_vertex *alone, const meeting *left,
                             const meeting *right, int32_t row)
{
    int32_t from = soft_first_row(left->x), to = soft_first_row(right->x);
    if (from < 0) from = 0;
    if (to > state->width) to = state->width;
    if (from >= to) return;
    C3D_ASSERT(right->x > left->x && right->x - left->x <= WIDE_Q4);
    int32_t s = along(alone->s, left->end->s, left->part),
            t = along(alone->t, left->end->t, left->part);
    int32_t w = along((int32_t)alone->w, (int32_t)left->end->w, left->part);
    int32_t reciprocal = state->edge_reciprocal[right->x - left->x],
            off = from * SOFT_ONE + SOFT_HALF - left->x;
    int32_t ds = high((along(alone->s, right->end->s, right->part) - s) * 32, reciprocal);
    int32_t dt = high((along(alone->t, right->end->t, right->part) - t) * 32, reciprocal);
    int32_t dw = high((along((int32_t)alone->w, (int32_t)right->end->w, right->part) - w) * 32,
                      reciprocal);
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
    uint32_t change = size_of((int32_t)(b->w - a->w)) | size_of((int32_t)(c->w - a->w));
    if (bottom - row > ROWS || size_of(b->x - a->x) >= REACH_Q4 || size_of(c->x - a->x) >= REACH_Q4)
        return 0;
    if (change > a->w >> 3 || a->w >= W_MAX) return 0;
    if (row < 0) row = 0;
    if (bottom > state->height) bottom = state->height;
    if (row < bottom && row < state->top_row) state->top_row = row;
    for (; row < bottom; row++) {
        const soft_vertex *alone = a, *next = b, *last = c;
        int32_t under_a = row - row_a, under_b = row - row_b, under_c = row - row_c;
        meeting one, two;
        if ((under_a ^ under_b) >= 0)
            alone = c, next = a, last = b;
        else if ((under_a ^ under_c) >= 0)
            alone = b, next = c, last = a;
        meet(state, alone, next, row * SOFT_ONE + SOFT_HALF, &one);
        meet(state, alone, last, row * SOFT_ONE + SOFT_HALF, &two);
        if (one.x < two.x)
            paint_row(state, alone, &one, &two, row);
        else if (two.x < one.x)
            paint_row(state, alone, &two, &one, row);
    }
    return 1;
}
