/* The skyline and the sky, as the auditor judges them: a wall and a peak of known height, ground
 * where there is none, and a real ground that is drawn just as it is. */
#include "../rig/scene_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

/* A wall 1000 m high from west to east, 4096 m north of the terrain's middle. */
static uint16_t wall(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    (void)x;
    return y == 24 ? 1000 : 0;
}

/* One sample of the wall. */
static uint16_t peak(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    return x == 17 && y == 24 ? 1000 : 0;
}

static double skyline_of(const scene *s)
{
    sim_audit_result result;
    assert_int_equal(sim_audit_frame(s->auditor, &s->view, &result), FF_OK);
    assert_int_equal(result.skyline_columns, 240);
    assert_true(result.skyline_px_p95 <= result.skyline_px_max);
    assert_true(result.skyline_px_rms <= result.skyline_px_max + 1e-9);
    return result.skyline_px_max;
}

/* How far a face's first row of texels with ground begins below ground that stands `above_m` over
 * the eye at a distance: a texel shows ground when its middle does. */
static double texel_row_px(double focal, double size, double above_m, double distance_m)
{
    double row = (1 - above_m / distance_m) / 2 * size, first = ceil(row - 0.5);
    return fabs(first - row) * 2 * focal / size;
}

/* A wall that is not drawn: its skyline is off by the wall's height down to where drawn ground
 * ends. Shown by a panorama it is off by what its rows of texels are off. A peak is as far off as
 * the wall, in its own column alone. */
static void the_skyline_of_a_wall(void **state)
{
    (void)state;
    static const unsigned size[] = { 64, 100, 256, 1000 };
    static scene s;
    sim_audit_result result;
    scene_make(&s, wall);
    double focal = s.view.camera.focal_q8 / 256.0, missing = focal * 800 / 4096;
    scene_draw(&s, 0);
    missing += scene_border_px(&s, 200);
    assert_true(fabs(skyline_of(&s) - missing) < 1.0 / 16);
    s.view.drawn_count = 0;
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        scene_panorama(&s, size[i], 0, 0);
        assert_true(fabs(skyline_of(&s) - texel_row_px(focal, size[i], 800, 4096)) < 2.0 / 16);
    }
    scene_free(&s);
    scene_make(&s, peak);
    scene_draw(&s, 0);
    assert_true(fabs(skyline_of(&s) - missing) < 2); /* its top lies between two columns */
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    /* 512 m to either side it is down at z = 0: a triangle, as wide as it is high above the end of
     * the terrain; the mean of its squares is a third of the largest */
    double wide = 2 * focal * 512 / 4096 * missing / (focal * 1000 / 4096);
    assert_true(fabs(result.skyline_px_rms - missing * sqrt(wide / 240 / 3)) < 0.5);
    scene_free(&s);
}

/* Ground that falls away ends lower: drawn as it is there is no error, and a panorama taken here
 * has the end where it is, by its rows of texels. */
static void round_ground_ends_lower(void **state)
{
    (void)state;
    static const unsigned size[] = { 700, 900, 1000, 1024 };
    static scene s;
    sim_audit_result result;
    scene_round(&s);
    double focal = s.view.camera.focal_q8 / 256.0,
           below_m = 200 + sim_ground_drop_m(&s.ground, 0, 8192);
    assert_true(focal * (below_m - 200) / 8192 > 0.5);
    scene_draw(&s, 0);
    assert_true(skyline_of(&s) <= 1.0 / 16);
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_true(result.err_px_max < 1e-3 && result.sky_pixels == 0);
    s.view.drawn_count = 0;
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        scene_panorama(&s, size[i], 0, 0);
        s.view.panorama.front_wu = 6000 * FF_WU_PER_METRE;
        /* towards the sides it ends 0.2 px lower */
        assert_true(fabs(skyline_of(&s) - texel_row_px(focal, size[i], -below_m, 8192)) < 0.3);
    }
    scene_free(&s);
}

/* Ground where the sky should be is off by its distance to the true ground, whoever draws it. */
static void ground_over_the_sky_is_an_error(void **state)
{
    (void)state;
    static scene s;
    sim_audit_result result;
    scene_flat(&s);
    /* taken 100 m lower: 16 km of ground end higher in its faces */
    scene_panorama(&s, 1024, 0, 0);
    s.view.panorama.pos_wu[2] -= 100 * FF_WU_PER_METRE;
    double border = scene_border_px(&s, 200), texels = scene_border_px(&s, 100);
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.sky_pixels, 30); /* the row 4.5 pixels below the middle */
    assert_true(fabs(result.skyline_px_max - (border - texels)) < 0.3);
    scene_assert_near(result.square_px[SIM_CAUSE_PANORAMA], result.err_px_rms * result.err_px_rms);
    /* drawn over the viewer's head, by cells that reach from before the eye to behind it */
    s.view.faces = 0;
    scene_draw(&s, 300);
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_true(fabs(result.skyline_px_rms - (160 + border)) < 1.0 / 16);
    assert_int_equal(result.sky_pixels, 30 * 20); /* all above the middle */
    /* looking away from the terrain, from beyond it: nothing to judge */
    scene_draw(&s, 150);
    s.view.camera.pos_wu[1] = 20000 * 256;
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.sky_pixels + result.ground_pixels + result.undrawn_pixels, 0);
    assert_int_equal(result.skyline_columns, 0);
    /* 4 km south of it, looking up: only what is drawn 20 km high is in the picture, and no true
     * ground is near */
    s.view.camera.pos_wu[1] = -4000 * 256;
    s.view.camera.pos_wu[2] = 3000 * 256;
    s.view.camera.pitch = 8192;
    for (int i = 0; i < SCENE_SIDE * SCENE_SIDE; i++) s.heights[i] = 20000;
    assert_int_equal(sim_audit_frame(s.auditor, &s.view, &result), FF_OK);
    assert_int_equal(result.ground_pixels + result.undrawn_pixels, 0);
    assert_true(result.sky_pixels > 100);
    scene_assert_near(result.err_px_rms, hypot(240, 320));
    scene_free(&s);
}

/* All nodes of the finest level of a real ground, drawn as they are: nothing is wrong with it,
 * however it is looked at. */
static void ground_drawn_as_it_is_has_no_error(void **state)
{
    (void)state;
    enum { CELLS = 8, NODES = 16 };
    static uint16_t heights[NODES * NODES][SCENE_SIDE * SCENE_SIDE];
    static ff_drawn drawn[NODES * NODES];
    uint8_t *bytes;
    ff_pack pack;
    sim_ground ground;
    sys_random random;
    scene_usual_ground(&bytes, &pack, &ground);
    ff_terrain_info info = pack.header.info;
    assert_int_equal(info.node_log2, 3);
    for (int i = 0; i < NODES * NODES; i++) {
        int x = i % NODES * CELLS, y = i / NODES * CELLS;
        for (int k = 0; k < SCENE_SIDE * SCENE_SIDE; k++)
            heights[i][k] = ground.height[(y + k / SCENE_SIDE) * 129 + x + k % SCENE_SIDE];
        drawn[i] = (ff_drawn){ .heights = heights[i],
                               .cell_wu = 32 * 256,
                               .origin_wu = { x * 32 * 256, y * 32 * 256 } };
    }
    sim_auditor *auditor = sim_auditor_create(&ground, &info, SCENE_STEP_PX);
    assert_non_null(auditor);
    sys_random_seed(&random, 8, 8);
    for (int i = 0; i < 60; i++) {
        double at[2] = { scene_uniform(&random, 0, 4096), scene_uniform(&random, 0, 4096) };
        double z = sim_ground_height_m(&ground, at[0], at[1]) + scene_uniform(&random, 2, 500);
        sim_audit_view view = {
            .camera = { .pos_wu = { (int32_t)(at[0] * 256), (int32_t)(at[1] * 256),
                                    (int32_t)(z * 256) },
                        .yaw = (int32_t)sys_random_below(&random, 65536),
                        .pitch = (int32_t)sys_random_below(&random, 12000) - 6000,
                        .roll = i % 2 ? (int32_t)sys_random_below(&random, 8000) - 4000 : 0,
                        .focal_q8 = 208 * 256,
                        .width = 240,
                        .height = 320 },
            .drawn = drawn,
            .drawn_count = NODES * NODES
        };
        sim_audit_result result;
        assert_int_equal(sim_audit_frame(auditor, &view, &result), FF_OK);
        if (result.err_px_max > 1e-6 || result.skyline_px_max > 1.0 / 16 || result.sky_pixels ||
            result.undrawn_pixels)
            fail_msg("view %d: error %g, skyline %g, %u over the sky, %u not drawn", i,
                     result.err_px_max, result.skyline_px_max, result.sky_pixels,
                     result.undrawn_pixels);
    }
    sim_auditor_destroy(auditor);
    sim_ground_free(&ground);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_skyline_of_a_wall),
        cmocka_unit_test(round_ground_ends_lower),
        cmocka_unit_test(ground_over_the_sky_is_an_error),
        cmocka_unit_test(ground_drawn_as_it_is_has_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
