/* FF_PANORAMA_AUTO: the rule by its numbers, and a client that follows it. */
#include "../rig/client_fixture.h"
#include "../../client/panorama/ff_panorama_auto.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define METRE FF_WU_PER_METRE

/* 240 pixels at 60 degrees, faces of 256 texels: half a texel is 0.81 pixels. Ground of 8 pixels
 * leaves 2 - 0.81 for motion: 42.9 m at 7.5 km. */
static const ff_panorama_case usual = { .focal_q8 = 208 * 256,
                                        .half_width_q8 = 120 * 256,
                                        .asked_px_q8 = 2 * 256,
                                        .face_size = 256,
                                        .front_wu = 7500 * METRE,
                                        .ground_px_q8 = 8 * 256,
                                        .triangles = 5000,
                                        .far_triangles = 2500,
                                        .link_bytes_s = 5000,
                                        .set_bytes = 3000 };

static void the_rule_keeps_its_numbers(void **state)
{
    (void)state;
    ff_panorama_case c = usual;
    assert_int_equal(ff_panorama_worth_q8(&c, 0), 2 * 256 - 208);
    /* 16 sets of 3000 bytes for each 42.9 m, or 8 once drawn: 4.46 m/s, 8.93 m/s */
    c.speed_wu_s = (int64_t)(4.4 * METRE);
    assert_true(ff_panorama_worth_q8(&c, 0));
    c.speed_wu_s = (int64_t)(4.5 * METRE);
    assert_false(ff_panorama_worth_q8(&c, 0));
    assert_true(ff_panorama_worth_q8(&c, 1));
    c.speed_wu_s = (int64_t)(9 * METRE);
    assert_false(ff_panorama_worth_q8(&c, 1));
    c = usual;
    c.ground_px_q8 = 832; /* a quarter of it is half a texel */
    assert_false(ff_panorama_worth_q8(&c, 0));
    c.ground_px_q8 = 836;
    assert_int_equal(ff_panorama_worth_q8(&c, 0), 1);
    c.ground_px_q8 = 2 * 4 * 24 * 256; /* twice as coarse as what it is taken for */
    assert_int_equal(ff_panorama_worth_q8(&c, 0), 24 * 256 - 208);
    c = usual;
    c.far_triangles = 1666;
    assert_false(ff_panorama_worth_q8(&c, 0));
    c = usual;
    c.link_bytes_s = 0;
    assert_false(ff_panorama_worth_q8(&c, 0));
    c = usual;
    c.face_size = 0;
    assert_false(ff_panorama_worth_q8(&c, 0));
}

/* Extreme numbers: no overflow, and ground where nothing is known to be better. */
static void the_rule_bears_any_numbers(void **state)
{
    (void)state;
    ff_panorama_case c = { .focal_q8 = INT32_MAX,
                           .face_size = 1,
                           .front_wu = 1,
                           .ground_px_q8 = INT32_MAX,
                           .triangles = UINT32_MAX,
                           .far_triangles = UINT32_MAX,
                           .speed_wu_s = INT64_C(10000) * METRE * 1000,
                           .link_bytes_s = UINT32_MAX,
                           .set_bytes = 6 * 65536 };
    assert_false(ff_panorama_worth_q8(&c, 0));
    c.focal_q8 = 1;
    c.front_wu = INT32_MAX;
    (void)ff_panorama_worth_q8(&c, 1);
}

static void limit_triangles(client_rig *rig, uint32_t triangles)
{
    rig->desc.quality = (ff_quality){ .measure = FF_MEASURE_PIXELS,
                                      .error_px_q8 = 256,
                                      .triangles_max = triangles };
    if (rig->client) ff_client_set_quality(rig->client, &rig->desc.quality);
}

static void run(client_rig *rig, unsigned frames, int32_t step_wu)
{
    for (unsigned i = 0; i < frames; i++) {
        rig->camera.pos_wu[1] += step_wu;
        rig_step(rig, 50000);
    }
}

/* All ground in view is here, and fine; no face was asked for. */
static void open_rig(client_rig *rig)
{
    rig_open(rig, 0);
    rig->desc.panorama.enabled = FF_PANORAMA_AUTO;
    rig->desc.panorama.back_plane_wu = 300 * METRE;
    limit_triangles(rig, 1000000);
    rig_client(rig, 4 * 1048576);
    run(rig, 300, 0);
    assert_int_equal(rig->asked[FF_KIND_FACE], 0);
}

/* Where the limit makes ground coarse and the viewer is at rest, far ground comes as a panorama;
 * who sets off gets ground again. */
static void a_client_follows_it(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig);
    limit_triangles(&rig, FF_TRIANGLES_MIN);
    run(&rig, 300, 0);
    assert_true(rig_stats(&rig).panorama_faces > 0);
    assert_true(rig_stats(&rig).back_plane_wu > 0);
    run(&rig, 20, 5 * METRE); /* 100 m/s */
    assert_int_equal(rig_stats(&rig).back_plane_wu, 0);
    uint32_t faces = rig.asked[FF_KIND_FACE];
    run(&rig, 100, 5 * METRE);
    assert_int_equal(rig.asked[FF_KIND_FACE], faces);
    rig_close(&rig);
}

/* The viewer turns to where no face has come: its own ground is there. */
static void ground_stands_in_for_faces_that_have_not_come(void **state)
{
    (void)state;
    client_rig rig;
    open_rig(&rig);
    limit_triangles(&rig, FF_TRIANGLES_MIN);
    for (unsigned i = 0; i < 300 && !rig_stats(&rig).back_plane_wu; i++) run(&rig, 1, 0);
    assert_true(rig_stats(&rig).back_plane_wu > 0);
    rig.no_faces = 1; /* before those behind have come */
    rig.camera.yaw += 32768;
    run(&rig, 1, 0);
    assert_int_equal(rig_stats(&rig).back_plane_wu, 0);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_rule_keeps_its_numbers),
        cmocka_unit_test(the_rule_bears_any_numbers),
        cmocka_unit_test(a_client_follows_it),
        cmocka_unit_test(ground_stands_in_for_faces_that_have_not_come),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
