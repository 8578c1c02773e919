#include "picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void make_squares(picture_kit *kit)
{
    static const uint16_t strip[4] = { 0, 1, 2, 3 };
    static const uint8_t corner_rgba[4][4] = {
        { 255, 0, 0, 255 }, { 0, 255, 0, 255 }, { 0, 0, 255, 255 }, { 255, 255, 255, 255 }
    };
    for (int plane = 0; plane < PICTURE_PLANES; plane++) {
        c3d_vertex corners[4] = { { 0 } };
        for (int i = 0; i < 4; i++) {
            int32_t across = (i & 1) * PICTURE_UNITS, along = (i >> 1) * PICTURE_UNITS;
            corners[i].x = plane == PICTURE_WEST ? 0 : across;
            corners[i].y = plane == PICTURE_LEVEL ? along : plane == PICTURE_WEST ? across : 0;
            corners[i].z = plane == PICTURE_LEVEL ? 0 : along;
            memcpy(corners[i].rgba, corner_rgba[i], 4);
        }
        kit->square[plane] = c3d_mesh_make(kit->device, corners, 4);
    }
    kit->strip = c3d_strip_make(kit->device, strip, 4);
}

static int is_soft(enum picture_kind kind)
{
    return kind == PICTURE_SOFT || kind == PICTURE_SOFT_565;
}

static int open_device(picture_kit *kit, int use_vertex_buffers)
{
    const struct c3d_backend *backend = is_soft(kit->kind)           ? c3d_backend_soft()
                                        : kit->kind == PICTURE_GLES1 ? c3d_backend_gles1()
                                                                     : c3d_backend_gl();
    c3d_desc desc = { .surface_api = kit->api,
                      .mesh_count = 64,
                      .strip_count = PICTURE_STRIPS,
                      .texture_count = 8,
                      .label_count = 8,
                      .mesh_vertices_max = 1089,
                      .strip_indices_max = 8192,
                      .use_vertex_buffers = (uint8_t)use_vertex_buffers,
                      .frame_format = kit->kind == PICTURE_SOFT ? C3D_RGBA8888 : C3D_RGB565,
                      .width = (uint16_t)kit->width,
                      .height = (uint16_t)kit->height };
    size_t bytes = c3d_bytes(backend, &desc);
    kit->memory = malloc(bytes);
    return kit->memory ? c3d_open(backend, &desc, kit->memory, bytes, &kit->device) : FF_ERR_MEMORY;
}

int picture_open(picture_kit *kit, enum picture_kind kind, int width, int height,
                 int use_vertex_buffers)
{
    memset(kit, 0, sizeof *kit);
    kit->kind = kind;
    kit->width = width;
    kit->height = height;
    kit->api = is_soft(kind)        ? sys_surface_memory()
               : kind == PICTURE_GL ? sys_surface_osmesa()
                                    : sys_surface_egl();
    sys_surface_desc desc = { "picture", width, height,
                              kind == PICTURE_GLES1 ? SYS_GL_ES1 : SYS_GL_DESKTOP };
    int rc = kit->api->open(&desc, &kit->surface);
    if (rc == FF_OK) rc = open_device(kit, use_vertex_buffers);
    if (rc < 0) {
        picture_close(kit);
        return rc;
    }
    make_squares(kit);
    kit->frame.camera = (c3d_camera){ .focal_q8 = c3d_focal_q8(16384, width),
                                      .width = (uint16_t)width,
                                      .height = (uint16_t)height,
                                      .near_wu = PICTURE_M / 4,
                                      .far_wu = 4000 * PICTURE_M };
    kit->frame.clear_colour = 0xFF000000u;
    return FF_OK;
}

void picture_close(picture_kit *kit)
{
    if (kit->surface) kit->api->make_current(kit->surface);
    if (kit->device) c3d_close(kit->device);
    if (kit->surface) kit->api->close(kit->surface);
    free(kit->memory);
    memset(kit, 0, sizeof *kit);
}

c3d_draw picture_square(const picture_kit *kit, enum picture_plane plane, int64_t x_wu,
                        int64_t y_wu, int64_t z_wu, int32_t size_wu, uint32_t colour)
{
    return (c3d_draw){ .mesh = kit->square[plane],
                       .strip = kit->strip,
                       .origin_wu = { x_wu, y_wu, z_wu },
                       .xy_scale_wu = size_wu / PICTURE_UNITS,
                       .z_scale_q16 = (uint32_t)(size_wu / PICTURE_UNITS) << 16,
                       .colour = colour };
}

void picture_render(picture_kit *kit, const c3d_draw *draws, size_t count, uint8_t *rgb)
{
    kit->api->make_current(kit->surface);
    c3d_begin(kit->device, &kit->frame);
    for (size_t i = 0; i < count; i++) c3d_draw_strip(kit->device, &draws[i]);
    c3d_end(kit->device);
    if (c3d_read_rgb(kit->device, rgb) < 0)
        memset(rgb, 99, (size_t)kit->width * (size_t)kit->height * 3);
    kit->api->present(kit->surface);
}

static char letter(const uint8_t rgb[3])
{
    static const struct {
        char letter;
        uint8_t rgb[3];
    } known[] = {
        { '.', { 0, 0, 0 } },     { 'w', { 255, 255, 255 } }, { 'r', { 255, 0, 0 } },
        { 'g', { 0, 255, 0 } },   { 'b', { 0, 0, 255 } },     { 'c', { 0, 255, 255 } },
        { 'm', { 255, 0, 255 } }, { 'y', { 255, 255, 0 } },   { '-', { 128, 128, 128 } }
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        int near = 1;
        for (int j = 0; j < 3; j++) near &= abs(known[i].rgb[j] - rgb[j]) <= 40;
        if (near) return known[i].letter;
    }
    return '?';
}

void picture_text(const uint8_t *rgb, int width, int height, char *text)
{
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++, rgb += 3) *text++ = letter(rgb);
        *text++ = '\n';
    }
    *text = 0;
}

int picture_is(picture_kit *kit, const c3d_draw *draws, size_t count, const char *expected)
{
    static uint8_t rgb[64 * 64 * 3];
    static char text[65 * 64 + 1];
    if (kit->width > 64 || kit->height > 64) return 0;
    picture_render(kit, draws, count, rgb);
    picture_text(rgb, kit->width, kit->height, text);
    if (strcmp(text, expected) == 0) return 1;
    printf("# drawn by %s:\n%s# expected:\n%s", kit->api->name, text, expected);
    return 0;
}

int picture_apart(const uint8_t *a, const uint8_t *b)
{
    int most = 0;
    for (int i = 0; i < 3; i++)
        if (abs(a[i] - b[i]) > most) most = abs(a[i] - b[i]);
    return most;
}

static int has_near(const uint8_t *pixel, const uint8_t *rgb, int width, int height, int x, int y,
                    int tolerance)
{
    for (int row = y - 1; row <= y + 1; row++)
        for (int column = x - 1; column <= x + 1; column++)
            if (row >= 0 && row < height && column >= 0 && column < width &&
                picture_apart(pixel, rgb + (row * width + column) * 3) <= tolerance)
                return 1;
    return 0;
}

int picture_disagreement(const uint8_t *a, const uint8_t *b, int width, int height, int tolerance,
                         int *strict)
{
    int count = 0;
    *strict = 0;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const uint8_t *p = a + (y * width + x) * 3, *q = b + (y * width + x) * 3;
            if (picture_apart(p, q) <= tolerance) continue;
            ++*strict;
            count += !has_near(p, b, width, height, x, y, tolerance) ||
                     !has_near(q, a, width, height, x, y, tolerance);
        }
    return count;
}
