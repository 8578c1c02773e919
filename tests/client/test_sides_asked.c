/* A client that has the sides of a node's ground does not take them again. */
#include "../rig/client_fixture.h"
#include "../../client/ff_client_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define MB (1 << 20)

static client_rig here; /* over the pack itself */

static void open_trained(client_rig *rig, int no_views)
{
    rig_open(rig, 0);
    rig_use_trained(rig, 129, 129);
    rig->desc.no_views = (uint8_t)no_views;
}

static int make_here(void **state)
{
    (void)state;
    open_trained(&here, 0);
    rig_local_client(&here, 2 * MB);
    return !rig_settle(&here, 400);
}

static int free_here(void **state)
{
    (void)state;
    rig_close(&here);
    return 0;
}

/* Whatever way it came, the ground is that of the pack. Which nodes are drawn depends on what is
 * held, too: most are the same. */
static void assert_shows_as(const client_rig *rig, client_rig *pack)
{
    const ff_drawn *mine, *its;
    uint32_t count = ff_tree_drawn(ff_client_tree(rig->client), &mine), same = 0;
    unsigned side = ff_node_side(ff_client_terrain(rig->client));
    pack->camera = rig->camera;
    assert_true(rig_settle(pack, 1000));
    uint32_t its_count = ff_tree_drawn(ff_client_tree(pack->client), &its);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < its_count; j++) {
            if (mine[i].key != its[j].key) continue;
            assert_memory_equal(mine[i].heights, its[j].heights, side * side * sizeof(uint16_t));
            same++;
        }
    assert_true(count > 0 && 10 * same > 9 * count);
}

static void assert_shows_the_pack(const client_rig *rig) { assert_shows_as(rig, &here); }

static void what_is_held_or_on_its_way_is_left_out(void **state)
{
    (void)state;
    for (int no_views = 0; no_views < 2; no_views++) {
        client_rig rig;
        open_trained(&rig, no_views);
        rig_client(&rig, 2 * MB);
        rig_fly(&rig, 100);
        assert_true(rig_settle(&rig, 400));
        assert_shows_the_pack(&rig);
        /* of most nodes one side at least: the first of several that leave together is on its way
         */
        assert_true(rig.sides_left_out > rig.asked[FF_KIND_REFINEMENT]);
        assert_int_equal(rig_stats(&rig).tree.sides_gone, 0);
        assert_int_equal(rig_stats(&rig).requests_failed, 0);
        rig_close(&rig);
    }
}

/* Where ground ends along a side, the node across has one child there: its heights are enough. */
static void ground_that_ends_within_nodes_comes_without_its_sides(void **state)
{
    static const uint32_t samples[][2] = { { 97, 129 }, { 129, 90 }, { 70, 101 },
                                           { 105, 67 }, { 66, 66 },  { 121, 83 } };
    (void)state;
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++)
        for (int no_views = 0; no_views < 2; no_views++) {
            client_rig rig, pack;
            open_trained(&rig, no_views);
            open_trained(&pack, 0);
            rig_use_trained(&rig, samples[i][0], samples[i][1]);
            rig_use_trained(&pack, samples[i][0], samples[i][1]);
            rig_local_client(&pack, 2 * MB);
            rig_client(&rig, 2 * MB);
            rig_fly(&rig, 100);
            assert_true(rig_settle(&rig, 400));
            assert_shows_as(&rig, &pack);
            assert_int_equal(rig_stats(&rig).tree.sides_gone, 0);
            assert_int_equal(rig_stats(&rig).requests_failed, 0);
            rig_close(&rig);
            rig_close(&pack);
        }
}

/* A cut takes what was on its way, and with it the sides that others counted on. */
static void the_ground_is_whole_after_cuts(void **state)
{
    uint32_t gone = 0, cuts = 0;
    (void)state;
    for (uint64_t at = 700; at < 6000; at += 100) {
        client_rig rig;
        open_trained(&rig, 1);
        rig.cut_at = at;
        rig_client(&rig, 2 * MB);
        rig_fly(&rig, 100);
        assert_true(rig_settle(&rig, 1000));
        cuts += rig.connections - 1;
        assert_shows_the_pack(&rig);
        gone += rig_stats(&rig).tree.sides_gone;
        rig_close(&rig);
    }
    assert_true(cuts > 10 && gone <= cuts);
}

/* What is dropped for what is worth more is asked for again, with all its sides. */
static void small_pools_settle(void **state)
{
    client_rig rig;
    (void)state;
    open_trained(&rig, 1);
    rig_client(&rig, 600 << 10);
    rig_fly(&rig, 300);
    assert_true(rig_settle(&rig, 1000));
    assert_true(rig.sides_left_out > 0);
    rig_close(&rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_held_or_on_its_way_is_left_out),
        cmocka_unit_test(ground_that_ends_within_nodes_comes_without_its_sides),
        cmocka_unit_test(the_ground_is_whole_after_cuts),
        cmocka_unit_test(small_pools_settle),
    };
    return cmocka_run_group_tests(tests, make_here, free_here);
}
