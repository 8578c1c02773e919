/* Payloads tell which children hold filled ground, which are leaves, and which are stubs: both
 * decoders say the same, whatever the codec. */
#include "../../protocol/codec/ff_codec.h"
#include "../rig/slow_decoder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

static int decode(const ff_terrain_info *info, int root, const uint8_t *payload, int bytes,
                  ff_residuals *out)
{
    size_t memory_bytes = ff_decoder_bytes(info);
    void *memory = malloc(memory_bytes);
    ff_decoder *dec = ff_decoder_create(info, memory, memory_bytes);
    assert_non_null(dec);
    int rc = root ? ff_decode_root(dec, payload, (size_t)bytes, out)
                  : ff_decode_refinement(dec, payload, (size_t)bytes, out);
    free(memory);
    return rc;
}

typedef struct payload_test {
    const ff_terrain_info *info;
    const uint16_t *parent; /* NULL: a root */
    const uint8_t *errors;
    ff_residuals res;
    uint16_t decoded[FF_REFINED_HEIGHTS_MAX];
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];
} payload_test;

/* Both decoders take the payload, and say the same marks; -1: both refuse it. */
static void expect_marks(const payload_test *test, int bytes, int marks)
{
    static int32_t taken[FF_REFINED_HEIGHTS_MAX];
    static uint16_t slow[FF_REFINED_HEIGHTS_MAX];
    ff_residuals out = { .value = taken };
    int rc = decode(test->info, !test->parent, test->payload, bytes, &out);
    assert_int_equal(rc == FF_OK, marks >= 0);
    assert_int_equal(slow_decode(test->info, test->parent, test->payload, (size_t)bytes, slow),
                     marks);
    if (marks < 0) return;
    assert_int_equal(256 * out.stub + 16 * out.leaf + out.filled, marks);
    assert_memory_equal(out.child_error, test->errors, test->parent ? 4 : 1);
}

/* A byte of marks may not be empty, nor tell of a child that is not there, nor of a leaf that it is
 * a stub. */
static void spoil(payload_test *test, int bytes, uint8_t *mark, int marks, int unit)
{
    uint8_t was = *mark;
    if (unit < 256) { /* 208 is an error code, the others are none */
        *mark = was & 0xF0;
        expect_marks(test, bytes, -1);
    }
    *mark = (was & 0xF0) + 2; /* a root has no second child */
    int changed = (marks & ~(15 * unit)) + 2 * unit, both = changed >> 8 & changed >> 4 & 15;
    expect_marks(test, bytes, test->parent && !both ? changed : -1);
    *mark = was;
}

static int encode_marked(payload_test *test, int marks)
{
    test->res.filled = marks & 15;
    test->res.leaf = marks >> 4 & 15;
    test->res.stub = (uint8_t)(marks >> 8);
    return ff_encode_payload(test->info, test->parent, test->decoded, &test->res, test->payload);
}

/* Stubs are marked in a payload that is there, and taken back, as if it had been encoded so. */
static void check_marking(payload_test *test, int marks)
{
    static uint8_t marked[FF_PAYLOAD_BYTES_MAX];
    int stub = marks >> 8, root = !test->parent,
        before = encode_marked(test, marks & (stub & 5 ? 0x2FF : 0xFF)),
        bytes = ff_mark_stubs(test->info, root, test->payload, (size_t)before, (uint8_t)stub,
                              marked);
    assert_int_equal(bytes, encode_marked(test, marks));
    assert_memory_equal(marked, test->payload, (size_t)bytes);
    bytes = ff_mark_stubs(test->info, root, test->payload, (size_t)bytes, 0, marked);
    assert_int_equal(bytes, encode_marked(test, marks & 0xFF));
    assert_memory_equal(marked, test->payload, (size_t)bytes);
    if (marks >> 4 & 15)
        assert_int_equal(ff_mark_stubs(test->info, root, test->payload, (size_t)bytes,
                                       (uint8_t)(marks >> 4 & 15), marked),
                         FF_ERR_RANGE);
    if (root)
        assert_int_equal(ff_mark_stubs(test->info, root, test->payload, (size_t)bytes, 2, marked),
                         FF_ERR_RANGE);
}

/* A mark costs one byte beside the error codes, two where those would take none; none costs
 * nothing, and neither does that all are exact leaves. */
static void check_bytes(payload_test *test, int bytes, int unmarked, int marks)
{
    int stub = marks >> 8, leaf = marks >> 4 & 15, filled = marks & 15,
        kinds = (stub > 0) + (leaf > 0) + (filled > 0), raw = test->info->codec == FF_CODEC_RAW,
        exact = !raw && leaf == (test->parent ? 15 : 1) && !filled &&
                memcmp(test->errors, "\0\0\0", 4) == 0;
    uint8_t *mark = test->payload + !raw;
    if (exact) assert_int_equal(bytes, unmarked);
    if (!exact) assert_in_range(bytes - unmarked, kinds, kinds ? kinds + 1 : 0);
    if (stub) spoil(test, bytes, mark, marks, 256);
    if (leaf && !exact) spoil(test, bytes, mark + (stub > 0), marks, 16);
    if (filled) spoil(test, bytes, mark + (stub > 0) + (leaf > 0), marks, 1);
}

/* Codec trained tells marks in bits: five each, and a few in all. */
static void check_bits(int bytes, int unmarked, int marks)
{
    assert_in_range(bytes - unmarked, marks ? 1 : 0, marks ? 3 : 0);
}

static void check(payload_test *test, const uint16_t *source)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint8_t body[FF_PAYLOAD_BYTES_MAX];
    int all = test->parent ? 15 : 1, unmarked = 0;
    test->res = (ff_residuals){ .value = value, .body = body };
    memcpy(test->res.child_error, test->errors, 4);
    ff_encode_heights(test->info, test->parent, source, NULL, &test->res, test->decoded);
    for (int marks = 0; marks < 4096; marks++) {
        int stub = marks >> 8, leaf = marks >> 4 & 15, filled = marks & 15;
        if ((stub | leaf | filled) > all || stub & leaf) continue;
        int bytes = encode_marked(test, marks);
        if (!marks) unmarked = bytes;
        expect_marks(test, bytes, marks);
        if (test->info->codec == FF_CODEC_TRAINED)
            check_bits(bytes, unmarked, marks);
        else
            check_bytes(test, bytes, unmarked, marks);
        if (stub) check_marking(test, marks);
    }
}

static void marks_are_told_in_a_byte_or_less_each(void **state)
{
    static const uint8_t errors[3][4] = { { 0, 0, 0, 0 }, { 9, 9, 9, 9 }, { 7, 0, 208, 40 } };
    static uint16_t parent[FF_NODE_HEIGHTS_MAX], source[FF_REFINED_HEIGHTS_MAX];

    (void)state;
    for (uint32_t i = 0; i < FF_REFINED_HEIGHTS_MAX; i++) source[i] = (uint16_t)(i * 40503u >> 5);
    for (uint32_t i = 0; i < 81; i++) parent[i] = source[2 * (i / 9) * 17 + 2 * (i % 9)];
    for (int codec = 0; codec < FF_CODEC_COUNT; codec++)
        for (int i = 0; i < 3; i++) {
            ff_terrain_info info = { .node_log2 = 3, .tile_log2 = 8, .codec = (uint8_t)codec };
            static payload_test test;
            test.info = &info;
            test.errors = errors[i];
            test.parent = NULL;
            check(&test, source);
            test.parent = parent;
            check(&test, source);
        }
}

/* The children of a leaf are those of a refinement without residuals, and their error is halved. */
static void below_leaves_all_is_prediction(void **state)
{
    static uint16_t parent[FF_NODE_HEIGHTS_MAX], made[FF_REFINED_HEIGHTS_MAX],
        slow[FF_REFINED_HEIGHTS_MAX];
    (void)state;
    for (uint8_t k = 1; k <= 5; k++)
        for (uint16_t max_error = 0; max_error < 40; max_error += 13) {
            ff_terrain_info info = {
                .node_log2 = k, .tile_log2 = 8, .codec = FF_CODEC_RICE, .max_error = max_error
            };
            uint8_t payload[1] = { 0 }; /* no error, no residual */
            uint32_t side = ff_node_side(&info);
            for (uint32_t i = 0; i < side * side; i++) parent[i] = (uint16_t)(i * 40503u);
            ff_predict_children(&info, (ff_cells){ 0 }, parent, made, codec_room);
            assert_int_equal(slow_decode(&info, parent, payload, sizeof payload, slow), 0);
            assert_memory_equal(made, slow, ff_refined_side(&info) * ff_refined_side(&info) * 2);
        }
    ff_terrain_info info = { .max_error = 0 };
    assert_int_equal(ff_geometric_error_below(&info, 0), 0);
    assert_int_equal(ff_geometric_error_below(&info, 1), 0);
    assert_int_equal(ff_geometric_error_below(&info, 31), 15);
    assert_int_equal(ff_geometric_error_below(&info, 208), 192);
    info.max_error = 10; /* nobody knows better */
    assert_int_equal(ff_geometric_error_below(&info, 31), 15);
    assert_int_equal(ff_geometric_error_below(&info, 15), 10);
    assert_int_equal(ff_geometric_error_below(&info, 7), 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(marks_are_told_in_a_byte_or_less_each),
                                        cmocka_unit_test(below_leaves_all_is_prediction) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
