/* Triangles of a few pixels, white and textured, into RGB565: most of a terrain. They are not walked edge by edge: each pixel of the
 * box around them is asked on which side of the three edges it lies, which takes additions only, and the answers are the weights of the
 * corners as well.
 *
 * With P a pixel's centre, b and c relative to a, and the area positive (b and c change places otherwise):
 *   weight of b: (P x c)/area, of c: (b x P)/area, of a: what is missing to 1.
 * Each is linear in P. Within TINY pixels and a rim of one each way coordinates are below 2^9 (Q4), steps below 2^14, weights and the
 * area below 2^19. A weight is at least 0 inside; on its edge, where it is 0, the pixel belongs to the triangle only if it lies
 * at a left or upper one: all others are lowered by one. So the weights of every pixel drawn stay within 0 .. 1 of the area, and what
 * they blend lies between the corners, on the texture.
 * Steps from pixel to pixel are used in a row of two pixels or more only: there no weight changes by more than the area, and no
 * product overflows. For thinner triangles they wrap, and nobody looks.
 * Perspective: w differs from a's by 1/8 at most. Linear interpolation moves the texture by (r - 1)/(r + 1) of an edge's length then,
 * r^2 = (9/8)/(7/8): by 1.4 pixels at worst, along 16 x 16 pixels; by a fraction of one where triangles are a few pixels large. */
#include "soft_sample.h"

#define TINY 16
#define PART 15 /* fraction bits of a weight over the area */

typedef struct corners {
    const soft_vertex *a, *b, *c;
    int32_t dx1, dy1, dx2, dy2, area;
} corners;

/* Pixels of a row inside, and the weights of b and c at the first of them. */
typedef struct span { uint32_t first; int32_t count, b, c; } span;

/* What is interpolated, from a on: texels Q9, w shifted down by `lift`. */
typedef struct slopes {
    int32_t ds1, dt1, ds2, dt2, dw1, dw2;
    int lift, lead;
    int32_t reciprocal;
} slopes;

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

static inline int32_t first_centre(int32_t q4) { return (q4 + SOFT_HALF - 1) >> SOFT_SUB; }

/* |n|, or one less. */
static inline uint32_t size_of(int32_t n) { return (uint32_t)(n ^ n >> 31); }

/* s and t in one word: 7 bits and 9 of fraction each, counted from the rim. */
static inline uint32_t packed(int32_t s, int32_t t) { return ((uint32_t)s << 16) + (uint32_t)t; }

static inline int32_t sum_of(int32_t part1, int32_t d1, int32_t part2, int32_t d2)
{
    return (int32_t)((uint32_t)part1 * (uint32_t)d1 + (uint32_t)part2 * (uint32_t)d2) >> PART;
}

static inline uint32_t texels_at(const slopes *slope, int32_t part_b, int32_t part_c)
{
    return packed(sum_of(part_b, slope->ds1, part_c, slope->ds2), sum_of(part_b, slope->dt1, part_c, slope->dt2));
}

static inline uint32_t depth_at(const slopes *slope, int32_t part_b, int32_t part_c)
{
    return (uint32_t)sum_of(part_b, slope->dw1, part_c, slope->dw2) << slope->lift;
}

static inline int32_t part_of(const slopes *slope, int32_t weight)
{
    return (int32_t)(((int64_t)(int32_t)((uint32_t)weight << slope->lead) * slope->reciprocal) >> 32) >> (29 - PART);
}

static inline void paint_span(soft_state *state, const span *at, uint32_t w, uint32_t dw, uint32_t st, uint32_t dst)
{
    const uint32_t *texels = (const uint32_t *)(const void *)state->paint.texture->texels;
    uint32_t stride = state->paint.texture->stride;
    uint32_t *depth = state->depth + at->first, *end = depth + at->count;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + at->first;
    do {
        if (w >= *depth) {
            *depth = w;
            const uint32_t *texel = texels + (st << 16 >> 25) * stride + (st >> 25);
            *pixel = soft_pixel_of(soft_blend_565(texel, stride, st << 7 >> 28, st << 23 >> 28));
        }
        depth++, pixel++, w += dw, st += dst;
    } while (depth < end);
}

static void paint(soft_state *state, const corners *t, const slopes *slope, const span *at, const span *end)
{
    int32_t across_b = part_of(slope, t->dy2 * SOFT_ONE), across_c = part_of(slope, -t->dy1 * SOFT_ONE);
    uint32_t dw = depth_at(slope, across_b, across_c), dst = texels_at(slope, across_b, across_c);
    uint32_t st = packed((t->a->s + 65536) >> 7, (t->a->t + 65536) >> 7), w = t->a->w;
    for (; at < end; at++) {
        int32_t b = part_of(slope, at->b), c = part_of(slope, at->c);
        paint_span(state, at, w + depth_at(slope, b, c), dw, st + texels_at(slope, b, c), dst);
    }
}

/* 0: w changes by too much from corner to corner. */
static inline int make_slopes(const soft_state *state, const corners *t, slopes *slope)
{
    const soft_vertex *a = t->a, *b = t->b, *c = t->c;
    int32_t dw1 = (int32_t)(b->w - a->w), dw2 = (int32_t)(c->w - a->w);
    if ((size_of(dw1) | size_of(dw2)) > a->w >> 3) return 0;
    slope->lift = 18 - soft_leading_zeros(a->w);
    if (slope->lift < 0) slope->lift = 0;
    slope->dw1 = dw1 >> slope->lift, slope->dw2 = dw2 >> slope->lift;
    slope->ds1 = (b->s - a->s) >> 7, slope->ds2 = (c->s - a->s) >> 7;
    slope->dt1 = (b->t - a->t) >> 7, slope->dt2 = (c->t - a->t) >> 7;
    slope->lead = soft_leading_zeros((uint32_t)t->area) - 1;
    slope->reciprocal = (int32_t)soft_reciprocal(state, (uint32_t)t->area << slope->lead);
    return 1;
}

/* Of the box from (left, top) to (right, bottom); returns the end of the spans. */
static inline span *find_spans(const corners *t, uint32_t width, int32_t left, int32_t top, int32_t right, int32_t bottom, span *out)
{
    int32_t to_x = left * SOFT_ONE + SOFT_HALF - t->a->x, to_y = top * SOFT_ONE + SOFT_HALF - t->a->y;
    int32_t b = to_x * t->dy2 - t->dx2 * to_y, c = t->dx1 * to_y - to_x * t->dy1, a = t->area - b - c;
    int32_t across_b = t->dy2 * SOFT_ONE, across_c = -t->dy1 * SOFT_ONE, across_a = -across_b - across_c;
    int32_t down_b = -t->dx2 * SOFT_ONE, down_c = t->dx1 * SOFT_ONE, down_a = -down_b - down_c;
    uint32_t begin = (uint32_t)top * width + (uint32_t)left, end = begin + (uint32_t)(right - left);
    b -= (int32_t)((uint32_t)(across_b * 8192 + down_b) >> 31);
    c -= (int32_t)((uint32_t)(across_c * 8192 + down_c) >> 31);
    a -= (int32_t)((uint32_t)(across_a * 8192 + down_a) >> 31);
    for (;;) {
        int32_t at_a = a, at_b = b, at_c = c;
        uint32_t at = begin;
        while ((at_a | at_b | at_c) < 0 && ++at < end) at_a += across_a, at_b += across_b, at_c += across_c;
        if (at < end) {
            out->first = at, out->b = at_b, out->c = at_c;
            do at_a += across_a, at_b += across_b, at_c += across_c;
            while (++at < end && (at_a | at_b | at_c) >= 0);
            out->count = (int32_t)(at - out->first);
            out++;
        }
        if (++top == bottom) return out;
        begin += width, end += width, a += down_a, b += down_b, c += down_c;
    }
}

int soft_tiny(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    int32_t top = first_centre(least(a->y, b->y, c->y)), bottom = first_centre(most(a->y, b->y, c->y));
    int32_t left = first_centre(least(a->x, b->x, c->x)), right = first_centre(most(a->x, b->x, c->x));
    span spans[TINY], *end;
    slopes slope;
    if (right - left > TINY || bottom - top > TINY) return 0;
    if (a->out | b->out | c->out) {
        if (left < 0) left = 0;
        if (top < 0) top = 0;
        if (right > state->width) right = state->width;
        if (bottom > state->height) bottom = state->height;
    }
    if (left >= right || top >= bottom) return 1;
    corners t = {a, b, c, b->x - a->x, b->y - a->y, c->x - a->x, c->y - a->y, 0};
    t.area = t.dx1 * t.dy2 - t.dx2 * t.dy1;
    if (t.area == 0) return 1;
    if (t.area < 0) t = (corners){a, c, b, t.dx2, t.dy2, t.dx1, t.dy1, -t.area};
    end = find_spans(&t, state->width, left, top, right, bottom, spans);
    if (end == spans) return 1;
    if (!make_slopes(state, &t, &slope)) return 0;
    if (top < state->top_row) state->top_row = top;
    paint(state, &t, &slope, spans, end);
    return 1;
}
