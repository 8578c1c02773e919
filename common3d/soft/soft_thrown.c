/* A picture thrown on a mesh: where each vertex lies in it. s = a/c and t = b/c, with a, b and c
 * sums of three products of a projector's row and the offset from its point.
 *
 * Offsets are brought to 30 bits, rows have at most 31 with their sign: sums of three products stay
 * below 2^62. s and t come from these; c, which is only a weight between vertices, and all three
 * where triangles are cut, have 30 bits. */
#include "soft_local.h"

#define TEXEL_MAX ((1 << 28) - 1)
#define QUICK_C   (1 << 20) /* c whose 30 bits are enough: 2^-20 of 4096 texels is 1/256 texel */

static int64_t size_of(int64_t n) { return n < 0 ? -n : n; }

/* The farthest that a vertex may lie from the projector's point along an axis, wu. */
static int64_t reach_wu(const soft_throw *space, const c3d_mesh_data *mesh, int axis)
{
    int64_t size = axis < 2 ? mesh->reach[axis] * size_of(space->scale_wu)
                            : (int64_t)(((uint64_t)mesh->reach[2] * space->z_scale_q16) >> 16) + 1;
    return size_of(space->from_wu[axis]) + size;
}

/* Prepares places in 32 bits, where units are no larger than a wu. */
static void set_near_places(soft_throw *space)
{
    int64_t scale = soft_scale64(space->scale_wu, space->shift < 0 ? 0 : space->shift);
    space->near = space->shift >= 0 && scale <= INT32_MAX && scale >= -INT32_MAX &&
                  space->z_scale_q16 <= INT32_MAX && space->sum_shift >= 0;
    space->scale = (int32_t)scale;
    for (int axis = 0; space->near && axis < 3; axis++)
        space->origin[axis] = (int32_t)soft_scale64(space->from_wu[axis], space->shift);
}

static void begin(soft_throw *space, const c3d_draw *draw, const c3d_projector *projector,
                  const c3d_mesh_data *mesh)
{
    int64_t most_wu = 1;
    uint64_t most_sum = 1;
    space->scale_wu = draw->xy_scale_wu;
    space->z_scale_q16 = draw->z_scale_q16;
    for (int axis = 0; axis < 3; axis++) {
        uint64_t sum = 0;
        space->from_wu[axis] = draw->origin_wu[axis] - projector->origin_wu[axis];
        int64_t reach = reach_wu(space, mesh, axis);
        most_wu = reach > most_wu ? reach : most_wu;
        for (int i = 0; i < 3; i++) {
            space->row_q24[axis][i] = projector->row_q24[axis][i];
            sum += (uint64_t)size_of(projector->row_q24[axis][i]) << 30;
        }
        most_sum = sum > most_sum ? sum : most_sum;
    }
    space->shift = 29 - soft_log2((uint64_t)most_wu);
    if (space->shift > 14) space->shift = 14;
    space->sum_shift = soft_log2(most_sum) - 29;
    C3D_ASSERT(most_wu < (int64_t)1 << 36 && most_sum < (uint64_t)1 << 63);
    set_near_places(space);
}

static SOFT_INLINE void sums_at(const soft_throw *space, int32_t x, int32_t y, int32_t z,
                                int64_t sum[3])
{
    for (int i = 0; i < 3; i++) {
        const int32_t *row = space->row_q24[i];
        sum[i] = (int64_t)row[0] * x + (int64_t)row[1] * y + (int64_t)row[2] * z;
    }
}

static SOFT_INLINE void sums_near(const soft_throw *space, const c3d_vertex *in, int64_t sum[3])
{
    int64_t height = (int64_t)(int32_t)space->z_scale_q16 * in->z;
    sums_at(space, space->origin[0] + in->x * space->scale, space->origin[1] + in->y * space->scale,
            space->origin[2] + (int32_t)(height >> (16 - space->shift)), sum);
}

/* The same as sums_near, where 32 bits do not suffice on the way. */
static void sums_of(const soft_throw *space, const c3d_vertex *in, int64_t sum[3])
{
    int32_t x = (int32_t)soft_scale64(space->from_wu[0] + (int64_t)in->x * space->scale_wu,
                                      space->shift),
            y = (int32_t)soft_scale64(space->from_wu[1] + (int64_t)in->y * space->scale_wu,
                                      space->shift),
            z = (int32_t)soft_scale64(
                space->from_wu[2] * 65536 + (int64_t)in->z * space->z_scale_q16, space->shift - 16);
    sums_at(space, x, y, z, sum);
}

/* sum/c in texels less one half, Q16, where 2^shift * n is c and r is 2^61/n. What lies farther
 * beyond the texture than can be told is +-TEXEL_MAX. */
static int32_t texel_q16(int64_t sum, int shift, uint32_t r, int size_log2)
{
    int64_t part = soft_scale64(sum, -(shift + 3)); /* sum/c below 8 has 31 bits */
    if (part > INT32_MAX || part < -INT32_MAX) return sum < 0 ? -TEXEL_MAX : TEXEL_MAX;
    int64_t texels = (part * r >> (61 - 3 - 16 - size_log2)) - 32768;
    return (int32_t)(texels > TEXEL_MAX ? TEXEL_MAX : texels < -TEXEL_MAX ? -TEXEL_MAX : texels);
}

static int is_far(int32_t texel) { return texel == TEXEL_MAX || texel == -TEXEL_MAX; }

/* The sides of the opaque texels that a place lies beyond: those of the rim's, which are none. */
static uint8_t sides_of(const soft_texture *texture, int32_t s, int32_t t)
{
    return (uint8_t)((s <= 0 ? SOFT_OFF_LEFT : 0) |
                     (s >= (texture->width - 1) << 16 ? SOFT_OFF_RIGHT : 0) |
                     (t <= 0 ? SOFT_OFF_ABOVE : 0) |
                     (t >= (texture->height - 1) << 16 ? SOFT_OFF_BELOW : 0));
}

/* The same for a place that has no s and t. */
static uint8_t far_sides_of(const soft_texture *texture, const int32_t sum[3])
{
    int64_t wide = texture->width, high = texture->height, a = 2 * wide * sum[0],
            b = 2 * high * sum[1], c = sum[2];
    return (uint8_t)((a <= c ? SOFT_OFF_LEFT : 0) | (a >= (2 * wide - 1) * c ? SOFT_OFF_RIGHT : 0) |
                     (b <= c ? SOFT_OFF_ABOVE : 0) |
                     (b >= (2 * high - 1) * c ? SOFT_OFF_BELOW : 0));
}

/* `exact` are the sums with as many bits as there are. */
static void throw_at(const soft_state *state, const int64_t exact[3], const int32_t sum[3],
                     soft_vertex *vertex)
{
    const soft_texture *texture = state->paint.texture;
    vertex->s = vertex->t = 0;
    vertex->c = sum[2];
    vertex->off = SOFT_OFF_BEHIND;
    if (sum[2] >= SOFT_THROWN_C) {
        int shift = soft_log2((uint64_t)exact[2]) - 30;
        uint32_t r = soft_fine_reciprocal(state, (uint32_t)soft_scale64(exact[2], -shift));
        vertex->s = texel_q16(exact[0], shift, r, texture->width_log2);
        vertex->t = texel_q16(exact[1], shift, r, texture->height_log2);
        vertex->off = sides_of(texture, vertex->s, vertex->t);
        if (!is_far(vertex->s) && !is_far(vertex->t)) return;
        vertex->off = SOFT_OFF_FAR;
    }
    vertex->off |= far_sides_of(texture, sum);
}

static void round_sums(const soft_throw *space, const int64_t exact[3], int32_t sum[3])
{
    for (int i = 0; i < 3; i++) {
        int64_t rounded = soft_scale64(exact[i], -space->sum_shift);
        C3D_ASSERT(rounded > -(1 << 30) - 1 && rounded < 1 << 30);
        sum[i] = (int32_t)rounded;
    }
}

/* a/c or b/c in texels less one half, Q16, as texel_q16: r is 2^60 / (c * 2^lead). */
static SOFT_INLINE int32_t quick_texel_q16(int32_t sum, int32_t r, int lead, int size_log2)
{
    return (int32_t)((int64_t)sum * r >> (60 - 16 - lead - size_log2)) - 32768;
}

/* Where c is large, and a and b are at most twice as large: 30 bits of each will do. */
static SOFT_INLINE int throw_quickly(const soft_state *state, const soft_texture *texture,
                                     const int32_t sum[3], soft_vertex *vertex)
{
    uint32_t c = (uint32_t)sum[2];
    if (sum[2] < QUICK_C || (uint32_t)sum[0] + 2 * c > 4 * c || (uint32_t)sum[1] + 2 * c > 4 * c)
        return 0;
    int lead = soft_leading_zeros(c) - 1;
    int32_t r = (int32_t)(soft_reciprocal(state, c << lead) >> 1);
    vertex->s = quick_texel_q16(sum[0], r, lead, texture->width_log2);
    vertex->t = quick_texel_q16(sum[1], r, lead, texture->height_log2);
    vertex->c = sum[2];
    vertex->off = sides_of(texture, vertex->s, vertex->t);
    return 1;
}

static void throw_near(soft_state *state, const c3d_mesh_data *mesh)
{
    const soft_throw space = state->throw;
    const soft_texture texture = *state->paint.texture;
    const c3d_vertex *in = mesh->vertices, *end = in + mesh->count;
    for (soft_vertex *vertex = state->vertices; in < end; in++, vertex++) {
        int64_t exact[3];
        sums_near(&space, in, exact);
        const int32_t sum[3] = { (int32_t)(exact[0] >> space.sum_shift),
                                 (int32_t)(exact[1] >> space.sum_shift),
                                 (int32_t)(exact[2] >> space.sum_shift) };
        if (!throw_quickly(state, &texture, sum, vertex)) throw_at(state, exact, sum, vertex);
    }
}

void soft_transform_thrown(soft_state *state, const c3d_draw *draw, const c3d_mesh_data *mesh)
{
    begin(&state->throw, draw, &state->projector, mesh);
    if (state->throw.near) {
        throw_near(state, mesh);
        return;
    }
    for (uint32_t i = 0; i < mesh->count; i++) {
        int64_t exact[3];
        int32_t sum[3];
        sums_of(&state->throw, &mesh->vertices[i], exact);
        round_sums(&state->throw, exact, sum);
        throw_at(state, exact, sum, &state->vertices[i]);
    }
}

void soft_thrown_sums(const soft_state *state, const soft_vertex *vertex, int32_t sum[3])
{
    C3D_ASSERT(vertex >= state->vertices);
    int64_t exact[3];
    sums_of(&state->throw, &state->cached_mesh[vertex - state->vertices], exact);
    round_sums(&state->throw, exact, sum);
}

void soft_throw_vertex(const soft_state *state, const int32_t sum[3], soft_vertex *vertex)
{
    const int32_t kept[3] = { sum[0], sum[1], sum[2] < SOFT_THROWN_C ? SOFT_THROWN_C : sum[2] };
    const int64_t exact[3] = { kept[0], kept[1], kept[2] };
    throw_at(state, exact, kept, vertex);
    vertex->off &= SOFT_OFF_SIDES;
}
