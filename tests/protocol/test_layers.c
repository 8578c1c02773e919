/* Layers of images: their names and levels in lists, LAYER, and what a WELCOME tells of them. */
#include "../../protocol/message/ff_message.h"
#include "../rig/pack_fixture.h"
#include "../rig/slow_pack.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <string.h>

static const ff_layers three = { .count = 3,
                                 .name = { "", "relief", "night of 2024" },
                                 .levels = { { 5, 4 }, { 3, 0 }, { 0, 16 } } };

static uint32_t write_rows(const ff_layers *layers, unsigned grounds, uint8_t *bytes, size_t room)
{
    ff_writer out = { bytes, bytes + room, FF_OK };
    ff_layers_write(&out, layers, grounds);
    assert_int_equal(out.error, FF_OK);
    return (uint32_t)(out.at - bytes);
}

static void names_and_levels_come_back_to_both_readers(void **state)
{
    uint8_t bytes[FF_LAYERS_BYTES_MAX], levels[2];
    char name[32];
    ff_layers read;
    (void)state;
    uint32_t count = write_rows(&three, 2, bytes, sizeof bytes);
    static const uint8_t first[] = { 3, 0, 5, 4, 9, 6, 'r' };
    assert_memory_equal(bytes, first, sizeof first);
    assert_int_equal(ff_layers_read(bytes, count, 2, &read), FF_OK);
    assert_memory_equal(&read, &three, sizeof read);
    for (unsigned i = 0; i < 3; i++) {
        assert_int_equal(slow_layer(bytes, count, i, 2, name, levels), 0);
        assert_string_equal(name, three.name[i]);
        assert_memory_equal(levels, three.levels[i], 2);
        assert_int_equal(ff_layers_find(&read, three.name[i]), i);
    }
    assert_int_equal(ff_layers_find(&read, "nightly"), FF_ERR_NOT_FOUND);
    assert_int_equal(slow_layer(bytes, count, 3, 2, name, levels), -1);
}

static void what_more_a_row_has_is_passed_over(void **state)
{
    static const uint8_t rows[] = "\x05\x01"
                                  "a\x03zz\x03\x01"
                                  "b\x02";
    ff_layers read;
    (void)state;
    assert_int_equal(ff_layers_read(rows, sizeof rows - 1, 1, &read), FF_OK);
    assert_int_equal(read.count, 2);
    assert_string_equal(read.name[1], "b");
    assert_int_equal(read.levels[0][0], 3);
    assert_int_equal(read.levels[1][0], 2);
}

static void faults_are_errors(void **state)
{
    static const struct {
        const char *rows;
        uint32_t count;
        int error;
    } fault[] = {
        { "", 0, FF_ERR_RANGE },             /* no layer */
        { "\x03\x01", 2, FF_ERR_TRUNCATED }, /* a row too short */
        { "\x02\x01"
          "a",
          3, FF_ERR_TRUNCATED }, /* no levels */
        { "\x02\x05"
          "a",
          3, FF_ERR_TRUNCATED }, /* a name too long for its row */
        { "\x03\x01"
          "a\x11",
          4, FF_ERR_RANGE },                             /* 17 levels */
        { "\x03\x01\x07\x01", 4, FF_ERR_RANGE },         /* no text */
        { "\x02\x00\x01\x02\x00\x01", 6, FF_ERR_RANGE }, /* the second has no name */
        { "\x03\x01"
          "a\x01\x03\x01"
          "a\x01",
          8, FF_ERR_RANGE } /* twice the same */
    };
    ff_layers read;
    uint8_t nine[9 * 4];
    (void)state;
    for (size_t i = 0; i < sizeof fault / sizeof *fault; i++)
        assert_int_equal(ff_layers_read((const uint8_t *)fault[i].rows, fault[i].count, 1, &read),
                         fault[i].error);
    for (int i = 0; i < 9; i++) memcpy(nine + 4 * i, (uint8_t[]){ 3, 1, (uint8_t)('a' + i), 1 }, 4);
    assert_int_equal(ff_layers_read(nine, 8 * 4, 1, &read), FF_OK);
    assert_int_equal(ff_layers_read(nine, 9 * 4, 1, &read), FF_ERR_RANGE);
    assert_false(ff_layer_name_ok("a name of more than 31 bytes is one too long"));
}

static void a_layer_is_told_in_three_bytes(void **state)
{
    ff_message message = { .type = FF_MSG_LAYER, .u.layer = { 7 } }, read;
    uint8_t bytes[8];
    (void)state;
    assert_int_equal(ff_message_encode(&message, bytes, sizeof bytes), 3);
    assert_memory_equal(bytes, "\x0b\x01\x07", 3);
    assert_int_equal(ff_message_decode(bytes, 3, &read), 3);
    assert_int_equal(read.u.layer.layer, 7);
    bytes[2] = FF_LAYER_NONE + 1;
    assert_int_equal(ff_message_decode(bytes, 3, &read), FF_ERR_RANGE);
    message.u.layer.layer = FF_LAYER_NONE + 1;
    assert_int_equal(ff_message_encode(&message, bytes, sizeof bytes), FF_ERR_RANGE);
}

static ff_welcome welcome_with(const uint8_t *rows, uint32_t count, uint8_t *list, size_t room)
{
    ff_writer out = { list, list + room, FF_OK };
    ff_welcome welcome = { .version = FF_PROTOCOL_VERSION, .info = pack_fixture_info(6, 1, 1) };
    welcome.info.texture_log2 = 6;
    welcome.info.texture_levels = 4;
    if (count) ff_list_write(&out, FF_WELCOME_LAYERS, rows, count);
    welcome.more = (ff_list){ list, (uint32_t)(out.at - list) };
    return welcome;
}

static void a_welcome_tells_of_layers_or_there_is_one_without_a_name(void **state)
{
    uint8_t rows[FF_LAYERS_BYTES_MAX], list[FF_WELCOME_BYTES_MAX], bytes[FF_WELCOME_BYTES_MAX];
    ff_layers read;
    ff_message message = { .type = FF_MSG_WELCOME }, back;
    (void)state;
    ff_welcome welcome = welcome_with(NULL, 0, list, sizeof list);
    ff_welcome_layers(&welcome, &read);
    assert_int_equal(read.count, 1);
    assert_string_equal(read.name[0], "");
    assert_int_equal(read.levels[0][0], 4);
    uint32_t count = write_rows(&three, 1, rows, sizeof rows);
    message.u.welcome = welcome_with(rows, count, list, sizeof list);
    int encoded = ff_message_encode(&message, bytes, sizeof bytes);
    assert_int_equal(ff_message_decode(bytes, (size_t)encoded, &back), encoded);
    ff_welcome_layers(&back.u.welcome, &read);
    assert_int_equal(read.count, 3);
    assert_int_equal(read.levels[0][0], 4); /* the terrain's, whatever the row says */
    assert_int_equal(read.levels[1][0], 3);
    message.u.welcome = welcome_with(rows, count - 1, list, sizeof list);
    encoded = ff_message_encode(&message, bytes, sizeof bytes);
    if (encoded > 0) encoded = ff_message_decode(bytes, (size_t)encoded, &back);
    assert_true(encoded < 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_levels_come_back_to_both_readers),
        cmocka_unit_test(what_more_a_row_has_is_passed_over),
        cmocka_unit_test(faults_are_errors),
        cmocka_unit_test(a_layer_is_told_in_three_bytes),
        cmocka_unit_test(a_welcome_tells_of_layers_or_there_is_one_without_a_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
