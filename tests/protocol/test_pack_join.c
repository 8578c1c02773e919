/* Packs of several grounds: each has its place by its origin, keys number the tiles on, records are
 * found in the pack that has them, and a WELCOME tells of all. */
#include "../../protocol/message/ff_message.h"
#include "../../protocol/shape/ff_shape.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define PACKS (FF_PACKS_JOINED_MAX + 1)

typedef struct some_packs {
    ff_pack pack[PACKS];
    uint8_t *bytes[PACKS];
} some_packs;

static void open_one(some_packs *s, unsigned i, int32_t epsg, int64_t east_mm, int64_t north_mm,
                     uint8_t node_log2)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 1), .height = pack_fixture_hills };
    size_t bytes;
    desc.info.node_log2 = node_log2;
    desc.info.epsg = epsg;
    desc.info.origin_x_mm = east_mm;
    desc.info.origin_y_mm = north_mm;
    s->bytes[i] = pack_fixture_make(&desc, &bytes);
    assert_int_equal(ff_pack_open(&s->pack[i], s->bytes[i], bytes), FF_OK);
}

static void close_all(some_packs *s)
{
    for (unsigned i = 0; i < PACKS; i++) free(s->bytes[i]);
}

static void origins_give_places_to_the_nearest_unit(void **state)
{
    static const struct {
        int64_t mm;
        int32_t wu;
    } row[] = { { 0, 0 },
                { 1000, 256 },
                { -1000, -256 },
                { 2, 1 },
                { 1, 0 },
                { -2, -1 },
                { -1, 0 },
                { 125, 32 },
                { -125, -32 },
                { 500000, 128000 },
                { 3999999999, 1024000000 },
                { -3999999999, -1024000000 } };

    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        ff_terrain_info first = pack_fixture_info(6, 2, 1), other = first;
        first.epsg = other.epsg = 32632;
        first.origin_x_mm = 500000000;
        other.origin_x_mm = 500000000 + row[i].mm;
        other.origin_y_mm = -row[i].mm;
        assert_int_equal(ff_terrain_join(&other, &first, &first), FF_OK);
        assert_int_equal(other.west_wu, row[i].wu);
        assert_in_range(other.south_wu + row[i].wu + 1, 0, 2); /* halves go to the east and north */
        assert_int_equal(other.first_tile, 2);
    }
}

static void a_record_is_found_in_the_pack_that_has_its_tile(void **state)
{
    some_packs s = { 0 };
    const uint8_t *joined, *own;

    (void)state;
    for (unsigned i = 0; i < 3; i++) open_one(&s, i, 32632, 5000 * (int64_t)i, 0, 3);
    assert_int_equal(ff_pack_join(&s.pack[0], &s.pack[1]), FF_OK);
    assert_int_equal(ff_pack_join(&s.pack[0], &s.pack[2]), FF_OK);
    for (uint32_t tile = 0; tile < 6; tile++) {
        ff_pack alone = s.pack[tile / 2];
        ff_key key = ff_key_make(tile, 1, 3);
        assert_ptr_equal(ff_pack_of(&s.pack[0], key), &s.pack[tile / 2]);
        alone.header.info.first_tile = 0;
        alone.next = NULL;
        int bytes = ff_pack_record(&s.pack[0], FF_SECTION_REFINEMENT, key, &joined);
        assert_true(bytes > 0);
        assert_int_equal(
            ff_pack_record(&alone, FF_SECTION_REFINEMENT, ff_key_make(tile % 2, 1, 3), &own),
            bytes);
        assert_ptr_equal(joined, own);
    }
    assert_int_equal(ff_pack_record(&s.pack[0], FF_SECTION_ROOT, ff_key_make(6, 0, 0), &own),
                     FF_ERR_NOT_FOUND);
    assert_null(ff_pack_of(&s.pack[0], ff_key_make(FF_KEY_TILES_MAX - 1, 0, 0)));
    close_all(&s);
}

static void what_does_not_go_together_is_refused(void **state)
{
    some_packs s = { 0 };

    (void)state;
    open_one(&s, 0, 32632, 0, 0, 3);
    open_one(&s, 1, 32632, 0, 0, 3); /* the same ground */
    open_one(&s, 2, 32633, 1000, 0, 3);
    open_one(&s, 3, 0, 1000, 0, 3);
    open_one(&s, 4, 32632, 1000, 0, 2);
    open_one(&s, 5, 32632, INT64_C(9000000000), 0, 3);
    open_one(&s, 6, 32632, INT64_MAX, INT64_MIN, 3);
    static const int expected[] = { 0,
                                    FF_ERR_ARGUMENT,
                                    FF_ERR_UNSUPPORTED,
                                    FF_ERR_UNSUPPORTED,
                                    FF_ERR_UNSUPPORTED,
                                    FF_ERR_RANGE,
                                    FF_ERR_RANGE };
    for (unsigned i = 1; i < 7; i++) {
        assert_int_equal(ff_pack_join(&s.pack[0], &s.pack[i]), expected[i]);
        assert_null(s.pack[0].next);
    }
    close_all(&s);
}

static void there_is_an_end_of_packs(void **state)
{
    some_packs s = { 0 };

    (void)state;
    for (unsigned i = 0; i < PACKS; i++) open_one(&s, i, 32632, 5000 * (int64_t)i, 0, 3);
    for (unsigned i = 1; i < PACKS; i++)
        assert_int_equal(ff_pack_join(&s.pack[0], &s.pack[i]),
                         i < FF_PACKS_JOINED_MAX ? FF_OK : FF_ERR_FULL);
    close_all(&s);
}

/* ---- WELCOME ---- */

static ff_terrain_info ground(unsigned number)
{
    ff_terrain_info info = pack_fixture_info(6, 2, 1);
    info.epsg = 32632;
    info.origin_x_mm = 1000000 * (int64_t)number;
    info.checksum = 0x1000 + number;
    return info;
}

/* A WELCOME of so many grounds, with as many sums of wholes; its bytes. */
static int welcome(unsigned grounds, unsigned wholes, uint8_t *bytes, size_t room)
{
    uint8_t list[FF_CAPS_BYTES_MAX], terrains[FF_TERRAIN_BYTES * FF_WELCOME_GROUNDS],
        sums[4 * FF_WELCOME_GROUNDS];
    ff_writer out = { list, list + sizeof list, FF_OK },
              rest = { terrains, terrains + sizeof terrains, FF_OK },
              whole = { sums, sums + sizeof sums, FF_OK };
    for (unsigned i = 1; i < grounds; i++) {
        ff_terrain_info info = ground(i);
        ff_write_terrain(&rest, &info);
    }
    for (unsigned i = 0; i < wholes; i++) ff_write_bytes(&whole, 0x2000 + i, 4);
    if (wholes) ff_list_write(&out, FF_WELCOME_WHOLE, sums, 4 * wholes);
    if (grounds > 1)
        ff_list_write(&out, FF_WELCOME_TERRAINS, terrains, (uint32_t)(rest.at - terrains));
    ff_message message = { .type = FF_MSG_WELCOME };
    message.u.welcome.version = FF_PROTOCOL_VERSION;
    message.u.welcome.info = ground(0);
    message.u.welcome.more = (ff_list){ list, (uint32_t)(out.at - list) };
    return ff_message_encode(&message, bytes, room);
}

static void a_welcome_tells_of_all_grounds(void **state)
{
    uint8_t bytes[1024];
    ff_message out;

    (void)state;
    for (unsigned grounds = 1; grounds <= FF_WELCOME_GROUNDS; grounds++)
        for (unsigned wholes = 0; wholes <= grounds; wholes += grounds) {
            int count = welcome(grounds, wholes, bytes, sizeof bytes);
            assert_true(count > 0);
            assert_int_equal(ff_message_decode(bytes, (size_t)count, &out), count);
            assert_int_equal(ff_welcome_count(&out.u.welcome), grounds);
            for (unsigned i = 0; i < grounds; i++) {
                ff_terrain_info info;
                uint32_t whole;
                ff_welcome_ground(&out.u.welcome, i, &info, &whole);
                assert_int_equal(info.entered, 0);
                assert_int_equal(info.checksum, 0x1000 + i);
                assert_int_equal(info.first_tile, 2 * i);
                assert_int_equal(info.west_wu, 256000 * i);
                assert_int_equal(whole, wholes ? 0x2000 + i : 0x1000 + i);
            }
        }
}

static void a_welcome_with_parts_of_grounds_is_refused(void **state)
{
    uint8_t bytes[1024];
    ff_message out;

    (void)state;
    for (unsigned wholes = 1; wholes <= 4; wholes++) {
        int count = welcome(3, wholes, bytes, sizeof bytes);
        assert_int_equal(ff_message_decode(bytes, (size_t)count, &out),
                         wholes == 3 ? count : FF_ERR_RANGE);
    }
    int count = welcome(2, 0, bytes, sizeof bytes);
    bytes[count - FF_TERRAIN_BYTES + 40] ^= 1; /* of another system */
    assert_int_equal(ff_message_decode(bytes, (size_t)count, &out), FF_ERR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(origins_give_places_to_the_nearest_unit),
        cmocka_unit_test(a_record_is_found_in_the_pack_that_has_its_tile),
        cmocka_unit_test(what_does_not_go_together_is_refused),
        cmocka_unit_test(there_is_an_end_of_packs),
        cmocka_unit_test(a_welcome_tells_of_all_grounds),
        cmocka_unit_test(a_welcome_with_parts_of_grounds_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
