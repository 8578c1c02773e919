/* The auditor over ground of known error: flat ground drawn too high, panoramas taken elsewhere,
 * nothing drawn; its ray casting and heights are compared with slower ways to the same answer. */
#include "../../server/panorama/ff_face_view.h"
#include "../../sim/judge/sim_cube.h"
#include "../rig/pack_fixture.h"
#include "../rig/scene_fixture.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Depth along the view at which the pixels of row y meet the flat ground; 0 when they miss it or
 * meet the plane north of the terrain. */
static double row_depth_m(const scene *s, unsigned y)
{
    double below = y + 0.5 - 160,
           depth = below > 0 ? 200 * (s->view.camera.focal_q8 / 256.0) / below : 0;
    return depth < 8192 ? depth : 0;
}

typedef struct expected {
    double sum_squares, most;
    uint32_t count;
} expected;

static void expect_error(expected *e, double error)
{
    e->sum_squares += error * error;
    e->most = fmax(e->most, error);
    e->count++;
}

/* Ground drawn h too high, seen from H above: a pixel v below the horizon shows it h/H nearer to
 * the horizon, v*h/H pixels off. Beyond the terrain's true end it is drawn over the sky: a pixel
 * there is off by the way to that end. The skyline is off by the way between the two ends. */
static void flat_ground_too_high(void **state)
{
    (void)state;
    static scene s;
    scene_flat(&s);
    for (uint16_t steps = 0; steps <= 150; steps += 50) {
        sim_audit_result result;
        expected e = { 0 };
        uint32_t over_sky = 0;
        scene_draw(&s, steps);
        for (unsigned y = SCENE_STEP_PX / 2; y < 320; y += SCENE_STEP_PX)
            for (unsigned x = SCENE_STEP_PX / 2; x < 240; x += SCENE_STEP_PX) {
                double below = y + 0.5 - 160;
                if (row_depth_m(&s, y) > 0)
                    expect_error(&e, below * steps / 200.0);
                else if (below > scene_border_px(&s, 200 - steps)) {
                    expect_error(&e, scene_border_px(&s, 200) - below);
                    over_sky++;
                }
            }
        assert_int_equal(over_sky, steps ? 30 : 0);
        assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
        assert_int_equal(result.ground_pixels, e.count - over_sky);
        assert_int_equal(result.sky_pixels, over_sky);
        assert_int_equal(result.panorama_pixels + result.undrawn_pixels, 0);
        scene_assert_near(result.err_px_max, e.most);
        assert_true(fabs(result.err_px_rms - sqrt(e.sum_squares / e.count)) < 1e-3);
        assert_int_equal(result.skyline_columns, 240);
        assert_true(fabs(result.skyline_px_rms - scene_border_px(&s, steps)) < 1.0 / 16);
        assert_true(fabs(result.skyline_px_max - scene_border_px(&s, steps)) < 1.0 / 16);
        assert_true(fabs(result.skyline_px_p95 - scene_border_px(&s, steps)) < 1.0 / 16);
        assert_true(result.err_px_p95 <= e.most + 1e-9 &&
                    result.err_px_p95 >= result.err_px_rms - 1e-9);
    }
    scene_free(&s);
}

/* Ground drawn above the eye: the error is the largest a picture can have, not a meaningless
 * number. */
static void ground_above_the_eye(void **state)
{
    (void)state;
    static scene s;
    sim_audit_result result;
    scene_flat(&s);
    scene_draw(&s, 5000);
    s.view.camera.pitch = -16384; /* straight down */
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_true(result.ground_pixels > 0);
    scene_assert_near(result.err_px_max, hypot(240, 320));
    scene_assert_near(result.err_px_rms, hypot(240, 320));
    scene_free(&s);
}

/* Nothing is drawn, so no edge is near: each pixel is off by the size of the picture. */
static void nothing_drawn_is_a_picture_off(void **state)
{
    (void)state;
    static scene s;
    sim_audit_result result;
    scene_flat(&s);
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_true(result.undrawn_pixels > 100);
    scene_assert_near(result.undrawn_percent, 100);
    scene_assert_near(result.err_px_max, hypot(240, 320));
    scene_assert_near(result.err_px_rms, hypot(240, 320));
    scene_assert_near(result.square_px[SIM_CAUSE_UNDRAWN], result.err_px_rms * result.err_px_rms);
    /* the skyline is missing down to the picture's lower border */
    assert_int_equal(result.skyline_columns, 240);
    assert_true(fabs(result.skyline_px_rms - (160 - scene_border_px(&s, 200))) < 1.0 / 16);
    scene_draw(&s, 0);
    uint32_t all = result.undrawn_pixels;
    s.drawn[10] = s.drawn[0]; /* the tile ahead on the right is missing */
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.undrawn_pixels + result.ground_pixels, all);
    assert_true(result.undrawn_pixels > 0 && result.ground_pixels > 0);
    scene_free(&s);
}

/* Seen from 2 km up, the farthest row of tiles is missing: the drawn ground ends in a level line,
 * and each pixel above it is off by its distance to that line. */
static void ground_not_yet_drawn(void **state)
{
    (void)state;
    static scene s;
    sim_audit_result result;
    double sum = 0, most = 0;
    uint32_t undrawn = 0, all = 0;
    scene_flat(&s);
    scene_draw(&s, 0);
    s.view.camera.pos_wu[2] = 2000 * 256;
    s.view.drawn_count = 12;
    double focal = s.view.camera.focal_q8 / 256.0, border = 2000 * focal / 8192,
           edge = 2000 * focal / 4096;
    for (unsigned y = SCENE_STEP_PX / 2; y < 320; y += SCENE_STEP_PX) {
        double below = y + 0.5 - 160;
        all += below > border ? 240 / SCENE_STEP_PX : 0;
        if (below <= border || below >= edge) continue;
        undrawn += 240 / SCENE_STEP_PX;
        sum += (edge - below) * (edge - below) * (240 / SCENE_STEP_PX);
        most = fmax(most, edge - below);
    }
    assert_true(undrawn > 100);
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.undrawn_pixels, undrawn);
    assert_int_equal(result.ground_pixels + result.undrawn_pixels, all);
    assert_true(fabs(result.skyline_px_rms - (edge - border)) < 1.0 / 16);
    /* the edge is found to half a pixel */
    assert_true(result.err_px_max >= most - 1e-6 && result.err_px_max <= most + 0.5);
    assert_true(result.err_px_rms >= sqrt(sum / all) - 1e-6 &&
                result.err_px_rms <= sqrt(sum / all) + 0.5);
    scene_assert_near(result.square_px[SIM_CAUSE_UNDRAWN], result.err_px_rms * result.err_px_rms);
    scene_free(&s);
}

/* The same wrong ground under several qualities: the auditor names another cause each time. What
 * would be waited for of other nodes is not there of stubs. */
static void the_quality_names_the_cause(void **state)
{
    (void)state;
    static const struct {
        ff_quality quality;
        uint8_t levels;
        enum sim_audit_cause cause;
    } row[] = {
        { { .measure = FF_MEASURE_DISTANCE, .c_q8 = 9 * 256 }, 3, SIM_CAUSE_WAITING },
        { { .measure = FF_MEASURE_DISTANCE, .c_q8 = 9 * 256, .depth_max = 2 },
          3,
          SIM_CAUSE_WAITING },
        { { .measure = FF_MEASURE_DISTANCE, .c_q8 = 9 * 256, .depth_max = 1 }, 3, SIM_CAUSE_DEPTH },
        { { .measure = FF_MEASURE_DISTANCE, .c_q8 = 9 * 256 }, 1, SIM_CAUSE_QUALITY },
        { { .measure = FF_MEASURE_DISTANCE, .c_q8 = 8 }, 3, SIM_CAUSE_QUALITY },
        { { .measure = FF_MEASURE_PIXELS, .error_px_q8 = 1 }, 3, SIM_CAUSE_WAITING },
        { { .measure = FF_MEASURE_PIXELS, .error_px_q8 = 1, .depth_max = 1 }, 3, SIM_CAUSE_DEPTH },
        { { .measure = FF_MEASURE_PIXELS, .error_px_q8 = 400 * 256 }, 3, SIM_CAUSE_QUALITY },
    };
    static scene s;
    sim_audit_result result;
    scene_flat(&s);
    scene_draw(&s, 50);
    for (size_t i = 0; i < 2 * (sizeof row / sizeof *row); i++) {
        ff_terrain_info info = s.pack.header.info;
        int stub = i >= sizeof row / sizeof *row;
        size_t r = i % (sizeof row / sizeof *row);
        enum sim_audit_cause named = stub && row[r].cause == SIM_CAUSE_WAITING ? SIM_CAUSE_STUB
                                                                               : row[r].cause;
        for (uint32_t n = 0; n < s.view.drawn_count; n++) s.drawn[n].stub = (uint8_t)stub;
        /* as if the terrain had this many levels */
        info.tile_log2 = (uint8_t)(info.node_log2 + row[r].levels - 1);
        sim_auditor *auditor = sim_auditor_create(&s.ground, &info, SCENE_STEP_PX);
        assert_non_null(auditor);
        s.view.quality = row[r].quality;
        assert_int_equal(sim_audit_frame(auditor, &s.view, &result), FF_OK);
        assert_true(result.err_px_rms > 1);
        for (int cause = 0; cause < SIM_CAUSES; cause++)
            scene_assert_near(result.square_px[cause],
                              cause == (int)named ? result.err_px_rms * result.err_px_rms : 0);
        sim_auditor_destroy(auditor);
    }
    scene_free(&s);
}

/* A panorama taken s to the west shows everything at the same depth s*d/depth pixels too far to the
 * east, and half a texel more. */
static void parallax_is_the_way_over_the_depth(void **state)
{
    (void)state;
    static scene s;
    sim_audit_result result;
    for (int forwards = 0; forwards < 2; forwards++) {
        expected e = { 0 };
        double shift = 100, focal = 0;
        scene_flat(&s);
        focal = s.view.camera.focal_q8 / 256.0;
        scene_panorama(&s, 1024, forwards ? 0 : 100, forwards ? 100 : 0);
        for (unsigned y = SCENE_STEP_PX / 2; y < 320; y += SCENE_STEP_PX)
            for (unsigned x = SCENE_STEP_PX / 2; x < 240 && row_depth_m(&s, y) > 0;
                 x += SCENE_STEP_PX) {
                double depth = row_depth_m(&s, y), radius = hypot(x + 0.5 - 120, y + 0.5 - 160);
                expect_error(&e, focal / 1024 + (forwards ? radius * shift / (depth + shift)
                                                          : shift * focal / depth));
            }
        assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
        assert_int_equal(result.panorama_pixels, e.count);
        scene_assert_near(result.err_px_max, e.most);
        scene_assert_near(result.err_px_rms, sqrt(e.sum_squares / e.count));
        scene_assert_near(result.square_px[SIM_CAUSE_PANORAMA], e.sum_squares / e.count);
        scene_free(&s);
    }
}

/* The same over ground that falls away from O as from the viewer: of a place d to the north and x
 * to the side, seen (200 + c (x^2 + d^2)) / d below the horizon, O 100 m to the south. */
static void parallax_over_round_ground(void **state)
{
    (void)state;
    static scene s;
    sim_audit_result result;
    expected e = { 0 };
    scene_round(&s);
    double focal = s.view.camera.focal_q8 / 256.0, curve = s.ground.curve_per_m, back = 100;
    scene_panorama(&s, 1024, 0, 100);
    for (unsigned y = SCENE_STEP_PX / 2; y < 320; y += SCENE_STEP_PX)
        for (unsigned x = SCENE_STEP_PX / 2; x < 240 && y + 0.5 > 160; x += SCENE_STEP_PX) {
            double across = (x + 0.5 - 120) / focal, slope = (y + 0.5 - 160) / focal,
                   bend = curve * (1 + across * across), root = slope * slope - 800 * bend;
            if (root < 0) continue;
            double d = 400 / (slope + sqrt(root)), away = d + back;
            if (d > 8192) continue;
            double low = (200 + curve * (across * across * d * d + away * away)) / away;
            expect_error(&e, focal / 1024 + focal * hypot(across * d / away - across, low - slope));
        }
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.panorama_pixels, e.count);
    scene_assert_near(result.err_px_max, e.most);
    scene_assert_near(result.err_px_rms, sqrt(e.sum_squares / e.count));
    scene_free(&s);
}

/* Half a texel in pixels, of a pixel (x, y) from the middle of a picture that looks level at an
 * edge of the cube. Both faces beside the edge, u from their middle and v below it, lie at the
 * picture's (1 - u) / (1 + u) and sqrt(2) v / (1 + u). */
static double half_texel_at_an_edge(double focal, double size, double x, double y)
{
    double u = (1 - fabs(x) / focal) / (1 + fabs(x) / focal), v = y / focal * (1 + u) / sqrt(2),
           left = u - 1 / size, right = u + 1 / size;
    double w = focal * hypot((1 - left) / (1 + left) - (1 - right) / (1 + right),
                             sqrt(2) * v / (1 + left) - sqrt(2) * v / (1 + right)),
           h = focal * 2 / size * sqrt(2) / (1 + u);
    return fmax(w, h) / 2;
}

/* Taken where the viewer is, a panorama has no parallax: all its pixels are off by half a texel. On
 * the face straight ahead that is focal / size pixels everywhere. */
static void a_texel_is_an_error_of_half_its_size(void **state)
{
    (void)state;
    static const unsigned size[] = { 64, 256, 1024 };
    static scene s;
    sim_audit_result result;
    scene_flat(&s);
    s.view.camera.height = 240;          /* level faces alone */
    s.view.camera.pos_wu[2] = 100 * 256; /* the highest row looked at meets ground 4.6 km away */
    double focal = s.view.camera.focal_q8 / 256.0;
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        expected e = { 0 };
        scene_panorama(&s, size[i], 0, 0);
        s.view.camera.yaw = 0;
        assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
        assert_true(result.panorama_pixels > 100);
        scene_assert_near(result.err_px_rms, focal / size[i]);
        scene_assert_near(result.err_px_max, focal / size[i]);
        scene_assert_near(result.square_px[SIM_CAUSE_PANORAMA],
                          result.err_px_rms * result.err_px_rms);
        s.view.camera.yaw = 8192;
        for (int y = 120 + SCENE_STEP_PX / 2; y < 240; y += SCENE_STEP_PX)
            for (int x = SCENE_STEP_PX / 2; x < 240; x += SCENE_STEP_PX)
                expect_error(&e, half_texel_at_an_edge(focal, size[i], x - 119.5, y - 119.5));
        assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
        assert_int_equal(result.panorama_pixels, e.count);
        scene_assert_near(result.err_px_max, e.most);
        scene_assert_near(result.err_px_rms, sqrt(e.sum_squares / e.count));
    }
    scene_free(&s);
}

/* A place on the cube is where the renderer's camera of that face has it, texel by texel. */
static void the_cube_lies_as_the_renderer_has_it(void **state)
{
    (void)state;
    const ff_get_panorama request = { .front_wu = 8, .back_wu = 1 << 20, .face_size = 64 };
    for (unsigned face = 0; face < FF_FACE_COUNT; face++) {
        const sim_cube_place at = { .face = (enum ff_face_name)face, .column = 9.5, .row = 50.5 };
        sim_cube_place met;
        c3d_camera camera;
        double direction[3], pixel[2];
        ff_face_camera(&request, (enum ff_face_name)face, &camera);
        sim_cube_direction(&at, 64, direction);
        assert_int_equal(sim_audit_project(&camera, direction, pixel), 1);
        scene_assert_near(pixel[0], at.column);
        scene_assert_near(pixel[1], at.row);
        for (int i = 0; i < 3; i++) direction[i] *= 7;
        sim_cube_meet(direction, 64, &met);
        assert_int_equal(met.face, face);
        scene_assert_near(met.column, at.column);
        scene_assert_near(met.row, at.row);
        scene_assert_near(met.reach, 7);
    }
}

/* Only the faces held and only ground between front and back plane count as shown. */
static void a_panorama_shows_between_its_planes(void **state)
{
    (void)state;
    static scene s;
    sim_audit_result all, result;
    scene_flat(&s);
    scene_panorama(&s, 1024, 0, 0);
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &all), FF_OK);
    scene_assert_near(all.err_px_max, s.view.camera.focal_q8 / 256.0 / 1024);
    assert_int_equal(all.undrawn_pixels, 0);
    s.view.faces = 62; /* all faces but the north one */
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.undrawn_pixels + result.panorama_pixels, all.panorama_pixels);
    assert_true(result.panorama_pixels < all.panorama_pixels / 2);
    s.view.faces = 63;
    s.view.panorama.front_wu = 1000 * 256;
    s.view.panorama.back_wu = 5000 * 256;
    uint32_t between = 0;
    for (unsigned y = SCENE_STEP_PX / 2; y < 320; y += SCENE_STEP_PX)
        if (row_depth_m(&s, y) >= 1000 && row_depth_m(&s, y) <= 5000)
            between += 240 / SCENE_STEP_PX;
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.panorama_pixels, between);
    scene_free(&s);
}

/* ---- the parts ---- */

static void projection_is_the_renderers(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 6, 6);
    for (int i = 0; i < 200; i++) {
        c3d_camera camera = { .pos_wu = { 100000, -50000, 30000 },
                              .yaw = (int32_t)sys_random_below(&random, 65536),
                              .pitch = (int32_t)sys_random_below(&random, 32768) - 16384,
                              .roll = (int32_t)sys_random_below(&random, 65536),
                              .focal_q8 = 300 * 256,
                              .width = 240,
                              .height = 320 };
        c3d_rotation rotation;
        int64_t offset[3], eye[3];
        double point[3], pixel[2];
        for (int k = 0; k < 3; k++) {
            offset[k] = (int64_t)sys_random_below(&random, 2000000) - 1000000;
            point[k] = (double)(camera.pos_wu[k] + offset[k]) / 256;
        }
        c3d_rotation_from_camera(&camera, &rotation);
        c3d_to_eye(&rotation, offset, eye);
        if (eye[2] < 100000) continue;
        assert_int_equal(sim_audit_project(&camera, point, pixel), 1);
        assert_true(fabs(pixel[0] - (120 + (double)eye[0] * 300 / (double)eye[2])) < 0.01);
        assert_true(fabs(pixel[1] - (160 - (double)eye[1] * 300 / (double)eye[2])) < 0.01);
    }
}

/* A real cut with stitched borders: the auditor's triangles and the tree's own answer agree. */
static void drawn_height_of_a_cut(void **state)
{
    (void)state;
    terrain_fixture fx;
    sim_ground ground = { 0 };
    sys_random random;
    fixture_make(&fx, 3, 7, 2, 2, fixture_hills);
    fixture_tree(&fx, 2000, 200);
    ff_view view = fixture_view(600, 700, 300, 30, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    (void)fixture_settle(&fx, &view, &quality, 200);
    const ff_drawn *list;
    uint32_t count = ff_tree_cut(fx.tree, &list), stitched = 0, checked = 0;
    ground.hscale_m = fx.info.hscale_q24 / 16777216.0;
    ground.hoffset_m = fx.info.hoffset_wu / 256.0;
    sim_auditor *auditor = sim_auditor_create(&ground, &fx.info, SCENE_STEP_PX);
    for (uint32_t i = 0; i < count; i++) stitched += list[i].coarser != 0;
    assert_true(stitched > 4);
    sys_random_seed(&random, 7, 7);
    for (int i = 0; i < 3000; i++) {
        int32_t x_wu = (int32_t)sys_random_below(&random, 2550 * 256),
                y_wu = (int32_t)sys_random_below(&random, 2550 * 256), z_wu;
        double z_m;
        int drawn = ff_tree_drawn_height(fx.tree, x_wu, y_wu, &z_wu);
        assert_int_equal(
            sim_audit_drawn_height(auditor, list, count, x_wu / 256.0, y_wu / 256.0, &z_m), drawn);
        if (drawn && fabs(z_m - z_wu / 256.0) > 0.02)
            fail_msg("at %g, %g the auditor has %g, the tree %g", x_wu / 256.0, y_wu / 256.0, z_m,
                     z_wu / 256.0);
        checked += (uint32_t)drawn;
    }
    assert_true(checked > 1000);
    sim_auditor_destroy(auditor);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flat_ground_too_high),
        cmocka_unit_test(ground_above_the_eye),
        cmocka_unit_test(nothing_drawn_is_a_picture_off),
        cmocka_unit_test(parallax_is_the_way_over_the_depth),
        cmocka_unit_test(parallax_over_round_ground),
        cmocka_unit_test(a_texel_is_an_error_of_half_its_size),
        cmocka_unit_test(the_cube_lies_as_the_renderer_has_it),
        cmocka_unit_test(a_panorama_shows_between_its_planes),
        cmocka_unit_test(projection_is_the_renderers),
        cmocka_unit_test(drawn_height_of_a_cut),
        cmocka_unit_test(ground_not_yet_drawn),
        cmocka_unit_test(the_quality_names_the_cause),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
