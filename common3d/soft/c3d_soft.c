/* The back end's table: memory, frames, draws in their order. */
#include "soft_local.h"

#include <string.h>

#define WIDTH_DEFAULT         240
#define HEIGHT_DEFAULT        320
#define TEXTURE_BYTES_DEFAULT 32768 /* for each texture */
#define ROWS_MAX              4096
#define WHITE                 0xFFFFFFFFu

FF_STATIC_ASSERT(ROWS_MAX <= UINT16_MAX && TEXTURE_BYTES_DEFAULT % SOFT_HEAP_UNIT == 0);
FF_STATIC_ASSERT(ROWS_MAX / 2 * SOFT_ONE <
                 SOFT_GUARD_Q4); /* no viewport reaches out of the guard band */

/* ---- memory ---- */

/* The block: state | vertices | textures | colour | depth | open parts of rows | used units
 *            | texels */

typedef struct soft_sizes {
    size_t vertices, textures, colour, depth, rows, used, heap, pixels;
} soft_sizes;

static size_t aligned(size_t bytes) { return (bytes + 15) & ~(size_t)15; }

static void measure(const c3d_desc *desc, soft_sizes *sizes)
{
    size_t texture_bytes = desc->texture_bytes
                               ? desc->texture_bytes
                               : (size_t)desc->texture_count * TEXTURE_BYTES_DEFAULT;
    size_t units = texture_bytes / SOFT_HEAP_UNIT;
    sizes->pixels = (size_t)(desc->width ? desc->width : WIDTH_DEFAULT) *
                    (desc->height ? desc->height : HEIGHT_DEFAULT);
    sizes->vertices = aligned(desc->mesh_vertices_max * sizeof(soft_vertex));
    sizes->textures = aligned(desc->texture_count * sizeof(soft_texture));
    sizes->colour = aligned(sizes->pixels * (desc->frame_format == C3D_RGBA8888 ? 4 : 2));
    sizes->depth = aligned(sizes->pixels * 4);
    sizes->rows = aligned(ROWS_MAX * (2 * sizeof(uint16_t) + sizeof(soft_part)));
    sizes->used = aligned(units);
    sizes->heap = units * SOFT_HEAP_UNIT;
}

static size_t soft_state_bytes(const c3d_desc *desc)
{
    soft_sizes sizes;
    measure(desc, &sizes);
    return aligned(sizeof(soft_state)) + sizes.vertices + sizes.textures + sizes.colour +
           sizes.depth + sizes.rows + sizes.used + sizes.heap;
}

static int soft_open(void *opaque, const c3d_desc *desc, int *buffers)
{
    soft_state *state = opaque;
    soft_sizes sizes;
    measure(desc, &sizes);
    uint8_t *at = (uint8_t *)opaque + aligned(sizeof *state);
    *buffers = 0; /* meshes stay where c3d_device has them */
    state->vertices = (soft_vertex *)(void *)at;
    state->textures = (soft_texture *)(void *)(at += sizes.vertices);
    state->colour = at += sizes.textures;
    state->depth = (uint32_t *)(void *)(at += sizes.colour);
    state->open_from = (uint16_t *)(void *)(at += sizes.depth);
    state->open_to = state->open_from + ROWS_MAX;
    state->covered = (soft_part *)(void *)(state->open_to + ROWS_MAX);
    state->heap_used = at += sizes.rows;
    state->heap = at + sizes.used;
    state->heap_units = (uint32_t)(sizes.heap / SOFT_HEAP_UNIT);
    state->pixels_max = (uint32_t)sizes.pixels;
    state->texture_count = desc->texture_count;
    state->wide = desc->frame_format == C3D_RGBA8888;
    C3D_ASSERT(state->heap + sizes.heap == (uint8_t *)opaque + soft_state_bytes(desc));
    for (uint32_t i = 0; i < 512; i++) /* 2^61/n in the middle of the step */
        state->reciprocal[i] =
            (uint32_t)(((UINT64_C(1) << 61) / (((uint64_t)(i + 512) << 21) + (1 << 20))));
    for (int32_t i = 1; i < SOFT_EDGE_TABLE; i++) state->edge_reciprocal[i] = INT32_MAX / i;
    return FF_OK;
}

static void soft_close(void *state) { (void)state; }

/* ---- a frame ---- */

/* Fills `bytes` bytes by repeating the first `done` of them; each copy doubles what is filled. */
static void repeat(void *start, size_t done, size_t bytes)
{
    C3D_ASSERT(done > 0 && done <= bytes);
    for (uint8_t *at = start; done < bytes; done *= 2)
        memcpy(at + done, at, done < bytes - done ? done : bytes - done);
}

/* Clears the picture, and depths from `first_row` on: above it the last frame marked none. */
static void clear(soft_state *state, uint32_t colour, int32_t first_row)
{
    size_t row_pixels = state->width, pixels = row_pixels * state->height,
           pixel_bytes = state->wide ? 4 : 2;
    if (!pixels) return;
    C3D_ASSERT(pixels <= state->pixels_max && first_row >= 0 && first_row <= state->height);
    if (first_row < state->height) {
        uint32_t *depth = state->depth + (size_t)first_row * row_pixels;
        memset(depth, 0, row_pixels * sizeof *depth);
        repeat(depth, row_pixels * sizeof *depth,
               (size_t)(state->height - first_row) * row_pixels * sizeof *depth);
    }
    soft_put(state, 0, (int32_t)(colour & 255), (int32_t)(colour >> 8 & 255),
             (int32_t)(colour >> 16 & 255));
    repeat(state->colour, pixel_bytes, pixels * pixel_bytes);
}

static void soft_begin(void *opaque, const c3d_frame *frame, const c3d_rotation *rotation)
{
    soft_state *state = opaque;
    const c3d_camera *camera = &frame->camera;
    state->frame = *frame;
    state->blank = (uint32_t)camera->width * camera->height > state->pixels_max;
    int32_t marked = camera->width == state->width && camera->height == state->height &&
                             state->top_row > 0
                         ? state->top_row
                         : 0;
    state->width = state->blank ? 0 : camera->width;
    state->height = state->blank ? 0 : camera->height;
    state->painted = 0;
    state->deferred_count = state->deferred_vertices = 0;
    state->cached_mesh = NULL;
    soft_begin_view(state, rotation);
    clear(state, frame->clear_colour, marked);
    state->top_row = state->height;
    C3D_ASSERT(state->height <= ROWS_MAX && state->width <= ROWS_MAX);
    memset(state->covered, 0, state->height * sizeof *state->covered);
}

static void set_paint(soft_state *state, const c3d_resolved_draw *resolved, enum soft_depth depth)
{
    const c3d_draw *draw = resolved->draw;
    uint32_t flags = draw->flags;
    int wireframe = (flags & C3D_DRAW_WIREFRAME) != 0, backdrop = (flags & C3D_DRAW_BACKDROP) != 0;
    soft_paint *paint = &state->paint;
    C3D_ASSERT(resolved->texture <= state->texture_count);
    C3D_ASSERT(!(flags & C3D_DRAW_TEXTURED) || resolved->texture >= 1);
    C3D_ASSERT(!(flags & C3D_DRAW_PROJECTED) || !(wireframe || backdrop));
    paint->thrown = (flags & C3D_DRAW_PROJECTED) != 0;
    paint->alpha_test = (flags & C3D_DRAW_ALPHA_TEST) != 0;
    paint->texture = (flags & (C3D_DRAW_TEXTURED | C3D_DRAW_PROJECTED)) && !wireframe
                         ? &state->textures[resolved->texture - 1]
                         : NULL;
    paint->depth = depth;
    paint->coloured = (flags & C3D_DRAW_COLOURED) != 0;
    paint->white = !paint->coloured && (draw->colour & 0xFFFFFFu) == (WHITE & 0xFFFFFFu);
    if (paint->thrown) paint->white = paint->alpha_test; /* no other colours are seen */
    paint->through = paint->thrown && paint->alpha_test ? draw->through : 0;
    paint->fog = state->frame.fog_end_wu > 0 && !backdrop;
    paint->on_top = (flags & C3D_DRAW_ON_TOP) != 0;
    paint->unmarked = depth == SOFT_DEPTH_UNCOVERED && !state->deferred_count;
}

static void draw_now(soft_state *state, const c3d_resolved_draw *resolved, enum soft_depth depth)
{
    C3D_ASSERT(resolved->strip->index_max < resolved->mesh->count);
    const c3d_strip_data *strip = resolved->strip;
    set_paint(state, resolved, depth);
    memset(&state->segment, 0, sizeof state->segment);
    soft_transform(state, resolved);
    soft_choose_span(state);
    if (resolved->draw->flags & C3D_DRAW_WIREFRAME)
        soft_lines(state, strip->indices + strip->count, strip->edge_count);
    else if (strip->count && state->paint.thrown)
        soft_thrown_strip(state, strip->indices, strip->count);
    else if (strip->count) /* lines have edges alone */
        soft_strip(state, strip->indices, strip->count);
}

/* Keeps a backdrop for the end of the frame; 0 when there is no room. */
static int defer(soft_state *state, const c3d_resolved_draw *resolved)
{
    uint32_t room = C3D_SOFT_BACKDROP_VERTICES - state->deferred_vertices,
             count = resolved->mesh->count;
    C3D_ASSERT(state->deferred_vertices <= C3D_SOFT_BACKDROP_VERTICES && count > 0);
    if (state->painted || state->deferred_count == C3D_SOFT_BACKDROPS || count > room) return 0;
    c3d_vertex *vertices = state->deferred_vertex + state->deferred_vertices;
    soft_deferred *deferred = &state->deferred[state->deferred_count++];
    deferred->draw = *resolved->draw;
    deferred->mesh = *resolved->mesh;
    deferred->resolved = *resolved;
    memcpy(vertices, resolved->mesh->vertices, count * sizeof *vertices);
    deferred->mesh.vertices = vertices;
    state->deferred_vertices += count;
    deferred->resolved.draw = &deferred->draw;
    deferred->resolved.mesh = &deferred->mesh;
    return 1;
}

/* Draws the backdrops that waited, the last one first: it hides the others. */
static void draw_deferred(soft_state *state)
{
    C3D_ASSERT(state->deferred_count <= C3D_SOFT_BACKDROPS);
    if (state->deferred_count) soft_find_open_parts(state);
    while (state->deferred_count) {
        state->open_rows = state->top_row;
        draw_now(state, &state->deferred[--state->deferred_count].resolved, SOFT_DEPTH_UNCOVERED);
    }
    if (state->paint.unmarked) state->top_row = state->open_rows;
    state->paint.unmarked = 0;
    state->painted = 1;
}

static void soft_draw(void *opaque, const c3d_resolved_draw *resolved)
{
    soft_state *state = opaque;
    int backdrop = (resolved->draw->flags & C3D_DRAW_BACKDROP) != 0;
    if (state->blank || (backdrop && defer(state, resolved))) return;
    if (backdrop) draw_deferred(state);
    if (!backdrop) state->painted = 1;
    draw_now(state, resolved, backdrop ? SOFT_DEPTH_NONE : SOFT_DEPTH_TEST);
}

static void soft_draw_points(void *opaque, const c3d_resolved_draw *resolved)
{
    soft_state *state = opaque;
    if (state->blank) return;
    state->painted = 1;
    state->paint = (soft_paint){ .depth = SOFT_DEPTH_TEST,
                                 .coloured = (resolved->draw->flags & C3D_DRAW_COLOURED) != 0,
                                 .fog = state->frame.fog_end_wu > 0,
                                 .on_top = (resolved->draw->flags & C3D_DRAW_ON_TOP) != 0 };
    soft_transform(state, resolved);
    soft_points(state, resolved->mesh->count, resolved->draw->point_px);
}

/* Frees a texture. A backdrop that waits may use it, so the backdrops are drawn first. */
static void soft_texture_drop(void *opaque, uint32_t texture)
{
    soft_state *state = opaque;
    draw_deferred(state);
    state->cached_mesh = NULL;
    soft_texture_free(state, texture);
}

static void soft_overlay(void *opaque, uint32_t name, int x, int y, int width, int height)
{
    C3D_ASSERT(name >= 1 && name <= ((soft_state *)opaque)->texture_count);
    soft_state *state = opaque;
    const soft_texture *texture = &state->textures[name - 1];
    if (width < 1 || height < 1) return;
    draw_deferred(state);
    for (int row = y < 0 ? -y : 0; row < height && y + row < state->height; row++)
        for (int column = x < 0 ? -x : 0; column < width && x + column < state->width; column++) {
            int32_t texel[4];
            uint8_t under[3];
            uint32_t at = (uint32_t)((y + row) * state->width + x + column);
            soft_sample(
                texture,
                (int32_t)((2 * (int64_t)column + 1) * texture->width * 32768 / width) - 32768,
                (int32_t)((2 * (int64_t)row + 1) * texture->height * 32768 / height) - 32768,
                texel);
            if (!texel[3]) continue;
            soft_get(state, at, under);
            for (int i = 0; i < 3; i++)
                texel[i] = (texel[i] * texel[3] + under[i] * (255 - texel[3]) + 127) / 255;
            soft_put(state, at, texel[0], texel[1], texel[2]);
        }
}

static void soft_end(void *state) { draw_deferred(state); }

static int soft_read_rows(void *opaque, uint32_t width, uint32_t first_row, uint32_t rows,
                          uint8_t *rgba)
{
    const soft_state *state = opaque;
    C3D_ASSERT(state->blank || (width == state->width && first_row + rows <= state->height));
    for (uint32_t row = first_row; row < first_row + rows; row++)
        for (uint32_t x = 0; x < width; x++, rgba += 4) {
            for (int i = 0; i < 3; i++) rgba[i] = (uint8_t)(state->frame.clear_colour >> (8 * i));
            if (!state->blank) soft_get(state, (state->height - 1 - row) * width + x, rgba);
            rgba[3] = 255;
        }
    return FF_OK;
}

static void soft_read_depth(void *opaque, int32_t *depth_wu)
{
    const soft_state *state = opaque;
    uint64_t near_q30 = (uint64_t)(uint32_t)state->frame.camera.near_wu << 30;
    uint32_t pixels = (uint32_t)state->width * state->height;
    for (uint32_t i = 0; i < pixels; i++) {
        uint32_t w = state->depth[i]; /* 0 and 1: nothing, or a backdrop */
        uint64_t far_wu = w > 1 ? near_q30 / w : INT32_MAX;
        depth_wu[i] = far_wu < INT32_MAX ? (int32_t)far_wu : INT32_MAX;
    }
}

static const void *soft_pixels(void *opaque, enum c3d_texture_format *format)
{
    const soft_state *state = opaque;
    *format = state->wide ? C3D_RGBA8888 : C3D_RGB565;
    return state->blank || !state->width ? NULL : state->colour;
}

const struct c3d_backend *c3d_backend_soft(void)
{
    static const struct c3d_backend backend = { .name = "soft",
                                                .state_bytes = soft_state_bytes,
                                                .open = soft_open,
                                                .close = soft_close,
                                                .texture_upload = soft_texture_upload,
                                                .texture_free = soft_texture_drop,
                                                .begin = soft_begin,
                                                .draw = soft_draw,
                                                .points = soft_draw_points,
                                                .label = soft_label,
                                                .flush = soft_end,
                                                .overlay = soft_overlay,
                                                .end = soft_end,
                                                .read_rows = soft_read_rows,
                                                .pixels = soft_pixels,
                                                .read_depth = soft_read_depth };
    return &backend;
}
