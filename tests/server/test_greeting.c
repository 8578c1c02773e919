/* How a session opens: HELLO, CAPS, WELCOME; and what it tells of its pack. */
#include "../rig/pack_fixture.h"
#include "../../server/session/ff_session.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const uint8_t said[] = "\1\5Hills\2\6nobody\3\2CC";
static ff_pack pack;
static uint8_t *pack_bytes;

static int open_pack(void **state)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(5, 1, 1),
                               .height = pack_fixture_hills,
                               .about = { said, sizeof said - 1 } };
    size_t size;
    (void)state;
    pack_bytes = pack_fixture_make(&desc, &size);
    return !pack_bytes || ff_pack_open(&pack, pack_bytes, size) != FF_OK;
}

static int close_pack(void **state)
{
    (void)state;
    free(pack_bytes);
    return 0;
}

static ff_session *session_new(void)
{
    ff_session *session = ff_session_create(&(ff_session_desc){ .pack = &pack });
    assert_non_null(session);
    return session;
}

static int tell(ff_session *session, const ff_message *message)
{
    uint8_t bytes[FF_CAPS_BYTES_MAX + FF_MESSAGE_HEADER_MAX];
    int count = ff_message_encode(message, bytes, sizeof bytes);
    assert_true(count > 0);
    return ff_session_receive(session, bytes, (size_t)count, 0);
}

static int hello(ff_session *session, uint32_t version)
{
    return tell(session, &(ff_message){ .type = FF_MSG_HELLO, .u.hello = { version, 0 } });
}

static int caps(ff_session *session, const char *bytes, uint32_t count)
{
    return tell(session,
                &(ff_message){ .type = FF_MSG_CAPS, .u.list = { (const uint8_t *)bytes, count } });
}

/* The next message, its list copied; type 0: there is none. */
static ff_message heard(ff_session *session)
{
    static uint8_t copy[FF_ABOUT_BYTES_MAX + 64];
    const uint8_t *bytes;
    ff_message message = { 0 };
    size_t count = ff_session_output(session, &bytes);
    if (!count) return message;
    memcpy(copy, bytes, count < sizeof copy ? count : sizeof copy);
    int used = ff_message_decode(copy, count < sizeof copy ? count : sizeof copy, &message);
    assert_true(used > 0);
    ff_session_sent(session, (size_t)used);
    return message;
}

static void assert_goodbye(ff_session *session, int error)
{
    ff_message message = heard(session);
    assert_int_equal(message.type, FF_MSG_GOODBYE);
    assert_int_equal(message.u.failed.error, error);
    ff_session_destroy(session);
}

static void welcome_comes_after_caps(void **state)
{
    (void)state;
    ff_session *session = session_new();
    assert_true(hello(session, FF_PROTOCOL_VERSION) > 0);
    assert_int_equal(heard(session).type, 0);
    assert_true(caps(session, "\2\2id\xc8\1?", 7) > 0); /* an unknown entry, too */
    assert_int_equal(heard(session).type, FF_MSG_WELCOME);
    ff_session_destroy(session);
}

/* In one piece, as clients send it: no round trip more. */
static void hello_and_caps_may_come_together(void **state)
{
    static const uint8_t both[] = "\1\x0c"
                                  "FFLD\x0b\0\0\0\0\0\0\0\7\0";
    (void)state;
    ff_session *session = session_new();
    assert_int_equal(ff_session_receive(session, both, 16, 0), 16);
    ff_message welcome = heard(session);
    assert_int_equal(welcome.type, FF_MSG_WELCOME);
    assert_int_equal(welcome.u.welcome.info.checksum, pack.header.info.checksum);
    assert_int_equal(welcome.u.welcome.more.byte_count, 0);
    ff_session_destroy(session);
}

static void caps_of_the_longest_are_taken_in_crumbs(void **state)
{
    uint8_t list[FF_CAPS_BYTES_MAX] = { 200, 0xfd, 3 }, bytes[FF_CAPS_BYTES_MAX + 4];
    (void)state;
    ff_session *session = session_new();
    assert_true(hello(session, FF_PROTOCOL_VERSION) > 0);
    int count = ff_message_encode(
        &(ff_message){ .type = FF_MSG_CAPS, .u.list = { list, sizeof list } }, bytes, sizeof bytes);
    assert_int_equal(count, sizeof list + 3);
    for (int i = 0; i < count; i++)
        assert_int_equal(ff_session_receive(session, bytes + i, 1, 0), 1);
    assert_int_equal(heard(session).type, FF_MSG_WELCOME);
    ff_session_destroy(session);
}

static void order_is_kept(void **state)
{
    (void)state;
    ff_session *session = session_new();
    assert_int_equal(caps(session, NULL, 0), FF_ERR_FORMAT); /* before HELLO */
    assert_goodbye(session, FF_ERR_FORMAT);
    session = session_new();
    hello(session, FF_PROTOCOL_VERSION);
    assert_int_equal(hello(session, FF_PROTOCOL_VERSION), FF_ERR_FORMAT);
    assert_goodbye(session, FF_ERR_FORMAT);
    session = session_new();
    hello(session, FF_PROTOCOL_VERSION);
    assert_int_equal(tell(session, &(ff_message){ .type = FF_MSG_PING }), FF_ERR_FORMAT);
    assert_goodbye(session, FF_ERR_FORMAT);
    session = session_new();
    hello(session, FF_PROTOCOL_VERSION);
    caps(session, NULL, 0);
    assert_int_equal(heard(session).type, FF_MSG_WELCOME);
    assert_int_equal(caps(session, NULL, 0), FF_ERR_FORMAT); /* twice */
    assert_goodbye(session, FF_ERR_FORMAT);
}

static void a_client_of_version_4_is_sent_away(void **state)
{
    (void)state;
    ff_session *session = session_new();
    assert_int_equal(hello(session, 4), FF_ERR_VERSION);
    assert_goodbye(session, FF_ERR_VERSION);
}

static void what_nobody_draws_is_told(void **state)
{
    (void)state;
    for (uint32_t lacks = 0; lacks <= FF_LACKS_FAR; lacks += FF_LACKS_FAR) {
        ff_session *session = ff_session_create(
            &(ff_session_desc){ .pack = &pack, .lacks = lacks });
        hello(session, FF_PROTOCOL_VERSION);
        caps(session, NULL, 0);
        ff_message message = heard(session);
        assert_int_equal(message.type, FF_MSG_WELCOME);
        assert_int_equal(ff_welcome_lacks(&message.u.welcome), lacks);
        assert_int_equal(message.u.welcome.more.byte_count, lacks ? 6 : 0);
        if (lacks) assert_memory_equal(message.u.welcome.more.bytes, "\x08\4\4\0\0\0", 6);
        ff_session_destroy(session);
    }
}

static void what_the_pack_says_is_told_as_asked(void **state)
{
    (void)state;
    ff_session *session = session_new();
    hello(session, FF_PROTOCOL_VERSION);
    caps(session, NULL, 0);
    (void)heard(session);
    tell(session, &(ff_message){ .type = FF_MSG_GET_ABOUT, .u.get_about = { 2 } });
    ff_message message = heard(session);
    assert_int_equal(message.type, FF_MSG_ABOUT);
    assert_int_equal(message.u.list.byte_count, 8);
    assert_memory_equal(message.u.list.bytes, "\2\6nobody", 8);
    tell(session, &(ff_message){ .type = FF_MSG_GET_ABOUT, .u.get_about = { UINT32_MAX } });
    assert_int_equal(heard(session).u.list.byte_count, sizeof said - 1);
    pack_bytes[pack.header.about.data_offset + 4] ^= 1; /* damaged: nothing is told */
    tell(session, &(ff_message){ .type = FF_MSG_GET_ABOUT, .u.get_about = { UINT32_MAX } });
    message = heard(session);
    assert_int_equal(message.type, FF_MSG_ABOUT);
    assert_int_equal(message.u.list.byte_count, 0);
    pack_bytes[pack.header.about.data_offset + 4] ^= 1;
    ff_session_destroy(session);
}

/* Whoever asks for the most and does not read waits, and loses nothing. */
static void asking_without_reading_is_bounded(void **state)
{
    enum { ASKED = 300, ASK = 5 };
    static uint8_t asks[ASK * ASKED], most[FF_ABOUT_BYTES_MAX] = { 20, 0xfd, 0x1f };
    pack_fixture_desc desc = { .info = pack_fixture_info(4, 1, 1),
                               .height = pack_fixture_hills,
                               .about = { most, sizeof most } };
    const uint8_t *bytes;
    size_t taken = 0, size;
    ff_pack large;
    (void)state;
    uint8_t *large_bytes = pack_fixture_make(&desc, &size);
    assert_int_equal(ff_pack_open(&large, large_bytes, size), FF_OK);
    for (int i = 0; i < ASKED; i++) memcpy(asks + ASK * i, "\x08\3\x80\x80\x20", ASK); /* 20 */
    ff_session *session = ff_session_create(
        &(ff_session_desc){ .pack = &large, .out_bytes_max = 1 });
    hello(session, FF_PROTOCOL_VERSION);
    caps(session, NULL, 0);
    assert_int_equal(heard(session).type, FF_MSG_WELCOME);
    for (int answers = 0; answers < ASKED;) {
        int rc = ff_session_receive(session, asks + taken, sizeof asks - taken, 0);
        assert_true(rc >= 0);
        taken += (size_t)rc;
        if (!answers) assert_true(taken < sizeof asks);
        /* what is kept for short answers: the rest of the buffer is a face's */
        assert_true(ff_session_output(session, &bytes) <= 8192);
        for (ff_message message; (message = heard(session)).type; answers++)
            assert_int_equal(message.u.list.byte_count, sizeof most);
    }
    assert_int_equal(taken, sizeof asks);
    ff_session_destroy(session);
    free(large_bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(welcome_comes_after_caps),
        cmocka_unit_test(hello_and_caps_may_come_together),
        cmocka_unit_test(caps_of_the_longest_are_taken_in_crumbs),
        cmocka_unit_test(order_is_kept),
        cmocka_unit_test(a_client_of_version_4_is_sent_away),
        cmocka_unit_test(what_nobody_draws_is_told),
        cmocka_unit_test(what_the_pack_says_is_told_as_asked),
        cmocka_unit_test(asking_without_reading_is_bounded),
    };

    return cmocka_run_group_tests(tests, open_pack, close_pack);
}
