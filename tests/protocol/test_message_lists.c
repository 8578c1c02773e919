/* Messages that are lists, CAPS, WELCOME and ABOUT: unknown entries pass, faults of form do not. */
#include "../../protocol/ff_bytes.h"
#include "../../protocol/message/ff_message.h"
#include "../rig/slow_pack.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define LIST(text)                                \
    {                                             \
        (const uint8_t *)(text), sizeof(text) - 1 \
    }

static const ff_terrain_info terrain = { .node_log2 = 3,
                                         .tile_log2 = 6,
                                         .tiles_x = 1,
                                         .tiles_y = 1,
                                         .samples_x = 65,
                                         .samples_y = 65,
                                         .spacing_wu = 256,
                                         .hscale_q24 = 1 << 24 };

/* What decoding answers to a message of this type with this list as its body; exact room, so that
 * reading beyond its end is seen. */
static int decode(unsigned type, ff_list list, ff_message *out)
{
    size_t head = list.byte_count < 128 ? 2 : 3;
    static uint8_t *bytes;
    free(bytes);
    bytes = malloc(head + list.byte_count);
    bytes[0] = (uint8_t)type;
    bytes[1] = (uint8_t)(head == 2 ? list.byte_count : (list.byte_count & 127) | 128);
    bytes[head - 1] = (uint8_t)(head == 2 ? list.byte_count : list.byte_count >> 7);
    memcpy(bytes + head, list.bytes, list.byte_count);
    int rc = ff_message_decode(bytes, head + list.byte_count, out);
    if (rc > 0) assert_int_equal(rc, head + list.byte_count);
    return rc;
}

static void unknown_entries_pass(void **state)
{
    ff_message out;
    const uint8_t *value, *other;
    ff_list list = LIST("\3\2ok\6\4\1\0\0\0\x70\3new\xff\0");

    (void)state;
    assert_true(decode(FF_MSG_CAPS, list, &out) > 0);
    assert_int_equal(ff_list_find(out.u.list, FF_CAPS_TOKEN, &value), 2);
    assert_memory_equal(value, "ok", 2);
    assert_int_equal(ff_list_find(out.u.list, FF_CAPS_SCREEN, &value), FF_ERR_NOT_FOUND);
    assert_int_equal(ff_list_find(out.u.list, FF_CAPS_FEATURES, &value), 4);
    assert_int_equal(slow_list_find(out.u.list.bytes, out.u.list.byte_count, 6, &other), 4);
    assert_ptr_equal(value, other);
    assert_true(decode(FF_MSG_ABOUT, (ff_list)LIST("\1\1a\x64\2\0\0"), &out) > 0);
}

static void faults_of_form_are_errors(void **state)
{
    const struct {
        ff_list list;
        int expected;
    } row[] = {
        { LIST("\2"), FF_ERR_TRUNCATED },
        { LIST("\2\5abc"), FF_ERR_TRUNCATED },
        { LIST("\2\1a\2\1b"), FF_ERR_RANGE },             /* twice */
        { LIST("\3\1a\2\1b"), FF_ERR_RANGE },             /* falling */
        { LIST("\0\1a"), FF_ERR_RANGE },                  /* no type */
        { LIST("\2\x81\0a"), FF_ERR_RANGE },              /* a length longer than it need be */
        { LIST("\4\3\0\1\0"), FF_ERR_RANGE },             /* a screen of three bytes */
        { LIST("\4\5\0\1\0\1\0"), FF_ERR_RANGE },         /* of five */
        { LIST("\1\0"), FF_ERR_RANGE },                   /* no codec */
        { LIST("\5\4\0\1\0\1"), FF_ERR_RANGE },           /* half the budgets */
        { LIST("\1\21ABCDEFGHIJKLMNOPQ"), FF_ERR_RANGE }, /* 17 codecs */
        { LIST("\7\3\0\1\0"), FF_ERR_RANGE },             /* a reach of three bytes */
    };
    ff_message out;

    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        uint8_t room[64];
        ff_message message = { .type = FF_MSG_CAPS, .u.list = row[i].list };
        assert_int_equal(decode(FF_MSG_CAPS, row[i].list, &out), row[i].expected);
        assert_int_equal(ff_message_encode(&message, room, sizeof room), FF_ERR_RANGE);
    }
    assert_int_equal(decode(FF_MSG_ABOUT, (ff_list)LIST("\1\1\x1b"), &out), FF_ERR_RANGE);
    assert_int_equal(decode(FF_MSG_ABOUT, (ff_list)LIST("\1\2\xc3\x28"), &out), FF_ERR_RANGE);
    assert_int_equal(decode(FF_MSG_ABOUT, (ff_list)LIST("\2\1a\1\1b"), &out), FF_ERR_RANGE);
}

static void lists_are_bounded(void **state)
{
    uint8_t bytes[FF_CAPS_BYTES_MAX + 1] = { 200, ((FF_CAPS_BYTES_MAX - 3) & 127) | 128,
                                             (FF_CAPS_BYTES_MAX - 3) >> 7 };
    ff_message out;

    (void)state;
    assert_true(decode(FF_MSG_CAPS, (ff_list){ bytes, FF_CAPS_BYTES_MAX }, &out) > 0);
    bytes[1]++;
    assert_int_equal(decode(FF_MSG_CAPS, (ff_list){ bytes, FF_CAPS_BYTES_MAX + 1 }, &out),
                     FF_ERR_RANGE);
}

static void welcome_needs_its_terrain(void **state)
{
    uint8_t bytes[256];
    ff_message message = { .type = FF_MSG_WELCOME,
                           .u.welcome = { FF_PROTOCOL_VERSION, terrain, LIST("\3\2\0\1") } },
               out;
    const uint8_t *value;

    (void)state;
    int count = ff_message_encode(&message, bytes, sizeof bytes);
    assert_int_equal(count, 2 + 1 + 2 + 9 + 8 + 4);
    assert_int_equal(ff_message_decode(bytes, (size_t)count, &out), count);
    assert_int_equal(out.u.welcome.info.samples_x, 65);
    assert_int_equal(ff_list_find(out.u.welcome.more, FF_WELCOME_REQUESTS, &value), 2);
    /* as the specification has it: version, then the list */
    assert_int_equal(slow_list_find(bytes + 3, (size_t)count - 3, 1, &value), 9 + 8);
    assert_ptr_equal(value, bytes + 5);
    assert_int_equal(slow_list_find(bytes + 3, (size_t)count - 3, 3, &value), 2);
    bytes[3] = 2; /* another type */
    assert_int_equal(ff_message_decode(bytes, (size_t)count, &out), FF_ERR_RANGE);
    bytes[3] = 1;
    bytes[14] = 99; /* no such terrain */
    assert_int_equal(ff_message_decode(bytes, (size_t)count, &out), FF_ERR_RANGE);
    assert_int_equal(ff_message_decode((const uint8_t *)"\x41\1\x0b", 3, &out), FF_ERR_RANGE);
    assert_int_equal(ff_message_decode((const uint8_t *)"\x41\3\x0b\1\0", 5, &out), FF_ERR_RANGE);
}

/* What a terrain entry of these bytes is read as. */
static int read_terrain(const uint8_t *value, unsigned count, ff_terrain_info *info)
{
    uint8_t bytes[128] = { 1, (uint8_t)count };
    ff_message out;
    memcpy(bytes + 2, value, count);
    uint8_t whole[160] = { 65, (uint8_t)(count + 3), FF_PROTOCOL_VERSION };
    memcpy(whole + 3, bytes, count + 2);
    int rc = ff_message_decode(whole, count + 5, &out);
    if (rc > 0) *info = out.u.welcome.info;
    return rc;
}

/* Our reader and the one written from the specification agree on whatever comes. */
static void a_terrain_travels_without_its_zeros(void **state)
{
    ff_message message = { .type = FF_MSG_WELCOME,
                           .u.welcome = { FF_PROTOCOL_VERSION, terrain, LIST("") } };
    uint8_t bytes[256], plain[68], expected[68];
    ff_terrain_info info;

    (void)state;
    message.u.welcome.info.checksum = 0xFF01FF02;
    message.u.welcome.info.hoffset_wu = -1;
    int count = ff_message_encode(&message, bytes, sizeof bytes) - 5;
    assert_int_equal(count, 9 + 8 + 8);
    for (int bit = -1; bit < 8 * count; bit++) {
        if (bit >= 0) bytes[5 + bit / 8] ^= (uint8_t)(1u << bit % 8);
        int slow = slow_terrain(bytes + 5, (size_t)count, plain),
            rc = read_terrain(bytes + 5, (unsigned)count, &info);
        assert_true(slow == 0 || rc < 0);
        if (rc > 0) {
            ff_writer out = { expected, expected + sizeof expected, FF_OK };
            ff_write_terrain(&out, &info);
            assert_memory_equal(plain, expected, sizeof plain);
        }
        if (bit == -1) assert_true(rc > 0);
        if (bit >= 0) bytes[5 + bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    for (int other = 0; other <= count + 1; other++)
        assert_int_equal(read_terrain(bytes + 5, (unsigned)other, &info) > 0, other == count);
    bytes[5 + 8] |= 0x10; /* a byte that there is not */
    bytes[5 + count] = 1;
    assert_int_equal(read_terrain(bytes + 5, (unsigned)count + 1, &info), FF_ERR_RANGE);
}

static void a_client_that_needs_nothing_says_two_bytes(void **state)
{
    uint8_t bytes[8];

    (void)state;
    assert_int_equal(ff_message_encode(&(ff_message){ .type = FF_MSG_CAPS }, bytes, sizeof bytes),
                     2);
    assert_int_equal(
        ff_message_encode(&(ff_message){ .type = FF_MSG_GET_ABOUT, .u.get_about = { 3 } }, bytes,
                          sizeof bytes),
        3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unknown_entries_pass),
        cmocka_unit_test(faults_of_form_are_errors),
        cmocka_unit_test(lists_are_bounded),
        cmocka_unit_test(welcome_needs_its_terrain),
        cmocka_unit_test(a_terrain_travels_without_its_zeros),
        cmocka_unit_test(a_client_that_needs_nothing_says_two_bytes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
