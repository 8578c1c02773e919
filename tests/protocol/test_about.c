/* Lists keep their form, and what a pack says of itself is text that can be shown; of several packs
 * each word once. */
#include "../../protocol/ff_about.h"
#include "../../protocol/ff_error.h"
#include "../rig/slow_pack.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define LIST(text) ((ff_list){ (const uint8_t *)(text), sizeof(text) - 1 })

static int checked(ff_list list)
{
    uint8_t *exact = malloc(list.byte_count + 1);
    memcpy(exact, list.bytes, list.byte_count);
    int rc = ff_about_check((ff_list){ exact, list.byte_count });
    free(exact);
    return rc;
}

static void entries_are_found_and_unknown_ones_passed_over(void **state)
{
    ff_list list = LIST("\1\1a\2\2bc\x63\3xyz\xff\0");
    const uint8_t *value;

    (void)state;
    assert_int_equal(checked(list), FF_OK);
    assert_int_equal(ff_list_find(list, 2, &value), 2);
    assert_memory_equal(value, "bc", 2);
    assert_int_equal(ff_list_find(list, 99, &value), 3);
    assert_int_equal(ff_list_find(list, 255, &value), 0);
    assert_int_equal(ff_list_find(list, 3, &value), FF_ERR_NOT_FOUND);
    assert_int_equal(slow_list_find(list.bytes, list.byte_count, 99, &value), 3);
    assert_int_equal(checked((ff_list){ list.bytes, 0 }), FF_OK);
}

static void faults_of_form_are_refused(void **state)
{
    const struct {
        ff_list list;
        int expected;
    } row[] = {
        { LIST("\1"), FF_ERR_TRUNCATED },      /* no length */
        { LIST("\1\2a"), FF_ERR_TRUNCATED },   /* too short */
        { LIST("\1\1a\2"), FF_ERR_TRUNCATED }, /* the last one */
        { LIST("\1\1a\1\1b"), FF_ERR_RANGE },  /* twice */
        { LIST("\2\1a\1\1b"), FF_ERR_RANGE },  /* falling */
        { LIST("\0\1a"), FF_ERR_RANGE },       /* no type */
        { LIST("\1\x81\0a"), FF_ERR_RANGE },   /* a length longer than it need be */
        { LIST("\1\0"), FF_ERR_RANGE },        /* an empty name */
        { LIST("\7\3abc"), FF_ERR_RANGE },     /* half a projection */
        { LIST("\1\xff\xff\xff\xff\xff\1"), FF_ERR_RANGE },
        { LIST("\1\xff\xff\xff\xff\x0f"), FF_ERR_TRUNCATED },
    };

    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        assert_int_equal(checked(row[i].list), row[i].expected);
}

static void values_are_bounded(void **state)
{
    uint8_t bytes[FF_ABOUT_BYTES_MAX + 64];

    (void)state;
    memset(bytes, 'a', sizeof bytes);
    bytes[0] = FF_ABOUT_NAME;
    bytes[1] = 100;
    assert_int_equal(checked((ff_list){ bytes, 102 }), FF_OK);
    bytes[1] = 101;
    assert_int_equal(checked((ff_list){ bytes, 103 }), FF_ERR_RANGE);
    bytes[0] = 77; /* of an unknown type all that the list can hold */
    bytes[1] = 0x80 | ((FF_ABOUT_BYTES_MAX - 3) & 127);
    bytes[2] = (FF_ABOUT_BYTES_MAX - 3) >> 7;
    assert_int_equal(checked((ff_list){ bytes, FF_ABOUT_BYTES_MAX }), FF_OK);
    bytes[1]++;
    assert_int_equal(checked((ff_list){ bytes, FF_ABOUT_BYTES_MAX + 1 }), FF_ERR_RANGE);
}

static void only_text_that_can_be_shown_is_text(void **state)
{
    static const char *const good[] = {
        "H\xc3\xbcgel",     "\xe5\xb1\xb1", "\xf0\x9f\x8f\x94", "", "\xc2\xa9 2026",
        "\xf4\x8f\xbf\xbf", "a\"\\"
    };
    static const char *const bad[] = { "\x1b[2J",
                                       "a\nb",
                                       "a\x7f",
                                       "\x80",
                                       "\xc3",
                                       "\xc3(",
                                       "\xc0\xaf",
                                       "\xe0\x80\xaf",
                                       "\xed\xa0\x80",     /* half a pair */
                                       "\xf4\x90\x80\x80", /* beyond the last */
                                       "\xff",
                                       "\xc2\x85",     /* next line */
                                       "\xe2\x80\xae", /* from right to left */
                                       "\xe2\x81\xa6",
                                       "\xe2\x80\xa8",
                                       "\xf8\x88\x80\x80\x80" };

    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        assert_int_equal(ff_about_is_text((const uint8_t *)good[i], (uint32_t)strlen(good[i])), 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(ff_about_is_text((const uint8_t *)bad[i], (uint32_t)strlen(bad[i])), 0);
    assert_int_equal(ff_about_is_text((const uint8_t *)"a\0b", 3), 0);
    assert_int_equal(checked(LIST("\1\2\xc3\x28")), FF_ERR_RANGE);
    assert_int_equal(checked(LIST("\x63\2\xc3\x28")), FF_OK); /* who knows what that is */
}

static void who_asks_gets_what_was_asked_for(void **state)
{
    ff_list all = LIST("\1\1a\2\2bc\3\1d\x20\1q\x63\3xyz");
    uint8_t out[64];

    (void)state;
    assert_int_equal(ff_about_select(all, FF_ABOUT_BIT(1) | FF_ABOUT_BIT(3), out, sizeof out), 6);
    assert_memory_equal(out, "\1\1a\3\1d", 6);
    assert_int_equal(ff_about_select(all, UINT32_MAX, out, sizeof out), all.byte_count - 5);
    assert_int_equal(ff_about_select(all, 0, out, sizeof out), 0);
    assert_int_equal(ff_about_select(all, FF_ABOUT_KNOWN, out, 5), FF_ERR_FULL);
    assert_int_equal(ff_about_bytes_max(FF_ABOUT_BIT(1) | FF_ABOUT_BIT(2)), 508);
    assert_in_range(ff_about_bytes_max(FF_ABOUT_KNOWN), 508, FF_ABOUT_BYTES_MAX);
}

static void numbers_of_a_projection_come_back(void **state)
{
    uint8_t bytes[64];
    ff_writer out = { bytes, bytes + sizeof bytes, FF_OK };
    uint8_t value[46];
    ff_writer numbers = { value, value + sizeof value, FF_OK };
    ff_about_projection projection;
    int64_t parameter;

    (void)state;
    ff_write_bytes(&numbers, 9807, 2);
    ff_write_bytes(&numbers, 6378137000000, 8);
    ff_write_bytes(&numbers, 298257223563, 8);
    ff_write_bytes(&numbers, (uint64_t)-17666666667, 8);
    ff_write_bytes(&numbers, 8802, 2);
    ff_write_bytes(&numbers, (uint64_t)-105000000000, 8);
    ff_write_bytes(&numbers, 8805, 2);
    ff_write_bytes(&numbers, 999600000000, 8);
    ff_list_write(&out, FF_ABOUT_PROJECTION, value, sizeof value);
    ff_list list = { bytes, (uint32_t)(out.at - bytes) };
    assert_int_equal(ff_about_check(list), FF_OK);
    assert_int_equal(ff_about_get_projection(list, &projection), FF_OK);
    assert_int_equal(projection.method, 9807);
    assert_true(projection.semi_major_um == 6378137000000 &&
                projection.inverse_flattening == 298257223563 &&
                projection.prime_meridian == -17666666667);
    assert_int_equal(projection.parameter_count, 2);
    assert_int_equal(ff_about_parameter(&projection, 0, &parameter), 8802);
    assert_true(parameter == -105000000000);
    assert_int_equal(ff_about_parameter(&projection, 1, &parameter), 8805);
    assert_true(parameter == 999600000000);
    list.byte_count -= 5;
    bytes[1] -= 5; /* half a parameter */
    assert_int_equal(ff_about_check(list), FF_ERR_RANGE);
    assert_int_equal(ff_about_get_projection(LIST("\1\1a"), &projection), FF_ERR_NOT_FOUND);
}

static uint32_t add(char *text, uint32_t room, const char *from)
{
    uint32_t bytes = ff_about_add_words((uint8_t *)text, (uint32_t)strlen(text), room,
                                        (const uint8_t *)from, (uint32_t)strlen(from));
    text[bytes] = 0;
    return bytes;
}

static void words_of_several_texts_come_once(void **state)
{
    char text[64] = "";
    (void)state;
    assert_int_equal(add(text, 30, "Alpha"), 5);
    add(text, 30, "Beta; Alpha; ");
    add(text, 30, "Al; Alpha;Beta");
    assert_string_equal(text, "Alpha; Beta; Al; Alpha;Beta");
    add(text, 30, "Gamma; G; ; Beta; H"); /* the first word has no room, the second one just has */
    assert_string_equal(text, "Alpha; Beta; Al; Alpha;Beta; G");
    assert_int_equal(add(text, 30, "Beta"), 30);
    assert_int_equal(add(text, 30, ""), 30);
}

static void a_part_says_of_which_whole_it_is(void **state)
{
    ff_list plain = LIST("\1\1a\x63\3xyz"), last = LIST("\1\1a"),
            told = LIST("\1\1a\x08\4\1\2\3\4\x63\3xyz");
    uint8_t out[14];
    (void)state;
    assert_int_equal(ff_about_put_whole(plain, 0x04030201, out, sizeof out), 14);
    assert_memory_equal(out, told.bytes, 14);
    assert_int_equal(ff_about_check((ff_list){ out, 14 }), FF_OK);
    assert_int_equal(ff_about_whole((ff_list){ out, 14 }, 7), 0x04030201);
    assert_int_equal(ff_about_put_whole(told, 5, out, sizeof out), 14);
    assert_int_equal(ff_about_whole((ff_list){ out, 14 }, 7), 5);
    assert_int_equal(ff_about_put_whole(last, 5, out, sizeof out), 9);
    assert_int_equal(ff_about_whole((ff_list){ out, 9 }, 7), 5);
    assert_int_equal(ff_about_put_whole(plain, 5, out, 13), FF_ERR_FULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(entries_are_found_and_unknown_ones_passed_over),
        cmocka_unit_test(faults_of_form_are_refused),
        cmocka_unit_test(values_are_bounded),
        cmocka_unit_test(only_text_that_can_be_shown_is_text),
        cmocka_unit_test(who_asks_gets_what_was_asked_for),
        cmocka_unit_test(numbers_of_a_projection_come_back),
        cmocka_unit_test(words_of_several_texts_come_once),
        cmocka_unit_test(a_part_says_of_which_whole_it_is),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
