/* What a server of several packs says of them: each word once, the rest of the first that tells it.
 */
#include "../../server/packs/ff_packs.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
/* after the four above: */
#include <cmocka.h>

#define WKT "\6\3WKT"
#define PROJECTION \
    "\7\x1a"       \
    "abcdefghijklmnopqrstuvwxyz"

static uint8_t *bytes[3];
static ff_pack pack[3];

static int setup(void **state)
{
    static const char *const said[3] = { "\1\4Alps\2\3One" PROJECTION "\x08\4sum1",
                                         "\1\4Alps\2\x0cTwo; One; On\3\3CC0" WKT,
                                         "\1\4Jura\2\3Two\6\5other\x63\1x" };
    (void)state;
    for (int i = 0; i < 3; i++) {
        size_t size;
        pack_fixture_desc desc = { .info = pack_fixture_info(4, 1, 1),
                                   .height = pack_fixture_hills,
                                   .about = { (const uint8_t *)said[i],
                                              (uint32_t)strlen(said[i]) } };
        bytes[i] = pack_fixture_make(&desc, &size);
        if (!bytes[i] || ff_pack_open(&pack[i], bytes[i], size) != FF_OK) return 1;
    }
    return 0;
}

static int teardown(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) free(bytes[i]);
    return 0;
}

static void assert_told(const char *expected)
{
    uint8_t room[FF_ABOUT_BYTES_MAX];
    ff_list told = ff_packs_about(&pack[0], room);
    assert_int_equal(told.byte_count, strlen(expected));
    assert_memory_equal(told.bytes, expected, told.byte_count);
    assert_int_equal(ff_about_check(told), FF_OK);
}

static void one_pack_is_told_as_it_is(void **state)
{
    (void)state;
    pack[0].next = NULL;
    assert_told("\1\4Alps\2\3One" PROJECTION "\x08\4sum1");
}

static void several_are_told_with_each_word_once(void **state)
{
    (void)state;
    pack[0].next = &pack[1];
    pack[1].next = &pack[2];
    pack[2].next = NULL;
    assert_told("\1\x0a"
                "Alps; Jura\2\x0cOne; Two; On\3\3CC0" WKT PROJECTION);
}

static void a_damaged_one_is_passed_over(void **state)
{
    (void)state;
    pack[0].next = &pack[1];
    pack[1].next = NULL;
    bytes[1][pack[1].header.about.data_offset + 3] ^= 1;
    assert_told("\1\4Alps\2\3One" PROJECTION);
    bytes[1][pack[1].header.about.data_offset + 3] ^= 1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_pack_is_told_as_it_is),
        cmocka_unit_test(several_are_told_with_each_word_once),
        cmocka_unit_test(a_damaged_one_is_passed_over),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
