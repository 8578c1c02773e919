/* Sectors of far sets: places, distances, fins there and back, damaged everywhere, and the slow
 * decoder beside ours. */
#include "../../protocol/far/ff_far.h"
#include "../rig/slow_far.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#ifndef TEST_STRIDE
#define TEST_STRIDE 1
#endif

static uint32_t random_state;

static uint32_t chance(uint32_t below)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)random_state * below >> 32);
}

/* -most..most */
static int32_t about_zero(uint32_t most) { return (int32_t)chance(2 * most + 1) - (int32_t)most; }

static int32_t within(int32_t value, int32_t low, int32_t high)
{
    return value < low ? low : value > high ? high : value;
}

/* ---- places and distances ---- */

static void sectors_look_along_sixteenths_of_a_turn(void **state)
{
    (void)state;
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) {
        int32_t forward[2], right[2], quarter_on[2], ignored[2];
        double azimuth = s * acos(-1) / 8;
        ff_far_axes(s, forward, right);
        ff_far_axes((s + 4) % FF_FAR_SECTORS, quarter_on, ignored);
        assert_true(fabs(forward[0] - sin(azimuth) * (1 << 30)) < 1);
        assert_true(fabs(forward[1] - cos(azimuth) * (1 << 30)) < 1);
        assert_memory_equal(right, quarter_on, sizeof right);
    }
}

static void pictures_reach_a_texel_beyond_their_sector(void **state)
{
    double tangent = tan(acos(-1) / 16);
    (void)state;
    for (int32_t focal = FF_FAR_FOCAL_MIN >> FF_FAR_SHIFT_MAX; focal <= FF_FAR_FOCAL_MAX; focal++) {
        int32_t half = ff_far_half(focal), blocks = ff_far_blocks_x(focal);
        assert_true(half >= focal * tangent + 1 && half < focal * tangent + 2.1);
        assert_true(blocks % 2 == 0 && blocks <= FF_FAR_BLOCKS_MAX);
        assert_true(blocks * FF_FAR_BLOCK / 2 >= half);
        assert_true(half <= FF_FAR_COLUMN_MAX);
    }
}

static void distances_are_those_of_the_specification(void **state)
{
    (void)state;
    for (unsigned step = 0; step <= FF_FAR_DISTANCE_MAX; step++) {
        assert_int_equal(ff_far_distance_wu(step), slow_distance((int)step));
        assert_int_equal(ff_far_distance_step(ff_far_distance_wu(step)), step);
    }
    assert_int_equal(ff_far_distance_wu(0), 64 * 256);
    assert_int_equal(ff_far_distance_wu(320), 64 * 256 * 1024);
}

static void a_distance_is_kept_within_1_1_percent(void **state)
{
    int32_t largest = ff_far_distance_wu(FF_FAR_DISTANCE_MAX);
    double worst = 0;
    (void)state;
    for (double at = 64 * 256; at < largest; at *= 1.0003) {
        int32_t kept = ff_far_distance_wu(ff_far_distance_step((int32_t)at));
        worst = fmax(worst, fabs(kept / floor(at) - 1));
    }
    assert_true(worst > 0.0105 && worst < 0.011);
    assert_int_equal(ff_far_distance_step(INT32_MIN), 0);
    assert_int_equal(ff_far_distance_step(0), 0);
    assert_int_equal(ff_far_distance_step(64 * 256 - 1), 0);
    assert_int_equal(ff_far_distance_step(INT32_MAX), FF_FAR_DISTANCE_MAX);
}

/* ---- fins made up ---- */

static ff_fin_vertex any_vertex(int32_t column)
{
    return (ff_fin_vertex){ .column = (int16_t)column,
                            .up_q2 = (int16_t)about_zero(FF_FAR_UP_MAX),
                            .distance = (uint16_t)chance(FF_FAR_DISTANCE_MAX + 1) };
}

/* Fins of any vertices, `most` of them in all. */
static uint32_t any_fins(ff_fin_vertex *vertex, uint32_t most)
{
    uint32_t count = 0;
    while (count + 2 <= most) {
        int32_t column = about_zero(FF_FAR_COLUMN_MAX - 1), reach = 1 + (int32_t)chance(400);
        for (uint32_t i = 0; count < most && (i < 2 || column <= FF_FAR_COLUMN_MAX); i++) {
            if (column > FF_FAR_COLUMN_MAX) column = FF_FAR_COLUMN_MAX;
            vertex[count] = any_vertex(column);
            vertex[count++].begins = i == 0;
            column += 1 + (int32_t)chance((uint32_t)reach);
        }
        if (vertex[count - 1].begins) return count - 1; /* no room for a second one */
    }
    return count;
}

/* Ridges as terrain has them, at half a texel's tolerance: far ones first, each lower and nearer
 * than those before. */
static uint32_t ridges(ff_fin_vertex *vertex, uint32_t fins)
{
    uint32_t count = 0;
    for (uint32_t fin = 0; fin < fins; fin++) {
        int32_t column = about_zero(100), up = 100 - (int32_t)(fin * 12) + about_zero(30);
        int32_t distance = 320 - (int32_t)(fin * 4) + about_zero(4);
        uint32_t length = 3 + chance(24);
        for (uint32_t i = 0; i < length; i++) {
            vertex[count++] = (ff_fin_vertex){ .column = (int16_t)column,
                                               .up_q2 = (int16_t)up,
                                               .distance = (uint16_t)distance,
                                               .begins = i == 0 };
            column += 1 + (int32_t)(chance(12) + chance(8));
            up += about_zero(3) + about_zero(5);
            distance = within(distance + about_zero(1) * (int32_t)chance(3), 0, 511);
        }
    }
    return count;
}

static void assert_same_vertex(const ff_fin_vertex *a, const slow_vertex *b)
{
    assert_int_equal(a->begins, b->begins);
    assert_int_equal(a->column, b->column);
    assert_int_equal(a->up_q2, b->height);
    assert_int_equal(a->distance, b->distance);
}

/* Both decoders refuse the bytes, or both read the same. Vertices. */
static int read_fins(const uint8_t *bytes, size_t count)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    static slow_vertex slow[SLOW_FAR_VERTICES];
    int found = ff_fins_decode(bytes, count, vertex, FF_FAR_VERTICES_MAX),
        told = slow_fins(bytes, count, slow);
    assert_true(found >= 0 ? found == told : told < 0);
    if (found < 0) return found;
    for (int i = 0; i < found; i++) assert_same_vertex(&vertex[i], &slow[i]);
    return found;
}

/* Encodes into exact room and decodes into exact room. Bytes. */
static int there_and_back(const ff_fin_vertex *vertex, uint32_t count)
{
    static uint8_t bytes[FF_FAR_FINS_BYTES];
    int used = ff_fins_encode(vertex, count, bytes, sizeof bytes);
    assert_in_range(used, 1, FF_FAR_FINS_BYTES);
    uint8_t *exact = malloc((size_t)used);
    ff_fin_vertex *back = malloc(count * sizeof *back);
    assert_int_equal(ff_fins_encode(vertex, count, exact, (size_t)used - 1), FF_ERR_FULL);
    assert_int_equal(ff_fins_encode(vertex, count, exact, (size_t)used), used);
    assert_memory_equal(exact, bytes, (size_t)used);
    assert_int_equal(ff_fins_decode(exact, (size_t)used, back, count - 1), FF_ERR_FULL);
    assert_int_equal(ff_fins_decode(exact, (size_t)used, back, count), count);
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(back[i].begins, vertex[i].begins);
        assert_int_equal(back[i].column, vertex[i].column);
        assert_int_equal(back[i].up_q2, vertex[i].up_q2);
        assert_int_equal(back[i].distance, vertex[i].distance);
    }
    free(back);
    assert_int_equal(read_fins(exact, (size_t)used), count);
    free(exact);
    return used;
}

static void fins_there_and_back_by_both_decoders(void **state)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    uint8_t nothing;
    (void)state;
    random_state = 1;
    for (uint32_t run = 0; run < 400; run += TEST_STRIDE) {
        uint32_t most = run % 4 ? 2 + chance(60) : FF_FAR_VERTICES_MAX;
        there_and_back(vertex, any_fins(vertex, most));
        there_and_back(vertex, ridges(vertex, 1 + chance(30)));
    }
    assert_int_equal(ff_fins_encode(vertex, 0, &nothing, 0), 0);
    assert_int_equal(ff_fins_decode(&nothing, 0, vertex, 0), 0);
    assert_int_equal(slow_fins(&nothing, 0, NULL), 0);
}

/* Bytes as they have been since protocol 9: whoever changes them changes the format. */
static void fins_stay_as_they_are(void **state)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    static uint8_t bytes[FF_FAR_FINS_BYTES];
    uint32_t sum = 2166136261u; /* FNV-1a */
    (void)state;
    random_state = 5;
    int used = ff_fins_encode(vertex, ridges(vertex, 12), bytes, sizeof bytes);
    for (int i = 0; i < used; i++) sum = (sum ^ bytes[i]) * 16777619u;
    assert_int_equal(sum, 0xf144b883u);
}

static void a_vertex_of_a_ridge_takes_two_bytes(void **state)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    uint32_t vertices = 0, bytes = 0;
    (void)state;
    random_state = 2;
    for (uint32_t run = 0; run < 100; run++) {
        uint32_t count = ridges(vertex, 12);
        vertices += count;
        bytes += (uint32_t)there_and_back(vertex, count);
    }
    assert_true(bytes <= 2 * vertices);
}

/* Largest steps, at every vertex; and as many fins as there can be. */
static void the_worst_fins_fit_the_bytes_named(void **state)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    (void)state;
    for (uint32_t length = 2; length <= FF_FAR_VERTICES_MAX; length *= 2) {
        for (uint32_t i = 0; i < FF_FAR_VERTICES_MAX; i++) {
            int32_t step = 2 * FF_FAR_COLUMN_MAX / (int32_t)(length - 1);
            vertex[i].begins = i % length == 0;
            vertex[i].column = (int16_t)(i / length % 2 && length == 2
                                             ? FF_FAR_COLUMN_MAX - 1 + (int32_t)(i % 2)
                                             : (int32_t)(i % length) * step - FF_FAR_COLUMN_MAX);
            vertex[i].up_q2 = i % 2 ? FF_FAR_UP_MAX : -FF_FAR_UP_MAX;
            vertex[i].distance = i % 2 ? FF_FAR_DISTANCE_MAX : 0;
        }
        there_and_back(vertex, FF_FAR_VERTICES_MAX);
    }
}

static void fins_out_of_range_are_not_encoded(void **state)
{
    static const ff_fin_vertex good[5] = {
        { -1023, -16383, 511, 1 },
        { 0, 16383, 0, 0 },
        { 1023, 0, 7, 0 },
        { 3, 1, 1, 1 },
        { 4, 1, 1, 0 },
    };
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX + 1];
    uint8_t bytes[128];
    (void)state;
    assert_true(ff_fins_encode(good, 5, bytes, sizeof bytes) > 0);
#define BAD(assignment)                 \
    memcpy(vertex, good, sizeof(good)); \
    vertex assignment;                  \
    assert_int_equal(ff_fins_encode(vertex, 5, bytes, sizeof bytes), FF_ERR_RANGE)
    BAD([0].column = -1024);
    BAD([2].column = 1024);
    BAD([0].up_q2 = -16384);
    BAD([1].up_q2 = 16384);
    BAD([0].distance = 512);
    BAD([1].column = -1023); /* no step at all */
    BAD([4].column = 2);
    BAD([0].begins = 0);
    BAD([0].begins = 2);
    BAD([1].begins = 1); /* a fin of one vertex */
    BAD([4].begins = 1);
    BAD([1].begins = 2);
#undef BAD
    for (int i = 0; i <= FF_FAR_VERTICES_MAX; i++)
        vertex[i] = (ff_fin_vertex){ (int16_t)(i % 2), 0, 0, i % 2 == 0 };
    static uint8_t room[FF_FAR_FINS_BYTES];
    assert_true(ff_fins_encode(vertex, FF_FAR_VERTICES_MAX, room, sizeof room) > 0);
    vertex[FF_FAR_VERTICES_MAX].begins = 0;
    vertex[FF_FAR_VERTICES_MAX].column = 2;
    assert_int_equal(ff_fins_encode(vertex, FF_FAR_VERTICES_MAX + 1, room, sizeof room),
                     FF_ERR_RANGE);
}

/* ---- damage ---- */

static void damage_all(uint8_t *bytes, size_t count, int (*read)(const uint8_t *, size_t))
{
    for (size_t cut = 1; cut < count; cut++) {
        uint8_t *exact = malloc(cut);
        memcpy(exact, bytes, cut);
        (void)read(exact, cut);
        free(exact);
    }
    for (size_t bit = 0; bit < 8 * count; bit++) {
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        read(bytes, count);
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
}

static void damaged_fins_are_refused_or_read_alike(void **state)
{
    static ff_fin_vertex vertex[FF_FAR_VERTICES_MAX];
    static uint8_t bytes[FF_FAR_FINS_BYTES];
    (void)state;
    random_state = 3;
    for (uint32_t run = 0; run < 60; run += TEST_STRIDE) {
        uint32_t count = run % 2 ? any_fins(vertex, 2 + chance(40)) : ridges(vertex, 1 + run % 6);
        int used = ff_fins_encode(vertex, count, bytes, sizeof bytes);
        damage_all(bytes, (size_t)used, read_fins);
    }
}

static void any_bytes_are_refused_or_read_alike(void **state)
{
    uint8_t bytes[48];
    int fins = 0;
    (void)state;
    random_state = 4;
    for (uint32_t run = 0; run < 100000; run += TEST_STRIDE) {
        size_t count = 1 + chance(run % 3 ? 4 : sizeof bytes);
        uint32_t zeros = chance(3); /* bytes with few ones are short numbers, and get farther */
        for (size_t i = 0; i < count; i++) {
            bytes[i] = (uint8_t)chance(256);
            for (uint32_t z = 0; z < zeros; z++) bytes[i] &= (uint8_t)chance(256);
        }
        fins += read_fins(bytes, count) >= 0;
    }
    assert_true(fins > 20); /* else nothing was compared */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sectors_look_along_sixteenths_of_a_turn),
        cmocka_unit_test(pictures_reach_a_texel_beyond_their_sector),
        cmocka_unit_test(distances_are_those_of_the_specification),
        cmocka_unit_test(a_distance_is_kept_within_1_1_percent),
        cmocka_unit_test(fins_there_and_back_by_both_decoders),
        cmocka_unit_test(fins_stay_as_they_are),
        cmocka_unit_test(a_vertex_of_a_ridge_takes_two_bytes),
        cmocka_unit_test(the_worst_fins_fit_the_bytes_named),
        cmocka_unit_test(fins_out_of_range_are_not_encoded),
        cmocka_unit_test(damaged_fins_are_refused_or_read_alike),
        cmocka_unit_test(any_bytes_are_refused_or_read_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
