/* Clipping in eye space, for the few triangles that cross the near or the far plane or reach out of
 * the guard band. A new vertex is always computed from the inner end of its edge towards the outer
 * end: so triangles that share the edge get the same vertex. */
#include "soft_local.h"

enum {
    NEAR_PLANE,
    FAR_PLANE,
    GUARD_PLANES,
    SCREEN_PLANES = 6,
    BEHIND_PLANE = SCREEN_PLANES, /* of a projector, and the edges of its picture */
    PICTURE_PLANES,
    PLANES = 11,
    CORNERS_MAX = 3 + PLANES
};

typedef struct corner {
    soft_vertex at;
    int32_t eye[3], sum[3]; /* sum: a, b, c under a projector */
} corner;

/* The same for the planes of a thrown picture: its outermost texels are beyond them. */
static int64_t within_picture(const soft_state *state, const corner *from, int plane)
{
    const soft_texture *texture = state->paint.texture;
    if (plane == BEHIND_PLANE) return (int64_t)from->sum[2] - SOFT_THROWN_C;
    int axis = (plane - PICTURE_PLANES) >> 1;
    int64_t size = 2 * (int64_t)(axis ? texture->height : texture->width),
            at = size * from->sum[axis]; /* 2^13 * 2^30 */
    return (plane - PICTURE_PLANES) & 1 ? (size - 1) * from->sum[2] - at : at - from->sum[2];
}

/* A measure of a corner's distance from a plane, positive inside. */
static int64_t distance(const soft_state *state, const corner *from, int plane)
{
    const int32_t *eye = from->eye;
    if (plane >= SCREEN_PLANES) return within_picture(state, from, plane);
    if (plane == NEAR_PLANE) return (int64_t)eye[2] - state->space.near_eye;
    if (plane == FAR_PLANE) return (int64_t)state->space.far_eye - eye[2];
    int64_t wide = (int64_t)eye[2] * (SOFT_GUARD_CLIP_PX * SOFT_ONE),
            side = soft_scale64(eye[(plane - GUARD_PLANES) >> 1], 27 - state->view.focal_shift);
    return plane & 1 ? wide + side : wide - side; /* 2^30 * 2^16, 2^30 * 2^27 */
}

static int32_t between(int32_t inner, int32_t outer, int32_t part_q30)
{
    C3D_ASSERT(part_q30 >= 0 && part_q30 <= 1 << 30);
    C3D_ASSERT((int64_t)outer - inner <= INT32_MAX && (int64_t)outer - inner >= -INT32_MAX);
    return inner + (int32_t)(((int64_t)(outer - inner) * part_q30) >> 30);
}

/* part/whole, Q30. */
static int32_t part_q30(const soft_state *state, int64_t part, int64_t whole)
{
    C3D_ASSERT(whole > 0 && part >= 0 && part <= whole);
    while (whole >= INT32_MAX) {
        whole >>= 1;
        part >>= 1;
    }
    int lead = soft_leading_zeros((uint32_t)whole) - 1;
    /* below 2^(31 - lead) * 2^31 */
    uint64_t part_q61 = (uint64_t)part * soft_fine_reciprocal(state, (uint32_t)whole << lead);
    uint32_t q30 = (uint32_t)(part_q61 >> (31 - lead));
    return (int32_t)(q30 < UINT32_C(1) << 30 ? q30 : UINT32_C(1) << 30);
}

/* Makes the corner where an edge crosses a plane: d_inner / (d_inner + d_outer) of the way from
 * `inner` to `outer`, with d their distances from the plane. */
static void cut(const soft_state *state, int plane, const corner *inner, const corner *outer,
                corner *new)
{
    int64_t part = distance(state, inner, plane);
    int32_t p = part_q30(state, part, part - distance(state, outer, plane));
    for (int i = 0; i < 3; i++) new->eye[i] = between(inner->eye[i], outer->eye[i], p);
    if (plane == NEAR_PLANE) new->eye[2] = state->space.near_eye;
    if (plane == FAR_PLANE) new->eye[2] = state->space.far_eye;
    new->at.s = between(inner->at.s, outer->at.s, p);
    new->at.t = between(inner->at.t, outer->at.t, p);
    if (state->paint.thrown) {
        for (int i = 0; i < 3; i++) new->sum[i] = between(inner->sum[i], outer->sum[i], p);
        soft_throw_vertex(state, new->sum, &new->at);
    }
    new->at.fog_q8 = (int16_t)between(inner->at.fog_q8, outer->at.fog_q8, p);
    for (int i = 0; i < 4; i++)
        new->at.rgba[i] = (uint8_t)between(inner->at.rgba[i], outer->at.rgba[i], p);
    soft_project(state, new->eye, &new->at);
    C3D_ASSERT(plane == NEAR_PLANE || !(new->at.out &SOFT_NEAR));
}

static void take(const soft_state *state, const soft_vertex *vertex, corner *new)
{
    new->at = *vertex;
    soft_eye(state, vertex, new->eye);
    if (state->paint.thrown) soft_thrown_sums(state, vertex, new->sum);
}

static int clip_plane(const soft_state *state, int plane, const corner *in, int count, corner *out)
{
    C3D_ASSERT(count >= 3 && count < CORNERS_MAX);
    int kept = 0, inside = distance(state, &in[0], plane) >= 0;
    for (int i = 0; i < count; i++) {
        const corner *here = &in[i], *next = &in[i + 1 < count ? i + 1 : 0];
        int next_inside = distance(state, next, plane) >= 0;
        if (inside) out[kept++] = *here;
        if (inside && !next_inside) cut(state, plane, here, next, &out[kept++]);
        if (!inside && next_inside) cut(state, plane, next, here, &out[kept++]);
        inside = next_inside;
    }
    C3D_ASSERT(kept <= count + 1); /* a plane cuts a convex polygon twice at most */
    return kept;
}

/* The bits of `out` that some corner has; *all receives those that every corner has. */
static uint32_t out_of(const corner *in, int count, uint32_t *all)
{
    C3D_ASSERT(count >= 3 && count <= CORNERS_MAX);
    uint32_t some = *all = in[0].at.out;
    for (int i = 1; i < count; i++) {
        some |= in[i].at.out;
        *all &= in[i].at.out;
    }
    return some;
}

/* 1 when some corner lies beyond the plane. A corner behind the near plane has no other bit: it
 * gets its other bits when it is cut there. */
static int beyond(uint32_t out, int plane)
{
    C3D_ASSERT(plane >= 0 && plane < SCREEN_PLANES);
    return (out & (plane == NEAR_PLANE  ? SOFT_NEAR
                   : plane == FAR_PLANE ? SOFT_FAR
                                        : SOFT_GUARD)) != 0;
}

static int64_t area_of(const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    return (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
}

/* Draws the corners as a fan from the first one. Rounding may fold a flat corner over: triangles
 * that turn the other way than the whole are left out. */
static void draw_fan(soft_state *state, const corner *in, int count)
{
    C3D_ASSERT(count >= 3 && count <= CORNERS_MAX);
    for (int i = 0; i < count; i++) C3D_ASSERT(!(in[i].at.out & SOFT_MUST_CLIP));
    int64_t all = 0;
    for (int i = 2; i < count; i++) all += area_of(&in[0].at, &in[i - 1].at, &in[i].at);
    for (int i = 2; i < count; i++) {
        int64_t area = area_of(&in[0].at, &in[i - 1].at, &in[i].at);
        if (all > 0 ? area > 0 : area < 0)
            (state->paint.thrown ? soft_thrown_triangle : soft_triangle)(state, &in[0].at,
                                                                         &in[i - 1].at, &in[i].at);
    }
}

static void clip(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                 const soft_vertex *c, int planes)
{
    corner corners[2][CORNERS_MAX], *now = corners[0], *then = corners[1];
    int count = 3;
    uint32_t all, some = a->out | b->out | c->out;
    take(state, a, &now[0]);
    take(state, b, &now[1]);
    take(state, c, &now[2]);
    for (int plane = 0; plane < planes; plane++) {
        if (plane < SCREEN_PLANES && !beyond(some, plane)) continue;
        count = clip_plane(state, plane, now, count, then);
        if (count < 3) return;
        some = out_of(then, count, &all);
        if (all) return; /* beside the screen */
        corner *swap = now;
        now = then;
        then = swap;
    }
    draw_fan(state, now, count);
}

void soft_clip(soft_state *state, const soft_vertex *a, const soft_vertex *b, const soft_vertex *c)
{
    clip(state, a, b, c, SCREEN_PLANES);
}

void soft_clip_thrown(soft_state *state, const soft_vertex *a, const soft_vertex *b,
                      const soft_vertex *c)
{
    C3D_ASSERT(state->paint.thrown);
    clip(state, a, b, c, PLANES);
}

int soft_clip_line(const soft_state *state, const soft_vertex *a, const soft_vertex *b,
                   soft_vertex cut_line[2])
{
    corner end[2], new;
    take(state, a, &end[0]);
    take(state, b, &end[1]);
    for (int plane = 0; plane < SCREEN_PLANES; plane++) {
        if (!beyond(end[0].at.out | end[1].at.out, plane)) continue;
        int inside[2] = { distance(state, &end[0], plane) >= 0,
                          distance(state, &end[1], plane) >= 0 };
        if (!inside[0] && !inside[1]) return 0;
        if (inside[0] && inside[1]) continue;
        cut(state, plane, &end[inside[0] ? 0 : 1], &end[inside[0] ? 1 : 0], &new);
        end[inside[0] ? 1 : 0] = new;
    }
    cut_line[0] = end[0].at;
    cut_line[1] = end[1].at;
    return 1;
}
