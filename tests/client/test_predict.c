/* Motion prediction: right on steady paths, calm on noise, irregular times, pauses and jumps. */
#include "../../client/ahead/ff_motion.h"
#include "../../client/ahead/ff_turn.h"
#include "../../platform/sys.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define METRE 256

static void straight_line_is_continued(void **state)
{
    (void)state;
    ff_motion motion;
    ff_motion_reset(&motion);
    int32_t p[3] = { 0, 0, 100 * METRE }, at[3];
    for (int i = 0; i <= 60; i++) { /* 40 m/s east, 30 frames a second */
        p[0] = 40 * METRE * i / 30;
        ff_motion_feed(&motion, i * 33333, p);
    }
    assert_true(ff_motion_predict(&motion, 5000000, at));
    assert_in_range(at[0], p[0] + 197 * METRE, p[0] + 203 * METRE);
    assert_int_equal(at[1], 0);
    assert_int_equal(at[2], p[2]);
    assert_in_range(ff_motion_speed_wu_s(&motion), 39 * METRE, 41 * METRE);
}

static void acceleration_bends_the_way_by_half_at_most(void **state)
{
    (void)state;
    ff_motion motion;
    ff_motion_reset(&motion);
    int32_t p[3] = { 0, 0, 0 }, at[3];
    for (int i = 0; i <= 90; i++) { /* 20 m/s^2 */
        p[1] = (int32_t)((int64_t)10 * METRE * i * i / 900);
        ff_motion_feed(&motion, i * 33333, p);
    }
    assert_true(ff_motion_predict(&motion, 1000000, at));
    assert_in_range(at[1] - p[1], 50 * METRE, 82 * METRE); /* 60 m/s now: 70 m is right */
    assert_true(ff_motion_predict(&motion, 20000000, at));
    assert_true(at[1] - p[1] < 20 * 60 * METRE * 3 / 2 + METRE);
}

static void standing_still_predicts_nothing(void **state)
{
    (void)state;
    ff_motion motion;
    ff_motion_reset(&motion);
    int32_t p[3] = { 5, 6, 7 }, at[3];
    assert_false(ff_motion_predict(&motion, 1000000, at));
    for (int i = 0; i < 100; i++) ff_motion_feed(&motion, i * 20000, p);
    assert_false(ff_motion_predict(&motion, 5000000, at));
}

static int32_t noise(sys_random *random, int32_t reach)
{
    return (int32_t)sys_random_below(random, (uint32_t)(2 * reach + 1)) - reach;
}

/* 5 m of noise on every fix of a 40 m/s flight, frames of 0 to 100 ms. */
static void noise_keeps_it_calm(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 7, 1);
    ff_motion motion;
    ff_motion_reset(&motion);
    int64_t now_us = 0;
    for (int i = 0; i < 3000; i++) {
        now_us += sys_random_below(&random, 4) ? sys_random_below(&random, 100000) : 0;
        int32_t true_x = (int32_t)(now_us * 40 * METRE / 1000000), at[3];
        int32_t p[3] = { true_x + noise(&random, 5 * METRE), noise(&random, 5 * METRE),
                         noise(&random, 5 * METRE) };
        ff_motion_feed(&motion, now_us, p);
        if (now_us < 2000000 || !ff_motion_predict(&motion, 5000000, at)) continue;
        assert_in_range(at[0], true_x + 40 * METRE, true_x + 400 * METRE); /* 200 m is right */
        assert_true(abs(at[1]) < 200 * METRE);
        assert_true(abs(at[2]) < 200 * METRE);
    }
}

static void jumps_and_pauses_start_anew(void **state)
{
    (void)state;
    ff_motion motion;
    ff_motion_reset(&motion);
    int32_t p[3] = { 0, 0, 0 }, at[3];
    for (int i = 0; i <= 60; i++) {
        p[0] = 40 * METRE * i / 30;
        ff_motion_feed(&motion, i * 33333, p);
    }
    p[0] += 1000000 * METRE;
    ff_motion_feed(&motion, 61 * 33333, p);
    assert_false(ff_motion_predict(&motion, 5000000, at));
    for (int i = 62; i <= 120; i++) {
        p[0] += 40 * METRE / 30;
        ff_motion_feed(&motion, i * 33333, p);
    }
    assert_true(ff_motion_predict(&motion, 5000000, at));
    assert_in_range(at[0] - p[0], 190 * METRE, 210 * METRE);
    ff_motion_feed(&motion, 120 * 33333 + 5000000, p); /* a pause */
    assert_false(ff_motion_predict(&motion, 5000000, at));
}

static void extremes_do_not_overflow(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 3, 3);
    ff_motion motion;
    ff_motion_reset(&motion);
    int64_t now_us = -5000000;
    for (int i = 0; i < 20000; i++) {
        int32_t p[3], at[3];
        for (int axis = 0; axis < 3; axis++)
            p[axis] = i % 97 ? (int32_t)(i % 1000 * 40000 + noise(&random, 100000))
                             : (int32_t)sys_random_u32(&random);
        ff_motion_feed(&motion, now_us, p);
        (void)ff_motion_predict(&motion, INT64_MAX, at);
        now_us += i % 5 ? sys_random_below(&random, 50000) : 0;
    }
    int32_t west[3] = { INT32_MIN, 0, 0 }, at[3];
    for (int i = 0; i < 100; i++) { /* beyond the world's end: clamped */
        west[0] = INT32_MIN + (100 - i) * METRE * 10;
        ff_motion_feed(&motion, now_us + i * 100000, west);
    }
    if (ff_motion_predict(&motion, 30000000, at)) assert_int_equal(at[0], INT32_MIN);
}

/* Yaw at a steady rate, through north; the prediction is cut into steps of at most 45 degrees, half
 * a turn in all. */
static void turning_is_continued(void **state)
{
    (void)state;
    ff_turn turn;
    int32_t yaw, pitch, start = 65536 - 400;
    ff_turn_reset(&turn);
    assert_int_equal(ff_turn_predict(&turn, 3000000, &yaw, &pitch), 0);
    for (int i = 0; i < 60; i++) ff_turn_feed(&turn, i * 33333, start + i * 36, -1000 - i * 4);
    assert_int_equal(ff_turn_predict(&turn, 3000000, &yaw, &pitch), 1);
    assert_in_range(yaw, 3 * 1080 - 2, 3 * 1080 + 2); /* 36 in 33 ms */
    assert_in_range(-pitch, 3 * 120 - 2, 3 * 120 + 2);
    assert_int_equal(ff_turn_predict(&turn, 10000000, &yaw, &pitch), 2);
    assert_int_equal(ff_turn_predict(&turn, INT64_MAX, &yaw, &pitch), FF_TURN_VIEWS_MAX);
    assert_in_range(yaw, 32000, 32768);
    for (int i = 60; i < 90; i++) /* the viewer stops turning */
        ff_turn_feed(&turn, i * 33333, start, -1000);
    assert_int_equal(ff_turn_predict(&turn, 3000000, &yaw, &pitch), 0);
    for (int i = 90; i < 120; i++) ff_turn_feed(&turn, i * 33333, start - i * 36, 0);
    assert_int_not_equal(ff_turn_predict(&turn, 3000000, &yaw, &pitch), 0);
    assert_true(yaw < 0);
    ff_turn_feed(&turn, 120 * 33333 + 5000000, start, 0); /* a pause */
    assert_int_equal(ff_turn_predict(&turn, 3000000, &yaw, &pitch), 0);
}

/* Any angles, jumping by any amount: nothing overflows, and the prediction stays within its bounds.
 */
static void wild_turning_stays_bounded(void **state)
{
    (void)state;
    ff_turn turn;
    int32_t yaw, pitch;
    ff_turn_reset(&turn);
    for (int i = 0; i < 200000; i++)
        ff_turn_feed(&turn, i / 100000, i & 1 ? INT32_MAX : INT32_MIN, (i & 3) * 32768);
    ff_turn_feed(&turn, 250000, INT32_MIN, INT32_MAX);
    assert_in_range(ff_turn_predict(&turn, INT64_MAX, &yaw, &pitch), 0, FF_TURN_VIEWS_MAX);
    assert_in_range(yaw + 32768, 0, 65536);
    assert_in_range(pitch + 16384, 0, 32768);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(straight_line_is_continued),
                                        cmocka_unit_test(
                                            acceleration_bends_the_way_by_half_at_most),
                                        cmocka_unit_test(standing_still_predicts_nothing),
                                        cmocka_unit_test(noise_keeps_it_calm),
                                        cmocka_unit_test(jumps_and_pauses_start_anew),
                                        cmocka_unit_test(extremes_do_not_overflow),
                                        cmocka_unit_test(turning_is_continued),
                                        cmocka_unit_test(wild_turning_stays_bounded) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
