/* Sessions: order, limits, cancels, superseded panoramas, nonsense and slow readers. */
#include "../rig/pack_fixture.h"
#include "../rig/session_talk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static ff_pack pack;
static uint8_t *pack_bytes;
static size_t pack_size;

static int open_pack(void **state)
{
    (void)state;
    pack_bytes = pack_fixture_usual(&pack_size);
    return !pack_bytes || ff_pack_open(&pack, pack_bytes, pack_size) != FF_OK;
}

static int close_pack(void **state)
{
    (void)state;
    free(pack_bytes);
    return 0;
}

/* ---- a client in an array ---- */

static ff_session *session_with(ff_session_desc desc)
{
    desc.pack = &pack;
    ff_session *session = ff_session_create(&desc);
    assert_non_null(session);
    return session;
}

static int say_hello(ff_session *session)
{
    return session_tell(
        session, &(ff_message){ .type = FF_MSG_HELLO, .u.hello = { FF_PROTOCOL_VERSION, 0 } });
}

static int say_caps(ff_session *session)
{
    return session_tell(session, &(ff_message){ .type = FF_MSG_CAPS });
}

static int greet(ff_session *session)
{
    int rc = say_hello(session);
    return rc < 0 ? rc : say_caps(session);
}

/* The first kind that is answered so: roots stand for refinements. */
static void assert_answer(ff_message message, enum ff_kind kind)
{
    assert_int_equal(message.type, FF_MSG_ANSWER);
    assert_int_equal(message.kind, kind);
}

static int get_root(ff_session *session, uint32_t tile)
{
    return session_tell(session, &(ff_message){ .type = FF_MSG_GET,
                                                .kind = FF_KIND_ROOT,
                                                .u.get = { ff_key_make(tile, 0, 0) } });
}

static int cancel(ff_session *session, uint16_t id)
{
    return session_tell(session, &(ff_message){ .type = FF_MSG_CANCEL, .u.cancel = { id } });
}

static int get_panorama_at(ff_session *session, uint16_t id, uint8_t faces, int64_t now_us)
{
    ff_message message = { .type = FF_MSG_GET, .kind = FF_KIND_FACE };
    message.u.panorama = (ff_get_panorama){ .id = id,
                                            .front_wu = 1000,
                                            .back_wu = 90000,
                                            .face_size = 64,
                                            .quality = 70,
                                            .face_count = faces,
                                            .face = { 3, 2, 1, 0, 4, 5 } };
    return session_tell_at(session, &message, now_us);
}

static int get_panorama(ff_session *session, uint16_t id, uint8_t faces)
{
    return get_panorama_at(session, id, faces, 0);
}

static ff_session *welcomed_with(ff_session_desc desc)
{
    ff_session *session = session_with(desc);
    assert_true(greet(session) > 0);
    ff_message welcome = session_heard(session);
    assert_int_equal(welcome.type, FF_MSG_WELCOME);
    assert_int_equal(welcome.u.welcome.info.checksum, pack.header.info.checksum);
    return session;
}

static ff_session *welcomed(void) { return welcomed_with((ff_session_desc){ 0 }); }

static void expect_goodbye(ff_session *session, int error)
{
    ff_message last = { 0 }, message;
    while ((message = session_heard(session)).type) last = message;
    assert_int_equal(last.type, FF_MSG_GOODBYE);
    assert_int_equal(last.u.failed.error, error);
    assert_int_equal(ff_session_receive(session, (const uint8_t *)"x", 1, 0), error);
    ff_session_destroy(session);
}

/* The root of a tile has come, and of no other. */
static void expect_root(ff_session *session, uint32_t tile)
{
    const uint8_t *payload;
    int bytes = ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(tile, 0, 0), &payload);
    ff_message node = session_heard(session);
    assert_answer(node, FF_KIND_ROOT);
    assert_int_equal(node.u.data.byte_count, bytes);
    assert_memory_equal(node.u.data.bytes, payload, (size_t)bytes);
}

static void expect_failed(ff_session *session, uint16_t id, int error)
{
    ff_message failed = session_heard(session);
    assert_int_equal(failed.type, FF_MSG_FAILED);
    assert_int_equal(failed.u.failed.id, id);
    assert_int_equal(failed.u.failed.error, error);
}

/* ---- nodes ---- */

static void nodes_come_from_the_pack_in_order(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    ff_key keys[] = { ff_key_make(0, 0, 0), ff_key_make(3, 0, 0), ff_key_make(2, 1, 3),
                      ff_key_make(1, 2, 7) };
    for (uint16_t i = 0; i < 4; i++)
        session_tell(session, &(ff_message){ .type = FF_MSG_GET,
                                             .kind = i < 2 ? FF_KIND_ROOT : FF_KIND_REFINEMENT,
                                             .u.get = { keys[i] } });
    for (uint16_t i = 0; i < 4; i++) {
        const uint8_t *payload;
        int bytes = ff_pack_record(&pack, i < 2 ? FF_SECTION_ROOT : FF_SECTION_REFINEMENT, keys[i],
                                   &payload);
        ff_message node = session_heard(session);
        assert_answer(node, FF_KIND_ROOT);
        assert_int_equal(node.u.data.byte_count, bytes);
        assert_memory_equal(node.u.data.bytes, payload, (size_t)bytes);
    }
    ff_session_stats stats;
    ff_session_get_stats(session, &stats);
    assert_int_equal(stats.answers[FF_DATA_HEIGHTS], 4);
    ff_session_destroy(session);
}

static void unknown_nodes_and_textures_fail(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    get_root(session, 4); /* four tiles: 0..3 */
    expect_failed(session, 0, FF_ERR_NOT_FOUND);
    /* The finest level has nothing below it. */
    session_tell(session, &(ff_message){ .type = FF_MSG_GET,
                                         .kind = FF_KIND_REFINEMENT,
                                         .u.get = { ff_key_make(0, 3, 0) } });
    expect_failed(session, 0, FF_ERR_NOT_FOUND);
    session_tell(session, &(ff_message){ .type = FF_MSG_GET,
                                         .kind = FF_KIND_TEXTURE,
                                         .u.get = { ff_key_make(0, 0, 0) } });
    expect_failed(session, 0, FF_ERR_NOT_FOUND);
    get_root(session, 0);
    expect_root(session, 0);
    ff_session_destroy(session);
}

static void a_damaged_record_fails_alone(void **state)
{
    (void)state;
    const uint8_t *payload;
    assert_true(ff_pack_record(&pack, FF_SECTION_ROOT, ff_key_make(1, 0, 0), &payload) > 0);
    uint8_t *victim = pack_bytes + (payload - pack_bytes);
    *victim ^= 1;
    ff_session *session = welcomed();
    get_root(session, 1);
    expect_failed(session, 0, FF_ERR_CHECKSUM);
    ff_session_stats stats;
    ff_session_get_stats(session, &stats);
    assert_int_equal(stats.damaged, 1);
    *victim ^= 1;
    get_root(session, 1);
    expect_root(session, 1);
    ff_session_destroy(session);
}

static void bytes_one_by_one(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    uint8_t bytes[64];
    int count = ff_message_encode(
        &(ff_message){ .type = FF_MSG_GET, .kind = FF_KIND_ROOT, .u.get = { 0 } }, bytes,
        sizeof bytes);
    for (int i = 0; i < count; i++) {
        assert_int_equal(session_heard(session).type, 0);
        assert_int_equal(ff_session_receive(session, bytes + i, 1, 0), 1);
    }
    expect_root(session, 0);
    ff_session_destroy(session);
}

/* ---- protocol errors ---- */

static void hello_must_come_first_and_once(void **state)
{
    (void)state;
    ff_session *session = session_with((ff_session_desc){ 0 });
    assert_int_equal(get_root(session, 0), FF_ERR_FORMAT);
    expect_goodbye(session, FF_ERR_FORMAT);
    session = welcomed();
    assert_int_equal(greet(session), FF_ERR_FORMAT);
    expect_goodbye(session, FF_ERR_FORMAT);
}

static void other_version_is_sent_away(void **state)
{
    (void)state;
    ff_session *session = session_with((ff_session_desc){ 0 });
    session_tell(session,
                 &(ff_message){ .type = FF_MSG_HELLO, .u.hello = { FF_PROTOCOL_VERSION + 1, 0 } });
    expect_goodbye(session, FF_ERR_VERSION);
}

static void nonsense_ends_the_session(void **state)
{
    (void)state;
    static const char *const nonsense[] = { "GET / HTTP/1.1\r\n\r\n", "\x05\xff\xff\xff\xff",
                                            "\x05\x01\x01", "\x9f\xff\xff\xff\xff\xff",
                                            "\xa0\x01" };
    for (size_t i = 0; i < sizeof nonsense / sizeof *nonsense; i++) {
        ff_session *session = welcomed();
        int rc = ff_session_receive(session, (const uint8_t *)nonsense[i], strlen(nonsense[i]), 0);
        assert_true(rc < 0);
        expect_goodbye(session, rc);
    }
}

static void servers_messages_and_endless_ones_end_the_session(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    assert_int_equal(session_tell(session, &(ff_message){ .type = FF_MSG_PONG, .u.ping = { 1 } }),
                     FF_ERR_FORMAT);
    expect_goodbye(session, FF_ERR_FORMAT);
    uint8_t long_one[1000] = { FF_MSG_HELLO, 0x80, 0x80, 1 }; /* 16 kB announced */
    session = session_with((ff_session_desc){ 0 });
    assert_int_equal(ff_session_receive(session, long_one, sizeof long_one, 0), FF_ERR_FORMAT);
    expect_goodbye(session, FF_ERR_FORMAT);
}

/* ---- limits ---- */

static void slow_reader_waits_and_loses_nothing(void **state)
{
    (void)state;
    ff_session *session = welcomed_with(
        (ff_session_desc){ .out_bytes_max = 400, .requests_max = 64 });
    const uint8_t *bytes;
    for (uint16_t id = 1; id <= 40; id++) assert_true(get_root(session, id % 4u) > 0);
    assert_true(ff_session_output(session, &bytes) <= 400);
    for (uint16_t id = 1; id <= 40; id++) expect_root(session, id % 4u);
    assert_int_equal(session_heard(session).type, 0);
    ff_session_destroy(session);
}

static void an_answer_larger_than_the_buffer_goes_alone(void **state)
{
    (void)state;
    ff_session *session = welcomed_with((ff_session_desc){ .out_bytes_max = 1 });
    get_root(session, 0);
    get_root(session, 1);
    expect_root(session, 0);
    expect_root(session, 1);
    ff_session_destroy(session);
}

static void too_many_requests_end_the_session(void **state)
{
    (void)state;
    ff_session *session = welcomed_with((ff_session_desc){ .out_bytes_max = 1, .requests_max = 5 });
    for (uint16_t id = 1; id <= 6; id++) /* one is in the buffer, five wait */
        assert_true(get_root(session, 0) > 0);
    assert_int_equal(get_root(session, 0), FF_ERR_FULL);
    expect_goodbye(session, FF_ERR_FULL);
}

static void pings_without_reading_are_left_unread(void **state)
{
    (void)state;
    ff_session *session = welcomed_with((ff_session_desc){ .out_bytes_max = 1 });
    uint8_t pings[6 * 4000];
    for (uint32_t i = 0; i < 4000; i++)
        assert_int_equal(ff_message_encode(&(ff_message){ .type = FF_MSG_PING, .u.ping = { i } },
                                           pings + 6 * i, 6),
                         6);
    size_t taken = 0;
    for (uint32_t answered = 0; answered < 4000;) {
        int rc = ff_session_receive(session, pings + taken, sizeof pings - taken, 0);
        assert_true(rc >= 0);
        taken += (size_t)rc;
        if (answered == 0) assert_true(taken < sizeof pings);
        for (ff_message pong; (pong = session_heard(session)).type; answered++) {
            assert_int_equal(pong.type, FF_MSG_PONG);
            assert_int_equal(pong.u.ping.stamp, answered);
        }
    }
    assert_int_equal(taken, sizeof pings);
    ff_session_destroy(session);
}

static void silence_makes_a_session_idle(void **state)
{
    (void)state;
    ff_session *session = session_with((ff_session_desc){ .idle_ms_max = 1000, .now_us = 5000000 });
    assert_false(ff_session_idle(session, 6000000));
    assert_true(ff_session_idle(session, 6000001));
    session_tell_at(session,
                    &(ff_message){ .type = FF_MSG_HELLO, .u.hello = { FF_PROTOCOL_VERSION, 0 } },
                    6000000);
    assert_true(ff_session_idle(session, 6000001)); /* HELLO alone is not enough */
    session_tell_at(session, &(ff_message){ .type = FF_MSG_CAPS }, 6000000);
    assert_false(ff_session_idle(session, 7000000));
    /* half a message is not a message */
    ff_session_receive(session, (const uint8_t *)"\x06", 1, 6900000);
    assert_true(ff_session_idle(session, 7000001));
    ff_session_destroy(session);
}

/* ---- cancels ---- */

/* Those for one node have no number: nothing of the sort cancels them, and their order stays. */
static void what_has_no_number_is_not_cancelled(void **state)
{
    (void)state;
    ff_session *session = welcomed_with((ff_session_desc){ .out_bytes_max = 1, .requests_max = 4 });
    for (uint32_t tile = 0; tile < 4; tile++) get_root(session, tile);
    cancel(session, 0);
    cancel(session, 2);
    cancel(session, 99);
    for (uint32_t tile = 0; tile < 4; tile++) expect_root(session, tile);
    assert_int_equal(session_heard(session).type, 0);
    ff_session_destroy(session);
}

/* What fails does so in its turn, so that everybody knows which it was. */
static void a_failure_keeps_its_place(void **state)
{
    (void)state;
    ff_session *session = welcomed_with((ff_session_desc){ .out_bytes_max = 1 });
    get_root(session, 2);
    get_root(session, 4);
    get_root(session, 3);
    expect_root(session, 2);
    expect_failed(session, 0, FF_ERR_NOT_FOUND);
    expect_root(session, 3);
    ff_session_destroy(session);
}

/* ---- panoramas ---- */

static int face_bytes(const ff_face_job *job, uint8_t *out, size_t capacity)
{
    ff_message message = { .type = FF_MSG_ANSWER, .kind = FF_KIND_FACE };
    message.u.face =
        (ff_face){ .id = job->request.id,
                   .face = job->face,
                   .face_size = 64,
                   .flags = (uint8_t)(FF_FACE_EMPTY | (job->last ? FF_FACE_LAST : 0)) };
    return ff_message_encode(&message, out, capacity);
}

static void render(ff_session *session, const ff_face_job *job)
{
    uint8_t face[64];
    int bytes = face_bytes(job, face, sizeof face);
    ff_session_face_done(session, job, face, bytes);
}

static void faces_one_at_a_time_in_the_order_wanted(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    ff_face_job job, other;
    assert_false(ff_session_next_face(session, &job));
    get_panorama(session, 1, 3);
    for (uint8_t i = 0; i < 3; i++) {
        assert_true(ff_session_next_face(session, &job));
        assert_false(ff_session_next_face(session, &other));
        assert_int_equal(job.face, 3 - i);
        assert_int_equal(job.last, i == 2);
        render(session, &job);
        ff_message face = session_heard(session);
        assert_answer(face, FF_KIND_FACE);
        assert_int_equal(face.u.face.flags, FF_FACE_EMPTY | (i == 2 ? FF_FACE_LAST : 0));
    }
    assert_false(ff_session_next_face(session, &job));
    ff_session_destroy(session);
}

static void a_newer_panorama_supersedes(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    ff_face_job old, job;
    get_panorama(session, 1, 2);
    assert_true(ff_session_next_face(session, &old));
    /* the new request has the same id: the old face must not pass for the new one */
    get_panorama(session, 1, 1);
    ff_message answer = session_heard(session);
    assert_int_equal(answer.type, FF_MSG_CANCELLED);
    assert_int_equal(answer.u.cancel.id, 1);
    assert_false(ff_session_next_face(session, &job));
    render(session, &old);
    assert_int_equal(session_heard(session).type, 0);
    assert_true(ff_session_next_face(session, &job));
    assert_true(job.last);
    render(session, &job);
    assert_answer(session_heard(session), FF_KIND_FACE);
    ff_session_destroy(session);
}

static void a_cancelled_panorama_is_not_drawn(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    ff_face_job job;
    get_panorama(session, 4, 2);
    assert_true(ff_session_next_face(session, &job));
    cancel(session, 4);
    assert_int_equal(session_heard(session).type, FF_MSG_CANCELLED);
    render(session, &job);
    assert_int_equal(session_heard(session).type, 0);
    assert_false(ff_session_next_face(session, &job));
    ff_session_destroy(session);
}

static void failed_face_ends_its_panorama_only(void **state)
{
    (void)state;
    ff_session *session = welcomed();
    ff_face_job job;
    get_panorama(session, 4, 6);
    assert_true(ff_session_next_face(session, &job));
    ff_session_face_done(session, &job, NULL, FF_ERR_SYSTEM);
    expect_failed(session, 4, FF_ERR_SYSTEM);
    assert_false(ff_session_next_face(session, &job));
    get_panorama(session, 5, 1);
    assert_true(ff_session_next_face(session, &job));
    assert_int_equal(job.request.id, 5);
    ff_session_destroy(session);
}

static void panoramas_per_minute_are_limited(void **state)
{
    (void)state;
    ff_session *session = welcomed_with((ff_session_desc){ .panoramas_per_minute = 3 });
    ff_face_job job;
    for (uint16_t id = 1; id <= 4; id++) {
        get_panorama_at(session, id, 1, 1000);
        if (id <= 3) {
            assert_true(ff_session_next_face(session, &job));
            render(session, &job);
            assert_answer(session_heard(session), FF_KIND_FACE);
        }
    }
    expect_failed(session, 4, FF_ERR_FULL);
    get_panorama_at(session, 5, 1, 19000000);
    expect_failed(session, 5, FF_ERR_FULL);
    get_panorama_at(session, 6, 1, 20001000);
    assert_true(ff_session_next_face(session, &job));
    ff_session_destroy(session);
}

static void large_face_fits_beside_full_buffer(void **state)
{
    (void)state;
    ff_session *session = welcomed_with(
        (ff_session_desc){ .out_bytes_max = 600, .requests_max = 64 });
    ff_face_job job;
    get_panorama(session, 100, 2);
    assert_true(ff_session_next_face(session, &job));
    for (int i = 0; i < 20; i++) get_root(session, 0);
    /* short answers fill the output's reserve for them */
    static const uint8_t ping[6] = { FF_MSG_PING, 4 };
    while (ff_session_receive(session, ping, sizeof ping, 0) > 0)
        ;
    size_t bytes = FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX;
    uint8_t *face = calloc(1, bytes);
    assert_non_null(face);
    ff_session_face_done(session, &job, face, (int)bytes);
    free(face);
    ff_session_stats stats;
    ff_session_get_stats(session, &stats);
    assert_int_equal(stats.answers[FF_DATA_FACES], 1);
    assert_false(ff_session_next_face(session, &job)); /* not before the reader has caught up */
    ff_session_destroy(session);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_come_from_the_pack_in_order),
        cmocka_unit_test(unknown_nodes_and_textures_fail),
        cmocka_unit_test(a_damaged_record_fails_alone),
        cmocka_unit_test(bytes_one_by_one),
        cmocka_unit_test(hello_must_come_first_and_once),
        cmocka_unit_test(other_version_is_sent_away),
        cmocka_unit_test(nonsense_ends_the_session),
        cmocka_unit_test(servers_messages_and_endless_ones_end_the_session),
        cmocka_unit_test(slow_reader_waits_and_loses_nothing),
        cmocka_unit_test(an_answer_larger_than_the_buffer_goes_alone),
        cmocka_unit_test(too_many_requests_end_the_session),
        cmocka_unit_test(pings_without_reading_are_left_unread),
        cmocka_unit_test(silence_makes_a_session_idle),
        cmocka_unit_test(what_has_no_number_is_not_cancelled),
        cmocka_unit_test(a_failure_keeps_its_place),
        cmocka_unit_test(faces_one_at_a_time_in_the_order_wanted),
        cmocka_unit_test(a_newer_panorama_supersedes),
        cmocka_unit_test(a_cancelled_panorama_is_not_drawn),
        cmocka_unit_test(failed_face_ends_its_panorama_only),
        cmocka_unit_test(panoramas_per_minute_are_limited),
        cmocka_unit_test(large_face_fits_beside_full_buffer),
    };
    return cmocka_run_group_tests(tests, open_pack, close_pack);
}
