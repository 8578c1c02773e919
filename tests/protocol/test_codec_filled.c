/* Payloads tell which children hold filled ground: both decoders say the same, whatever the codec.
 */
#include "../../protocol/codec/ff_codec.h"
#include "../rig/slow_decoder.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

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

/* A mark costs one byte beside the error codes, two where those would take none; none costs
 * nothing. */
static void check(const ff_terrain_info *info, const uint16_t *parent, const uint16_t *source,
                  const uint8_t errors[4])
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX], taken[FF_REFINED_HEIGHTS_MAX];
    static uint16_t decoded[FF_REFINED_HEIGHTS_MAX], slow[FF_REFINED_HEIGHTS_MAX];
    static uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    ff_residuals res = { .value = value }, out = { .value = taken };
    int unmarked = 0;
    memcpy(res.child_error, errors, 4);
    ff_encode_heights(info, parent, source, &res, decoded);
    for (uint8_t filled = 0; filled < (parent ? 16 : 2); filled++) {
        res.filled = filled;
        int bytes = ff_encode_payload(info, parent, decoded, &res, payload);
        if (!filled) unmarked = bytes;
        assert_in_range(bytes - unmarked, filled ? 1 : 0, filled ? 2 : 0);
        assert_int_equal(decode(info, !parent, payload, bytes, &out), FF_OK);
        assert_int_equal(out.filled, filled);
        assert_memory_equal(out.child_error, errors, parent ? 4 : 1);
        assert_int_equal(slow_decode(info, parent, payload, (size_t)bytes, slow), filled);
        if (!filled) continue;
        uint8_t *mark = payload + (info->codec != FF_CODEC_RAW);
        assert_int_equal(*mark, 240 + filled);
        *mark = 240; /* a mark of nothing */
        assert_true(decode(info, !parent, payload, bytes, &out) < 0);
        assert_int_equal(slow_decode(info, parent, payload, (size_t)bytes, slow), -1);
        *mark = 242; /* a root has no second child */
        assert_int_equal(decode(info, !parent, payload, bytes, &out) == FF_OK, parent != NULL);
        assert_int_equal(slow_decode(info, parent, payload, (size_t)bytes, slow), parent ? 2 : -1);
    }
}

static void filled_ground_is_told_in_a_byte(void **state)
{
    static const uint8_t errors[3][4] = { { 0, 0, 0, 0 }, { 9, 9, 9, 9 }, { 7, 0, 208, 40 } };
    static uint16_t parent[FF_NODE_HEIGHTS_MAX], source[FF_REFINED_HEIGHTS_MAX];

    (void)state;
    for (uint32_t i = 0; i < FF_REFINED_HEIGHTS_MAX; i++) source[i] = (uint16_t)(i * 40503u >> 5);
    for (uint32_t i = 0; i < 81; i++) parent[i] = source[2 * (i / 9) * 17 + 2 * (i % 9)];
    for (int codec = 0; codec < FF_CODEC_COUNT; codec++)
        for (int i = 0; i < 3; i++) {
            ff_terrain_info info = { .node_log2 = 3, .tile_log2 = 8, .codec = (uint8_t)codec };
            check(&info, NULL, source, errors[i]);
            check(&info, parent, source, errors[i]);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(filled_ground_is_told_in_a_byte) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
