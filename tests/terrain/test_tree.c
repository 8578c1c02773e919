/* The tree's rules one by one: measures, window, restriction, wishes, deliveries, skipping. */
#include "../rig/terrain_fixture.h"
#include "../../client/terrain/ff_tree_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define M FF_WU_PER_METRE

/* ---- measures ---- */

static double node_f(const terrain_fixture *fx, const ff_drawn *drawn, const ff_view *view,
                     const ff_quality *quality)
{
    double edge = ff_node_edge_wu(&fx->info, ff_key_level(drawn->key)), sum = 0,
           side = ff_node_side(&fx->info), d = 0;
    for (int i = 0; i < side * side; i++) sum += drawn->heights[i];
    double middle[3] = { drawn->origin_wu[0] + edge / 2, drawn->origin_wu[1] + edge / 2,
                         ff_height_wu(&fx->info, (uint32_t)(sum / (side * side))) };
    for (int axis = 0; axis < 3; axis++)
        d += (middle[axis] - view->camera.pos_wu[axis]) *
             (middle[axis] - view->camera.pos_wu[axis]);
    return sqrt(d) / (edge * quality->c_q8 / 256.0);
}

static void distance_splits_by_the_published_rule(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view_above(&fx, 1500, 1100, 100, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 400;
    fixture_settle(&fx, &view, &quality, 200);
    const ff_drawn *cut;
    uint32_t count = ff_tree_cut(fx.tree, &cut), levels[16] = { 0 };
    for (uint32_t i = 0; i < count; i++) {
        levels[ff_key_level(cut[i].key)]++;
        if (ff_key_level(cut[i].key) + 1 < ff_terrain_levels(&fx.info) && cut[i].coarser == 0)
            assert_true(node_f(&fx, &cut[i], &view, &quality) > 0.999);
    }
    assert_true(levels[4] > 0 && levels[3] > 0 && levels[2] > 0);
    quality.depth_max = 1;
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
    assert_int_equal(ff_tree_cut(fx.tree, &cut), 6);
    quality.depth_max = 3;
    ff_tree_select(fx.tree, &view, &quality);
    count = ff_tree_cut(fx.tree, &cut);
    for (uint32_t i = 0; i < count; i++) assert_true(ff_key_level(cut[i].key) <= 2);
    fixture_free(&fx);
}

/* The largest geometric error of a drawn node, in pixels at the distance of its box. */
static double most_error_px(const terrain_fixture *fx, const ff_view *view)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_drawn(fx->tree, &list);
    double most = 0;
    for (uint32_t i = 0; i < count; i++) {
        ff_box box;
        ff_node_box(fx->tree, list[i].node, &box);
        double distance = fmax(1, (double)ff_box_distance(&box)),
               error = ff_steps_wu(&fx->info, ff_geometric_error_decode(list[i].node->error_code));
        most = fmax(most, error * view->camera.focal_q8 / 256 / distance);
    }
    return most;
}

static void pixels_split_by_their_error(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view(1900, 600, 900, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    uint32_t last = 0;
    for (int32_t pixels = 64; pixels >= 1; pixels /= 4) {
        quality.error_px_q8 = pixels * 256;
        fixture_settle(&fx, &view, &quality, 200);
        fixture_assert_whole(&fx);
        ff_tree_stats stats = fixture_stats(&fx);
        assert_true(most_error_px(&fx, &view) <= pixels);
        assert_true(stats.nodes_cut > last);
        last = stats.nodes_cut;
    }
    fixture_free(&fx);
}

/* The same ground, asked for in different orders through different links, ends in the same cut. */
static void settled_cut_does_not_depend_on_order(void **state)
{
    (void)state;
    ff_view view = fixture_view(1500, 1100, 400, 0, -30);
    for (int measure = FF_MEASURE_DISTANCE; measure <= FF_MEASURE_PIXELS; measure++) {
        ff_quality quality = fixture_quality((enum ff_measure)measure);
        uint64_t expected = 0;
        for (uint64_t seed = 0; seed < 6; seed++) {
            terrain_fixture fx;
            fixture_usual(&fx, 4000);
            fixture_link link = { .loss_percent = (uint32_t)seed * 10, .per_frame = 5 };
            sys_random_seed(&link.random, seed, 3);
            for (unsigned frame = 0; frame < 2000; frame++) {
                const ff_wish *wish;
                ff_tree_select(fx.tree, &view, &quality);
                if (ff_tree_wishes(fx.tree, &wish) == 0) break;
                fixture_link_step(&fx, &link);
            }
            const ff_drawn *cut;
            uint64_t sum = 0;
            uint32_t count = ff_tree_cut(fx.tree, &cut);
            for (uint32_t i = 0; i < count; i++)
                sum += cut[i].key * UINT64_C(0x9E3779B97F4A7C15) + cut[i].coarser;
            if (seed == 0) expected = sum;
            assert_int_equal(sum, expected);
            fixture_free(&fx);
        }
    }
}

/* ---- window ---- */

static void only_tiles_in_the_window_are_drawn(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 5, 9, 9, fixture_hills); /* tiles of 320 m */
    fixture_tree(&fx, 400, 100);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 0;
    quality.view_wu = 100 * M;
    const ff_wish *wish;
    /* On the corner of four tiles; in the middle of one; so far that the next ones are just
     * touched; off the terrain. */
    const struct {
        int32_t x, y;
        uint32_t tiles;
    } cases[] = {
        { 4 * 320, 4 * 320, 4 },
        { 4 * 320 + 160, 4 * 320 + 160, 1 },
        { 4 * 320 + 100, 4 * 320 + 160, 2 },
        { 0, 0, 1 },
        { 9 * 320 + 100, 9 * 320, 1 },
        { 9 * 320 + 101, 9 * 320, 0 },
        { -100, 160, 1 },
        { -101, 160, 0 },
    };
    for (unsigned i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        fixture_tree(&fx, 400, 100);
        ff_view view = fixture_view(cases[i].x, cases[i].y, 200, 0, 0);
        assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
        assert_int_equal(ff_tree_wishes(fx.tree, &wish), cases[i].tiles);
        fixture_settle(&fx, &view, &quality, 10);
        assert_int_equal(fixture_stats(&fx).nodes_cut, cases[i].tiles);
        fixture_assert_whole(&fx);
    }
    /* A thousand kilometres up nothing is within view: nothing is asked for. */
    fixture_tree(&fx, 400, 100);
    ff_view view = fixture_view(700, 700, 1000 * 1000, 0, -90);
    ff_tree_select(fx.tree, &view, &quality);
    assert_int_equal(ff_tree_wishes(fx.tree, &wish), 0);
    fixture_free(&fx);
}

/* Whoever tells of a terrain says how small its tiles are, and all those in reach are walked over.
 */
static void tiles_in_reach_are_as_many_as_may_be_walked_over(void **state)
{
    static const uint32_t across[][2] = {
        { 256, 256 }, { 257, 256 }, { 65537, 1 }, { 4096, 4096 }
    };
    static const int32_t reach_m[] = { 500, 10000, 10159, 10161, 200000 };
    (void)state;
    for (size_t i = 0; i < sizeof across / sizeof *across; i++)
        for (size_t j = 0; j < sizeof reach_m / sizeof *reach_m; j++) {
            terrain_fixture fx;
            uint32_t tile, count = 0, tiles = across[i][0] * across[i][1];
            fixture_make(&fx, 3, 3, across[i][0], across[i][1], fixture_flat); /* of 80 m */
            fixture_tree(&fx, 40, 10);
            ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
            quality.view_wu = reach_m[j] * M;
            ff_view view = fixture_view(40 * (int32_t)across[i][0], 40 * (int32_t)across[i][1], 100,
                                        0, -8192);
            ff_tree_select(fx.tree, &view, &quality);
            ff_walk walk = ff_shape_walk(&fx.info, &fx.tree->window[0]);
            while (ff_shape_next(&fx.info, &walk, &tile)) count++;
            int64_t along = 2 * ((int64_t)reach_m[j] / 80) + 1; /* at least, and two more at most */
            int64_t least = 1, most = 1;
            for (int axis = 0; axis < 2; axis++) {
                int64_t there = across[i][axis];
                int64_t reached = tiles > 65536 && along > 255 ? 254 : along;
                least *= reached < there ? reached : there;
                most *= reached + 2 < there ? reached + 2 : there;
            }
            assert_in_range(count, least, most);
            assert_true(count <= 65536);
            fixture_free(&fx);
        }
}

static void a_world_of_one_node(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 3, 1, 1, fixture_hills);
    fixture_tree(&fx, 8, 4);
    ff_view view = fixture_view(40, 40, 300, 0, -90);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    assert_int_equal(fixture_settle(&fx, &view, &quality, 10), 1);
    fixture_assert_whole(&fx);
    assert_int_equal(fixture_stats(&fx).triangles, 128);
    /* delivered again: no harm */
    assert_int_equal(fixture_deliver(&fx, ff_key_make(0, 0, 0), 0), FF_OK);
    assert_int_equal(fixture_stats(&fx).nodes_held, 1);
    fixture_free(&fx);
}

/* ---- restriction ---- */

static void refinement_of_one_spot_pulls_its_neighbours(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    /* beside a corner of four tiles */
    ff_view view = fixture_view_above(&fx, 1285, 1275, 30, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 300;
    fixture_settle(&fx, &view, &quality, 200);
    fixture_assert_whole(&fx);
    const ff_drawn *cut;
    uint32_t count = ff_tree_cut(fx.tree, &cut), finest = 0;
    for (uint32_t i = 0; i < count; i++)
        finest = ff_key_level(cut[i].key) > finest ? ff_key_level(cut[i].key) : finest;
    assert_int_equal(finest, 4);
    assert_true(fixture_stats(&fx).stitched > 0);
    fixture_free(&fx);
}

static void flat_ground_asks_for_nothing_below(void **state)
{
    (void)state;
    for (int measure = FF_MEASURE_DISTANCE; measure <= FF_MEASURE_PIXELS; measure++) {
        terrain_fixture fx;
        fixture_make(&fx, 3, 7, 2, 2, fixture_flat);
        fixture_tree(&fx, 400, 64);
        ff_view view = fixture_view(1280, 1280, 130, 0, -5);
        ff_quality quality = fixture_quality((enum ff_measure)measure);
        assert_int_equal(fixture_settle(&fx, &view, &quality, 100), 4);
        ff_tree_stats stats = fixture_stats(&fx);
        assert_int_equal(stats.nodes_held, 4);
        assert_int_equal(stats.flat, measure == FF_MEASURE_DISTANCE ? 4 : 0);
        fixture_free(&fx);
    }
}

/* Beside rough ground flat ground is refined as far as the restriction needs, so that the rough
 * ground may split. */
static void flat_ground_beside_rough(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 7, 1, 1, fixture_half_flat);
    fixture_tree(&fx, 1000, 64);
    ff_view view = fixture_view(980, 640, 560, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 30 * 256;
    fixture_settle(&fx, &view, &quality, 200);
    fixture_assert_whole(&fx);
    const ff_drawn *cut;
    uint32_t count = ff_tree_cut(fx.tree, &cut), rough_and_coarse = 0, flat_and_coarse = 0;
    for (uint32_t i = 0; i < count; i++) {
        int rough = cut[i].origin_wu[0] >= 960 * M;
        rough_and_coarse += rough && ff_key_level(cut[i].key) < 4;
        flat_and_coarse += !rough && ff_key_level(cut[i].key) < 3;
    }
    assert_int_equal(rough_and_coarse, 0);
    assert_true(flat_and_coarse > 0);
    assert_true(fixture_stats(&fx).flat > 0);
    fixture_free(&fx);
}

/* ---- wishes ---- */

static void wishes_come_in_order(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view(640, 640, 300, 90, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    const ff_wish *wish;
    ff_tree_select(fx.tree, &view, &quality);
    uint32_t count = ff_tree_wishes(fx.tree, &wish);
    assert_int_equal(count, 6);
    assert_int_equal(ff_key_tile(wish[0].key), 0); /* the tile below the viewer comes first */
    fixture_deliver(&fx, ff_key_make(0, 0, 0), 0);
    fixture_deliver(&fx, ff_key_make(1, 0, 0), 0);
    uint32_t unseen = 0;
    for (unsigned round = 0; round < 40; round++) {
        ff_tree_select(fx.tree, &view, &quality);
        count = ff_tree_wishes(fx.tree, &wish);
        for (uint32_t i = 0; i < count; i++)
            unseen += wish[i].kind == FF_KIND_REFINEMENT && !wish[i].in_view;
        for (uint32_t i = 1; i < count; i++) {
            assert_true(wish[i - 1].kind <= wish[i].kind);
            if (wish[i - 1].kind == wish[i].kind) {
                assert_true(wish[i - 1].in_view >= wish[i].in_view);
                if (wish[i].kind == FF_KIND_REFINEMENT && wish[i - 1].in_view == wish[i].in_view)
                    assert_true(wish[i - 1].priority >= wish[i].priority);
            }
        }
        if (count) fixture_deliver(&fx, wish[count - 1].key, wish[count - 1].kind);
    }
    assert_true(unseen > 0);
    fixture_free(&fx);
}

/* Delivers the first wish until none is left; with unseen 0 only wishes that count as in view. */
static uint32_t deliver_wishes(terrain_fixture *fx, const ff_view *view, const ff_quality *quality,
                               int unseen)
{
    for (uint32_t delivered = 0;; delivered++) {
        const ff_wish *wish;
        ff_tree_select(fx->tree, view, quality);
        uint32_t count = ff_tree_wishes(fx->tree, &wish), at = 0;
        while (at < count && !unseen && !wish[at].in_view) at++;
        if (at == count) return delivered;
        fixture_deliver(fx, wish[at].key, wish[at].kind);
    }
}

/* The nodes in view and those that let them split are enough: the same nodes are drawn as when
 * everything has come. */
static void wishes_in_view_are_enough(void **state)
{
    (void)state;
    terrain_fixture part, whole;
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    for (int yaw = 0; yaw < 360; yaw += 30) {
        const ff_drawn *a, *b;
        fixture_make(&part, 3, 7, 2, 2, fixture_hills);
        fixture_tree(&part, 3000, 200);
        fixture_make(&whole, 3, 7, 2, 2, fixture_hills);
        fixture_tree(&whole, 3000, 200);
        ff_view view = fixture_view(900, 1000, 300, yaw, -10);
        assert_true(deliver_wishes(&part, &view, &quality, 0) <
                    deliver_wishes(&whole, &view, &quality, 1));
        uint32_t count = ff_tree_drawn(part.tree, &a);
        assert_int_equal(count, ff_tree_drawn(whole.tree, &b));
        for (uint32_t i = 0; i < count; i++)
            /* a rim may be coarser, beside a neighbour out of view */
            assert_true(a[i].key == b[i].key);
        fixture_free(&part);
        fixture_free(&whole);
    }
}

static void wish_list_is_bounded_and_keeps_the_best(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 5, 30, 30, fixture_hills);
    fixture_tree(&fx, 3000, 20);
    ff_view view = fixture_view(15 * 320 + 160, 15 * 320 + 160, 200, 0, -90);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    const ff_wish *wish;
    ff_tree_select(fx.tree, &view, &quality);
    /* roots out of view take a quarter of the list */
    assert_int_equal(ff_tree_wishes(fx.tree, &wish), 5);
    assert_int_equal(ff_key_tile(wish[0].key), 15 * 30 + 15);
    fixture_deliver(&fx, wish[0].key, 0);
    ff_tree_select(fx.tree, &view, &quality);
    assert_int_equal(ff_tree_wishes(fx.tree, &wish), 6);
    assert_true(wish[5].kind == FF_KIND_REFINEMENT && ff_key_tile(wish[5].key) == 15 * 30 + 15);
    fixture_free(&fx);
}

static void bad_deliveries_are_refused(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 100);
    int32_t value[FF_REFINED_HEIGHTS_MAX] = { 0 };
    ff_residuals residuals = { .count = 81, .value = value };
    assert_int_equal(ff_tree_deliver_root(fx.tree, 6, 0, &residuals), FF_ERR_RANGE);
    assert_int_equal(ff_tree_deliver_children(fx.tree, ff_key_make(0, 4, 0), 0, &residuals),
                     FF_ERR_RANGE);
    assert_int_equal(ff_tree_deliver_children(fx.tree, ff_key_make(0, 1, 7), 0, &residuals),
                     FF_ERR_RANGE);
    assert_int_equal(ff_tree_deliver_children(fx.tree, ff_key_make(0, 1, 3), 0, &residuals),
                     FF_ERR_NOT_FOUND);
    assert_int_equal(fixture_stats(&fx).orphans, 1);
    fixture_free(&fx);
}

static void trees_need_their_memory(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 7, 2, 2, fixture_hills);
    ff_tree_desc desc = { fx.info, 7, 10, FF_HIDDEN_FETCHED, 0, 0, 0 };
    assert_int_equal(ff_tree_bytes(&desc), 0);
    desc.node_count = 4096;
    size_t bytes = ff_tree_bytes(&desc), per_node = bytes / desc.node_count;
    assert_true(per_node < 162 + 200);
    uint8_t *memory = malloc(bytes + 1);
    assert_null(ff_tree_create(&desc, memory, bytes - 1));
    assert_non_null(ff_tree_create(&desc, memory + 1, bytes)); /* any alignment */
    free(memory);
    desc.info.tile_log2 = 20;
    assert_int_equal(ff_tree_bytes(&desc), 0);
}

/* ---- skipping ---- */

static void select_skips_when_nothing_changed(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view(640, 640, 300, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
    view.camera.near_wu = 17; /* the near plane does not change the ground */
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
    assert_int_equal(fixture_stats(&fx).selects_skipped, 2);
    fixture_deliver(&fx, ff_key_make(1, 0, 0), 0);
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
    fixture_deliver(&fx, ff_key_make(1, 0, 0), 0); /* the tree holds this node already */
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
    view.camera.yaw++;
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
    view.centre_wu[1]++;
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
    quality.c_q8++;
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
    quality.c_q8 = -5; /* a setting out of range is clamped the same way every time */
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 1);
    assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distance_splits_by_the_published_rule),
        cmocka_unit_test(pixels_split_by_their_error),
        cmocka_unit_test(settled_cut_does_not_depend_on_order),
        cmocka_unit_test(only_tiles_in_the_window_are_drawn),
        cmocka_unit_test(tiles_in_reach_are_as_many_as_may_be_walked_over),
        cmocka_unit_test(a_world_of_one_node),
        cmocka_unit_test(refinement_of_one_spot_pulls_its_neighbours),
        cmocka_unit_test(flat_ground_asks_for_nothing_below),
        cmocka_unit_test(flat_ground_beside_rough),
        cmocka_unit_test(wishes_come_in_order),
        cmocka_unit_test(wishes_in_view_are_enough),
        cmocka_unit_test(wish_list_is_bounded_and_keeps_the_best),
        cmocka_unit_test(bad_deliveries_are_refused),
        cmocka_unit_test(trees_need_their_memory),
        cmocka_unit_test(select_skips_when_nothing_changed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
