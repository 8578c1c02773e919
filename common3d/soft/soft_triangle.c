/* Strips to triangles, and what can be said of a triangle before its pixels. */
#include "soft_edge.h"

/* Twice the area, Q8, positive when b lies left of the edge from a to c (y grows downwards). */
static int64_t area_of(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    return (int64_t)(c->x - a->x) * (b->y - a->y) - (int64_t)(b->x - a->x) * (c->y - a->y);
}

void soft_triangle(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                   const soft_vertex *c)
{
    C3D_ASSERT(!((a->out | b->out | c->out) & SOFT_MUST_CLIP));
    const soft_vertex *swap;
    if (b->y < a->y) swap = a, a = b, b = swap;
    if (c->y < b->y) swap = b, b = c, c = swap;
    if (b->y < a->y) swap = a, a = b, b = swap;
    if (soft_first_row(a->y) == soft_first_row(c->y)) return; /* between two rows of centres */
    int32_t left = a->x < b->x ? a->x : b->x, right = a->x < b->x ? b->x : a->x;
    if (c->x < left) left = c->x;
    if (c->x > right) right = c->x;
    if (soft_first_row(left) == soft_first_row(right)) return; /* between two columns of centres */
    if (soft_small(state, a, b, c)) return;
    int64_t area = area_of(a, b, c);
    if (area != 0) soft_perspective(state, a, b, c, area);
}

static inline void draw(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                        const soft_vertex *c)
{
    uint32_t any = a->out | b->out | c->out;
    if (a->out & b->out & c->out) return;
    if (any & SOFT_MUST_CLIP)
        soft_clip(state, a, b, c);
    else if (!(state->tiny_rows && soft_tiny(state, a, b, c)) &&
             !(state->tiny_colours && soft_tiny_colours(state, a, b, c)))
        soft_triangle(state, a, b, c);
}

void soft_strip(soft_state *state, const uint16_t *indices, uint32_t count)
{
    C3D_ASSERT(count >= 3);
    const soft_vertex *vertices = state->vertices, *a, *b = &vertices[indices[0]],
                      *c = &vertices[indices[1]];
    int32_t row_a, row_b = soft_first_row(b->y), row_c = soft_first_row(c->y);
    for (uint32_t i = 2; i < count; i++) {
        a = b, b = c, c = &vertices[indices[i]];
        row_a = row_b, row_b = row_c, row_c = soft_first_row(c->y);
        /* between two rows of centres: a third of a terrain's triangles */
        if (row_a == row_b && row_b == row_c) continue;
        if (a == b || b == c || a == c) continue;
        draw(state, a, b, c);
    }
}
