/* What a pack says of itself, as lines in the letters of the small font. */
#include "../rig/client_fixture.h"
#include "../../sim/options/sim_about.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define MB ((size_t)1 << 20)

/* The lines of a pack of this name and attribution. */
static unsigned lines_of(const char *name, const char *attribution, unsigned columns,
                         unsigned lines, char *text, size_t room)
{
    client_rig rig;
    char said[400];
    int bytes = snprintf(said, sizeof said, "%c%c%s%c%c%s", FF_ABOUT_NAME, (int)strlen(name), name,
                         FF_ABOUT_ATTRIBUTION, (int)strlen(attribution), attribution);
    assert_true(strlen(name) < 128 && strlen(attribution) < 128);
    rig_open(&rig, 0);
    rig_use_about(&rig, (ff_list){ (const uint8_t *)said, (uint32_t)bytes });
    rig.desc.about = SIM_ABOUT_SHOWN;
    rig_local_client(&rig, 2 * MB);
    unsigned made = sim_about_lines(rig.client, columns, lines, text, room);
    rig_close(&rig);
    return made;
}

static void names_and_attributions_can_be_read(void **state)
{
    (void)state;
    char text[400];
    assert_int_equal(lines_of("H\u00f6hen \u2013 Z\u00fcrich",
                              "\u00a9 A \u2014 \u201cB\u201d & C\u2019s; \u5c71", 60, 4, text,
                              sizeof text),
                     2);
    assert_string_equal(text, "Hohen - Zurich\n(c) A - \"B\" & C's; ?\n");
}

static void lines_end_at_words_and_are_counted(void **state)
{
    (void)state;
    char text[400];
    assert_int_equal(lines_of("Hills", "one two three four", 8, 4, text, sizeof text), 4);
    assert_string_equal(text, "Hills\none two\nthree\nfour\n");
    assert_int_equal(lines_of("Hills", "one two three four", 8, 2, text, sizeof text), 2);
    assert_string_equal(text, "Hills\none two\n");
    assert_int_equal(lines_of("Hills", "abcdefghij", 8, 4, text, sizeof text), 3);
    assert_string_equal(text, "Hills\nabcdefgh\nij\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_attributions_can_be_read),
        cmocka_unit_test(lines_end_at_words_and_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
