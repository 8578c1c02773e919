/* From vertices to the screen, once for each vertex of a mesh.
 *
 * World units: 2^shift to a wu, chosen so that every coordinate relative to the camera stays below
 * 2^30. A vertex's place is exact in them (its height rounded down), so that meshes that share the
 * vertex get the same place, whatever their origins.
 * Rotation: the sum of three products of 30 and 31 bits, of which the upper word is kept. The rows
 * have at most the length 2^31, so sums stay below 2^62 and eye coordinates below 2^29 * sqrt 3.
 * The row for depth is the forward direction, so an eye unit is 2 world units. The rows for x and y
 * are multiplied with the focal distance beforehand. Projection: 1/z is a mantissa r of 30 bits and
 * an exponent, so that x/z is one product, of which again the upper word is kept. */
#include "soft_local.h"

#include <string.h>

#define WORLD_MAX    ((int64_t)1 << 30)
#define W_MIN        16 /* least w of anything drawn: depths 0 and 1 mean something else */
#define W_PLAIN_LOG2 25 /* up to 2^25 times the near plane's distance w is above W_MIN */
#define W_ERROR_LOG2 18 /* 1/z may be too great by 2^-19 of itself: near_norm makes up for it */

void soft_begin_view(soft_state *state, const c3d_rotation *rotation)
{
    const c3d_camera *camera = &state->frame.camera;
    soft_view *view = &state->view;
    int lead = soft_leading_zeros((uint32_t)camera->focal_q8) - 1;
    /* below 2^31; times a row of at most 2^30 */
    int64_t focal_norm = (int64_t)camera->focal_q8 << lead;
    C3D_ASSERT(focal_norm >> 30 == 1);
    view->focal_shift = lead;
    for (int i = 0; i < 3; i++) {
        view->row[0][i] = (int32_t)((rotation->m[0][i] * focal_norm) >> 30);
        view->row[1][i] = (int32_t)((rotation->m[1][i] * focal_norm) >> 30);
        int64_t forward = 2 * (int64_t)rotation->m[2][i];
        view->row[2][i] = (int32_t)(forward > INT32_MAX    ? INT32_MAX
                                    : forward < -INT32_MAX ? -INT32_MAX
                                                           : forward);
    }
    view->centre[0] = state->width * SOFT_ONE;
    view->centre[1] = state->height * SOFT_ONE;
    for (int i = 0; i < 2; i++) view->guard_from[i] = view->centre[i] / 2 - SOFT_GUARD_Q4 + 1;
    view->right_q4 = state->width * SOFT_ONE - SOFT_HALF;
    view->below_q4 = state->height * SOFT_ONE - SOFT_HALF;
    state->frame_shift = 14; /* the far plane below 2^29 world units */
    while (soft_scale64(camera->far_wu, state->frame_shift) >= 1 << 29) state->frame_shift--;
    C3D_ASSERT(state->frame_shift >= -2 && state->frame_shift <= 14);
}

/* ---- the space of a draw ---- */

/* Largest offset of a vertex from the camera along any axis, wu. */
static int64_t reach_wu(const c3d_resolved_draw *resolved)
{
    const c3d_draw *draw = resolved->draw;
    const uint32_t *reach = resolved->mesh->reach;
    int64_t most = 0;
    for (int i = 0; i < 3; i++) {
        int64_t origin = draw->origin_wu[i] < 0 ? -draw->origin_wu[i] : draw->origin_wu[i];
        int64_t size = i < 2 ? (int64_t)reach[i] * (draw->xy_scale_wu < 0
                                                        ? -(int64_t)draw->xy_scale_wu
                                                        : draw->xy_scale_wu)
                             : (int64_t)(((uint64_t)reach[2] * draw->z_scale_q16) >> 16) + 1;
        most = origin + size > most ? origin + size : most;
    }
    C3D_ASSERT(most >= 0);
    return most;
}

static int fits(int64_t value) { return value <= INT32_MAX && value >= -INT32_MAX; }

/* Prepares places in 32 bits, where world units are no larger than a wu. WORLD_MAX bounds the sum
 * of the magnitudes of origin and offset, so each of them fits. */
static void set_near_places(soft_space *space)
{
    int64_t scale = soft_scale64(space->scale_wu, space->shift);
    space->near = space->shift >= 0 && fits(scale) && space->z_scale_q16 <= INT32_MAX;
    if (!space->near) return;
    for (int i = 0; i < 3; i++) {
        int64_t origin = soft_scale64(space->origin_wu[i], space->shift);
        C3D_ASSERT(origin > -WORLD_MAX && origin < WORLD_MAX);
        space->origin[i] = (int32_t)origin;
    }
    space->scale = (int32_t)scale;
}

/* The near plane in eye units, rounded up so that near/z never exceeds 1, and the factors that
 * project() takes for near/z. */
static void set_planes(soft_space *space, int32_t near_wu, int32_t far_wu)
{
    int64_t near_eye = -soft_scale64(-(int64_t)near_wu, space->shift - 1),
            far_eye = soft_scale64(far_wu, space->shift - 1);
    int lead = soft_leading_zeros((uint32_t)near_wu);
    space->near_eye = near_eye > INT32_MAX ? INT32_MAX : (int32_t)near_eye;
    space->far_eye = far_eye > INT32_MAX ? INT32_MAX : (int32_t)far_eye;
    C3D_ASSERT(near_eye >= 1 && near_eye <= far_eye);
    space->near_norm = (uint32_t)near_wu << lead;
    space->near_norm -= space->near_norm >> W_ERROR_LOG2;
    space->near_shift = lead - space->shift;
    /* so that project() shifts by less than 32 bits */
    for (; space->near_shift > 31; space->near_shift--) space->near_norm >>= 1;
    C3D_ASSERT(space->near_shift >= 0);
}

static void begin_space(soft_state *state, const c3d_resolved_draw *resolved)
{
    const c3d_draw *draw = resolved->draw;
    soft_space *space = &state->space;
    int backdrop = (draw->flags & C3D_DRAW_BACKDROP) != 0;
    int64_t reach = reach_wu(resolved);
    /* Backdrops surround the eye: a near plane closer than 1/4096 of their reach would only cost
     * bits of depth. */
    int32_t near_wu = !backdrop                 ? state->frame.camera.near_wu
                      : reach < 8192            ? 1
                      : reach >> 12 < INT32_MAX ? (int32_t)(reach >> 12)
                                                : INT32_MAX;
    space->shift = backdrop ? 14 : state->frame_shift;
    while (soft_scale64(reach, space->shift) >= WORLD_MAX) space->shift--;
    C3D_ASSERT(near_wu >= 1 && space->shift >= -17 && space->shift <= 14);
    memcpy(space->origin_wu, draw->origin_wu, sizeof space->origin_wu);
    space->scale_wu = draw->xy_scale_wu;
    space->z_scale_q16 = draw->z_scale_q16;
    set_near_places(space);
    set_planes(space, near_wu, state->frame.camera.far_wu);
    if (backdrop) space->far_eye = INT32_MAX;
}

/* ---- eye space ---- */

static SOFT_INLINE int32_t along(const int32_t row[3], int32_t x, int32_t y, int32_t z)
{
    uint64_t sum = (uint64_t)((int64_t)row[0] * x + (int64_t)row[1] * y + (int64_t)row[2] * z);
    /* by way of unsigned, so that compilers see that 32 bits are multiplied next */
    return (int32_t)(uint32_t)(sum >> 32);
}

static SOFT_INLINE void rotate(const soft_view *view, int32_t x, int32_t y, int32_t z,
                               int32_t eye[3])
{
    eye[0] = along(view->row[0], x, y, z);
    eye[1] = along(view->row[1], x, y, z);
    eye[2] = along(view->row[2], x, y, z);
}

static SOFT_INLINE void place_near(const soft_space *space, const c3d_vertex *in, int32_t world[3])
{
    int64_t height = (int64_t)(int32_t)space->z_scale_q16 * in->z;
    int down = 16 - space->shift;
    C3D_ASSERT(down >= 2 && down <= 16);
    world[0] = space->origin[0] + in->x * space->scale;
    world[1] = space->origin[1] + in->y * space->scale;
    world[2] = space->origin[2] +
               (int32_t)((uint32_t)height >> down | (uint32_t)(height >> 32) << (32 - down));
}

static SOFT_INLINE void eye_near(const soft_space *space, const soft_view *view,
                                 const c3d_vertex *in, int32_t eye[3])
{
    int32_t world[3];
    place_near(space, in, world);
    rotate(view, world[0], world[1], world[2], eye);
}

/* The same as eye_near, where 32 bits do not suffice on the way. */
static void eye_far(const soft_space *space, const soft_view *view, const c3d_vertex *in,
                    int32_t eye[3])
{
    rotate(
        view,
        (int32_t)soft_scale64(space->origin_wu[0] + (int64_t)in->x * space->scale_wu, space->shift),
        (int32_t)soft_scale64(space->origin_wu[1] + (int64_t)in->y * space->scale_wu, space->shift),
        (int32_t)soft_scale64(space->origin_wu[2] * 65536 + (int64_t)in->z * space->z_scale_q16,
                              space->shift - 16),
        eye);
}

void soft_eye(const soft_state *state, const soft_vertex *vertex, int32_t eye[3])
{
    C3D_ASSERT(vertex >= state->vertices &&
               (const uint8_t *)(vertex + 1) <= (const uint8_t *)state->textures);
    const c3d_vertex *in = &state->cached_mesh[vertex - state->vertices];
    (state->space.near ? eye_near : eye_far)(&state->space, &state->view, in, eye);
}

/* ---- the screen ---- */

/* 2^60/n for n in 2^30 .. 2^31 - 1, within 2^-19 of its value. */
static SOFT_INLINE int32_t reciprocal(const uint32_t table[512], uint32_t n)
{
    C3D_ASSERT(n >> 30 == 1);
    uint32_t r = table[n >> 21 ^ 512];
    uint32_t error = (uint32_t)(((uint64_t)n * r) >> 32); /* 2^29 when exact */
    return (int32_t)(((uint64_t)r * ~(error << 2)) >> 32);
}

/* The bits of `out` for a vertex beside the screen along one axis. */
static inline uint32_t beside(int32_t at, int32_t guard_from, uint32_t low, uint32_t high)
{
    uint32_t guard = (uint32_t)(at - guard_from) > 2 * SOFT_GUARD_Q4 - 2 ? SOFT_GUARD : 0;
    return guard | (at <= SOFT_HALF ? low : high);
}

/* Twice x/z on the screen, Q4: x * r * 2^(lead - focal_shift - 32) with z = n / 2^lead and r =
 * 2^60/n. |x * r| < 2^60. */
static inline int32_t twice_on_screen(int32_t x, int32_t r, int shift, int plain)
{
    int64_t product = (int64_t)x * r;
    if (plain || shift >= 0) return (int32_t)(product >> 32) >> shift;
    C3D_ASSERT(shift > -32);
    product >>= 32 + shift; /* nearer than a metre or so */
    return (int32_t)(product > 1 << 28 ? 1 << 28 : product < -(1 << 28) ? -(1 << 28) : product);
}

/* 1 when the whole mesh lies between the near and the far plane, not so near that a product takes
 * 64 bits, and not so far that near/z vanishes. A sum of three products is least and greatest in
 * corners of the mesh's box; keeping only the upper words keeps their order. */
static int is_plain(const soft_space *space, const soft_view *view, const c3d_mesh_data *mesh)
{
    const c3d_vertex corner[2] = {
        { .x = mesh->least[0], .y = mesh->least[1], .z = mesh->least[2] },
        { .x = mesh->most[0], .y = mesh->most[1], .z = mesh->most[2] }
    };
    int32_t world[2][3];
    int64_t least = 0, most = 0;
    place_near(space, &corner[0], world[0]);
    place_near(space, &corner[1], world[1]);
    for (int i = 0; i < 3; i++) {
        C3D_ASSERT(world[0][i] > -WORLD_MAX && world[0][i] < WORLD_MAX);
        C3D_ASSERT(world[1][i] > -WORLD_MAX && world[1][i] < WORLD_MAX);
    }
    for (int i = 0; i < 3; i++) {
        int64_t a = (int64_t)view->row[2][i] * world[0][i],
                b = (int64_t)view->row[2][i] * world[1][i];
        least += a < b ? a : b;
        most += a < b ? b : a;
    }
    int32_t nearest = (int32_t)(least >> 32), farthest = (int32_t)(most >> 32);
    return nearest >= space->near_eye && nearest >= 1 << (30 - view->focal_shift) &&
           farthest <= space->far_eye && farthest >> W_PLAIN_LOG2 < space->near_eye;
}

/* Projects a place in eye space: x and y on the screen, w = near/z, and `out`. near/z is near_norm
 * * r * 2^(lead - near_shift - 31), from a product below 2^62. */
static SOFT_INLINE void project(const soft_space *space, const soft_view *view,
                                const uint32_t table[512], int plain, const int32_t eye[3],
                                soft_vertex *vertex)
{
    int32_t z = eye[2];
    if (!plain && z < space->near_eye) {
        vertex->out = SOFT_NEAR;
        vertex->y = INT32_MIN; /* a row that no vertex in front has: soft_strip compares rows */
        return;
    }
    int lead = soft_leading_zeros((uint32_t)z) - 1, shift = view->focal_shift - lead;
    int32_t r = reciprocal(table, (uint32_t)z << lead);
    uint32_t out = !plain && z > space->far_eye ? SOFT_FAR : 0;
    int32_t x = (view->centre[0] + 1 + twice_on_screen(eye[0], r, shift, plain)) >> 1;
    int32_t y = (view->centre[1] - twice_on_screen(eye[1], r, shift, plain)) >> 1;
    uint32_t w = (uint32_t)(((uint64_t)space->near_norm * (uint32_t)r) >> 32) << 1 >>
                 (space->near_shift - lead);
    C3D_ASSERT(space->near_shift >= lead && space->near_shift - lead < 32);
    C3D_ASSERT(w < UINT32_C(1) << 30);
    vertex->w = !plain && w < W_MIN ? W_MIN : w;
    vertex->x = x;
    vertex->y = y;
    if ((uint32_t)(x - SOFT_HALF - 1) >= (uint32_t)(view->right_q4 - SOFT_HALF))
        out |= beside(x, view->guard_from[0], SOFT_LEFT, SOFT_RIGHT);
    if ((uint32_t)(y - SOFT_HALF - 1) >= (uint32_t)(view->below_q4 - SOFT_HALF))
        out |= beside(y, view->guard_from[1], SOFT_ABOVE, SOFT_BELOW);
    vertex->out = out;
}

/* Brings a vertex nearer by 1/64. */
static void put_on_top(soft_vertex *vertex)
{
    C3D_ASSERT(vertex->out & SOFT_NEAR || vertex->w < UINT32_C(1) << 30);
    uint32_t w = vertex->w + (vertex->w >> 6), most = (UINT32_C(1) << 30) - 1;
    vertex->w = w > most ? most : w;
}

void soft_project(const soft_state *state, const int32_t eye[3], soft_vertex *vertex)
{
    project(&state->space, &state->view, state->reciprocal, 0, eye, vertex);
    if (state->paint.on_top) put_on_top(vertex);
}

static SOFT_INLINE void transform_each(soft_state *state, const c3d_mesh_data *mesh, int plain)
{
    C3D_ASSERT((const uint8_t *)(state->vertices + mesh->count) <=
               (const uint8_t *)state->textures);
    const soft_space space = state->space;
    const soft_view view = state->view;
    const uint32_t *table = state->reciprocal;
    const c3d_vertex *in = mesh->vertices, *end = in + mesh->count;
    for (soft_vertex *vertex = state->vertices; in < end; in++, vertex++) {
        int32_t eye[3];
        eye_near(&space, &view, in, eye);
        project(&space, &view, table, plain, eye, vertex);
    }
}

static void transform_near(soft_state *state, const c3d_mesh_data *mesh)
{
    if (is_plain(&state->space, &state->view, mesh))
        transform_each(state, mesh, 1);
    else
        transform_each(state, mesh, 0);
}

static void transform_far(soft_state *state, const c3d_mesh_data *mesh)
{
    C3D_ASSERT((const uint8_t *)(state->vertices + mesh->count) <=
               (const uint8_t *)state->textures);
    for (uint32_t i = 0; i < mesh->count; i++) {
        int32_t eye[3];
        eye_far(&state->space, &state->view, &mesh->vertices[i], eye);
        project(&state->space, &state->view, state->reciprocal, 0, eye, &state->vertices[i]);
    }
}

/* ---- textures, colours, fog ---- */

/* s of a column or t of a row: at * scale + offset, texels Q16. */
typedef struct texel_axis {
    int64_t scale, offset;
    int64_t first, last; /* the least and the most of at * scale */
} texel_axis;

static int32_t texel_q16(const texel_axis *axis, uint32_t at)
{
    int64_t along = at * axis->scale, limit = ((int64_t)1 << 28) - 1;
    if (along < axis->first) along = axis->first;
    int64_t texels = (along > axis->last ? axis->last : along) + axis->offset;
    return (int32_t)(texels > limit ? limit : texels < -limit ? -limit : texels);
}

/* What the first and the last column, or row, give is the range of all. */
static texel_axis make_axis(soft_state *state, const c3d_draw *draw, int i, uint32_t last)
{
    int size_log2 = i ? state->paint.texture->height_log2 : state->paint.texture->width_log2;
    C3D_ASSERT(size_log2 <= 12);
    texel_axis axis = { draw->tex_scale_q16[i] * ((int64_t)1 << size_log2),
                        draw->tex_offset_q16[i] * ((int64_t)1 << size_log2) - 32768, INT64_MIN,
                        INT64_MAX };
    if (draw->tex_first_q16[i]) axis.first = draw->tex_first_q16[i] * axis.scale / 65536;
    if (draw->tex_last_q16[i]) axis.last = draw->tex_last_q16[i] * axis.scale / 65536;
    for (int end = 0; end < 2; end++) {
        int32_t texels = texel_q16(&axis, end ? last : 0);
        /* the texture with half of its rim */
        state->off_texture |= texels < -32768 || texels > (1 << (size_log2 + 16)) - 32768;
    }
    return axis;
}

/* A column has the same s in every row. */
static void transform_textured(soft_state *state, const c3d_draw *draw, uint32_t count)
{
    uint32_t columns = draw->tex_columns < count ? draw->tex_columns : count;
    texel_axis s = make_axis(state, draw, 0, columns - 1),
               t = make_axis(state, draw, 1, (count - 1) / columns);
    const soft_vertex *top = state->vertices;
    for (uint32_t i = 0; i < columns; i++) state->vertices[i].s = texel_q16(&s, i);
    for (uint32_t row = 0, first = 0; first < count; row++, first += columns) {
        soft_vertex *vertex = state->vertices + first;
        uint32_t length = count - first < columns ? count - first : columns;
        int32_t texel = texel_q16(&t, row);
        for (uint32_t i = 0; i < length; i++) {
            vertex[i].s = top[i].s;
            vertex[i].t = texel;
        }
    }
}

static void transform_colours(soft_state *state, const c3d_draw *draw, const c3d_mesh_data *mesh)
{
    for (uint32_t i = 0; i < mesh->count; i++)
        for (int c = 0; c < 4; c++)
            state->vertices[i].rgba[c] = state->paint.coloured ? mesh->vertices[i].rgba[c]
                                                               : (uint8_t)(draw->colour >> (8 * c));
}

/* Fog is linear between its start and end. */
static void transform_fog(soft_state *state, uint32_t count)
{
    const c3d_frame *frame = &state->frame;
    int64_t length = (int64_t)frame->fog_end_wu - frame->fog_start_wu;
    if (length < 1) length = 1;
    int64_t per_wu_q24 = ((int64_t)1 << 32) / length, most = 64 * length;
    for (uint32_t i = 0; i < count; i++) {
        int32_t eye[3];
        soft_eye(state, &state->vertices[i], eye);
        int64_t clear = frame->fog_end_wu - soft_scale64(eye[2], 1 - state->space.shift);
        clear = clear > most ? most : clear < -most ? -most : clear;
        int64_t fog_q8 = (clear * per_wu_q24) >> 24;
        C3D_ASSERT(fog_q8 >= -(1 << 14) && fog_q8 <= 1 << 14);
        state->vertices[i].fog_q8 = (int16_t)fog_q8;
    }
}

/* 1 when a draw's vertices stand where those of the last one stood. */
static int same_places(const c3d_draw *a, const c3d_draw *b)
{
    const uint32_t moves = C3D_DRAW_ON_TOP | C3D_DRAW_BACKDROP;
    for (int i = 0; i < 3; i++)
        if (a->origin_wu[i] != b->origin_wu[i]) return 0;
    return a->mesh.id == b->mesh.id && a->xy_scale_wu == b->xy_scale_wu &&
           a->z_scale_q16 == b->z_scale_q16 && (a->flags & moves) == (b->flags & moves);
}

static int same_looks(const c3d_draw *a, const c3d_draw *b)
{
    for (int i = 0; i < 2; i++)
        if (a->tex_scale_q16[i] != b->tex_scale_q16[i] ||
            a->tex_offset_q16[i] != b->tex_offset_q16[i] ||
            a->tex_first_q16[i] != b->tex_first_q16[i] || a->tex_last_q16[i] != b->tex_last_q16[i])
            return 0;
    return a->flags == b->flags && a->colour == b->colour && a->texture.id == b->texture.id &&
           a->tex_columns == b->tex_columns;
}

static int same_projector(const soft_state *state, const c3d_draw *draw)
{
    return !state->paint.thrown ||
           memcmp(&state->projector, draw->projector, sizeof state->projector) == 0;
}

static void transform_places(soft_state *state, const c3d_resolved_draw *resolved)
{
    const c3d_mesh_data *mesh = resolved->mesh;
    begin_space(state, resolved);
    (state->space.near ? transform_near : transform_far)(state, mesh);
    for (uint32_t i = 0; state->paint.on_top && i < mesh->count; i++)
        put_on_top(&state->vertices[i]);
    if (state->paint.fog) transform_fog(state, mesh->count);
}

/* The strips of a node share its mesh: its vertices are transformed with the first. Further
 * pictures thrown on it leave them where they are. */
void soft_transform(soft_state *state, const c3d_resolved_draw *resolved)
{
    const c3d_draw *draw = resolved->draw;
    const c3d_mesh_data *mesh = resolved->mesh;
    int placed = state->cached_mesh == mesh->vertices && same_places(&state->cached, draw);
    if (placed && same_looks(&state->cached, draw) && same_projector(state, draw)) return;
    if (state->paint.thrown) state->projector = *draw->projector;
    state->cached = *draw;
    state->cached_mesh = mesh->vertices;
    C3D_ASSERT(mesh->count > 0);
    if (!placed) transform_places(state, resolved);
    state->off_texture = 0;
    if (state->paint.thrown)
        soft_transform_thrown(state, draw, mesh);
    else if (state->paint.texture)
        transform_textured(state, draw, mesh->count);
    if (!state->paint.texture || !state->paint.white || state->paint.fog)
        transform_colours(state, draw, mesh);
}
