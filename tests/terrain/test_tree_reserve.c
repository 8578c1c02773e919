/* The tree's part of the reserve: what it takes, where it finds room, and that what comes for it
 * leaves the picture as it is. */
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#define LIST   16
#define TILE_M 1280

/* 6 x 6 tiles of 1280 m, seen from near the border between the tiles (2, 2) and (2, 1), to the
 * north; all that is in view has come. */
static void begin(terrain_fixture *fx, uint32_t nodes, ff_view *view, ff_quality *quality)
{
    fixture_make(fx, 3, 7, 6, 6, fixture_hills);
    fixture_tree(fx, nodes, 96);
    *view = fixture_view_above(fx, 2 * TILE_M + 640, 2 * TILE_M + 100, 100, 0, -5);
    *quality = fixture_quality(FF_MEASURE_PIXELS);
    for (;;) {
        const ff_wish *wish;
        ff_tree_select(fx->tree, view, quality);
        uint32_t count = ff_tree_wishes(fx->tree, &wish), at = 0;
        while (at < count && !wish[at].in_view) at++;
        if (at == count || fixture_deliver(fx, wish[at].key, wish[at].kind) != FF_OK) return;
    }
}

/* Delivers the reserve, one after the other; returns how many came. After each the same nodes are
 * drawn as before. */
static uint32_t deliver_reserve(terrain_fixture *fx, const ff_view *view, const ff_quality *quality)
{
    ff_wish list[LIST];
    const ff_drawn *drawn;
    uint32_t delivered = 0;
    for (; ff_tree_reserve(fx->tree, list, LIST) > 0; delivered++) {
        uint32_t count = ff_tree_drawn(fx->tree, &drawn);
        assert_int_equal(fixture_deliver(fx, list[0].key, list[0].kind), FF_OK);
        ff_tree_select(fx->tree, view, quality);
        assert_int_equal(ff_tree_drawn(fx->tree, &drawn), count);
        fixture_assert_whole(fx);
    }
    return delivered;
}

static void the_reserve_is_roots_first_then_coarse_ground(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_view view;
    ff_quality quality;
    ff_wish list[LIST];
    begin(&fx, 4000, &view, &quality);
    uint32_t count = ff_tree_reserve(fx.tree, list, LIST), roots = 0;
    for (uint32_t i = 0; i < count; i++) {
        assert_false(list[i].in_view);
        roots += list[i].kind == FF_KIND_ROOT;
        if (i > 0) assert_true(list[i - 1].kind <= list[i].kind);
    }
    assert_true(roots > 4);
    assert_int_equal(ff_key_tile(list[0].key) / 6, 1); /* of the row behind the viewer */
    assert_true(deliver_reserve(&fx, &view, &quality) > roots);
    /* a turn meets ground everywhere, and nothing that is very coarse */
    const ff_wish *wish;
    view.camera.yaw = 32768;
    ff_tree_select(fx.tree, &view, &quality);
    count = ff_tree_wishes(fx.tree, &wish);
    assert_true(count > 0);
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(wish[i].kind, FF_KIND_REFINEMENT);
        if (wish[i].in_view) assert_true(wish[i].priority <= 20 * 256);
    }
    fixture_free(&fx);
}

/* A root out of view joins the cut when the nodes in view may stay as fine as they are; in view it
 * joins at once. */
static void a_new_tile_out_of_view_waits(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_view view;
    ff_quality quality;
    ff_wish list[LIST];
    const ff_drawn *cut;
    begin(&fx, 4000, &view, &quality);
    assert_int_equal(ff_tree_reserve(fx.tree, list, 1), 1);
    ff_key behind = list[0].key;
    uint32_t before = ff_tree_cut(fx.tree, &cut);
    assert_int_equal(fixture_deliver(&fx, behind, 0), FF_OK);
    ff_tree_select(fx.tree, &view, &quality);
    assert_int_equal(ff_tree_cut(fx.tree, &cut), before);
    view.camera.yaw = 32768;
    ff_tree_select(fx.tree, &view, &quality);
    uint32_t count = ff_tree_cut(fx.tree, &cut), found = 0;
    for (uint32_t i = 0; i < count; i++) found += cut[i].key == behind;
    assert_int_equal(found, 1);
    fixture_assert_whole(&fx);
    view.camera.yaw = 0; /* who was in the cut stays there */
    ff_tree_select(fx.tree, &view, &quality);
    count = ff_tree_cut(fx.tree, &cut);
    for (uint32_t i = 0; i < count; i++) found += cut[i].key == behind;
    assert_int_equal(found, 2);
    fixture_free(&fx);
}

/* In pools of all sizes nothing that is drawn is given up, and what was asked for finds room. */
static void the_reserve_takes_nothing_from_the_view(void **state)
{
    (void)state;
    uint32_t came = 0, none = 0;
    for (uint32_t nodes = 20; nodes < 800; nodes += nodes / 4) {
        terrain_fixture fx;
        ff_view view;
        ff_quality quality;
        begin(&fx, nodes, &view, &quality);
        ff_tree_select(fx.tree, &view, &quality);
        uint32_t full = fixture_stats(&fx).pool_full,
                 delivered = deliver_reserve(&fx, &view, &quality);
        assert_int_equal(fixture_stats(&fx).pool_full, full);
        came += delivered > 0;
        none += delivered == 0;
        fixture_free(&fx);
    }
    assert_true(came > 0 && none > 0);
}

/* A pool full of wanted ground in view: a nearer root out of view is refused, and drives out no
 * farther root from under its children. */
static void a_full_view_refuses_roots_elsewhere(void **state)
{
    (void)state;
    terrain_fixture fx;
    ff_view view;
    ff_quality quality;
    const uint32_t ahead = 3 * 6 + 2, behind = 1 * 6 + 2;
    begin(&fx, 4000, &view, &quality);
    quality.error_px_q8 = 1;
    fixture_tree(&fx, 9, 96);
    const ff_key keys[] = { ff_key_make(ahead, 0, 0), ff_key_make(ahead, 0, 0),
                            ff_key_make(ahead, 1, 0) };
    for (int i = 0; i < 3; i++) {
        ff_tree_select(fx.tree, &view, &quality);
        assert_int_equal(fixture_deliver(&fx, keys[i], i > 0), FF_OK);
    }
    ff_tree_select(fx.tree, &view, &quality);
    assert_int_equal(fixture_stats(&fx).nodes_held, 9);
    assert_int_equal(fixture_deliver(&fx, ff_key_make(behind, 0, 0), 0), FF_ERR_FULL);
    assert_int_equal(fixture_stats(&fx).nodes_held, 9);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_reserve_is_roots_first_then_coarse_ground),
        cmocka_unit_test(a_new_tile_out_of_view_waits),
        cmocka_unit_test(the_reserve_takes_nothing_from_the_view),
        cmocka_unit_test(a_full_view_refuses_roots_elsewhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
