/* Terrains entered below their top: at which level, which node a key means, what a WELCOME tells.
 */
#include "../../protocol/ff_entry.h"
#include "../../protocol/message/ff_message.h"
#include "../../protocol/shape/ff_shape.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define EDGE_WU (32 * 256 * 64) /* of a tile of 2^6 cells */

static ff_terrain_info terrain(uint32_t samples_x, uint32_t samples_y)
{
    ff_terrain_info info = pack_fixture_info(6, 1, 1);
    ff_shape_cover(&info, samples_x, samples_y);
    return info;
}

static void a_view_lies_in_no_more_than_two_tiles_each_way(void **state)
{
    static const struct {
        int32_t reach_wu;
        uint32_t level;
    } row[] = { { INT32_MAX, 0 },
                { EDGE_WU, 0 },
                { EDGE_WU / 2, 0 },
                { EDGE_WU / 2 - 1, 0 },
                { EDGE_WU / 4 + 1, 0 },
                { EDGE_WU / 4, 1 },
                { EDGE_WU / 8 + 1, 1 },
                { EDGE_WU / 8, 2 },
                { EDGE_WU / 16, 3 },
                { EDGE_WU / 32, 3 },
                { 1, 3 } }; /* a tile is a node at least */
    const ff_terrain_info info = terrain(129, 129);

    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        assert_int_equal(ff_entry_level(&info, row[i].reach_wu), row[i].level);
}

static void tiles_are_as_many_as_a_client_may_walk_over(void **state)
{
    ff_terrain_info info = pack_fixture_info(15, 1, 1);

    (void)state;
    info.spacing_wu = 256;
    ff_shape_cover(&info, 32769, 32769);
    assert_int_equal(ff_entry_level(&info, 256), 8); /* 65536 of them */
}

static void where_there_are_images_every_tile_has_one(void **state)
{
    ff_terrain_info info = terrain(129, 129);

    (void)state;
    info.texture_log2 = 5;
    info.texture_levels = 2;
    assert_int_equal(ff_entry_level(&info, 1), 1);
    assert_int_equal(ff_entry_terrain(&info, 1).texture_levels, 1);
}

static void assert_same_place(const ff_terrain_info *whole, ff_key in_whole,
                              const ff_terrain_info *entered, ff_key key)
{
    ff_frame frame = { 0 };
    ff_placed a = ff_shape_put(whole, &frame, in_whole), b = ff_shape_put(entered, &frame, key);
    ff_extent ground_a = ff_shape_extent(whole, in_whole), ground_b = ff_shape_extent(entered, key);

    assert_int_equal(ground_a.columns, ground_b.columns);
    assert_int_equal(ground_a.rows, ground_b.rows);
    for (uint32_t corner = 0; corner < 4; corner++) {
        int32_t at_a[3], at_b[3];
        uint32_t column = 8 * (corner & 1u), row = 8 * (corner >> 1);
        ff_shape_place(whole, in_whole, &a, column, row, 5, at_a);
        ff_shape_place(entered, key, &b, column, row, 5, at_b);
        assert_memory_equal(at_a, at_b, sizeof at_a);
    }
}

static void keys_mean_the_same_ground(void **state)
{
    static const uint32_t samples[][2] = { { 65, 65 }, { 129, 65 }, { 100, 180 }, { 2, 77 } };

    (void)state;
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++)
        for (uint32_t level = 1; level < 4; level++) {
            ff_terrain_info whole = terrain(samples[i][0], samples[i][1]);
            ff_terrain_info entered = ff_entry_terrain(&whole, level);
            assert_int_equal(ff_terrain_check(&entered), FF_OK);
            assert_false(ff_terrain_same(&whole, &entered));
            entered.first_tile = 1000; /* among others */
            for (uint32_t t = 0; t < ff_shape_tiles(&entered); t++)
                for (uint32_t below = 0; below < ff_terrain_levels(&entered); below++)
                    for (uint32_t code = 0; code < 1u << 2 * below; code++) {
                        ff_key key = ff_key_make(1000 + t, below, code),
                               in_whole = ff_entry_key(&whole, &entered, key);
                        assert_true(ff_terrain_has_node(&whole, in_whole));
                        assert_int_equal(ff_key_level(in_whole), level + below);
                        if (ff_shape_has_ground(&entered, key))
                            assert_same_place(&whole, in_whole, &entered, key);
                    }
        }
}

/* WELCOME of two grounds, with an entry of so many bytes: what comes of it. */
static int welcomed(enum ff_welcome_entry type, const uint8_t *entry, uint32_t count,
                    ff_terrain_info got[2])
{
    uint8_t list[256], row[FF_TERRAIN_BYTES], bytes[512];
    ff_terrain_info info = terrain(129, 129);
    ff_writer out = { list, list + sizeof list, FF_OK }, rest = { row, row + sizeof row, FF_OK };
    ff_message message = { .type = FF_MSG_WELCOME }, read;

    info.epsg = 32632;
    info.texture_log2 = 5;
    info.texture_levels = 2;
    message.u.welcome.version = FF_PROTOCOL_VERSION;
    message.u.welcome.info = info;
    info.origin_x_mm = 10000000;
    ff_write_terrain(&rest, &info);
    ff_list_write(&out, FF_WELCOME_TERRAINS, row, sizeof row);
    ff_list_write(&out, type, entry, count);
    message.u.welcome.more = (ff_list){ list, (uint32_t)(out.at - list) };
    int used = ff_message_encode(&message, bytes, sizeof bytes);
    assert_true(used > 0);
    int rc = ff_message_decode(bytes, (size_t)used, &read);
    for (unsigned i = 0; rc > 0 && i < 2; i++) {
        uint32_t whole;
        ff_welcome_ground(&read.u.welcome, i, &got[i], &whole);
    }
    return rc > 0 ? FF_OK : rc;
}

static void a_welcome_says_what_is_left_out(void **state)
{
    ff_terrain_info got[2];

    (void)state;
    assert_int_equal(welcomed(FF_WELCOME_ENTRY, (const uint8_t[]){ 3, 0 }, 2, got), FF_OK);
    assert_int_equal(got[0].entered, 3);
    assert_int_equal(got[1].entered, 0);
    assert_int_equal(welcomed(FF_WELCOME_ENTRY, (const uint8_t[]){ 0, 12 }, 2, got), FF_OK);
    assert_int_equal(got[1].entered, 12);
    assert_int_equal(welcomed(FF_WELCOME_ENTRY, (const uint8_t[]){ 0, 13 }, 2, got), FF_ERR_RANGE);
    assert_int_equal(welcomed(FF_WELCOME_ENTRY, (const uint8_t[]){ 255, 0 }, 2, got), FF_ERR_RANGE);
    assert_int_equal(welcomed(FF_WELCOME_ENTRY, (const uint8_t[]){ 3 }, 1, got), FF_ERR_RANGE);
    assert_int_equal(welcomed(FF_WELCOME_ENTRY, (const uint8_t[]){ 3, 0, 0 }, 3, got),
                     FF_ERR_RANGE);
}

static void a_welcome_says_down_to_where_all_images_are(void **state)
{
    ff_terrain_info got[2];

    (void)state;
    assert_int_equal(welcomed(FF_WELCOME_IMAGES, (const uint8_t[]){ 2, 0 }, 2, got), FF_OK);
    assert_int_equal(got[0].images_whole, 2);
    assert_int_equal(got[1].images_whole, 0);
    assert_int_equal(welcomed(FF_WELCOME_IMAGES, (const uint8_t[]){ 0, 1 }, 2, got), FF_OK);
    assert_int_equal(got[1].images_whole, 1);
    assert_int_equal(welcomed(FF_WELCOME_ENTRY, (const uint8_t[]){ 0, 1 }, 2, got), FF_OK);
    assert_int_equal(got[0].images_whole, 0);
    assert_int_equal(welcomed(FF_WELCOME_IMAGES, (const uint8_t[]){ 0, 3 }, 2, got), FF_ERR_RANGE);
    assert_int_equal(welcomed(FF_WELCOME_IMAGES, (const uint8_t[]){ 2 }, 1, got), FF_ERR_RANGE);
    assert_int_equal(welcomed(FF_WELCOME_IMAGES, (const uint8_t[]){ 2, 0, 0 }, 3, got),
                     FF_ERR_RANGE);
}

/* Down to a grid of one node each way, on ground that ends within nodes, and below heights. */
static void nodes_that_have_ground_are_counted(void **state)
{
    static const uint32_t samples[][2] = { { 65, 65 }, { 129, 65 }, { 100, 180 }, { 2, 77 } };

    (void)state;
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
        ff_terrain_info whole = terrain(samples[i][0], samples[i][1]);
        for (uint32_t level = 0; level < ff_image_levels(&whole) && level < 6; level++) {
            uint64_t count = 0;
            for (uint32_t t = 0; t < ff_shape_tiles(&whole); t++)
                for (uint32_t code = 0; code < 1u << 2 * level; code++)
                    count += ff_shape_has_ground(&whole, ff_key_make(t, level, code)) != 0;
            assert_int_equal(ff_entry_nodes(&whole, level), count);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_view_lies_in_no_more_than_two_tiles_each_way),
        cmocka_unit_test(tiles_are_as_many_as_a_client_may_walk_over),
        cmocka_unit_test(where_there_are_images_every_tile_has_one),
        cmocka_unit_test(keys_mean_the_same_ground),
        cmocka_unit_test(a_welcome_says_what_is_left_out),
        cmocka_unit_test(a_welcome_says_down_to_where_all_images_are),
        cmocka_unit_test(nodes_that_have_ground_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
