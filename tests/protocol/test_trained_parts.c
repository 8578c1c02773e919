/* Codec trained's payloads, part by part: heads, sides, and where streams end. */
#include "../rig/trained_grid.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

/* ---- streams ---- */

/* The tail of a payload as an encoder makes it, and the stream before it with all bits that lie
 * there. Bytes of that. */
static uint32_t take_apart(const grid_test *t, ff_bits *bits, uint8_t *stream)
{
    ff_residuals head = { 0 };
    ff_tail tail = { t->payload, (uint32_t)t->bytes, 0 }, rest;
    uint8_t last;
    assert_int_equal(ff_trained_take_head(&t->info, t->root, &tail, &head), FF_OK);
    if (t->root) tail.at += 64;
    if (head.apart == FF_SIDES_MEASURED)
        assert_int_equal(ff_trained_pass_sides(&t->info, &tail), FF_OK);
    uint32_t bytes = ff_tail_before(&tail, &last);
    memcpy(stream, t->payload, bytes);
    if (bytes > 0) stream[bytes - 1] = last;
    rest = (ff_tail){ t->payload, (uint32_t)t->bytes, 0 };
    *bits = (ff_bits){ 0 };
    ff_bits_copy(bits, &rest, tail.at);
    return bytes;
}

static void streams_are_held_to_their_end(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    static uint8_t stream[FF_PAYLOAD_BYTES_MAX];
    (void)state;
    for (uint8_t k = 2; k <= FF_NODE_LOG2_MAX; k++)
        for (int root = 0; root < 2; root++) {
            ff_bits tail;
            grid_set(&t, k, root, 4);
            grid_make(&t, ROUGH);
            grid_encode(&t);
            uint32_t bytes = take_apart(&t, &tail, stream), shared = tail.count % 8;
            for (uint32_t more = 1; more <= 6; more++) {
                memset(stream + bytes, 1, more); /* a reader is up to four ahead */
                memset(stream + bytes + more, 0, 2);
                memcpy(t.payload, stream, bytes + more + 2);
                size_t all = ff_bits_join(&tail, t.payload, 8 * (bytes + more + 2) - shared);
                assert_int_equal(grid_decode_both(&t, t.payload, all, heights), FF_ERR_FORMAT);
                stream[bytes + more - 1] = 128;
                memcpy(t.payload, stream, bytes + more);
                all = ff_bits_join(&tail, t.payload, 8 * (bytes + more) - shared);
                int rc = grid_decode_both(&t, t.payload, all, heights);
                if (more == 6) assert_int_equal(rc, FF_ERR_FORMAT);
            }
        }
}

/* Words tell at once how many there are. */
static void words_are_held_to_their_number(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++)
        for (int root = 0; root < 2; root++) {
            grid_set(&t, k, root, 0);
            grid_make(&t, EXTREMES);
            grid_encode(&t);
            for (int more = -1; more <= 1; more++) {
                ff_bits tail = { 0 };
                uint32_t bytes = 2 * t.count + (uint32_t)more;
                ff_bits_put(&tail, 9, 8); /* set 0, words, no marks, codes as bound */
                for (int i = 0; i < 64 && root; i++) ff_bits_put(&tail, 1, 1);
                memset(t.payload, 0xff, bytes);
                size_t all = ff_bits_join(&tail, t.payload, 8 * bytes);
                assert_int_equal(grid_decode_both(&t, t.payload, all, heights),
                                 more < 0   ? FF_ERR_TRUNCATED
                                 : more > 0 ? FF_ERR_FORMAT
                                            : FF_OK);
            }
        }
}

/* ---- sides ---- */

/* Which of the sides' points are coded is known only where the ground goes on beyond them. */
static int may_leave_out(const grid_test *t, unsigned sides)
{
    uint32_t side = grid_side(t);
    return !(sides >> FF_SIDE_EAST & 1u && (t->cells.columns + 1u) / 2 * 2 < side - 1) &&
           !(sides >> FF_SIDE_NORTH & 1u && (t->cells.rows + 1u) / 2 * 2 < side - 1);
}

static ff_residuals head_of(const grid_test *t, const uint8_t *payload, size_t bytes)
{
    ff_residuals head = { 0 };
    ff_tail tail = { payload, (uint32_t)bytes, 0 };
    assert_int_equal(ff_trained_take_head(&t->info, t->root, &tail, &head), FF_OK);
    return head;
}

static void what_lies_beside_a_node_need_not_come_again(void **state)
{
    static grid_test t;
    static uint16_t again[FF_REFINED_HEIGHTS_MAX];
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    uint32_t left_out = 0;
    (void)state;
    for (uint32_t run = 0; run < 5 * MAX_ERRORS * 2 * 16; run++) {
        unsigned sides = run / 5 / MAX_ERRORS % 16;
        grid_set(&t, (uint8_t)(1 + run % 5), 0, max_errors[run / 5 % MAX_ERRORS]);
        if (run / 5 / MAX_ERRORS / 16)
            t.cells.columns = (uint8_t)(1 + grid_random_below(grid_side(&t) - 1));
        grid_make(&t, run % 2 ? ROUGH : SMOOTH);
        int bytes = grid_encode(&t);
        int fewer = ff_without_sides(&t.info, t.payload, (size_t)bytes, sides, less);
        if (head_of(&t, t.payload, (size_t)bytes).apart != FF_SIDES_MEASURED) {
            assert_int_equal(fewer, 0); /* sides apart would not pay, or words are as short */
            continue;
        }
        ff_residuals head = head_of(&t, less, (size_t)fewer);
        assert_in_range(fewer, 1, bytes - 1);
        assert_int_equal(head.apart, FF_SIDES_BARE);
        assert_int_equal(head.sides, sides);
        if (!may_leave_out(&t, sides)) {
            assert_int_equal(grid_decode_both(&t, less, (size_t)fewer, again), FF_ERR_FORMAT);
            continue;
        }
        assert_int_equal(grid_decode_both(&t, less, (size_t)fewer, again), FF_OK);
        assert_memory_equal(again, t.decoded, 2 * grid_side(&t) * grid_side(&t));
        assert_int_equal(ff_without_sides(&t.info, less, (size_t)fewer, sides, t.payload), 0);
        left_out += sides != 0;
    }
    assert_true(left_out > 300);
}

/* Who has not put the sides into the grid is not given what happens to be there. */
static void sides_are_left_out_for_those_who_know_them(void **state)
{
    static grid_test t;
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    ff_residuals out = { .value = value };
    (void)state;
    grid_set(&t, 3, 0, 0);
    grid_make(&t, ROUGH);
    out.cells = t.cells;
    int bytes = grid_encode(&t),
        fewer = ff_without_sides(&t.info, t.payload, (size_t)bytes, 2, less);
    void *memory = malloc(ff_decoder_bytes(&t.info));
    ff_decoder *dec = ff_decoder_create(&t.info, memory, ff_decoder_bytes(&t.info));
    assert_int_equal(ff_decode_refinement(dec, less, (size_t)fewer, &out), FF_OK);
    assert_int_equal(out.sides, 1 << FF_SIDE_EAST);
    assert_int_equal(ff_reconstruct_refinement(&t.info, t.parent, &out, heights, codec_room),
                     FF_ERR_FORMAT);
    free(memory);
}

/* A payload of which the beginning is gone, or whose lengths are wrong, is not read beyond it. */
static void lengths_of_sides_are_held_to_the_payload(void **state)
{
    static grid_test t;
    static uint8_t less[FF_PAYLOAD_BYTES_MAX], stream[FF_PAYLOAD_BYTES_MAX];
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    ff_bits tail;
    (void)state;
    grid_set(&t, 3, 0, 1);
    grid_make(&t, ROUGH);
    grid_encode(&t);
    uint32_t bytes = take_apart(&t, &tail, stream), shared = tail.count % 8;
    assert_int_equal(head_of(&t, t.payload, t.bytes).apart, FF_SIDES_MEASURED);
    for (size_t left = 0; 8 * left < tail.count; left++) {
        uint8_t *exact = malloc(left ? left : 1);
        memcpy(exact, t.payload + t.bytes - left, left);
        assert_int_equal(ff_without_sides(&t.info, exact, left, 5, less), FF_ERR_TRUNCATED);
        assert_true(grid_decode_both(&t, exact, left, heights) < 0);
        free(exact);
    }
    for (unsigned s = 0; s < 8; s++) {
        ff_tail in = { t.payload, (uint32_t)t.bytes, 0 };
        ff_residuals head = { 0 };
        ff_bits wrong = { 0 };
        assert_int_equal(ff_trained_take_head(&t.info, 0, &in, &head), FF_OK);
        ff_trained_put_head(&t.info, 0, &head, &wrong);
        assert_int_equal(wrong.count, in.at);
        for (unsigned side = 0; side < 4; side++)
            ff_bits_number(&wrong, ff_tail_number(&in, 4) + (side == s / 2 ? 2 * (s % 2) - 1 : 0),
                           4);
        ff_bits_copy(&wrong, &in, tail.count - in.at);
        memcpy(t.payload, stream, bytes);
        size_t all = ff_bits_join(&wrong, t.payload, 8 * bytes - shared);
        assert_true(grid_decode_both(&t, t.payload, all, heights) < 0);
        memcpy(t.payload, stream, bytes);
        assert_int_equal(ff_bits_join(&tail, t.payload, 8 * bytes - shared), t.bytes);
    }
}

/* ---- heads ---- */

static uint8_t code_by_chance(uint8_t bound)
{
    return grid_random_below(3)
               ? (uint8_t)grid_random_below(209)
               : (uint8_t)(grid_random_below(2) ? bound : grid_random_below(bound + 1u));
}

static ff_residuals head_by_chance(const grid_test *t)
{
    uint8_t bound = ff_geometric_error_encode(t->info.max_error), all = t->root ? 1 : 15;
    ff_residuals head = { .way = (uint8_t)grid_random_below(2) };
    int same = grid_random_below(3) == 0;
    head.apart = (uint8_t)(t->root ? (grid_random_below(2) ? FF_SIDES_NONE : FF_SIDES_WORDS)
                                   : grid_random_below(4));
    if (head.apart == FF_SIDES_BARE) head.sides = (uint8_t)grid_random_below(16);
    for (unsigned i = 0; i < (t->root ? 1 : 4); i++)
        head.child_error[i] = same && i > 0 ? head.child_error[0] : code_by_chance(bound);
    if (grid_random_below(2)) {
        head.stub = (uint8_t)(grid_random_below(16) & all);
        head.leaf = (uint8_t)(grid_random_below(16) & all & ~head.stub);
        head.filled = (uint8_t)(grid_random_below(16) & all);
    }
    return head;
}

static void what_a_head_says_comes_back(void **state)
{
    static grid_test t;
    (void)state;
    for (int run = 0; run < 20000; run++) {
        grid_set(&t, 3, run % 2, max_errors[grid_random_below(MAX_ERRORS)]);
        ff_residuals head = head_by_chance(&t), again = { 0 };
        ff_bits bits = { 0 };
        uint8_t bytes[64];
        ff_trained_put_head(&t.info, t.root, &head, &bits);
        ff_tail tail = { bytes, (uint32_t)ff_bits_join(&bits, bytes, 0), 0 };
        assert_int_equal(ff_trained_take_head(&t.info, t.root, &tail, &again), FF_OK);
        assert_int_equal(tail.at, bits.count);
        assert_memory_equal(again.child_error, head.child_error, 4);
        assert_int_equal(again.way | again.apart << 4 | again.sides << 8,
                         head.way | head.apart << 4 | head.sides << 8);
        assert_int_equal(again.stub | again.leaf << 4 | again.filled << 8,
                         head.stub | head.leaf << 4 | head.filled << 8);
    }
}

/* Both decoders take the same heads, and find the same marks. */
static void heads_are_held_to_what_they_mean(void **state)
{
    static grid_test t;
    static uint16_t heights[FF_REFINED_HEIGHTS_MAX];
    int taken = 0;
    (void)state;
    for (uint32_t run = 0; run < 1 << 15; run++) {
        ff_bits tail = { 0 };
        uint8_t payload[40] = { 0 };
        grid_set(&t, 2, run & 1, 1);
        grid_make(&t, FLAT);
        grid_encode(&t);
        ff_bits_put(&tail, run >> 1, 14);
        size_t bytes = ff_bits_join(&tail, payload, t.root ? 0 : 8 * grid_random_below(2));
        taken += grid_decode_both(&t, payload, bytes, heights) == FF_OK;
        if (run >> 12 == 0 && (run >> 9 & 3) == 3) /* 000, set, form 3 */
            assert_true(grid_decode_both(&t, payload, bytes, heights) < 0);
    }
    assert_true(taken > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(streams_are_held_to_their_end),
        cmocka_unit_test(words_are_held_to_their_number),
        cmocka_unit_test(what_lies_beside_a_node_need_not_come_again),
        cmocka_unit_test(sides_are_left_out_for_those_who_know_them),
        cmocka_unit_test(lengths_of_sides_are_held_to_the_payload),
        cmocka_unit_test(what_a_head_says_comes_back),
        cmocka_unit_test(heads_are_held_to_what_they_mean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
