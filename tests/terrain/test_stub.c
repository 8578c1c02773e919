/* Stubs, of which nothing finer is stored though there is finer ground: the tree draws them as the
 * finest there is, asks for nothing below, and what lies beside them is as whole as ever. */
#include "../../client/terrain/ff_tree_local.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

static uint32_t stub_level;

static int is_of_stub_level(ff_key key) { return ff_key_level(key) == stub_level; }

/* Here and there, at different levels. */
static int is_stub_by_chance(ff_key key)
{
    uint64_t mixed = (key + 1) * UINT64_C(0x9E3779B97F4A7C15);
    return ff_key_level(key) > 0 && mixed >> 61 == 0;
}

static int is_below_stub(const terrain_fixture *fx, ff_key key)
{
    while (ff_key_level(key) > 0) {
        key = ff_key_parent(key);
        if (fx->is_stub(key)) return 1;
    }
    return 0;
}

/* Settles a view and fails the test when a wish is for the children of a stub. */
static void settle(terrain_fixture *fx, const ff_view *view, const ff_quality *quality)
{
    for (int round = 0; round < 500; round++) {
        const ff_wish *list;
        ff_wish wish[FIXTURE_BAG];
        ff_tree_select(fx->tree, view, quality);
        fixture_assert_whole(fx);
        uint32_t count = ff_tree_wishes(fx->tree, &list);
        if (count == 0) return;
        count = count > FIXTURE_BAG ? FIXTURE_BAG : count;
        memcpy(wish, list, count * sizeof *wish);
        for (uint32_t i = 0; i < count; i++) {
            assert_true(wish[i].kind == FF_KIND_ROOT || !fx->is_stub(wish[i].key));
            (void)fixture_deliver(fx, wish[i].key, wish[i].kind);
        }
    }
    fail_msg("the tree does not settle");
}

static void expect_stubs_drawn(const terrain_fixture *fx)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_cut(fx->tree, &list), stubs = 0;
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(list[i].stub, fx->is_stub(list[i].key));
        assert_false(is_below_stub(fx, list[i].key));
        stubs += list[i].stub;
    }
    assert_true(stubs > 0);
    assert_in_range(fixture_stats(fx).stubs, 1, stubs);
}

static void the_tree_ends_at_stubs(void **state)
{
    (void)state;
    for (stub_level = 0; stub_level < 3; stub_level++)
        for (int measure = FF_MEASURE_DISTANCE; measure <= FF_MEASURE_PIXELS; measure++) {
            terrain_fixture fx;
            fixture_usual(&fx, 3000);
            fx.is_stub = is_of_stub_level;
            ff_view view = fixture_view_above(&fx, 1500, 1100, 100, 0, -30);
            ff_quality quality = fixture_quality((enum ff_measure)measure);
            settle(&fx, &view, &quality);
            expect_stubs_drawn(&fx);
            fixture_free(&fx);
        }
}

/* The ground beside them is finer by one level at most, whatever their level, and nothing keeps on
 * being asked for. */
static void the_cut_is_whole_beside_stubs(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    fx.is_stub = is_stub_by_chance;
    for (int step = 0; step < 40; step++) {
        ff_view view = fixture_view_above(&fx, 300 + 70 * step, 500 + 30 * step, 60, 9 * step, -20);
        ff_quality quality = fixture_quality((enum ff_measure)(step % 2));
        settle(&fx, &view, &quality);
        expect_stubs_drawn(&fx);
    }
    fixture_free(&fx);
}

/* Nobody looks at a mark of the last level. */
static void stubs_of_the_last_level_are_nothing_special(void **state)
{
    (void)state;
    terrain_fixture fx;
    const ff_drawn *list;
    uint32_t finest = 0;
    fixture_usual(&fx, 3000);
    stub_level = ff_terrain_levels(&fx.info) - 1;
    fx.is_stub = is_of_stub_level;
    ff_view view = fixture_view_above(&fx, 1500, 1100, 30, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    settle(&fx, &view, &quality);
    uint32_t count = ff_tree_cut(fx.tree, &list);
    for (uint32_t i = 0; i < count; i++)
        if (ff_key_level(list[i].key) > finest) finest = ff_key_level(list[i].key);
    assert_int_equal(finest, stub_level);
    assert_int_equal(fixture_stats(&fx).stubs, 0);
    fixture_free(&fx);
}

static void nothing_below_stubs_is_foreseen_or_reserved(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_wish list[FIXTURE_BAG];
    int32_t ahead_wu[3] = { 2000 * FF_WU_PER_METRE, 1200 * FF_WU_PER_METRE, 60 * FF_WU_PER_METRE };
    uint32_t wishes = 0;
    fixture_usual(&fx, 3000);
    fx.is_stub = is_stub_by_chance;
    ff_view view = fixture_view_above(&fx, 700, 700, 100, 90, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    settle(&fx, &view, &quality);
    for (int turn = 0; turn < 16; turn++) {
        uint32_t count = ff_tree_foresee(fx.tree, ahead_wu, turn << 12, 0, list, FIXTURE_BAG / 2);
        count += ff_tree_reserve(fx.tree, list + count, FIXTURE_BAG / 2);
        for (uint32_t i = 0; i < count; i++)
            assert_true(list[i].kind == FF_KIND_ROOT || !fx.is_stub(list[i].key));
        wishes += count;
    }
    assert_true(wishes > 0);
    fixture_free(&fx);
}

static void what_a_server_sends_below_a_stub_is_not_taken(void **state)
{
    (void)state;
    terrain_fixture fx;
    stub_level = 0;
    fixture_usual(&fx, 3000);
    fx.is_stub = is_of_stub_level;
    assert_int_equal(fixture_deliver(&fx, ff_key_make(0, 0, 0), 0), FF_OK);
    assert_int_equal(fixture_deliver(&fx, ff_key_make(0, 0, 0), 1), FF_ERR_NOT_FOUND);
    assert_int_equal(fixture_stats(&fx).nodes_held, 1);
    fixture_free(&fx);
}

static void pools_of_any_size_settle(void **state)
{
    (void)state;
    for (uint32_t nodes = 8; nodes < 400; nodes += nodes < 40 ? 1 : 23) {
        terrain_fixture fx;
        fixture_usual(&fx, nodes);
        fx.is_stub = is_stub_by_chance;
        ff_view view = fixture_view_above(&fx, 1400, 1100, 50, 20, -15);
        ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
        settle(&fx, &view, &quality);
        for (unsigned frame = 0; frame < 20; frame++)
            assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
        fixture_free(&fx);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tree_ends_at_stubs),
        cmocka_unit_test(the_cut_is_whole_beside_stubs),
        cmocka_unit_test(stubs_of_the_last_level_are_nothing_special),
        cmocka_unit_test(nothing_below_stubs_is_foreseen_or_reserved),
        cmocka_unit_test(what_a_server_sends_below_a_stub_is_not_taken),
        cmocka_unit_test(pools_of_any_size_settle)
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
