/* Triangles of a few rows under a projector, edge to edge as in soft_tiny.c: most of those that a
 * picture is thrown on. Their own colours, which are seen where it is open, are interpolated
 * linearly, however much w changes. */
#include "soft_meet.h"
#include "soft_ramp.h"
#include "soft_thrown_texels.h"

#define TEXELS_MAX 64 /* between two corners */
#define W_RANGE    (1 << 25)

/* What is interpolated: w, the texel's place, and the mesh's own colours where they may be seen. */
enum { W, S, T, PICTURE_VALUES, RED = PICTURE_VALUES, GREEN, BLUE, VALUES };
FF_STATIC_ASSERT(VALUES <= SOFT_MEET_VALUES);

/* differences of differences, times the 32 of paint_row */
FF_STATIC_ASSERT(2 * TEXELS_MAX * 65536 <= (1 << 28) / 32 && 2 * (1 << 24) * 32 <= 1 << 30);
FF_STATIC_ASSERT((int64_t)W_RANGE * 32 <= INT32_MAX);
FF_STATIC_ASSERT(TEXELS_MAX + 4 <= 256); /* packed */

/* The part of the texture that a triangle can reach. */
typedef struct part {
    const uint16_t *texels;
    uint32_t stride;
    int32_t s, t; /* of its first texel */
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
static SOFT_INLINE void paint(soft_state *state, const part *picture, uint32_t first,
                              const soft_run *run, const int coloured)
{
    const int32_t *value = run->value, *step = run->step, count = run->count;
    C3D_ASSERT(soft_in_frame(state, first, (uint32_t)count));
    C3D_ASSERT(value[S] >= 0 && value[T] >= 0 && value[S] < 255 << 16 && value[T] < 255 << 16);
    uint32_t over = state->paint.alpha_test, stride = picture->stride, w = (uint32_t)value[W],
             dw = (uint32_t)step[W], st = packed(value[S], value[T]),
             dst = packed(step[S], step[T]), bias = over ? soft_thrown_bias(w, (int32_t)dw) : 0,
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
        } else if (coloured) {
            int32_t at = count - (int32_t)(end - depth);
            *pixel = soft_colour_565(value[RED] + step[RED] * at, value[GREEN] + step[GREEN] * at,
                                     value[BLUE] + step[BLUE] * at);
        } else {
            continue;
        }
        if (w > *depth) *depth = w;
    }
}

/* Rows from `row` to `bottom` - 1, which lie on one side of the corners `one` and `two`. */
static SOFT_INLINE void paint_rows(soft_state *state, const part *picture, const soft_corner *alone,
                                   const soft_corner *one, const soft_corner *two, int32_t row,
                                   int32_t bottom, const int coloured)
{
    for (; row < bottom; row++) {
        soft_run run;
        if (soft_run_of_row(state, alone, one, two, row, coloured ? VALUES : PICTURE_VALUES, &run))
            paint(state, picture, (uint32_t)(row * state->width + run.from), &run, coloured);
    }
}

/* 1 when a triangle's differences are small enough. */
static int is_tiny(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    return soft_first_row(c->y) - soft_first_row(a->y) <= SOFT_MEET_ROWS &&
           soft_size_of(b->x - a->x) < SOFT_MEET_REACH_Q4 &&
           soft_size_of(c->x - a->x) < SOFT_MEET_REACH_Q4 &&
           range_of((int32_t)a->w, (int32_t)b->w, (int32_t)c->w) < W_RANGE &&
           range_of(a->s, b->s, c->s) < TEXELS_MAX << 16 &&
           range_of(a->t, b->t, c->t) < TEXELS_MAX << 16;
}

static part find_part(const soft_texture *texture, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c)
{
    /* one texel before the least, which rounding may miss: the rim at the outside */
    int32_t column = (least_of(a->s, b->s, c->s) >> 16) - 1,
            row = (least_of(a->t, b->t, c->t) >> 16) - 1;
    C3D_ASSERT(column >= -1 && row >= -1);
    const uint16_t *texels = (const uint16_t *)(const void *)texture->texels;
    return (part){ texels + (row + 1) * texture->stride + column + 1, texture->stride,
                   column * 65536, row * 65536 };
}

static SOFT_INLINE void take(soft_corner *new, const soft_vertex *vertex, const part *picture,
                             const int coloured)
{
    new->at = vertex;
    new->value[W] = (int32_t)vertex->w;
    new->value[S] = vertex->s - picture->s;
    new->value[T] = vertex->t - picture->t;
    if (coloured) soft_take_colours(new->value + RED, vertex->rgba);
}

static SOFT_INLINE void draw(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                             const soft_vertex *c, const int coloured)
{
    int32_t row = soft_first_row(a->y), middle = soft_first_row(b->y),
            bottom = soft_first_row(c->y);
    part picture = find_part(state->paint.texture, a, b, c);
    soft_corner top, bend, foot;
    if (row < 0) row = 0;
    if (bottom > state->height) bottom = state->height;
    if (row >= bottom) return;
    if (row < state->top_row) state->top_row = row;
    take(&top, a, &picture, coloured);
    take(&bend, b, &picture, coloured);
    take(&foot, c, &picture, coloured);
    if (middle > bottom) middle = bottom;
    paint_rows(state, &picture, &top, &bend, &foot, row, middle, coloured);
    paint_rows(state, &picture, &foot, &bend, &top, middle > row ? middle : row, bottom, coloured);
}

int soft_thrown_tiny(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                     const soft_vertex *c)
{
    C3D_ASSERT(!state->wide && a->y <= b->y && b->y <= c->y);
    if (!is_tiny(a, b, c)) return 0;
    if (state->paint.alpha_test)
        draw(state, a, b, c, 0);
    else
        draw(state, a, b, c, 1);
    return 1;
}
