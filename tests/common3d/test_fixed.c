/* Fixed-point maths against libm over dense sweeps, and at the ends of the ranges the header
 * states. */
#include "../../common3d/c3d.h"
#include "../../common3d/c3d_backend.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TURN (2.0 * 3.14159265358979323846)
#define ONE  1073741824.0

static void sine_is_within_two_units(void **state)
{
    (void)state;
    double worst = 0;
    for (int32_t angle = -70000; angle <= 140000; angle++) {
        double exact = angle * TURN / 65536;
        worst = fmax(worst, fabs(c3d_sin_q30(angle) - sin(exact) * ONE));
        worst = fmax(worst, fabs(c3d_cos_q30(angle) - cos(exact) * ONE));
    }
    assert_true(worst <= 2.0);
}

static void sine_of_fine_angles(void **state)
{
    (void)state;
    double worst = 0;
    for (uint64_t angle = 0; angle < UINT64_C(1) << 32; angle += 9973)
        worst = fmax(worst, fabs(c3d_sin_turn32_q30((uint32_t)angle) -
                                 sin((double)angle * TURN / 4294967296.0) * ONE));
    assert_true(worst <= 2.0);
}

static void sine_is_exact_on_the_axes(void **state)
{
    (void)state;
    for (int turn = -3; turn <= 3; turn++) {
        assert_int_equal(c3d_sin_q30(turn * 65536), 0);
        assert_int_equal(c3d_sin_q30(turn * 65536 + 16384), C3D_ONE_Q30);
        assert_int_equal(c3d_sin_q30(turn * 65536 + 32768), 0);
        assert_int_equal(c3d_sin_q30(turn * 65536 + 49152), -C3D_ONE_Q30);
        assert_int_equal(c3d_cos_q30(turn * 65536), C3D_ONE_Q30);
    }
    assert_int_equal(c3d_sin_q30(INT32_MAX), c3d_sin_q30(-1));
    assert_int_equal(c3d_sin_q30(INT32_MIN), 0);
}

static void square_root_is_the_floor(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 1, 1);
    for (uint32_t i = 0; i < 200000; i++) {
        uint64_t value = ((uint64_t)sys_random_u32(&random) << 32 | sys_random_u32(&random)) >>
                         (i % 64);
        uint64_t root = c3d_isqrt64(value);
        assert_true(root * root <= value);
        assert_true(root == UINT32_MAX || (root + 1) * (root + 1) > value);
    }
    for (uint64_t root = 0; root < 3000; root++) assert_int_equal(c3d_isqrt64(root * root), root);
    assert_int_equal(c3d_isqrt64(UINT64_MAX), UINT32_MAX);
}

/* A number of 128 bits, for machines without such a type. */
typedef struct wide {
    uint64_t high, low;
} wide;

static wide product(uint64_t a, uint64_t b)
{
    uint64_t a0 = a & UINT32_MAX, a1 = a >> 32, b0 = b & UINT32_MAX, b1 = b >> 32;
    uint64_t middle = a1 * b0 + (a0 * b0 >> 32), carried = a0 * b1 + (middle & UINT32_MAX);
    return (wide){ a1 * b1 + (middle >> 32) + (carried >> 32), a * b };
}

static int is_less(wide a, wide b)
{
    return a.high < b.high || (a.high == b.high && a.low < b.low);
}

static uint64_t magnitude(int64_t value)
{
    return value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
}

/* a * b / c, rounded towards zero and held within 64 bits. */
static int is_quotient(int64_t quotient, int64_t a, int64_t b, int64_t c)
{
    wide whole = product(magnitude(a), magnitude(b));
    uint64_t divisor = magnitude(c), size = magnitude(quotient);
    int negative = ((a < 0) ^ (b < 0) ^ (c < 0)) && (whole.high || whole.low);
    uint64_t limit = (uint64_t)INT64_MAX + (unsigned)negative;
    if (!is_less(whole, product(limit + 1, divisor)))
        return quotient == (negative ? INT64_MIN : INT64_MAX);
    return (size == 0 || (quotient < 0) == negative) && !is_less(whole, product(size, divisor)) &&
           is_less(whole, product(size + 1, divisor));
}

/* Operands of any size, and quotients at a whole number or just below it. */
static void division_is_the_floor(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 3, 1);
    for (uint32_t i = 0; i < 400000; i++) {
        uint64_t a = ((uint64_t)sys_random_u32(&random) << 32 | sys_random_u32(&random)) >>
                     (i % 61);
        uint64_t b = ((uint64_t)sys_random_u32(&random) << 32 | sys_random_u32(&random)) >>
                     (i % 64),
                 by_one = i % 3;
        if (i & 1) a = (b >> 32 ? b : b * sys_random_u32(&random)) + by_one - 1;
        uint64_t exact = b ? a / b : UINT64_MAX;
        assert_int_equal(c3d_divide_saturated(a, b), exact > UINT32_MAX ? UINT32_MAX : exact);
    }
    assert_int_equal(c3d_divide_saturated(0, 0), UINT32_MAX);
    assert_int_equal(c3d_divide_saturated((UINT64_C(1) << 63) - 1, UINT64_C(1) << 31), UINT32_MAX);
}

static void muldiv_equals_128_bits(void **state)
{
    (void)state;
    static const int64_t edge[] = { 0,
                                    1,
                                    -1,
                                    2,
                                    -3,
                                    65535,
                                    INT32_MAX,
                                    INT32_MIN,
                                    INT64_MAX,
                                    INT64_MIN,
                                    INT64_MIN + 1,
                                    INT64_C(1) << 32,
                                    -(INT64_C(1) << 40),
                                    INT64_C(1) << 62 };
    const size_t edges = sizeof edge / sizeof *edge;
    for (size_t a = 0; a < edges; a++)
        for (size_t b = 0; b < edges; b++)
            for (size_t c = 1; c < edges; c++)
                assert_true(is_quotient(c3d_muldiv64(edge[a], edge[b], edge[c]), edge[a], edge[b],
                                        edge[c]));
    sys_random random;
    sys_random_seed(&random, 2, 1);
    for (uint32_t i = 0; i < 200000; i++) {
        int64_t word[3];
        for (int j = 0; j < 3; j++) {
            uint64_t bits = (uint64_t)sys_random_u32(&random) << 32 | sys_random_u32(&random);
            word[j] = (int64_t)bits >> sys_random_below(&random, 63);
        }
        if (word[2] == 0) word[2] = 1;
        assert_true(
            is_quotient(c3d_muldiv64(word[0], word[1], word[2]), word[0], word[1], word[2]));
    }
}

static void length_is_near(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 3, 1);
    for (uint32_t i = 0; i < 100000; i++) {
        int64_t v[3];
        for (int j = 0; j < 3; j++) {
            int64_t bits = (int64_t)((uint64_t)sys_random_u32(&random) << 9 ^
                                     sys_random_u32(&random)) &
                           0xFFFFFFFFFF;
            v[j] = (bits >> sys_random_below(&random, 40)) * (sys_random_u32(&random) & 1 ? 1 : -1);
        }
        double exact = sqrt((double)v[0] * (double)v[0] + (double)v[1] * (double)v[1] +
                            (double)v[2] * (double)v[2]);
        double got = (double)c3d_length64(v[0], v[1], v[2]);
        assert_true(fabs(got - exact) <= 1.0 + exact * 4e-9);
    }
    assert_int_equal(c3d_length64(3, -4, 12), 13);
    assert_int_equal(c3d_length64(0, 0, 0), 0);
    assert_int_equal(c3d_length64(INT64_MIN, INT64_MIN, INT64_MAX), INT64_C(1) << 62);
}

static void focal_distance_of_all_fields_of_view(void **state)
{
    (void)state;
    for (int32_t fov = 18; fov <= 30948; fov++) {
        double exact = 320.0 * 256 / tan(fov * TURN / 65536 / 2);
        assert_true(fabs(c3d_focal_q8(fov, 640) - exact) <= 1.0 + exact * 4e-6);
    }
    assert_int_equal(c3d_focal_q8(16384, 240), 120 * 256); /* 90 degrees */
    assert_int_equal(c3d_focal_q8(0, 240), c3d_focal_q8(18, 240));
    assert_int_equal(c3d_focal_q8(32768, 240), c3d_focal_q8(30948, 240));
    assert_int_equal(c3d_focal_q8(32768, 1), 256);
    assert_true(c3d_focal_q8(18, 4096) > 0);
}

static void expect_row(const int32_t row[3], int x, int y, int z)
{
    assert_int_equal(row[0], x * C3D_ONE_Q30);
    assert_int_equal(row[1], y * C3D_ONE_Q30);
    assert_int_equal(row[2], z * C3D_ONE_Q30);
}

static void rotations_of_the_compass(void **state)
{
    (void)state;
    c3d_camera camera = { 0 };
    c3d_rotation rotation;
    c3d_rotation_from_camera(&camera, &rotation); /* north */
    expect_row(rotation.m[0], 1, 0, 0);
    expect_row(rotation.m[1], 0, 0, 1);
    expect_row(rotation.m[2], 0, 1, 0);
    camera.yaw = 16384; /* east */
    c3d_rotation_from_camera(&camera, &rotation);
    expect_row(rotation.m[0], 0, -1, 0);
    expect_row(rotation.m[2], 1, 0, 0);
    camera = (c3d_camera){ .pitch = 16384 }; /* zenith: the top of the picture is south */
    c3d_rotation_from_camera(&camera, &rotation);
    expect_row(rotation.m[1], 0, -1, 0);
    expect_row(rotation.m[2], 0, 0, 1);
    camera = (c3d_camera){ .roll = 16384 }; /* a quarter clockwise: the right side is down */
    c3d_rotation_from_camera(&camera, &rotation);
    expect_row(rotation.m[0], 0, 0, -1);
    expect_row(rotation.m[1], 1, 0, 0);
}

static void rotations_are_orthonormal(void **state)
{
    (void)state;
    for (int32_t step = 0; step < 65536; step += 37) {
        c3d_camera camera = { .yaw = step, .pitch = step * 5, .roll = step * 11 };
        c3d_rotation r;
        c3d_rotation_from_camera(&camera, &r);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                double dot = 0;
                for (int k = 0; k < 3; k++) dot += (double)r.m[i][k] * r.m[j][k];
                assert_true(fabs(dot / ONE / ONE - (i == j)) < 2e-8);
            }
    }
}

static void eye_space_of_far_points(void **state)
{
    (void)state;
    const int64_t limit = (INT64_C(1) << 33) - 1;
    for (int32_t step = 0; step < 65536; step += 131) {
        c3d_camera camera = { .yaw = step * 3, .pitch = step * 7, .roll = step };
        const int64_t offset[3] = { limit, -limit + step, step % 2 ? limit : -limit };
        c3d_rotation r;
        int64_t eye[3], fine[3];
        c3d_rotation_from_camera(&camera, &r);
        c3d_to_eye(&r, offset, eye);
        c3d_to_eye_q14(&r, offset, fine);
        for (int row = 0; row < 3; row++) {
            int64_t high = 0, low = 0; /* the exact sum, split at 2^16 */
            for (int i = 0; i < 3; i++) {
                int64_t rest = offset[i] & 0xFFFF;
                high += r.m[row][i] * ((offset[i] - rest) / 65536);
                low += r.m[row][i] * rest;
            }
            int64_t exact = high + (low >> 16);
            assert_true(llabs(eye[row] - (exact >> 14)) <= 1);
            assert_true(llabs(fine[row] - exact) <= 1);
        }
    }
}

static void edges_of_strips(void **state)
{
    (void)state;
    /* Two rows of one cell joined by degenerate triangles. */
    static const uint16_t strip[] = { 0, 1, 2, 3, 3, 2, 2, 3, 4, 5 };
    static const uint16_t expected[] = {
        0, 1, 1, 2, 0, 2, 2, 3, 1, 3, 2, 3, 3, 4, 2, 4, 4, 5, 3, 5
    };
    uint16_t edges[4 * sizeof strip / sizeof *strip];
    uint32_t triangles;
    uint32_t count = c3d_strip_edges(strip, sizeof strip / sizeof *strip, edges, &triangles);
    assert_int_equal(triangles, 4);
    assert_int_equal(count, sizeof expected / sizeof *expected);
    assert_memory_equal(edges, expected, sizeof expected);
    /* Most edges for the fewest indices: drawn and degenerate triangles in turn. */
    uint16_t worst[300], many[4 * 300];
    for (uint32_t seed = 0; seed < 200; seed++) {
        sys_random random;
        sys_random_seed(&random, seed, 4);
        for (int i = 0; i < 300; i++) worst[i] = (uint16_t)sys_random_below(&random, 2 + seed % 7);
        assert_true(c3d_strip_edges(worst, 300, many, &triangles) <= 4 * 300);
        assert_true(triangles <= 298);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sine_is_within_two_units),
        cmocka_unit_test(sine_of_fine_angles),
        cmocka_unit_test(sine_is_exact_on_the_axes),
        cmocka_unit_test(square_root_is_the_floor),
        cmocka_unit_test(division_is_the_floor),
        cmocka_unit_test(muldiv_equals_128_bits),
        cmocka_unit_test(length_is_near),
        cmocka_unit_test(focal_distance_of_all_fields_of_view),
        cmocka_unit_test(rotations_of_the_compass),
        cmocka_unit_test(rotations_are_orthonormal),
        cmocka_unit_test(eye_space_of_far_points),
        cmocka_unit_test(edges_of_strips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
