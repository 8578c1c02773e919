/* A node's image as it is stored: bytes may stand before what is coded, and the nearest image above
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
        int is_bare = first > 128 && first<144, is_open = first> 144 && first < 159,
            is_mark = is_bare || is_open;
        ff_image image;
        if (first == 159) continue;
        assert_int_equal(ff_image_read(bytes, sizeof bytes, &image), FF_OK);
        assert_ptr_equal(image.coded, bytes + is_mark);
        assert_int_equal(image.coded_bytes, sizeof bytes - (size_t)is_mark);
        assert_int_equal(image.marks.bare, is_bare ? first - 128 : 0);
        assert_int_equal(image.marks.open, is_open ? first - 144 : 0);
        assert_int_equal(ff_image_read(bytes, 1, &image), is_mark ? FF_ERR_TRUNCATED : FF_OK);
        assert_int_equal(ff_image_read(bytes, 0, &image), FF_ERR_TRUNCATED);
    }
}

static void what_stands_before_an_image_is_read_as_it_was_put(void **state)
{
    (void)state;
    for (unsigned bare = 0; bare < 16; bare++)
        for (unsigned open = 0; open < 15; open++) {
            uint8_t bytes[FF_IMAGE_MARKS_BYTES + 1];
            const ff_image_marks marks = { bare & 15u, open & 15u };
            ff_image image;
            size_t before = ff_image_put_marks(marks, bytes);
            bytes[before] = 75;
            int rc = ff_image_read(bytes, before + 1, &image);
            if (bare & open) {
                assert_int_equal(rc, FF_ERR_FORMAT); /* a child is one or the other */
                continue;
            }
            assert_int_equal(rc, FF_OK);
            assert_int_equal(image.coded_bytes, 1);
            assert_int_equal(image.marks.bare, bare);
            assert_int_equal(image.marks.open, open);
            for (unsigned q = 0; q < 4; q++)
                assert_int_equal(ff_image_ends(marks, q), (bare | open) >> q & 1);
        }
}

static void an_open_root_is_a_mark_and_nothing_else(void **state)
{
    (void)state;
    uint8_t bytes[3] = { 144 + 15, 75, 0xAB };
    ff_image image;
    assert_int_equal(ff_image_read(bytes, 1, &image), FF_OK);
    assert_int_equal(image.coded_bytes, 0);
    assert_int_equal(image.marks.open, 15);
    assert_int_equal(ff_image_read(bytes, 2, &image), FF_ERR_FORMAT);
    bytes[0] = 128 + 1;
    bytes[1] = 144 + 15;
    assert_int_equal(ff_image_read(bytes, 2, &image), FF_ERR_FORMAT);
    bytes[0] = 144 + 2; /* the other way round: no coded byte is like that, but nobody looks */
    bytes[1] = 128 + 1;
    assert_int_equal(ff_image_read(bytes, 2, &image), FF_OK);
    assert_int_equal(image.marks.bare, 0);
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
            assert_int_equal(image.marks.bare, ff_key_level(found) == 1 ? 15 : 0);
            assert_int_equal(sys_jpeg_decode(image.coded, image.coded_bytes, 16, 16, rgb), FF_OK);
        }
    free(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_byte_before_the_jpeg_says_which_children_have_none),
        cmocka_unit_test(what_stands_before_an_image_is_read_as_it_was_put),
        cmocka_unit_test(an_open_root_is_a_mark_and_nothing_else),
        cmocka_unit_test(the_nearest_image_above_stands_for_one_that_is_not_there)
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
