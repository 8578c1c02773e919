/* Lines, points and labels over hills: the integer back end against GL and GL ES, held as in
 * test_soft_agrees.c. */
#include "../rig/picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define M PICTURE_M

enum { WIDE = 240, HIGH = 160, HILLS = 16, VIEWS = 40, TOLERANCE = 8, PART_MAX = 200 };

/* Hills of 16 by 16 cells, and points a little over every second vertex. */
static void make_hills(c3d_device *device, c3d_mesh *ground, c3d_mesh *points, c3d_strip *strip,
                       c3d_strip *lines)
{
    c3d_vertex vertex[(HILLS + 1) * (HILLS + 1)], point[sizeof vertex / sizeof *vertex];
    uint16_t index[HILLS * (2 * HILLS + 4)], pair[4 * HILLS];
    uint32_t count = 0, points_made = 0, pairs = 0;
    sys_random random;
    sys_random_seed(&random, 3, 1);
    for (int y = 0; y <= HILLS; y++)
        for (int x = 0; x <= HILLS; x++) {
            c3d_vertex *v = &vertex[y * (HILLS + 1) + x];
            *v = (c3d_vertex){ .x = x, .y = y, .z = (int32_t)sys_random_below(&random, 400) };
            for (int i = 0; i < 3; i++) v->rgba[i] = (uint8_t)sys_random_below(&random, 256);
            if (!((x + y) & 1)) continue;
            point[points_made] = *v;
            point[points_made++].z = v->z + 20;
        }
    for (int y = 0; y < HILLS; y++) {
        for (int x = 0; x <= HILLS; x++) {
            uint16_t here = (uint16_t)(y * (HILLS + 1) + x);
            if (x == 0 && y > 0) index[count] = index[count - 1], count++;
            if (x == 0 && y > 0) index[count++] = (uint16_t)(here + HILLS + 1);
            index[count++] = (uint16_t)(here + HILLS + 1);
            index[count++] = here;
        }
        pair[pairs++] = (uint16_t)(y * (HILLS + 2)); /* from corner to corner */
        pair[pairs++] = (uint16_t)((y + 1) * (HILLS + 2));
        pair[pairs++] = (uint16_t)(y * (HILLS + 1) + HILLS / 2);
        pair[pairs++] = (uint16_t)((y + 1) * (HILLS + 1) + HILLS / 2);
    }
    *ground = c3d_mesh_make(device, vertex, sizeof vertex / sizeof *vertex);
    *points = c3d_mesh_make(device, point, points_made);
    *strip = c3d_strip_make(device, index, count);
    *lines = c3d_lines_make(device, pair, pairs);
}

typedef struct hills_kit {
    picture_kit kit;
    c3d_mesh ground, points;
    c3d_strip strip, lines;
    c3d_label label[4];
    uint8_t rgb[WIDE * HIGH * 3];
} hills_kit;

static void show_hills(hills_kit *hills, int view)
{
    c3d_camera *camera = &hills->kit.frame.camera;
    c3d_device *device = hills->kit.device;
    int64_t eye[3] = { 40 * M * (view % 5) - 80 * M, -900 * M + 60 * M * (view % 7),
                       (300 + 45 * (view % 11)) * M };
    camera->yaw = view * 401 - 8000;
    camera->pitch = -2500 - 150 * (view % 9);
    camera->roll = view % 4 ? 0 : 1500;
    c3d_draw draw = { .mesh = hills->ground,
                      .strip = hills->strip,
                      .origin_wu = { -800 * M - eye[0], -800 * M - eye[1], -eye[2] },
                      .xy_scale_wu = 100 * M,
                      .z_scale_q16 = M << 16,
                      .flags = C3D_DRAW_COLOURED,
                      .point_px = (uint8_t)(1 + view % 5) };
    hills->kit.api->make_current(hills->kit.surface);
    c3d_begin(device, &hills->kit.frame);
    c3d_draw_strip(device, &draw);
    draw.strip = hills->lines;
    draw.flags = C3D_DRAW_WIREFRAME | C3D_DRAW_ON_TOP;
    draw.colour = PICTURE_WHITE;
    c3d_draw_strip(device, &draw);
    draw.mesh = hills->points;
    draw.flags = C3D_DRAW_COLOURED | (view & 1 ? C3D_DRAW_ON_TOP : 0);
    c3d_draw_points(device, &draw);
    for (int i = 0; i < 4; i++) {
        c3d_label_draw label = { .label = hills->label[i],
                                 .origin_wu = { (i - 2) * 350 * M - eye[0],
                                                (i - 1) * 250 * M - eye[1], 300 * M - eye[2] },
                                 .colour = PICTURE_RED };
        c3d_draw_label(device, &label);
    }
    c3d_end(device);
    assert_int_equal(c3d_read_rgb(device, hills->rgb), FF_OK);
}

static void integers_agree_with_gl(void **state)
{
    (void)state;
    enum { SOFT, GLES1, GL, KINDS };
    static const enum picture_kind kind[KINDS] = { PICTURE_SOFT, PICTURE_GLES1, PICTURE_GL };
    static hills_kit hills[KINDS];
    if (!sys_surface_egl()) return;
    for (int i = 0; i < KINDS; i++) {
        assert_int_equal(picture_open(&hills[i].kit, kind[i], WIDE, HIGH, 1), FF_OK);
        make_hills(hills[i].kit.device, &hills[i].ground, &hills[i].points, &hills[i].strip,
                   &hills[i].lines);
        for (int j = 0; j < 4; j++)
            hills[i].label[j] = c3d_label_make(hills[i].kit.device,
                                               j & 1 ? "Summit" : "Pass 2145 m");
    }
    for (int with = GLES1; with < KINDS; with++) {
        int worst = 0, worst_strict = 0;
        for (int view = 0; view < VIEWS; view++) {
            int strict, count;
            show_hills(&hills[SOFT], view);
            show_hills(&hills[with], view);
            count = picture_disagreement(hills[SOFT].rgb, hills[with].rgb, WIDE, HIGH, TOLERANCE,
                                         &strict);
            worst = count > worst ? count : worst;
            worst_strict = strict > worst_strict ? strict : worst_strict;
        }
        print_message(
            "# against %s: at most %.3f %% of pixels disagree (%.3f %% without allowing for "
            "edges)\n",
            hills[with].kit.api->name, 100.0 * worst / (WIDE * HIGH),
            100.0 * worst_strict / (WIDE * HIGH));
        assert_in_range(worst, 0, WIDE * HIGH / PART_MAX);
    }
    assert_int_equal(sys_png_write("build/tests/c3d-dynamic-soft.png", hills[SOFT].rgb, WIDE, HIGH),
                     FF_OK);
    assert_int_equal(sys_png_write("build/tests/c3d-dynamic-gl.png", hills[GL].rgb, WIDE, HIGH),
                     FF_OK);
    for (int i = 0; i < KINDS; i++) picture_close(&hills[i].kit);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(integers_agree_with_gl) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
