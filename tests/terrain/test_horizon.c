/* What near ground hides: never anything that has a pixel, and only where it is known to be
 * hidden. */
#include "../../sim/judge/sim_cover.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define NODES    4000
#define RIDGE_M  1500 /* east of the border, from south to north, 300 m high */
#define RIDGE_UP 300
#define BACK_M   3500
#define LIST     64
#define DOWN     (-6000) /* 33 degrees */

static uint16_t ridge(uint32_t x, uint32_t y)
{
    uint32_t away = x > RIDGE_M / 10 ? x - RIDGE_M / 10 : RIDGE_M / 10 - x;
    return (uint16_t)(100 + (away < 15 ? RIDGE_UP - 20 * away : 0) + fixture_hills(x, y) / 10);
}

/* Behind it a valley, and a ridge that stands steeper before the eye. */
static uint16_t valley(uint32_t x, uint32_t y)
{
    uint32_t away = x > BACK_M / 10 ? x - BACK_M / 10 : BACK_M / 10 - x;
    return (uint16_t)(ridge(x, y) + (away < 65 ? 1300 - 20 * away : 0));
}

/* Ground with its ridges, and a tree over it. */
static void open_ground(terrain_fixture *fx, fixture_height height, enum ff_hidden hidden)
{
    fixture_make(fx, 3, 7, 4, 3, height);
    fx->hidden = hidden;
    fixture_tree(fx, NODES, LIST);
}

/* Delivers what is wished for in view until there is nothing; how much came. */
static uint32_t settle_in_view(terrain_fixture *fx, const ff_view *view, const ff_quality *quality)
{
    uint32_t delivered = 0, before;
    do {
        ff_wish wish[LIST];
        const ff_wish *list;
        before = delivered;
        ff_tree_select(fx->tree, view, quality);
        uint32_t count = ff_tree_wishes(fx->tree, &list);
        memcpy(wish, list, count * sizeof *wish);
        for (uint32_t i = 0; i < count; i++)
            if (wish[i].in_view)
                delivered += fixture_deliver(fx, wish[i].key, wish[i].kind) == FF_OK;
    } while (delivered > before);
    return delivered;
}

static void roots(terrain_fixture *fx)
{
    for (uint32_t tile = 0; tile < fx->info.tiles_x * fx->info.tiles_y; tile++)
        assert_int_equal(fixture_deliver(fx, ff_key_make(tile, 0, 0), 0), FF_OK);
}

/* ---- exact ---- */

/* Counts the nodes that are left out; none has a pixel. */
static uint32_t check_pixels(const terrain_fixture *fx, const sim_mesh *mesh, sim_cover *cover,
                             const ff_view *view)
{
    const ff_drawn *list;
    uint32_t drawn = ff_tree_drawn(fx->tree, &list), count = ff_tree_in_view(fx->tree, &list),
             pixels = (uint32_t)view->camera.width * view->camera.height;
    assert_int_equal(sim_cover_make(cover, mesh, &view->camera, 1, list, count), FF_OK);
    for (uint32_t i = 0; i < pixels; i++) assert_true(cover->node[i] <= drawn);
    ff_tree_stats stats = fixture_stats(fx);
    assert_int_equal(stats.nodes_hidden, count - drawn);
    return count - drawn;
}

static ff_view random_view(const terrain_fixture *fx, sys_random *random)
{
    static const int32_t above_m[] = { -5, 2, 20, 100, 600 };
    int32_t size_m[2] = { (int32_t)fx->info.samples_x * 10 - 20,
                          (int32_t)fx->info.samples_y * 10 - 20 },
            x_m = 10 + (int32_t)sys_random_below(random, (uint32_t)size_m[0] - 10),
            y_m = 10 + (int32_t)sys_random_below(random, (uint32_t)size_m[1] - 10);
    ff_view view = fixture_view_above(fx, x_m, y_m, above_m[sys_random_below(random, 5)],
                                      (int32_t)sys_random_below(random, 360),
                                      (int32_t)sys_random_below(random, 100) - 60);
    if (sys_random_below(random, 3) == 0) view.camera.pitch = 0;
    if (sys_random_below(random, 2)) view.camera.roll = (int32_t)sys_random_below(random, 65536);
    view.camera.width = 120;
    view.camera.height = 160;
    view.camera.focal_q8 = (int32_t)(20 + sys_random_below(random, 300)) * 256;
    return view;
}

static uint32_t hidden_in_views(fixture_height height, uint32_t curve, unsigned views)
{
    sys_random random;
    sim_mesh mesh;
    sim_cover cover = { 0 };
    terrain_fixture fx;
    uint32_t hidden = 0;
    sys_random_seed(&random, 7, 1);
    fixture_make(&fx, 3, 7, 4, 3, height);
    fixture_samples(&fx, 450, 333); /* the ground ends within its tiles */
    fx.info.curve_q60 = curve;
    fx.hidden = FF_HIDDEN_LEFT_OUT;
    assert_int_equal(sim_mesh_make(&mesh, &fx.info), FF_OK);
    for (unsigned i = 0; i < views; i++) {
        ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
        fixture_link link = { .loss_percent = 50, .per_frame = 40 };
        sys_random_seed(&link.random, i, 2);
        fixture_tree(&fx, NODES, LIST);
        ff_view view = random_view(&fx, &random);
        if (i % 4 == 0) quality.view_wu = 1500 * FF_WU_PER_METRE;
        for (unsigned frame = 0; frame < 12; frame++) {
            ff_tree_select(fx.tree, &view, &quality);
            hidden += check_pixels(&fx, &mesh, &cover, &view);
            fixture_link_step(&fx, &link);
            view.camera.yaw += 500;
        }
        fixture_assert_whole(&fx);
        fixture_free(&fx);
    }
    sim_cover_free(&cover);
    sim_mesh_free(&mesh);
    return hidden;
}

static void what_is_hidden_has_no_pixel(void **state)
{
    (void)state;
    assert_true(hidden_in_views(fixture_hills, 0, 60) > 1000);
    assert_true(hidden_in_views(ridge, 0, 60) > 500);
    assert_true(hidden_in_views(ridge, FF_CURVE_MAX, 30) > 100);
    (void)hidden_in_views(fixture_cliffs, 0, 30);
    (void)hidden_in_views(fixture_half_flat, 0, 30);
}

/* ---- asked for ---- */

static void hidden_ground_is_not_wished_for(void **state)
{
    (void)state;
    terrain_fixture left_out, fetched;
    open_ground(&left_out, ridge, FF_HIDDEN_LEFT_OUT);
    open_ground(&fetched, ridge, FF_HIDDEN_FETCHED);
    roots(&left_out);
    roots(&fetched);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    ff_view view = fixture_view_above(&left_out, 600, 2000, 30, 90, 0);
    uint32_t few = settle_in_view(&left_out, &view, &quality),
             many = settle_in_view(&fetched, &view, &quality);
    ff_tree_stats less = fixture_stats(&left_out), more = fixture_stats(&fetched);
    assert_true(few > 0 && few < many);
    assert_true(less.nodes_hidden > 0 && less.triangles_hidden > 0);
    assert_true(less.triangles < more.triangles);
    assert_int_equal(more.nodes_hidden, 0);
    /* a still camera: no wish in view is left, and nothing changes */
    assert_int_equal(settle_in_view(&left_out, &view, &quality), 0);
    assert_int_equal(ff_tree_select(left_out.tree, &view, &quality), 0);

    /* over the ridge all that is drawn of the one is drawn of the other */
    view = fixture_view_above(&left_out, RIDGE_M, 2000, 100, 90, -10);
    assert_true(settle_in_view(&left_out, &view, &quality) > 0);
    settle_in_view(&fetched, &view, &quality);
    less = fixture_stats(&left_out);
    more = fixture_stats(&fetched);
    assert_int_equal(less.triangles + less.triangles_hidden, more.triangles);
    fixture_free(&left_out);
    fixture_free(&fetched);
}

/* Nodes that the valley has in a settled picture from before both ridges. */
static uint32_t held_in_valley(enum ff_hidden hidden)
{
    terrain_fixture fx;
    open_ground(&fx, valley, hidden);
    roots(&fx);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    const ff_view view = fixture_view_above(&fx, 600, 2000, 30, 90, 10);
    const ff_drawn *list;
    settle_in_view(&fx, &view, &quality); /* the ridges are known now */
    quality.error_px_q8 = 64;
    settle_in_view(&fx, &view, &quality);
    uint32_t count = ff_tree_in_view(fx.tree, &list), nodes = 0;
    for (uint32_t i = 0; i < count; i++) {
        int32_t origin_wu[3];
        fixture_origin(&fx.info, list[i].key, origin_wu);
        nodes += origin_wu[0] >= (RIDGE_M + 200) * FF_WU_PER_METRE &&
                 origin_wu[0] < (BACK_M - 700) * FF_WU_PER_METRE;
    }
    fixture_free(&fx);
    return nodes;
}

static void a_valley_between_ridges_is_not_wished_for(void **state)
{
    (void)state;
    uint32_t few = held_in_valley(FF_HIDDEN_LEFT_OUT), many = held_in_valley(FF_HIDDEN_FETCHED);
    assert_true(few > 0 && 2 * few < many);
}

/* One after the other, the refinements that are left to wish for come, those of hidden ground among
 * them, and then the roots of the reserve. Nothing of the picture is given up for them. Returns how
 * many came. */
static uint32_t deliver_out_of_view(terrain_fixture *fx, const ff_view *view,
                                    const ff_quality *quality)
{
    for (uint32_t came = 0;; came++) {
        const ff_wish *wish;
        const ff_drawn *drawn;
        ff_wish next;
        uint32_t count = ff_tree_wishes(fx->tree, &wish), at = 0,
                 before = ff_tree_drawn(fx->tree, &drawn);
        while (at < count && wish[at].kind != FF_KIND_REFINEMENT) at++;
        if (at < count)
            next = wish[at];
        else if (!ff_tree_reserve(fx->tree, &next, 1))
            return came;
        assert_false(next.in_view);
        assert_int_equal(fixture_deliver(fx, next.key, next.kind), FF_OK);
        settle_in_view(fx, view, quality);
        assert_true(ff_tree_drawn(fx->tree, &drawn) >= before);
        assert_true(came < 4000);
    }
}

/* In pools of every size what is in view comes to an end, then the rest, and then nothing changes
 * any more. */
static void full_pools_settle(void **state)
{
    (void)state;
    static const fixture_height ground[] = { ridge, valley, fixture_hills };
    uint32_t came = 0;
    for (uint32_t nodes = 16; nodes < 1200; nodes += nodes / 2) {
        for (unsigned g = 0; g < 3; g++) {
            terrain_fixture fx;
            fixture_make(&fx, 3, 7, 4, 3, ground[g]);
            fx.hidden = FF_HIDDEN_LEFT_OUT;
            fixture_tree(&fx, nodes, LIST);
            ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
            quality.error_px_q8 = 16;
            quality.triangles_max = g == 0 ? 40000 : 0;
            const ff_view view = fixture_view_above(&fx, 600, 2000, 30, 90, 0);
            settle_in_view(&fx, &view, &quality);
            came += deliver_out_of_view(&fx, &view, &quality);
            ff_wish list[LIST];
            uint32_t held = fixture_stats(&fx).nodes_held;
            for (unsigned frame = 0; frame < 40; frame++) {
                assert_int_equal(ff_tree_select(fx.tree, &view, &quality), 0);
                assert_int_equal(ff_tree_reserve(fx.tree, list, LIST), 0);
            }
            assert_int_equal(fixture_stats(&fx).nodes_held, held);
            fixture_assert_whole(&fx);
            fixture_free(&fx);
        }
    }
    assert_true(came > 100);
}

/* What is foreseen straight behind the part of the ridge that is held as it is. */
static uint32_t foreseen_beyond(const terrain_fixture *fx, const int32_t pos_wu[3])
{
    ff_wish list[LIST];
    uint32_t count = ff_tree_foresee(fx->tree, pos_wu, 0, DOWN, list, LIST), beyond = 0;
    for (uint32_t i = 0; i < count; i++) {
        int32_t origin_wu[3];
        fixture_origin(&fx->info, list[i].key, origin_wu);
        beyond += origin_wu[0] >= RIDGE_M * FF_WU_PER_METRE &&
                  abs(origin_wu[1] - 2000 * FF_WU_PER_METRE) < 200 * FF_WU_PER_METRE;
    }
    return beyond;
}

static void ground_beyond_a_ridge_is_foreseen_from_above(void **state)
{
    (void)state;
    terrain_fixture fx;
    open_ground(&fx, ridge, FF_HIDDEN_LEFT_OUT);
    roots(&fx);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    quality.error_px_q8 = 64;
    ff_view view = fixture_view_above(&fx, 600, 2000, 30, 90, 0);
    settle_in_view(&fx, &view, &quality);
    const ff_view before = fixture_view_above(&fx, 800, 2000, 30, 90, 0),
                  above = fixture_view_above(&fx, RIDGE_M, 2000, 40, 90, 0);
    assert_int_equal(foreseen_beyond(&fx, before.camera.pos_wu), 0);
    assert_true(foreseen_beyond(&fx, above.camera.pos_wu) > 0);
    fixture_free(&fx);
}

/* ---- where nothing hides ---- */

static uint32_t hidden_from(terrain_fixture *fx, const ff_view *view)
{
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    ff_tree_select(fx->tree, view, &quality);
    return fixture_stats(fx).nodes_hidden;
}

static void only_whole_ground_under_the_eye_hides(void **state)
{
    (void)state;
    terrain_fixture fx;
    open_ground(&fx, ridge, FF_HIDDEN_LEFT_OUT);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    ff_view view = fixture_view_above(&fx, 600, 2000, 30, 90, 0), other = view;
    roots(&fx);
    settle_in_view(&fx, &view, &quality);
    assert_true(hidden_from(&fx, &view) > 0);
    other.camera.pos_wu[2] -= 60 * FF_WU_PER_METRE; /* below ground */
    assert_int_equal(hidden_from(&fx, &other), 0);
    other = view;
    other.camera.near_wu = 100 * FF_WU_PER_METRE; /* ground below is cut off */
    assert_int_equal(hidden_from(&fx, &other), 0);
    other = view;
    other.camera.pos_wu[0] = other.centre_wu[0] = -100 * FF_WU_PER_METRE; /* beside the terrain */
    assert_int_equal(hidden_from(&fx, &other), 0);

    /* a tile in view is missing: the ridge that stands on it and beyond hides nothing */
    fixture_tree(&fx, NODES, LIST);
    for (uint32_t tile = 0; tile < 12; tile++)
        if (tile != 5) assert_int_equal(fixture_deliver(&fx, ff_key_make(tile, 0, 0), 0), FF_OK);
    assert_int_equal(hidden_from(&fx, &view), 0);
    fixture_free(&fx);
}

static void where_little_is_hidden_it_rests(void **state)
{
    (void)state;
    terrain_fixture fx;
    unsigned found = 0;
    open_ground(&fx, fixture_hills, FF_HIDDEN_LEFT_OUT);
    roots(&fx);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    ff_view view = fixture_view_above(&fx, 600, 2000, 534, 90, 0);
    quality.depth_max = 3;
    settle_in_view(&fx, &view, &quality);
    for (unsigned i = 0; i < 32; i++) {
        view.camera.pos_wu[0] += 16;
        view.centre_wu[0] += 16;
        ff_tree_select(fx.tree, &view, &quality);
        found += fixture_stats(&fx).nodes_hidden > 0;
    }
    assert_int_equal(found, 2); /* in one view of sixteen */
    assert_int_equal(fixture_stats(&fx).nodes_hidden, 0);
    quality.depth_max = 0; /* now nodes lack children, and hidden ones are not to be asked for */
    ff_tree_select(fx.tree, &view, &quality);
    assert_true(fixture_stats(&fx).nodes_hidden > 0);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_hidden_has_no_pixel),
        cmocka_unit_test(hidden_ground_is_not_wished_for),
        cmocka_unit_test(a_valley_between_ridges_is_not_wished_for),
        cmocka_unit_test(full_pools_settle),
        cmocka_unit_test(ground_beyond_a_ridge_is_foreseen_from_above),
        cmocka_unit_test(where_little_is_hidden_it_rests),
        cmocka_unit_test(only_whole_ground_under_the_eye_hides),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
