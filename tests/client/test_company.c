/* When requests leave, and in which order: what is asked for ahead waits for company, an image goes
 * behind those above it, and what is expected of answers follows those that came. */
#include "../../client/source/link/ff_stream.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define IN_FLIGHT 8
#define SECOND    1000000

/* A stream that is up, over a link that takes all and brings nothing. */
typedef struct rig {
    sys_stream io;
    ff_requests requests;
    ff_intake intake;
    ff_stream stream;
    uint8_t recv[2 * FF_REQUEST_BYTES_MAX];
    void *slots;
    unsigned pieces; /* that left, each of one requests or more */
    uint64_t bytes;
} rig;

static int take_all(void *state, const uint8_t *bytes, size_t count)
{
    rig *r = state;
    (void)bytes;
    r->pieces++;
    r->bytes += count;
    return (int)count;
}

static int bring_nothing(void *state, uint8_t *bytes, size_t count)
{
    (void)state, (void)bytes, (void)count;
    return 0;
}

static void stay(void *state) { (void)state; }

static int open_rig(void **state)
{
    rig *r = calloc(1, sizeof *r);
    r->io = (sys_stream){ .state = r, .send = take_all, .recv = bring_nothing, .close = stay };
    r->slots = malloc(ff_requests_bytes(IN_FLIGHT));
    ff_requests_init(&r->requests, IN_FLIGHT, r->slots);
    r->intake.requests = &r->requests;
    ff_stream_init(&r->stream, &r->io, &r->intake, IN_FLIGHT, 1000000, r->recv, sizeof r->recv);
    r->stream.has_terrain = 1;
    r->stream.state = FF_STREAM_UP;
    *state = r;
    return 0;
}

static int close_rig(void **state)
{
    rig *r = *state;
    sys_mutex_destroy(&r->requests.mutex);
    free(r->slots);
    free(r);
    return 0;
}

static ff_key node(unsigned code) { return ff_key_make(0, 4, code); }

/* A ranking that wants these nodes refined, and a step. How many requests are out since. */
static unsigned want(rig *r, int64_t now_us, enum ff_request_class rank, unsigned first,
                     unsigned count)
{
    uint32_t sent = r->requests.counts.sent;
    ff_requests_rank_begin(&r->requests);
    for (unsigned i = 0; i < count; i++)
        ff_requests_want(&r->requests, FF_KIND_REFINEMENT, node(first + i), rank, 1, 0, NULL);
    ff_requests_rank_end(&r->requests);
    ff_stream_step(&r->stream, now_us);
    return r->requests.counts.sent - sent;
}

static void what_is_ahead_waits_a_second_after_the_last_of_its_sort(void **state)
{
    rig *r = *state;
    assert_int_equal(want(r, 0, FF_CLASS_PREFETCH, 1, 1), 1); /* the first need not */
    assert_int_equal(want(r, SECOND / 2, FF_CLASS_PREFETCH, 2, 1), 0);
    assert_int_equal(want(r, SECOND - 1, FF_CLASS_PREFETCH, 2, 2), 0);
    assert_int_equal(want(r, SECOND, FF_CLASS_PREFETCH, 2, 2), 2); /* in one piece */
    assert_int_equal(r->pieces, 2);
    assert_int_equal(want(r, 2 * SECOND - 1, FF_CLASS_PREFETCH, 4, 1), 0);
    assert_int_equal(want(r, 2 * SECOND, FF_CLASS_PREFETCH, 4, 1), 1);
}

static void what_is_in_view_takes_along_what_is_ahead(void **state)
{
    rig *r = *state;
    assert_int_equal(want(r, 0, FF_CLASS_PREFETCH, 1, 1), 1);
    ff_requests_rank_begin(&r->requests);
    ff_requests_want(&r->requests, FF_KIND_REFINEMENT, node(2), FF_CLASS_PREFETCH, 1, 0, NULL);
    ff_requests_want(&r->requests, FF_KIND_REFINEMENT, node(3), FF_CLASS_IN_VIEW, 1, 0, NULL);
    ff_requests_rank_end(&r->requests);
    ff_stream_step(&r->stream, SECOND / 10);
    assert_int_equal(r->requests.counts.sent, 3);
    assert_int_equal(r->pieces, 2);
}

static void what_is_in_view_never_waits(void **state)
{
    rig *r = *state;
    assert_int_equal(want(r, 0, FF_CLASS_PREFETCH, 1, 1), 1);
    assert_int_equal(want(r, 1000, FF_CLASS_IN_VIEW, 2, 1), 1);
    assert_int_equal(want(r, 2000, FF_CLASS_IN_VIEW, 3, 1), 1);
}

static void who_turns_does_not_wait(void **state)
{
    rig *r = *state;
    assert_int_equal(want(r, 0, FF_CLASS_PREFETCH, 1, 1), 1);
    ff_stream_hurry(&r->stream, 1);
    assert_int_equal(want(r, 1000, FF_CLASS_PREFETCH, 2, 1), 1);
    ff_stream_hurry(&r->stream, 0);
    assert_int_equal(want(r, 2000, FF_CLASS_PREFETCH, 3, 1), 0);
}

static void a_window_is_not_full_of_what_only_waits_for_company(void **state)
{
    rig *r = *state;
    assert_int_equal(want(r, 0, FF_CLASS_PREFETCH, 1, 1), 1);
    r->stream.link.window_full = 0;
    assert_int_equal(want(r, 1000, FF_CLASS_PREFETCH, 2, 1), 0);
    assert_int_equal(r->stream.link.window_full, 0);
    assert_int_equal(want(r, SECOND, FF_CLASS_IN_VIEW, 3, IN_FLIGHT + 4), IN_FLIGHT - 1);
    assert_int_equal(r->stream.link.window_full, 1);
}

/* ---- images, which may be differences to those above ---- */

static ff_key sent(rig *r)
{
    ff_request out;
    assert_true(ff_requests_next(&r->requests, 0, IN_FLIGHT, 1 << 20, 0, &out));
    return out.key;
}

static void an_image_goes_behind_those_above_it(void **state)
{
    rig *r = *state;
    const ff_key root = ff_key_make(0, 0, 0), child = ff_key_child(root, 3),
                 grandchild = ff_key_child(child, 1);
    ff_requests_rank_begin(&r->requests);
    ff_requests_want(&r->requests, FF_KIND_TEXTURE, grandchild, FF_CLASS_IN_VIEW, 9000, 0, NULL);
    ff_requests_want(&r->requests, FF_KIND_TEXTURE, child, FF_CLASS_IN_VIEW, 100, 0, NULL);
    ff_requests_want(&r->requests, FF_KIND_TEXTURE, root, FF_CLASS_IN_VIEW, 10, 0, NULL);
    ff_requests_want(&r->requests, FF_KIND_REFINEMENT, root, FF_CLASS_IN_VIEW, 50, 0, NULL);
    ff_requests_rank_end(&r->requests);
    assert_int_equal(sent(r), root);
    assert_int_equal(sent(r), child);
    assert_int_equal(sent(r), grandchild);
    assert_int_equal(r->requests.counts.of[FF_KIND_TEXTURE].sent, 3);
    assert_int_equal(sent(r), root);
}

static void the_first_answer_tells_how_long_others_will_be(void **state)
{
    rig *r = *state;
    const ff_key root = ff_key_make(0, 0, 0);
    uint32_t guess = ff_requests_answer_bytes(&r->requests, FF_KIND_TEXTURE, 5);
    ff_request out;
    ff_requests_want(&r->requests, FF_KIND_TEXTURE, root, FF_CLASS_IN_VIEW, 1, 0, NULL);
    assert_true(ff_requests_next(&r->requests, 0, IN_FLIGHT, 1 << 20, 0, &out));
    ff_requests_arrived(&r->requests, out.id, 80);
    assert_true(guess > 160);
    for (unsigned level = 0; level <= FF_KEY_LEVEL_MAX; level++)
        assert_int_equal(ff_requests_answer_bytes(&r->requests, FF_KIND_TEXTURE, level), 80);
    ff_requests_finish(&r->requests, out.id, FF_REQUEST_DONE);
    /* the second of a level is one of many, the first of another level tells of all but these */
    ff_requests_want(&r->requests, FF_KIND_TEXTURE, ff_key_child(root, 0), FF_CLASS_IN_VIEW, 1, 0,
                     NULL);
    assert_true(ff_requests_next(&r->requests, 0, IN_FLIGHT, 1 << 20, 0, &out));
    ff_requests_arrived(&r->requests, out.id, 40);
    assert_int_equal(ff_requests_answer_bytes(&r->requests, FF_KIND_TEXTURE, 0), 80);
    assert_int_equal(ff_requests_answer_bytes(&r->requests, FF_KIND_TEXTURE, 1), 40);
    assert_int_equal(ff_requests_answer_bytes(&r->requests, FF_KIND_TEXTURE, 9), 40);
    ff_requests_finish(&r->requests, out.id, FF_REQUEST_DONE);
    ff_requests_want(&r->requests, FF_KIND_TEXTURE, ff_key_child(root, 1), FF_CLASS_IN_VIEW, 1, 0,
                     NULL);
    assert_true(ff_requests_next(&r->requests, 0, IN_FLIGHT, 1 << 20, 0, &out));
    ff_requests_arrived(&r->requests, out.id, 120);
    assert_int_equal(ff_requests_answer_bytes(&r->requests, FF_KIND_TEXTURE, 1), 50);
    ff_requests_finish(&r->requests, out.id, FF_REQUEST_DONE);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, open_rig, close_rig)
    const struct CMUnitTest tests[] = {
        TEST(what_is_ahead_waits_a_second_after_the_last_of_its_sort),
        TEST(what_is_in_view_takes_along_what_is_ahead),
        TEST(what_is_in_view_never_waits),
        TEST(who_turns_does_not_wait),
        TEST(a_window_is_not_full_of_what_only_waits_for_company),
        TEST(an_image_goes_behind_those_above_it),
        TEST(the_first_answer_tells_how_long_others_will_be),
    };
#undef TEST
    return cmocka_run_group_tests(tests, NULL, NULL);
}
