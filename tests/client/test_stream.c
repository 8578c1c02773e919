/* The stream and its request queue: a link or a peer fails in every way, and the picture is
 * complete in the end. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define METRE FF_WU_PER_METRE
#ifndef TEST_STRIDE
#define TEST_STRIDE 1 /* tests under emulation try every fifth place alone (cross.mk) */
#endif

static client_rig whole; /* a client whose link never failed: its picture is the right one */

static int make_whole(void **state)
{
    (void)state;
    rig_open(&whole, 0);
    rig_client(&whole, 2 * MB);
    return !rig_settle(&whole, 400);
}

static int free_whole(void **state)
{
    (void)state;
    rig_close(&whole);
    return 0;
}

static void assert_adds_up(client_rig *rig)
{
    ff_request_counts c;
    ff_requests_get_counts(&rig->client->first.requests, &c, NULL);
    assert_int_equal(c.made, c.done + c.failed + c.cancelled + c.dropped + c.queued + c.in_flight +
                                 c.arriving);
}

static void assert_comes_whole(client_rig *rig)
{
    assert_true(rig_settle(rig, 4000));
    assert_true(rig_same_picture(rig, &whole));
    assert_adds_up(rig);
}

static void connection_cut_after_any_byte(void **state)
{
    (void)state;
    for (uint64_t at = 0; at < whole.bytes_down + 40; at += TEST_STRIDE * (at < 100 ? 2 : 211)) {
        client_rig rig;
        rig_open(&rig, 0);
        rig.cut_at = at;
        rig_client(&rig, 2 * MB);
        assert_comes_whole(&rig);
        assert_int_equal(rig_stats(&rig).protocol_errors, 0);
        if (at <= whole.bytes_down - 40) assert_int_equal(rig_stats(&rig).reconnects, 1);
        rig_close(&rig);
    }
}

static void cut_again_and_again(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 40; i++) {
        rig.cut_at = rig.bytes_down + 150;
        for (int step = 0; step < 40; step++) rig_step(&rig, 100000);
    }
    rig.cut_at = UINT64_MAX;
    assert_comes_whole(&rig);
    rig_close(&rig);
}

static void bytes_in_crumbs(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.chop = 1;
    rig_client(&rig, 2 * MB);
    assert_comes_whole(&rig);
    assert_int_equal(rig_stats(&rig).protocol_errors, 0);
    rig_close(&rig);
}

/* From some byte on the peer sends nonsense. The client notices it by its form, or it decodes by
 * chance (payloads carry no checksum on the wire); either way the client comes to rest with all
 * requests accounted for. */
static void nonsense_after_any_byte(void **state)
{
    (void)state;
    static const uint8_t with[] = { 0xff, 0x00, 66, 69 };
    unsigned noticed = 0, runs = 0;
    for (uint64_t at = 0; at < whole.bytes_down; at += TEST_STRIDE * (at < 100 ? 7 : 331)) {
        client_rig rig;
        rig_open(&rig, 0);
        rig.spoil_at = at;
        rig.spoil_with = with[at % sizeof with];
        rig.desc.answer_timeout_ms = 5000;
        rig_client(&rig, 2 * MB);
        assert_true(rig_settle(&rig, 1000));
        assert_adds_up(&rig);
        /* a WELCOME to another terrain */
        int believed = ff_client_terrain(rig.client)->checksum != whole.pack.header.info.checksum;
        assert_true(believed || rig_stats(&rig).tree.nodes_drawn > 0);
        noticed += rig_stats(&rig).protocol_errors > 0;
        runs++;
        rig_close(&rig);
    }
    assert_true(noticed * 2 > runs);
}

static void peer_stops_in_mid_message(void **state)
{
    (void)state;
    for (uint64_t at = 1; at < whole.bytes_down; at += TEST_STRIDE * 211) {
        client_rig rig;
        rig_open(&rig, 0);
        rig.silent_at = at;
        rig.desc.answer_timeout_ms = 3000;
        rig_client(&rig, 2 * MB);
        assert_comes_whole(&rig);
        assert_int_equal(rig_stats(&rig).reconnects, 1);
        rig_close(&rig);
    }
}

static void silence_is_waited_out_for_its_time(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.silent_at = 300;
    rig.desc.answer_timeout_ms = 30000;
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 290; i++) /* 29 s */
        rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).link, FF_LINK_UP);
    assert_int_equal(rig_stats(&rig).reconnects, 0);
    for (int i = 0; i < 25; i++) rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).reconnects, 1);
    assert_comes_whole(&rig);
    rig_close(&rig);
}

static void backs_off_when_nobody_answers(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.cut_at = 0;
    rig.refuse = 1;
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 6000; i++) /* ten minutes */
        rig_step(&rig, 100000);
    assert_in_range(rig_stats(&rig).reconnects, 20, 30); /* 0.5, 1, 2 .. 30, 30 s */
    assert_int_equal(rig_stats(&rig).link, FF_LINK_DOWN);
    rig.refuse = 0;
    assert_comes_whole(&rig);
    rig_close(&rig);
}

static void no_way_to_reconnect_keeps_the_picture(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.stream.reconnect = NULL;
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    rig.cut_at = 0;
    rig.camera.yaw += 100;
    for (int i = 0; i < 100; i++) rig_step(&rig, 100000);
    assert_int_equal(rig_stats(&rig).link, FF_LINK_DOWN);
    assert_true(rig_stats(&rig).tree.nodes_drawn > 5);
    rig_close(&rig);
}

static void another_terrain_replaces_all(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    uint32_t requests = rig_stats(&rig).requests_sent;
    rig.cut_at = rig.bytes_down; /* the same terrain: what is here is not asked for again */
    assert_true(rig_settle(&rig, 400));
    for (int i = 0; i < 40; i++) rig_step(&rig, 100000);
    assert_int_equal(rig.connections, 2);
    assert_int_equal(rig_stats(&rig).requests_sent, requests);
    assert_true(rig_same_picture(&rig, &whole));

    rig_change_terrain(&rig);
    for (int i = 0; i < 40; i++) rig_step(&rig, 100000);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.connections, 3);
    assert_int_equal(ff_client_terrain(rig.client)->hoffset_wu, 1000);
    assert_true(rig_stats(&rig).requests_sent > requests);
    assert_adds_up(&rig);
    rig_close(&rig);
}

static void requests_are_never_asked_twice(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 200; i++) {
        rig.camera.yaw += 700;
        rig_step(&rig, 20000);
    }
    assert_true(rig_settle(&rig, 400));
    ff_client_stats stats = rig_stats(&rig);
    assert_int_equal(stats.requests_sent, stats.requests_done);
    assert_int_equal(stats.tree.orphans, 0);
    /* each refinement brought four nodes, each root one: no node came twice */
    uint32_t roots = 4;
    assert_int_equal(stats.tree.nodes_held, roots + 4 * (rig_heights(&rig) - roots));
    rig_close(&rig);
}

static void full_list_stops_receiving(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig_client(&rig, 2 * MB);
    rig_settle(&rig, 8);
    /* the main thread does not run */
    for (int i = 0; i < 500; i++) ff_client_work(rig.client, rig.now_us += 10000);
    assert_in_range(rig.client->news.high, 1, rig.client->news.item_slots);
    assert_int_equal(rig_stats(&rig).reconnects, 0);
    assert_comes_whole(&rig);
    rig_close(&rig);
}

static void too_long_a_message_fails_alone(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 8); /* 256 x 256 images */
    rig_client(&rig, 2 * MB);
    rig.client->first.stream.recv_bytes = 2000; /* nodes fit, images do not */
    assert_true(rig_settle(&rig, 2000));
    ff_client_stats stats = rig_stats(&rig);
    assert_true(stats.requests_failed > 0);
    assert_int_equal(stats.protocol_errors, 0);
    assert_int_equal(stats.reconnects, 0);
    assert_true(rig_same_picture(&rig, &whole));
    rig_close(&rig);
}

static void undecodable_payloads_are_tried_thrice(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.no_views = 1; /* each refusal ends a request */
    rig_client(&rig, 2 * MB);
    rig_settle(&rig, 3);
    rig.client->first.intake.info[0].texture_log2 = 0;
    rig.client->first.intake.info[0].codec = FF_CODEC_RAW; /* the peer speaks another version */
    for (int i = 0; i < 200; i++) rig_step(&rig, 50000);
    ff_client_stats stats = rig_stats(&rig);
    assert_true(stats.requests_failed > 0);
    assert_int_equal(stats.requests_failed % FF_REFUSALS_TRIES, 0);
    assert_int_equal(stats.in_flight + stats.queued, 0);
    assert_adds_up(&rig);
    rig_close(&rig);
}

/* ---- the queue by itself ---- */

static void queue_goes_by_class_then_value_then_age(void **state)
{
    (void)state;
    static ff_request slots[300];
    ff_requests requests;
    ff_request out;
    assert_true(ff_requests_bytes(8) <= sizeof slots);
    ff_requests_init(&requests, 8, slots);
    ff_requests_rank_begin(&requests);
    ff_requests_want(&requests, FF_KIND_REFINEMENT, 1, FF_CLASS_PREFETCH, 900, 0, NULL);
    ff_requests_want(&requests, FF_KIND_REFINEMENT, 2, FF_CLASS_IN_VIEW, 100, 0, NULL);
    ff_requests_want(&requests, FF_KIND_REFINEMENT, 3, FF_CLASS_IN_VIEW, 5000, 0, NULL);
    ff_requests_want(&requests, FF_KIND_REFINEMENT, 4, FF_CLASS_IN_VIEW, 5000, 0, NULL);
    ff_requests_want(&requests, FF_KIND_ROOT, 5, FF_CLASS_FIRST, 1, 0, NULL);
    ff_requests_rank_end(&requests);
    static const ff_key order[] = { 5, 3, 4, 2 };
    for (unsigned i = 0; i < 4; i++) {
        assert_true(ff_requests_next(&requests, 0, 8, 1 << 20, 0, &out));
        assert_int_equal(out.key, order[i]);
    }
    /* prefetch only when allowed */
    assert_false(ff_requests_next(&requests, 0, 8, 1 << 20, 0, &out));
    assert_true(ff_requests_next(&requests, 0, 8, 1 << 20, 1, &out));
    sys_mutex_destroy(&requests.mutex);
}

/* The reserve leaves last, while nothing else is out, and only an eighth of the window of it. */
static void the_reserve_leaves_on_an_idle_link(void **state)
{
    (void)state;
    static ff_request slots[300];
    ff_requests requests;
    ff_request out, other;
    ff_requests_init(&requests, 8, slots);
    for (ff_key key = 1; key < 9; key++)
        ff_requests_want(&requests, FF_KIND_REFINEMENT, key, FF_CLASS_RESERVE, 9000, 0, NULL);
    ff_requests_want(&requests, FF_KIND_REFINEMENT, 20, FF_CLASS_PREFETCH, 1, 0, NULL);
    assert_true(ff_requests_waiting(&requests, FF_CLASS_PREFETCH));
    assert_false(ff_requests_waiting(&requests, FF_CLASS_IN_VIEW));
    assert_true(ff_requests_next(&requests, 0, 8, 4000, 1, &other));
    assert_int_equal(other.key, 20);
    assert_false(ff_requests_next(&requests, 0, 8, 4000, 1, &out)); /* something is out */
    assert_false(ff_requests_waiting(&requests, FF_CLASS_PREFETCH));
    ff_requests_arrived(&requests, other.id, 200);
    assert_false(ff_requests_next(&requests, 0, 8, 4000, 0, &out)); /* power is low */
    unsigned sent = 0;
    while (ff_requests_next(&requests, 0, 8, 4000, 1, &out)) sent++;
    assert_int_equal(sent, 3); /* of 200 bytes each, the third while fewer than 500 are out */
    assert_int_equal(requests.counts.reserve_sent, 3);
    ff_requests_want(&requests, FF_KIND_REFINEMENT, 30, FF_CLASS_IN_VIEW, 1, 0, NULL);
    assert_true(ff_requests_next(&requests, 0, 8, 4000, 1, &other));
    assert_int_equal(other.key, 30);            /* what comes into view does not wait for it */
    ff_requests_came(&requests, other.id, 400); /* the first of several */
    ff_requests_came(&requests, out.id, 70);
    ff_requests_arrived(&requests, out.id, 80);
    assert_int_equal(requests.counts.reserve_bytes, 150);
    assert_int_equal(requests.counts.reserve_in_flight, 2);
    ff_requests_lost(&requests);
    assert_int_equal(requests.counts.reserve_in_flight, 0);
    sys_mutex_destroy(&requests.mutex);
}

static void window_leaves_two_always(void **state)
{
    (void)state;
    static ff_request slots[300];
    ff_requests requests;
    ff_request out;
    ff_requests_init(&requests, 8, slots);
    for (ff_key key = 0; key < 20; key++)
        ff_requests_want(&requests, FF_KIND_ROOT, key, FF_CLASS_FIRST, 1, 0, NULL);
    assert_true(ff_requests_next(&requests, 0, 1, 0, 1, &out));
    assert_true(ff_requests_next(&requests, 0, 1, 0, 1, &out));
    assert_false(ff_requests_next(&requests, 0, 1, 0, 1, &out));
    for (int i = 2; i < 8; i++) assert_true(ff_requests_next(&requests, 0, 8, 1 << 20, 1, &out));
    assert_false(ff_requests_next(&requests, 0, 8, 1 << 20, 1, &out));
    ff_requests_lost(&requests);
    assert_int_equal(requests.counts.queued, 20);
    assert_int_equal(requests.counts.bytes_in_flight, 0);
    ff_requests_rank_begin(&requests);
    ff_requests_rank_end(&requests);
    assert_int_equal(requests.counts.dropped, 20);
    sys_mutex_destroy(&requests.mutex);
}

static void estimate_finds_the_link(void **state)
{
    (void)state;
    ff_link_estimate link;
    ff_link_estimate_reset(&link);
    assert_int_equal(ff_link_estimate_window(&link), FF_WINDOW_BYTES_UNTIMED);
    int64_t now_us = 0;
    for (int i = 0; i < 200; i++) { /* 5500 bytes/s, 800 ms */
        ff_link_estimate_sent(&link, now_us);
        link.window_full = 1;
        now_us += 100000;
        ff_link_estimate_received(&link, 550, 1, now_us);
        ff_link_estimate_answer(&link, now_us - 800000, now_us);
    }
    assert_in_range(link.bytes_s, 5400, 5600);
    assert_int_equal(link.rtt_us, 800000);
    assert_in_range(ff_link_estimate_window(&link), 8600, 9000);
    /* a stall does not make the client forget the link's rate */
    ff_link_estimate_received(&link, 50, 1, now_us + 30000000);
    assert_true(link.bytes_s > 4500);
}

/* NB-IoT: an answer takes 6 s, then it comes as fast as the link goes. */
static void the_way_there_and_back_is_no_slowness(void **state)
{
    (void)state;
    for (int known = 0; known < 2; known++) {
        ff_link_estimate link;
        ff_link_estimate_reset(&link);
        assert_int_equal(ff_link_estimate_window(&link), FF_WINDOW_BYTES_UNTIMED);
        if (known) ff_link_estimate_answer(&link, 0, 6000000);
        ff_link_estimate_sent(&link, 0);
        for (int64_t now_us = 6000000; now_us < 13000000; now_us += 100000) {
            ff_link_estimate_received(&link, 300, 1, now_us);
            ff_link_estimate_answer(&link, 0, 6000000);
        }
        assert_in_range(link.bytes_s, 2900, 3100);
    }
    /* a single answer tells of no rate */
    ff_link_estimate link;
    ff_link_estimate_reset(&link);
    ff_link_estimate_answer(&link, 0, 6000000);
    ff_link_estimate_sent(&link, 0);
    ff_link_estimate_received(&link, 300, 0, 6010000);
    assert_int_equal(link.bytes_s, 0);
}

/* ---- threads ---- */

static void worker_thread_brings_the_same_picture(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.use_thread = 1;
    rig_client(&rig, 2 * MB);
    int same = 0;
    for (int i = 0; i < 20000 && !same; i++) {
        rig_step(&rig, 1000);
        sys_sleep_us(500);
        ff_client_stats stats = rig_stats(&rig);
        same = stats.have_terrain && !stats.queued && !stats.in_flight &&
               rig_same_picture(&rig, &whole);
    }
    assert_true(same);
    rig_close(&rig); /* joins */
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(connection_cut_after_any_byte),
                                        cmocka_unit_test(cut_again_and_again),
                                        cmocka_unit_test(bytes_in_crumbs),
                                        cmocka_unit_test(nonsense_after_any_byte),
                                        cmocka_unit_test(peer_stops_in_mid_message),
                                        cmocka_unit_test(silence_is_waited_out_for_its_time),
                                        cmocka_unit_test(backs_off_when_nobody_answers),
                                        cmocka_unit_test(no_way_to_reconnect_keeps_the_picture),
                                        cmocka_unit_test(another_terrain_replaces_all),
                                        cmocka_unit_test(requests_are_never_asked_twice),
                                        cmocka_unit_test(full_list_stops_receiving),
                                        cmocka_unit_test(too_long_a_message_fails_alone),
                                        cmocka_unit_test(undecodable_payloads_are_tried_thrice),
                                        cmocka_unit_test(queue_goes_by_class_then_value_then_age),
                                        cmocka_unit_test(the_reserve_leaves_on_an_idle_link),
                                        cmocka_unit_test(window_leaves_two_always),
                                        cmocka_unit_test(estimate_finds_the_link),
                                        cmocka_unit_test(the_way_there_and_back_is_no_slowness),
                                        cmocka_unit_test(worker_thread_brings_the_same_picture) };
    return cmocka_run_group_tests(tests, make_whole, free_whole);
}
