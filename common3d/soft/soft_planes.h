/* Planes of w and of attributes times w over the screen, and the rows of a triangle that lies
 * partly beyond its sides. */
#ifndef SOFT_PLANES_H
#define SOFT_PLANES_H

#include "soft_edge.h"

#define SOFT_PLANES  (SOFT_ATTRIBUTES + 1)
#define SOFT_PLANE_W SOFT_ATTRIBUTES

/* A value over the screen: at the frame's first pixel, its change from column to column and from
 * row to row. */
typedef struct soft_plane {
    uint32_t origin, across, down;
} soft_plane;
typedef struct soft_planes {
    int first, last; /* attributes in use; w always is */
    int w_shift;     /* takes w from the planes' scale to Q30 */
    int linear;      /* 1: colours stand in Q16, not times w: nothing is divided */
    soft_plane of[SOFT_PLANES];
} soft_planes;

static inline uint32_t soft_plane_at(const soft_plane *plane, int32_t row, int32_t column)
{
    return plane->origin + plane->down * (uint32_t)row + plane->across * (uint32_t)column;
}

/* 2^59 / (w * 2^*lead), with *lead such that the product takes 31 bits. w is 1 .. 2^31 - 1; for
 * other w the result means nothing. */
static inline int32_t soft_one_over_w(const soft_state *state, uint32_t w, int *lead)
{
    *lead = soft_leading_zeros(w << 1 | 1);
    uint32_t n = w << *lead;
    /* 2^29 when exact */
    int32_t first = (int32_t)state->reciprocal[(n >> 21) & 511],
            error = soft_high((int32_t)n, first);
    return soft_high((int32_t)((UINT32_C(1) << 31) - 2 * (uint32_t)error), first);
}

/* An attribute times w, divided by w: Q16, even. What lies beyond +-2^28 wraps. */
static inline int32_t soft_quotient(uint32_t part, int32_t reciprocal, int lead)
{
    return 2 * soft_high((int32_t)(part << lead), reciprocal);
}

/* A change over `pixels` pixels, per pixel. Rounding loses less than 1/65536 of the change. */
static inline int32_t soft_per_pixel(const soft_state *state, int32_t change, int pixels)
{
    C3D_ASSERT(pixels >= 0 && pixels < SOFT_EDGE_TABLE);
    return pixels ? 2 * soft_high(change, state->edge_reciprocal[pixels]) : 0;
}

static inline uint32_t soft_depth_of(uint32_t w, int w_shift)
{
    C3D_ASSERT(w_shift >= 0 && w_shift < 30);
    return (int32_t)w < 2 << w_shift ? 2 : w >> w_shift;
}

/* This row lies beyond the left (to <= 0) or the right side of the frame. Returns how many rows
 * after it do so, too: an edge is straight up to the next bend, so what holds at both ends of a
 * number of rows holds between. */
static inline int32_t soft_rows_beyond(const soft_state *state, const soft_walk *walk, int32_t to)
{
    soft_edge edge = to <= 0 ? walk->right : walk->left;
    int32_t rest = (walk->row < walk->middle && walk->middle < walk->end ? walk->middle
                                                                         : walk->end) -
                   walk->row - 1,
            rows = 0;
    for (int32_t step = 64; step >= 4; step /= 2)
        while (rows + step <= rest) {
            soft_edge next = { edge.at + edge.step * step, edge.step };
            int32_t pixel = soft_edge_pixel(&next);
            if (to <= 0 ? pixel > 0 : pixel < state->width) break;
            edge = next;
            rows += step;
        }
    C3D_ASSERT(rows >= 0 && rows <= rest);
    return rows;
}

static inline void soft_skip_rows(soft_walk *walk, int32_t rows)
{
    C3D_ASSERT(rows >= 0 && walk->row + rows < walk->end);
    walk->row += rows;
    walk->left.at += walk->left.step * rows;
    walk->right.at += walk->right.step * rows;
}

/* Goes on, from this row, to the first row that has pixels in the frame; 0 when there is none.
 * `painted` says that earlier rows had some. */
static inline int soft_walk_to_pixels(const soft_state *state, soft_walk *walk, int painted)
{
    do {
        int32_t from = soft_edge_pixel(&walk->left), to = soft_edge_pixel(&walk->right);
        if (to <= 0 || from >= state->width) {
            if (painted) return 0; /* once left, the frame is never entered again */
            soft_skip_rows(walk, soft_rows_beyond(state, walk, to));
            continue;
        }
        if (from < 0) from = 0;
        if (to > state->width) to = state->width;
        if (state->paint.depth == SOFT_DEPTH_UNCOVERED) {
            if (from < state->open_from[walk->row]) from = state->open_from[walk->row];
            if (to > state->open_to[walk->row]) to = state->open_to[walk->row];
        }
        C3D_ASSERT(walk->row < state->height && from >= 0 && to <= state->width);
        walk->from = from;
        walk->to = to;
        if (from < to) return 1;
    } while (soft_walk_next(state, walk));
    return 0;
}

/* soft_perspective.c: makes the planes of the attributes first .. last through three vertices, with
 * what they are multiplied with, `w`; y grows from vertex to vertex. Their values at a pixel. */
void soft_make_planes(const soft_state *state, soft_planes *planes,
                      const soft_vertex *const vertex[3], const uint32_t w[3], int64_t area,
                      int32_t row);
void soft_attributes_at(const soft_state *state, const soft_planes *planes, int32_t row,
                        int32_t column, int32_t out[SOFT_ATTRIBUTES]);
/* soft_perspective.c: 1 when colours may be interpolated linearly over the whole triangle, because
 * that is off by at most 4/255, half a step of red in RGB565. */
int soft_colours_are_linear(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c);
/* soft_perspective.c: draws a row, divided at the ends of segments. */
void soft_segments(soft_state *state, const soft_planes *planes, const soft_walk *walk);
/* soft_texture_rows.c: draws a triangle under a texture alone, from the walk's row on. */
void soft_texture_rows(soft_state *state, const soft_planes *planes, soft_walk *walk);

#endif
