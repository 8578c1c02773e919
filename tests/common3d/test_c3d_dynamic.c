/* Things made and freed in flight: strips, lines, points, labels; the same pixels on every back
 * end. */
#include "../rig/picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define M PICTURE_M

enum { WIDTH = 32, HEIGHT = 16, TEXT = HEIGHT * (WIDTH + 1) + 1, INDICES_MAX = 8192 };

static const struct {
    enum picture_kind kind;
    int buffers;
} ways[] = { { PICTURE_SOFT, 0 }, { PICTURE_SOFT_565, 0 }, { PICTURE_GL, 1 },
             { PICTURE_GL, 0 },   { PICTURE_GLES1, 1 },    { PICTURE_EGL_GL, 1 } };
#define WAYS (sizeof ways / sizeof *ways)

/* 1 px is 1 m at 16 m: one quarter of a pixel is one unit of the meshes below. */
static int open_way(size_t way, picture_kit *kit)
{
    if (!sys_surface_egl() && way > 1) return 0; /* integers alone where no GL is built in */
    assert_int_equal(picture_open(kit, ways[way].kind, WIDTH, HEIGHT, ways[way].buffers), FF_OK);
    return 1;
}
#define EACH_WAY(way, kit) \
    for (size_t way = 0; way < WAYS && open_way(way, &(kit)); way++, picture_close(&(kit)))

/* Draws the mesh's x and z upright, 16 m away, (0, 0) at the bottom left corner of the picture. */
static c3d_draw upright(c3d_mesh mesh, c3d_strip strip, int64_t away_wu)
{
    return (c3d_draw){ .mesh = mesh,
                       .strip = strip,
                       .origin_wu = { -16 * M, away_wu, -8 * M },
                       .xy_scale_wu = M / 4,
                       .z_scale_q16 = (M / 4) << 16,
                       .colour = PICTURE_WHITE };
}

static c3d_vertex vertex_at(int x, int z, uint32_t rgba)
{
    c3d_vertex vertex = { .x = x, .z = z };
    for (int i = 0; i < 4; i++) vertex.rgba[i] = (uint8_t)(rgba >> (8 * i));
    return vertex;
}

typedef struct dynamic_scene {
    c3d_draw draw[8], points[4];
    c3d_label_draw label[4];
    size_t draws, point_draws, labels;
    size_t labels_after; /* the labels come after this many draws */
} dynamic_scene;

static void show(picture_kit *kit, const dynamic_scene *scene, char *text)
{
    uint8_t rgb[WIDTH * HEIGHT * 3];
    kit->api->make_current(kit->surface);
    c3d_begin(kit->device, &kit->frame);
    for (size_t i = 0; i <= scene->draws; i++) {
        for (size_t j = 0; i == scene->labels_after && j < scene->labels; j++)
            c3d_draw_label(kit->device, &scene->label[j]);
        if (i < scene->draws) c3d_draw_strip(kit->device, &scene->draw[i]);
    }
    for (size_t i = 0; i < scene->point_draws; i++) c3d_draw_points(kit->device, &scene->points[i]);
    c3d_end(kit->device);
    assert_int_equal(c3d_read_rgb(kit->device, rgb), FF_OK);
    picture_text(rgb, WIDTH, HEIGHT, text);
}

static void assert_shows(picture_kit *kit, const dynamic_scene *scene, const char *expected)
{
    char text[TEXT];
    show(kit, scene, text);
    if (strcmp(text, expected) != 0)
        print_message("# drawn by %s:\n%s# expected:\n%s", kit->api->name, text, expected);
    assert_string_equal(text, expected);
}

static c3d_stats stats_of(const picture_kit *kit)
{
    c3d_stats stats;
    c3d_get_stats(kit->device, &stats);
    return stats;
}

/* ---- strips ---- */

/* Eight columns of four pixels; strip i shows the i-th, however long it is. */
static c3d_mesh columns(c3d_device *device)
{
    c3d_vertex corner[32];
    for (int i = 0; i < 32; i++)
        corner[i] = vertex_at((i / 4 * 4 + (i & 1) * 4) * 4, (i >> 1 & 1) * HEIGHT * 4, ~0u);
    return c3d_mesh_make(device, corner, 32);
}

static c3d_strip column_strip(c3d_device *device, unsigned column, uint32_t count, int lines)
{
    static uint16_t index[INDICES_MAX];
    for (uint32_t i = 0; i < count; i++) index[i] = (uint16_t)(4 * column + (i < 3 ? i : 3));
    return lines ? c3d_lines_make(device, index, count) : c3d_strip_make(device, index, count);
}

static void strips_come_and_go(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        sys_random random;
        c3d_strip strip[7] = { { 0 } };
        int refused = 0, lines[7] = { 0 };
        c3d_mesh mesh = columns(kit.device);
        sys_random_seed(&random, 5, way);
        c3d_strip_free(kit.device, kit.strip);
        for (int round = 0; round < 300; round++) {
            unsigned i = sys_random_below(&random, 7);
            c3d_strip_free(kit.device, strip[i]);
            uint32_t count = (4 + sys_random_below(&random, 3500)) & ~1u;
            lines[i] = (int)sys_random_below(&random, 3) == 0;
            strip[i] = column_strip(kit.device, i, count, lines[i]);
            refused += !strip[i].id;
            dynamic_scene scene = { .draws = 7 };
            char text[TEXT];
            for (unsigned j = 0; j < 7; j++) scene.draw[j] = upright(mesh, strip[j], 16 * M);
            uint32_t stale = stats_of(&kit).stale_handles;
            show(&kit, &scene, text);
            for (unsigned j = 0; j < 7; j++) {
                stale += !strip[j].id;
                assert_int_equal(text[j * 4 + 1], strip[j].id && !lines[j] ? 'w' : '.');
            }
            assert_int_equal(stats_of(&kit).stale_handles, stale);
        }
        assert_true(refused > 20 && refused < 280);
        assert_true(stats_of(&kit).strip_indices_high <= INDICES_MAX);
        /* all memory is free again */
        for (unsigned i = 0; i < 7; i++) c3d_strip_free(kit.device, strip[i]);
        for (int round = 0; round < 3; round++) {
            c3d_strip all = column_strip(kit.device, 0, INDICES_MAX, 0);
            assert_int_not_equal(all.id, 0);
            assert_int_equal(column_strip(kit.device, 1, 3, 0).id, 0);
            c3d_strip_free(kit.device, all);
        }
        for (int round = 0; round < 2; round++) {
            c3d_strip all[PICTURE_STRIPS];
            for (unsigned i = 0; i < PICTURE_STRIPS; i++) {
                all[i] = column_strip(kit.device, i % 8, 4, 0);
                assert_int_not_equal(all[i].id, 0);
            }
            assert_int_equal(column_strip(kit.device, 0, 4, 0).id, 0);
            for (unsigned i = 0; i < PICTURE_STRIPS; i++) c3d_strip_free(kit.device, all[i]);
        }
        assert_int_equal(stats_of(&kit).strip_high, PICTURE_STRIPS);
    }
}

static void freed_strips_are_stale(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        c3d_mesh mesh = columns(kit.device);
        c3d_strip old = column_strip(kit.device, 1, 4, 0);
        c3d_strip_free(kit.device, old);
        c3d_strip reused = column_strip(kit.device, 2, 4, 0);
        assert_int_not_equal(old.id, reused.id);
        dynamic_scene scene = { .draws = 1, .draw = { upright(mesh, old, 16 * M) } };
        char text[TEXT];
        show(&kit, &scene, text);
        assert_null(strchr(text, 'w'));
        assert_int_equal(stats_of(&kit).stale_handles, 1);
        c3d_strip_free(kit.device, old);
        c3d_strip_free(kit.device, (c3d_strip){ 0 }); /* to free no strip is no fault */
        assert_int_equal(stats_of(&kit).stale_handles, 2);
    }
}

/* A strip may be freed as soon as it is drawn, even a backdrop's, which the integer back end draws
 * only at the end of the frame. */
static void a_strip_may_go_within_the_frame(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        uint8_t rgb[WIDTH * HEIGHT * 3];
        char text[TEXT];
        c3d_mesh mesh = columns(kit.device);
        kit.api->make_current(kit.surface);
        c3d_begin(kit.device, &kit.frame);
        for (unsigned i = 0; i < 6; i++) {
            c3d_draw draw = upright(mesh, column_strip(kit.device, i, 4, 0), 16 * M);
            draw.flags = i & 1 ? 0 : C3D_DRAW_BACKDROP;
            c3d_draw_strip(kit.device, &draw);
            c3d_strip_free(kit.device, draw.strip);
        }
        c3d_end(kit.device);
        assert_int_equal(c3d_read_rgb(kit.device, rgb), FF_OK);
        picture_text(rgb, WIDTH, HEIGHT, text);
        for (int i = 0; i < 8; i++) assert_int_equal(text[i * 4 + 1], i < 6 ? 'w' : '.');
    }
}

/* ---- lines ---- */

static const char blank_row[] = "................................\n";

/* Expected pictures: blank rows, and those given. */
typedef struct row_of_text {
    int row;
    const char *text;
} row_of_text;

static void expect(char *text, const row_of_text *rows, size_t count)
{
    for (int row = 0; row < HEIGHT; row++)
        memcpy(text + row * (WIDTH + 1), blank_row, sizeof blank_row);
    for (size_t i = 0; i < count; i++)
        memcpy(text + rows[i].row * (WIDTH + 1), rows[i].text, WIDTH);
}

/* A level line, a slanting one and a post; ends a quarter of a pixel off the corners. */
static c3d_mesh three_lines(c3d_device *device, c3d_strip *strip)
{
    static const uint16_t pairs[] = { 0, 1, 2, 3, 4, 5 };
    const c3d_vertex vertex[6] = {
        vertex_at(9, 54, PICTURE_RED),    vertex_at(45, 54, PICTURE_RED),
        vertex_at(53, 17, PICTURE_GREEN), vertex_at(69, 33, PICTURE_GREEN),
        vertex_at(102, 17, PICTURE_BLUE), vertex_at(102, 45, PICTURE_BLUE)
    };
    *strip = c3d_lines_make(device, pairs, 6);
    return c3d_mesh_make(device, vertex, 6);
}

static void lines_lie_where_they_are_drawn(void **state)
{
    (void)state;
    static const row_of_text rows[] = {
        { 2, "..rrrrrrrrr....................." },  { 5, ".........................b......" },
        { 6, ".........................b......" },  { 7, ".........................b......" },
        { 8, "................g........b......" },  { 9, "...............g.........b......" },
        { 10, "..............g..........b......" }, { 11, ".............g...........b......" }
    };
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        char expected[TEXT];
        dynamic_scene scene = { .draws = 1 };
        c3d_strip strip;
        c3d_mesh mesh = three_lines(kit.device, &strip);
        scene.draw[0] = upright(mesh, strip, 16 * M);
        scene.draw[0].flags = C3D_DRAW_WIREFRAME | C3D_DRAW_COLOURED;
        expect(expected, rows, sizeof rows / sizeof *rows);
        assert_shows(&kit, &scene, expected);
        assert_int_equal(stats_of(&kit).frame_triangles, 0);
        scene.draw[0].flags = C3D_DRAW_COLOURED; /* no triangles */
        expect(expected, rows, 0);
        assert_shows(&kit, &scene, expected);
        /* behind a square; and before one that is farther by less than 1/64, on top only */
        scene.draw[0].flags = C3D_DRAW_WIREFRAME | C3D_DRAW_COLOURED | C3D_DRAW_ON_TOP;
        scene.draw[1] = picture_square(&kit, PICTURE_SOUTH, -64 * M, 15 * M, -64 * M, 128 * M,
                                       PICTURE_WHITE);
        scene.draws = 2;
        char text[TEXT];
        show(&kit, &scene, text);
        assert_null(strchr(text, 'r'));
        scene.draw[1].origin_wu[1] = 16 * M - M / 8;
        show(&kit, &scene, text);
        assert_non_null(strchr(text, 'r'));
        scene.draw[0].flags = C3D_DRAW_WIREFRAME | C3D_DRAW_COLOURED;
        show(&kit, &scene, text);
        assert_null(strchr(text, 'r'));
    }
}

static void lines_take_their_room_and_no_more(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        uint16_t index[16] = { 0 };
        c3d_strip_free(kit.device, kit.strip);
        assert_int_equal(c3d_lines_make(kit.device, index, 0).id, 0);
        assert_int_equal(c3d_lines_make(kit.device, index, 3).id, 0);
        c3d_strip most = column_strip(kit.device, 0, INDICES_MAX - 2, 0);
        assert_int_equal(c3d_lines_make(kit.device, index, 12).id, 0);
        assert_int_not_equal(c3d_lines_make(kit.device, index, 10).id, 0); /* two of an index */
        assert_int_equal(c3d_lines_make(kit.device, index, 2).id, 0);
        assert_int_equal(stats_of(&kit).strip_indices_high, INDICES_MAX);
        c3d_strip_free(kit.device, most);
        assert_int_not_equal(c3d_lines_make(kit.device, index, 2).id, 0);
    }
}

/* ---- points ---- */

static void points_are_squares_of_pixels(void **state)
{
    (void)state;
    static const row_of_text rows[] = { { 4, "..........gg............bbb....." },
                                        { 5, "..r.......gg............bbb....." },
                                        { 6, "........................bbb....." } };
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        char expected[TEXT];
        dynamic_scene scene = { .point_draws = 3 };
        const c3d_vertex vertex[3] = { vertex_at(2 * 4 + 2, 10 * 4 + 2, PICTURE_RED),
                                       vertex_at(11 * 4 + 1, 11 * 4 + 1, PICTURE_GREEN),
                                       vertex_at(25 * 4 + 1, 10 * 4 + 3, PICTURE_BLUE) };
        for (int i = 0; i < 3; i++) {
            scene.points[i] = upright(c3d_mesh_make(kit.device, vertex + i, 1), (c3d_strip){ 0 },
                                      16 * M);
            scene.points[i].flags = C3D_DRAW_COLOURED;
            scene.points[i].point_px = (uint8_t)(i + 1);
        }
        expect(expected, rows, 3);
        assert_shows(&kit, &scene, expected);
        assert_int_equal(stats_of(&kit).frame_draws, 3);
        assert_int_equal(stats_of(&kit).stale_handles, 0);
        /* one colour for all points; a texture is ignored */
        for (int i = 0; i < 3; i++) {
            scene.points[i].flags = C3D_DRAW_TEXTURED;
            for (char *c = strpbrk(expected, "rgb"); c; c = strpbrk(c, "rgb")) *c = 'w';
        }
        assert_shows(&kit, &scene, expected);
        /* points are hidden like a surface at their depth */
        scene.draws = 1;
        scene.draw[0] = picture_square(&kit, PICTURE_SOUTH, 0, 16 * M - M / 8, -64 * M, 128 * M,
                                       PICTURE_GREEN);
        for (int row = 0; row < HEIGHT; row++)
            memset(expected + row * (WIDTH + 1) + WIDTH / 2, 'g', WIDTH / 2);
        assert_shows(&kit, &scene, expected);
        scene.points[2].flags = C3D_DRAW_ON_TOP;
        for (int row = 4; row < 7; row++) memset(expected + row * (WIDTH + 1) + 24, 'w', 3);
        assert_shows(&kit, &scene, expected);
        /* beyond the planes, behind the camera or with the middle beside the picture no point is
         * drawn */
        static const int64_t away[] = { 5000 * M, -16 * M, M / 8 };
        scene.draws = 0;
        for (int i = 0; i < 3; i++) scene.points[i].origin_wu[1] = away[i];
        expect(expected, rows, 0);
        assert_shows(&kit, &scene, expected);
        for (int i = 0; i < 3; i++) {
            scene.points[i].origin_wu[1] = 16 * M;
            scene.points[i].origin_wu[i ? 2 : 0] += i == 1 ? -12 * M : (i ? 6 : 30) * M;
        }
        assert_shows(&kit, &scene, expected);
        c3d_mesh_free(kit.device, scene.points[0].mesh);
        scene.point_draws = 1;
        assert_shows(&kit, &scene, expected);
        assert_int_equal(stats_of(&kit).stale_handles, 1);
    }
}

static void points_lie_in_fog(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        char text[TEXT];
        const c3d_vertex vertex = vertex_at(64, 32, 0);
        dynamic_scene scene = { .point_draws = 1 };
        scene.points[0] = upright(c3d_mesh_make(kit.device, &vertex, 1), (c3d_strip){ 0 }, 16 * M);
        scene.points[0].point_px = 2;
        kit.frame.fog_end_wu = 16 * M;
        kit.frame.fog_colour = PICTURE_RED;
        show(&kit, &scene, text);
        assert_non_null(strchr(text, 'r'));
    }
}

/* Alone before the sky, lines, points and labels keep their pixels, and leave no depth to the next
 * frame. */
static void nothing_else_stands_before_the_sky(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        char text[TEXT];
        c3d_strip strip;
        c3d_mesh mesh = three_lines(kit.device, &strip);
        const c3d_draw sky = picture_square(&kit, PICTURE_SOUTH, -2048 * M, 900 * M, -2048 * M,
                                            4096 * M, PICTURE_BLUE);
        for (int what = 0; what < 3; what++) {
            dynamic_scene scene = { .draws = 1, .labels_after = 1, .draw = { sky } };
            scene.draw[0].flags = C3D_DRAW_BACKDROP;
            scene.draw[1] = scene.points[0] = upright(mesh, strip, 16 * M);
            scene.draw[1].flags = C3D_DRAW_WIREFRAME;
            scene.points[0].point_px = 1;
            scene.label[0] = (c3d_label_draw){ .label = c3d_label_make(kit.device, "I"),
                                               .origin_wu = { 0, 16 * M, 0 },
                                               .colour = PICTURE_WHITE };
            scene.draws += what == 0;
            scene.point_draws = what == 1;
            scene.labels = what == 2;
            show(&kit, &scene, text);
            assert_non_null(strchr(text, 'w'));
            scene = (dynamic_scene){ .draws = 1, .draw = { sky } };
            show(&kit, &scene, text);
            assert_int_equal(strspn(text, "b\n"), TEXT - 1);
        }
    }
}

/* ---- labels ---- */

/* Of a point in the middle of pixel (column, row). */
static c3d_label_draw label_at(c3d_label label, int column, int row, int64_t away_wu)
{
    return (c3d_label_draw){ .label = label,
                             .origin_wu = { (2 * column + 1 - WIDTH) * away_wu / 32, away_wu,
                                            (HEIGHT - 2 * row - 1) * away_wu / 32 },
                             .colour = PICTURE_GREEN };
}

static const row_of_text hi_rows[] = {
    { 4, ".........g...g...g..............." }, { 5, ".........g...g...g..............." },
    { 6, ".........g...g...g..............." }, { 7, ".........ggggg...g..............." },
    { 8, ".........g...g...g..............." }, { 9, ".........g...g...g..............." },
    { 10, ".........g...g...g..............." }
};

static void labels_stand_over_their_points(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        char expected[TEXT], text[TEXT];
        dynamic_scene scene = { .labels = 1 };
        /* "H!": 11 pixels, the middle one 5 from the left */
        scene.label[0] = label_at(c3d_label_make(kit.device, "h!"), 14, 10, 16 * M);
        expect(expected, hi_rows, 7);
        memcpy(expected + 9 * (WIDTH + 1), blank_row, WIDTH);
        memcpy(expected + 9 * (WIDTH + 1) + 9, "g...g", 5);
        assert_shows(&kit, &scene, expected);
        assert_int_equal(stats_of(&kit).frame_draws, 1);
        /* a label looks the same at any distance, in any fog, however the camera turns */
        static const int64_t away[] = { M / 2, 300 * M, 3999 * M };
        kit.frame.fog_end_wu = M;
        for (int i = 0; i < 3; i++) {
            scene.label[0] = label_at(scene.label[0].label, 14, 10, away[i]);
            assert_shows(&kit, &scene, expected);
        }
        kit.frame.camera.roll = 32768; /* upside down: the text is not */
        scene.label[0] = label_at(scene.label[0].label, WIDTH - 1 - 14, HEIGHT - 1 - 10, 16 * M);
        assert_shows(&kit, &scene, expected);
        kit.frame.camera.roll = 0;
        /* the point moves on the screen */
        scene.label[0] = label_at(scene.label[0].label, 14 - 7, 10 + 3, 16 * M);
        scene.label[0].right_px = 7;
        scene.label[0].down_px = -3;
        assert_shows(&kit, &scene, expected);
        /* behind the camera, nearer than the near plane, beyond the far one */
        static const int64_t out[] = { -16 * M, M / 8, 4001 * M };
        expect(expected, hi_rows, 0);
        for (int i = 0; i < 3; i++) {
            scene.label[0] = label_at(scene.label[0].label, 14, 10, 16 * M);
            scene.label[0].origin_wu[1] = out[i];
            show(&kit, &scene, text);
            assert_string_equal(text, expected);
        }
    }
}

static void labels_are_cut_by_the_picture_s_edges(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        c3d_label label = c3d_label_make(kit.device, "#?[a1B2c3-a1B2c3-a1B2c3-"); /* cut off */
        for (int row = -8; row < HEIGHT + 16; row += 3)
            for (int column = -90; column < WIDTH + 90; column += 7) {
                char text[TEXT];
                dynamic_scene scene = { .labels = 1,
                                        .label = { label_at(label, column, row, 16 * M) } };
                show(&kit, &scene, text);
                int seen = row >= 0 && row < HEIGHT + 6 && column > -69 && column < WIDTH + 68;
                assert_true(strchr(text, 'g') == NULL || seen);
                if (row >= 6 && row < HEIGHT && column > -60 && column < WIDTH + 60)
                    assert_non_null(strchr(text, 'g'));
            }
    }
}

/* A label before the sky, and with a surface that hides it or does not, drawn before the label or
 * after it. */
static void hide_labels(picture_kit *kit, size_t labels_after)
{
    char text[TEXT];
    dynamic_scene scene = { .draws = 2, .labels = 1, .labels_after = labels_after };
    scene.label[0] = label_at(c3d_label_make(kit->device, "HI"), 14, 10, 16 * M);
    scene.draw[0] = picture_square(kit, PICTURE_SOUTH, -2048 * M, 900 * M, -2048 * M, 4096 * M,
                                   PICTURE_RED);
    scene.draw[0].flags = C3D_DRAW_BACKDROP;
    scene.draw[1] = picture_square(kit, PICTURE_SOUTH, -64 * M, 17 * M, -64 * M, 128 * M,
                                   PICTURE_WHITE);
    show(kit, &scene, text);
    assert_memory_equal(text + 7 * (WIDTH + 1) + 9, "gggggw", 6);
    /* ground at the label's point may be drawn a little nearer than it is */
    scene.draw[1].origin_wu[1] = 16 * M - M / 8;
    show(kit, &scene, text);
    assert_memory_equal(text + 7 * (WIDTH + 1) + 9, "gggggw", 6);
    scene.draw[1].origin_wu[1] = 15 * M;
    show(kit, &scene, text);
    assert_null(strchr(text, 'g'));
    /* a hill before the left part of it */
    scene.draw[1] = picture_square(kit, PICTURE_SOUTH, -66 * M, 12 * M, -32 * M, 64 * M,
                                   PICTURE_WHITE);
    show(kit, &scene, text);
    assert_memory_equal(text + 7 * (WIDTH + 1) + 9, "wwwwgr", 6);
}

static void labels_are_hidden_by_what_is_nearer(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        hide_labels(&kit, 2);
        hide_labels(&kit, 1);
    }
}

static void label_pools_fill_and_empty(void **state)
{
    (void)state;
    picture_kit kit;
    EACH_WAY(way, kit)
    {
        char expected[TEXT];
        c3d_label label[8];
        assert_int_equal(c3d_label_make(kit.device, "").id, 0);
        for (int round = 0; round < 3; round++) {
            for (int i = 0; i < 8; i++) {
                label[i] = c3d_label_make(kit.device, i & 1 ? "HI" : "_");
                assert_int_not_equal(label[i].id, 0);
            }
            assert_int_equal(c3d_label_make(kit.device, "HI").id, 0);
            for (int i = 0; i < 8; i++) c3d_label_free(kit.device, label[i]);
        }
        assert_int_equal(stats_of(&kit).label_high, 8);
        assert_int_equal(stats_of(&kit).stale_handles, 0);
        c3d_label reused = c3d_label_make(kit.device, "HI");
        dynamic_scene scene = { .labels = 1, .label = { label_at(label[7], 14, 10, 16 * M) } };
        expect(expected, hi_rows, 0);
        assert_int_not_equal(reused.id, label[7].id);
        assert_shows(&kit, &scene, expected);
        assert_int_equal(stats_of(&kit).stale_handles, 1);
        c3d_label_free(kit.device, label[7]);
        c3d_label_free(kit.device, (c3d_label){ 0 });
        assert_int_equal(stats_of(&kit).stale_handles, 2);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strips_come_and_go),
        cmocka_unit_test(freed_strips_are_stale),
        cmocka_unit_test(a_strip_may_go_within_the_frame),
        cmocka_unit_test(lines_lie_where_they_are_drawn),
        cmocka_unit_test(lines_take_their_room_and_no_more),
        cmocka_unit_test(points_are_squares_of_pixels),
        cmocka_unit_test(points_lie_in_fog),
        cmocka_unit_test(nothing_else_stands_before_the_sky),
        cmocka_unit_test(labels_stand_over_their_points),
        cmocka_unit_test(labels_are_cut_by_the_picture_s_edges),
        cmocka_unit_test(labels_are_hidden_by_what_is_nearer),
        cmocka_unit_test(label_pools_fill_and_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
