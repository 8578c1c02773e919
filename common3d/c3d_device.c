/* Handles, pools and counters of a device; everything about graphics is behind its back end.
 *
 * The block:  device | back end's state | mesh slots | strip slots | texture slots | edge scratch |
 * [vertex copies | index copies] The copies in brackets are for plain arrays only: with vertex
 * buffers the graphics library has the data.
 */
#include "c3d_pool.h"

#include <assert.h>
#include <string.h>

#define READ_BYTES 65536 /* rows read back at once: at least one of 4096 pixels */

typedef struct mesh_slot {
    c3d_slot slot;
    c3d_mesh_data data;
} mesh_slot;

typedef struct strip_slot {
    c3d_slot slot;
    c3d_strip_data data;
} strip_slot;

typedef struct texture_slot {
    c3d_slot slot;
    uint32_t texture;
} texture_slot;

struct c3d_device {
    const struct c3d_backend *backend;
    void *state;
    c3d_desc desc;
    c3d_pool meshes, strips, textures;
    uint16_t *scratch;     /* a strip and its edges, before they are uploaded */
    c3d_vertex *vertices;  /* mesh_vertices_max for each mesh slot; NULL with vertex buffers */
    uint16_t *indices;     /* INDEX_WORDS for each index; NULL with vertex buffers */
    uint32_t indices_used; /* of strip_indices_max */
    c3d_frame frame;
    c3d_rotation rotation;
    int64_t origin_wu[3], eye_q14[3]; /* of the last draw: those of a ground's nodes are one */
    c3d_stats stats;
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
    void *part = block->memory ? block->memory + block->used : NULL;
    block->used += (bytes + 15) & ~(size_t)15;
    return part;
}

/* Lays the device out in the block, or only measures when there is no memory. `plain`: with room
 * for copies. */
static c3d_device *lay_out(block_part *block, const struct c3d_backend *backend,
                           const c3d_desc *desc, int plain)
{
    c3d_device *device = take(block, sizeof *device);
    void *state = take(block, backend->state_bytes_for ? backend->state_bytes_for(desc)
                                                       : backend->state_bytes);
    void *meshes = take(block, desc->mesh_count * sizeof(mesh_slot));
    void *strips = take(block, desc->strip_count * sizeof(strip_slot));
    void *textures = take(block, desc->texture_count * sizeof(texture_slot));
    uint16_t *scratch = take(block,
                             (size_t)desc->strip_indices_max * INDEX_WORDS * sizeof(uint16_t));
    c3d_vertex *vertices = NULL;
    uint16_t *indices = NULL;
    if (plain) {
        vertices = take(block,
                        (size_t)desc->mesh_count * desc->mesh_vertices_max * sizeof(c3d_vertex));
        indices = take(block, (size_t)desc->strip_indices_max * INDEX_WORDS * sizeof(uint16_t));
    }
    if (!device) return NULL;
    memset(block->memory, 0, block->used);
    device->backend = backend;
    device->state = state;
    device->desc = *desc;
    device->scratch = scratch;
    device->vertices = vertices;
    device->indices = indices;
    c3d_pool_init(&device->meshes, meshes, sizeof(mesh_slot), desc->mesh_count);
    c3d_pool_init(&device->strips, strips, sizeof(strip_slot), desc->strip_count);
    c3d_pool_init(&device->textures, textures, sizeof(texture_slot), desc->texture_count);
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
    for (uint32_t i = 0; i < mesh->count; i++) {
        const int16_t at[3] = { vertices[i].x, vertices[i].y, vertices[i].z };
        for (int axis = 0; axis < 3; axis++) {
            if (i == 0 || at[axis] < mesh->least[axis]) mesh->least[axis] = at[axis];
            if (i == 0 || at[axis] > mesh->most[axis]) mesh->most[axis] = at[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++)
        mesh->reach[axis] = (uint16_t)(-mesh->least[axis] > mesh->most[axis] ? -mesh->least[axis]
                                                                             : mesh->most[axis]);
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
    if (device->vertices) {
        c3d_vertex *copy = device->vertices +
                           (size_t)c3d_pool_index(id) * device->desc.mesh_vertices_max;
        memcpy(copy, vertices, count * sizeof *vertices);
        mesh->data.vertices = copy;
    } else {
        mesh->data.buffer = device->backend->mesh_upload(device->state, vertices, count);
        if (!mesh->data.buffer) {
            c3d_pool_give(&device->meshes, id);
            return none;
        }
    }
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

c3d_strip c3d_strip_make(c3d_device *device, const uint16_t *indices, uint32_t count)
{
    c3d_strip none = { 0 };
    if (count < 3 || count > device->desc.strip_indices_max - device->indices_used) return none;
    uint32_t id = c3d_pool_take(&device->strips);
    strip_slot *strip = c3d_pool_get(&device->strips, id);
    if (!strip) return none;
    c3d_strip_data *data = &strip->data;
    *data = (c3d_strip_data){ .count = count };
    uint16_t *words = device->indices ? device->indices + (size_t)device->indices_used * INDEX_WORDS
                                      : device->scratch;
    memcpy(words, indices, count * sizeof *indices);
    data->edge_count = c3d_strip_edges(indices, count, words + count, &data->triangles);
    for (uint32_t i = 0; i < count; i++)
        if (indices[i] > data->index_max) data->index_max = indices[i];
    if (device->indices) {
        data->indices = words;
    } else {
        data->buffer = device->backend->strip_upload(device->state, words,
                                                     count + data->edge_count);
        if (!data->buffer) {
            c3d_pool_give(&device->strips, id);
            return none;
        }
    }
    device->indices_used += count;
    return (c3d_strip){ id };
}

static int is_power_of_two(uint32_t value) { return value != 0 && (value & (value - 1)) == 0; }

c3d_texture c3d_texture_make(c3d_device *device, enum c3d_texture_format format, uint32_t width,
                             uint32_t height, const void *pixels)
{
    c3d_texture none = { 0 };
    if (!is_power_of_two(width) || !is_power_of_two(height) || width > 4096 || height > 4096)
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

void c3d_begin(c3d_device *device, const c3d_frame *frame)
{
    assert(frame->camera.width >= 1 && frame->camera.width <= 4096);
    assert(frame->camera.height >= 1 && frame->camera.height <= 4096);
    assert(frame->camera.near_wu > 0 && frame->camera.near_wu < frame->camera.far_wu);
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

void c3d_draw_strip(c3d_device *device, const c3d_draw *draw)
{
    int textured = (draw->flags & C3D_DRAW_TEXTURED) != 0;
    const mesh_slot *mesh = c3d_pool_get(&device->meshes, draw->mesh.id);
    const strip_slot *strip = c3d_pool_get(&device->strips, draw->strip.id);
    const texture_slot *texture = textured ? c3d_pool_get(&device->textures, draw->texture.id)
                                           : NULL;
    if (!mesh || !strip || (textured && !texture) || strip->data.index_max >= mesh->data.count) {
        device->stats.stale_handles++;
        return;
    }
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

void c3d_get_stats(const c3d_device *device, c3d_stats *stats)
{
    *stats = device->stats;
    stats->mesh_high = device->meshes.high;
    stats->strip_high = device->strips.high;
    stats->texture_high = device->textures.high;
}
