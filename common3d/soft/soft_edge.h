/* Exact edges. At the centre of a row, k sixteenths of a pixel below its upper end, an edge lies at
 * x = x0 + dx * k/dy sixteenths. Needed is the first pixel whose centre is not left of x. `at`
 * holds x with 32 fraction bits, too small by less than 1/dy, plus 1 - 2^-32. Because x is a
 * multiple of 1/dy, the upper word of `at` is x rounded up exactly. Small edges (dy <= 512, |dx| <
 * 8192): dx is multiplied with floor((2^31 - 1)/dy), a negative dx with the next greater number.
 * The product is too small by at most |dx| units of 2^-31 for each sixteenth of a row: over the
 * whole edge by less than 2^13 * 2^9 / 2^31 = 2^-9 <= 1/dy. Other edges: two quotients, rounded
 * down, are too small by at most 2^-32 a row: over 2^13 rows by less than 2^-17 <= 1/dy. */
#ifndef SOFT_EDGE_H
#define SOFT_EDGE_H

#include "soft_local.h"

typedef struct soft_edge {
    int64_t at, step; /* x in the row, and its change from row to row: Q4 with 32 more bits */
} soft_edge;

/* n/d rounded down, exactly; |n| < 2^53, d > 0. A first quotient comes from 31 bits of n, a second
 * one from the rest (below 2^26), and at most one step more is needed: a fraction of what a
 * division of 64 bits costs on processors that have none. */
static inline int64_t soft_floor_divide(const soft_state *state, int64_t n, int32_t d)
{
    C3D_ASSERT(d > 0 && n > -((int64_t)1 << 53) && n < (int64_t)1 << 53);
    int lead = soft_leading_zeros((uint32_t)d) - 1;
    /* 2^60 / (d << lead) */
    int32_t reciprocal = (int32_t)(soft_fine_reciprocal(state, (uint32_t)d << lead) >> 1);
    int64_t quotient = ((n >> 22) * reciprocal) >> (38 - lead), left = n - quotient * d;
    int64_t more = (left * reciprocal) >> (60 - lead);
    quotient += more;
    left -= more * d;
    for (; left < 0; left += d) quotient--;
    for (; left >= d; left -= d) quotient++;
    return quotient;
}

/* Begins the edge from a down to b at row `row`, whose centre lies between a and b. */
static inline void soft_edge_begin(const soft_state *state, soft_edge *edge, const soft_vertex *a,
                                   const soft_vertex *b, int32_t row)
{
    int32_t dx = b->x - a->x, dy = b->y - a->y, k = row * SOFT_ONE + SOFT_HALF - a->y;
    C3D_ASSERT(k >= 0 && k < dy && dx > -(1 << 17) && dx < 1 << 17);
    if (dy < SOFT_EDGE_TABLE && dx > -8192 && dx < 8192) {
        /* 2^13 * 2^31 */
        int64_t slope = (int64_t)dx * state->edge_reciprocal[dy] + (dx < 0 ? dx : 0);
        edge->step = slope * (2 * SOFT_ONE);
        edge->at = ((int64_t)a->x + 1) * ((int64_t)1 << 32) - 1 + slope * (2 * k);
    } else {
        /* 2^17 * 2^36 */
        edge->step = soft_floor_divide(state, (int64_t)dx * ((int64_t)1 << (32 + SOFT_SUB)), dy);
        edge->at = ((int64_t)a->x + 1) * ((int64_t)1 << 32) - 1 + (k >> SOFT_SUB) * edge->step +
                   soft_floor_divide(state, (int64_t)dx * (k & (SOFT_ONE - 1)) * ((int64_t)1 << 32),
                                     dy);
    }
}

/* First pixel whose centre is at the edge or right of it. */
static inline int32_t soft_edge_pixel(const soft_edge *edge)
{
    return ((int32_t)(edge->at >> 32) + SOFT_HALF - 1) >> SOFT_SUB;
}

static inline int32_t soft_first_row(int32_t y) { return (y + SOFT_HALF - 1) >> SOFT_SUB; }

/* Rows of a triangle (a.y <= b.y <= c.y), top to bottom; clipped to the frame. */
typedef struct soft_walk {
    soft_edge left, right;
    int32_t row, middle, end;
    int32_t from, to; /* the row's pixels */
    int bend_left;    /* 1: b is on the left side */
    const soft_vertex *b, *c;
} soft_walk;

/* Begins at the first row of the triangle that is in the frame; 0 when there is none. */
static inline int soft_walk_begin(const soft_state *state, soft_walk *walk, const soft_vertex *a,
                                  const soft_vertex *b, const soft_vertex *c, int bend_left)
{
    C3D_ASSERT(a->y <= b->y && b->y <= c->y);
    walk->row = soft_first_row(a->y);
    walk->middle = soft_first_row(b->y);
    walk->end = soft_first_row(c->y);
    if (walk->row < 0) walk->row = 0;
    if (walk->end > state->height) walk->end = state->height;
    if (walk->row >= walk->end) return 0;
    walk->bend_left = bend_left;
    walk->b = b;
    walk->c = c;
    soft_edge_begin(state, bend_left ? &walk->right : &walk->left, a, c, walk->row);
    if (walk->row < walk->middle)
        soft_edge_begin(state, bend_left ? &walk->left : &walk->right, a, b, walk->row);
    else
        soft_edge_begin(state, bend_left ? &walk->left : &walk->right, b, c, walk->row);
    return 1;
}

static inline void soft_walk_row(const soft_state *state, soft_walk *walk)
{
    C3D_ASSERT(walk->row >= 0 && walk->row < walk->end && walk->end <= state->height);
    walk->from = soft_edge_pixel(&walk->left);
    walk->to = soft_edge_pixel(&walk->right);
    if (walk->from < 0) walk->from = 0;
    if (walk->to > state->width) walk->to = state->width;
    if (state->paint.depth != SOFT_DEPTH_UNCOVERED) return;
    if (walk->from < state->open_from[walk->row]) walk->from = state->open_from[walk->row];
    if (walk->to > state->open_to[walk->row]) walk->to = state->open_to[walk->row];
}

/* Goes on to the next row; 0 after the last. */
static inline int soft_walk_next(const soft_state *state, soft_walk *walk)
{
    if (++walk->row >= walk->end) return 0;
    walk->left.at += walk->left.step;
    walk->right.at += walk->right.step;
    if (walk->row == walk->middle)
        soft_edge_begin(state, walk->bend_left ? &walk->left : &walk->right, walk->b, walk->c,
                        walk->row);
    return 1;
}

#endif
