/* From vertices to the screen, once for each vertex of a mesh.
 *
 * World units: 2^shift to a wu, chosen so that every coordinate relative to the camera stays below 2^30. Rotation: three products of
 * 31 + 30 bits, their sum below 2^62, of which the upper word is kept: eye units are 2 world units and stay below 2^29 * sqrt 3.
 * Projection: 1/z as a 31-bit mantissa r and an exponent, so that x * focal/z is one product of 30 and 31 bits. */
#include "soft_local.h"

#include <string.h>

#define WORLD_MAX ((int64_t)1 << 30)
#define W_MAX ((1u << 30) - 1) /* near/z in Q30: at the near plane rounding, and ON_TOP anywhere near, would pass it */

/* Largest offset of a vertex from the camera along any axis, wu. */
static int64_t reach_wu(const c3d_resolved_draw *resolved)
{
    const c3d_draw *draw = resolved->draw;
    const uint16_t *reach = resolved->mesh->reach;
    int64_t most = 0;
    for (int i = 0; i < 3; i++) {
        int64_t origin = draw->origin_wu[i] < 0 ? -draw->origin_wu[i] : draw->origin_wu[i];
        int64_t size = i < 2 ? (int64_t)reach[i] * (draw->xy_scale_wu < 0 ? -(int64_t)draw->xy_scale_wu : draw->xy_scale_wu)
                             : (int64_t)(((uint64_t)reach[2] * draw->z_scale_q16) >> 16) + 1;
        most = origin + size > most ? origin + size : most;
    }
    return most;
}

void soft_begin_space(soft_state *state, const c3d_resolved_draw *resolved)
{
    const c3d_draw *draw = resolved->draw;
    soft_space *space = &state->space;
    int backdrop = (draw->flags & C3D_DRAW_BACKDROP) != 0;
    int64_t reach = reach_wu(resolved);
    /* Backdrops surround the eye: what is closer than 1/4096 of their reach only costs bits of depth. */
    int32_t near_wu = !backdrop ? state->frame.camera.near_wu : reach < 8192 ? 1 : reach >> 12 < INT32_MAX ? (int32_t)(reach >> 12) : INT32_MAX;
    space->shift = backdrop ? 14 : state->frame_shift;
    while (soft_scale64(reach, space->shift) >= WORLD_MAX) space->shift--;
    memcpy(space->origin_wu, draw->origin_wu, sizeof space->origin_wu);
    space->scale_wu = draw->xy_scale_wu;
    space->z_scale_q16 = draw->z_scale_q16;
    int64_t near_scale = soft_scale64(draw->xy_scale_wu, space->shift);
    int near = space->shift >= 0 && near_scale < WORLD_MAX && near_scale > -WORLD_MAX;
    space->near_scale = near ? (int32_t)near_scale : 0;
    for (int i = 0; near && i < 2; i++) space->near_origin[i] = (int32_t)soft_scale64(draw->origin_wu[i], space->shift);
    space->near_z = draw->origin_wu[2] * 65536;
    int64_t near_eye = soft_scale64(near_wu, space->shift - 1), far_eye = soft_scale64(state->frame.camera.far_wu, space->shift - 1);
    int leading = soft_leading_zeros((uint32_t)near_wu) - 1;
    space->near_norm = near_wu << leading;
    space->near_shift = leading - (space->shift - 1);
    space->near_eye = near_eye < 1 ? 1 : (int32_t)near_eye;
    space->far_eye = backdrop || far_eye > INT32_MAX ? INT32_MAX : (int32_t)far_eye;
}

/* a * b / 2^shift, rounded, within +-(SOFT_GUARD_Q4); shift 2 .. 62. */
static inline int32_t multiply_shift(int32_t a, int32_t b, int shift)
{
    int64_t product = (int64_t)a * b;
    int64_t twice = shift > 32 ? (int32_t)(product >> 32) >> (shift - 33) : product >> (shift - 1);
    twice = twice > 2 * SOFT_GUARD_Q4 ? 2 * SOFT_GUARD_Q4 : twice < -2 * SOFT_GUARD_Q4 ? -2 * SOFT_GUARD_Q4 : twice;
    return ((int32_t)twice + 1) >> 1;
}

static inline int out_of_guard(int32_t at) { return (uint32_t)(at + SOFT_GUARD_Q4 - 1) > 2 * SOFT_GUARD_Q4 - 2; }

static inline void project_xy(const soft_state *state, soft_vertex *vertex, int32_t reciprocal_focal, int shift)
{
    int32_t x = multiply_shift(vertex->eye[0], reciprocal_focal, shift), y = -multiply_shift(vertex->eye[1], reciprocal_focal, shift);
    uint32_t out = vertex->out;
    if (out_of_guard(x) || out_of_guard(y)) out |= SOFT_GUARD;
    vertex->x = x += state->centre_x;
    vertex->y = y += state->centre_y;
    if (x <= SOFT_HALF) out |= SOFT_LEFT;
    if (x > state->right_q4) out |= SOFT_RIGHT;
    if (y <= SOFT_HALF) out |= SOFT_ABOVE;
    if (y > state->below_q4) out |= SOFT_BELOW;
    vertex->out = out;
}

/* z = zn / 2^lead with zn in 2^30 .. 2^31; r = 2^61/zn. p = r * focal_norm / 2^31 < 2^31, and x * focal * 16/z is
 * x * p / 2^(34 + focal_shift - lead): |x| < 2^30 keeps the product below 2^61. */
void soft_project(const soft_state *state, soft_vertex *vertex)
{
    const soft_space *space = &state->space;
    int32_t z = vertex->eye[2];
    vertex->out = 0;
    if (z < space->near_eye) {
        vertex->out = SOFT_NEAR;
        vertex->y = INT32_MIN; /* in no row of those in front */
        return;
    }
    if (z > space->far_eye) vertex->out = SOFT_FAR;
    int lead = soft_leading_zeros((uint32_t)z) - 1;
    uint32_t r = soft_reciprocal(state, (uint32_t)z << lead);
    uint32_t p = (uint32_t)(((uint64_t)r * (uint32_t)state->focal_norm) >> 31);
    int shift = 34 + state->focal_shift - lead, w_shift = space->near_shift - lead;
    uint32_t w = (uint32_t)(((uint64_t)r * (uint32_t)space->near_norm) >> 31);
    w = w_shift <= 0 ? w : w_shift > 30 ? 0 : w >> w_shift;
    if (state->paint.on_top) w += w >> 6;
    vertex->w = w < 16 ? 16 : w > W_MAX ? W_MAX : w;
    project_xy(state, vertex, (int32_t)(p > INT32_MAX ? INT32_MAX : p), shift);
}

static void rotate(const soft_state *state, const int32_t world[3], int32_t eye[3])
{
    for (int row = 0; row < 3; row++) {
        const int32_t *m = state->rotation.m[row];
        eye[row] = (int32_t)(((int64_t)m[0] * world[0] + (int64_t)m[1] * world[1] + (int64_t)m[2] * world[2]) >> 32);
    }
}

/* s or t: (at * scale + offset) >> shift, texels Q16. */
typedef struct texel_axis {
    int32_t scale;
    int shift, axis;
    int64_t offset;
    int32_t high; /* of the texture with half a texel of its rim */
} texel_axis;

static void make_axis(const soft_state *state, const c3d_draw *draw, int i, texel_axis *axis)
{
    int size_log2 = i ? state->paint.texture->height_log2 : state->paint.texture->width_log2;
    int64_t scale = draw->tex_scale_q16[i] * ((int64_t)1 << size_log2);
    int64_t offset = draw->tex_offset_q16[i] * ((int64_t)1 << size_log2) - 32768;
    int64_t limit = INT32_MAX; /* 2^15 texture widths for one vertex unit */
    axis->scale = (int32_t)(scale > limit ? limit : scale < -limit ? -limit : scale);
    axis->shift = draw->tex_shift;
    axis->axis = state->paint.axis[i];
    axis->offset = offset * ((int64_t)1 << axis->shift) - (int64_t)draw->tex_origin[i] * axis->scale;
    axis->high = (1 << (size_log2 + 16)) - 32768;
}

static inline int32_t texel_q16(const texel_axis *axis, const int16_t at[3])
{
    int64_t texels = ((int64_t)at[axis->axis] * axis->scale + axis->offset) >> axis->shift;
    int64_t limit = ((int64_t)1 << 28) - 1;
    return (int32_t)(texels > limit ? limit : texels < -limit ? -limit : texels);
}

/* Fog is linear between its start and end. */
static int32_t fog_q8(const soft_state *state, int32_t z_eye)
{
    const c3d_frame *frame = &state->frame;
    int64_t z_wu = soft_scale64(z_eye, 1 - state->space.shift), length = (int64_t)frame->fog_end_wu - frame->fog_start_wu;
    int64_t clear = ((int64_t)frame->fog_end_wu - z_wu) * 256 / (length > 0 ? length : 1);
    return (int32_t)(clear > 1 << 14 ? 1 << 14 : clear < -(1 << 14) ? -(1 << 14) : clear);
}

/* Exact, and the same for every mesh that shares the point. */
static void place_far(const soft_space *space, const c3d_vertex *in, int32_t world[3])
{
    world[0] = (int32_t)soft_scale64(space->origin_wu[0] + (int64_t)in->x * space->scale_wu, space->shift);
    world[1] = (int32_t)soft_scale64(space->origin_wu[1] + (int64_t)in->y * space->scale_wu, space->shift);
    world[2] = (int32_t)soft_scale64(space->origin_wu[2] * 65536 + (int64_t)in->z * space->z_scale_q16, space->shift - 16);
}

/* The same where a unit is at most a wu: sums of 32 bits do, for no vertex is out of reach. */
static inline void place_near(const soft_space *space, const c3d_vertex *in, int32_t world[3])
{
    world[0] = space->near_origin[0] + in->x * space->near_scale;
    world[1] = space->near_origin[1] + in->y * space->near_scale;
    world[2] = (int32_t)((space->near_z + in->z * (int64_t)space->z_scale_q16) >> (16 - space->shift));
}

static void transform_textured(soft_state *state, const c3d_draw *draw, const c3d_mesh_data *mesh)
{
    texel_axis s, t;
    make_axis(state, draw, 0, &s);
    make_axis(state, draw, 1, &t);
    for (uint32_t i = 0; i < mesh->count; i++) {
        soft_vertex *vertex = &state->vertices[i];
        const c3d_vertex *in = &mesh->vertices[i];
        const int16_t at[3] = {in->x, in->y, in->z};
        vertex->s = texel_q16(&s, at);
        vertex->t = texel_q16(&t, at);
        if (vertex->s < -32768 || vertex->s > s.high || vertex->t < -32768 || vertex->t > t.high) state->off_texture = 1;
    }
}

static void transform_places(soft_state *state, const c3d_mesh_data *mesh)
{
    const soft_space *space = &state->space;
    int near = space->near_scale != 0;
    for (uint32_t i = 0; i < mesh->count; i++) {
        int32_t world[3];
        soft_vertex *vertex = &state->vertices[i];
        if (near)
            place_near(space, &mesh->vertices[i], world);
        else
            place_far(space, &mesh->vertices[i], world);
        rotate(state, world, vertex->eye);
        soft_project(state, vertex);
    }
}

static void transform_colours(soft_state *state, const c3d_draw *draw, const c3d_mesh_data *mesh)
{
    for (uint32_t i = 0; i < mesh->count; i++)
        for (int c = 0; c < 4; c++)
            state->vertices[i].rgba[c] = state->paint.coloured ? mesh->vertices[i].rgba[c] : (uint8_t)(draw->colour >> (8 * c));
}

static int same_vertices(const c3d_draw *a, const c3d_draw *b)
{
    return a->mesh.id == b->mesh.id && memcmp(a->origin_wu, b->origin_wu, sizeof a->origin_wu) == 0 &&
           a->xy_scale_wu == b->xy_scale_wu && a->z_scale_q16 == b->z_scale_q16 && a->flags == b->flags && a->colour == b->colour &&
           a->texture.id == b->texture.id && memcmp(a->tex_scale_q16, b->tex_scale_q16, sizeof a->tex_scale_q16) == 0 &&
           memcmp(a->tex_offset_q16, b->tex_offset_q16, sizeof a->tex_offset_q16) == 0 &&
           memcmp(a->tex_origin, b->tex_origin, sizeof a->tex_origin) == 0 && a->tex_shift == b->tex_shift;
}

/* The strips of a node share its mesh: its vertices are transformed with the first. */
void soft_transform(soft_state *state, const c3d_resolved_draw *resolved)
{
    const c3d_draw *draw = resolved->draw;
    if (state->cached_mesh == resolved->mesh->vertices && same_vertices(&state->cached, draw)) return;
    state->cached = *draw;
    state->cached_mesh = resolved->mesh->vertices;
    soft_begin_space(state, resolved);
    state->off_texture = 0;
    transform_places(state, resolved->mesh);
    if (state->paint.texture) transform_textured(state, draw, resolved->mesh);
    if (!state->paint.texture || !state->paint.white || state->paint.fog) transform_colours(state, draw, resolved->mesh);
    for (uint32_t i = 0; state->paint.fog && i < resolved->mesh->count; i++)
        state->vertices[i].fog_q8 = fog_q8(state, state->vertices[i].eye[2]);
}
