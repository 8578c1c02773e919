/* A second shape behind the seam (turned_shapes.h): whoever asks of a node only what ff_shape.h
 * answers draws the same ground of turned tiles. Built with a list of shapes of its own, and with
 * its own objects of protocol/ and client/terrain/. */
#include "../../sim/judge/sim_watertight.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#define ALL_KINDS  0x6c9d27e4u /* every quarter turn beside every other one */
#define HALF_TURNS 0x88222888u /* half turns keep the diagonals of cells as well */

uint32_t turned_tiles;

/* ---- neighbours ---- */

static void rim_place(const ff_terrain_info *info, ff_key key, enum ff_side side, uint32_t along,
                      int32_t place_wu[3])
{
    const int32_t nowhere[3] = { 0, 0, 0 };
    uint32_t last = 1u << info->node_log2;
    ff_frame frame = ff_shape_frame(info, nowhere);
    ff_placed placed = ff_shape_put(info, &frame, key);
    ff_shape_place(info, key, &placed,
                   side == FF_SIDE_EAST   ? last
                   : side == FF_SIDE_WEST ? 0
                                          : along,
                   side == FF_SIDE_NORTH   ? last
                   : side == FF_SIDE_SOUTH ? 0
                                           : along,
                   500, place_wu);
}

static void check_side(const ff_terrain_info *info, ff_key key, enum ff_side side)
{
    uint32_t last = 1u << info->node_log2;
    ff_beside beside = ff_shape_neighbour(info, key, side);
    if (beside.key == FF_KEY_NONE) return;
    ff_beside back = ff_shape_neighbour(info, beside.key, beside.side);
    assert_true(back.key == key && back.side == side && back.reversed == beside.reversed);
    for (uint32_t along = 0; along <= last; along++) {
        int32_t here[3], there[3];
        rim_place(info, key, side, along, here);
        rim_place(info, beside.key, beside.side, ff_beside_along(&beside, along, last), there);
        assert_memory_equal(here, there, sizeof here);
    }
}

static void sides_meet(void **state)
{
    (void)state;
    terrain_fixture fx;
    turned_tiles = ALL_KINDS;
    fixture_make(&fx, 2, 5, 4, 4, fixture_hills);
    for (uint32_t level = 0; level <= 3; level++)
        for (uint32_t tile = 0; tile < 16; tile++)
            for (uint32_t code = 0; code < 1u << (2 * level); code++)
                for (int side = 0; side < FF_SIDE_COUNT; side++)
                    check_side(&fx.info, ff_key_make(tile, level, code), (enum ff_side)side);
}

/* ---- the same ground ---- */

typedef struct pair {
    terrain_fixture plane, turned;
    uint32_t turns;
} pair;

static void pair_settle(pair *p, uint32_t turns, uint32_t max_error, const ff_view *view,
                        const ff_quality *quality)
{
    p->turns = turns;
    for (int i = 0; i < 2; i++) {
        terrain_fixture *fx = i ? &p->turned : &p->plane;
        turned_tiles = i ? turns : 0;
        fixture_make(fx, 3, 7, 3, 3, fixture_hills);
        fx->info.codec = FF_CODEC_DEFLATE;
        fx->info.max_error = (uint16_t)max_error;
        fx->info.flags = max_error ? FF_TERRAIN_LOSSY : 0;
        fixture_tree(fx, 4000, 64);
        fixture_settle(fx, view, quality, 500);
        fixture_assert_whole(fx);
    }
}

static void pair_free(pair *p)
{
    fixture_free(&p->plane);
    fixture_free(&p->turned);
}

static const ff_drawn *drawn_of(const ff_drawn *list, uint32_t count, ff_key key)
{
    for (uint32_t i = 0; i < count; i++)
        if (list[i].key == key) return &list[i];
    fail_msg("node %llx is not in the cut of the plane", (unsigned long long)key);
    return NULL;
}

/* Heights, colours, places and coarser sides of a turned node are those of the plane's. */
static void same_node(const pair *p, const ff_drawn *plane, const ff_drawn *turned)
{
    unsigned quarters = turned_by(ff_key_tile(turned->key));
    uint32_t side = ff_node_side(&p->plane.info);
    c3d_vertex expected[FF_NODE_HEIGHTS_MAX], got[FF_NODE_HEIGHTS_MAX];
    turned_tiles = 0;
    ff_tree_vertices(p->plane.tree, plane, 1, expected);
    turned_tiles = p->turns;
    ff_tree_vertices(p->turned.tree, turned, 1, got);
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t column = i % side, row = i / side;
        turned_place(quarters, side - 1, &column, &row);
        assert_int_equal(turned->heights[i], plane->heights[row * side + column]);
        assert_memory_equal(got[i].rgba, expected[row * side + column].rgba, 4);
        int32_t place_wu[3], plane_wu[3];
        ff_shape_place(&p->turned.info, turned->key, ff_tree_placed(turned->node), i % side,
                       i / side, turned->heights[i], place_wu);
        ff_planar_place(&p->plane.info, plane->key, ff_tree_placed(plane->node), column, row,
                        turned->heights[i], plane_wu);
        assert_memory_equal(place_wu, plane_wu, sizeof place_wu);
    }
    for (unsigned s = 0; s < FF_SIDE_COUNT; s++)
        assert_int_equal(turned->coarser >> s & 1, plane->coarser >> (s + quarters) % 4 & 1);
}

static void same_cut(const pair *p)
{
    const ff_drawn *plane, *turned;
    turned_tiles = p->turns;
    uint32_t count = ff_tree_cut(p->turned.tree, &turned);
    turned_tiles = 0;
    assert_int_equal(ff_tree_cut(p->plane.tree, &plane), count);
    assert_true(count > 50 && fixture_stats(&p->plane).stitched > 4);
    turned_tiles = p->turns;
    for (uint32_t i = 0; i < count; i++)
        same_node(p, drawn_of(plane, count, turned_to_plane(turned[i].key)), &turned[i]);
}

/* Points are rounded towards the first column and row of their cell, so heights may be a unit
 * apart.
 */
static void same_surface(const pair *p)
{
    sys_random random;
    sys_random_seed(&random, 4, 1);
    unsigned found = 0;
    for (int i = 0; i < 20000; i++) {
        int32_t x_wu = (int32_t)sys_random_below(&random, 3 * 128 * p->plane.info.spacing_wu),
                y_wu = (int32_t)sys_random_below(&random, 3 * 128 * p->plane.info.spacing_wu),
                expected = 0, got = 0;
        turned_tiles = 0;
        int there = ff_tree_drawn_height(p->plane.tree, x_wu, y_wu, &expected);
        turned_tiles = p->turns;
        assert_int_equal(ff_tree_drawn_height(p->turned.tree, x_wu, y_wu, &got), there);
        assert_in_range(got - expected + 1, 0, 2);
        found += (unsigned)there;
    }
    assert_true(found > 10000);
}

static void half_turned_tiles_are_the_same_ground(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 4; i++) {
        pair p;
        ff_view view = fixture_view(700 + 900 * (int32_t)i, 1300, 1100, 30 + 80 * (int32_t)i, -25);
        ff_quality quality = fixture_quality(i % 2 ? FF_MEASURE_PIXELS : FF_MEASURE_DISTANCE);
        quality.c_q8 = 600;
        quality.error_px_q8 = 5 * 256;
        pair_settle(&p, HALF_TURNS, i < 2 ? 0 : 7, &view, &quality);
        same_cut(&p);
        same_surface(&p);
        pair_free(&p);
    }
}

/* Quarter turns cut cells along the other diagonal, so errors differ: the cut is chosen by distance
 * alone. */
static void turned_tiles_have_the_same_vertices(void **state)
{
    (void)state;
    for (unsigned i = 0; i < 4; i++) {
        pair p;
        ff_view view = fixture_view(2500 - 500 * (int32_t)i, 1900, 1100, 80 * (int32_t)i, -25);
        ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
        quality.c_q8 = 600;
        pair_settle(&p, ALL_KINDS, i < 2 ? 0 : 7, &view, &quality);
        same_cut(&p);
        pair_free(&p);
    }
}

/* ---- flights ---- */

static void turned_ground_is_whole(void **state)
{
    (void)state;
    turned_tiles = ALL_KINDS;
    for (uint64_t seed = 0; seed < 40; seed++) {
        terrain_fixture fx;
        fixture_make(&fx, 3, 6, 4, 3, seed % 2 ? fixture_hills : fixture_noise);
        fixture_tree(&fx, seed % 3 ? 500 : 60, 40);
        fixture_link link = { .loss_percent = 20, .per_frame = 10 };
        sys_random random;
        sys_random_seed(&link.random, seed, 2);
        sys_random_seed(&random, seed, 1);
        ff_view view = fixture_view(0, 0, 0, 0, 0);
        ff_quality quality = fixture_quality(seed % 4 ? FF_MEASURE_DISTANCE : FF_MEASURE_PIXELS);
        for (unsigned frame = 0; frame < 60; frame++) {
            if (frame % 15 == 0)
                view = fixture_view((int32_t)sys_random_below(&random, 2500),
                                    (int32_t)sys_random_below(&random, 2000), 900,
                                    (int32_t)sys_random_below(&random, 360), -20);
            view.camera.pos_wu[0] += 20 * FF_WU_PER_METRE;
            view.centre_wu[0] += 20 * FF_WU_PER_METRE;
            ff_tree_select(fx.tree, &view, &quality);
            fixture_assert_whole(&fx);
            fixture_link_step(&fx, &link);
        }
        fixture_free(&fx);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_meet),
        cmocka_unit_test(half_turned_tiles_are_the_same_ground),
        cmocka_unit_test(turned_tiles_have_the_same_vertices),
        cmocka_unit_test(turned_ground_is_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
