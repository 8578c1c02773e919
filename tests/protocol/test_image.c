/* A node's image as it is stored: a byte may stand before its JPEG, and the nearest image above
 * stands for one that is not there. */
#include "../../protocol/ff_image.h"
#include "../../platform/sys.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void a_byte_before_the_jpeg_says_which_children_have_none(void **state)
{
    (void)state;
    for (int first = 0; first < 256; first++) {
        uint8_t bytes[3] = { (uint8_t)first, 75, 0xAB };
        int is_mark = first > 128 && first < 144;
        ff_image image;
        assert_int_equal(ff_image_read(bytes, sizeof bytes, &image), FF_OK);
        assert_ptr_equal(image.coded, bytes + is_mark);
        assert_int_equal(image.coded_bytes, sizeof bytes - (size_t)is_mark);
        assert_int_equal(image.bare, is_mark ? first - 128 : 0);
        assert_int_equal(ff_image_read(bytes, 1, &image), is_mark ? FF_ERR_TRUNCATED : FF_OK);
        assert_int_equal(ff_image_read(bytes, 0, &image), FF_ERR_TRUNCATED);
    }
}

static void colour(void *context, int64_t x_wu, int64_t y_wu, uint8_t rgb[3])
{
    (void)context;
    rgb[0] = (uint8_t)(x_wu >> 12);
    rgb[1] = (uint8_t)(y_wu >> 12);
    rgb[2] = 90;
}

static void the_nearest_image_above_stands_for_one_that_is_not_there(void **state)
{
    (void)state;
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 1, 1),
                               .height = pack_fixture_hills,
                               .colour = colour,
                               .bare_level = 1 };
    desc.info.texture_log2 = 4;
    desc.info.texture_levels = 4;
    size_t bytes;
    uint8_t *file = pack_fixture_make(&desc, &bytes), rgb[3 * 16 * 16];
    ff_pack pack;
    assert_non_null(file);
    assert_int_equal(ff_pack_open(&pack, file, bytes), FF_OK);
    for (uint32_t level = 0; level < 5; level++)
        for (uint32_t code = 0; code >> 2 * level == 0; code++) {
            ff_key key = ff_key_make(0, level, code), found = key;
            const uint8_t *payload;
            ff_image image = { 0 };
            int count = ff_pack_image(&pack, 0, &found, &payload);
            assert_true(count > 0);
            assert_int_equal(ff_key_level(found), level < 1 ? level : 1);
            assert_int_equal(ff_key_code(found), level < 1 ? code : code >> 2 * (level - 1));
            assert_int_equal(ff_image_read(payload, (size_t)count, &image), FF_OK);
            assert_int_equal(image.bare, ff_key_level(found) == 1 ? 15 : 0);
            assert_int_equal(sys_jpeg_decode(image.coded, image.coded_bytes, 16, 16, rgb), FF_OK);
        }
    free(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_byte_before_the_jpeg_says_which_children_have_none),
        cmocka_unit_test(the_nearest_image_above_stands_for_one_that_is_not_there)
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
