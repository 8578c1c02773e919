/* The integer back end by itself: its fill rule, every pixel once, clipping, formats, its memory,
 * and frames that are the same on every machine. test_c3d.c (small pictures) and test_soft_agrees.c
 * compare its pictures with the other back ends'. */
#include "../rig/picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define M PICTURE_M

/* ---- a device of its own: more strips than the kit has ---- */

enum {
    CELLS = 7,
    SIDE = CELLS + 1,
    TRIANGLES = 2 * CELLS * CELLS,
    WIDTH = 40,
    HEIGHT = 30,
    PIXELS = WIDTH * HEIGHT
};

typedef struct bench {
    void *memory;
    c3d_device *device;
    c3d_mesh mesh;
    c3d_texture white, thrown;
    c3d_strip triangle[TRIANGLES];
    c3d_frame frame;
} bench;

static void open_bench(bench *b)
{
    c3d_desc desc = { .surface_api = sys_surface_memory(),
                      .mesh_count = 2,
                      .strip_count = TRIANGLES,
                      .texture_count = 2,
                      .mesh_vertices_max = SIDE * SIDE,
                      .strip_indices_max = 3 * TRIANGLES,
                      .width = WIDTH,
                      .height = HEIGHT };
    size_t bytes = c3d_bytes(c3d_backend_soft(), &desc);
    memset(b, 0, sizeof *b);
    b->memory = malloc(bytes);
    assert_int_equal(c3d_open(c3d_backend_soft(), &desc, b->memory, bytes, &b->device), FF_OK);
    for (int i = 0; i < TRIANGLES; i++) {
        int cell = i / 2, corner = cell / CELLS * SIDE + cell % CELLS;
        const uint16_t lower[3] = { (uint16_t)corner, (uint16_t)(corner + 1),
                                    (uint16_t)(corner + SIDE + 1) };
        const uint16_t upper[3] = { (uint16_t)corner, (uint16_t)(corner + SIDE + 1),
                                    (uint16_t)(corner + SIDE) };
        b->triangle[i] = c3d_strip_make(b->device, i & 1 ? upper : lower, 3);
        assert_int_not_equal(b->triangle[i].id, 0);
    }
    static const uint16_t white[4] = { 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF };
    b->white = c3d_texture_make(b->device, C3D_RGB565, 2, 2, white);
    uint16_t texels[64];
    for (int i = 0; i < 64; i++)
        texels[i] = i % 8 % 7 && i / 8 % 7 ? 0xFFFF : 0xFFFE; /* open at the outside */
    b->thrown = c3d_texture_make(b->device, C3D_RGBA5551, 8, 8, texels);
    b->frame.camera = (c3d_camera){ .pitch = -16384,
                                    .focal_q8 = 40 * 256,
                                    .width = WIDTH,
                                    .height = HEIGHT,
                                    .near_wu = M / 4,
                                    .far_wu = 4000 * M };
}

static void close_bench(bench *b)
{
    c3d_close(b->device);
    free(b->memory);
}

/* A grid, each vertex moved by less than half a cell: no triangle lies over another when seen from
 * above. */
static void scatter(bench *b, sys_random *random)
{
    c3d_vertex vertices[SIDE * SIDE];
    if (b->mesh.id) c3d_mesh_free(b->device, b->mesh);
    for (int i = 0; i < SIDE * SIDE; i++)
        vertices[i] = (c3d_vertex){ (i % SIDE) * 1000 + (int)sys_random_below(random, 600) - 300,
                                    (i / SIDE) * 1000 + (int)sys_random_below(random, 600) - 300,
                                    0,
                                    { 255, 255, 255, 255 } };
    b->mesh = c3d_mesh_make(b->device, vertices, SIDE * SIDE);
}

/* How often each pixel is written when the triangles of the mesh are drawn one by one, each into a
 * frame of its own. */
static void count_writes(bench *b, c3d_draw *draw, uint8_t *writes)
{
    static uint8_t rgb[PIXELS * 3];
    memset(writes, 0, PIXELS);
    for (int i = 0; i < TRIANGLES; i++) {
        draw->strip = b->triangle[i];
        c3d_begin(b->device, &b->frame);
        c3d_draw_strip(b->device, draw);
        c3d_end(b->device);
        assert_int_equal(c3d_read_rgb(b->device, rgb), FF_OK);
        for (int p = 0; p < PIXELS; p++) writes[p] = (uint8_t)(writes[p] + (rgb[p * 3] == 255));
    }
}

/* Seen from far above, where triangles are smaller than a pixel, to so near that the guard band
 * clips them, at any angle; in one colour, under a texture, and under one that is thrown from
 * above, whose triangles take other code. */
static void every_pixel_of_a_surface_is_written_once(void **state)
{
    (void)state;
    static uint8_t writes[PIXELS];
    static const int32_t above_m[] = { 100, 260, 2500, 12, 1 };
    bench b;
    sys_random random;
    sys_random_seed(&random, 5, 5);
    open_bench(&b);
    for (int round = 0; round < 90; round++) {
        int32_t above = above_m[round % 5] * M, scale = above < 100 * M ? 4 : 8;
        scatter(&b, &random);
        b.frame.camera.roll = (int32_t)sys_random_u32(&random);
        b.frame.camera.pitch = -16384 + (int32_t)sys_random_below(&random, 1200);
        c3d_draw draw = {
            .mesh = b.mesh, .xy_scale_wu = scale, .z_scale_q16 = 65536, .colour = PICTURE_WHITE
        };
        draw.origin_wu[0] = -scale * 3500 - (int32_t)sys_random_below(&random, 400);
        draw.origin_wu[1] = -scale * 3500 - (int32_t)sys_random_below(&random, 400);
        draw.origin_wu[2] = -above;
        const c3d_projector projector = {
            { 0, 0, 0 },
            { { 1 << 23, 0, -(1 << 23) }, { 0, 1 << 23, -(1 << 23) }, { 0, 0, -(1 << 24) } }
        };
        if (round % 3 == 2) {
            draw.flags = C3D_DRAW_PROJECTED;
            draw.texture = b.thrown;
            draw.projector = &projector;
        }
        if (round % 3 == 1) {
            draw.flags = C3D_DRAW_TEXTURED;
            draw.texture = b.white;
            draw.tex_scale_q16[0] = draw.tex_scale_q16[1] = 7000;
            draw.tex_columns = SIDE;
            draw.tex_offset_q16[0] = draw.tex_offset_q16[1] = 4096;
        }
        count_writes(&b, &draw, writes);
        int inside = above <= 100 * M; /* then the frame lies within the mesh */
        for (int p = 0; p < PIXELS; p++) assert_true(writes[p] == 1 || (!inside && writes[p] == 0));
    }
    close_bench(&b);
}

/* ---- small pictures ---- */

/* A square whose edges run through centres of pixels: those on its left and upper edges belong to
 * it. d = 8 px, 8 m away. */
static void centres_on_left_and_upper_edges_are_inside(void **state)
{
    (void)state;
    picture_kit kit;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT_565, 12, 8, 0), FF_OK);
    kit.frame.camera.focal_q8 = 8 * 256;
    c3d_draw draw = picture_square(&kit, PICTURE_SOUTH, -4 * M + M / 2, 8 * M, -M - M / 2, 4 * M,
                                   PICTURE_RED);
    assert_true(picture_is(&kit, &draw, 1,
                           "............\n..rrrr......\n..rrrr......\n..rrrr......\n"
                           "..rrrr......\n............\n............\n............\n"));
    picture_close(&kit);
}

/* A metre above a plain 4 km wide: clipped at the near plane and at the guard band, the lower half
 * is ground without a hole. */
static void the_ground_under_the_camera_has_no_hole(void **state)
{
    (void)state;
    static uint8_t rgb[96 * 72 * 3];
    picture_kit kit;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT_565, 96, 72, 0), FF_OK);
    for (int view = 0; view < 32; view++) {
        kit.frame.camera.yaw = view * 2048 + 77;
        c3d_draw draw = picture_square(&kit, PICTURE_LEVEL, -2000 * M, -2000 * M, -M, 4000 * M,
                                       PICTURE_GREEN);
        picture_render(&kit, &draw, 1, rgb);
        for (int p = 0; p < 96 * 72; p++)
            if (p / 96 < 36 || p / 96 > 37) assert_int_equal(rgb[p * 3 + 1], p / 96 < 36 ? 0 : 255);
    }
    picture_close(&kit);
}

/* A triangle that hangs from its upper corner, the nearer one, to its lower two: what it shows in
 * its middle, and how far away that is. */
static int32_t look_at_steep(picture_kit *kit, int32_t upper_wu, int32_t lower_wu, uint8_t rgb[3])
{
    enum { WIDE = 96, HIGH = 72 };
    static uint8_t frame[WIDE * HIGH * 3];
    static int32_t depth_wu[WIDE * HIGH];
    static const uint16_t index[3] = { 0, 1, 2 };
    const c3d_vertex corner[3] = {
        { .x = 0, .y = upper_wu, .z = upper_wu / 4, .rgba = { 255, 0, 0, 255 } },
        { .x = -lower_wu / 2, .y = lower_wu, .z = -lower_wu / 4, .rgba = { 255, 0, 0, 255 } },
        { .x = lower_wu / 2, .y = lower_wu, .z = -lower_wu / 4, .rgba = { 255, 0, 0, 255 } }
    };
    c3d_mesh mesh = c3d_mesh_make(kit->device, corner, 3);
    c3d_strip strip = c3d_strip_make(kit->device, index, 3);
    const c3d_draw draw = { .mesh = mesh,
                            .strip = strip,
                            .flags = C3D_DRAW_COLOURED,
                            .xy_scale_wu = 1,
                            .z_scale_q16 = 65536,
                            .tex_columns = 1 };
    picture_render(kit, &draw, 1, frame);
    assert_int_equal(c3d_read_depth(kit->device, depth_wu), FF_OK);
    c3d_mesh_free(kit->device, mesh);
    c3d_strip_free(kit->device, strip);
    memcpy(rgb, frame + 3 * (HIGH / 2 * WIDE + WIDE / 2), 3);
    return depth_wu[HIGH / 2 * WIDE + WIDE / 2];
}

/* At corners of which near/z, in 30 bits, differs by about 2^23: those of smaller differences are
 * interpolated without it, in numbers of 19 bits and a sign. */
static void steep_triangles_have_their_depths(void **state)
{
    (void)state;
    picture_kit kit;
    const int32_t lower_wu = 8000 * M, upper_wu = 6430 * M + M / 10;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT, 96, 72, 0), FF_OK);
    kit.frame.camera.near_wu = 256 * M;
    kit.frame.camera.far_wu = 40000 * M;
    kit.frame.camera.focal_q8 = 48 * 256;
    for (int32_t i = 0; i < 400; i++) { /* some of them by 1 to 15 less than 2^23 */
        uint8_t rgb[3];
        int32_t depth_wu = look_at_steep(&kit, upper_wu + i / 8, lower_wu + i % 8, rgb);
        assert_int_equal(rgb[0], 255);
        /* half a pixel below the middle of 24: 24 / (11.5 / upper + 12.5 / lower) */
        assert_in_range(depth_wu, 7155 * M, 7165 * M);
    }
    picture_close(&kit);
}

static void lines_cross_the_near_plane(void **state)
{
    (void)state;
    static uint8_t rgb[96 * 72 * 3];
    picture_kit kit;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT_565, 96, 72, 0), FF_OK);
    /* its west edge runs from behind the camera to ahead of it */
    c3d_draw draw = picture_square(&kit, PICTURE_LEVEL, 0, -M, -M, 4 * M, PICTURE_RED);
    draw.flags = C3D_DRAW_WIREFRAME;
    picture_render(&kit, &draw, 1, rgb);
    for (int row = 60; row < 72; row++) assert_int_equal(rgb[(row * 96 + 48) * 3], 255);
    picture_close(&kit);
}

/* ---- memory ---- */

static void textures_come_from_the_block_and_go_back(void **state)
{
    (void)state;
    static const uint16_t pixels[256 * 256];
    picture_kit kit; /* 8 slots, 128 KB */
    assert_int_equal(picture_open(&kit, PICTURE_SOFT, 16, 12, 0), FF_OK);
    for (int round = 0; round < 3; round++) {
        /* 67 KB with the rim */
        c3d_texture large = c3d_texture_make(kit.device, C3D_RGB565, 128, 256, pixels);
        assert_int_not_equal(large.id, 0);
        assert_int_equal(c3d_texture_make(kit.device, C3D_RGB565, 128, 256, pixels).id, 0);
        c3d_texture small = c3d_texture_make(kit.device, C3D_RGB565, 64, 64, pixels);
        assert_int_not_equal(small.id, 0);
        c3d_texture_free(kit.device, large);
        c3d_texture_free(kit.device, small);
    }
    picture_close(&kit);
}

/* A backdrop waits until the end of the frame, but may lose its texture and its mesh before. */
static void backdrops_outlive_what_they_are_made_of(void **state)
{
    (void)state;
    static const uint16_t red[4] = { 0xF800, 0xF800, 0xF800, 0xF800 };
    uint8_t rgb[16 * 12 * 3];
    picture_kit kit;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT_565, 16, 12, 0), FF_OK);
    for (int round = 0; round < 2; round++) {
        c3d_draw draw = picture_square(&kit, PICTURE_SOUTH, -9 * M, 8 * M, -9 * M, 18 * M,
                                       PICTURE_WHITE);
        draw.texture = c3d_texture_make(kit.device, C3D_RGB565, 2, 2, red);
        draw.flags = C3D_DRAW_TEXTURED | C3D_DRAW_BACKDROP;
        draw.tex_columns = 2;
        c3d_begin(kit.device, &kit.frame);
        c3d_draw_strip(kit.device, &draw);
        if (round) c3d_mesh_free(kit.device, draw.mesh);
        c3d_texture_free(kit.device, draw.texture);
        c3d_end(kit.device);
        assert_int_equal(c3d_read_rgb(kit.device, rgb), FF_OK);
        for (int p = 0; p < 16 * 12; p++) assert_memory_equal(rgb + p * 3, "\377\0\0", 3);
    }
    picture_close(&kit);
}

static void a_frame_larger_than_the_memory_stays_empty(void **state)
{
    (void)state;
    static uint8_t rgb[32 * 24 * 3];
    enum c3d_texture_format format;
    picture_kit kit;
    assert_int_equal(picture_open(&kit, PICTURE_SOFT_565, 16, 12, 0), FF_OK);
    kit.frame.camera.width = 32;
    kit.frame.camera.height = 24;
    kit.frame.clear_colour = PICTURE_BLUE;
    c3d_draw draw = picture_square(&kit, PICTURE_SOUTH, -M, M, -M, 2 * M, PICTURE_RED);
    picture_render(&kit, &draw, 1, rgb);
    for (int p = 0; p < 32 * 24; p++) assert_memory_equal(rgb + p * 3, "\0\0\377", 3);
    assert_null(c3d_frame_pixels(kit.device, &format));
    picture_close(&kit);
}

/* ---- large frames ---- */

enum { LARGE_WIDTH = 240, LARGE_HEIGHT = 320, GRID = 33 };

/* Hills under a texture, a coloured backdrop behind them; with and without fog. */
static uint64_t large_frame(enum picture_kind kind, int32_t yaw, int fog, uint8_t *rgb)
{
    static c3d_vertex vertices[GRID * GRID];
    static uint16_t indices[(GRID - 1) * (2 * GRID + 2)], texels[64 * 64];
    uint32_t count = 0;
    uint64_t hash = UINT64_C(14695981039346656037);
    picture_kit kit;
    assert_int_equal(picture_open(&kit, kind, LARGE_WIDTH, LARGE_HEIGHT, 0), FF_OK);
    for (int i = 0; i < GRID * GRID; i++)
        vertices[i] = (c3d_vertex){ i % GRID,
                                    i / GRID,
                                    (c3d_sin_q30(i % GRID * 3000) >> 19) +
                                        (c3d_sin_q30(i / GRID * 5000) >> 20),
                                    { 255, 255, 255, 255 } };
    for (int i = 0; i < 64 * 64; i++)
        texels[i] = (uint16_t)((i % 64 / 2) << 11 | (i / 64) << 5 | ((i ^ i >> 6) & 31));
    for (int row = 0; row + 1 < GRID; row++)
        for (int i = -1; i < 2 * GRID + 1; i++) { /* the first and the last index twice */
            int at = i < 0 ? 0 : i > 2 * GRID - 1 ? 2 * GRID - 1 : i;
            indices[count++] = (uint16_t)((row + !(at & 1)) * GRID + at / 2);
        }
    kit.frame.camera = (c3d_camera){ .yaw = yaw,
                                     .pitch = -2000,
                                     .focal_q8 = 208 * 256,
                                     .width = LARGE_WIDTH,
                                     .height = LARGE_HEIGHT,
                                     .near_wu = M,
                                     .far_wu = 1000 * M };
    kit.frame.fog_start_wu = 20 * M;
    kit.frame.fog_end_wu = fog ? 120 * M : 0;
    kit.frame.fog_colour = 0xFFC08040u;
    c3d_draw sky = picture_square(&kit, PICTURE_SOUTH, -64 * M, 32 * M, -64 * M, 128 * M, 0);
    sky.flags = C3D_DRAW_BACKDROP | C3D_DRAW_COLOURED;
    c3d_draw hills = { .mesh = c3d_mesh_make(kit.device, vertices, GRID * GRID),
                       .strip = c3d_strip_make(kit.device, indices, count),
                       .origin_wu = { -60 * M, -40 * M, -16 * M },
                       .xy_scale_wu = 4 * M,
                       .z_scale_q16 = 65536,
                       .flags = C3D_DRAW_TEXTURED,
                       .colour = PICTURE_WHITE,
                       .texture = c3d_texture_make(kit.device, C3D_RGB565, 64, 64, texels),
                       .tex_scale_q16 = { 2016, 2016 },
                       .tex_offset_q16 = { 512, 512 },
                       .tex_columns = GRID };
    assert_true(hills.mesh.id && hills.strip.id && hills.texture.id);
    const c3d_draw draws[2] = { sky, hills };
    picture_render(&kit, draws, 2, rgb);
    for (int i = 0; i < LARGE_WIDTH * LARGE_HEIGHT * 3; i++)
        hash = (hash ^ rgb[i]) * UINT64_C(1099511628211);
    picture_close(&kit);
    return hash;
}

static void frames_are_the_same_on_every_machine(void **state)
{
    (void)state;
    static uint8_t rgb[LARGE_WIDTH * LARGE_HEIGHT * 3];
    static const struct {
        enum picture_kind kind;
        int32_t yaw;
        int fog;
        uint64_t hash;
    } frames[4] = { { PICTURE_SOFT_565, 0, 0, UINT64_C(0x805680ff13b81e17) },
                    { PICTURE_SOFT_565, 9000, 1, UINT64_C(0x5b00464f60e24167) },
                    { PICTURE_SOFT, 0, 0, UINT64_C(0xf2eb1ec61ca35478) },
                    { PICTURE_SOFT, 9000, 1, UINT64_C(0x400015b1bde8233a) } };
    int different = 0;
    for (int i = 0; i < 4; i++) {
        uint64_t hash = large_frame(frames[i].kind, frames[i].yaw, frames[i].fog, rgb);
        different += hash != frames[i].hash;
        if (hash != frames[i].hash)
            print_error("frame %d: 0x%016llx\n", i, (unsigned long long)hash);
    }
    assert_int_equal(different, 0);
}

/* The fast spans of RGB565 differ from the exact ones of RGBA8888 by at most one step of the narrow
 * format, at edges too. */
static void formats_show_the_same(void **state)
{
    (void)state;
    static uint8_t narrow[LARGE_WIDTH * LARGE_HEIGHT * 3], wide[LARGE_WIDTH * LARGE_HEIGHT * 3];
    for (int view = 0; view < 6; view++) {
        int apart = 0;
        large_frame(PICTURE_SOFT_565, view * 3000 - 8000, view & 1, narrow);
        large_frame(PICTURE_SOFT, view * 3000 - 8000, view & 1, wide);
        for (int i = 0; i < LARGE_WIDTH * LARGE_HEIGHT * 3; i++)
            apart += abs(narrow[i] - wide[i]) > 14;
        assert_in_range(apart, 0, LARGE_WIDTH * LARGE_HEIGHT * 3 / 200);
    }
    assert_int_equal(sys_png_write("build/tests/soft-frame.png", narrow, LARGE_WIDTH, LARGE_HEIGHT),
                     FF_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pixel_of_a_surface_is_written_once),
        cmocka_unit_test(centres_on_left_and_upper_edges_are_inside),
        cmocka_unit_test(the_ground_under_the_camera_has_no_hole),
        cmocka_unit_test(steep_triangles_have_their_depths),
        cmocka_unit_test(lines_cross_the_near_plane),
        cmocka_unit_test(textures_come_from_the_block_and_go_back),
        cmocka_unit_test(backdrops_outlive_what_they_are_made_of),
        cmocka_unit_test(a_frame_larger_than_the_memory_stays_empty),
        cmocka_unit_test(frames_are_the_same_on_every_machine),
        cmocka_unit_test(formats_show_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
