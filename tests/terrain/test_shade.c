/* Colours of bare ground: the same on both sides of a node border, lit from the north-west, water
 * only where it may be. */
#include "../../client/terrain/ff_shade.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

/* A framed grid of 9 x 9 with the given rises per sample, in steps of 1 m; cells of 10 m. */
static void slope_colour(int east, int north, uint8_t rgba[4])
{
    ff_terrain_info info = {
        .node_log2 = 3, .hscale_q24 = 1 << 24, .height_min = 10, .height_max = 3000
    };
    uint16_t framed[11 * 11];
    for (int row = 0; row < 11; row++) {
        for (int column = 0; column < 11; column++)
            framed[row * 11 + column] = (uint16_t)(1500 + (column - 5) * east + (row - 5) * north);
    }
    const ff_shade_grid grid = {
        &info, ff_key_make(0, 0, 0), 2560, framed, { info.height_min, info.height_max }
    };
    ff_shade(&grid, 4, 4, rgba);
}

static int brightness(const uint8_t rgba[4]) { return rgba[0] + rgba[1] + rgba[2]; }

static void light_from_north_west(void **state)
{
    (void)state;
    uint8_t level[4], lit[4], away[4], wall[4];
    slope_colour(0, 0, level);
    slope_colour(1, -1, lit); /* falls to the north-west */
    slope_colour(-1, 1, away);
    slope_colour(-100, 100, wall);
    assert_true(brightness(lit) > brightness(level));
    assert_true(brightness(level) > brightness(away));
    /* shadows are not black */
    assert_true(brightness(away) > brightness(wall) && brightness(wall) > 60);
    assert_int_equal(level[3], 255);
}

static void steep_ground_is_rock(void **state)
{
    (void)state;
    uint8_t level[4], steep[4];
    slope_colour(0, 0, level);
    slope_colour(15, 0, steep);
    int level_tint = abs(level[0] - level[2]), steep_tint = abs(steep[0] - steep[2]);
    assert_true(steep_tint < level_tint);
}

static void water_at_zero_only(void **state)
{
    (void)state;
    uint16_t framed[11 * 11];
    uint8_t sea[4], land[4];
    memset(framed, 0, sizeof framed);
    ff_terrain_info info = {
        .node_log2 = 3, .hscale_q24 = 1 << 24, .height_min = 0, .height_max = 3000
    };
    const ff_shade_grid grid = {
        &info, ff_key_make(0, 0, 0), 2560, framed, { info.height_min, info.height_max }
    };
    ff_shade(&grid, 0, 8, sea);
    assert_true(sea[2] > sea[0]);
    info.hoffset_wu = 100 * FF_WU_PER_METRE; /* the lowest ground lies 100 m high */
    ff_shade(&grid, 0, 8, land);
    assert_true(land[2] < land[1]);
}

/* Both nodes beside a border, tiles' borders too, give its vertices the same colour. */
static void shading_has_no_seams(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 5, 2, 2, fixture_hills);
    fx.info.height_max = 1400;
    fixture_tree(&fx, 200, 64);
    ff_view view = fixture_view_above(&fx, 320, 320, 20, 0, -30);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 100 * 256;
    fixture_settle(&fx, &view, &quality, 50);
    enum { EDGE = 65 };
    static uint8_t colour[EDGE][EDGE][4], seen[EDGE][EDGE];
    memset(seen, 0, sizeof seen);
    const ff_drawn *cut;
    c3d_vertex vertex[81];
    uint32_t count = ff_tree_cut(fx.tree, &cut), shared = 0;
    assert_int_equal(count, 64);
    for (uint32_t i = 0; i < count; i++) {
        ff_tree_vertices(fx.tree, &cut[i], 1, vertex);
        for (unsigned v = 0; v < 81; v++) {
            int x = cut[i].origin_wu[0] / 2560 + vertex[v].x,
                y = cut[i].origin_wu[1] / 2560 + vertex[v].y;
            if (seen[y][x]) assert_memory_equal(colour[y][x], vertex[v].rgba, 4);
            if (x > 0 && y > 0 && x < EDGE - 1 && y < EDGE - 1) shared += seen[y][x];
            memcpy(colour[y][x], vertex[v].rgba, 4);
            seen[y][x] = 1;
        }
    }
    assert_true(shared > 800);
    fixture_free(&fx);
}

static uint32_t forgotten;
static void note(void *context, uint32_t user)
{
    (void)context;
    forgotten |= user;
}

static void neighbours_are_coloured_anew(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 5, 3, 1, fixture_hills);
    fixture_tree(&fx, 100, 64);
    ff_tree_on_evict(fx.tree, note, NULL);
    ff_view view = fixture_view(480, 160, 2000, 0, -90);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    fixture_deliver(&fx, ff_key_make(0, 0, 0), 0);
    fixture_deliver(&fx, ff_key_make(2, 0, 0), 0);
    quality.depth_max = 1;
    ff_tree_select(fx.tree, &view, &quality);
    const ff_drawn *cut;
    uint32_t count = ff_tree_cut(fx.tree, &cut);
    assert_int_equal(count, 2);
    for (uint32_t i = 0; i < count; i++) *ff_tree_user(fx.tree, cut[i].node) = 1u << i;
    forgotten = 0;
    fixture_deliver(&fx, ff_key_make(1, 0, 0), 0);
    assert_int_equal(forgotten, 3);
    ff_tree_select(fx.tree, &view, &quality);
    count = ff_tree_cut(fx.tree, &cut);
    for (uint32_t i = 0; i < count; i++) assert_int_equal(*ff_tree_user(fx.tree, cut[i].node), 0);
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_from_north_west),        cmocka_unit_test(steep_ground_is_rock),
        cmocka_unit_test(water_at_zero_only),           cmocka_unit_test(shading_has_no_seams),
        cmocka_unit_test(neighbours_are_coloured_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
