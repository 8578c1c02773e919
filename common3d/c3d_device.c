/* Handles, pools and counters of a device; everything about graphics is behind its back end.
 *
 * The block: device | back end's state | mesh slots | strip slots | texture slots | label slots
 *            | edge scratch | vertex copies | index copies
 * The copies are there for plain arrays only: with vertex buffers the graphics library has the
 * data.
 */
#include "c3d_font.h"
#include "c3d_assert.h"
#include "c3d_pool.h"
#include "c3d_text.h"

#include <stddef.h>
#include <string.h>

#define READ_BYTES 65536 /* rows read back at once */
#define SIDE_MAX   4096  /* of pictures and textures */

FF_STATIC_ASSERT(READ_BYTES >= SIDE_MAX * 4);
FF_STATIC_ASSERT(sizeof(c3d_vertex) == 16);

typedef struct mesh_slot {
    c3d_slot slot;
    c3d_mesh_data data;
} mesh_slot;

typedef struct strip_slot {
    c3d_slot slot;
    c3d_strip_data data;
    uint32_t first, room; /* its part of the indices */
    uint32_t next;        /* the strip whose part comes after it, or NO_STRIP */
} strip_slot;

#define NO_STRIP UINT32_MAX

typedef struct texture_slot {
    c3d_slot slot;
    uint32_t texture;
} texture_slot;

typedef struct label_slot {
    c3d_slot slot;
    char text[C3D_LABEL_CHARS + 1];
} label_slot;

/* a pool knows a slot by its first member alone */
FF_STATIC_ASSERT(offsetof(mesh_slot, slot) == 0 && offsetof(strip_slot, slot) == 0);
FF_STATIC_ASSERT(offsetof(texture_slot, slot) == 0 && offsetof(label_slot, slot) == 0);
FF_STATIC_ASSERT(sizeof(label_slot) == 32); /* as c3d_desc says */

struct c3d_device {
    const struct c3d_backend *backend;
    void *state;
    c3d_desc desc;
    c3d_pool meshes, strips, textures;
    void *scratch;        /* a strip and its edges, or a mesh, before they are uploaded */
    c3d_vertex *vertices; /* mesh_vertices_max for each mesh slot; NULL with vertex buffers */
    uint16_t *indices;    /* INDEX_WORDS for each index; NULL with vertex buffers */
    uint32_t first_strip; /* in the order of their parts of strip_indices_max, or NO_STRIP */
    c3d_frame frame;
    c3d_rotation rotation;
    int64_t origin_wu[3], eye_q14[3]; /* of the last draw: all nodes of a ground have the same */
    c3d_stats stats;
    c3d_pool labels;
    uint8_t read[READ_BYTES];
};

#define INDEX_WORDS 5 /* an index and up to four words of edges, see c3d_strip_edges */

typedef struct block_part {
    uint8_t *memory;
    size_t used;
} block_part;

/* Next part of the block, aligned to 16; NULL while only measuring. */
static void *take(block_part *block, size_t bytes)
{
    C3D_ASSERT(((uintptr_t)block->memory & 15) == 0 && block->used % 16 == 0);
    void *part = block->memory ? block->memory + block->used : NULL;
    block->used += (bytes + 15) & ~(size_t)15;
    return part;
}

/* Lays the device out in the block, or only measures when the block has no memory. `plain` asks for
 * room for copies. */
static c3d_device *lay_out(block_part *block, const struct c3d_backend *backend,
                           const c3d_desc *desc, int plain)
{
    c3d_device *device = take(block, sizeof *device);
    void *state = take(block, backend->state_bytes(desc));
    void *meshes = take(block, desc->mesh_count * sizeof(mesh_slot));
    void *strips = take(block, desc->strip_count * sizeof(strip_slot));
    void *textures = take(block, desc->texture_count * sizeof(texture_slot));
    void *labels = take(block, desc->label_count * sizeof(label_slot));
    size_t mesh_bytes = desc->mesh_vertices_max * sizeof(c3d_vertex),
           strip_bytes = (size_t)desc->strip_indices_max * INDEX_WORDS * sizeof(uint16_t);
    void *scratch = take(block, mesh_bytes > strip_bytes ? mesh_bytes : strip_bytes);
    c3d_vertex *vertices = plain ? take(block, desc->mesh_count * mesh_bytes) : NULL;
    uint16_t *indices = plain ? take(block, strip_bytes) : NULL;
    if (!device) return NULL;
    memset(block->memory, 0, block->used);
    device->backend = backend;
    device->state = state;
    device->desc = *desc;
    device->scratch = scratch;
    device->vertices = vertices;
    device->indices = indices;
    device->first_strip = NO_STRIP;
    c3d_pool_init(&device->meshes, meshes, sizeof(mesh_slot), desc->mesh_count);
    c3d_pool_init(&device->strips, strips, sizeof(strip_slot), desc->strip_count);
    c3d_pool_init(&device->textures, textures, sizeof(texture_slot), desc->texture_count);
    c3d_pool_init(&device->labels, labels, sizeof(label_slot), desc->label_count);
    return device;
}

static size_t bytes_for(const struct c3d_backend *backend, const c3d_desc *desc, int plain)
{
    block_part measure = { NULL, 0 };
    lay_out(&measure, backend, desc, plain);
    return measure.used + 15; /* for a block that is not aligned */
}

static int wants_buffers(const struct c3d_backend *backend, const c3d_desc *desc)
{
    return desc->use_vertex_buffers && backend->mesh_upload;
}

size_t c3d_bytes(const struct c3d_backend *backend, const c3d_desc *desc)
{
    return bytes_for(backend, desc, !wants_buffers(backend, desc));
}

int c3d_open(const struct c3d_backend *backend, const c3d_desc *desc, void *memory, size_t bytes,
             c3d_device **device)
{
    if (bytes < c3d_bytes(backend, desc)) return FF_ERR_MEMORY;
    block_part block = { (uint8_t *)memory + (-(uintptr_t)memory & 15), 0 };
    int buffers = wants_buffers(backend, desc),
        plain = !buffers || bytes >= bytes_for(backend, desc, 1);
    c3d_device *opened = lay_out(&block, backend, desc, plain);
    C3D_ASSERT((size_t)(block.memory - (uint8_t *)memory) + block.used <= bytes);
    int rc = backend->open(opened->state, desc, &buffers);
    if (rc < 0) return rc;
    if (!buffers && !plain) {
        backend->close(opened->state);
        return FF_ERR_MEMORY;
    }
    if (buffers) opened->vertices = NULL;
    if (buffers) opened->indices = NULL;
    opened->stats.vertex_buffers_used = (uint8_t)buffers;
    *device = opened;
    return FF_OK;
}

void c3d_close(c3d_device *device)
{
    for (uint32_t i = 0; i < device->meshes.count; i++) {
        mesh_slot *mesh = c3d_pool_at(&device->meshes, i);
        if (mesh->data.buffer) device->backend->buffer_free(device->state, mesh->data.buffer);
    }
    for (uint32_t i = 0; i < device->strips.count; i++) {
        strip_slot *strip = c3d_pool_at(&device->strips, i);
        if (strip->data.buffer) device->backend->buffer_free(device->state, strip->data.buffer);
    }
    for (uint32_t i = 0; i < device->textures.count; i++) {
        texture_slot *texture = c3d_pool_at(&device->textures, i);
        if (texture->texture) device->backend->texture_free(device->state, texture->texture);
    }
    device->backend->close(device->state);
}

static void measure_extent(c3d_mesh_data *mesh, const c3d_vertex *vertices)
{
    C3D_ASSERT(mesh->count > 0);
    for (uint32_t i = 0; i < mesh->count; i++) {
        const int32_t at[3] = { vertices[i].x, vertices[i].y, vertices[i].z };
        for (int axis = 0; axis < 3; axis++) {
            if (i == 0 || at[axis] < mesh->least[axis]) mesh->least[axis] = at[axis];
            if (i == 0 || at[axis] > mesh->most[axis]) mesh->most[axis] = at[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        C3D_ASSERT(mesh->least[axis] <= mesh->most[axis]);
        int64_t below = -(int64_t)mesh->least[axis], above = mesh->most[axis];
        mesh->reach[axis] = (uint32_t)(below > above ? below : above);
    }
}

/* Copies the vertices to where they stay, or to where they are uploaded from. */
static c3d_vertex *copy_mesh(c3d_device *device, uint32_t id, const c3d_vertex *vertices,
                             uint32_t count)
{
    size_t first = (size_t)c3d_pool_index(id) * device->desc.mesh_vertices_max;
    c3d_vertex *copy = device->vertices ? device->vertices + first : device->scratch;
    memcpy(copy, vertices, count * sizeof *vertices);
    if (device->backend->mesh_form) device->backend->mesh_form(copy, count);
    return copy;
}

c3d_mesh c3d_mesh_make(c3d_device *device, const c3d_vertex *vertices, uint32_t count)
{
    c3d_mesh none = { 0 };
    if (count == 0 || count > device->desc.mesh_vertices_max) return none;
    uint32_t id = c3d_pool_take(&device->meshes);
    mesh_slot *mesh = c3d_pool_get(&device->meshes, id);
    if (!mesh) return none;
    mesh->data = (c3d_mesh_data){ .count = count };
    measure_extent(&mesh->data, vertices);
    const c3d_vertex *copy = copy_mesh(device, id, vertices, count);
    if (device->vertices)
        mesh->data.vertices = copy;
    else
        mesh->data.buffer = device->backend->mesh_upload(device->state, copy, count);
    if (!mesh->data.vertices && !mesh->data.buffer) {
        c3d_pool_give(&device->meshes, id);
        return none;
    }
    C3D_ASSERT(!mesh->data.vertices == (mesh->data.buffer != 0));
    return (c3d_mesh){ id };
}

void c3d_mesh_free(c3d_device *device, c3d_mesh mesh)
{
    if (mesh.id == 0) return;
    mesh_slot *slot = c3d_pool_get(&device->meshes, mesh.id);
    if (!slot) {
        device->stats.stale_handles++;
        return;
    }
    if (slot->data.buffer) device->backend->buffer_free(device->state, slot->data.buffer);
    slot->data = (c3d_mesh_data){ 0 };
    c3d_pool_give(&device->meshes, mesh.id);
}

/* The first gap between the strips' parts of the indices that holds `room`: *link names the strip
 * after it. Returns where the gap begins. */
static uint32_t find_gap(c3d_device *device, uint32_t room, uint32_t **link)
{
    uint32_t begin = 0;
    for (*link = &device->first_strip; **link != NO_STRIP;) {
        strip_slot *strip = c3d_pool_at(&device->strips, **link);
        C3D_ASSERT(strip->first >= begin && strip->room > 0);
        if (strip->first - begin >= room) break;
        begin = strip->first + strip->room;
        *link = &strip->next;
    }
    return begin;
}

/* Takes a slot and its part of the indices; *words receives where the indices go. NULL when there
 * is no room. */
static strip_slot *take_strip(c3d_device *device, uint32_t room, uint32_t *id, uint16_t **words)
{
    uint32_t *link, first = find_gap(device, room, &link), end = first + room;
    if (room > device->desc.strip_indices_max || end > device->desc.strip_indices_max) return NULL;
    C3D_ASSERT((device->first_strip == NO_STRIP) == (device->strips.in_use == 0));
    C3D_ASSERT(*link == NO_STRIP ||
               ((strip_slot *)c3d_pool_at(&device->strips, *link))->first >= end);
    *id = c3d_pool_take(&device->strips);
    strip_slot *strip = c3d_pool_get(&device->strips, *id);
    if (!strip) return NULL;
    strip->data = (c3d_strip_data){ .count = 0 };
    strip->first = first;
    strip->room = room;
    strip->next = *link;
    *link = c3d_pool_index(*id);
    if (end > device->stats.strip_indices_high) device->stats.strip_indices_high = end;
    *words = device->indices ? device->indices + (size_t)first * INDEX_WORDS : device->scratch;
    return strip;
}

static void give_strip(c3d_device *device, uint32_t id)
{
    strip_slot *strip = c3d_pool_get(&device->strips, id);
    uint32_t *link = &device->first_strip;
    while (*link != c3d_pool_index(id))
        link = &((strip_slot *)c3d_pool_at(&device->strips, *link))->next;
    C3D_ASSERT(strip->next == NO_STRIP || strip->next < device->strips.count);
    *link = strip->next;
    if (strip->data.buffer) device->backend->buffer_free(device->state, strip->data.buffer);
    strip->data = (c3d_strip_data){ .count = 0 };
    c3d_pool_give(&device->strips, id);
}

/* Finishes a strip whose words are in place: its handle, or id 0 when the graphics library has no
 * room. */
static c3d_strip finish_strip(c3d_device *device, uint32_t id, const uint16_t *words)
{
    strip_slot *strip = c3d_pool_get(&device->strips, id);
    c3d_strip_data *data = &strip->data;
    uint32_t count = data->count + data->edge_count;
    C3D_ASSERT(count > 0 && count <= strip->room * INDEX_WORDS);
    C3D_ASSERT(data->edge_count % 2 == 0 && data->triangles <= data->count);
    for (uint32_t i = 0; i < count; i++)
        if (words[i] > data->index_max) data->index_max = words[i];
    if (device->indices)
        data->indices = words;
    else
        data->buffer = device->backend->strip_upload(device->state, words, count);
    if (!data->indices && !data->buffer) {
        give_strip(device, id);
        id = 0;
    }
    return (c3d_strip){ id };
}

c3d_strip c3d_strip_make(c3d_device *device, const uint16_t *indices, uint32_t count)
{
    uint32_t id;
    uint16_t *words;
    strip_slot *strip = count < 3 ? NULL : take_strip(device, count, &id, &words);
    if (!strip) return (c3d_strip){ 0 };
    strip->data.count = count;
    memcpy(words, indices, count * sizeof *indices);
    strip->data.edge_count = c3d_strip_edges(indices, count, words + count, &strip->data.triangles);
    return finish_strip(device, id, words);
}

c3d_strip c3d_lines_make(c3d_device *device, const uint16_t *indices, uint32_t count)
{
    uint32_t id, room = count / INDEX_WORDS + (count % INDEX_WORDS != 0);
    uint16_t *words;
    strip_slot *strip = count < 2 || count & 1 ? NULL : take_strip(device, room, &id, &words);
    if (!strip) return (c3d_strip){ 0 };
    strip->data.edge_count = count;
    memcpy(words, indices, count * sizeof *indices);
    return finish_strip(device, id, words);
}

void c3d_strip_free(c3d_device *device, c3d_strip strip)
{
    if (strip.id == 0) return;
    if (!c3d_pool_get(&device->strips, strip.id)) {
        device->stats.stale_handles++;
        return;
    }
    if (device->backend->flush) device->backend->flush(device->state);
    give_strip(device, strip.id);
}

static int is_power_of_two(uint32_t value) { return value != 0 && (value & (value - 1)) == 0; }

c3d_texture c3d_texture_make(c3d_device *device, enum c3d_texture_format format, uint32_t width,
                             uint32_t height, const void *pixels)
{
    c3d_texture none = { 0 };
    if (!is_power_of_two(width) || !is_power_of_two(height) || width > SIDE_MAX ||
        height > SIDE_MAX)
        return none;
    uint32_t id = c3d_pool_take(&device->textures);
    texture_slot *texture = c3d_pool_get(&device->textures, id);
    if (!texture) return none;
    texture->texture = device->backend->texture_upload(device->state, format, width, height,
                                                       pixels);
    if (!texture->texture) {
        c3d_pool_give(&device->textures, id);
        return none;
    }
    return (c3d_texture){ id };
}

void c3d_texture_free(c3d_device *device, c3d_texture texture)
{
    if (texture.id == 0) return;
    texture_slot *slot = c3d_pool_get(&device->textures, texture.id);
    if (!slot) {
        device->stats.stale_handles++;
        return;
    }
    device->backend->texture_free(device->state, slot->texture);
    slot->texture = 0;
    c3d_pool_give(&device->textures, texture.id);
}

c3d_label c3d_label_make(c3d_device *device, const char *text)
{
    size_t length = 0;
    while (length < C3D_LABEL_CHARS && text[length]) length++;
    uint32_t id = length ? c3d_pool_take(&device->labels) : 0;
    label_slot *label = c3d_pool_get(&device->labels, id);
    if (!label) return (c3d_label){ 0 };
    memcpy(label->text, text, length);
    label->text[length] = 0;
    return (c3d_label){ id };
}

void c3d_label_free(c3d_device *device, c3d_label label)
{
    if (label.id == 0) return;
    if (c3d_pool_get(&device->labels, label.id))
        c3d_pool_give(&device->labels, label.id);
    else
        device->stats.stale_handles++;
}

void c3d_begin(c3d_device *device, const c3d_frame *frame)
{
    C3D_ASSERT(frame->camera.width >= 1 && frame->camera.width <= SIDE_MAX);
    C3D_ASSERT(frame->camera.height >= 1 && frame->camera.height <= SIDE_MAX);
    C3D_ASSERT(frame->camera.near_wu > 0 && frame->camera.near_wu < frame->camera.far_wu);
    device->frame = *frame;
    device->stats.frame_triangles = 0;
    device->stats.frame_draws = 0;
    c3d_rotation_from_camera(&frame->camera, &device->rotation);
    c3d_to_eye_q14(&device->rotation, device->origin_wu, device->eye_q14);
    device->backend->begin(device->state, frame, &device->rotation);
}

static void find_origin(c3d_device *device, const int64_t origin_wu[3])
{
    int64_t *last = device->origin_wu;
    if (last[0] == origin_wu[0] && last[1] == origin_wu[1] && last[2] == origin_wu[2]) return;
    memcpy(last, origin_wu, sizeof device->origin_wu);
    c3d_to_eye_q14(&device->rotation, last, device->eye_q14);
}

void c3d_draw_strip(c3d_device *device, const c3d_draw *given)
{
    c3d_draw plain;
    const c3d_draw *draw = given;
    if ((given->flags & C3D_DRAW_PROJECTED) &&
        (!given->projector || !c3d_pool_get(&device->textures, given->texture.id))) {
        device->stats.stale_handles++;
        if (given->flags & C3D_DRAW_ALPHA_TEST) return;
        plain = *given;
        plain.flags &= ~(uint32_t)C3D_DRAW_PROJECTED;
        draw = &plain;
    }
    if ((draw->flags & C3D_DRAW_PROJECTED) &&
        (draw->flags & (C3D_DRAW_WIREFRAME | C3D_DRAW_BACKDROP))) {
        plain = *draw;
        plain.flags &= ~(uint32_t)C3D_DRAW_PROJECTED;
        draw = &plain;
    }
    int textured = (draw->flags & (C3D_DRAW_TEXTURED | C3D_DRAW_PROJECTED)) != 0;
    const mesh_slot *mesh = c3d_pool_get(&device->meshes, draw->mesh.id);
    const strip_slot *strip = c3d_pool_get(&device->strips, draw->strip.id);
    const texture_slot *texture = textured ? c3d_pool_get(&device->textures, draw->texture.id)
                                           : NULL;
    if (!mesh || !strip || (textured && !texture) || strip->data.index_max >= mesh->data.count) {
        device->stats.stale_handles++;
        return;
    }
    C3D_ASSERT(!(draw->flags & C3D_DRAW_TEXTURED) || draw->tex_columns >= 1);
    C3D_ASSERT((draw->flags & (C3D_DRAW_TEXTURED | C3D_DRAW_PROJECTED)) !=
               (C3D_DRAW_TEXTURED | C3D_DRAW_PROJECTED));
    find_origin(device, draw->origin_wu);
    c3d_resolved_draw resolved = { draw,
                                   &mesh->data,
                                   &strip->data,
                                   texture ? texture->texture : 0,
                                   { device->eye_q14[0], device->eye_q14[1], device->eye_q14[2] } };
    device->backend->draw(device->state, &resolved);
    device->stats.frame_draws++;
    if (!(draw->flags & C3D_DRAW_WIREFRAME)) device->stats.frame_triangles += strip->data.triangles;
}

void c3d_draw_points(c3d_device *device, const c3d_draw *draw)
{
    C3D_ASSERT(draw->point_px >= 1 && draw->point_px <= 64);
    const mesh_slot *mesh = c3d_pool_get(&device->meshes, draw->mesh.id);
    if (!mesh) {
        device->stats.stale_handles++;
        return;
    }
    c3d_draw points = *draw;
    points.flags &= C3D_DRAW_COLOURED | C3D_DRAW_ON_TOP;
    c3d_resolved_draw resolved = { .draw = &points, .mesh = &mesh->data };
    c3d_to_eye_q14(&device->rotation, points.origin_wu, resolved.eye_q14);
    device->backend->points(device->state, &resolved);
    device->stats.frame_draws++;
}

/* Where a coordinate of eye space lies on the screen, in pixels from the left or the top. */
static int64_t screen_px(int64_t eye_q14, int64_t z_q14, const c3d_camera *camera, int size_px)
{
    C3D_ASSERT(z_q14 > 0);
    int64_t offset_q8 = c3d_muldiv64(eye_q14, camera->focal_q8, z_q14), most = (int64_t)1 << 40;
    offset_q8 = offset_q8 > most ? most : offset_q8 < -most ? -most : offset_q8;
    return (offset_q8 + size_px * 128) >> 8;
}

void c3d_draw_label(c3d_device *device, const c3d_label_draw *draw)
{
    const label_slot *label = c3d_pool_get(&device->labels, draw->label.id);
    const c3d_camera *camera = &device->frame.camera;
    int64_t eye[3], near_q14 = (int64_t)camera->near_wu << C3D_EYE_SHIFT;
    if (!label) {
        device->stats.stale_handles++;
        return;
    }
    c3d_to_eye_q14(&device->rotation, draw->origin_wu, eye);
    if (eye[2] < near_q14 || eye[2] > (int64_t)camera->far_wu << C3D_EYE_SHIFT) return;
    int width_px = (int)strlen(label->text) * C3D_TEXT_ADVANCE_PX - 1;
    C3D_ASSERT(width_px > 0 && width_px < C3D_LABEL_CHARS * C3D_TEXT_ADVANCE_PX);
    int64_t nearer = eye[2] - (eye[2] >> 6),
            x = screen_px(eye[0], eye[2], camera, camera->width) - width_px / 2 + draw->right_px,
            y = screen_px(-eye[1], eye[2], camera, camera->height) - C3D_FONT_ROWS + 1 +
                draw->down_px;
    if (x <= -width_px || x >= camera->width || y <= -C3D_FONT_ROWS || y >= camera->height) return;
    device->backend->label(device->state,
                           &(c3d_placed_label){ .text = label->text,
                                                .x = (int32_t)x,
                                                .y = (int32_t)y,
                                                .z_q14 = nearer < near_q14 ? near_q14 : nearer,
                                                .colour = draw->colour });
    device->stats.frame_draws++;
}

void c3d_overlay(c3d_device *device, c3d_texture texture, int x, int y, int width, int height)
{
    const texture_slot *slot = c3d_pool_get(&device->textures, texture.id);
    if (slot)
        device->backend->overlay(device->state, slot->texture, x, y, width, height);
    else
        device->stats.stale_handles++;
}

void c3d_end(c3d_device *device) { device->backend->end(device->state); }

int c3d_read_rgb(c3d_device *device, uint8_t *rgb)
{
    uint32_t width = device->frame.camera.width, height = device->frame.camera.height;
    if (width == 0) return FF_ERR_ARGUMENT; /* no frame was begun yet */
    uint32_t at_once = READ_BYTES / (width * 4);
    C3D_ASSERT(at_once >= 1);
    for (uint32_t first = 0; first < height; first += at_once) {
        uint32_t rows = height - first < at_once ? height - first : at_once;
        int rc = device->backend->read_rows(device->state, width, first, rows, device->read);
        if (rc < 0) return rc;
        for (uint32_t row = 0; row < rows; row++) {
            uint8_t *out = rgb + (size_t)(height - 1 - first - row) * width * 3;
            const uint8_t *in = device->read + (size_t)row * width * 4;
            for (uint32_t x = 0; x < width; x++, out += 3, in += 4) memcpy(out, in, 3);
        }
    }
    return FF_OK;
}

const void *c3d_frame_pixels(c3d_device *device, enum c3d_texture_format *format)
{
    return device->backend->pixels ? device->backend->pixels(device->state, format) : NULL;
}

int c3d_read_depth(c3d_device *device, int32_t *depth_wu)
{
    if (device->frame.camera.width == 0) return FF_ERR_ARGUMENT; /* no frame was begun yet */
    if (!device->backend->read_depth) return FF_ERR_UNSUPPORTED;
    device->backend->read_depth(device->state, depth_wu);
    return FF_OK;
}

void c3d_get_stats(const c3d_device *device, c3d_stats *stats)
{
    C3D_ASSERT(device->stats.strip_indices_high <= device->desc.strip_indices_max);
    *stats = device->stats;
    stats->mesh_held = device->meshes.in_use;
    stats->strip_held = device->strips.in_use;
    stats->texture_held = device->textures.in_use;
    stats->mesh_high = device->meshes.high;
    stats->strip_high = device->strips.high;
    stats->texture_high = device->textures.high;
    stats->label_high = device->labels.high;
}
