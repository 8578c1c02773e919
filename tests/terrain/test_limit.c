/* The limit of triangles: never passed, nearly used up where the ground needs it, settled under a
 * still camera, and no reason to fetch what it will not let be drawn. */
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <string.h>

static ff_quality limited(enum ff_measure measure, uint32_t triangles)
{
    ff_quality quality = fixture_quality(measure);
    quality.error_px_q8 = 64;
    quality.c_q8 = 40 * 256;
    quality.depth_max = 0;
    quality.triangles_max = triangles;
    return quality;
}

/* Views of a walk round the middle of the usual ground, low and high, level and down. */
static ff_view view_at(const terrain_fixture *fx, unsigned i)
{
    int32_t x = 900 + (int32_t)(i * 37 % 2000), y = 500 + (int32_t)(i * 53 % 1500),
            above = i % 3 == 0   ? 5
                    : i % 3 == 1 ? 150
                                 : 1500;
    return fixture_view_above(fx, x, y, above, (int32_t)(i * 71 % 360), -(int32_t)(i * 13 % 60));
}

static void is_kept_and_used_in_every_view(void **state)
{
    (void)state;
    static const uint32_t limits[] = { 1024, 3000, 6000, 20000 };
    for (int measure = FF_MEASURE_DISTANCE; measure <= FF_MEASURE_PIXELS; measure++) {
        unsigned needed = 0, used = 0;
        terrain_fixture fx;
        fixture_usual(&fx, 4000);
        ff_quality free_of_it = limited((enum ff_measure)measure, 0);
        for (unsigned i = 0; i < 40; i++) {
            ff_view view = view_at(&fx, i);
            fixture_settle(&fx, &view, &free_of_it, 300);
            uint32_t wanted = fixture_stats(&fx).triangles;
            for (unsigned l = 0; l < sizeof limits / sizeof *limits; l++) {
                ff_quality quality = limited((enum ff_measure)measure, limits[l]);
                ff_tree_select(fx.tree, &view, &quality);
                fixture_assert_whole(&fx);
                ff_tree_stats stats = fixture_stats(&fx);
                assert_true(stats.triangles <= limits[l]);
                if (wanted <= limits[l] / 4 * 3) assert_int_equal(stats.triangles, wanted);
                if (wanted < limits[l] || l == 0) continue; /* a split is a third of the smallest */
                needed++;
                used += stats.triangles >= limits[l] / 4 * 3;
            }
        }
        assert_true(needed > 40);
        assert_true(used * 10 >= needed * 9);
        fixture_free(&fx);
    }
}

/* 400 tiles in sight: their roots alone are 51 200 triangles. */
static void shortens_the_reach_when_roots_are_too_many(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 5, 20, 20, fixture_hills);
    fixture_tree(&fx, 2000, 400);
    ff_quality quality = limited(FF_MEASURE_PIXELS, 0);
    ff_view view = fixture_view(3200, 100, 3000, 0, -45);
    quality.error_px_q8 = 256 * 256;
    fixture_settle(&fx, &view, &quality, 1000);
    assert_true(fixture_stats(&fx).triangles > 20000);
    quality.triangles_max = 1; /* FF_TRIANGLES_MIN */
    ff_tree_select(fx.tree, &view, &quality);
    fixture_assert_whole(&fx);
    assert_true(fixture_stats(&fx).triangles <= FF_TRIANGLES_MIN);
    quality.triangles_max = 5000;
    ff_tree_select(fx.tree, &view, &quality);
    fixture_assert_whole(&fx);
    assert_in_range(fixture_stats(&fx).triangles, 3000, 5000);
    assert_true(ff_tree_quality(fx.tree)->view_wu < quality.view_wu);
    fixture_free(&fx);
}

/* Pools of every size under a limit: after a while nothing is wished for, and the cut stays. */
static void settles_in_pools_of_every_size(void **state)
{
    (void)state;
    for (uint32_t nodes = 8; nodes < 900; nodes += nodes < 40 ? 3 : 37) {
        terrain_fixture fx;
        fixture_usual(&fx, nodes);
        ff_view view = fixture_view_above(&fx, 1400, 1100, 50, 20, -15);
        ff_quality quality = limited(FF_MEASURE_PIXELS, 3000);
        fixture_settle(&fx, &view, &quality, 1000);
        uint32_t held = fixture_stats(&fx).nodes_held;
        for (unsigned frame = 0; frame < 30; frame++) {
            const ff_wish *wish;
            assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
            uint32_t wishes = ff_tree_wishes(fx.tree, &wish);
            for (uint32_t i = 0; i < wishes; i++) assert_false(wish[i].in_view);
        }
        assert_int_equal(fixture_stats(&fx).nodes_held, held);
        fixture_free(&fx);
    }
}

/* All that is wished for in view comes at once; returns how much. */
static uint32_t deliver_in_view(terrain_fixture *fx, const ff_view *view, const ff_quality *quality)
{
    ff_wish wish[FIXTURE_BAG];
    const ff_wish *list;
    uint32_t came = 0;
    ff_tree_select(fx->tree, view, quality);
    uint32_t count = ff_tree_wishes(fx->tree, &list);
    assert_true(count <= FIXTURE_BAG);
    memcpy(wish, list, count * sizeof *wish);
    for (uint32_t i = 0; i < count; i++)
        if (wish[i].in_view)
            came += fixture_deliver(fx, wish[i].key, wish[i].kind == FF_KIND_REFINEMENT) == FF_OK;
    return came;
}

/* What is fetched under a limit is little more than what the limit lets be drawn in view. */
static void fetches_what_it_lets_be_drawn(void **state)
{
    (void)state;
    uint32_t held[2];
    for (int with = 0; with < 2; with++) {
        terrain_fixture fx;
        fixture_usual(&fx, 4000);
        ff_view view = fixture_view_above(&fx, 1400, 200, 100, 0, -10);
        ff_quality quality = limited(FF_MEASURE_PIXELS, with ? 4000 : 0);
        while (deliver_in_view(&fx, &view, &quality)) {
        }
        ff_tree_stats stats = fixture_stats(&fx);
        held[with] = stats.nodes_held;
        if (with) assert_in_range(stats.triangles, 3000, 4000);
        if (with) assert_true(held[1] <= 3 * 4000 / 128);
        fixture_free(&fx);
    }
    assert_true(held[0] > 3 * held[1]);
}

/* The same views in the same order: the same cuts. */
static void repeats(void **state)
{
    (void)state;
    uint32_t triangles[2][60];
    for (int run = 0; run < 2; run++) {
        terrain_fixture fx;
        fixture_usual(&fx, 1000);
        fixture_link link = { .per_frame = 4, .loss_percent = 10 };
        sys_random_seed(&link.random, 5, 5);
        ff_quality quality = limited(FF_MEASURE_PIXELS, 3000);
        for (unsigned i = 0; i < 60; i++) {
            ff_view view = view_at(&fx, i / 4);
            ff_tree_select(fx.tree, &view, &quality);
            triangles[run][i] = fixture_stats(&fx).triangles;
            assert_true(triangles[run][i] <= 3000);
            fixture_link_step(&fx, &link);
        }
        fixture_free(&fx);
    }
    assert_memory_equal(triangles[0], triangles[1], sizeof triangles[0]);
}

/* One root for all of the ground: nodes of its coarse levels are in view by a part of them, and
 * their splits bring as much. Over views all round, what comes is most of what may be drawn. */
static void fetches_what_fits_of_one_root(void **state)
{
    (void)state;
    uint64_t drawn = 0, views = 0;
    terrain_fixture fx;
    fixture_make(&fx, 3, 10, 1, 1, fixture_hills);
    ff_quality quality = limited(FF_MEASURE_PIXELS, 1500);
    for (int yaw = 0; yaw < 360; yaw += 30, views++) {
        ff_view view = fixture_view_above(&fx, 5000, 5200, 400, yaw, -60);
        fixture_tree(&fx, 2000, 64);
        while (deliver_in_view(&fx, &view, &quality)) {
        }
        uint32_t triangles = fixture_stats(&fx).triangles;
        assert_in_range(triangles, 1, 1500);
        drawn += triangles;
    }
    assert_true(drawn > views * 1500 * 3 / 4);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(is_kept_and_used_in_every_view),
        cmocka_unit_test(shortens_the_reach_when_roots_are_too_many),
        cmocka_unit_test(settles_in_pools_of_every_size),
        cmocka_unit_test(fetches_what_it_lets_be_drawn),
        cmocka_unit_test(fetches_what_fits_of_one_root),
        cmocka_unit_test(repeats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
