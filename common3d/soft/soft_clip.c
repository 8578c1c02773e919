/* Clipping in eye space, for the few triangles that cross the near or the far plane or reach out of the guard band.
 * A new vertex is always computed from the inner end of its edge to the outer one: triangles that share the edge get the same. */
#include "soft_local.h"

enum { PLANES = 6, CORNERS_MAX = 3 + PLANES };

/* Inside is positive. |x| * focal_q8 < 2^30 * 2^31; guard: 4000 * 256 * 2^30 < 2^51. */
static int64_t distance(const soft_state *state, const soft_vertex *vertex, int plane)
{
    const int32_t *eye = vertex->eye;
    int64_t wide = (int64_t)eye[2] * (SOFT_GUARD_CLIP_PX * 256);
    switch (plane) {
    case 0: return (int64_t)eye[2] - state->space.near_eye;
    case 1: return (int64_t)state->space.far_eye - eye[2];
    case 2: return wide - (int64_t)eye[0] * state->frame.camera.focal_q8;
    case 3: return wide + (int64_t)eye[0] * state->frame.camera.focal_q8;
    case 4: return wide - (int64_t)eye[1] * state->frame.camera.focal_q8;
    default: return wide + (int64_t)eye[1] * state->frame.camera.focal_q8;
    }
}

static int32_t between(int32_t inner, int32_t outer, int32_t part_q30)
{
    return inner + (int32_t)((((int64_t)outer - inner) * part_q30) >> 30);
}

/* The point of the edge on the plane: as far from `inner` as its distance is of the sum of both. */
static void cut(const soft_state *state, int plane, const soft_vertex *inner, const soft_vertex *outer, soft_vertex *at)
{
    int64_t part = distance(state, inner, plane), whole = part - distance(state, outer, plane);
    while (whole >= INT32_MAX) {
        whole >>= 1;
        part >>= 1;
    }
    int32_t p = (int32_t)(part * ((int64_t)1 << 30) / whole); /* the one division */
    for (int i = 0; i < 3; i++) at->eye[i] = between(inner->eye[i], outer->eye[i], p);
    if (plane == 0) at->eye[2] = state->space.near_eye;
    if (plane == 1) at->eye[2] = state->space.far_eye;
    at->s = between(inner->s, outer->s, p);
    at->t = between(inner->t, outer->t, p);
    at->fog_q8 = between(inner->fog_q8, outer->fog_q8, p);
    for (int i = 0; i < 4; i++) at->rgba[i] = (uint8_t)between(inner->rgba[i], outer->rgba[i], p);
    soft_project(state, at);
}

static int clip_plane(const soft_state *state, int plane, const soft_vertex *in, int count, soft_vertex *out)
{
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const soft_vertex *here = &in[i], *next = &in[i + 1 < count ? i + 1 : 0];
        int inside = distance(state, here, plane) >= 0, next_inside = distance(state, next, plane) >= 0;
        if (inside) out[kept++] = *here;
        if (inside && !next_inside) cut(state, plane, here, next, &out[kept++]);
        if (!inside && next_inside) cut(state, plane, next, here, &out[kept++]);
    }
    return kept;
}

static int64_t area_of(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    return (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
}

/* A fan from the first corner. Rounding may fold a flat corner over: what turns the other way than most of it is left out. */
static void draw_fan(soft_state *state, const soft_vertex *corner, int count)
{
    int64_t all = 0;
    for (int i = 2; i < count; i++) all += area_of(&corner[0], &corner[i - 1], &corner[i]);
    for (int i = 2; i < count; i++) {
        int64_t area = area_of(&corner[0], &corner[i - 1], &corner[i]);
        if (all > 0 ? area > 0 : area < 0) soft_triangle(state, &corner[0], &corner[i - 1], &corner[i]);
    }
}

void soft_clip(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    soft_vertex corner[2][CORNERS_MAX] = {{*a, *b, *c}};
    int count = 3, from = 0;
    for (int plane = 0; plane < PLANES && count >= 3; plane++, from ^= 1)
        count = clip_plane(state, plane, corner[from], count, corner[from ^ 1]);
    if (count >= 3) draw_fan(state, corner[from], count);
}

int soft_clip_line(soft_state *state, soft_vertex *a, soft_vertex *b)
{
    for (int plane = 0; plane < PLANES; plane++) {
        int a_inside = distance(state, a, plane) >= 0, b_inside = distance(state, b, plane) >= 0;
        soft_vertex at = *a;
        if (!a_inside && !b_inside) return 0;
        if (a_inside && !b_inside) {
            cut(state, plane, a, b, &at);
            *b = at;
        } else if (!a_inside && b_inside) {
            cut(state, plane, b, a, &at);
            *a = at;
        }
    }
    return 1;
}
