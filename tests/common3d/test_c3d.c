/* What the picture must show: projection, directions, textures, fog and all draw flags, as text, on
 * every back end. All kits are open at once in this one process, so each picture also shows that
 * OSMesa and EGL live side by side. */
#include "../rig/picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define M             PICTURE_M
#define EACH_KIT(kit) for (picture_kit *kit = kits; kit < kits + kits_open; kit++)

enum { KITS = 5, WIDTH = 16, HEIGHT = 12 };
/* in order: integers; desktop GL, GL ES, desktop GL by EGL; desktop GL with plain arrays */
static picture_kit kits[KITS];
static int kits_open; /* 1 where no GL is built in */

static int open_kits(void **state)
{
    (void)state;
    static const enum picture_kind kinds[KITS] = { PICTURE_SOFT, PICTURE_GL, PICTURE_GLES1,
                                                   PICTURE_EGL_GL, PICTURE_GL };
    int count = sys_surface_egl() ? KITS : 1;
    for (; kits_open < count; kits_open++)
        if (picture_open(&kits[kits_open], kinds[kits_open], WIDTH, HEIGHT, kits_open != 4) < 0)
            return -1;
    return 0;
}

static int close_kits(void **state)
{
    (void)state;
    EACH_KIT(kit) picture_close(kit);
    return 0;
}

/* Every test begins with the frame picture_open made. */
static c3d_frame first_frame;
static int keep_frame(void **state)
{
    (void)state;
    if (!first_frame.camera.width) first_frame = kits[0].frame;
    EACH_KIT(kit) kit->frame = first_frame;
    return 0;
}

/* d = 8 px. The square from (3, 8, 1) m of half a metre, with d = 16: columns 8 + 16*3/8 .. 8 +
 * 16*3.5/8, rows 6 - 16*1.5/8 .. */
static void a_known_square_is_one_pixel(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        kit->frame.camera.focal_q8 = 16 * 256;
        c3d_draw draw = picture_square(kit, PICTURE_SOUTH, 3 * M, 8 * M, M, M / 2, PICTURE_RED);
        assert_true(
            picture_is(kit, &draw, 1,
                       "................\n................\n................\n..............r.\n"
                       "................\n................\n................\n................\n"
                       "................\n................\n................\n................\n"));
    }
}

/* Posts of 2 m, 8 m away: red in the north, green in the east, blue in the south, white in the
 * west. */
static void yaw_grows_clockwise(void **state)
{
    (void)state;
    static const char middle[4] = { 'r', 'g', 'b', 'w' };
    EACH_KIT(kit)
    {
        const c3d_draw posts[4] = {
            picture_square(kit, PICTURE_SOUTH, -M, 8 * M, -M, 2 * M, PICTURE_RED),
            picture_square(kit, PICTURE_WEST, 8 * M, -M, -M, 2 * M, PICTURE_GREEN),
            picture_square(kit, PICTURE_SOUTH, -M, -8 * M, -M, 2 * M, PICTURE_BLUE),
            picture_square(kit, PICTURE_WEST, -8 * M, -M, -M, 2 * M, PICTURE_WHITE)
        };
        for (int quarter = 0; quarter < 4; quarter++) {
            char expected[HEIGHT * (WIDTH + 1) + 1];
            for (int y = 0; y < HEIGHT; y++) {
                memset(expected + y * (WIDTH + 1), '.', WIDTH);
                expected[y * (WIDTH + 1) + WIDTH] = '\n';
                if (y == 5 || y == 6) memset(expected + y * (WIDTH + 1) + 7, middle[quarter], 2);
            }
            expected[sizeof expected - 1] = 0;
            kit->frame.camera.yaw = quarter * 16384;
            assert_true(picture_is(kit, posts, 4, expected));
        }
        kit->frame.camera.yaw = 4096; /* turned to the right: the north is left of the middle */
        assert_true(
            picture_is(kit, posts, 1,
                       "................\n................\n................\n................\n"
                       "................\n...rrr..........\n...rrr..........\n................\n"
                       "................\n................\n................\n................\n"));
    }
}

/* The first row in which a column shows the ground, HEIGHT when none does. */
static int horizon(const uint8_t *rgb, int column)
{
    int row = 0;
    while (row < HEIGHT && rgb[(row * WIDTH + column) * 3 + 1] < 128) row++;
    return row;
}

static void horizon_of(picture_kit *kit, int32_t pitch, int32_t roll, int *left, int *right)
{
    uint8_t rgb[WIDTH * HEIGHT * 3];
    c3d_draw ground = picture_square(kit, PICTURE_LEVEL, -2000 * M, -2000 * M, -M, 4000 * M,
                                     PICTURE_GREEN);
    kit->frame.camera.pitch = pitch;
    kit->frame.camera.roll = roll;
    picture_render(kit, &ground, 1, rgb);
    *left = horizon(rgb, 0);
    *right = horizon(rgb, WIDTH - 1);
}

static void pitch_moves_and_roll_tilts_the_horizon(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        int left, right;
        horizon_of(kit, 0, 0, &left, &right);
        assert_int_equal(left, HEIGHT / 2);
        assert_int_equal(right, HEIGHT / 2);
        /* up: 8 px * tan 22.5 degrees = 3.3 rows more sky */
        horizon_of(kit, 4096, 0, &left, &right);
        assert_int_equal(left, 9);
        assert_int_equal(right, 9);
        horizon_of(kit, -4096, 0, &left, &right);
        assert_int_equal(left, 3);
        /* clockwise: the right hand goes down, and sees ground further up */
        horizon_of(kit, 0, 2048, &left, &right);
        assert_true(left > HEIGHT / 2 && right < HEIGHT / 2);
        horizon_of(kit, 0, 32768, &left, &right);
        assert_int_equal(left, 0); /* upside down */
    }
}

/* row 0: red, green */
static const uint8_t quarters_rgba[4 * 4] = { 255, 0, 0, 255, 0, 255, 0, 255,
                                              /* row 1: blue, white (transparent) */
                                              0, 0, 255, 255, 255, 255, 255, 0 };

/* A texture of 2 by 2 enlarged to 8 by 8, so that bilinear filtering blurs one pixel only. */
static c3d_texture quarters(picture_kit *kit)
{
    uint8_t pixels[8 * 8 * 4];
    for (int y = 0; y < 8; y++)
        for (int x = 0; x < 8; x++)
            memcpy(pixels + (y * 8 + x) * 4, quarters_rgba + (y / 4 * 2 + x / 4) * 4, 4);
    kit->api->make_current(kit->surface);
    return c3d_texture_make(kit->device, C3D_RGBA8888, 8, 8, pixels);
}

static void draw_textured(c3d_draw *draw, c3d_texture texture, uint32_t flags)
{
    draw->texture = texture;
    draw->flags = C3D_DRAW_TEXTURED | flags;
    draw->tex_scale_q16[0] = draw->tex_scale_q16[1] = 65536;
    draw->tex_columns = 2;
}

static const char map_picture[] =
    "................\n................\n....bbbbwwww....\n....bbbbwwww....\n....bbbbwwww....\n....bbbbwwww....\n"
    "....rrrrgggg....\n....rrrrgggg....\n....rrrrgggg....\n....rrrrgggg....\n................\n................\n";

static void texture_rows_begin_in_the_south(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        c3d_texture texture = quarters(kit);
        kit->frame.camera.pitch = -16384; /* straight down: north is up, east is right */
        c3d_draw draw = picture_square(kit, PICTURE_LEVEL, -4 * M, -4 * M, -8 * M, 8 * M,
                                       PICTURE_WHITE);
        draw_textured(&draw, texture, 0);
        assert_true(picture_is(kit, &draw, 1, map_picture));
        kit->frame.camera.pitch = 0; /* upright squares: the second row of vertices is above */
        draw = picture_square(kit, PICTURE_SOUTH, -4 * M, 8 * M, -4 * M, 8 * M, PICTURE_WHITE);
        draw_textured(&draw, texture, 0);
        assert_true(picture_is(kit, &draw, 1, map_picture));
        kit->frame.camera.yaw = -16384; /* to the west, y grows to the right */
        draw = picture_square(kit, PICTURE_WEST, -8 * M, -4 * M, -4 * M, 8 * M, PICTURE_WHITE);
        draw_textured(&draw, texture, 0);
        assert_true(picture_is(kit, &draw, 1, map_picture));
        c3d_texture_free(kit->device, texture);
    }
}

static void texture_window_scales_and_shifts(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        c3d_texture texture = quarters(kit);
        c3d_draw draw = picture_square(kit, PICTURE_SOUTH, -8 * M, 8 * M, -6 * M, 16 * M,
                                       PICTURE_WHITE);
        draw_textured(&draw, texture, 0);
        /* a quarter of the texture: the middle of its green part */
        draw.tex_scale_q16[0] = draw.tex_scale_q16[1] = 16384;
        draw.tex_offset_q16[0] = 40960;
        draw.tex_offset_q16[1] = 8192;
        uint8_t rgb[WIDTH * HEIGHT * 3];
        picture_render(kit, &draw, 1, rgb);
        for (int i = 0; i < WIDTH * HEIGHT; i++) assert_memory_equal(rgb + i * 3, "\0\377\0", 3);
        c3d_texture_free(kit->device, texture);
    }
}

/* Neither the middle column's place nor the size of a place says where the texture lies: its middle
 * is at the second of three columns. */
static void textures_lie_on_the_grid_of_the_mesh(void **state)
{
    (void)state;
    static const uint16_t strip[6] = { 3, 0, 4, 1, 5, 2 };
    static const int32_t far_x = 1 << 22;
    EACH_KIT(kit)
    {
        static const c3d_vertex vertex[6] = {
            { .x = far_x },         { .x = far_x + 2 },         { .x = far_x + 6 },
            { .x = far_x, .z = 8 }, { .x = far_x + 2, .z = 8 }, { .x = far_x + 6, .z = 8 }
        };
        c3d_texture texture = quarters(kit);
        c3d_draw draw = { .mesh = c3d_mesh_make(kit->device, vertex, 6),
                          .strip = c3d_strip_make(kit->device, strip, 6),
                          .origin_wu = { (-4 - (int64_t)far_x) * M, 8 * M, -4 * M },
                          .xy_scale_wu = M,
                          .z_scale_q16 = M << 16,
                          .colour = PICTURE_WHITE };
        draw_textured(&draw, texture, 0);
        draw.tex_columns = 3;
        draw.tex_scale_q16[0] = 32768;
        assert_true(
            picture_is(kit, &draw, 1,
                       "................\n................\n....bbwwww......\n....bbwwww......\n"
                       "....bbwwww......\n....bbwwww......\n....rrgggg......\n....rrgggg......\n"
                       "....rrgggg......\n....rrgggg......\n................\n................\n"));
        /* The last column ends a quarter of the way, the last row too: beyond, red is all there is.
         */
        draw.tex_scale_q16[0] = 21845;
        draw.tex_last_q16[0] = 5 << 14;
        draw.tex_last_q16[1] = 1 << 14;
        assert_true(
            picture_is(kit, &draw, 1,
                       "................\n................\n....rrrrrr......\n....rrrrrr......\n"
                       "....rrrrrr......\n....rrrrrr......\n....rrrrrr......\n....rrrrrr......\n"
                       "....rrrrrr......\n....rrrrrr......\n................\n................\n"));
        /* The first column begins where the second does, the first row as well: before, white. */
        draw.tex_first_q16[0] = draw.tex_first_q16[1] = 3 << 15;
        draw.tex_last_q16[0] = draw.tex_last_q16[1] = 0;
        draw.tex_scale_q16[0] = draw.tex_scale_q16[1] = 43690;
        assert_true(
            picture_is(kit, &draw, 1,
                       "................\n................\n....wwwwww......\n....wwwwww......\n"
                       "....wwwwww......\n....wwwwww......\n....wwwwww......\n....wwwwww......\n"
                       "....wwwwww......\n....wwwwww......\n................\n................\n"));
        c3d_texture_free(kit->device, texture);
        c3d_strip_free(kit->device, draw.strip);
        c3d_mesh_free(kit->device, draw.mesh);
    }
}

static void alpha_test_leaves_holes(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        c3d_texture texture = quarters(kit);
        c3d_draw draws[2];
        draws[0] = picture_square(kit, PICTURE_SOUTH, -4 * M, 8 * M, -4 * M, 8 * M, PICTURE_WHITE);
        draw_textured(&draws[0], texture, C3D_DRAW_ALPHA_TEST);
        /* a cyan square behind */
        draws[1] = picture_square(kit, PICTURE_SOUTH, -16 * M, 16 * M, -16 * M, 32 * M,
                                  0xFFFFFF00u);
        assert_true(
            picture_is(kit, draws, 2,
                       "cccccccccccccccc\ncccccccccccccccc\nccccbbbbcccccccc\nccccbbbbcccccccc\n"
                       "ccccbbbbcccccccc\nccccbbbbcccccccc\nccccrrrrggggcccc\nccccrrrrggggcccc\n"
                       "ccccrrrrggggcccc\nccccrrrrggggcccc\ncccccccccccccccc\ncccccccccccccccc\n"));
        c3d_texture_free(kit->device, texture);
    }
}

static void small_formats_have_the_right_bits(void **state)
{
    (void)state;
    static const uint16_t rgb565[4] = { 0xF800, 0x07E0, 0x001F, 0xFFFF };
    static const uint16_t rgba5551[4] = { 0xF801, 0x07C1, 0x003F, 0xFFFF };
    EACH_KIT(kit)
    {
        for (int i = 0; i < 2; i++) {
            uint8_t rgb[WIDTH * HEIGHT * 3];
            kit->api->make_current(kit->surface);
            c3d_texture texture = c3d_texture_make(kit->device, i ? C3D_RGBA5551 : C3D_RGB565, 2, 2,
                                                   i ? rgba5551 : rgb565);
            c3d_draw draw = picture_square(kit, PICTURE_SOUTH, -8 * M, 8 * M, -6 * M, 16 * M,
                                           PICTURE_WHITE);
            draw_textured(&draw, texture, C3D_DRAW_ALPHA_TEST);
            picture_render(kit, &draw, 1, rgb);
            assert_memory_equal(rgb + (11 * WIDTH + 0) * 3, "\377\0\0", 3);
            assert_memory_equal(rgb + (11 * WIDTH + 15) * 3, "\0\377\0", 3);
            c3d_texture_free(kit->device, texture);
        }
    }
}

static void colours_multiply_the_texture(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        c3d_texture texture = quarters(kit);
        /* yellow */
        c3d_draw draw = picture_square(kit, PICTURE_SOUTH, -4 * M, 8 * M, -4 * M, 8 * M,
                                       0xFF00FFFFu);
        draw_textured(&draw, texture, 0);
        assert_true(
            picture_is(kit, &draw, 1,
                       "................\n................\n........yyyy....\n........yyyy....\n"
                       "........yyyy....\n........yyyy....\n....rrrrgggg....\n....rrrrgggg....\n"
                       "....rrrrgggg....\n....rrrrgggg....\n................\n................\n"));
        c3d_texture_free(kit->device, texture);
    }
}

static void fog_grows_with_depth(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        uint8_t rgb[WIDTH * HEIGHT * 3];
        kit->frame.fog_colour = PICTURE_RED;
        kit->frame.fog_start_wu = 10 * M;
        kit->frame.fog_end_wu = 20 * M;
        static const struct {
            int distance_m;
            uint8_t red, blue;
        } expected[] = { { 8, 0, 255 }, { 15, 128, 128 }, { 18, 204, 51 }, { 40, 255, 0 } };
        for (int i = 0; i < 4; i++) {
            int64_t away = expected[i].distance_m * M;
            c3d_draw draw = picture_square(kit, PICTURE_SOUTH, -away, away, -away,
                                           (int32_t)(2 * away), PICTURE_BLUE);
            picture_render(kit, &draw, 1, rgb);
            /* a corner is hidden by depth */
            assert_true(abs(rgb[0] - expected[i].red) <= 3 && abs(rgb[2] - expected[i].blue) <= 3);
            draw.flags = C3D_DRAW_BACKDROP;
            picture_render(kit, &draw, 1, rgb);
            assert_memory_equal(rgb, "\0\0\377", 3);
        }
    }
}

static void depth_hides_at_any_ratio(void **state)
{
    (void)state;
    static const int64_t depth_m[][2] = {
        { 1, 2 }, { 50, 51 }, { 1000, 1010 }, { 10000, 10300 }, { 60000, 65000 }
    };
    EACH_KIT(kit)
    {
        kit->frame.camera.near_wu = 26; /* 0.1 m to 100 km */
        kit->frame.camera.far_wu = 26000000;
        for (size_t i = 0; i < sizeof depth_m / sizeof *depth_m; i++)
            for (int first = 0; first < 2; first++) {
                uint8_t rgb[WIDTH * HEIGHT * 3];
                c3d_draw draws[2];
                for (int j = 0; j < 2; j++) {
                    int64_t away = depth_m[i][j ^ first] * M,
                            half = away < 8000 * M ? away : 8000 * M;
                    draws[j] = picture_square(kit, PICTURE_SOUTH, -half, away, -half,
                                              (int32_t)(2 * half),
                                              j ^ first ? PICTURE_BLUE : PICTURE_RED);
                }
                picture_render(kit, draws, 2, rgb);
                assert_memory_equal(rgb + (6 * WIDTH + 8) * 3, "\377\0\0", 3);
            }
    }
}

static void backdrops_are_behind_everything(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        kit->frame.camera.far_wu = 100 * M;
        c3d_draw draws[3] = {
            picture_square(kit, PICTURE_SOUTH, -900 * M, 900 * M, -900 * M, 1800 * M, PICTURE_BLUE),
            picture_square(kit, PICTURE_SOUTH, -M, M, -M, 2 * M, PICTURE_GREEN),
            picture_square(kit, PICTURE_SOUTH, -90 * M, 90 * M, 0, 90 * M, PICTURE_RED)
        };
        draws[0].flags = C3D_DRAW_BACKDROP; /* beyond the far plane */
        draws[1].flags = C3D_DRAW_BACKDROP; /* nearer to the eye than the draw over it */
        assert_true(
            picture_is(kit, draws, 3,
                       "rrrrrrrrgggggggg\nrrrrrrrrgggggggg\nrrrrrrrrgggggggg\nrrrrrrrrgggggggg\n"
                       "rrrrrrrrgggggggg\nrrrrrrrrgggggggg\ngggggggggggggggg\ngggggggggggggggg\n"
                       "gggggggggggggggg\ngggggggggggggggg\ngggggggggggggggg\ngggggggggggggggg\n"));
        draws[1].origin_wu[0] = 0;       /* the right half only */
        draws[2].origin_wu[1] = 110 * M; /* beyond the far plane only a backdrop is drawn */
        assert_true(
            picture_is(kit, draws, 3,
                       "bbbbbbbbgggggggg\nbbbbbbbbgggggggg\nbbbbbbbbgggggggg\nbbbbbbbbgggggggg\n"
                       "bbbbbbbbgggggggg\nbbbbbbbbgggggggg\nbbbbbbbbgggggggg\nbbbbbbbbgggggggg\n"
                       "bbbbbbbbgggggggg\nbbbbbbbbgggggggg\nbbbbbbbbgggggggg\nbbbbbbbbgggggggg\n"));
    }
}

static void wireframes_are_the_edges(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        c3d_stats stats;
        c3d_draw draws[2] = {
            picture_square(kit, PICTURE_SOUTH, -4 * M, 8 * M, -4 * M, 8 * M, PICTURE_BLUE),
            picture_square(kit, PICTURE_SOUTH, -4 * M, 8 * M, -4 * M, 8 * M, PICTURE_WHITE)
        };
        /* off pixel centres */
        for (int i = 0; i < 2; i++) draws[i].origin_wu[0] += M / 4, draws[i].origin_wu[2] -= M / 4;
        draws[1].flags = C3D_DRAW_WIREFRAME | C3D_DRAW_ON_TOP;
        assert_true(
            picture_is(kit, draws, 2,
                       "................\n................\n....wwwwwwwww...\n....wwbbbbbbw...\n"
                       "....wbwbbbbbw...\n....wbbwbbbbw...\n....wbbbwbbbw...\n....wbbbbwbbw...\n"
                       "....wbbbbbwbw...\n....wbbbbbbww...\n....wwwwwwww....\n................\n"));
        c3d_get_stats(kit->device, &stats);
        assert_int_equal(stats.frame_draws, 2);
        assert_int_equal(stats.frame_triangles, 2);
    }
}

/* Lines over slanting ground lose no pixel to it, but are hidden by what stands before them. */
static void lines_on_top_keep_their_pixels(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        kit->frame.camera.pitch = -8192;
        /* the focal distance of a picture 16 times as wide: depth grows by 0.8 % a row */
        kit->frame.camera.focal_q8 = 128 * 256;
        for (int32_t roll = 0; roll < 65536; roll += 3001) {
            uint8_t alone[WIDTH * HEIGHT * 3], over[WIDTH * HEIGHT * 3];
            kit->frame.camera.roll = roll;
            c3d_draw draws[3] = {
                picture_square(kit, PICTURE_LEVEL, -M / 2, 8 * M - M / 2, -8 * M, M, PICTURE_BLUE),
                picture_square(kit, PICTURE_LEVEL, -M / 2, 8 * M - M / 2, -8 * M, M, PICTURE_WHITE),
                picture_square(kit, PICTURE_LEVEL, -32 * M, -32 * M, -7 * M, 64 * M, PICTURE_RED)
            };
            draws[1].flags = C3D_DRAW_WIREFRAME | C3D_DRAW_ON_TOP;
            picture_render(kit, draws + 1, 1, alone);
            picture_render(kit, draws, 2, over);
            for (int i = 0; i < WIDTH * HEIGHT; i++) assert_int_equal(alone[i * 3], over[i * 3]);
            picture_render(kit, draws, 3, over);
            for (int i = 0; i < WIDTH * HEIGHT; i++)
                assert_memory_equal(over + i * 3, "\377\0\0", 3);
        }
    }
}

static void overlays_lie_on_top(void **state)
{
    (void)state;
    EACH_KIT(kit)
    {
        uint8_t rgb[WIDTH * HEIGHT * 3];
        char text[HEIGHT * (WIDTH + 1) + 1];
        c3d_texture texture = quarters(kit);
        c3d_draw near = picture_square(kit, PICTURE_SOUTH, -M, M, -M, 2 * M, 0xFFFFFF00u);
        c3d_begin(kit->device, &kit->frame);
        c3d_draw_strip(kit->device, &near);
        c3d_overlay(kit->device, texture, 2, 1, 8, 8);
        /* at equal depth the square is drawn again, over the overlay */
        c3d_draw_strip(kit->device, &near);
        c3d_overlay(kit->device, texture, 2, 1, 8, 8);
        c3d_end(kit->device);
        assert_int_equal(c3d_read_rgb(kit->device, rgb), FF_OK);
        picture_text(rgb, WIDTH, HEIGHT, text);
        assert_string_equal(
            text, "cccccccccccccccc\nccrrrrggggcccccc\nccrrrrggggcccccc\nccrrrrggggcccccc\n"
                  "ccrrrrggggcccccc\nccbbbbcccccccccc\nccbbbbcccccccccc\nccbbbbcccccccccc\n"
                  "ccbbbbcccccccccc\ncccccccccccccccc\ncccccccccccccccc\ncccccccccccccccc\n");
        c3d_texture_free(kit->device, texture);
    }
}

int main(void)
{
#define PICTURE_TEST(name) cmocka_unit_test_setup(name, keep_frame)
    const struct CMUnitTest tests[] = {
        PICTURE_TEST(a_known_square_is_one_pixel),
        PICTURE_TEST(yaw_grows_clockwise),
        PICTURE_TEST(pitch_moves_and_roll_tilts_the_horizon),
        PICTURE_TEST(texture_rows_begin_in_the_south),
        PICTURE_TEST(texture_window_scales_and_shifts),
        PICTURE_TEST(textures_lie_on_the_grid_of_the_mesh),
        PICTURE_TEST(alpha_test_leaves_holes),
        PICTURE_TEST(small_formats_have_the_right_bits),
        PICTURE_TEST(colours_multiply_the_texture),
        PICTURE_TEST(fog_grows_with_depth),
        PICTURE_TEST(depth_hides_at_any_ratio),
        PICTURE_TEST(backdrops_are_behind_everything),
        PICTURE_TEST(wireframes_are_the_edges),
        PICTURE_TEST(lines_on_top_keep_their_pixels),
        PICTURE_TEST(overlays_lie_on_top),
    };
    return cmocka_run_group_tests(tests, open_kits, close_kits);
}
