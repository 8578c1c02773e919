/* Prefetch asks for the ground of tiles that will come into the window, and for nothing when the
 * pool is full. */
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <string.h>

#define LIST   64
#define TILE_M 1280

/* 6 x 6 tiles of 1280 m, seen 1000 m far from the middle of tile (2, 2). */
static void begin(terrain_fixture *fx, ff_view *view, ff_quality *quality)
{
    fixture_make(fx, 3, 7, 6, 6, fixture_hills);
    fixture_tree(fx, 2000, 60);
    *view = fixture_view_above(fx, 2 * TILE_M + 900, 2 * TILE_M + 640, 100, 90, -5);
    *quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality->view_wu = 300 * FF_WU_PER_METRE;
    fixture_settle(fx, view, quality, 100);
}

static void ahead_of(const ff_view *view, int32_t metres, int32_t pos_wu[3])
{
    memcpy(pos_wu, view->camera.pos_wu, 3 * sizeof *pos_wu);
    pos_wu[0] += metres * FF_WU_PER_METRE;
}

static ff_key tile_key(uint32_t x, uint32_t y) { return ff_key_make(y * 6 + x, 0, 0); }

static uint32_t finest_drawn(const terrain_fixture *fx)
{
    const ff_drawn *cut;
    uint32_t finest = 0, count = ff_tree_cut(fx->tree, &cut);
    for (uint32_t i = 0; i < count; i++)
        finest = ff_key_level(cut[i].key) > finest ? ff_key_level(cut[i].key) : finest;
    return finest;
}

/* A tile that comes into the window as a bare root makes the ground beside it coarse; one that was
 * foreseen does not. */
static void new_tiles_come_refined(void **state)
{
    (void)state;
    for (int foreseen = 0; foreseen < 2; foreseen++) {
        terrain_fixture fx;
        ff_view view;
        ff_quality quality;
        ff_wish list[LIST];
        int32_t pos_wu[3];
        begin(&fx, &view, &quality);
        quality.c_q8 = 6 * 256;
        fixture_settle(&fx, &view, &quality, 100);
        uint32_t before = finest_drawn(&fx);
        ahead_of(&view, 100, pos_wu);
        for (uint32_t round = 0; foreseen && round < 20; round++) {
            uint32_t count = ff_tree_foresee(fx.tree, pos_wu, 0, 0, list, LIST);
            for (uint32_t i = 0; i < count; i++)
                assert_int_equal(fixture_deliver(&fx, list[i].key, list[i].kind), FF_OK);
        }
        assert_int_equal(fixture_deliver(&fx, tile_key(3, 2), 0), FF_OK);
        memcpy(view.camera.pos_wu, pos_wu, sizeof pos_wu);
        memcpy(view.centre_wu, pos_wu, sizeof pos_wu);
        ff_tree_select(fx.tree, &view, &quality);
        fixture_assert_whole(&fx);
        if (foreseen)
            assert_true(finest_drawn(&fx) >= before);
        else
            assert_true(finest_drawn(&fx) < before);
        fixture_free(&fx);
    }
}

/* When the pool is full, prefetch asks for nothing. */
static void a_full_pool_prefetches_nothing(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_wish list[LIST];
    int32_t pos_wu[3];
    fixture_make(&fx, 3, 7, 6, 6, fixture_hills);
    fixture_tree(&fx, 9, 60);
    ff_view view = fixture_view_above(&fx, 2 * TILE_M + 900, 2 * TILE_M + 640, 100, 90, -5);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.view_wu = 300 * FF_WU_PER_METRE;
    fixture_settle(&fx, &view, &quality, 100);
    ahead_of(&view, 1, pos_wu);
    uint32_t count = ff_tree_foresee(fx.tree, pos_wu, 0, 0, list, LIST);
    ff_tree_stats stats = fixture_stats(&fx);
    assert_int_equal(stats.nodes_held, stats.nodes_capacity);
    assert_int_equal(count, 0);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(new_tiles_come_refined),
        cmocka_unit_test(a_full_pool_prefetches_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
