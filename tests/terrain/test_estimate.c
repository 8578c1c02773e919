/* The client's own estimate of its error: how errors spread over a picture, and what it says of
 * ground whose error is known. tests/sim/fly.sh holds it against the auditor. */
#include "../rig/terrain_fixture.h"
#include "../../client/terrain/ff_estimate.h"
#include "../../client/terrain/ff_spread.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#define M FF_WU_PER_METRE

static const ff_beyond nothing = { 0 };

static unsigned step_of(double px) { return ff_spread_step(ff_log2_q8((uint64_t)(px * 256))); }

static int about(double a, double b, double factor) { return a <= b * factor && b <= a * factor; }

static void logarithms_are_right_at_powers_and_straight_between(void **state)
{
    (void)state;
    for (int bits = 0; bits < 60; bits++)
        assert_int_equal(ff_log2_q8(UINT64_C(1) << bits), bits * 256);
    assert_int_equal(ff_log2_q8(384), 8 * 256 + 128);
    assert_int_equal(ff_spread_step(-1), 0);
    assert_int_equal(ff_spread_step(INT32_MAX), FF_SPREAD_STEPS - 1);
}

static void a_twentieth_of_the_pixels_passes_the_percentile(void **state)
{
    (void)state;
    ff_spread spread = { 0 };
    assert_int_equal(ff_spread_p95_q8(&spread), 0);
    spread.known[step_of(1)] = 960;
    spread.known[step_of(16)] = 40;
    assert_true(about(ff_spread_p95_q8(&spread) / 256.0, 1, 1.2));
    spread.known[step_of(16)] = 60;
    assert_true(about(ff_spread_p95_q8(&spread) / 256.0, 16, 1.2));
    spread.known[0] = 100000;
    assert_int_equal(ff_spread_p95_q8(&spread), 0);
}

/* Of many patches one in twenty is off by more than 0.42 of its bound; of one patch half of them
 * are off by more than a tenth. */
static void bounds_count_for_a_part_of_them(void **state)
{
    (void)state;
    ff_spread spread = { .patches = 10000 };
    spread.most[step_of(64)] = 10000;
    assert_true(about(ff_spread_p95_q8(&spread) / 256.0, 64 * 0.42, 1.2));
    double many = ff_spread_p95_q8(&spread);
    spread.patches = UINT64_C(10000) * 10000; /* one */
    assert_true(ff_spread_p95_q8(&spread) < 0.6 * many);
    assert_true(ff_spread_p95_q8(&spread) / 256.0 > 6.4);
}

static uint32_t estimate(const terrain_fixture *fx)
{
    return ff_estimate_p95_q8(fx->tree, &nothing);
}

static void exact_ground_has_no_error(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 7, 2, 2, fixture_flat);
    fixture_tree(&fx, 400, 64);
    ff_view view = fixture_view(1280, 600, 130, 0, -5);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    assert_int_equal(estimate(&fx), 0); /* nothing selected yet */
    fixture_settle(&fx, &view, &quality, 100);
    assert_int_equal(estimate(&fx), 0);
    fixture_free(&fx);
}

/* Allowed less error there is less, and always less than was allowed; the eye is inside the nodes'
 * boxes all the time. */
static void finer_ground_has_less_error(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view_above(&fx, 1900, 600, 20, 0, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    uint32_t first = 0, last = 0;
    for (int32_t pixels = 64; pixels >= 1; pixels /= 4) {
        quality.error_px_q8 = pixels * 256;
        fixture_settle(&fx, &view, &quality, 200);
        uint32_t p95_q8 = estimate(&fx);
        assert_true(p95_q8 < (uint32_t)quality.error_px_q8 && (!first || p95_q8 <= last));
        first = first ? first : p95_q8;
        last = p95_q8;
    }
    assert_true(first > 0 && last < first / 2);
    fixture_free(&fx);
}

/* A tile in sight that has not come counts as ground not drawn; where all have come it does not. */
static void a_tile_that_has_not_come_is_an_error(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 7, 3, 3, fixture_flat);
    fx.info.height_min = fx.info.height_max = fixture_flat(0, 0);
    fixture_tree(&fx, 400, 64);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    ff_view view = fixture_view(1900, 100, 400, 0, -20);
    ff_tree_select(fx.tree, &view, &quality);
    uint32_t bare = estimate(&fx);
    assert_true(bare > 100 * 256);                 /* none at all is here */
    fixture_deliver(&fx, ff_key_make(1, 0, 0), 0); /* the nearest one */
    ff_tree_select(fx.tree, &view, &quality);
    uint32_t lacking = estimate(&fx);
    assert_true(lacking > 256 && lacking < bare);
    for (uint32_t tile = 0; tile < 9; tile++) fixture_deliver(&fx, ff_key_make(tile, 0, 0), 0);
    ff_tree_select(fx.tree, &view, &quality);
    assert_int_equal(estimate(&fx), 0);
    fixture_free(&fx);
}

/* The picture's size is all it can be wrong by, above and below the drawn ground. */
static void coarse_ground_near_the_eye_has_an_end(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 7, 3, 2, fixture_cliffs);
    fixture_tree(&fx, 400, 64);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.depth_max = 1;
    static const int32_t focal_q8[] = { 1, 256, 208 * 256, 140000 * 256, INT32_MAX };
    const ff_beyond beyond = { .face_size = 1,
                               .position_wu = { INT32_MAX, INT32_MIN, 0 },
                               .back_wu = INT32_MAX };
    for (int32_t z_m = -100; z_m <= 70000; z_m += 10000)
        for (unsigned i = 0; i < sizeof focal_q8 / sizeof *focal_q8; i++)
            for (int32_t pitch = -90; pitch <= 90; pitch += 45) {
                ff_view view = fixture_view(1900, 600, z_m, 0, pitch);
                view.camera.focal_q8 = focal_q8[i];
                fixture_settle(&fx, &view, &quality, 100);
                assert_true(estimate(&fx) <= 256 * 440);
                assert_true(ff_estimate_p95_q8(fx.tree, &beyond) <= 256 * 440);
            }
    fixture_free(&fx);
}

static void it_does_not_depend_on_roll(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view_above(&fx, 1900, 600, 100, 20, -20);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    view.camera.width = view.camera.height = 320;
    quality.error_px_q8 = 16 * 256;
    fixture_settle(&fx, &view, &quality, 200);
    double level = estimate(&fx);
    for (int32_t roll = 8192; roll < 65536; roll += 8192) {
        view.camera.roll = roll;
        fixture_settle(&fx, &view, &quality, 200);
        assert_true(about(estimate(&fx), level, 1.5));
    }
    fixture_free(&fx);
}

/* High over ground that is not drawn: a panorama taken here is off by its texels alone, one taken
 * elsewhere by its parallax; without any the error is the picture's size. */
static void beyond_the_ground_a_panorama_counts(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view(1900, 0, 3000, 0, -50);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    ff_beyond beyond = { .face_size = 256, .back_wu = 100000 * M };
    quality.view_wu = 100 * M;
    fixture_settle(&fx, &view, &quality, 100);
    assert_true(estimate(&fx) > 256 * 300);
    memcpy(beyond.position_wu, view.camera.pos_wu, sizeof beyond.position_wu);
    double here = ff_estimate_p95_q8(fx.tree, &beyond) / 256.0;
    assert_true(here > 0.5 && here < 4);
    beyond.face_size = 1024;
    assert_true(about(ff_estimate_p95_q8(fx.tree, &beyond) / 256.0, here / 4, 1.2));
    beyond.position_wu[0] += 300 * M; /* a tenth of the way: 20 of 208 pixels, and more beside */
    double aside = ff_estimate_p95_q8(fx.tree, &beyond) / 256.0;
    assert_true(aside > 15 && aside < 40);
    fixture_free(&fx);
}

/* Level ground in view, a fifth of a kilometre below: what lies beyond F metres fills the rows from
 * the horizon to 200 / F below it. */
static void far_ground_is_counted_by_how_far_away_it_is(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_far_ground far;
    fixture_make(&fx, 3, 7, 3, 3, fixture_flat);
    fixture_tree(&fx, 400, 64);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    ff_view view = fixture_view_above(&fx, 1900, 100, 200, 0, 0);
    ff_estimate_far(fx.tree, 500 * M, &far);
    assert_int_equal(far.nodes, 0); /* nothing selected yet */
    fixture_settle(&fx, &view, &quality, 100);
    ff_estimate_far(fx.tree, 500 * M, &far);
    const double focal = view.camera.focal_q8 / 256.0, end = 3840 - 100;
    for (unsigned i = 0; i < FF_FAR_RUNGS; i++) {
        double begin = 500 * pow(2, ((double)i - FF_FAR_NEARER) / 2.0),
               rows = focal * 200 / begin - focal * 200 / end;
        assert_true(about(far.pixels[i], rows * view.camera.width, 1.25));
    }
    assert_true(far.pixels[0] > far.pixels[1] && far.pixels[1] > far.pixels[2]);
    assert_int_equal(far.error_q8, 0);
    assert_int_equal(far.skyline_q8, 0);
    assert_true(far.far_nodes > 0 && far.far_nodes < far.nodes);
    fixture_free(&fx);
}

/* Coarser ground is further off, at its skyline, too, which is where ground is highest: more than
 * in the mean. */
static void far_ground_is_as_wrong_as_it_is_coarse(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_far_ground fine, coarse;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view_above(&fx, 1900, 600, 20, 0, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    quality.error_px_q8 = 2 * 256;
    fixture_settle(&fx, &view, &quality, 200);
    ff_estimate_far(fx.tree, 500 * M, &fine);
    quality.error_px_q8 = 32 * 256;
    fixture_settle(&fx, &view, &quality, 200);
    ff_estimate_far(fx.tree, 500 * M, &coarse);
    assert_true(fine.error_q8 > 0 && fine.skyline_q8 > 0);
    assert_true(coarse.error_q8 > 2 * fine.error_q8 && coarse.skyline_q8 > 2 * fine.skyline_q8);
    assert_true(fine.error_q8 < 2 * 256 * 2 && coarse.error_q8 < 32 * 256 * 2);
    fixture_free(&fx);
}

/* A front that all ground lies before, though it reaches beyond a nearer one. */
static void ground_before_the_front_is_not_wrong(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_far_ground far;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view_above(&fx, 1900, 600, 20, 0, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    quality.error_px_q8 = 32 * 256;
    fixture_settle(&fx, &view, &quality, 200);
    ff_estimate_far(fx.tree, 3400 * M, &far);
    assert_true(far.pixels[0] > 0);
    assert_int_equal(far.pixels[FF_FAR_NEARER], 0);
    assert_int_equal(far.error_q8, 0);
    assert_int_equal(far.skyline_q8, 0);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(logarithms_are_right_at_powers_and_straight_between),
        cmocka_unit_test(a_twentieth_of_the_pixels_passes_the_percentile),
        cmocka_unit_test(bounds_count_for_a_part_of_them),
        cmocka_unit_test(exact_ground_has_no_error),
        cmocka_unit_test(finer_ground_has_less_error),
        cmocka_unit_test(a_tile_that_has_not_come_is_an_error),
        cmocka_unit_test(coarse_ground_near_the_eye_has_an_end),
        cmocka_unit_test(it_does_not_depend_on_roll),
        cmocka_unit_test(beyond_the_ground_a_panorama_counts),
        cmocka_unit_test(far_ground_is_counted_by_how_far_away_it_is),
        cmocka_unit_test(far_ground_is_as_wrong_as_it_is_coarse),
        cmocka_unit_test(ground_before_the_front_is_not_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
