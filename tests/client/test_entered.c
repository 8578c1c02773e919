/* A client that looks no further than so far: its server leaves out the levels that are too coarse
 * for it, and the ground in view is the same. */
#include "../../client/ff_client_local.h"
#include "../../protocol/ff_entry.h"
#include "../rig/client_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define METRE FF_WU_PER_METRE
#define NEAR  (400 * METRE) /* two tiles of 1024 m each way, of a ground whose root has 2048 */

/* All that is in reach is split as far as it goes, so that the levels above do not show. */
static void looks_near(client_rig *rig, int32_t view_wu)
{
    rig->desc.quality = (ff_quality){ .c_q8 = 100 * 256, .view_wu = view_wu };
    rig->camera.pos_wu[2] = 1000 * METRE; /* 200 m above the ground, of which it looks at some */
    rig->camera.pitch = -8000;
    rig->desc.place_known = 1;
}

static void open_near(client_rig *rig, unsigned texture_log2, int32_t view_wu)
{
    rig_open(rig, texture_log2);
    looks_near(rig, view_wu);
}

/* Both show the same nodes, each under its own key. Beyond the view they may border on others. */
static void assert_same_ground(const client_rig *near, const client_rig *whole)
{
    const ff_drawn *list_a, *list_b;
    const ff_terrain_info *info = ff_client_terrain(near->client);
    uint32_t count = ff_tree_drawn(ff_client_tree(near->client), &list_a);
    assert_int_equal(count, ff_tree_drawn(ff_client_tree(whole->client), &list_b));
    assert_true(count >= 1);
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(ff_entry_key(ff_client_terrain(whole->client), info, list_a[i].key),
                         list_b[i].key);
        assert_memory_equal(list_a[i].heights, list_b[i].heights,
                            ff_node_side(info) * ff_node_side(info) * sizeof(uint16_t));
    }
}

static void assert_same_all_round(client_rig *near, client_rig *whole)
{
    for (int turn = 0; turn < 4; turn++) {
        near->camera.yaw += 1 << 14;
        whole->camera.yaw += 1 << 14;
        assert_true(rig_settle(near, 400));
        assert_true(rig_settle(whole, 400));
        assert_same_ground(near, whole);
    }
}

static void a_near_view_is_the_same_ground(void **state)
{
    (void)state;
    for (unsigned texture_log2 = 0; texture_log2 <= 5; texture_log2 += 5)
        for (int views = 0; views < 2; views++) {
            client_rig near, whole;
            open_near(&near, texture_log2, NEAR);
            near.desc.no_views = (uint8_t)!views;
            rig_client(&near, 8 * MB);
            open_near(&whole, texture_log2, NEAR);
            rig_local_client(&whole, 8 * MB);
            assert_same_all_round(&near, &whole);
            assert_int_equal(ff_client_terrain(near.client)->entered, 1);
            assert_int_equal(ff_client_terrain(whole.client)->entered, 0);
            assert_int_equal(near.client->textures.held > 0, texture_log2 > 0);
            assert_int_equal(rig_stats(&near).requests_failed, 0);
            rig_close(&near);
            rig_close(&whole);
        }
}

/* Levels that are left out count: what a depth shows does not depend on them. */
static void a_depth_is_counted_from_the_top(void **state)
{
    (void)state;
    for (uint8_t depth = 2; depth <= 4; depth++) {
        client_rig near, whole;
        open_near(&near, 0, NEAR);
        near.desc.quality.depth_max = depth;
        rig_client(&near, 8 * MB);
        open_near(&whole, 0, NEAR);
        whole.desc.quality.depth_max = depth;
        rig_local_client(&whole, 8 * MB);
        assert_true(rig_settle(&near, 400));
        assert_true(rig_settle(&whole, 400));
        assert_int_equal(ff_client_terrain(near.client)->entered, 1);
        assert_same_ground(&near, &whole);
        rig_close(&near);
        rig_close(&whole);
    }
}

static void what_is_left_out_is_not_sent(void **state)
{
    client_rig near, far, asked;
    (void)state;
    open_near(&near, 0, NEAR);
    rig_client(&near, 8 * MB);
    open_near(&far, 0, 0);
    rig_client(&far, 8 * MB);
    open_near(&asked, 0, NEAR); /* who asks for all levels has them */
    asked.desc.no_entry = 1;
    rig_client(&asked, 8 * MB);
    assert_true(rig_settle(&near, 400));
    assert_true(rig_settle(&far, 400));
    assert_true(rig_settle(&asked, 400));
    assert_int_equal(ff_client_terrain(far.client)->entered, 0);
    assert_int_equal(ff_client_terrain(asked.client)->entered, 0);
    assert_true(near.bytes_down < asked.bytes_down);
    rig_close(&asked);
    assert_true(near.bytes_down < far.bytes_down);
    /* at most four tiles lie within reach */
    assert_in_range(near.asked[FF_KIND_ROOT], 0, 4);
    rig_close(&near);
    rig_close(&far);
}

static void a_farther_view_has_the_rest_told(void **state)
{
    client_rig rig, whole;
    (void)state;
    open_near(&rig, 0, NEAR);
    rig_client(&rig, 8 * MB);
    assert_true(rig_settle(&rig, 400));
    ff_quality farther = rig.desc.quality;
    farther.view_wu = NEAR / 2; /* nearer: nothing has to be told */
    ff_client_set_quality(rig.client, &farther);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.connections, 1);
    farther.view_wu = 0; /* as far as one sees */
    ff_client_set_quality(rig.client, &farther);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(rig.connections, 2);
    assert_int_equal(ff_client_terrain(rig.client)->entered, 0);
    open_near(&whole, 0, 0);
    rig_local_client(&whole, 8 * MB);
    assert_true(rig_settle(&whole, 400));
    assert_true(rig_same_picture(&rig, &whole));
    rig_close(&rig);
    rig_close(&whole);
}

static void a_lost_link_finds_the_same_ground_again(void **state)
{
    client_rig rig;
    (void)state;
    open_near(&rig, 0, NEAR);
    rig.desc.no_views = 1;
    rig_client(&rig, 8 * MB);
    assert_true(rig_settle(&rig, 400));
    uint32_t nodes = rig_stats(&rig).tree.nodes_held, asked = rig.asked[FF_KIND_REFINEMENT];
    rig.cut_at = rig.bytes_down;
    for (int i = 0; i < 100; i++) rig_step(&rig, 50000);
    rig.cut_at = UINT64_MAX;
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(ff_client_terrain(rig.client)->entered, 1);
    assert_true(rig_stats(&rig).tree.nodes_held >= nodes);
    assert_int_equal(rig.asked[FF_KIND_REFINEMENT], asked);
    rig_close(&rig);
}

static void of_several_sources_each_hands_out_all(void **state)
{
    client_rig rig, beside;
    (void)state;
    open_near(&rig, 0, NEAR);
    open_near(&beside, 0, NEAR);
    ff_source_desc more = { .stream = &beside.stream };
    rig.desc.more = &more;
    rig.desc.more_count = 1;
    rig_client(&rig, 8 * MB);
    assert_true(rig_settle(&rig, 400));
    assert_int_equal(ff_client_terrain(rig.client)->entered, 0);
    rig_close(&rig);
    beside.client = NULL;
    beside.memory = NULL;
    rig_close(&beside);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_near_view_is_the_same_ground),
        cmocka_unit_test(a_depth_is_counted_from_the_top),
        cmocka_unit_test(what_is_left_out_is_not_sent),
        cmocka_unit_test(a_farther_view_has_the_rest_told),
        cmocka_unit_test(a_lost_link_finds_the_same_ground_again),
        cmocka_unit_test(of_several_sources_each_hands_out_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
