/* Hybrid's refresh rules against the figures of the paper and at their limits; cube faces against a
 * fine grid of rays. */
#include "../../client/panorama/ff_panorama_rules.h"
#include "../../protocol/message/ff_message.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>

#include <cmocka.h>

#define METRE 256
#define Z_WU  (7500 * METRE)

static void figures_of_the_paper(void **state)
{
    (void)state;
    int64_t w = 120 * 256; /* 90 degree faces: d = w */
    /* 5 % of the half-width, 5 % of the full width, 2 pixels of a 256 pixel face */
    assert_int_equal(ff_panorama_sideways_max(w / 20, Z_WU, w) / METRE, 375);
    assert_int_equal(ff_panorama_forwards_max(w / 20, Z_WU, w) / METRE, 357);
    assert_int_equal(ff_panorama_sideways_max(w / 10, Z_WU, w) / METRE, 750);
    assert_in_range(ff_panorama_forwards_max(w / 10, Z_WU, w) / METRE, 681, 682);
    assert_int_equal(ff_panorama_sideways_max(2 * 256, Z_WU, 128 * 256) / METRE, 117);
    assert_int_equal(ff_panorama_forwards_max(2 * 256, Z_WU, 128 * 256) / METRE, 115);
}

static void limits_do_not_blow_up(void **state)
{
    (void)state;
    assert_int_equal(ff_panorama_forwards_max(0, Z_WU, 0), 0);
    assert_int_equal(ff_panorama_forwards_max(0, Z_WU, 1000), 0);
    /* w -> 0: only z limits the way forwards */
    assert_int_equal(ff_panorama_forwards_max(1, Z_WU, 0), Z_WU);
    assert_int_equal(ff_panorama_sideways_max(0, Z_WU, 1), 0);
    assert_true(ff_panorama_sideways_max(INT32_MAX, INT32_MAX, 1) > 0);
    assert_true(ff_panorama_forwards_max(INT32_MAX, INT32_MAX, 1) <= INT32_MAX);
}

static c3d_camera camera_at(int32_t x_m, int32_t y_m, int32_t z_m, int32_t yaw, int32_t pitch)
{
    c3d_camera camera = { .pos_wu = { x_m * METRE, y_m * METRE, z_m * METRE },
                          .yaw = yaw,
                          .pitch = pitch,
                          .width = 240,
                          .height = 240,
                          .focal_q8 = 120 * 256 };
    return camera;
}

static const int32_t level_ground[2] = { -100 * METRE, 100 * METRE },
                     any_ground[2] = { INT32_MIN, INT32_MAX };

static int outdated_over(const c3d_camera *camera, const int32_t taken_wu[3],
                         const int32_t ground_wu[2], int32_t error_px_q8)
{
    ff_panorama_sight sight;
    ff_panorama_sight_terrain(&sight, taken_wu, ground_wu, Z_WU);
    return ff_panorama_outdated(camera, taken_wu, &sight, Z_WU, error_px_q8);
}

static int outdated(int32_t x_m, int32_t y_m, int32_t z_m, int32_t yaw)
{
    static const int32_t origin[3] = { 0, 0, 0 };
    c3d_camera camera = camera_at(x_m, y_m, z_m, yaw, 0);
    return outdated_over(&camera, origin, level_ground, 120 * 256 / 20);
}

static void motion_in_any_direction(void **state)
{
    (void)state;
    assert_false(outdated(0, 0, 0, 0));
    /* sideways, looking north: Hybrid allows 375 m, and our whole patches cost some of it */
    assert_false(outdated(320, 0, 0, 0));
    assert_true(outdated(376, 0, 0, 0));
    assert_true(outdated(-376, 0, 0, 0));
    assert_false(outdated(0, 300, 0, 0)); /* forwards: 357 m */
    assert_true(outdated(0, 358, 0, 0));
    assert_false(outdated(0, -300, 0, 0));
    assert_true(outdated(0, -380, 0, 0));
    assert_false(outdated(0, 0, 320, 0)); /* upwards */
    assert_true(outdated(0, 0, 376, 0));
    assert_false(outdated(300, 0, 0, 16384)); /* looking east, the same motion is forwards */
    assert_true(outdated(366, 0, 0, 16384));
    assert_true(outdated(300, 300, 0, 0)); /* each motion alone is allowed, their sum is not */
    assert_true(outdated(7500, 0, 0, 0));
    assert_true(outdated(1000000, 0, 0, 0));
}

static void no_error_allowed_means_no_motion_allowed(void **state)
{
    (void)state;
    static const int32_t origin[3] = { 0, 0, 0 };
    c3d_camera camera = camera_at(0, 0, 0, 0, 0);
    assert_false(outdated_over(&camera, origin, any_ground, 0));
    camera.pos_wu[0] = 1;
    assert_true(outdated_over(&camera, origin, any_ground, 0));
    camera.pos_wu[0] = INT32_MAX; /* the far end of the world */
    int32_t far_west[3] = { INT32_MIN, 0, 0 };
    assert_true(outdated_over(&camera, far_west, any_ground, INT32_MAX));
}

/* What the faces show decides: high ground in the window's corners that no face shows does not
 * count. */
static void only_what_is_shown_counts(void **state)
{
    (void)state;
    const int32_t origin[3] = { 0, 0, 0 }, mountains[2] = { -100 * METRE, 4000 * METRE };
    ff_panorama_sight sight;
    c3d_camera camera = camera_at(0, 300, 0, 0, 0);
    assert_true(outdated_over(&camera, origin, mountains, 120 * 256 / 20));
    for (unsigned face = 0; face < FF_FACE_COUNT; face++)
        ff_panorama_sight_face(&sight, face, 256, 0, 0, Z_WU);
    assert_false(ff_panorama_outdated(&camera, origin, &sight, Z_WU, 256));
    ff_panorama_sight_face(&sight, FF_FACE_SOUTH, 256, 0, 256, Z_WU); /* behind the viewer */
    assert_false(ff_panorama_outdated(&camera, origin, &sight, Z_WU, 256));
    ff_panorama_sight_face(&sight, FF_FACE_NORTH, 256, 126, 5, Z_WU);
    assert_true(sight.high_wu[FF_FACE_NORTH] == Z_WU * 3 / 128 &&
                sight.low_wu[FF_FACE_NORTH] == -Z_WU * 3 / 128);
    assert_false(ff_panorama_outdated(&camera, origin, &sight, Z_WU, 120 * 256 / 20));
    assert_true(ff_panorama_outdated(&camera, origin, &sight, Z_WU, 4 * 256));
    ff_panorama_sight_face(&sight, FF_FACE_NORTH, 256, 0, 256, Z_WU);
    assert_true(sight.high_wu[FF_FACE_NORTH] == Z_WU && sight.low_wu[FF_FACE_NORTH] == -Z_WU);
    assert_true(ff_panorama_outdated(&camera, origin, &sight, Z_WU, 120 * 256 / 20));
}

/* Faces hit by a fine grid of rays over the picture. */
static unsigned faces_by_rays(const c3d_camera *camera)
{
    c3d_rotation r;
    unsigned faces = 0;
    c3d_rotation_from_camera(camera, &r);
    for (int j = 0; j <= 64; j++)
        for (int i = 0; i <= 64; i++) {
            double eye[3] = { (i / 64.0 - 0.5) * camera->width, (j / 64.0 - 0.5) * camera->height,
                              camera->focal_q8 / 256.0 },
                   d[3];
            for (int a = 0; a < 3; a++)
                d[a] = eye[0] * r.m[0][a] + eye[1] * r.m[1][a] + eye[2] * r.m[2][a];
            double ax = fabs(d[0]), ay = fabs(d[1]), az = fabs(d[2]);
            unsigned face = az > ax && az > ay ? (d[2] > 0 ? FF_FACE_UP : FF_FACE_DOWN)
                            : ax > ay          ? (d[0] > 0 ? FF_FACE_EAST : FF_FACE_WEST)
                            : d[1] > 0         ? FF_FACE_NORTH
                                               : FF_FACE_SOUTH;
            faces |= 1u << face;
        }
    return faces;
}

static unsigned bits(unsigned set)
{
    unsigned count = 0;
    for (; set; set &= set - 1) count++;
    return count;
}

static void faces_in_view_miss_none(void **state)
{
    (void)state;
    unsigned too_many = 0, all = 0;
    for (int32_t pitch = -16384; pitch <= 16384; pitch += 2048)
        for (int32_t yaw = 0; yaw < 65536; yaw += 1500)
            for (int32_t focal = 12; focal <= 1200; focal *= 10) {
                c3d_camera camera = camera_at(0, 0, 0, yaw, pitch);
                camera.height = 320;
                camera.roll = yaw * 3;
                camera.focal_q8 = focal * 256;
                unsigned faces = ff_panorama_faces_in_view(&camera), seen = faces_by_rays(&camera);
                assert_int_equal(seen & ~faces, 0);
                too_many += bits(faces & ~seen);
                all += bits(faces);
            }
    assert_true(too_many * 10 < all); /* conservative, not silly */
}

static void straight_ahead_is_one_face(void **state)
{
    (void)state;
    static const struct {
        int32_t yaw, pitch;
        unsigned face;
    } look[] = { { 0, 0, FF_FACE_NORTH },     { 16384, 0, FF_FACE_EAST },
                 { 32768, 0, FF_FACE_SOUTH }, { 49152, 0, FF_FACE_WEST },
                 { 0, 16384, FF_FACE_UP },    { 0, -16384, FF_FACE_DOWN } };
    for (unsigned i = 0; i < sizeof look / sizeof *look; i++) {
        c3d_camera camera = camera_at(0, 0, 0, look[i].yaw, look[i].pitch);
        camera.focal_q8 = 400 * 256;
        assert_int_equal(ff_panorama_faces_in_view(&camera), 1u << look[i].face);
    }
}

static void left_behind_beyond_half(void **state)
{
    (void)state;
    const int32_t taken[3] = { 5, -7, INT32_MIN };
    for (int axis = 0; axis < 3; axis++) {
        int32_t viewer[3] = { 5, -7, INT32_MIN };
        viewer[axis] += Z_WU / 2;
        assert_false(ff_panorama_left_behind(viewer, taken, Z_WU));
        viewer[axis]++;
        assert_true(ff_panorama_left_behind(viewer, taken, Z_WU));
        assert_true(ff_panorama_left_behind(taken, viewer, Z_WU));
    }
    const int32_t far_up[3] = { 5, -7, INT32_MAX };
    assert_true(ff_panorama_left_behind(far_up, taken, INT32_MAX));
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(figures_of_the_paper),
                                        cmocka_unit_test(limits_do_not_blow_up),
                                        cmocka_unit_test(motion_in_any_direction),
                                        cmocka_unit_test(no_error_allowed_means_no_motion_allowed),
                                        cmocka_unit_test(only_what_is_shown_counts),
                                        cmocka_unit_test(faces_in_view_miss_none),
                                        cmocka_unit_test(straight_ahead_is_one_face),
                                        cmocka_unit_test(left_behind_beyond_half) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
