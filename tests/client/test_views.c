/* Ground of which a view lacks several levels comes in one answer; what a server does not answer so
 * is asked for singly. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define MB      (1 << 20)
#define UNTIMED 16384 /* bytes of a view while nothing is known of the link */

static client_rig whole; /* asked level by level */

static int make_whole(void **state)
{
    (void)state;
    rig_open(&whole, 0);
    whole.desc.no_views = 1;
    rig_client(&whole, 2 * MB);
    return !rig_settle(&whole, 400);
}

static int free_whole(void **state)
{
    (void)state;
    rig_close(&whole);
    return 0;
}

/* Steps of 50 ms until all is here. */
static unsigned steps_to_whole(client_rig *rig)
{
    unsigned steps = 0;
    for (; steps < 400; steps++) {
        rig_step(rig, 50000);
        if (rig_stats(rig).have_terrain && rig_same_picture(rig, &whole)) break;
    }
    return steps;
}

static void all_levels_come_in_one_answer(void **state)
{
    unsigned steps[3];
    (void)state;
    for (int i = 0; i < 3; i++) {
        client_rig rig;
        rig_open(&rig, 0);
        rig.desc.no_views = i == 0;
        rig.desc.place_known = i == 2;
        rig_client(&rig, 2 * MB);
        steps[i] = steps_to_whole(&rig);
        assert_true(rig_settle(&rig, 400));
        assert_true(rig_same_picture(&rig, &whole));
        assert_int_equal(rig.asked[FF_KIND_VIEW], i > 0);
        assert_int_equal(rig.asked[FF_KIND_ROOT] > 0, i == 0);
        assert_int_equal(rig_stats(&rig).requests_sent, rig_stats(&rig).requests_done);
        assert_int_equal(rig_stats(&rig).tree.orphans, 0);
        if (i == 1) assert_int_equal(rig_heights(&rig), rig_heights(&whole));
        rig_close(&rig);
    }
    assert_true(steps[0] >= steps[1] + 2);
    assert_true(steps[1] >= steps[2]);
}

/* Beside far sets the server's views are as coarse far away as the client's own. */
static void far_ground_comes_as_coarsely_as_asked_for(void **state)
{
    uint32_t heights[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        client_rig rig;
        rig_open(&rig, 0);
        rig.desc.far = (ff_far_desc){ .enabled = FF_FAR_PAINT,
                                      .front_wu = 300 * FF_WU_PER_METRE,
                                      .coarse = 16 };
        rig.desc.no_views = i == 0;
        rig.desc.place_known = i == 1;
        rig.no_faces = 1; /* nor sectors */
        rig_client(&rig, 2 * MB);
        for (int step = 0; step < 200; step++) rig_step(&rig, 50000);
        heights[i] = rig_heights(&rig);
        assert_int_equal(rig.asked[FF_KIND_VIEW] > 0, i);
        assert_true(rig.asked[FF_KIND_FAR] > 0);
        rig_close(&rig);
    }
    assert_true(heights[0] < rig_heights(&whole) * 3 / 4);
    assert_int_equal(heights[1], heights[0]);
}

/* The greeting and the view leave before any answer has come; so does nothing else. */
static void the_greeting_brings_a_known_place(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.place_known = 1;
    rig.silent_at = 0;
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 20; i++) rig_step(&rig, 50000);
    assert_int_equal(rig.asked[FF_KIND_VIEW], 1);
    assert_int_equal(rig.asked[FF_KIND_ROOT], 0);
    rig.silent_at = UINT64_MAX;
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.asked[FF_KIND_VIEW], 1);
    assert_true(rig_same_picture(&rig, &whole));
    rig_close(&rig);
}

/* On a slow link the viewer is somewhere else when the answer comes. */
static void the_greeting_asks_for_where_the_viewer_will_be(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.place_known = 1;
    rig.desc.velocity_wu_s[0] = 40 * FF_WU_PER_METRE;
    rig.desc.velocity_wu_s[1] = -20 * FF_WU_PER_METRE;
    rig.desc.first_answer_ms = 6000;
    rig.silent_at = 0;
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 20; i++) rig_step(&rig, 50000);
    const ff_get_view *asked = &rig.client->first.requests.view;
    assert_int_equal(rig.asked[FF_KIND_VIEW], 1);
    assert_int_equal(asked->position_wu[0], rig.camera.pos_wu[0] + 240 * FF_WU_PER_METRE);
    assert_int_equal(asked->position_wu[1], rig.camera.pos_wu[1] - 120 * FF_WU_PER_METRE);
    assert_int_equal(asked->position_wu[2], rig.camera.pos_wu[2]);
    rig_close(&rig);
}

static void a_view_is_of_where_the_viewer_will_be(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.no_reserve = 1;
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    for (int i = 0; i < 40; i++) {
        rig.camera.pos_wu[0] += 2 * FF_WU_PER_METRE;
        rig_step(&rig, 50000);
    }
    unsigned before = rig.asked[FF_KIND_VIEW];
    rig.camera.yaw += 32768;
    for (int i = 0; i < 4 && rig.asked[FF_KIND_VIEW] == before; i++) rig_step(&rig, 50000);
    assert_int_equal(rig.asked[FF_KIND_VIEW], before + 1);
    const ff_get_view *asked = &rig.client->first.requests.view;
    int32_t ahead_wu = (int32_t)(40 * FF_WU_PER_METRE * rig_stats(&rig).rtt_ms / 1000);
    assert_true(ahead_wu > 0);
    assert_in_range(asked->position_wu[0] - rig.camera.pos_wu[0], ahead_wu * 7 / 8,
                    ahead_wu * 9 / 8 + FF_WU_PER_METRE);
    rig_close(&rig);
}

static void a_leap_is_answered_at_once(void **state)
{
    (void)state;
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.no_reserve = 1;
    rig.camera.pos_wu[0] = 3900 * FF_WU_PER_METRE;
    rig.camera.pos_wu[2] = 300 * FF_WU_PER_METRE;
    rig.camera.yaw = 16384; /* out over the edge */
    rig_client(&rig, 2 * MB);
    rig.chop = 40; /* the first view is still coming */
    for (int i = 0; i < 6; i++) rig_step(&rig, 50000);
    rig.camera = whole.camera;
    for (int i = 0; i < 6; i++) rig_step(&rig, 50000);
    rig.chop = 0;
    assert_true(rig_settle(&rig, 400));
    assert_true(rig_same_picture(&rig, &whole));
    assert_int_equal(rig_stats(&rig).protocol_errors, 0);
    rig_close(&rig);
}

/* A server that would not: it is not asked so again. */
static void refused_views_are_asked_for_singly(void **state)
{
    (void)state;
    client_rig rig;
    ff_request request = { .id = 0 };
    rig_open(&rig, 0);
    rig.silent_at = 200; /* the WELCOME comes, no part of the view does */
    rig_client(&rig, 2 * MB);
    for (int i = 0; i < 6; i++) rig_step(&rig, 50000);
    assert_int_equal(rig.asked[FF_KIND_VIEW], 1);
    uint16_t id = rig.client->first.requests.view_id;
    assert_true(ff_requests_answered(&rig.client->first.requests, id, &request));
    assert_int_equal(ff_intake_failed(&rig.client->first.intake, &request, FF_ERR_UNSUPPORTED),
                     FF_OK);
    rig.cut_at = rig.bytes_down; /* with the answers of this server, which does answer */
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.asked[FF_KIND_VIEW], 1);
    assert_true(rig.asked[FF_KIND_ROOT] > 0);
    assert_true(rig_same_picture(&rig, &whole));
    rig_close(&rig);
}

/* What a view names and its server cannot read is tried thrice, like any other thing, and then
 * left; the rest comes. */
static void damaged_records_are_left_out(void **state)
{
    (void)state;
    client_rig rig;
    const uint8_t *payload;
    rig_open(&rig, 0);
    assert_true(ff_pack_record(&rig.pack, FF_SECTION_ROOT, ff_key_make(0, 0, 0), &payload) > 0);
    rig.pack_bytes[payload - rig.pack_bytes] ^= 1;
    rig_client(&rig, 2 * MB);
    assert_true(rig_settle(&rig, 400));
    assert_in_range(rig.asked[FF_KIND_VIEW] + rig.asked[FF_KIND_ROOT], FF_REFUSALS_TRIES,
                    2 * FF_REFUSALS_TRIES);
    assert_int_equal(rig_stats(&rig).protocol_errors, 0);
    assert_true(rig_stats(&rig).tree.nodes_held > 20);
    for (int i = 0; i < 50; i++) rig_step(&rig, 50000);
    assert_in_range(rig.asked[FF_KIND_VIEW], 1, 2 * FF_REFUSALS_TRIES);
    rig_close(&rig);
}

/* ---- a server that answers otherwise ---- */

typedef struct liar {
    ff_pack *pack;
    const ff_message *answer; /* to the first view */
    unsigned answers;
    int answered;
    uint8_t bytes[1 << 15];
    size_t count;
    unsigned connections;
} liar;

static void say(liar *server, const ff_message *message)
{
    int count = ff_message_encode(message, server->bytes + server->count,
                                  sizeof server->bytes - server->count);
    assert_true(count > 0);
    server->count += (size_t)count;
}

static int liar_send(void *state, const uint8_t *bytes, size_t count)
{
    liar *server = state;
    ff_message heard;
    size_t at = 0;
    for (int used; (used = ff_message_decode(bytes + at, count - at, &heard)) > 0;
         at += (size_t)used) {
        ff_message answer = { .type = FF_MSG_WELCOME };
        answer.u.welcome = (ff_welcome){ FF_PROTOCOL_VERSION, server->pack->header.info, { 0 } };
        if (heard.type == FF_MSG_CAPS) say(server, &answer);
        if (heard.type != FF_MSG_GET || heard.kind != FF_KIND_VIEW) continue;
        for (unsigned i = 0; !server->answered && i < server->answers; i++)
            say(server, &server->answer[i]);
        server->answered = 1;
    }
    return (int)count;
}

static int liar_recv(void *state, uint8_t *bytes, size_t capacity)
{
    liar *server = state;
    size_t count = server->count < capacity ? server->count : capacity;
    memcpy(bytes, server->bytes, count);
    server->count -= count;
    memmove(server->bytes, server->bytes + count, server->count);
    return (int)count;
}

static void liar_close(void *state) { ((liar *)state)->count = 0; }

static int liar_reconnect(void *state)
{
    ((liar *)state)->connections++;
    return FF_OK;
}

/* Protocol errors that an answer makes. */
static uint32_t errors_of(client_rig *rig, const ff_message *answer, unsigned answers)
{
    static liar server;
    server = (liar){ .pack = &rig->pack, .answer = answer, .answers = answers };
    rig->stream = (sys_stream){ &server, liar_send, liar_recv, liar_close, liar_reconnect };
    rig_client(rig, 2 * MB);
    ff_session_destroy(rig->session); /* the other server's */
    rig->session = NULL;
    for (int i = 0; i < 40; i++) {
        rig->now_us += 50000;
        ff_client_update(rig->client, rig->now_us, &rig->camera);
        ff_client_work(rig->client, rig->now_us);
    }
    uint32_t errors = rig_stats(rig).protocol_errors;
    ff_client_destroy(rig->client);
    rig->client = NULL;
    free(rig->memory);
    rig->memory = NULL;
    return errors;
}

static ff_message roots(const char *tiles, size_t count)
{
    return (ff_message){ .type = FF_MSG_ROOTS,
                         .u.roots = { (const uint8_t *)tiles, (uint32_t)count } };
}

static ff_message part_of(const client_rig *rig, enum ff_kind kind, ff_key key, uint8_t below)
{
    ff_message part = { .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW, .u.part.below = below };
    int bytes = ff_pack_record(&rig->pack, (enum ff_section_kind)ff_kind[kind].section, key,
                               &part.u.part.bytes);
    assert_true(bytes > 0);
    part.u.part.byte_count = (uint32_t)bytes;
    return part;
}

/* The answer to a client that knows its place: a root, and what refines it to the finest level. */
static void good_answer(const client_rig *rig, ff_message answer[6])
{
    ff_key key = ff_key_make(0, 0, 0);
    answer[0] = roots("\0", 1);
    answer[1] = part_of(rig, FF_KIND_ROOT, key, 1);
    for (int level = 0; level < 3; level++, key = ff_key_child(key, 0))
        answer[2 + level] = part_of(rig, FF_KIND_REFINEMENT, key, level < 2);
    answer[5] = answer[4];
}

static void parts_nobody_asked_for_end_the_connection(void **state)
{
    (void)state;
    client_rig rig;
    ff_message answer[6];
    rig_open(&rig, 0);
    rig.desc.no_reserve = 1;
    rig.desc.place_known = 1;
    good_answer(&rig, answer);
    assert_int_equal(errors_of(&rig, answer, 5), 0);
    assert_true(errors_of(&rig, answer, 6) > 0); /* one more than were announced */
    answer[4].u.part.below = 1;                  /* nothing refines the finest level */
    assert_true(errors_of(&rig, answer, 6) > 0);
    answer[0] = roots("\4", 1); /* there are four tiles */
    assert_true(errors_of(&rig, answer, 2) > 0);
    assert_true(errors_of(&rig, answer + 1, 1) > 0); /* of which tile? */
    rig.desc.place_known = 0;
    rig.camera.pos_wu[0] = rig.camera.pos_wu[1] = 200 * FF_WU_PER_METRE;
    rig.camera.yaw = 40960; /* sees one tile alone, and names it */
    rig.camera.pos_wu[2] = 1500 * FF_WU_PER_METRE;
    answer[0] = roots("\0", 1);
    assert_int_equal(errors_of(&rig, answer + 1, 1), 0);
    assert_true(errors_of(&rig, answer, 2) > 0); /* it is told another one */
    rig_close(&rig);
}

/* A server could else keep the client from asking for anything for ever. */
static void parts_are_no_more_than_was_asked_for(void **state)
{
    (void)state;
    static ff_message answer[2 + FF_PARTS_MAX];
    static const char tiles[FF_PARTS_MAX]; /* of tile 0, again and again */
    client_rig rig;
    rig_open(&rig, 0);
    rig.desc.no_reserve = 1;
    rig.desc.place_known = 1;
    for (unsigned i = 1; i < 2 + FF_PARTS_MAX; i++)
        answer[i] = part_of(&rig, FF_KIND_ROOT, ff_key_make(0, 0, 0), 0);
    unsigned most = UNTIMED / answer[1].u.part.byte_count;
    assert_in_range(most, 10, FF_PARTS_MAX - 1);
    answer[0] = roots(tiles, most + 1);
    assert_int_equal(errors_of(&rig, answer, 1 + most), 0);
    assert_true(errors_of(&rig, answer, 1 + most + 1) > 0);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_levels_come_in_one_answer),
        cmocka_unit_test(far_ground_comes_as_coarsely_as_asked_for),
        cmocka_unit_test(the_greeting_brings_a_known_place),
        cmocka_unit_test(the_greeting_asks_for_where_the_viewer_will_be),
        cmocka_unit_test(a_view_is_of_where_the_viewer_will_be),
        cmocka_unit_test(a_leap_is_answered_at_once),
        cmocka_unit_test(refused_views_are_asked_for_singly),
        cmocka_unit_test(damaged_records_are_left_out),
        cmocka_unit_test(parts_nobody_asked_for_end_the_connection),
        cmocka_unit_test(parts_are_no_more_than_was_asked_for),
    };
    return cmocka_run_group_tests(tests, make_whole, free_whole);
}
