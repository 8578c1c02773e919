/* Triangles of a few rows in colours alone, into RGB565, edge to edge as in soft_tiny.c: most
 * triangles of a terrain without images.
 *
 * Perspective: w differs from that of a by at most 1/8, so that colours are off by at most
 * (r - 1)/4 of their difference, r = (9/8)/(7/8): by a fourteenth. */
#include "soft_meet.h"
#include "soft_ramp.h"

#define W_MAX (1u << 27)

enum { W, RED, GREEN, BLUE, VALUES };

/* differences times the 32 of paint_row: of w they are an eighth, twice, of colours below 2^24 */
FF_STATIC_ASSERT(2 * (W_MAX / 8) * 32 < INT32_MAX);

/* A corner with its w, and its colours as soft_make_ramp has them. */
typedef struct corner {
    const soft_vertex *at;
    int32_t value[VALUES];
} corner;

static inline void take(corner *new, const soft_vertex *vertex)
{
    new->at = vertex;
    new->value[W] = (int32_t)vertex->w;
    soft_take_colours(new->value + RED, vertex->rgba);
}

/* An inner loop. */
static inline void paint(soft_state *state, uint32_t first, int32_t count,
                         const int32_t value[VALUES], const int32_t step[VALUES])
{
    C3D_ASSERT(soft_in_frame(state, first, (uint32_t)count));
    int32_t red = value[RED], green = value[GREEN], blue = value[BLUE], dr = step[RED],
            dg = step[GREEN], db = step[BLUE];
    uint32_t w = (uint32_t)value[W], dw = (uint32_t)step[W];
    uint32_t *depth = state->depth + first, *end = depth + count;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + first;
    do {
        if (w >= *depth) {
            *depth = w;
            *pixel = soft_colour_565(red, green, blue);
        }
        depth++, pixel++, w += dw, red += dr, green += dg, blue += db;
    } while (depth < end);
}

static inline void paint_row(soft_state *state, const corner *alone, const corner *left_end,
                             const soft_meeting *left, const corner *right_end,
                             const soft_meeting *right, int32_t row)
{
    int32_t from = soft_first_row(left->x), to = soft_first_row(right->x), value[VALUES],
            step[VALUES];
    if (from < 0) from = 0;
    if (to > state->width) to = state->width;
    if (from >= to) return;
    C3D_ASSERT(right->x > left->x && right->x - left->x <= SOFT_MEET_WIDE_Q4);
    int32_t reciprocal = state->edge_reciprocal[right->x - left->x],
            off = from * SOFT_ONE + SOFT_HALF - left->x;
    for (int i = 0; i < VALUES; i++) {
        int32_t at = soft_along(alone->value[i], left_end->value[i], left->part),
                end = soft_along(alone->value[i], right_end->value[i], right->part);
        step[i] = soft_high((end - at) * 32, reciprocal);
        value[i] = at + (step[i] * off >> SOFT_SUB);
    }
    paint(state, (uint32_t)(row * state->width + from), to - from, value, step);
}

/* Rows from `row` to `bottom` - 1, which lie on one side of the corners `one` and `two`. */
static inline void paint_rows(soft_state *state, const corner *alone, const corner *one,
                              const corner *two, int32_t row, int32_t bottom)
{
    for (; row < bottom; row++) {
        soft_meeting at_one, at_two;
        soft_meet(state, alone->at, one->at, row * SOFT_ONE + SOFT_HALF, &at_one);
        soft_meet(state, alone->at, two->at, row * SOFT_ONE + SOFT_HALF, &at_two);
        if (at_one.x < at_two.x)
            paint_row(state, alone, one, &at_one, two, &at_two, row);
        else if (at_two.x < at_one.x)
            paint_row(state, alone, two, &at_two, one, &at_one, row);
    }
}

int soft_tiny_colours(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c)
{
    C3D_ASSERT(state->tiny_colours && !state->wide);
    const soft_vertex *swap;
    if (b->y < a->y) swap = a, a = b, b = swap;
    if (c->y < b->y) swap = b, b = c, c = swap;
    if (b->y < a->y) swap = a, a = b, b = swap;
    int32_t row = soft_first_row(a->y), middle = soft_first_row(b->y),
            bottom = soft_first_row(c->y);
    uint32_t change = soft_size_of((int32_t)(b->w - a->w)) | soft_size_of((int32_t)(c->w - a->w));
    if (bottom - row > SOFT_MEET_ROWS || soft_size_of(b->x - a->x) >= SOFT_MEET_REACH_Q4 ||
        soft_size_of(c->x - a->x) >= SOFT_MEET_REACH_Q4)
        return 0;
    if (change > a->w >> 3 || (a->w | b->w | c->w) >= W_MAX) return 0;
    if (row < 0) row = 0;
    if (bottom > state->height) bottom = state->height;
    if (row >= bottom) return 1;
    if (row < state->top_row) state->top_row = row;
    corner top, bend, foot;
    take(&top, a);
    take(&bend, b);
    take(&foot, c);
    if (middle > bottom) middle = bottom;
    paint_rows(state, &top, &bend, &foot, row, middle);
    paint_rows(state, &foot, &bend, &top, middle > row ? middle : row, bottom);
    return 1;
}
