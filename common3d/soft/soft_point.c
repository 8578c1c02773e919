/* Points: squares of pixels round the vertex, of its depth and colour. */
#include "soft_local.h"

/* First of `size` pixels round a place: the pixel it lies in, or those round the nearest corner. */
static int32_t first_pixel(int32_t at_q4, int32_t size)
{
    return (at_q4 - (size - 1) * SOFT_HALF) >> SOFT_SUB;
}

static void draw_point(soft_state *state, const soft_vertex *vertex, int32_t size)
{
    int32_t left = first_pixel(vertex->x, size), top = first_pixel(vertex->y, size),
            right = left + size, bottom = top + size;
    left = left < 0 ? 0 : left;
    top = top < 0 ? 0 : top;
    right = right < state->width ? right : state->width;
    bottom = bottom < state->height ? bottom : state->height;
    if (left >= right) return;
    state->top_row = top < state->top_row ? top : state->top_row;
    soft_segment segment = { .count = (uint32_t)(right - left), .w = vertex->w };
    for (int i = 0; i < 3; i++) segment.value[SOFT_R + i] = vertex->rgba[i] << 16;
    segment.value[SOFT_F] = vertex->fog_q8 * 65536;
    for (int32_t row = top; row < bottom; row++) {
        segment.first = (uint32_t)(row * state->width + left);
        soft_segment_paint(state, &segment);
    }
}

/* A GL, too, leaves out what lies with its middle outside the picture. */
static int is_inside(const soft_state *state, const soft_vertex *vertex)
{
    return !(vertex->out & SOFT_MUST_CLIP) && vertex->x >= 0 && vertex->y >= 0 &&
           vertex->x < state->width * SOFT_ONE && vertex->y < state->height * SOFT_ONE;
}

void soft_points(soft_state *state, uint32_t count, int32_t size_px)
{
    for (uint32_t i = 0; i < count; i++)
        if (is_inside(state, &state->vertices[i])) draw_point(state, &state->vertices[i], size_px);
}
