/* Triangles of a few rows in colours alone, into RGB565, edge to edge as in soft_tiny.c: most
 * triangles of a terrain without images.
 *
 * Perspective: w differs from that of a by at most 1/8, so that colours are off by at most
 * (r - 1)/4 of their difference, r = (9/8)/(7/8): by a fourteenth. */
#include "soft_meet.h"
#include "soft_ramp.h"

#define W_MAX (1u << 27)

enum { W, RED, GREEN, BLUE, VALUES };
FF_STATIC_ASSERT(VALUES <= SOFT_MEET_VALUES);

/* differences times the 32 of paint_row: of w they are an eighth, twice, of colours below 2^24 */
FF_STATIC_ASSERT(2 * (W_MAX / 8) * 32 < INT32_MAX);

/* Its w, and its colours as soft_make_ramp has them. */
static inline void take(soft_corner *new, const soft_vertex *vertex)
{
    new->at = vertex;
    new->value[W] = (int32_t)vertex->w;
    soft_take_colours(new->value + RED, vertex->rgba);
}

/* An inner loop. */
static inline void paint(soft_state *state, uint32_t first, const soft_run *run)
{
    const int32_t *value = run->value, *step = run->step, count = run->count;
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

/* Rows from `row` to `bottom` - 1, which lie on one side of the corners `one` and `two`. */
static inline void paint_rows(soft_state *state, const soft_corner *alone, const soft_corner *one,
                              const soft_corner *two, int32_t row, int32_t bottom)
{
    for (; row < bottom; row++) {
        soft_run run;
        if (soft_run_of_row(state, alone, one, two, row, VALUES, &run))
            paint(state, (uint32_t)(row * state->width + run.from), &run);
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
    soft_corner top, bend, foot;
    take(&top, a);
    take(&bend, b);
    take(&foot, c);
    if (middle > bottom) middle = bottom;
    paint_rows(state, &top, &bend, &foot, row, middle);
    paint_rows(state, &foot, &bend, &top, middle > row ? middle : row, bottom);
    return 1;
}
