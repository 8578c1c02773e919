/* Where the edges of a triangle of a few rows meet the line through a row's pixel centres: one
 * corner is alone on its one side, and two edges run from it to the line. Attributes are
 * interpolated along both edges up to the line, then along the line from one edge to the other.
 *
 * Exact edges: an edge meets the line dx * k/dy sixteenths right of its corner. With v = -dx * k,
 * floor(v/dy) is the upper word of (2v + 1) * floor((2^31 - 1)/dy): the 1 puts the product ahead by
 * 1/(2 dy), and with |v| < 2^17 and dy < 2^9 the rounded reciprocal takes away less than that. */
#ifndef SOFT_MEET_H
#define SOFT_MEET_H

#include "soft_edge.h"

#define SOFT_MEET_ROWS     12  /* at most */
#define SOFT_MEET_REACH_Q4 256 /* how far two corners may lie from the third, sideways */
#define SOFT_MEET_HIGH_Q4  ((SOFT_MEET_ROWS + 1) * SOFT_ONE) /* dy stays below */
#define SOFT_MEET_WIDE_Q4  (2 * SOFT_MEET_REACH_Q4)          /* and dx */

FF_STATIC_ASSERT(SOFT_MEET_HIGH_Q4 < 1 << 9 && SOFT_MEET_HIGH_Q4 * SOFT_MEET_WIDE_Q4 < 1 << 17);
FF_STATIC_ASSERT(SOFT_MEET_HIGH_Q4 < SOFT_EDGE_TABLE && SOFT_MEET_WIDE_Q4 < SOFT_EDGE_TABLE);

/* Where an edge from the corner that is alone meets the line. */
typedef struct soft_meeting {
    const soft_vertex *end;
    int32_t x;    /* Q4, rounded up */
    int32_t part; /* of the way from the corner to `end`, Q31 */
} soft_meeting;

/* |n|; one less for negative n. */
static inline uint32_t soft_size_of(int32_t n) { return (uint32_t)(n ^ n >> 31); }

/* k leads from the corner to the line, dy from the corner to the end: both down, or both up. */
static inline void soft_meet(const soft_state *state, const soft_vertex *alone,
                             const soft_vertex *end, int32_t y, soft_meeting *at)
{
    int32_t k = y - alone->y, dy = end->y - alone->y;
    if (k < 0) k = -k, dy = -dy;
    C3D_ASSERT(k >= 0 && k <= dy && dy > 0 && dy < SOFT_MEET_HIGH_Q4);
    C3D_ASSERT(end->x - alone->x > -SOFT_MEET_WIDE_Q4 && end->x - alone->x < SOFT_MEET_WIDE_Q4);
    int32_t reciprocal = state->edge_reciprocal[dy];
    at->end = end;
    at->part = k * reciprocal;
    at->x = alone->x - soft_high(1 - 2 * k * (end->x - alone->x), reciprocal);
}

static inline int32_t soft_along(int32_t from, int32_t to, int32_t part)
{
    return from + 2 * soft_high(to - from, part);
}

/* A corner with what is interpolated from it: of any number of values. */
#define SOFT_MEET_VALUES 6
typedef struct soft_corner {
    const soft_vertex *at;
    int32_t value[SOFT_MEET_VALUES];
} soft_corner;

/* A part of a row: its first pixel, how many, and values there and their steps. */
typedef struct soft_run {
    int32_t from, count, value[SOFT_MEET_VALUES], step[SOFT_MEET_VALUES];
} soft_run;

static SOFT_INLINE int soft_run_between(const soft_state *state, const soft_corner *alone,
                                        const soft_corner *left_end, const soft_meeting *left,
                                        const soft_corner *right_end, const soft_meeting *right,
                                        int values, soft_run *run)
{
    int32_t from = soft_first_row(left->x), to = soft_first_row(right->x);
    if (from < 0) from = 0;
    if (to > state->width) to = state->width;
    if (from >= to) return 0;
    C3D_ASSERT(right->x > left->x && right->x - left->x <= SOFT_MEET_WIDE_Q4);
    int32_t reciprocal = state->edge_reciprocal[right->x - left->x],
            off = from * SOFT_ONE + SOFT_HALF - left->x;
    run->from = from;
    run->count = to - from;
    for (int i = 0; i < values; i++) {
        int32_t at = soft_along(alone->value[i], left_end->value[i], left->part),
                end = soft_along(alone->value[i], right_end->value[i], right->part);
        run->step[i] = soft_high((end - at) * 32, reciprocal);
        run->value[i] = at + (run->step[i] * off >> SOFT_SUB);
    }
    return 1;
}

/* What lies in a row between the edges from `alone` to `one` and to `two`. 0: nothing. */
static SOFT_INLINE int soft_run_of_row(const soft_state *state, const soft_corner *alone,
                                       const soft_corner *one, const soft_corner *two, int32_t row,
                                       int values, soft_run *run)
{
    soft_meeting at_one, at_two;
    soft_meet(state, alone->at, one->at, row * SOFT_ONE + SOFT_HALF, &at_one);
    soft_meet(state, alone->at, two->at, row * SOFT_ONE + SOFT_HALF, &at_two);
    if (at_one.x < at_two.x)
        return soft_run_between(state, alone, one, &at_one, two, &at_two, values, run);
    return at_two.x < at_one.x &&
           soft_run_between(state, alone, two, &at_two, one, &at_one, values, run);
}

#endif
