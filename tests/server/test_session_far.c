/* Far sets in a session: sectors in order, superseded, cancelled, refused, limited together with
 * panoramas. */
#include "../rig/pack_fixture.h"
#include "../rig/session_talk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static ff_pack pack;
static uint8_t *pack_bytes;

static int open_pack(void **state)
{
    (void)state;
    size_t bytes;
    pack_bytes = pack_fixture_usual(&bytes);
    return !pack_bytes || ff_pack_open(&pack, pack_bytes, bytes) != FF_OK;
}

static int close_pack(void **state)
{
    (void)state;
    free(pack_bytes);
    return 0;
}

static ff_session *greeted(uint32_t per_minute)
{
    ff_session_desc desc = { .pack = &pack, .panoramas_per_minute = per_minute };
    ff_session *session = ff_session_create(&desc);
    assert_non_null(session);
    session_greet(session);
    return session;
}

static void get_far(ff_session *session, uint16_t id, uint8_t sectors, int64_t now_us)
{
    ff_message message = { .type = FF_MSG_GET, .kind = FF_KIND_FAR };
    message.u.get_far = (ff_get_far){ .id = id,
                                      .front_wu = 1000,
                                      .focal = 208,
                                      .down = 100,
                                      .quality = 40,
                                      .tolerance_q2 = 4,
                                      .sector_count = sectors,
                                      .sector = { 6, 0, 5, 3, 4, 1, 2, 7 } };
    session_tell_at(session, &message, now_us);
}

static void get_panorama(ff_session *session, uint16_t id, int64_t now_us)
{
    ff_message message = { .type = FF_MSG_GET, .kind = FF_KIND_FACE };
    message.u.panorama = (ff_get_panorama){ .id = id,
                                            .front_wu = 1000,
                                            .back_wu = 90000,
                                            .face_size = 64,
                                            .quality = 70,
                                            .face_count = 1 };
    session_tell_at(session, &message, now_us);
}

static void draw(ff_session *session, const ff_face_job *job)
{
    uint8_t bytes[64];
    ff_message message = { .type = FF_MSG_ANSWER, .kind = FF_KIND_FAR };
    message.u.far = (ff_far){ .sector = job->face,
                              .flags = (uint8_t)(FF_FACE_EMPTY | (job->last ? FF_FACE_LAST : 0)) };
    int count = ff_message_encode(&message, bytes, sizeof bytes);
    ff_session_face_done(session, job, bytes, count);
}

static void assert_failed(ff_session *session, uint16_t id, int error)
{
    ff_message answer = session_heard(session);
    assert_int_equal(answer.type, FF_MSG_FAILED);
    assert_int_equal(answer.u.failed.id, id);
    assert_int_equal(answer.u.failed.error, error);
}

static void sectors_one_at_a_time_in_the_order_wanted(void **state)
{
    (void)state;
    static const uint8_t wanted[] = { 6, 0, 5 };
    ff_session *session = greeted(0);
    ff_face_job job, other;
    ff_session_stats stats;
    get_far(session, 1, 3, 0);
    for (int i = 0; i < 3; i++) {
        assert_true(ff_session_next_face(session, &job));
        assert_false(ff_session_next_face(session, &other));
        assert_int_equal(job.kind, FF_KIND_FAR);
        assert_int_equal(job.face, wanted[i]);
        assert_int_equal(job.last, i == 2);
        assert_int_equal(job.far.focal, 208);
        draw(session, &job);
        ff_message sector = session_heard(session);
        assert_int_equal(sector.type, FF_MSG_ANSWER);
        assert_int_equal(sector.kind, FF_KIND_FAR);
        assert_int_equal(sector.u.far.sector, wanted[i]);
    }
    assert_false(ff_session_next_face(session, &job));
    ff_session_get_stats(session, &stats);
    assert_int_equal(stats.far_sets, 1);
    assert_int_equal(stats.panoramas, 0);
    assert_int_equal(stats.answers[FF_DATA_FAR], 3);
    assert_int_equal(stats.answers[FF_DATA_FACES], 0);
    ff_session_destroy(session);
}

/* A session draws one thing at a time, whichever it is. */
static void a_newer_set_or_panorama_supersedes(void **state)
{
    (void)state;
    ff_session *session = greeted(0);
    ff_face_job old, job;
    get_far(session, 1, 8, 0);
    assert_true(ff_session_next_face(session, &old));
    get_panorama(session, 2, 0);
    ff_message answer = session_heard(session);
    assert_int_equal(answer.type, FF_MSG_CANCELLED);
    assert_int_equal(answer.u.cancel.id, 1);
    draw(session, &old);
    assert_int_equal(session_heard(session).type, 0);
    assert_true(ff_session_next_face(session, &job));
    assert_int_equal(job.kind, FF_KIND_FACE);
    get_far(session, 3, 1, 0);
    answer = session_heard(session);
    assert_int_equal(answer.type, FF_MSG_CANCELLED);
    assert_int_equal(answer.u.cancel.id, 2);
    ff_session_face_done(session, &job, NULL, FF_ERR_SYSTEM); /* nobody's any more */
    assert_int_equal(session_heard(session).type, 0);
    assert_true(ff_session_next_face(session, &job));
    assert_int_equal(job.kind, FF_KIND_FAR);
    assert_int_equal(job.far.id, 3);
    ff_session_destroy(session);
}

static void a_cancelled_set_is_not_drawn(void **state)
{
    (void)state;
    ff_session *session = greeted(0);
    ff_face_job job;
    get_far(session, 4, 2, 0);
    assert_true(ff_session_next_face(session, &job));
    session_tell_at(session, &(ff_message){ .type = FF_MSG_CANCEL, .u.cancel = { 4 } }, 0);
    assert_int_equal(session_heard(session).type, FF_MSG_CANCELLED);
    draw(session, &job);
    assert_int_equal(session_heard(session).type, 0);
    assert_false(ff_session_next_face(session, &job));
    ff_session_destroy(session);
}

static void a_failed_sector_ends_its_set_only(void **state)
{
    (void)state;
    ff_session *session = greeted(0);
    ff_face_job job;
    get_far(session, 4, 8, 0);
    assert_true(ff_session_next_face(session, &job));
    ff_session_face_done(session, &job, NULL, FF_ERR_UNSUPPORTED);
    assert_failed(session, 4, FF_ERR_UNSUPPORTED);
    assert_false(ff_session_next_face(session, &job));
    get_far(session, 5, 1, 0);
    assert_true(ff_session_next_face(session, &job));
    assert_int_equal(job.far.id, 5);
    ff_session_destroy(session);
}

static void sets_and_panoramas_share_a_limit(void **state)
{
    (void)state;
    ff_session *session = greeted(3);
    get_far(session, 1, 1, 1000);
    get_panorama(session, 2, 1000);
    get_far(session, 3, 1, 1000);
    assert_int_equal(session_heard(session).type, FF_MSG_CANCELLED);
    assert_int_equal(session_heard(session).type, FF_MSG_CANCELLED);
    get_far(session, 4, 1, 1000);
    assert_failed(session, 4, FF_ERR_FULL);
    get_far(session, 5, 1, 20001000);
    assert_int_equal(session_heard(session).type, FF_MSG_CANCELLED); /* the third gives way to it */
    ff_session_destroy(session);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sectors_one_at_a_time_in_the_order_wanted),
        cmocka_unit_test(a_newer_set_or_panorama_supersedes),
        cmocka_unit_test(a_cancelled_set_is_not_drawn),
        cmocka_unit_test(a_failed_sector_ends_its_set_only),
        cmocka_unit_test(sets_and_panoramas_share_a_limit),
    };
    return cmocka_run_group_tests(tests, open_pack, close_pack);
}
