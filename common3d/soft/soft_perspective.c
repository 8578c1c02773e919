/* Any triangle, perspective-correct: planes of w and of every attribute times w, divided at the
 * ends of segments.
 *
 * Slopes are computed in 64 bits. w stands in Q42. An attribute (Q16, below 2^28) times w (Q14)
 * stands in Q30. Differences of two values are below 2^43 for both; times 2^17 sixteenths of a
 * pixel, and two such products added, they stay below 2^62. Then all is shifted down so that the
 * nearest w takes 30 bits: over 2^9 pixels, and for depths up to 2^10 times the nearest, rounding
 * moves the quotient by less than 2^-11. Values may wrap: at pixels inside the triangle they are
 * right again. */
#include "soft_planes.h"

#define DIFFERENCE_MAX ((int64_t)1 << 44)
#define SEGMENT_MAX    64 /* pixels */

FF_STATIC_ASSERT(SEGMENT_MAX < SOFT_EDGE_TABLE);
static void vertex_values(const soft_vertex *vertex, int64_t w, const soft_planes *planes,
                          int64_t value[SOFT_PLANES])
{
    C3D_ASSERT(w > 0 && w < 1 << 30);
    C3D_ASSERT(vertex->fog_q8 >= -(1 << 14) && vertex->fog_q8 <= 1 << 14);
    value[SOFT_PLANE_W] = w * 4096;
    for (int i = 0; planes->linear && i < 3; i++) value[SOFT_R + i] = vertex->rgba[i] * 65536;
    if (planes->linear) return;
    C3D_ASSERT(planes->first != SOFT_S || (vertex->s > -(1 << 28) && vertex->s < 1 << 28));
    C3D_ASSERT(planes->first != SOFT_S || (vertex->t > -(1 << 28) && vertex->t < 1 << 28));
    value[SOFT_S] = (vertex->s * w) >> 16;
    value[SOFT_T] = (vertex->t * w) >> 16;
    if (planes->last == SOFT_T) return;
    for (int i = 0; i < 3; i++) value[SOFT_R + i] = vertex->rgba[i] * w;
    value[SOFT_F] = (vertex->fog_q8 * w) >> 6; /* Q10: within 2^24 */
}

/* 1/area as a mantissa of 31 bits, 2^60 / (area scaled into bits 30..), and its exponent: a
 * division costs hundreds of instructions. */
typedef struct quotient {
    int32_t mantissa;
    int exponent;
} quotient;

static quotient one_over(const soft_state *state, int64_t area)
{
    int64_t size = area < 0 ? -area : area;
    int lead = 30 - soft_log2((uint64_t)size);
    C3D_ASSERT(size < (int64_t)1 << 35); /* two products of 17 bits each way */
    int32_t mantissa = (int32_t)(soft_fine_reciprocal(state, (uint32_t)soft_scale64(size, lead)) >>
                                 1);
    return (quotient){ area < 0 ? -mantissa : mantissa, lead - 60 };
}

/* value/area, off by at most 2^-28 of itself: the value as 31 bits and an exponent, times 1/area.
 */
static int64_t over_area(int64_t value, quotient per_area)
{
    if (value == 0) return 0;
    int down = soft_log2((uint64_t)(value < 0 ? -value : value)) - 30;
    C3D_ASSERT(down <= 62 - 30);
    int shift = down + per_area.exponent;
    int64_t product = (int64_t)(int32_t)soft_scale64(value, -down) * per_area.mantissa;
    return shift <= -63 ? 0 : soft_scale64(product, shift);
}

static uint32_t scaled(uint64_t value, int down)
{
    return (uint32_t)soft_scale64((int64_t)value, -down);
}

/* Makes the planes through three vertices: those that `planes` says are in use, shifted by `down`.
 */
static void make_planes(const soft_state *state, soft_planes *planes,
                        const soft_vertex *const vertex[3], const uint32_t w[3], int64_t area,
                        int32_t row, int down)
{
    int64_t value[3][SOFT_PLANES];
    quotient per_area = one_over(state, area);
    int64_t dx1 = vertex[1]->x - vertex[0]->x, dy1 = vertex[1]->y - vertex[0]->y;
    int64_t dx2 = vertex[2]->x - vertex[0]->x, dy2 = vertex[2]->y - vertex[0]->y;
    C3D_ASSERT(dx1 > -(1 << 17) && dx1 < 1 << 17 && dx2 > -(1 << 17) && dx2 < 1 << 17);
    C3D_ASSERT(dy1 >= 0 && dy1 <= dy2 && dy2 < 1 << 17);
    uint64_t to_x = (uint64_t)(int64_t)(SOFT_HALF - vertex[0]->x),
             to_y = (uint64_t)(int64_t)(row * SOFT_ONE + SOFT_HALF - vertex[0]->y);
    for (int i = 0; i < 3; i++) vertex_values(vertex[i], w[i], planes, value[i]);
    for (int i = planes->first; i < SOFT_PLANES; i++) {
        int64_t d1 = value[1][i] - value[0][i], d2 = value[2][i] - value[0][i];
        C3D_ASSERT(d1 > -DIFFERENCE_MAX && d1 < DIFFERENCE_MAX);
        C3D_ASSERT(d2 > -DIFFERENCE_MAX && d2 < DIFFERENCE_MAX);
        uint64_t across = (uint64_t)over_area(d2 * dy1 - d1 * dy2, per_area),
                 below = (uint64_t)over_area(d1 * dx2 - d2 * dx1, per_area);
        int shift = planes->linear && i != SOFT_PLANE_W ? 0 : down;
        soft_plane *plane = &planes->of[i];
        plane->across = scaled(across * SOFT_ONE, shift);
        plane->down = scaled(below * SOFT_ONE, shift);
        plane->origin = scaled((uint64_t)value[0][i] + across * to_x + below * to_y, shift) -
                        plane->down * (uint32_t)row;
        if (i == planes->last) i = SOFT_PLANE_W - 1;
    }
}

/* The shift that brings the largest w to 30 bits, from Q42. */
static int down_of(const uint32_t w[3])
{
    uint32_t most = w[0] > w[1] ? w[0] : w[1];
    if (w[2] > most) most = w[2];
    C3D_ASSERT(most < UINT32_C(1) << 30);
    return 12 + 2 - soft_leading_zeros(most);
}

void soft_make_planes(const soft_state *state, soft_planes *planes,
                      const soft_vertex *const vertex[3], const uint32_t w[3], int64_t area,
                      int32_t row)
{
    int down = down_of(w);
    planes->w_shift = 12 - down;
    make_planes(state, planes, vertex, w, area, row, down);
}

/* With r = nearest w / farthest w it is off by (r - 1)/4 of the colours' largest difference. */
int soft_colours_are_linear(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    uint32_t near = a->w > b->w ? a->w : b->w, far = a->w < b->w ? a->w : b->w;
    if (c->w > near) near = c->w;
    if (c->w < far) far = c->w;
    int range = 0;
    for (int i = 0; i < 3; i++) {
        int low = a->rgba[i] < b->rgba[i] ? a->rgba[i] : b->rgba[i],
            high = a->rgba[i] + b->rgba[i] - low;
        if (c->rgba[i] < low) low = c->rgba[i];
        if (c->rgba[i] > high) high = c->rgba[i];
        if (high - low > range) range = high - low;
    }
    C3D_ASSERT(range >= 0 && range <= 255 && far <= near);
    return (uint64_t)(near - far) * (uint32_t)range <= (uint64_t)far * 16;
}

/* Says which attributes are interpolated. */
static void set_up(const soft_state *state, soft_planes *planes, const soft_vertex *a,
                   const soft_vertex *b, const soft_vertex *c)
{
    const soft_paint *paint = &state->paint;
    int fog = paint->fog && (a->fog_q8 < 256 || b->fog_q8 < 256 || c->fog_q8 < 256);
    planes->first = paint->texture ? SOFT_S : SOFT_R;
    planes->last = fog ? SOFT_F : paint->texture && paint->white ? SOFT_T : SOFT_B;
    planes->linear = planes->last == SOFT_B && !paint->texture && soft_colours_are_linear(a, b, c);
    C3D_ASSERT(planes->first <= planes->last && planes->last < SOFT_PLANE_W);
}

/* Attributes from the planes' values at a pixel: each attribute times w, divided by w. Q16, below
 * 2^28. */
static void divide(const soft_state *state, const soft_planes *planes,
                   const uint32_t value[SOFT_PLANES], int32_t out[SOFT_ATTRIBUTES])
{
    int lead;
    int32_t w = (int32_t)value[SOFT_PLANE_W] < 1 ? 1 : (int32_t)value[SOFT_PLANE_W],
            reciprocal = soft_one_over_w(state, (uint32_t)w, &lead);
    for (int i = planes->first; i <= planes->last; i++) {
        int32_t part = (int32_t)value[i];
        out[i] = soft_quotient((uint32_t)(part > w ? w : part < -w ? -w : part), reciprocal, lead);
        C3D_ASSERT(out[i] >= -(1 << 28) && out[i] <= 1 << 28);
    }
}

void soft_attributes_at(const soft_state *state, const soft_planes *planes, int32_t row,
                        int32_t column, int32_t out[SOFT_ATTRIBUTES])
{
    uint32_t value[SOFT_PLANES];
    for (int i = planes->first; i <= planes->last; i++)
        value[i] = soft_plane_at(&planes->of[i], row, column);
    value[SOFT_PLANE_W] = soft_plane_at(&planes->of[SOFT_PLANE_W], row, column);
    divide(state, planes, value, out);
}

/* The number of pixels after which to divide again. Linear interpolation over them is off by
 * (change of w)/w * (change of the attribute)/4: by at most a quarter of a texel where a pixel is
 * as large as a texel, and by at most 1/16 of the change of a colour. */
static int segment_length(const soft_state *state, int32_t w, int32_t across)
{
    int64_t change = across < 0 ? -(int64_t)across : across;
    C3D_ASSERT(change <= INT64_MAX >> 12);
    if (!state->paint.texture) return change * 256 < w ? SEGMENT_MAX : change * 64 < w ? 16 : 8;
    return change * 4096 < w ? SEGMENT_MAX : change * 1024 < w ? 32 : change * 256 < w ? 16 : 8;
}

static void paint_segment(soft_state *state, const soft_planes *planes,
                          const int32_t from[SOFT_ATTRIBUTES], const int32_t to[SOFT_ATTRIBUTES],
                          int apart)
{
    soft_segment *segment = &state->segment;
    C3D_ASSERT(apart >= 0 && apart <= SEGMENT_MAX && apart <= (int)segment->count);
    for (int i = planes->first; i <= planes->last; i++) {
        segment->value[i] = from[i];
        segment->step[i] = soft_per_pixel(state, to[i] - from[i], apart);
    }
    if (planes->last == SOFT_F) {
        segment->value[SOFT_F] *= 64;
        segment->step[SOFT_F] *= 64;
        soft_segment_paint(state, segment);
    } else {
        state->span(state, segment);
    }
}

void soft_segments(soft_state *state, const soft_planes *planes, const soft_walk *walk)
{
    uint32_t value[SOFT_PLANES], w_across = planes->of[SOFT_PLANE_W].across;
    int32_t attribute[2][SOFT_ATTRIBUTES], left = walk->to - walk->from;
    C3D_ASSERT(left > 0);
    int now = 0;
    for (int i = planes->first; i <= planes->last; i++)
        value[i] = soft_plane_at(&planes->of[i], walk->row, walk->from);
    value[SOFT_PLANE_W] = soft_plane_at(&planes->of[SOFT_PLANE_W], walk->row, walk->from);
    state->segment.first = (uint32_t)(walk->row * state->width + walk->from);
    divide(state, planes, value, attribute[0]);
    while (left > 0) {
        int length = segment_length(state, (int32_t)value[SOFT_PLANE_W], (int32_t)w_across);
        /* the last segment ends on a pixel of the triangle */
        int last = left <= length, apart = last ? left - 1 : length;
        state->segment.w = soft_depth_of(value[SOFT_PLANE_W], planes->w_shift);
        state->segment.count = (uint32_t)(last ? left : length);
        for (int i = planes->first; i <= planes->last; i++)
            value[i] += planes->of[i].across * (uint32_t)apart;
        value[SOFT_PLANE_W] += w_across * (uint32_t)apart;
        divide(state, planes, value, attribute[now ^ 1]);
        paint_segment(state, planes, attribute[now], attribute[now ^ 1], apart);
        state->segment.first += state->segment.count;
        left -= length;
        now ^= 1;
    }
    C3D_ASSERT(state->segment.first == (uint32_t)(walk->row * state->width + walk->to));
}

static void linear_row(soft_state *state, const soft_planes *planes, const soft_walk *walk)
{
    C3D_ASSERT(planes->linear && walk->from < walk->to);
    soft_segment *segment = &state->segment;
    segment->first = (uint32_t)(walk->row * state->width + walk->from);
    segment->count = (uint32_t)(walk->to - walk->from);
    segment->w = soft_depth_of(soft_plane_at(&planes->of[SOFT_PLANE_W], walk->row, walk->from),
                               planes->w_shift);
    for (int i = SOFT_R; i <= SOFT_B; i++) {
        segment->value[i] = (int32_t)soft_plane_at(&planes->of[i], walk->row, walk->from);
        segment->step[i] = (int32_t)planes->of[i].across;
    }
    state->span(state, segment);
}

void soft_perspective(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c, int64_t area)
{
    C3D_ASSERT(area != 0);
    const soft_vertex *const vertex[3] = { a, b, c };
    soft_walk walk;
    soft_planes planes;
    if (!soft_walk_begin(state, &walk, a, b, c, area > 0)) return;
    if (state->paint.depth == SOFT_DEPTH_UNCOVERED && walk.end > state->open_end)
        walk.end = state->open_end;
    if (walk.row >= walk.end || !soft_walk_to_pixels(state, &walk, 0)) return;
    const uint32_t w[3] = { a->w, b->w, c->w };
    set_up(state, &planes, a, b, c);
    soft_make_planes(state, &planes, vertex, w, area, walk.row);
    state->segment.dw = (uint32_t)((int32_t)planes.of[SOFT_PLANE_W].across >> planes.w_shift);
    state->segment.value[SOFT_F] = 256 << 16; /* clear */
    state->segment.step[SOFT_F] = 0;
    if (walk.row < state->top_row) state->top_row = walk.row;
    if (planes.last == SOFT_T) {
        soft_texture_rows(state, &planes, &walk);
        return;
    }
    do {
        if (planes.linear)
            linear_row(state, &planes, &walk);
        else
            soft_segments(state, &planes, &walk);
    } while (soft_walk_next(state, &walk) && soft_walk_to_pixels(state, &walk, 1));
}
