/* Below leaves nothing is stored: the tree makes the ground there itself, and asks for none. */
#include "../../client/terrain/ff_tree_local.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

/* Settles a view and fails the test when a wish goes below the leaves. */
static void settle(terrain_fixture *fx, const ff_view *view, const ff_quality *quality)
{
    for (int round = 0; round < 500; round++) {
        const ff_wish *list;
        ff_wish wish[FIXTURE_BAG];
        ff_tree_select(fx->tree, view, quality);
        uint32_t count = ff_tree_wishes(fx->tree, &list);
        if (count == 0 && ff_tree_to_make(fx->tree) == 0) return;
        count = count > FIXTURE_BAG ? FIXTURE_BAG : count;
        memcpy(wish, list, count * sizeof *wish);
        for (uint32_t i = 0; i < count; i++) {
            assert_true(wish[i].kind == FF_KIND_ROOT || ff_key_level(wish[i].key) < fx->leaf_level);
            (void)fixture_deliver(fx, wish[i].key, wish[i].kind);
        }
    }
    fail_msg("the tree does not settle");
}

/* A node held below a leaf: what its parent predicts, half the parent's error, and a leaf too. */
static void expect_predicted(const terrain_fixture *fx, const ff_node *node)
{
    const ff_tree *tree = fx->tree;
    size_t heights = ff_heights_per_node(tree);
    uint16_t refined[FF_REFINED_HEIGHTS_MAX], child[FF_NODE_HEIGHTS_MAX];
    ff_predict_children(tree->ground, ff_shape_cells(tree->ground, tree->node[node->parent].key, 1),
                        tree->heights + node->parent * heights, refined, codec_room);
    ff_refined_child(tree->ground, refined, ff_key_quadrant(node->key), child);
    assert_memory_equal(child, tree->heights + ff_slot_of(tree, node) * heights,
                        heights * sizeof *child);
    assert_int_equal(node->error_code,
                     ff_geometric_error_below(tree->ground, tree->node[node->parent].error_code));
    assert_true(node->flags & FF_NODE_LEAF);
}

static void the_tree_makes_what_is_not_stored(void **state)
{
    (void)state;
    for (uint32_t leaf_level = 0; leaf_level < 3; leaf_level++)
        for (int measure = FF_MEASURE_DISTANCE; measure <= FF_MEASURE_PIXELS; measure++) {
            terrain_fixture fx;
            uint32_t below = 0;
            fixture_usual(&fx, 3000);
            fx.leaf_level = leaf_level;
            ff_view view = fixture_view_above(&fx, 1500, 1100, 100, 0, -30);
            ff_quality quality = fixture_quality((enum ff_measure)measure);
            settle(&fx, &view, &quality);
            fixture_assert_whole(&fx);
            for (uint32_t slot = 0; slot < fx.tree->node_count; slot++) {
                const ff_node *node = &fx.tree->node[slot];
                if (!ff_node_held(node) || ff_key_level(node->key) <= leaf_level) continue;
                expect_predicted(&fx, node);
                below++;
            }
            assert_true(below > 40);
            fixture_free(&fx);
        }
}

/* A flat root of that error, a filled leaf, seen from near by: how many leaves are to be split. */
static uint32_t split_of_flat(terrain_fixture *fx, uint8_t error_code, uint16_t max_error)
{
    static int32_t value[FF_NODE_HEIGHTS_MAX];
    fixture_make(fx, 3, 7, 1, 1, fixture_flat);
    fx->info.max_error = max_error;
    fixture_tree(fx, 200, 40);
    uint32_t side = ff_node_side(&fx->info);
    ff_residuals root = { .child_error = { error_code },
                          .filled = 1,
                          .leaf = 1,
                          .count = (uint16_t)(side * side),
                          .value = value };
    ff_view view = fixture_view(640, 640, 100, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    assert_int_equal(ff_tree_deliver_root(fx->tree, 0, 0, &root), FF_OK);
    ff_tree_select(fx->tree, &view, &quality);
    uint32_t count = ff_tree_to_make(fx->tree);
    ff_tree_select(fx->tree, &view, &quality);
    return count;
}

/* What lies within the bound of the source is not made finer: nothing better is known. */
static void leaves_within_the_bound_are_not_split(void **state)
{
    (void)state;
    for (uint8_t max_error = 0; max_error <= 5; max_error += 5)
        for (uint8_t error = 0; error <= 7; error++) {
            terrain_fixture fx;
            assert_int_equal(split_of_flat(&fx, error, max_error), error > max_error);
            assert_int_equal(fixture_stats(&fx).nodes_held, error > max_error ? 5 : 1);
            fixture_free(&fx);
        }
}

static void what_was_filled_is_filled_below_leaves(void **state)
{
    (void)state;
    terrain_fixture fx;
    assert_int_equal(split_of_flat(&fx, 7, 0), 1);
    for (uint32_t q = 0; q < 4; q++) {
        uint32_t slot = ff_tree_find(fx.tree, ff_key_child(ff_key_make(0, 0, 0), q));
        assert_true(slot != FF_SLOT_NONE && fx.tree->node[slot].flags & FF_NODE_FILLED);
    }
    fixture_free(&fx);
}

/* Also where there is no room for all: it does not make and drop the same nodes again and again. */
static void pools_of_any_size_settle(void **state)
{
    (void)state;
    for (uint32_t nodes = 8; nodes < 400; nodes += nodes < 40 ? 1 : 23) {
        terrain_fixture fx;
        fixture_usual(&fx, nodes);
        fx.leaf_level = 1;
        ff_view view = fixture_view_above(&fx, 1400, 1100, 50, 20, -15);
        ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
        settle(&fx, &view, &quality);
        fixture_assert_whole(&fx);
        for (unsigned frame = 0; frame < 20; frame++)
            assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
        fixture_free(&fx);
    }
}

/* A node that was to be split goes, and comes again from a server that calls it no leaf now. */
static void a_leaf_may_come_again_as_none(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    fx.leaf_level = 0;
    ff_view view = fixture_view_above(&fx, 1500, 1100, 100, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    const ff_wish *list;
    ff_tree_select(fx.tree, &view, &quality);
    assert_true(ff_tree_wishes(fx.tree, &list) > 0);
    uint32_t tile = ff_key_tile(list[0].key);
    (void)fixture_deliver(&fx, list[0].key, 0);
    ff_tree_select(fx.tree, &view, &quality);
    assert_int_equal(ff_tree_to_make(fx.tree), 1);
    ff_tree_drop_root(fx.tree, &fx.tree->node[ff_tree_find(fx.tree, ff_key_make(tile, 0, 0))]);
    fx.leaf_level = UINT32_MAX;
    (void)fixture_deliver(&fx, ff_key_make(tile, 0, 0), 0);
    ff_tree_select(fx.tree, &view, &quality);
    assert_int_equal(ff_tree_to_make(fx.tree), 0);
    assert_false(
        ff_node_has_children(&fx.tree->node[ff_tree_find(fx.tree, ff_key_make(tile, 0, 0))]));
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(the_tree_makes_what_is_not_stored),
                                        cmocka_unit_test(leaves_within_the_bound_are_not_split),
                                        cmocka_unit_test(what_was_filled_is_filled_below_leaves),
                                        cmocka_unit_test(pools_of_any_size_settle),
                                        cmocka_unit_test(a_leaf_may_come_again_as_none) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
