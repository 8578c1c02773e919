/* Packs in files, joined as the grounds of one server: what does not go together is told with the
 * file's name, and requests reach each of them. */
#include "../../server/packs/ff_packs.h"
#include "../../server/session/ff_session.h"
#include "../../server/view/ff_view_parts.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#define PACKS 3

static char path[PACKS][64];

/* A pack of 2 tiles, 5 km east of the one before it, as a file. */
static void write_pack(unsigned number, int32_t epsg)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 1), .height = pack_fixture_hills };
    size_t bytes;
    desc.info.epsg = epsg;
    desc.info.origin_x_mm = 5000000 * (int64_t)number;
    uint8_t *pack = pack_fixture_make(&desc, &bytes);
    snprintf(path[number], sizeof path[number], "packs.%d.%u.ffp", (int)getpid(), number);
    FILE *file = fopen(path[number], "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(pack, 1, bytes, file), bytes);
    fclose(file);
    free(pack);
}

static void remove_packs(void)
{
    for (unsigned i = 0; i < PACKS; i++) unlink(path[i]);
}

static int opened(ff_packs *packs, size_t count)
{
    const char *const list[PACKS] = { path[0], path[1], path[2] };
    return ff_packs_open(packs, list, count);
}

static void what_does_not_go_together_is_told_with_its_name(void **state)
{
    static ff_packs packs;
    (void)state;
    write_pack(0, 32632);
    write_pack(1, 32633);
    write_pack(2, 32632);
    assert_int_equal(opened(&packs, 2), FF_ERR_UNSUPPORTED);
    assert_non_null(strstr(packs.why, path[1]));
    assert_non_null(strstr(packs.why, "--t-srs"));
    ff_packs_close(&packs);
    memcpy(path[1], path[0], sizeof path[1]); /* the same one twice */
    assert_int_equal(opened(&packs, 2), FF_ERR_ARGUMENT);
    assert_non_null(strstr(packs.why, "farfield-merge"));
    ff_packs_close(&packs);
    strcpy(path[1], "packs.no-such-file.ffp");
    assert_int_equal(opened(&packs, 2), FF_ERR_NOT_FOUND);
    assert_non_null(strstr(packs.why, path[1]));
    ff_packs_close(&packs);
    remove_packs();
    snprintf(path[1], sizeof path[1], "packs.%d.1.ffp", (int)getpid());
    remove_packs();
}

/* ---- requests ---- */

/* The next message of the session, which is whole. */
static ff_message next_of(ff_session *session)
{
    static uint8_t copy[1 << 16];
    const uint8_t *bytes;
    ff_message message = { .type = FF_MSG_PING };
    size_t count = ff_session_output(session, &bytes);
    assert_in_range(count, 1, sizeof copy);
    memcpy(copy, bytes, count);
    int used = ff_message_decode(copy, count, &message);
    assert_true(used > 0);
    ff_session_sent(session, (size_t)used);
    return message;
}

static void say(ff_session *session, const ff_message *message)
{
    uint8_t bytes[512];
    int count = ff_message_encode(message, bytes, sizeof bytes);
    assert_true(count > 0);
    assert_int_equal(ff_session_receive(session, bytes, (size_t)count, 0), count);
}

static ff_session *greeted(const ff_pack *pack)
{
    ff_session *session = ff_session_create(&(ff_session_desc){ .pack = pack });
    ff_message hello = { .type = FF_MSG_HELLO, .u.hello.version = FF_PROTOCOL_VERSION };
    say(session, &hello);
    say(session, &(ff_message){ .type = FF_MSG_CAPS });
    ff_message welcome = next_of(session);
    assert_int_equal(welcome.type, FF_MSG_WELCOME);
    assert_int_equal(ff_welcome_count(&welcome.u.welcome), 3);
    return session;
}

static void nodes_of_every_pack_are_answered(void **state)
{
    static ff_packs packs;
    (void)state;
    for (unsigned i = 0; i < PACKS; i++) write_pack(i, 32632);
    assert_int_equal(opened(&packs, 3), FF_OK);
    ff_session *session = greeted(&packs.pack[0]);
    for (uint32_t tile = 0; tile <= 6; tile++) {
        ff_message ask = { .type = FF_MSG_GET, .kind = FF_KIND_REFINEMENT };
        const uint8_t *payload;
        ask.u.get = (ff_get){ .key = ff_key_make(tile, 1, 2) };
        say(session, &ask);
        ff_message answer = next_of(session);
        if (tile == 6) {
            assert_int_equal(answer.type, FF_MSG_FAILED);
            assert_int_equal(answer.u.failed.error, FF_ERR_NOT_FOUND);
            break;
        }
        assert_int_equal(answer.type, FF_MSG_ANSWER);
        int bytes = ff_pack_record(&packs.pack[tile / 2], FF_SECTION_REFINEMENT,
                                   ff_key_make(tile, 1, 2), &payload);
        assert_int_equal(answer.u.data.byte_count, bytes);
        assert_memory_equal(answer.u.data.bytes, payload, (size_t)bytes);
    }
    ff_session_destroy(session);
    ff_packs_close(&packs);
    remove_packs();
}

static void a_view_brings_ground_of_every_pack_in_sight(void **state)
{
    static ff_packs packs;
    ff_get_view view = { .position_wu = { -2000 * 256, 1000 * 256, 2500 * 256 },
                         .yaw = 1 << 14,
                         .pitch = (uint16_t)-2000,
                         .focal_q8 = 208 * 256,
                         .width = 240,
                         .height = 320,
                         .measure = FF_VIEW_BY_PIXELS,
                         .allowed_q8 = 512,
                         .reach_wu = INT32_MAX,
                         .bytes_max = 1 << 20 };
    ff_view_part part[FF_PARTS_MAX];
    ff_view_front front;
    unsigned of[PACKS] = { 0 };
    (void)state;
    for (unsigned i = 0; i < PACKS; i++) write_pack(i, 32632);
    assert_int_equal(opened(&packs, 3), FF_OK);
    int count = ff_view_parts(&packs.pack[0], &view, part, &front);
    assert_true(count > 0);
    for (int i = 0; i < count; i++) {
        const uint8_t *payload;
        assert_in_range(ff_key_tile(part[i].key), 0, 5);
        of[ff_key_tile(part[i].key) / 2]++;
        assert_true(ff_pack_record(&packs.pack[0],
                                   (enum ff_section_kind)ff_kind[part[i].kind].section, part[i].key,
                                   &payload) > 0);
    }
    for (unsigned i = 0; i < PACKS; i++) assert_true(of[i] >= 2);
    /* named of the last one: what comes lies below that */
    view.count = 1;
    view.roots = 1;
    view.below[0] = ff_key_make(4, 0, 0);
    count = ff_view_parts(&packs.pack[0], &view, part, &front);
    assert_true(count > 1);
    for (int i = 0; i < count; i++) assert_int_equal(ff_key_tile(part[i].key), 4);
    ff_packs_close(&packs);
    remove_packs();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_does_not_go_together_is_told_with_its_name),
        cmocka_unit_test(nodes_of_every_pack_are_answered),
        cmocka_unit_test(a_view_brings_ground_of_every_pack_in_sight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
