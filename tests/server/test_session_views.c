/* Views and long answers in a session: they wait for a reader, not for a renderer, and are few. */
#include "../rig/pack_fixture.h"
#include "../rig/session_talk.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define LONG 4096 /* more than this of a view's parts does not wait in the buffer */

static ff_pack pack;
static uint8_t *pack_bytes;

/* A tile whose refinement is LONG, and more. */
static int open_pack(void **state)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 1, 1), .height = pack_fixture_hills };
    const uint8_t *payload;
    size_t bytes;
    (void)state;
    desc.info.node_log2 = 5;
    desc.info.codec = FF_CODEC_RAW;
    pack_bytes = pack_fixture_make(&desc, &bytes);
    return !pack_bytes || ff_pack_open(&pack, pack_bytes, bytes) != FF_OK ||
           ff_pack_record(&pack, FF_SECTION_REFINEMENT, 0, &payload) <= LONG;
}

static int close_pack(void **state)
{
    (void)state;
    free(pack_bytes);
    return 0;
}

static ff_session *greeted(uint32_t out_bytes_max)
{
    ff_session *session = ff_session_create(
        &(ff_session_desc){ .pack = &pack, .out_bytes_max = out_bytes_max });
    assert_non_null(session);
    session_greet(session);
    return session;
}

/* A session whose client has asked for a panorama that is being drawn. */
static ff_session *drawing(uint32_t out_bytes_max, ff_face_job *job)
{
    ff_session *session = greeted(out_bytes_max);
    ff_message faces = { .type = FF_MSG_GET, .kind = FF_KIND_FACE };
    faces.u.panorama = (ff_get_panorama){
        .id = 1, .back_wu = 90000, .face_size = 64, .quality = 70, .face_count = 1
    };
    session_tell(session, &faces);
    assert_true(ff_session_next_face(session, job));
    return session;
}

static void a_long_part_does_not_wait_for_a_face(void **state)
{
    ff_message ask = { .type = FF_MSG_GET, .kind = FF_KIND_VIEW };
    ff_face_job job;
    (void)state;
    ff_session *session = drawing(0, &job);
    ask.u.view = (ff_get_view){ .id = 2,
                                .focal_q8 = 256,
                                .width = 1,
                                .height = 1,
                                .allowed_q8 = INT32_MAX,
                                .reach_wu = 1,
                                .fine_wu = 1,
                                .coarse = 1,
                                .count = 1 };
    session_tell(session, &ask);
    ff_message part = session_heard(session);
    assert_int_equal(part.type, FF_MSG_ANSWER);
    assert_int_equal(part.kind, FF_KIND_VIEW);
    assert_int_equal(part.u.part.below, 0);
    assert_true(part.u.part.byte_count > LONG);
    assert_int_equal(session_heard(session).type, 0);
    ff_session_destroy(session);
}

/* How many of `count` views, asked for one after the other, bring more than they name. */
static unsigned searched(ff_session *session, unsigned count, int64_t now_us)
{
    unsigned with_more = 0;
    ff_message ask = session_deep_view(), part;
    for (unsigned i = 0; i < count; i++) {
        unsigned parts = 0;
        session_tell_at(session, &ask, now_us);
        for (; (part = session_heard(session)).type; parts++) {
            assert_int_equal(part.type, FF_MSG_ANSWER);
            assert_int_equal(part.kind, FF_KIND_VIEW);
        }
        assert_in_range(parts, 1, 2); /* the root, and its refinement */
        with_more += parts == 2;
    }
    return with_more;
}

/* A search is dear: nobody asks for a minute's worth of them at once, and the others wait. */
static void searches_for_views_are_few_at_once(void **state)
{
    const int64_t second_us = 1000000;
    (void)state;
    ff_session *session = greeted(0);
    assert_int_equal(searched(session, 20, 0), 8);
    assert_int_equal(searched(session, 5, second_us - 1), 0);
    assert_int_equal(searched(session, 5, second_us), 1);
    assert_int_equal(searched(session, 5, 4 * second_us), 3);
    assert_int_equal(searched(session, 20, 3600 * second_us), 8);
    ff_session_destroy(session);
}

/* What cannot be read is an empty part, and nothing that lies below it comes. */
static void an_unreadable_part_is_empty(void **state)
{
    const uint8_t *payload;
    (void)state;
    int bytes = ff_pack_record(&pack, FF_SECTION_ROOT, 0, &payload);
    assert_true(bytes > 0);
    uint8_t *victim = pack_bytes + (payload - pack_bytes);
    ff_session *session = greeted(0);
    ff_message ask = session_deep_view();
    *victim ^= 1;
    ask.u.view.allowed_q8 = INT32_MAX;
    session_tell(session, &ask);
    *victim ^= 1;
    ff_message part = session_heard(session);
    assert_int_equal(part.kind, FF_KIND_VIEW);
    assert_int_equal(part.u.part.byte_count, 0);
    assert_int_equal(session_heard(session).type, 0);
    ff_session_destroy(session);
}

/* What leaves no room beside a face waits for it, also when nobody wants the face any more. */
static void an_answer_behind_a_cancelled_face_comes(void **state)
{
    ff_face_job job;
    (void)state;
    ff_session *session = drawing(LONG, &job);
    session_tell(session, &(ff_message){ .type = FF_MSG_GET, .kind = FF_KIND_REFINEMENT });
    assert_int_equal(session_heard(session).type, 0);
    session_tell(session, &(ff_message){ .type = FF_MSG_CANCEL, .u.cancel.id = 1 });
    assert_int_equal(session_heard(session).type, FF_MSG_CANCELLED);
    assert_int_equal(session_heard(session).type, 0);
    ff_session_face_done(session, &job, NULL, FF_ERR_SYSTEM);
    ff_message node = session_heard(session);
    assert_int_equal(node.type, FF_MSG_ANSWER);
    assert_true(node.u.data.byte_count > LONG);
    ff_session_destroy(session);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_long_part_does_not_wait_for_a_face),
        cmocka_unit_test(searches_for_views_are_few_at_once),
        cmocka_unit_test(an_unreadable_part_is_empty),
        cmocka_unit_test(an_answer_behind_a_cancelled_face_comes),
    };
    return cmocka_run_group_tests(tests, open_pack, close_pack);
}
