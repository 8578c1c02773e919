/* Any triangle, perspective-correct: planes of w and of every attribute times w in 64 bits, divided at the ends of segments.
 *
 * w: Q42 (below 2^43). An attribute in Q16 below 2^28 times w, Q14: below 2^43 too. Differences of two, times 2^17 sixteenths, two of
 * these: below 2^62. A plane's slope is rounded to 1 of 2^42 a sixteenth: 2^16 of them are off by 2^-26 of the nearest w. */
#include "soft_edge.h"

#define SEGMENT_MAX 16
#define PLANES (SOFT_ATTRIBUTES + 1)
#define PLANE_W SOFT_ATTRIBUTES

typedef struct soft_planes {
    int used[PLANES];
    int64_t value[PLANES];          /* at the row's first pixel, then at the segment's */
    int64_t across[PLANES], down[PLANES]; /* from pixel to pixel */
} soft_planes;

static void vertex_values(const soft_vertex *vertex, int64_t value[PLANES])
{
    int64_t w = vertex->w;
    int32_t attribute[SOFT_ATTRIBUTES];
    attribute[SOFT_S] = vertex->s;
    attribute[SOFT_T] = vertex->t;
    for (int i = 0; i < 3; i++) attribute[SOFT_R + i] = vertex->rgba[i] << 16;
    attribute[SOFT_F] = vertex->fog_q8 * 65536 / 64; /* Q10 of Q8: within 2^24 */
    for (int i = 0; i < SOFT_ATTRIBUTES; i++) value[i] = (attribute[i] * w) >> 16;
    value[PLANE_W] = w * 4096;
}

/* Through three points; at the centre of the frame's first pixel in `row`. */
static void make_planes(soft_planes *planes, const soft_paint *paint, const soft_vertex *const vertex[3], int64_t area, int32_t row)
{
    int64_t value[3][PLANES];
    int64_t dx1 = vertex[1]->x - vertex[0]->x, dy1 = vertex[1]->y - vertex[0]->y;
    int64_t dx2 = vertex[2]->x - vertex[0]->x, dy2 = vertex[2]->y - vertex[0]->y;
    for (int i = 0; i < 3; i++) vertex_values(vertex[i], value[i]);
    for (int i = 0; i < PLANES; i++)
        planes->used[i] = i == PLANE_W || (i <= SOFT_T ? paint->texture != NULL : i <= SOFT_B ? 1 : paint->fog);
    for (int i = 0; i < PLANES; i++) {
        if (!planes->used[i]) continue;
        int64_t d1 = value[1][i] - value[0][i], d2 = value[2][i] - value[0][i];
        int64_t across = (d2 * dy1 - d1 * dy2) / area, down = (d1 * dx2 - d2 * dx1) / area;
        planes->value[i] = value[0][i] + across * (SOFT_HALF - vertex[0]->x) + down * (row * SOFT_ONE + SOFT_HALF - vertex[0]->y);
        planes->across[i] = across * SOFT_ONE;
        planes->down[i] = down * SOFT_ONE;
    }
}

/* Attributes `pixels` to the right of the segment's first pixel: each plane divided by that of w. Below 2^28, Q16. */
static void divide(const soft_state *state, const soft_planes *planes, int pixels, int32_t value[SOFT_ATTRIBUTES])
{
    int64_t w = planes->value[PLANE_W] + planes->across[PLANE_W] * pixels;
    if (w < 1) w = 1;
    int lead = w >> 32 ? 32 + (31 - soft_leading_zeros((uint32_t)(w >> 32))) : 31 - soft_leading_zeros((uint32_t)w);
    uint32_t r = soft_reciprocal(state, (uint32_t)soft_scale64(w, 30 - lead));
    for (int i = 0; i < SOFT_ATTRIBUTES; i++) {
        if (!planes->used[i]) {
            value[i] = 0;
            continue;
        }
        int64_t part = soft_scale64(planes->value[i] + planes->across[i] * pixels, 30 - lead);
        part = part > INT32_MAX ? INT32_MAX : part < -INT32_MAX ? -INT32_MAX : part;
        value[i] = (int32_t)((part * r) >> 33);
    }
}

static void paint_segment(soft_state *state, const soft_planes *planes, uint32_t first, int count, const int32_t from[SOFT_ATTRIBUTES],
                          const int32_t to[SOFT_ATTRIBUTES], int apart)
{
    soft_segment segment = {.first = first, .count = (uint32_t)count,
                            .w = (uint32_t)(planes->value[PLANE_W] >> 12), .dw = (uint32_t)(planes->across[PLANE_W] >> 12)};
    if (planes->value[PLANE_W] < 2 * 4096) segment.w = 2;
    for (int i = 0; i < SOFT_ATTRIBUTES; i++) {
        segment.value[i] = from[i];
        segment.step[i] = apart > 0 ? (to[i] - from[i]) / apart : 0;
    }
    segment.value[SOFT_F] *= 64;
    segment.step[SOFT_F] *= 64;
    soft_segment_paint(state, &segment);
}

static void paint_row(soft_state *state, const soft_planes *row_planes, const soft_walk *walk)
{
    soft_planes planes = *row_planes;
    int32_t from[SOFT_ATTRIBUTES], to[SOFT_ATTRIBUTES];
    for (int i = 0; i < PLANES; i++)
        if (planes.used[i]) planes.value[i] += planes.across[i] * walk->from;
    divide(state, &planes, 0, from);
    for (int32_t x = walk->from; x < walk->to;) {
        int64_t change = planes.across[PLANE_W] * SEGMENT_MAX * 16;
        int length = change < planes.value[PLANE_W] && -change < planes.value[PLANE_W] ? SEGMENT_MAX : SEGMENT_MAX / 2;
        int last = walk->to - x <= length, count = last ? walk->to - x : length;
        int apart = last ? count - 1 : length; /* the last segment ends on a pixel of the triangle */
        divide(state, &planes, apart, to);
        paint_segment(state, &planes, (uint32_t)(walk->row * state->width + x), count, from, to, apart);
        for (int i = 0; i < PLANES; i++)
            if (planes.used[i]) planes.value[i] += planes.across[i] * length;
        for (int i = 0; i < SOFT_ATTRIBUTES; i++) from[i] = to[i];
        x += count;
    }
}

void soft_perspective(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c, int64_t area)
{
    const soft_vertex *const vertex[3] = {a, b, c};
    soft_walk walk;
    soft_planes planes;
    if (!soft_walk_begin(state, &walk, a, b, c, area > 0)) return;
    make_planes(&planes, &state->paint, vertex, area, walk.row);
    do {
        soft_walk_row(state, &walk);
        if (walk.from < walk.to) paint_row(state, &planes, &walk);
        for (int i = 0; i < PLANES; i++)
            if (planes.used[i]) planes.value[i] += planes.down[i];
    } while (soft_walk_next(state, &walk));
}
