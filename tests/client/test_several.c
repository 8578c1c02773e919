/* A client with several packs and servers: what one lacks another gives, grounds come together, and
 * one that fits none is told and harms nothing. */
#include "../../client/ff_client_local.h"
#include "../rig/client_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define MB   (1u << 20)
#define UTM  32632
#define WIDE (128 * 32) /* metres, of the usual pack each way */

/* A rig whose pack says that it is a part of another one's. */
static void make_part(client_rig *part, const client_rig *of, unsigned texture_log2,
                      uint8_t about[6])
{
    uint32_t whole = of->pack.header.info.checksum;
    about[0] = FF_ABOUT_WHOLE;
    about[1] = 4;
    for (int i = 0; i < 4; i++) about[2 + i] = (uint8_t)(whole >> 8 * i);
    rig_open(part, texture_log2);
    part->about = (ff_list){ about, 6 };
    rig_use_stubs(part, texture_log2);
}

static void close_server(client_rig *rig)
{
    rig->client = NULL;
    rig->memory = NULL;
    rig_close(rig);
}

static void look_around(client_rig *rig)
{
    for (int turn = 0; turn < 4; turn++) {
        rig->camera.yaw += 1 << 14;
        assert_true(rig_settle(rig, 400));
    }
}

static void assert_shows_whole_ground(client_rig *rig, unsigned texture_log2)
{
    client_rig whole;
    rig_open(&whole, texture_log2);
    rig_local_client(&whole, 8 * MB);
    look_around(&whole);
    assert_true(rig_same_picture(rig, &whole));
    for (unsigned i = 0; i < whole.client->textures.slot_count; i++) {
        const ff_texture_slot *slot = &whole.client->textures.slot[i];
        if (slot->tag && ff_client_wears(whole.client, slot->key))
            assert_true(ff_client_wears(rig->client, slot->key));
    }
    rig_close(&whole);
}

static void what_a_part_on_the_device_lacks_the_server_gives(void **state)
{
    (void)state;
    for (unsigned texture_log2 = 0; texture_log2 <= 5; texture_log2 += 5)
        for (int part_first = 0; part_first < 2; part_first++) {
            uint8_t about[6];
            client_rig server, rig;
            rig_open(&server, texture_log2);
            make_part(&rig, &server, texture_log2, about);
            ff_source_desc more = { 0 };
            rig.desc.more = &more;
            rig.desc.more_count = 1;
            if (part_first) {
                more.stream = &server.stream;
                rig_local_client(&rig, 8 * MB);
            } else {
                more.pack = &rig.pack;
                rig.desc.stream = &server.stream;
                rig_client_of(&rig, 8 * MB);
            }
            assert_true(rig_settle(&rig, 400));
            look_around(&rig);
            assert_shows_whole_ground(&rig, texture_log2);
            /* the part has all roots and what they refine to, so nobody else is asked for it */
            assert_int_equal(server.asked[FF_KIND_ROOT], 0);
            assert_true(server.asked[FF_KIND_REFINEMENT] + server.asked[FF_KIND_VIEW] > 0);
            if (!texture_log2) assert_int_equal(rig_stats(&rig).requests_failed, 0);
            assert_int_equal(ff_client_source_state(rig.client, 0), FF_OK);
            assert_int_equal(ff_client_source_state(rig.client, 1), FF_OK);
            rig_close(&rig);
            close_server(&server);
        }
}

static void without_its_server_a_part_is_drawn_as_it_is(void **state)
{
    (void)state;
    for (unsigned part_first = 0; part_first < 2; part_first++) {
        uint8_t about[6];
        client_rig server, rig, alone;
        rig_open(&server, 0);
        server.refuse = 1;
        make_part(&rig, &server, 0, about);
        ff_source_desc more = { 0 };
        rig.desc.more = &more;
        rig.desc.more_count = 1;
        if (part_first) {
            more.stream = &server.stream;
            rig_local_client(&rig, 8 * MB);
        } else {
            more.pack = &rig.pack;
            rig.desc.stream = &server.stream;
            rig.desc.panorama.enabled = FF_PANORAMA_AUTO;
            rig_client_of(&rig, 8 * MB);
        }
        for (int i = 0; i < 100; i++) rig_step(&rig, 50000);
        make_part(&alone, &server, 0, about);
        rig_local_client(&alone, 8 * MB);
        assert_true(rig_settle(&alone, 400));
        assert_true(rig_same_picture(&rig, &alone));
        assert_int_equal(ff_client_source_state(rig.client, part_first), FF_ERR_AGAIN);
        assert_int_equal(ff_client_source_state(rig.client, !part_first), FF_OK);
        /* it comes */
        server.refuse = 0;
        for (int i = 0; i < 800; i++) rig_step(&rig, 50000);
        assert_int_equal(ff_client_source_state(rig.client, part_first), FF_OK);
        look_around(&rig);
        assert_shows_whole_ground(&rig, 0);
        assert_int_equal(rig_stats(&rig).protocol_errors, 0);
        rig_close(&alone);
        rig_close(&rig);
        close_server(&server);
    }
}

/* Until its server is heard a part is drawn alone; then the server gives the rest of the same
 * ground, and nothing of it is drawn or asked for anew. */
static void what_a_part_shows_stays_when_its_server_is_heard(void **state)
{
    uint8_t about[6];
    client_rig server, rig;
    (void)state;
    rig_open(&server, 0);
    server.refuse = 1;
    make_part(&rig, &server, 0, about);
    ff_source_desc more = { .pack = &rig.pack };
    rig.desc.more = &more;
    rig.desc.more_count = 1;
    rig.desc.stream = &server.stream;
    rig_client_of(&rig, 8 * MB);
    for (int n = 0; n < 40; n++) rig_step(&rig, 50000);
    uint32_t held = rig_stats(&rig).tree.nodes_held, asked = rig_stats(&rig).requests_sent;
    assert_int_equal(ff_client_source_state(rig.client, 0), FF_ERR_AGAIN);
    assert_true(held > 4 && rig_stats(&rig).tree.nodes_drawn > 0);
    server.refuse = 0;
    for (int n = 0; n < 200; n++) {
        rig_step(&rig, 50000);
        assert_true(rig_stats(&rig).tree.nodes_held >= held);
        assert_true(rig_stats(&rig).tree.nodes_drawn > 0);
    }
    assert_int_equal(ff_client_source_state(rig.client, 0), FF_OK);
    assert_true(rig_stats(&rig).requests_sent > asked);
    assert_int_equal(server.asked[FF_KIND_ROOT], 0);
    uint32_t count;
    const ff_terrain_info *all = ff_tree_grounds(ff_client_tree(rig.client), &count);
    assert_int_equal(count, 1);
    assert_int_equal(all->checksum, server.pack.header.info.checksum);
    look_around(&rig);
    assert_shows_whole_ground(&rig, 0);
    rig_close(&rig);
    close_server(&server);
}

static void a_second_server_stands_in_for_one_that_is_lost(void **state)
{
    (void)state;
    client_rig rig, second;
    rig_open(&rig, 0);
    rig_open(&second, 0);
    rig.cut_at = 1500;
    ff_source_desc more = { .stream = &second.stream };
    rig.desc.more = &more;
    rig.desc.more_count = 1;
    rig_client(&rig, 8 * MB);
    for (int i = 0; i < 400; i++) {
        rig.refuse |= rig.session == NULL;
        rig_step(&rig, 50000);
    }
    assert_null(rig.session);
    look_around(&rig);
    assert_shows_whole_ground(&rig, 0);
    assert_true(second.asked[FF_KIND_REFINEMENT] + second.asked[FF_KIND_VIEW] > 0);
    rig_close(&rig);
    close_server(&second);
}

/* Ground that lies so many metres east and north of the others'. */
static void open_placed(client_rig *rig, int32_t epsg, int east_m, int north_m)
{
    rig_open(rig, 0);
    rig_use_place(rig, epsg, 500000 + east_m, 5000000 + north_m);
}

/* A client of the rig's server and one source more, until both are heard. */
static void client_with(client_rig *rig, const ff_source_desc *more)
{
    rig->desc.more = more;
    rig->desc.more_count = 1;
    rig_client(rig, 8 * MB);
    for (int n = 0; n < 40; n++) rig_step(rig, 50000);
}

/* Height of the hills at a place of their ground, as far as the wish for it goes. */
static int has_ground(const client_rig *rig, int east_m, int north_m)
{
    int32_t z_wu;
    return ff_client_ground(rig->client, east_m * FF_WU_PER_METRE, north_m * FF_WU_PER_METRE,
                            &z_wu);
}

static void expect_both(client_rig *rig, int east_m, int north_m)
{
    uint32_t count;
    look_around(rig);
    const ff_terrain_info *all = ff_tree_grounds(ff_client_tree(rig->client), &count);
    assert_int_equal(count, 2);
    assert_int_equal(all[1].west_wu, east_m * FF_WU_PER_METRE);
    assert_int_equal(all[1].south_wu, north_m * FF_WU_PER_METRE);
    assert_int_equal(all[1].first_tile, 4);
    assert_true(has_ground(rig, 10, 10));
    assert_true(has_ground(rig, east_m + 10, north_m + 10));
    assert_int_equal(rig_stats(rig).requests_failed, 0);
}

static void grounds_of_two_servers_come_together(void **state)
{
    (void)state;
    const int place[][2] = { { WIDE, 0 }, { -WIDE, 64 }, { 100, -WIDE } };
    for (int i = 0; i < 3; i++) {
        client_rig rig, beside;
        open_placed(&rig, UTM, 0, 0);
        open_placed(&beside, UTM, place[i][0], place[i][1]);
        ff_source_desc more = { .stream = &beside.stream };
        client_with(&rig, &more);
        assert_true(rig_settle(&rig, 400));
        expect_both(&rig, place[i][0], place[i][1]);
        rig_close(&rig);
        close_server(&beside);
    }
}

static void a_server_of_several_packs_gives_all_of_them(void **state)
{
    (void)state;
    for (int local = 0; local < 2; local++) {
        client_rig rig, beside;
        open_placed(&rig, UTM, 0, 0);
        open_placed(&beside, UTM, WIDE, 0);
        assert_int_equal(ff_pack_join(&rig.pack, &beside.pack), FF_OK);
        if (local)
            rig_local_client(&rig, 8 * MB);
        else
            rig_client(&rig, 8 * MB);
        assert_true(rig_settle(&rig, 400));
        expect_both(&rig, WIDE, 0);
        rig_close(&rig);
        close_server(&beside);
    }
}

/* More of them than the part's stead has room for are put together anew. */
static void a_server_of_several_packs_is_heard_beside_a_part(void **state)
{
    uint8_t about[6];
    client_rig server, beside, rig;
    (void)state;
    open_placed(&server, UTM, 0, 0);
    open_placed(&beside, UTM, WIDE, 0);
    make_part(&rig, &server, 0, about);
    rig.epsg = server.epsg;
    memcpy(rig.origin_mm, server.origin_mm, sizeof rig.origin_mm);
    rig_use_stubs(&rig, 0);
    assert_int_equal(ff_pack_join(&server.pack, &beside.pack), FF_OK);
    server.refuse = 1;
    ff_source_desc more = { .pack = &rig.pack };
    rig.desc.more = &more;
    rig.desc.more_count = 1;
    rig.desc.stream = &server.stream;
    rig_client_of(&rig, 8 * MB);
    for (int n = 0; n < 40; n++) rig_step(&rig, 50000);
    assert_true(rig_stats(&rig).tree.nodes_drawn > 0);
    server.refuse = 0;
    for (int n = 0; n < 200; n++) rig_step(&rig, 50000);
    expect_both(&rig, WIDE, 0);
    rig_close(&rig);
    close_server(&server);
    close_server(&beside);
}

static void more_packs_than_a_server_has_are_refused(void **state)
{
    (void)state;
    client_rig rig, more[FF_WELCOME_GROUNDS];
    ff_source_desc source = { 0 };
    open_placed(&rig, UTM, 0, 0);
    for (int i = 0; i < FF_WELCOME_GROUNDS; i++) {
        open_placed(&more[i], UTM, (i + 1) * WIDE, 0);
        assert_int_equal(ff_pack_join(&rig.pack, &more[i].pack), FF_OK);
    }
    rig.memory = malloc(8 * MB);
    rig.desc.memory = rig.memory;
    rig.desc.memory_bytes = 8 * MB;
    rig.desc.pack = &rig.pack;
    assert_int_equal(ff_client_create(&rig.desc, &rig.client), FF_ERR_ARGUMENT);
    source.pack = &rig.pack;
    rig.desc.pack = NULL;
    rig.desc.stream = &rig.stream;
    rig.desc.more = &source;
    rig.desc.more_count = 1;
    assert_int_equal(ff_client_create(&rig.desc, &rig.client), FF_ERR_ARGUMENT);
    for (int i = 0; i < FF_WELCOME_GROUNDS; i++) close_server(&more[i]);
    rig_close(&rig);
}

static void what_fits_no_ground_is_told_and_left_out(void **state)
{
    (void)state;
    const struct {
        int32_t epsg;
        int east_m, node_log2, expected;
    } row[] = { { 32633, 0, 3, FF_ERR_UNSUPPORTED },
                { 0, 0, 3, FF_ERR_UNSUPPORTED },
                { UTM, 0, 4, FF_ERR_UNSUPPORTED },
                { UTM, 20000000, 3, FF_ERR_RANGE } };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        for (int local = 0; local < 2; local++) {
            client_rig rig, other;
            open_placed(&rig, UTM, 0, 0);
            open_placed(&other, row[i].epsg, row[i].east_m, 0);
            if (row[i].node_log2 != 3) rig_use_node_log2(&other, (unsigned)row[i].node_log2, 0);
            ff_source_desc more = { .stream = local ? NULL : &other.stream,
                                    .pack = local ? &other.pack : NULL };
            client_with(&rig, &more);
            assert_true(rig_settle(&rig, 400));
            assert_int_equal(ff_client_source_state(rig.client, 1), row[i].expected);
            assert_int_equal(ff_client_source_state(rig.client, 0), FF_OK);
            assert_int_equal(ff_client_source_state(rig.client, 2), FF_ERR_ARGUMENT);
            assert_true(has_ground(&rig, 1000, 1000));
            rig_close(&rig);
            close_server(&other);
        }
}

static void a_server_that_changes_its_pack_is_taken_anew(void **state)
{
    (void)state;
    client_rig rig, beside;
    open_placed(&rig, UTM, 0, 0);
    open_placed(&beside, UTM, WIDE, 0);
    ff_source_desc more = { .stream = &beside.stream };
    client_with(&rig, &more);
    expect_both(&rig, WIDE, 0);
    rig_change_terrain(&beside);
    for (int n = 0; n < 200; n++) rig_step(&rig, 50000);
    look_around(&rig);
    uint32_t count;
    const ff_terrain_info *all = ff_tree_grounds(ff_client_tree(rig.client), &count);
    assert_int_equal(count, 2);
    assert_int_equal(all[1].hoffset_wu, beside.pack.header.info.hoffset_wu);
    assert_true(has_ground(&rig, WIDE + 10, 10));
    rig_close(&rig);
    close_server(&beside);
}

static uint32_t asked_of(const client_rig *rig)
{
    uint32_t asked = 0;
    for (int kind = 0; kind < FF_KIND_COUNT; kind++) asked += rig->asked[kind];
    return asked;
}

/* It is told of again at each connection. */
static void a_ground_that_fits_not_makes_nothing_come_twice(void **state)
{
    (void)state;
    const int east_m[][2] = { { 0, 9000000 }, { 7000000, 9000000 } };
    for (int i = 0; i < 2; i++) {
        client_rig rig, beside, far;
        open_placed(&rig, UTM, 0, 0);
        open_placed(&beside, UTM, east_m[i][0], i ? 0 : WIDE);
        open_placed(&far, UTM, east_m[i][1], 0);
        if (i == 0) far.pack.header.info.codec = FF_CODEC_COUNT; /* one that is not built in */
        ff_source_desc more[2] = { { .stream = &beside.stream } };
        rig.desc.more = more;
        rig.desc.more_count = 1;
        if (i == 0) {
            more[1].pack = &far.pack;
            rig.desc.more_count = 2;
        } else {
            assert_int_equal(ff_pack_join(&beside.pack, &far.pack), FF_OK);
        }
        rig_client(&rig, 8 * MB);
        for (int n = 0; n < 40; n++) rig_step(&rig, 50000);
        look_around(&rig);
        uint32_t count, of_rig = asked_of(&rig), of_beside = asked_of(&beside);
        (void)ff_tree_grounds(ff_client_tree(rig.client), &count);
        assert_int_equal(count, 2);
        assert_int_equal(ff_client_source_state(rig.client, 1 + !i),
                         i ? FF_ERR_RANGE : FF_ERR_UNSUPPORTED);
        beside.cut_at = beside.bytes_down;
        for (int n = 0; n < 200; n++) rig_step(&rig, 50000);
        look_around(&rig);
        assert_true(beside.connections > 1);
        assert_int_equal(asked_of(&rig), of_rig);
        assert_int_equal(asked_of(&beside), of_beside);
        rig_close(&rig);
        close_server(&beside);
        close_server(&far);
    }
}

/* How many nodes both draw, all of them of the same heights; -1: some are not. */
static int same_heights(const client_rig *a, const client_rig *b)
{
    const ff_drawn *list_a, *list_b;
    uint32_t count_a = ff_tree_drawn(ff_client_tree(a->client), &list_a),
             count_b = ff_tree_drawn(ff_client_tree(b->client), &list_b);
    unsigned side = ff_node_side(ff_client_terrain(a->client));
    int same = 0;
    for (uint32_t i = 0; i < count_a; i++)
        for (uint32_t j = 0; j < count_b; j++) {
            if (list_a[i].key != list_b[j].key) continue;
            if (memcmp(list_a[i].heights, list_b[j].heights, side * side * sizeof(uint16_t)) != 0)
                return -1;
            same++;
        }
    return same;
}

/* A slow server has answers on their way while another one's grounds are put together anew. */
static void answers_on_their_way_are_not_taken_for_others(void **state)
{
    (void)state;
    for (unsigned changed = 4; changed < 64; changed += 5) {
        client_rig rig, beside, calm, other;
        open_placed(&rig, UTM, 0, 0);
        open_placed(&beside, UTM, WIDE, 0);
        ff_source_desc more = { .stream = &beside.stream };
        rig.desc.more = &more;
        rig.desc.more_count = 1;
        rig.chop = 3;
        rig_client(&rig, 8 * MB);
        for (unsigned n = 0; n < changed; n++) rig_step(&rig, 50000);
        rig_change_terrain(&beside);
        for (unsigned n = 0; n < 60; n++) rig_step(&rig, 50000);
        rig.chop = 0;
        look_around(&rig);
        assert_int_equal(rig_stats(&rig).protocol_errors, 0);
        assert_int_equal(rig_stats(&rig).requests_failed, 0);
        assert_int_equal(rig.connections, 1);
        /* the same as if it had always been so */
        open_placed(&calm, UTM, 0, 0);
        open_placed(&other, UTM, WIDE, 0);
        rig_change_terrain(&other);
        ff_source_desc more_calm = { .stream = &other.stream };
        calm.desc.more = &more_calm;
        calm.desc.more_count = 1;
        rig_client(&calm, 8 * MB);
        for (int n = 0; n < 40; n++) rig_step(&calm, 50000);
        look_around(&calm);
        assert_true(same_heights(&rig, &calm) > 20);
        rig_close(&calm);
        close_server(&other);
        rig_close(&rig);
        close_server(&beside);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_part_on_the_device_lacks_the_server_gives),
        cmocka_unit_test(without_its_server_a_part_is_drawn_as_it_is),
        cmocka_unit_test(what_a_part_shows_stays_when_its_server_is_heard),
        cmocka_unit_test(a_second_server_stands_in_for_one_that_is_lost),
        cmocka_unit_test(grounds_of_two_servers_come_together),
        cmocka_unit_test(a_server_of_several_packs_gives_all_of_them),
        cmocka_unit_test(a_server_of_several_packs_is_heard_beside_a_part),
        cmocka_unit_test(more_packs_than_a_server_has_are_refused),
        cmocka_unit_test(what_fits_no_ground_is_told_and_left_out),
        cmocka_unit_test(a_server_that_changes_its_pack_is_taken_anew),
        cmocka_unit_test(a_ground_that_fits_not_makes_nothing_come_twice),
        cmocka_unit_test(answers_on_their_way_are_not_taken_for_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
