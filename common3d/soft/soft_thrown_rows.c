/* Triangles under a projector, rows and pixels. s and t are divided by the plane of c * w, colours
 * and fog by that of w, as without a projector; depths are those of every pixel's own place. */
#include "soft_planes.h"
#include "soft_ramp.h"
#include "soft_thrown_texels.h"

#define SEGMENT_MAX 64 /* pixels */

typedef struct thrown_planes {
    soft_planes picture, own; /* s, t and c * w; the rest and w */
} thrown_planes;

/* c * w, so that the largest has 29 bits. */
static void weigh(const soft_vertex *const vertex[3], uint32_t weight[3])
{
    uint64_t product[3], any = 0;
    for (int i = 0; i < 3; i++) {
        product[i] = (uint64_t)(uint32_t)vertex[i]->c * vertex[i]->w;
        any |= product[i];
    }
    int shift = soft_log2(any) - 28;
    for (int i = 0; i < 3; i++) {
        weight[i] = (uint32_t)soft_scale64((int64_t)product[i], -shift);
        if (!weight[i]) weight[i] = 1;
    }
}

static void make_planes(const soft_state *state, thrown_planes *planes,
                        const soft_vertex *const vertex[3], int64_t area, int32_t row)
{
    uint32_t w[3], weight[3];
    int fog = 0;
    for (int i = 0; i < 3; i++) {
        w[i] = vertex[i]->w;
        fog |= state->paint.fog && vertex[i]->fog_q8 < 256;
    }
    weigh(vertex, weight);
    planes->picture.first = SOFT_S;
    planes->picture.last = SOFT_T;
    planes->picture.linear = 0;
    planes->own.first = SOFT_R;
    planes->own.last = fog ? SOFT_F : SOFT_B;
    planes->own.linear = !fog && soft_colours_are_linear(vertex[0], vertex[1], vertex[2]);
    soft_make_planes(state, &planes->picture, vertex, weight, area, row);
    soft_make_planes(state, &planes->own, vertex, w, area, row);
}

/* The number of pixels after which to divide again; see soft_perspective.c. */
static int segment_length(const thrown_planes *planes, int32_t row, int32_t column)
{
    const soft_plane *weight = &planes->picture.of[SOFT_PLANE_W],
                     *w = &planes->own.of[SOFT_PLANE_W];
    int64_t whole = (int32_t)soft_plane_at(weight, row, column), part = (int32_t)weight->across;
    part = part < 0 ? -part : part;
    int length = part * 4096 < whole   ? SEGMENT_MAX
                 : part * 1024 < whole ? 32
                 : part * 256 < whole  ? 16
                                       : 8;
    whole = (int32_t)soft_plane_at(w, row, column), part = (int32_t)w->across;
    part = part < 0 ? -part : part;
    int of_colours = part * 256 < whole ? SEGMENT_MAX : part * 64 < whole ? 16 : 8;
    return length < of_colours ? length : of_colours;
}

static void attributes_at(const soft_state *state, const thrown_planes *planes, int32_t row,
                          int32_t column, int32_t out[SOFT_ATTRIBUTES])
{
    soft_attributes_at(state, &planes->picture, row, column, out);
    if (!planes->own.linear && (!state->paint.white || planes->own.last == SOFT_F))
        soft_attributes_at(state, &planes->own, row, column, out);
}

static void paint_segment(soft_state *state, const soft_planes *own,
                          const int32_t from[SOFT_ATTRIBUTES], const int32_t to[SOFT_ATTRIBUTES],
                          int apart)
{
    soft_segment *segment = &state->segment;
    int last = own->last;
    if (own->linear || (state->paint.white && last != SOFT_F)) last = SOFT_T;
    for (int i = SOFT_S; i <= last; i++) {
        segment->value[i] = from[i];
        segment->step[i] = soft_per_pixel(state, to[i] - from[i], apart);
    }
    if (last == SOFT_F) {
        segment->value[SOFT_F] *= 64;
        segment->step[SOFT_F] *= 64;
        soft_segment_paint(state, segment);
    } else {
        state->span(state, segment);
    }
}

static void draw_row(soft_state *state, const thrown_planes *planes, const soft_walk *walk)
{
    soft_segment *segment = &state->segment;
    int32_t attribute[2][SOFT_ATTRIBUTES], at = walk->from;
    int now = 0;
    attributes_at(state, planes, walk->row, at, attribute[0]);
    while (at < walk->to) {
        int length = segment_length(planes, walk->row, at), left = walk->to - at;
        /* the last segment ends on a pixel of the triangle */
        int apart = left <= length ? left - 1 : length;
        segment->first = (uint32_t)(walk->row * state->width + at);
        segment->count = (uint32_t)(left <= length ? left : length);
        segment->w = soft_plane_at(&planes->own.of[SOFT_PLANE_W], walk->row, at);
        attributes_at(state, planes, walk->row, at + apart, attribute[now ^ 1]);
        for (int i = SOFT_R; planes->own.linear && i <= SOFT_B; i++) {
            segment->value[i] = (int32_t)soft_plane_at(&planes->own.of[i], walk->row, at);
            segment->step[i] = (int32_t)planes->own.of[i].across;
        }
        paint_segment(state, &planes->own, attribute[now], attribute[now ^ 1], apart);
        at += length;
        now ^= 1;
    }
}

void soft_thrown_rows(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c, int64_t area)
{
    C3D_ASSERT(area != 0 && state->paint.depth == SOFT_DEPTH_TEST);
    const soft_vertex *const vertex[3] = { a, b, c };
    soft_walk walk;
    thrown_planes planes;
    if (!soft_walk_begin(state, &walk, a, b, c, area > 0)) return;
    if (!soft_walk_to_pixels(state, &walk, 0)) return;
    make_planes(state, &planes, vertex, area, walk.row);
    state->segment.dw = planes.own.of[SOFT_PLANE_W].across;
    state->segment.w_shift = planes.own.w_shift;
    state->segment.value[SOFT_F] = 256 << 16; /* clear */
    state->segment.step[SOFT_F] = 0;
    if (walk.row < state->top_row) state->top_row = walk.row;
    do {
        draw_row(state, &planes, &walk);
    } while (soft_walk_next(state, &walk) && soft_walk_to_pixels(state, &walk, 1));
    state->segment.w_shift = 0;
}

/* ---- pixels, of RGBA5551 into RGB565 ---- */

/* The colour that the mesh has by itself at a pixel of a segment. */
static uint16_t own_colour(const soft_segment *segment, int32_t at)
{
    soft_ramp ramp;
    soft_make_ramp(&ramp, segment);
    return soft_colour_565(ramp.red + ramp.dr * at, ramp.green + ramp.dg * at,
                           ramp.blue + ramp.db * at);
}

/* 1 on the texture and its rim; beyond them all is open. */
static inline int is_on(const soft_texture *texture, int32_t s, int32_t t)
{
    return (uint32_t)s + 65536 < ((uint32_t)texture->width + 1) << 16 &&
           (uint32_t)t + 65536 < ((uint32_t)texture->height + 1) << 16;
}

/* An inner loop. `all_on`: every pixel lies on the texture and its rim. */
static SOFT_INLINE void span(soft_state *state, const soft_segment *segment, const int all_on)
{
    const soft_texture *texture = state->paint.texture;
    const uint16_t *texels = (const uint16_t *)(const void *)texture->texels + texture->stride + 1;
    int32_t stride = texture->stride, s = segment->value[SOFT_S], t = segment->value[SOFT_T];
    int32_t ds = segment->step[SOFT_S], dt = segment->step[SOFT_T];
    int shift = segment->w_shift, over = state->paint.alpha_test;
    uint32_t w = segment->w, dw = segment->dw,
             bias = over ? soft_thrown_bias(w >> shift, (int32_t)dw >> shift) : 0;
    uint32_t through = soft_thrown_of_32(&state->paint);
    uint32_t *first = state->depth + segment->first, *depth = first, *end = first + segment->count;
    uint16_t *pixel = (uint16_t *)(void *)state->colour + segment->first;
    for (; depth < end; depth++, pixel++, w += dw, s += ds, t += dt) {
        uint32_t here = w >> shift, x = (uint32_t)s >> 11 & 31, y = (uint32_t)t >> 11 & 31;
        if (here + bias < *depth) continue;
        const uint16_t *texel = all_on || is_on(texture, s, t)
                                    ? texels + (t >> 16) * stride + (s >> 16)
                                    : NULL;
        if (texel && soft_thrown_opaque(texel, (uint32_t)stride, x, y)) {
            uint16_t colour = soft_thrown_blend(texel, (uint32_t)stride, x, y);
            *pixel = through ? soft_thrown_through(*pixel, colour, through) : colour;
        } else if (!over)
            *pixel = own_colour(segment, (int32_t)(depth - first));
        else
            continue;
        if (here > *depth) *depth = here;
    }
}

void soft_span_thrown(soft_state *state, const soft_segment *segment)
{
    C3D_ASSERT(soft_in_frame(state, segment->first, segment->count) && !state->wide);
    C3D_ASSERT(state->paint.texture->format == C3D_RGBA5551);
    if (!state->off_texture || soft_on_texture(state->paint.texture, segment))
        span(state, segment, 1);
    else
        span(state, segment, 0);
}
