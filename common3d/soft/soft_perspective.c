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
    int fog;                         /* else the whole triangle is clear of it */
    uint64_t value[PLANES];          /* at the row's first pixel, then at the segment's */
    uint64_t across[PLANES], down[PLANES]; /* from pixel to pixel; all wraps: at pixels inside it is right again */
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

static int log2_of(uint64_t n) /* n > 0 */
{
    return n >> 32 ? 63 - soft_leading_zeros((uint32_t)(n >> 32)) : 31 - soft_leading_zeros((uint32_t)n);
}

/* 1/area as a mantissa of 31 bits, 2^60 / (area scaled into bits 30..), and its exponent: a division costs hundreds of instructions. */
typedef struct quotient { int32_t mantissa; int exponent; } quotient;

static quotient one_over(const soft_state *state, int64_t area)
{
    int64_t size = area < 0 ? -area : area;
    int lead = 30 - log2_of((uint64_t)size);
    int32_t mantissa = (int32_t)(soft_fine_reciprocal(state, (uint32_t)soft_scale64(size, lead)) >> 1);
    return (quotient){area < 0 ? -mantissa : mantissa, lead - 60};
}

/* value/area: value in 31 bits and an exponent, times that of 1/area; 2^-28 of it is the error. */
static int64_t over_area(int64_t value, quotient per_area)
{
    if (value == 0) return 0;
    int down = log2_of((uint64_t)(value < 0 ? -value : value)) - 30;
    int shift = down + per_area.exponent;
    int64_t product = soft_scale64(value, -down) * per_area.mantissa;
    return shift <= -63 ? 0 : soft_scale64(product, shift);
}

/* Through three points; at the centre of the frame's first pixel in `row`. */
static void make_planes(const soft_state *state, soft_planes *planes, const soft_vertex *const vertex[3], int64_t area, int32_t row)
{
    int64_t value[3][PLANES];
    int plain = state->paint.texture && state->paint.white; /* the texture's colours only */
    quotient per_area = one_over(state, area);
    int64_t dx1 = vertex[1]->x - vertex[0]->x, dy1 = vertex[1]->y - vertex[0]->y;
    int64_t dx2 = vertex[2]->x - vertex[0]->x, dy2 = vertex[2]->y - vertex[0]->y;
    planes->fog = state->paint.fog && (vertex[0]->fog_q8 < 256 || vertex[1]->fog_q8 < 256 || vertex[2]->fog_q8 < 256);
    for (int i = 0; i < 3; i++) vertex_values(vertex[i], value[i]);
    for (int i = 0; i < PLANES; i++)
        planes->used[i] = i == PLANE_W || (i <= SOFT_T ? state->paint.texture != NULL : i <= SOFT_B ? !plain : planes->fog);
    for (int i = 0; i < PLANES; i++) {
        if (!planes->used[i]) continue;
        int64_t d1 = value[1][i] - value[0][i], d2 = value[2][i] - value[0][i];
        uint64_t across = (uint64_t)over_area(d2 * dy1 - d1 * dy2, per_area), down = (uint64_t)over_area(d1 * dx2 - d2 * dx1, per_area);
        planes->value[i] = (uint64_t)value[0][i] + across * (uint64_t)(int64_t)(SOFT_HALF - vertex[0]->x) +
                           down * (uint64_t)(int64_t)(row * SOFT_ONE + SOFT_HALF - vertex[0]->y);
        planes->across[i] = across * SOFT_ONE;
        planes->down[i] = down * SOFT_ONE;
    }
}

/* Attributes `pixels` to the right of the segment's first pixel: each plane divided by that of w. Below 2^28, Q16. */
static void divide(const soft_state *state, const soft_planes *planes, int pixels, int32_t value[SOFT_ATTRIBUTES])
{
    int64_t w = (int64_t)(planes->value[PLANE_W] + planes->across[PLANE_W] * (uint64_t)pixels);
    if (w < 1) w = 1;
    int lead = log2_of((uint64_t)w);
    uint32_t r = soft_reciprocal(state, (uint32_t)soft_scale64(w, 30 - lead));
    for (int i = 0; i < SOFT_ATTRIBUTES; i++) {
        if (!planes->used[i]) {
            value[i] = 0;
            continue;
        }
        int64_t part = (int64_t)(planes->value[i] + planes->across[i] * (uint64_t)pixels);
        part = soft_scale64(part > w ? w : part < -w ? -w : part, 30 - lead);
        value[i] = (int32_t)((part * r) >> 33);
    }
}

/* 65536/n, rounded down: what is lost is below 1/65536 of the change over the segment. */
static int32_t per_pixel(int32_t change, int pixels)
{
    static const int32_t part[SEGMENT_MAX] = {0, 65536, 32768, 21845, 16384, 13107, 10922, 9362, 8192, 7281, 6553, 5957, 5461, 5041, 4681, 4369};
    return pixels == SEGMENT_MAX ? change >> 4 : (int32_t)(((int64_t)change * part[pixels]) >> 16);
}

static void paint_segment(soft_state *state, const soft_planes *planes, uint32_t first, int count, const int32_t from[SOFT_ATTRIBUTES],
                          const int32_t to[SOFT_ATTRIBUTES], int apart)
{
    soft_segment segment = {.first = first, .count = (uint32_t)count,
                            .w = (uint32_t)(planes->value[PLANE_W] >> 12), .dw = (uint32_t)(planes->across[PLANE_W] >> 12)};
    if ((int64_t)planes->value[PLANE_W] < 2 * 4096) segment.w = 2;
    for (int i = 0; i < SOFT_ATTRIBUTES; i++) {
        segment.value[i] = from[i];
        segment.step[i] = per_pixel(to[i] - from[i], apart);
    }
    if (!planes->fog) segment.value[SOFT_F] = 256 << 10;
    segment.value[SOFT_F] *= 64;
    segment.step[SOFT_F] *= 64;
    if (planes->fog)
        soft_segment_paint(state, &segment);
    else
        state->span(state, &segment);
}

static void paint_row(soft_state *state, const soft_planes *row_planes, const soft_walk *walk)
{
    soft_planes planes = *row_planes;
    int32_t from[SOFT_ATTRIBUTES], to[SOFT_ATTRIBUTES];
    for (int i = 0; i < PLANES; i++)
        if (planes.used[i]) planes.value[i] += planes.across[i] * (uint64_t)walk->from;
    divide(state, &planes, 0, from);
    for (int32_t x = walk->from; x < walk->to;) {
        int64_t change = (int64_t)planes.across[PLANE_W] >> 8, here = (int64_t)planes.value[PLANE_W] >> 16; /* of 256 pixels */
        int length = change < here && -change < here ? SEGMENT_MAX : SEGMENT_MAX / 2;
        int last = walk->to - x <= length, count = last ? walk->to - x : length;
        int apart = last ? count - 1 : length; /* the last segment ends on a pixel of the triangle */
        divide(state, &planes, apart, to);
        paint_segment(state, &planes, (uint32_t)(walk->row * state->width + x), count, from, to, apart);
        for (int i = 0; i < PLANES; i++)
            if (planes.used[i]) planes.value[i] += planes.across[i] * (uint64_t)length;
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
    make_planes(state, &planes, vertex, area, walk.row);
    do {
        soft_walk_row(state, &walk);
        if (walk.from < walk.to) paint_row(state, &planes, &walk);
        for (int i = 0; i < PLANES; i++)
            if (planes.used[i]) planes.value[i] += planes.down[i];
    } while (soft_walk_next(state, &walk));
}
