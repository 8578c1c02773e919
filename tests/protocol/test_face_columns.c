/* Columns of a panorama's face: there and back, cut anywhere, nonsense. */
#include "../../protocol/message/ff_message.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <cmocka.h>

static void columns_there_and_back(void **state)
{
    static uint16_t top[1024], bottom[1024], top_again[1024], bottom_again[1024];
    uint32_t random = 7;

    (void)state;
    for (uint32_t run = 0; run < 300; run++) {
        uint32_t count = run % 3 ? 1024 : 16, rows = run % 2 ? 1024 : 1, wander = 512;
        uint8_t packed[4 * 1024 + 8];
        for (uint32_t c = 0; c < count; c++) {
            random = random * 1664525u + 1013904223u;
            /* noise, then skylines that get calmer */
            wander = run < 20
                         ? random >> 22
                         : (wander + (random >> 24) % (1 + 200 / run) + 1024 - 100 / run) % 1024;
            top[c] = (uint16_t)(wander % (rows + 1));
            bottom[c] = (uint16_t)(random >> 20 & 1 || top[c] > rows ? rows : top[c]);
        }
        int bytes = ff_face_columns_encode(top, bottom, count, packed, 4 * count + 8);
        assert_true(bytes > 0);
        assert_int_equal(
            ff_face_columns_decode(packed, (size_t)bytes, count, rows, top_again, bottom_again),
            FF_OK);
        assert_memory_equal(top, top_again, count * sizeof(*top));
        assert_memory_equal(bottom, bottom_again, count * sizeof(*bottom));
        for (int cut = 0; cut < bytes; cut++)
            assert_int_equal(
                ff_face_columns_decode(packed, (size_t)cut, count, rows, top_again, bottom_again),
                FF_ERR_TRUNCATED);
        assert_int_equal(
            ff_face_columns_decode(packed, (size_t)bytes + 1, count, rows, top_again, bottom_again),
            FF_ERR_RANGE);
        assert_int_equal(ff_face_columns_encode(top, bottom, count, packed, (size_t)bytes - 1),
                         FF_ERR_FULL);
    }
}

static void level_horizon_is_a_few_bytes(void **state)
{
    uint16_t top[1024], bottom[1024];
    uint8_t packed[4 * 1024 + 8];

    (void)state;
    for (uint32_t c = 0; c < 1024; c++) {
        top[c] = 0;
        bottom[c] = 300;
    }
    assert_in_range(ff_face_columns_encode(top, bottom, 1024, packed, sizeof(packed)), 1, 16);
    top[5] = 301;
    assert_int_equal(ff_face_columns_encode(top, bottom, 1024, packed, sizeof(packed)),
                     FF_ERR_RANGE);
}

static void assert_columns(const char *bytes, size_t count, int expected)
{
    uint16_t top[17] = { 0 }, bottom[17] = { 0 };

    top[16] = bottom[16] = 4711; /* only 16 columns are written: these must stay */
    assert_int_equal(ff_face_columns_decode((const uint8_t *)bytes, count, 16, 5, top, bottom),
                     expected);
    assert_int_equal(top[16], 4711);
    assert_int_equal(bottom[16], 4711);
}

static void bad_columns_are_refused(void **state)
{
    (void)state;
    assert_columns("\xfb\xfb", 2, FF_OK);            /* 16 times 0, twice */
    assert_columns("\xfb\x0c\x00", 3, FF_ERR_RANGE); /* a run of 17 */
    assert_columns("\xfb\x2a\xdb", 3, FF_ERR_RANGE); /* 5, then 6 */
    assert_columns("\xfb\xba\x0e", 3, FF_OK);        /* 5, then 15 times again */
    assert_columns("\xfb\x01\xeb", 3, FF_ERR_RANGE); /* -1 */
    assert_columns("\xfb\x0e", 2, FF_ERR_RANGE);     /* reserved */
    assert_columns("\xba\xbe\x0f", 3, FF_ERR_RANGE); /* top 5, bottom 0 */
    assert_columns("\xfb\xfb\x00", 3, FF_ERR_RANGE); /* left over */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_there_and_back),
        cmocka_unit_test(bad_columns_are_refused),
        cmocka_unit_test(level_horizon_is_a_few_bytes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
