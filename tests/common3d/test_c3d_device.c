/* Devices: handles and pools, opening with little memory or a poor GL, and the same picture on
 * every way to draw it. */
#include "../rig/picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define M PICTURE_M

/* ---- handles ---- */

static void stale_handles_draw_nothing_and_are_counted(void **state)
{
    (void)state;
    picture_kit kit;
    c3d_stats stats;
    uint8_t rgb[16 * 12 * 3];
    assert_int_equal(picture_open(&kit, PICTURE_GL, 16, 12, 1), FF_OK);
    c3d_vertex corners[3] = { { 0 } };
    c3d_mesh old = c3d_mesh_make(kit.device, corners, 3);
    c3d_mesh_free(kit.device, old);
    c3d_mesh reused = c3d_mesh_make(kit.device, corners, 3);
    assert_int_not_equal(old.id, reused.id); /* same slot, next generation */
    c3d_draw draws[5];
    for (int i = 0; i < 5; i++)
        draws[i] = picture_square(&kit, PICTURE_SOUTH, -M, M, -M, 2 * M, PICTURE_RED);
    draws[0].mesh = old;
    draws[1].mesh.id = 0;
    draws[2].strip.id = 0;
    draws[3].flags = C3D_DRAW_TEXTURED; /* texture 0 */
    draws[4].mesh = reused;             /* three vertices: the strip's fourth index lies outside */
    picture_render(&kit, draws, 5, rgb);
    c3d_get_stats(kit.device, &stats);
    assert_int_equal(stats.stale_handles, 5);
    assert_int_equal(stats.frame_draws, 0);
    for (size_t i = 0; i < sizeof rgb; i++) assert_int_equal(rgb[i], 0);
    c3d_mesh_free(kit.device, old);
    c3d_texture_free(kit.device, (c3d_texture){ 0x00010003 });
    c3d_overlay(kit.device, (c3d_texture){ 0 }, 0, 0, 8, 8);
    c3d_mesh_free(kit.device, (c3d_mesh){ 0 }); /* to free no mesh is no fault */
    c3d_texture_free(kit.device, (c3d_texture){ 0 });
    c3d_get_stats(kit.device, &stats);
    assert_int_equal(stats.stale_handles, 8);
    picture_close(&kit);
}

static void full_pools_give_no_handle(void **state)
{
    (void)state;
    for (int buffers = 0; buffers < 2; buffers++) {
        picture_kit kit;
        c3d_stats stats;
        c3d_vertex corners[3] = { { 0 } };
        c3d_mesh meshes[64];
        uint32_t made = 0;
        assert_int_equal(picture_open(&kit, PICTURE_GLES1, 16, 12, buffers), FF_OK);
        while (made < 64 && (meshes[made] = c3d_mesh_make(kit.device, corners, 3)).id) made++;
        assert_int_equal(made, 64 - PICTURE_PLANES);
        c3d_mesh_free(kit.device, meshes[0]);
        meshes[0] = c3d_mesh_make(kit.device, corners, 3);
        assert_int_not_equal(meshes[0].id, 0);
        assert_int_equal(c3d_mesh_make(kit.device, corners, 3).id, 0);
        uint16_t texel = 0;
        for (int i = 0; i < 8; i++)
            assert_int_not_equal(c3d_texture_make(kit.device, C3D_RGB565, 1, 1, &texel).id, 0);
        assert_int_equal(c3d_texture_make(kit.device, C3D_RGB565, 1, 1, &texel).id, 0);
        c3d_get_stats(kit.device, &stats);
        assert_int_equal(stats.mesh_high, 64);
        assert_int_equal(stats.texture_high, 8);
        assert_int_equal(stats.strip_high, 1);
        assert_int_equal(stats.stale_handles, 0);
        assert_int_equal(stats.vertex_buffers_used, buffers);
        picture_close(&kit);
    }
}

static void what_does_not_fit_gives_no_handle(void **state)
{
    (void)state;
    picture_kit kit;
    static c3d_vertex vertices[1090];
    static uint16_t indices[8193];
    assert_int_equal(picture_open(&kit, PICTURE_GL, 16, 12, 0), FF_OK);
    assert_int_equal(c3d_mesh_make(kit.device, vertices, 1090).id, 0);
    assert_int_equal(c3d_mesh_make(kit.device, vertices, 0).id, 0);
    assert_int_not_equal(c3d_mesh_make(kit.device, vertices, 1089).id, 0);
    assert_int_equal(c3d_strip_make(kit.device, indices, 8193).id, 0);
    /* the square's strip has four */
    assert_int_equal(c3d_strip_make(kit.device, indices, 8192 - 3).id, 0);
    assert_int_not_equal(c3d_strip_make(kit.device, indices, 8192 - 4).id, 0);
    assert_int_equal(c3d_strip_make(kit.device, indices, 3).id, 0);
    assert_int_equal(c3d_texture_make(kit.device, C3D_RGBA8888, 3, 4, vertices).id, 0);
    assert_int_equal(c3d_texture_make(kit.device, C3D_RGBA8888, 4, 0, vertices).id, 0);
    picture_close(&kit);
}

static void triangles_are_those_with_area(void **state)
{
    (void)state;
    picture_kit kit;
    c3d_stats stats;
    uint8_t rgb[16 * 12 * 3];
    static const uint16_t joined[] = { 0, 1, 2, 3, 3, 0, 0, 1, 2, 3 };
    assert_int_equal(picture_open(&kit, PICTURE_GL, 16, 12, 1), FF_OK);
    c3d_draw draws[2] = { picture_square(&kit, PICTURE_SOUTH, -M, M, -M, 2 * M, PICTURE_RED),
                          picture_square(&kit, PICTURE_SOUTH, -M, M, -M, 2 * M, PICTURE_RED) };
    draws[1].strip = c3d_strip_make(kit.device, joined, sizeof joined / sizeof *joined);
    picture_render(&kit, draws, 2, rgb);
    c3d_get_stats(kit.device, &stats);
    assert_int_equal(stats.frame_triangles, 2 + 4);
    assert_int_equal(stats.frame_draws, 2);
    picture_close(&kit);
}

/* ---- opening ---- */

static int missing_buffers; /* the poor GL below lacks vertex buffers, else glClear */
static void *poor_proc(const char *name)
{
    const char *missing = missing_buffers ? "glBindBuffer" : "glClear";
    return strcmp(name, missing) == 0 ? NULL : sys_surface_osmesa()->gl_proc(name);
}

static void devices_need_their_memory_and_their_gl(void **state)
{
    (void)state;
    sys_surface *surface;
    sys_surface_desc surface_desc = { "device", 16, 12, SYS_GL_DESKTOP };
    const struct c3d_backend *gl = c3d_backend_gl();
    sys_surface_api poor = *sys_surface_osmesa();
    c3d_desc desc = { .surface_api = sys_surface_osmesa(),
                      .mesh_count = 4,
                      .strip_count = 4,
                      .texture_count = 4,
                      .mesh_vertices_max = 100,
                      .strip_indices_max = 100,
                      .use_vertex_buffers = 1 },
             plain = desc;
    plain.use_vertex_buffers = 0;
    c3d_device *device;
    c3d_stats stats;
    size_t bytes = c3d_bytes(gl, &desc), plain_bytes = c3d_bytes(gl, &plain);
    assert_true(plain_bytes >= bytes + 4 * 100 * sizeof(c3d_vertex));
    uint8_t *memory = malloc(plain_bytes + 1);
    assert_int_equal(sys_surface_osmesa()->open(&surface_desc, &surface), FF_OK);
    assert_int_equal(c3d_open(gl, &desc, memory + 1, bytes - 1, &device), FF_ERR_MEMORY);
    /* odd addresses too */
    assert_int_equal(c3d_open(gl, &desc, memory + 1, bytes, &device), FF_OK);
    assert_int_equal(c3d_read_rgb(device, memory), FF_ERR_ARGUMENT); /* no frame yet */
    c3d_close(device);
    assert_int_equal(c3d_open(c3d_backend_gles1(), &desc, memory, plain_bytes, &device),
                     FF_ERR_UNSUPPORTED);
    poor.gl_proc = poor_proc;
    desc.surface_api = &poor;
    missing_buffers = 0;
    assert_int_equal(c3d_open(gl, &desc, memory, plain_bytes, &device), FF_ERR_UNSUPPORTED);
    missing_buffers = 1;
    /* plain arrays need memory for copies */
    assert_int_equal(c3d_open(gl, &desc, memory, bytes, &device), FF_ERR_MEMORY);
    assert_int_equal(c3d_open(gl, &desc, memory, plain_bytes, &device), FF_OK);
    c3d_get_stats(device, &stats);
    assert_int_equal(stats.vertex_buffers_used, 0);
    c3d_close(device);
    sys_surface_osmesa()->close(surface);
    surface_desc.gl = SYS_GL_ES1;
    assert_int_equal(sys_surface_egl()->open(&surface_desc, &surface), FF_OK);
    desc.surface_api = sys_surface_egl();
    assert_int_equal(c3d_open(gl, &desc, memory, plain_bytes, &device), FF_ERR_UNSUPPORTED);
    sys_surface_egl()->close(surface);
    free(memory);
}

/* ---- the same picture ---- */

enum { SIDE = 33, WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT };

/* A hilly patch of 32 by 32 cells, column `part` of two that share an edge; vertex colours from its
 * grid. */
static c3d_mesh hills(c3d_device *device, int part)
{
    static c3d_vertex vertices[SIDE * SIDE];
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            int world_x = x + part * (SIDE - 1);
            int32_t z = (c3d_sin_q30(world_x * 3000) >> 19) +
                        (c3d_sin_q30(y * 5000 + world_x * 700) >> 20);
            vertices[y * SIDE + x] = (c3d_vertex){ x,
                                                   y,
                                                   z,
                                                   { (uint8_t)(64 + x * 5), (uint8_t)(64 + y * 5),
                                                     (uint8_t)(128 + z / 32), 255 } };
        }
    return c3d_mesh_make(device, vertices, SIDE * SIDE);
}

static c3d_strip grid_strip(c3d_device *device)
{
    static uint16_t indices[(SIDE - 1) * (2 * SIDE + 2)];
    uint32_t count = 0;
    for (int y = 0; y + 1 < SIDE; y++) {
        /* with the row's last index twice: degenerate joints */
        if (y) indices[count++] = (uint16_t)((y + 1) * SIDE);
        for (int x = 0; x < SIDE; x++) {
            indices[count++] = (uint16_t)((y + 1) * SIDE + x);
            indices[count++] = (uint16_t)(y * SIDE + x);
        }
        if (y + 2 < SIDE) indices[count] = indices[count - 1], count++;
    }
    return c3d_strip_make(device, indices, count);
}

/* Two patches of 64 m side by side, seen from (x, y, z) wu relative to the middle of their common
 * edge. */
static void render_hills(picture_kit *kit, const c3d_camera *camera, uint32_t flags, uint8_t *rgb)
{
    c3d_draw draws[4];
    kit->frame.camera = *camera;
    for (int i = 0; i < 4; i++) {
        draws[i] = (c3d_draw){ .mesh = kit->square[i & 1],
                               .strip = kit->strip,
                               .xy_scale_wu = 2 * M,
                               .z_scale_q16 = 65536,
                               .colour = 0xFF202020u,
                               .flags = i < 2 ? flags : C3D_DRAW_WIREFRAME | C3D_DRAW_ON_TOP };
        draws[i].origin_wu[0] = (i & 1 ? 0 : -64 * M) - camera->pos_wu[0];
        draws[i].origin_wu[1] = -32 * M - camera->pos_wu[1];
        draws[i].origin_wu[2] = -camera->pos_wu[2];
    }
    picture_render(kit, draws, flags & C3D_DRAW_COLOURED ? 4 : 2, rgb);
}

static void open_hills(picture_kit *kit, enum picture_kind kind, int buffers)
{
    assert_int_equal(picture_open(kit, kind, WIDTH, HEIGHT, buffers), FF_OK);
    kit->square[0] = hills(kit->device, 0);
    kit->square[1] = hills(kit->device, 1);
    kit->strip = grid_strip(kit->device);
    assert_true(kit->square[0].id && kit->square[1].id && kit->strip.id);
    kit->frame.fog_colour = 0xFFC08040u;
    kit->frame.fog_start_wu = 20 * M;
    kit->frame.fog_end_wu = 120 * M;
}

static c3d_camera hill_camera(int32_t yaw, int32_t x_wu, int32_t y_wu)
{
    return (c3d_camera){ .pos_wu = { x_wu, y_wu, 20 * M },
                         .yaw = yaw,
                         .pitch = -3000,
                         .focal_q8 = c3d_focal_q8(13000, WIDTH),
                         .width = WIDTH,
                         .height = HEIGHT,
                         .near_wu = M / 2,
                         .far_wu = 1000 * M };
}

static void every_way_to_draw_gives_the_same_picture(void **state)
{
    (void)state;
    static uint8_t rgb[5][PIXELS * 3];
    static const struct {
        enum picture_kind kind;
        int buffers;
    } ways[5] = { { PICTURE_GL, 1 },
                  { PICTURE_GL, 0 },
                  { PICTURE_GLES1, 1 },
                  { PICTURE_GLES1, 0 },
                  { PICTURE_EGL_GL, 1 } };
    picture_kit kits[5];
    for (int i = 0; i < 5; i++) open_hills(&kits[i], ways[i].kind, ways[i].buffers);
    for (int view = 0; view < 8; view++) {
        c3d_camera camera = hill_camera(view * 8192, 3 * M, -7 * M);
        for (int i = 0; i < 5; i++) render_hills(&kits[i], &camera, C3D_DRAW_COLOURED, rgb[i]);
        assert_memory_equal(rgb[0], rgb[1], sizeof rgb[0]); /* with buffers and without */
        assert_memory_equal(rgb[2], rgb[3], sizeof rgb[0]);
        for (int i = 2; i < 5; i++) {
            int differ = 0;
            for (int j = 0; j < PIXELS * 3; j++) differ += abs(rgb[0][j] - rgb[i][j]) > 2;
            assert_true(differ <= PIXELS * 3 / 100);
        }
    }
    assert_int_equal(sys_png_write("build/tests/c3d-hills.png", rgb[0], WIDTH, HEIGHT), FF_OK);
    for (int i = 0; i < 5; i++) picture_close(&kits[i]);
}

static void devices_share_a_context(void **state)
{
    (void)state;
    static uint8_t alone[PIXELS * 3], shared[PIXELS * 3];
    picture_kit kit, second;
    c3d_camera camera = hill_camera(5000, 0, 0);
    open_hills(&kit, PICTURE_GL, 1);
    render_hills(&kit, &camera, C3D_DRAW_COLOURED, alone);
    c3d_desc desc = { .surface_api = kit.api,
                      .mesh_count = 4,
                      .strip_count = 4,
                      .texture_count = 4,
                      /* plain arrays beside buffers */
                      .mesh_vertices_max = SIDE * SIDE,
                      .strip_indices_max = 4096 };
    size_t bytes = c3d_bytes(c3d_backend_gl(), &desc);
    second = kit;
    second.memory = malloc(bytes);
    assert_int_equal(c3d_open(c3d_backend_gl(), &desc, second.memory, bytes, &second.device),
                     FF_OK);
    second.square[0] = hills(second.device, 0);
    second.square[1] = hills(second.device, 1);
    second.strip = grid_strip(second.device);
    for (int i = 0; i < 4; i++) {
        render_hills(i & 1 ? &kit : &second, &camera, C3D_DRAW_COLOURED, shared);
        assert_memory_equal(alone, shared, sizeof alone);
    }
    c3d_close(second.device);
    free(second.memory);
    render_hills(&kit, &camera, C3D_DRAW_COLOURED, shared);
    assert_memory_equal(alone, shared, sizeof alone);
    picture_close(&kit);
}

/* Seen low over the common edge from everywhere, no pixel along that edge shows the clear colour.
 */
static void neighbours_meet_without_a_crack(void **state)
{
    (void)state;
    static uint8_t rgb[PIXELS * 3];
    static const enum picture_kind kinds[2] = { PICTURE_GL, PICTURE_GLES1 };
    for (int i = 0; i < 2; i++) {
        picture_kit kit;
        sys_random random;
        sys_random_seed(&random, 9, 9);
        open_hills(&kit, kinds[i], 1);
        kit.frame.clear_colour = 0xFFFF00FFu;
        kit.frame.fog_end_wu = 0;
        for (int view = 0; view < 150; view++) {
            c3d_camera camera = hill_camera((int32_t)sys_random_u32(&random), 0, 0);
            camera.pos_wu[0] = (int32_t)sys_random_below(&random, 4 * M) - 2 * M;
            camera.pos_wu[1] = (int32_t)sys_random_below(&random, 20 * M) - 10 * M;
            camera.pos_wu[2] = 13 * M + (int32_t)sys_random_below(&random, 2 * M);
            /* narrow and down: the patches' far ends are not in view */
            camera.focal_q8 = c3d_focal_q8(8000, WIDTH);
            camera.pitch = -16384 + (int32_t)sys_random_below(&random, 1500);
            camera.roll = (int32_t)sys_random_u32(&random);
            render_hills(&kit, &camera, 0, rgb);
            for (int p = 0; p < PIXELS; p++) assert_int_equal(rgb[p * 3 + 1], 0x20);
        }
        picture_close(&kit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stale_handles_draw_nothing_and_are_counted),
        cmocka_unit_test(full_pools_give_no_handle),
        cmocka_unit_test(what_does_not_fit_gives_no_handle),
        cmocka_unit_test(triangles_are_those_with_area),
        cmocka_unit_test(devices_need_their_memory_and_their_gl),
        cmocka_unit_test(every_way_to_draw_gives_the_same_picture),
        cmocka_unit_test(devices_share_a_context),
        cmocka_unit_test(neighbours_meet_without_a_crack),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
