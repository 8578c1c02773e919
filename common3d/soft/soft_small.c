/* Triangles small enough that linear interpolation shows no difference. 32-bit throughout.
 *
 * Within 128 pixels each way, differences of coordinates are below 2^11 (Q4), of attributes below
 * 2^18 (64 texels in Q12; colours in Q10), of w below 2^19 after a shift. So a numerator, two
 * products, is below 2^31. The area is below 2^23; a slope is a numerator times the reciprocal of
 * the area, in 64 bits. Values are stepped in 32 bits and may wrap: at pixels inside the triangle
 * they are right again. */
#include "soft_edge.h"
#include "soft_sample.h"

#define SIZE_MAX_Q4  2048
#define TEXELS_MAX   (63 << 16)
#define AREA_MIN     64 /* an eighth of a pixel */
#define COLOUR_RANGE 32
#define FOG_MAX      256
#define PLAIN_PIXELS 8 /* in shorter rows every pixel is sampled */
#define W            SOFT_ATTRIBUTES

/* differences of coordinates below 2^11, of attributes below 2^18 before they are multiplied */
FF_STATIC_ASSERT(SIZE_MAX_Q4 == 128 * SOFT_ONE && SIZE_MAX_Q4 <= 1 << 11);
FF_STATIC_ASSERT(TEXELS_MAX >> 4 < 1 << 18 && 255 * 1024 < 1 << 18 && FOG_MAX * 16 < 1 << 18);
FF_STATIC_ASSERT(TEXELS_MAX >> 13 < 1 << 9 && COLOUR_RANGE < 1 << 9); /* is_flat */

typedef struct soft_slopes {
    int32_t across[SOFT_ATTRIBUTES + 1], down[SOFT_ATTRIBUTES + 1]; /* from pixel to pixel */
    uint32_t at[SOFT_ATTRIBUTES + 1]; /* at the first pixel of the frame in this row */
} soft_slopes;

typedef struct soft_shape {
    const soft_vertex *a, *b, *c;
    int32_t dx1, dy1, dx2, dy2;
    int32_t reciprocal, shift; /* 16/area = reciprocal / 2^(32 + shift), signed */
    /* from a to the centre of the frame's first pixel in the first row, Q4 */
    int32_t to_x, to_y;
} soft_shape;

static int32_t larger(int32_t a, int32_t b)
{
    a = a < 0 ? -a : a;
    b = b < 0 ? -b : b;
    return a > b ? a : b;
}

/* The largest difference of w: a negative one, too, has 19 bits after it is shifted down by 4. */
#define STEP_MAX ((1 << 23) - 16)

/* The slope per pixel, 16 * n / area, of a numerator n. */
static inline int32_t slope(const soft_shape *shape, int32_t n)
{
    return (int32_t)(((int64_t)n * shape->reciprocal) >> 32) >> shape->shift;
}

/* Makes the slopes of attribute i from its value at a and its differences d1 = b - a, d2 = c - a,
 * which were shifted down by `lift` bits. */
static inline void attribute(const soft_shape *shape, soft_slopes *slopes, int i, int32_t value,
                             int32_t d1, int32_t d2, int lift)
{
    C3D_ASSERT(larger(d1, d2) < 1 << 19); /* times 2^11, twice: below 2^31 */
    int32_t across = (int32_t)((uint32_t)slope(shape, d2 * shape->dy1 - d1 * shape->dy2) << lift);
    int32_t down = (int32_t)((uint32_t)slope(shape, d1 * shape->dx2 - d2 * shape->dx1) << lift);
    slopes->across[i] = across;
    slopes->down[i] = down;
    slopes->at[i] = (uint32_t)value +
                    (uint32_t)(((int64_t)across * shape->to_x + (int64_t)down * shape->to_y) >>
                               SOFT_SUB);
}

/* 1 when linear interpolation is good enough: it is off by at most (r - 1)/4 of an attribute's
 * range, with r = greatest w / least w. Texels of a thrown texture change with another weight:
 * soft_thrown_strip.c has looked at them. */
static int is_flat(const soft_state *state, const soft_shape *shape, int32_t dw)
{
    C3D_ASSERT(dw >= 0 && dw < 1 << 30);
    const soft_vertex *a = shape->a, *b = shape->b, *c = shape->c;
    uint32_t least = a->w < b->w ? a->w : b->w;
    int32_t range = 0;
    if (c->w < least) least = c->w;
    if (dw > STEP_MAX) return 0;
    if (state->paint.texture) {
        int32_t texels = larger(larger(b->s - a->s, c->s - a->s), larger(b->t - a->t, c->t - a->t));
        if (texels > TEXELS_MAX) return 0;
        if (!state->paint.thrown) range = texels >> 13;
    }
    if ((!state->paint.texture || !state->paint.white || state->paint.fog) && range < COLOUR_RANGE)
        range = COLOUR_RANGE;
    C3D_ASSERT(range >= 0 && range < 1 << 9); /* times 2^20 */
    return (uint32_t)(dw >> 3) * (uint32_t)range <= least;
}

static void colour_slopes(const soft_shape *shape, soft_slopes *slopes)
{
    for (int i = 0; i < 3; i++) {
        int32_t value = shape->a->rgba[i] << 16;
        attribute(shape, slopes, SOFT_R + i, value, (shape->b->rgba[i] - shape->a->rgba[i]) * 1024,
                  (shape->c->rgba[i] - shape->a->rgba[i]) * 1024, 6);
    }
}

static void make_slopes(const soft_state *state, const soft_shape *shape, soft_slopes *slopes,
                        int32_t dw, int fog)
{
    C3D_ASSERT(dw < 1 << 23);
    const soft_vertex *a = shape->a, *b = shape->b, *c = shape->c;
    int lift = dw < 1 << 19 ? 0 : 4;
    attribute(shape, slopes, W, (int32_t)a->w, ((int32_t)b->w - (int32_t)a->w) >> lift,
              ((int32_t)c->w - (int32_t)a->w) >> lift, lift);
    if (state->paint.texture) {
        attribute(shape, slopes, SOFT_S, a->s, (b->s - a->s) >> 4, (c->s - a->s) >> 4, 4);
        attribute(shape, slopes, SOFT_T, a->t, (b->t - a->t) >> 4, (c->t - a->t) >> 4, 4);
    }
    if (!state->paint.texture || !state->paint.white || fog) colour_slopes(shape, slopes);
    if (fog)
        attribute(shape, slopes, SOFT_F, a->fog_q8 * 65536, (b->fog_q8 - a->fog_q8) * 16,
                  (c->fog_q8 - a->fog_q8) * 16, 12);
}

/* Draws a triangle under a texture alone, as small triangles of the terrain are: everything in one
 * function, because it is drawn so often. Long rows may be magnified. */
static void texture_rows(soft_state *state, soft_walk *walk, soft_slopes *slopes)
{
    C3D_ASSERT(!state->off_texture && state->paint.white);
    soft_segment *segment = &state->segment;
    uint32_t w = slopes->at[W], s = slopes->at[SOFT_S], t = slopes->at[SOFT_T];
    uint32_t dw = (uint32_t)slopes->across[W], ds = (uint32_t)slopes->across[SOFT_S],
             dt = (uint32_t)slopes->across[SOFT_T];
    uint32_t plain = soft_sample_spacing((int32_t)ds, (int32_t)dt) ? PLAIN_PIXELS : UINT32_MAX;
    segment->dw = dw, segment->step[SOFT_S] = (int32_t)ds, segment->step[SOFT_T] = (int32_t)dt;
    do {
        soft_walk_row(state, walk);
        if (walk->from < walk->to) {
            uint32_t from = (uint32_t)walk->from;
            segment->first = (uint32_t)walk->row * state->width + from,
            segment->count = (uint32_t)walk->to - from;
            segment->w = w + dw * from, segment->value[SOFT_S] = (int32_t)(s + ds * from),
            segment->value[SOFT_T] = (int32_t)(t + dt * from);
            if (segment->count < plain)
                soft_sample_row(state, segment);
            else
                state->span(state, segment);
        }
        w += (uint32_t)slopes->down[W];
        s += (uint32_t)slopes->down[SOFT_S];
        t += (uint32_t)slopes->down[SOFT_T];
    } while (soft_walk_next(state, walk));
}

static void paint_rows(soft_state *state, soft_walk *walk, soft_slopes *slopes, int first, int last)
{
    C3D_ASSERT(first <= last && last <= SOFT_F);
    soft_segment *segment = &state->segment;
    void (*span)(soft_state *, const soft_segment *) = last == SOFT_F ? soft_segment_paint
                                                                      : state->span;
    segment->dw = (uint32_t)slopes->across[W];
    for (int i = first; i <= last; i++) segment->step[i] = slopes->across[i];
    do {
        soft_walk_row(state, walk);
        if (walk->from < walk->to) {
            uint32_t from = (uint32_t)walk->from;
            segment->first = (uint32_t)walk->row * state->width + from;
            segment->count = (uint32_t)walk->to - from;
            segment->w = slopes->at[W] + (uint32_t)slopes->across[W] * from;
            for (int i = first; i <= last; i++)
                segment->value[i] = (int32_t)(slopes->at[i] + (uint32_t)slopes->across[i] * from);
            span(state, segment);
        }
        slopes->at[W] += (uint32_t)slopes->down[W];
        for (int i = first; i <= last; i++) slopes->at[i] += (uint32_t)slopes->down[i];
    } while (soft_walk_next(state, walk));
}

static void measure(const soft_state *state, soft_shape *shape, int32_t area, int32_t row)
{
    uint32_t size = (uint32_t)(area < 0 ? -area : area);
    C3D_ASSERT(size >= AREA_MIN && size < 1 << 23);
    int lead = soft_leading_zeros(size) - 1;
    int32_t reciprocal = (int32_t)(soft_reciprocal(state, size << lead) >> 1);
    shape->reciprocal = area < 0 ? -reciprocal : reciprocal;
    shape->shift = 60 - 32 - lead - SOFT_SUB;
    C3D_ASSERT(shape->shift >= 0);
    shape->to_x = SOFT_HALF - shape->a->x;
    shape->to_y = row * SOFT_ONE + SOFT_HALF - shape->a->y;
}

/* 1 for a sliver. Across a width below half of 1/16 pixel slopes would exceed 32 bits: so slivers
 * have none, and take the attributes of a. */
static int is_sliver(const soft_shape *shape, int32_t area)
{
    C3D_ASSERT(area != 0);
    int32_t size = area < 0 ? -area : area,
            length = larger(larger(shape->dx1, shape->dx2), shape->dy2);
    return size < AREA_MIN || size < length / 2;
}

static int32_t largest_step(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    return larger(larger((int32_t)b->w - (int32_t)a->w, (int32_t)c->w - (int32_t)a->w),
                  (int32_t)c->w - (int32_t)b->w);
}

int soft_small(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    soft_shape shape = { .a = a,
                         .b = b,
                         .c = c,
                         .dx1 = b->x - a->x,
                         .dy1 = b->y - a->y,
                         .dx2 = c->x - a->x,
                         .dy2 = c->y - a->y };
    const soft_paint *paint = &state->paint;
    int fog = paint->fog && (a->fog_q8 < 256 || b->fog_q8 < 256 || c->fog_q8 < 256),
        textured = paint->texture != NULL;
    int32_t dw = largest_step(a, b, c);
    soft_walk walk;
    soft_slopes slopes;
    if (shape.dy2 >= SIZE_MAX_Q4 || larger(shape.dx1, shape.dx2) >= SIZE_MAX_Q4 ||
        !is_flat(state, &shape, dw))
        return 0;
    if (fog && larger(b->fog_q8 - a->fog_q8, c->fog_q8 - a->fog_q8) > FOG_MAX) return 0;
    C3D_ASSERT(shape.dy1 >= 0 && shape.dy1 <= shape.dy2);
    int32_t area = shape.dx2 * shape.dy1 - shape.dx1 * shape.dy2;
    if (area == 0 || !soft_walk_begin(state, &walk, a, b, c, area > 0)) return 1;
    if (walk.row < state->top_row) state->top_row = walk.row;
    if (is_sliver(&shape, area))
        shape.reciprocal = shape.shift = shape.to_x = shape.to_y = 0;
    else
        measure(state, &shape, area, walk.row);
    make_slopes(state, &shape, &slopes, dw, fog);
    state->segment.value[SOFT_F] = 256 << 16; /* clear */
    state->segment.step[SOFT_F] = 0;
    if (!fog && state->texture_rows)
        texture_rows(state, &walk, &slopes);
    else
        paint_rows(state, &walk, &slopes, textured ? SOFT_S : SOFT_R,
                   fog                        ? SOFT_F
                   : textured && paint->white ? SOFT_T
                                              : SOFT_B);
    return 1;
}
