/* Sides of refinements in a session: those that the client has, or has been sent, do not go again.
 */
#include "../../protocol/message/ff_parts.h"
#include "../../protocol/shape/ff_shape.h"
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
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 1, 1), .height = pack_fixture_hills };
    size_t bytes;
    (void)state;
    desc.info.codec = FF_CODEC_TRAINED;
    pack_bytes = pack_fixture_make(&desc, &bytes);
    return !pack_bytes || ff_pack_open(&pack, pack_bytes, bytes) != FF_OK;
}

static int close_pack(void **state)
{
    (void)state;
    free(pack_bytes);
    return 0;
}

static ff_session *greeted(void)
{
    ff_session *session = ff_session_create(&(ff_session_desc){ .pack = &pack });
    assert_non_null(session);
    session_greet(session);
    return session;
}

static ff_residuals told(ff_key key, const uint8_t *bytes, size_t count)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    const ff_terrain_info *info = &pack.header.info;
    ff_residuals out = { .value = value, .cells = ff_shape_cells(info, key, 1) };
    void *memory = malloc(ff_decoder_bytes(info));
    ff_decoder *decoder = ff_decoder_create(info, memory, ff_decoder_bytes(info));
    assert_int_equal(ff_decode_refinement(decoder, bytes, count, &out), FF_OK);
    free(memory);
    return out;
}

static void a_node_comes_without_the_sides_its_client_has(void **state)
{
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    const ff_key key = ff_key_make(0, 2, 5);
    const uint8_t *payload;
    (void)state;
    ff_session *session = greeted();
    int bytes = ff_pack_record(&pack, FF_SECTION_REFINEMENT, key, &payload);
    for (unsigned sides = 0; sides < 16; sides++) {
        ff_message ask = { .type = FF_MSG_GET, .kind = FF_KIND_REFINEMENT };
        ask.u.get = (ff_get){ key, (uint8_t)sides };
        int fewer = ff_without_sides(&pack.header.info, payload, (size_t)bytes, sides, less);
        assert_in_range(fewer, 1, bytes - 1);
        session_tell(session, &ask);
        ff_message heard = session_heard(session);
        assert_int_equal(heard.type, FF_MSG_ANSWER);
        assert_int_equal(heard.u.data.byte_count, fewer);
        assert_memory_equal(heard.u.data.bytes, less, (size_t)fewer);
        assert_int_equal(told(key, less, (size_t)fewer).sides, sides);
    }
    ff_session_destroy(session);
}

static int has_come(const ff_key *list, unsigned count, ff_key key)
{
    while (count > 0 && list[count - 1] != key) count--;
    return count > 0;
}

static void no_side_goes_twice_in_a_view(void **state)
{
    static ff_parts parts;
    static ff_key come[FF_PARTS_MAX];
    unsigned count = 0, left_out = 0;
    ff_message ask = session_deep_view();
    (void)state;
    ff_session *session = greeted();
    session_tell(session, &ask);
    ff_parts_begin(&parts, &ask.u.view);
    while (!ff_parts_done(&parts)) {
        enum ff_kind kind;
        ff_key key;
        int named;
        ff_message heard = session_heard(session);
        assert_int_equal(heard.type, FF_MSG_ANSWER);
        const ff_part *part = &heard.u.part;
        assert_true(ff_parts_next(&parts, &kind, &key, &named));
        if (kind == FF_KIND_REFINEMENT && part->byte_count) {
            ff_residuals residuals = told(key, part->bytes, part->byte_count);
            for (unsigned side = 0; side < FF_SIDE_COUNT && residuals.apart == FF_SIDES_BARE;
                 side++) {
                ff_key beside = ff_shape_neighbour(&pack.header.info, key, (enum ff_side)side).key;
                int known = beside != FF_KEY_NONE && has_come(come, count, beside);
                assert_int_equal(residuals.sides >> side & 1, known);
                left_out += (unsigned)known;
            }
            come[count++] = key;
        }
        assert_int_equal(ff_parts_take(&parts, part), FF_OK);
    }
    assert_true(count > 20 && left_out > count);
    ff_session_destroy(session);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_node_comes_without_the_sides_its_client_has),
        cmocka_unit_test(no_side_goes_twice_in_a_view),
    };
    return cmocka_run_group_tests(tests, open_pack, close_pack);
}
