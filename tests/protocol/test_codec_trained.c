/* Codec trained beside the slow decoder: wild, flat and cut ground, any bytes; its numbers, and
 * payloads that must stay as they are. What payloads are made of: test_trained_parts.c. */
#include "../rig/trained_grid.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <zlib.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

static void every_ground_comes_back(void **state)
{
    static grid_test t;
    static uint16_t again[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    for (uint32_t run = 0; run < 5 * MAX_ERRORS * GROUNDS * 8; run++) {
        uint32_t e = run / 5 % MAX_ERRORS, way = run / 5 / MAX_ERRORS / GROUNDS;
        grid_set(&t, (uint8_t)(1 + run % 5), way & 1, max_errors[e]);
        t.info.entered = way == 7;
        uint32_t side = grid_side(&t);
        if (way & 2) t.cells.columns = (uint8_t)(1 + grid_random_below(side - 1));
        if (way & 4) t.cells.rows = (uint8_t)(1 + grid_random_below(side - 1));
        grid_make(&t, (int)(run / 5 / MAX_ERRORS % GROUNDS));
        int bytes = grid_encode(&t), error = t.info.entered ? 0 : t.info.max_error;
        assert_in_range(bytes, 1, 2 + 8 + 2 * t.count);
        assert_int_equal(grid_decode_both(&t, t.payload, (size_t)bytes, again), FF_OK);
        assert_memory_equal(again, t.decoded, 2 * side * side);
        for (uint32_t i = 0; i < side * side; i++)
            assert_in_range(abs(again[i] - t.source[i]), 0, error);
    }
}

/* ---- any bytes ---- */

static void put_chance(ff_bits *to, unsigned bits)
{
    for (; bits > 0; bits--) ff_bits_put(to, grid_random_below(2), 1);
}

/* A stream of chance behind a head of chance that says nothing wrong, or an encoded one of wild
 * ground with a few bits turned. */
static size_t spoilt_payload(grid_test *t)
{
    size_t bytes = (size_t)grid_encode(t);
    if (grid_random_below(2)) {
        ff_bits tail = { 0 };
        uint32_t form = grid_random_below(3);
        if (grid_random_below(3)) {
            ff_bits_put(&tail, grid_random_below(2), 4);
            ff_bits_put(&tail, form, 2);
            ff_bits_put(&tail, 1, 2); /* no marks, codes as bound */
        } else {
            form = 0;
            ff_bits_put(&tail, 1, 1 + grid_random_below(2));
        }
        put_chance(&tail, (t->root ? 64 : 0) + grid_random_below(64));
        bytes = form == 2 ? 2 * t->count : grid_random_below(2 * t->count + 2);
        for (size_t i = 0; i < bytes; i++) t->payload[i] = (uint8_t)grid_random_below(256);
        if (form == 2) tail.count = t->root ? 72 : 8;
        bytes = ff_bits_join(&tail, t->payload, 8 * (uint32_t)bytes);
    } else {
        for (uint32_t i = grid_random_below(4); i > 0; i--)
            t->payload[grid_random_below((uint32_t)bytes)] ^= (uint8_t)(1u << grid_random_below(8));
        if (grid_random_below(4) == 0) bytes = grid_random_below((uint32_t)bytes + 1);
        if (grid_random_below(4) == 0) t->payload[bytes++] = (uint8_t)grid_random_below(256);
    }
    return bytes;
}

static void any_bytes_are_read_alike(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    uint32_t taken = 0, refused = 0;
    (void)state;
    for (int run = 0; run < 6000; run++) {
        grid_set(&t, (uint8_t)(1 + grid_random_below(5)), (int)grid_random_below(2),
                 grid_random_below(2) ? max_errors[grid_random_below(MAX_ERRORS)]
                                      : (uint16_t)grid_random_below(32768));
        t.info.entered = grid_random_below(8) == 0;
        if (grid_random_below(2)) {
            t.cells.columns = (uint8_t)(1 + grid_random_below(grid_side(&t) - 1));
            t.cells.rows = (uint8_t)(1 + grid_random_below(grid_side(&t) - 1));
        }
        grid_make(&t, (int)grid_random_below(GROUNDS));
        size_t bytes = spoilt_payload(&t);
        if (grid_decode_both(&t, t.payload, bytes, heights) == FF_OK)
            taken++;
        else
            refused++;
    }
    assert_true(taken > 1000 && refused > 1000);
}

/* ---- sizes ---- */

static void flat_ground_needs_no_stream(void **state)
{
    static grid_test t;
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (uint32_t e = 0; e < MAX_ERRORS; e++)
            for (int root = 0; root < 2; root++) {
                grid_set(&t, k, root, max_errors[e]);
                grid_make(&t, FLAT);
                /* without error, where there may be some */
                int bytes = root ? 8 + 1 + (e > 0) : 1 + (e > 0);
                assert_int_equal(grid_encode(&t), bytes);
                for (; t.cells.columns > 0; t.cells.columns--)
                    assert_int_equal(grid_encode(&t), bytes);
                grid_set(&t, k, root, max_errors[e]);
                for (t.cells.columns = 1; t.cells.rows > 0; t.cells.rows--)
                    assert_int_equal(grid_encode(&t), bytes);
            }
}

static void noise_is_stored_as_words(void **state)
{
    static grid_test t;
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (int root = 0; root < 2; root++) {
            grid_set(&t, k, root, 0);
            grid_make(&t, NOISE);
            uint32_t bytes = (uint32_t)grid_encode(&t);
            assert_int_equal(bytes, 1 + (root ? 8 : 0) + 2 * t.count);
            assert_int_equal(t.payload[bytes - 1] & 0xEF, 9); /* words of either set */
        }
}

/* ---- sets of weights ---- */

static unsigned way_of(const grid_test *t) { return t->payload[t->bytes - 1] >> 7 ? 0 : 1; }

/* What the finest levels of real ground are like, and what coarse ones are. */
static void smooth_and_rough_ground_take_sets_of_their_own(void **state)
{
    static grid_test t;
    (void)state;
    for (uint8_t k = 3; k <= FF_NODE_LOG2_MAX; k++) {
        grid_set(&t, k, 0, 0);
        grid_make(&t, ROUGH);
        grid_encode(&t);
        assert_int_equal(way_of(&t), 1);
        for (uint32_t i = 0, side = grid_side(&t); i < side * side; i++)
            t.source[i] = (uint16_t)(20000 + i % side * (i % side) / 4 + 25 * (i / side) +
                                     grid_random_below(3));
        for (uint32_t i = 0, side = ff_node_side(&t.info); i < side * side; i++)
            t.parent[i] = t.source[2 * (i / side) * grid_side(&t) + 2 * (i % side)];
        grid_encode(&t);
        assert_int_equal(way_of(&t), 0);
    }
}

static uint16_t as_predicted(void *context, uint32_t at, int32_t predicted)
{
    (void)context, (void)at;
    return (uint16_t)predicted;
}

/* Below leaves there is no payload that could tell the set, so they are always of the first. */
static void ground_that_only_the_second_set_foresees_is_no_leaf(void **state)
{
    static grid_test t;
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .value = value, .body = body };
    (void)state;
    grid_set(&t, 2, 0, 0);
    grid_make(&t, ROUGH);
    res.cells = t.cells;
    for (unsigned way = 0; way < 2; way++) {
        ff_trained_predict(&t.info, t.cells, way, t.parent, t.source, codec_room, as_predicted,
                           NULL);
        ff_encode_heights(&t.info, t.parent, t.source, NULL, &res, t.decoded);
        assert_int_equal(res.way, way);
        for (uint32_t i = 0; i < res.count; i++)
            if (way == 0) assert_int_equal(value[i], 0);
        assert_int_equal(ff_is_as_predicted(&res), way == 0);
    }
}

/* ---- leaves ---- */

/* What lies below a leaf has a residual of 0 everywhere, even where another one is likelier. */
static void below_leaves_all_is_prediction(void **state)
{
    static grid_test t;
    static uint16_t made[FF_REFINED_HEIGHTS_MAX], heights[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (uint32_t run = 0; run < MAX_ERRORS * GROUNDS * 2; run++) {
            grid_set(&t, k, 0, max_errors[run % MAX_ERRORS]);
            if (run % 2) t.cells.columns = (uint8_t)(1 + grid_random_below(grid_side(&t) - 1));
            grid_make(&t, (int)(run / MAX_ERRORS / 2));
            grid_encode(&t);
            memset(payload, 0, 2 * t.count);
            payload[2 * t.count] = 9; /* set 0, words */
            assert_int_equal(grid_decode_both(&t, payload, 1 + 2 * t.count, heights), FF_OK);
            ff_predict_children(&t.info, t.cells, t.parent, made, codec_room);
            assert_memory_equal(made, heights, 2 * grid_side(&t) * grid_side(&t));
        }
}

/* ---- numbers ---- */

/* A decision that cannot be would end the coder's interval. */
static void every_decision_is_possible(void **state)
{
    (void)state;
    for (uint32_t scale = 0; scale < FF_TRAINED_SCALES; scale++) {
        const uint16_t *one = (const uint16_t *)&ff_trained_tables.odds[scale];
        for (uint32_t i = 0; i < FF_TRAINED_DECISIONS; i++) assert_in_range(one[i], 1, 65535);
    }
}

static int64_t sizes(const int16_t *weight, uint32_t count)
{
    int64_t sum = 0;
    for (uint32_t i = 0; i < count; i++) sum += weight[i] < 0 ? -weight[i] : weight[i];
    return sum;
}

static void sums_of_what_is_around_a_point_fit_32_bits(void **state)
{
    (void)state;
    for (unsigned set = 0; set < FF_TRAINED_SETS; set++)
        for (unsigned kind = 0; kind < FF_POINTS; kind++) {
            const ff_weights *by = &ff_trained_tables.weights[set];
            const int16_t *trait = by->trait[kind];
            for (unsigned bucket = 0; bucket < FF_TRAINED_BUCKETS; bucket++) {
                const int16_t *tap = by->taps[kind][bucket].tap;
                int32_t sum = 0;
                for (unsigned i = 0; i < FF_TRAINED_TAPS; i++) sum += tap[i];
                assert_int_equal(by->taps[kind][bucket].sum, sum);
                assert_in_range(sizes(tap, FF_TRAINED_TAPS), 0, INT16_MAX);
            }
            assert_in_range(4 * sizes(trait, 1) + UINT16_MAX * sizes(trait + 1, 1) +
                                FF_TRAINED_TRAIT_MAX * sizes(trait + 2, FF_TRAINED_TRAITS - 2),
                            0, INT32_MAX);
        }
}

/* Ground without chance, whatever machine made it: its payloads and heights are part of the
 * format. Their CRC-32, by k; refinements, then roots. */
static void payloads_stay_as_they_are(void **state)
{
    static const uint32_t golden[2][FF_NODE_LOG2_MAX][2] = { { { 0x2bb2895f, 0xfcfc6e07 },
                                                               { 0x318dc299, 0xb1aefa47 },
                                                               { 0x26b6b7c1, 0x41d41f2f },
                                                               { 0xa7c234f2, 0xd744b927 },
                                                               { 0x98c57911, 0x28a64898 } },
                                                             { { 0xd9df3e01, 0x9b965651 },
                                                               { 0x422978d4, 0x41c77a8c },
                                                               { 0x2371a39f, 0xa77629af },
                                                               { 0x26bf676a, 0x87394c42 },
                                                               { 0x699ef692, 0x0fc6f063 } } };
    static grid_test t;
    int differ = 0;
    (void)state;
    for (int root = 0; root < 2; root++)
        for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++) {
            uLong of_bytes = 0, of_heights = 0;
            grid_random_state = 1;
            for (uint32_t e = 0; e < MAX_ERRORS; e++)
                for (int kind = CLIFF; kind <= ROUGH; kind++)
                    for (uint8_t cut = 0; cut < 2; cut++) {
                        grid_set(&t, k, root, max_errors[e]);
                        t.cells.rows = (uint8_t)(t.cells.rows - cut);
                        grid_make(&t, kind);
                        of_bytes = crc32(of_bytes, t.payload, (uInt)grid_encode(&t));
                        for (uint32_t i = 0; i < grid_side(&t) * grid_side(&t); i++) {
                            const uint8_t two[2] = { (uint8_t)t.decoded[i],
                                                     (uint8_t)(t.decoded[i] >> 8) };
                            of_heights = crc32(of_heights, two, 2);
                        }
                    }
            if (golden[root][k - 1][0] == of_bytes && golden[root][k - 1][1] == of_heights)
                continue;
            print_message("# root %d, k %d: 0x%08lx, 0x%08lx\n", root, k, of_bytes, of_heights);
            differ++;
        }
    assert_int_equal(differ, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ground_comes_back),
        cmocka_unit_test(any_bytes_are_read_alike),
        cmocka_unit_test(flat_ground_needs_no_stream),
        cmocka_unit_test(noise_is_stored_as_words),
        cmocka_unit_test(smooth_and_rough_ground_take_sets_of_their_own),
        cmocka_unit_test(ground_that_only_the_second_set_foresees_is_no_leaf),
        cmocka_unit_test(below_leaves_all_is_prediction),
        cmocka_unit_test(every_decision_is_possible),
        cmocka_unit_test(sums_of_what_is_around_a_point_fit_32_bits),
        cmocka_unit_test(payloads_stay_as_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
