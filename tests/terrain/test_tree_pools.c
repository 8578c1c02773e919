/* Pools of every size, still cameras and moving ones, and the largest terrains and numbers there
 * can be. */
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

/* ---- pools ---- */

/* A still camera and pools of every size: after a while the tree wishes for nothing, evicts nothing
 * and redraws nothing. */
static void pools_settle_down(void **state)
{
    (void)state;
    for (uint32_t nodes = 8; nodes < 500; nodes += nodes < 40 ? 1 : 37) {
        for (int measure = FF_MEASURE_DISTANCE; measure <= FF_MEASURE_PIXELS; measure++) {
            terrain_fixture fx;
            fixture_usual(&fx, nodes);
            ff_view view = fixture_view_above(&fx, 1400, 1100, 50, 20, -15);
            ff_quality quality = fixture_quality((enum ff_measure)measure);
            fixture_settle(&fx, &view, &quality, 1000);
            ff_tree_stats settled = fixture_stats(&fx);
            fixture_assert_whole(&fx);
            for (unsigned frame = 0; frame < 300; frame++) {
                const ff_wish *wish;
                assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
                assert_int_equal(ff_tree_wishes(fx.tree, &wish), 0);
            }
            assert_int_equal(fixture_stats(&fx).nodes_held, settled.nodes_held);
            if (nodes < 200) assert_true(settled.nodes_held > nodes - 4);
            fixture_free(&fx);
        }
    }
}

static void full_pool_stays_still_for_10000_frames(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 90);
    fixture_link link = { .per_frame = 3 };
    sys_random_seed(&link.random, 5, 5);
    ff_view view = fixture_view_above(&fx, 1400, 1100, 50, 20, -15);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    uint32_t changed_last = 0;
    for (uint32_t frame = 0; frame < 10000; frame++) {
        if (ff_tree_select(fx.tree, &view, &quality)) changed_last = frame;
        fixture_link_step(&fx, &link);
    }
    assert_true(changed_last < 200);
    assert_true(fixture_stats(&fx).nodes_held > 86);
    fixture_free(&fx);
}

/* Half a world of roots and a pool for eight: the tree holds the eight nearest, and does not evict
 * one for another. */
static void more_roots_than_slots(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 5, 20, 20, fixture_hills);
    fixture_tree(&fx, 8, 30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    for (int32_t x = 160; x < 20 * 320; x += 700) {
        ff_view view = fixture_view(x, 3300, 300, 0, -20);
        fixture_settle(&fx, &view, &quality, 100);
        fixture_assert_whole(&fx);
        const ff_wish *wish;
        assert_int_equal(ff_tree_wishes(fx.tree, &wish), 0);
        assert_int_equal(fixture_stats(&fx).nodes_cut, 8);
        int32_t z;
        assert_int_equal(ff_tree_drawn_height(fx.tree, x * M, 3300 * M, &z), 1);
    }
    fixture_free(&fx);
}

static void cache_serves_a_return(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 4000);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 256;
    ff_view here = fixture_view(600, 600, 300, 0, -30),
            there = fixture_view(3000, 1900, 300, 0, -30);
    fixture_settle(&fx, &here, &quality, 200);
    fixture_settle(&fx, &there, &quality, 200);
    assert_int_equal(fixture_settle(&fx, &here, &quality, 200), 0);
    fixture_free(&fx);
}

/* A family that was not asked for is not given room by dropping the node it would refine, whatever
 * sigma says. */
static void own_family_is_spared(void **state)
{
    (void)state;
    for (int32_t sigma = 257; sigma < 100000; sigma *= 300) {
        terrain_fixture fx;
        fixture_make(&fx, 3, 5, 1, 1, fixture_hills);
        fixture_tree(&fx, 8, 8);
        /* the child is nearer than its parent's middle */
        ff_view view = fixture_view_above(&fx, 240, 240, 20, 0, -90);
        ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
        quality.sigma_q8 = sigma;
        quality.c_q8 = 8; /* nothing wants to split */
        ff_tree_select(fx.tree, &view, &quality);
        fixture_deliver(&fx, ff_key_make(0, 0, 0), 0);
        ff_tree_select(fx.tree, &view, &quality);
        assert_int_equal(fixture_deliver(&fx, ff_key_make(0, 0, 0), 1), FF_OK);
        ff_tree_select(fx.tree, &view, &quality);
        /* the parent's own family is not dropped for it */
        assert_int_equal(fixture_deliver(&fx, ff_key_make(0, 1, 3), 1), FF_ERR_FULL);
        assert_int_equal(fixture_stats(&fx).nodes_held, 5);
        assert_int_equal(fixture_stats(&fx).pool_full, 1);
        fixture_free(&fx);
    }
}

static uint32_t evicted_users;
static void note_eviction(void *context, uint32_t user)
{
    assert_ptr_equal(context, &evicted_users);
    assert_int_not_equal(user, 0);
    evicted_users++;
}

static void user_words_live_and_die_with_nodes(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 40);
    ff_tree_on_evict(fx.tree, note_eviction, &evicted_users);
    evicted_users = 0;
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    uint32_t given = 0;
    for (int32_t x = 0; x < 3800; x += 100) {
        ff_view view = fixture_view(x, 900, 300, 90, -20);
        fixture_settle(&fx, &view, &quality, 20);
        const ff_drawn *cut;
        uint32_t count = ff_tree_cut(fx.tree, &cut);
        for (uint32_t i = 0; i < count; i++) {
            uint32_t *user = ff_tree_user(fx.tree, cut[i].node);
            given += *user == 0;
            *user = 77;
        }
    }
    assert_true(evicted_users > 0 && evicted_users < given);
    assert_true(given - evicted_users <= 40);
    fixture_free(&fx);
}

/* ---- extremes: nothing overflows (UndefinedBehaviorSanitizer watches) ---- */

static void largest_terrain_and_farthest_cameras(void **state)
{
    (void)state;
    terrain_fixture fx;
    /* 65537 samples a side, 127 m apart: the edge of 32 bits */
    fixture_make(&fx, 3, 15, 2, 2, fixture_hills);
    fx.info.spacing_wu = INT32_MAX / 65536;
    fx.info.hscale_q24 = 1 << 22;
    fixture_tree(&fx, 600, 40);
    const int32_t far[] = { INT32_MIN, -1, 0, 1 << 30, INT32_MAX };
    for (unsigned i = 0; i < 125; i++) {
        ff_view view = fixture_view(0, 0, 0, (int32_t)i * 37, -(int32_t)i % 90);
        for (unsigned axis = 0, rest = i; axis < 3; axis++, rest /= 5)
            view.camera.pos_wu[axis] = view.centre_wu[axis] = far[rest % 5];
        ff_quality quality = fixture_quality(i & 1 ? FF_MEASURE_PIXELS : FF_MEASURE_DISTANCE);
        quality.view_wu = i % 3 == 0 ? INT32_MAX : 1 << 20;
        quality.c_q8 = i % 4 == 0 ? INT32_MAX : 700;
        quality.error_px_q8 = i % 7 == 0 ? 0 : 256;
        view.camera.focal_q8 = i % 11 == 0 ? INT32_MAX : i % 11 == 1 ? 0 : view.camera.focal_q8;
        fixture_settle(&fx, &view, &quality, 3);
        fixture_assert_whole(&fx);
        int32_t z;
        (void)ff_tree_drawn_height(fx.tree, view.camera.pos_wu[0], view.camera.pos_wu[1], &z);
    }
    fixture_free(&fx);
}

static void a_long_thin_world_of_many_tiles(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 1, 1, 1, 1 << 20, fixture_hills);
    fx.info.spacing_wu = 256;
    fixture_tree(&fx, 64, 16);
    ff_view view = fixture_view(0, 0, 100, 0, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    quality.view_wu = INT32_MAX;
    for (int32_t y = 0; y < 2000000; y += 300000) {
        view.camera.pos_wu[1] = view.centre_wu[1] = y * M;
        fixture_settle(&fx, &view, &quality, 30);
        fixture_assert_whole(&fx);
        assert_true(fixture_stats(&fx).nodes_cut > 60);
    }
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pools_settle_down),
        cmocka_unit_test(full_pool_stays_still_for_10000_frames),
        cmocka_unit_test(more_roots_than_slots),
        cmocka_unit_test(cache_serves_a_return),
        cmocka_unit_test(own_family_is_spared),
        cmocka_unit_test(user_words_live_and_die_with_nodes),
        cmocka_unit_test(largest_terrain_and_farthest_cameras),
        cmocka_unit_test(a_long_thin_world_of_many_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
