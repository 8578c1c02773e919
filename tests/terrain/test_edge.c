/* The ground ends at the terrain's last sample, wherever that lies in its tiles: in every cut, on
 * integers, for whoever asks a height, and without a crack along it. */
#include "../../client/ground/ff_ground_frame.h"
#include "../../client/terrain/ff_strips.h"
#include "../../sim/judge/sim_audit.h"
#include "../rig/slow_watertight.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#define CELL_WU (10 * FF_WU_PER_METRE)

static int32_t between(sys_random *random, int32_t lo, int32_t hi)
{
    return lo + (int32_t)sys_random_below(random, (uint32_t)(hi - lo) + 1);
}

static ff_view random_view(sys_random *random, const ff_terrain_info *info)
{
    int32_t east_m = (int32_t)info->samples_x * 10, north_m = (int32_t)info->samples_y * 10;
    return fixture_view(between(random, -500, east_m + 500), between(random, -500, north_m + 500),
                        between(random, 100, 3000), between(random, 0, 359),
                        between(random, -90, 20));
}

static ff_quality random_quality(sys_random *random)
{
    ff_quality quality = fixture_quality(sys_random_below(random, 2) ? FF_MEASURE_PIXELS
                                                                     : FF_MEASURE_DISTANCE);
    quality.c_q8 = between(random, 64, 8 * 256);
    quality.error_px_q8 = between(random, 32, 20 * 256);
    quality.depth_max = (uint8_t)between(random, 0, 6);
    return quality;
}

/* ---- what is drawn ---- */

/* Twice the area, in samples, of a node's triangles as they go to the back end; each turns the
 * right way, or lies in padding and is nothing. */
static int64_t doubled_area(const terrain_fixture *fx, const ff_strips *strips,
                            const ff_ground_frame *frame, const ff_drawn *drawn)
{
    c3d_vertex vertex[FF_NODE_HEIGHTS_MAX];
    uint32_t side = ff_node_side(&fx->info);
    int64_t sum = 0;
    uint8_t strip[5];
    ff_tree_vertices(fx->tree, drawn, 0, vertex);
    ff_ground_frame_vertices(frame, &fx->info, drawn, vertex, side * side);
    for (uint32_t i = 0; i < side * side; i++) {
        int64_t x = (int64_t)vertex[i].x * CELL_WU + frame->origin_wu[0],
                y = (int64_t)vertex[i].y * CELL_WU + frame->origin_wu[1];
        assert_in_range(x, 0, (fx->info.samples_x - 1) * CELL_WU);
        assert_in_range(y, 0, (fx->info.samples_y - 1) * CELL_WU);
    }
    for (unsigned s = 0, count = ff_strips_for(drawn->coarser, strip); s < count; s++)
        for (unsigned i = 0; i + 2 < strips->length[strip[s]]; i++) {
            const uint16_t *index = strips->index + strips->first[strip[s]] + i;
            const c3d_vertex *a = &vertex[index[0]], *b = &vertex[index[1 + (i & 1)]],
                             *c = &vertex[index[2 - (i & 1)]];
            int64_t doubled = (int64_t)(b->x - a->x) * (c->y - a->y) -
                              (int64_t)(c->x - a->x) * (b->y - a->y);
            assert_true(doubled >= 0);
            sum += doubled;
        }
    return sum;
}

/* The tree counts as triangles what has an area. */
static uint32_t triangles_with_area(const terrain_fixture *fx, const ff_strips *strips,
                                    const ff_drawn *drawn)
{
    uint32_t side = ff_node_side(&fx->info), count = 0;
    uint8_t strip[5];
    ff_placed placed = ff_shape_put(&fx->info, ff_tree_frame(fx->tree), drawn->key);
    for (unsigned s = 0, strips_of = ff_strips_for(drawn->coarser, strip); s < strips_of; s++)
        for (unsigned i = 0; i + 2 < strips->length[strip[s]]; i++) {
            const uint16_t *index = strips->index + strips->first[strip[s]] + i;
            int32_t at[3][3];
            for (unsigned v = 0; v < 3; v++)
                ff_shape_place(&fx->info, drawn->key, &placed, index[v] % side, index[v] / side, 0,
                               at[v]);
            count += (int64_t)(at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) !=
                     (int64_t)(at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
        }
    return count;
}

/* Whole by both judges, and no larger than the ground. */
static void judge_cut(terrain_fixture *fx, const ff_strips *strips)
{
    const ff_drawn *cut, *seen;
    char why[160] = "";
    int64_t area = 0;
    uint32_t triangles = 0, drawn = ff_tree_drawn(fx->tree, &seen),
             count = ff_tree_cut(fx->tree, &cut);
    int32_t east = (int32_t)fx->info.samples_x - 1, north = (int32_t)fx->info.samples_y - 1;
    ff_ground_frame frame = { .origin_wu = { (east < 7 ? east : 7) * CELL_WU,
                                             (north < 3 ? north : 3) * CELL_WU },
                              .set = 1 };
    fixture_assert_whole(fx);
    if (!slow_watertight_check(&fx->info, cut, count, why, sizeof why)) fail_msg("%s", why);
    for (uint32_t i = 0; i < count; i++) {
        area += doubled_area(fx, strips, &frame, &cut[i]);
        if (i < drawn) triangles += triangles_with_area(fx, strips, &cut[i]);
    }
    assert_int_equal(fixture_stats(fx).triangles, triangles);
    assert_true(area <= 2 * (int64_t)(fx->info.samples_x - 1) * (fx->info.samples_y - 1));
}

static void fly(uint64_t seed, unsigned node_log2, unsigned tile_log2, uint32_t samples_x,
                uint32_t samples_y, uint32_t nodes, uint16_t max_error)
{
    static ff_strips strips;
    terrain_fixture fx;
    sys_random random;
    sys_random_seed(&random, seed, 1);
    fixture_make(&fx, node_log2, tile_log2, 1, 1, seed % 5 ? fixture_hills : fixture_noise);
    fixture_samples(&fx, samples_x, samples_y);
    fx.info.max_error = max_error;
    fx.info.flags = max_error ? FF_TERRAIN_LOSSY : 0;
    fixture_tree(&fx, nodes, 40);
    assert_int_equal(ff_strips_make(&strips, node_log2), FF_OK);
    fixture_link link = { .loss_percent = sys_random_below(&random, 40),
                          .per_frame = 1 + sys_random_below(&random, 12) };
    sys_random_seed(&link.random, seed, 2);
    ff_quality quality = random_quality(&random);
    ff_view view = random_view(&random, &fx.info);
    for (unsigned frame = 0; frame < 30; frame++) {
        uint32_t what = sys_random_below(&random, 8);
        if (what == 0) view = random_view(&random, &fx.info);
        if (what == 1) quality = random_quality(&random);
        ff_tree_select(fx.tree, &view, &quality);
        judge_cut(&fx, &strips);
        fixture_link_step(&fx, &link);
    }
    fixture_free(&fx);
}

static void flights_along_the_edge_are_whole(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++)
        fly(seed, 3, 5 + seed % 2, 100, 70, seed % 3 ? 900 : 60, seed % 4 == 3 ? 7 : 0);
}

static void terrains_of_any_size_end_at_their_last_sample(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 3, 3);
    for (uint64_t seed = 100; seed < 160; seed++) {
        unsigned node_log2 = 1 + sys_random_below(&random, 4),
                 tile_log2 = node_log2 + sys_random_below(&random, 4);
        fly(seed, node_log2, tile_log2, 2 + sys_random_below(&random, 150),
            2 + sys_random_below(&random, 90), 8 + sys_random_below(&random, 600),
            (uint16_t)sys_random_below(&random, 6));
    }
    fly(200, 3, 6, 2, 2, 50, 0);
    fly(201, 3, 6, 34, 33, 50, 0);
}

/* Every quality, settled: the whole terrain is drawn, to the last sample and no further. */
static void every_settled_cut_covers_the_ground_exactly(void **state)
{
    (void)state;
    static ff_strips strips;
    terrain_fixture fx;
    fixture_make(&fx, 3, 6, 1, 1, fixture_hills);
    fixture_samples(&fx, 100, 70);
    assert_int_equal(ff_strips_make(&strips, 3), FF_OK);
    ff_ground_frame frame = { .set = 1 };
    for (int32_t c_q8 = 16; c_q8 < 4000; c_q8 += c_q8 / 3) {
        fixture_tree(&fx, 2000, 64);
        ff_view view = fixture_view(980, 690, 300, 225, -20);
        ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
        const ff_drawn *cut;
        int64_t area = 0;
        quality.c_q8 = c_q8;
        fixture_settle(&fx, &view, &quality, 100);
        judge_cut(&fx, &strips);
        uint32_t count = ff_tree_cut(fx.tree, &cut);
        for (uint32_t i = 0; i < count; i++) area += doubled_area(&fx, &strips, &frame, &cut[i]);
        assert_int_equal(area, 2 * 99 * 69);
        fixture_free(&fx);
    }
}

/* ---- the pool and the wishes ---- */

static void padding_is_neither_held_nor_asked_for(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 2, 6, 1, 1, fixture_hills);
    fixture_samples(&fx, 100, 70);
    fixture_tree(&fx, 4000, 64);
    ff_view view = fixture_view(500, 350, 100, 0, -20);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 1 << 20; /* all there is */
    fixture_settle(&fx, &view, &quality, 1000);
    uint32_t nodes = 0;
    for (uint32_t edge = 64; edge >= 4; edge /= 2)
        nodes += (99 + edge - 1) / edge * ((69 + edge - 1) / edge);
    assert_int_equal(fixture_stats(&fx).nodes_held, nodes);
    assert_int_equal(fixture_stats(&fx).pool_full, 0);
    const ff_wish *wish;
    assert_int_equal(ff_tree_wishes(fx.tree, &wish), 0);
    fixture_free(&fx);
    /* a pool of just that size takes them all; one slot less, and something is left out */
    for (uint32_t missing = 0; missing < 2; missing++) {
        fixture_tree(&fx, nodes - missing, 64);
        fixture_settle(&fx, &view, &quality, 1000);
        assert_int_equal(fixture_stats(&fx).nodes_held == nodes, !missing);
        assert_int_equal(fixture_stats(&fx).pool_full, 0);
        assert_int_equal(ff_tree_wishes(fx.tree, &wish), 0);
        fixture_free(&fx);
    }
}

/* ---- heights ---- */

static void check_heights(uint32_t samples_x, uint32_t samples_y)
{
    terrain_fixture fx;
    fixture_make(&fx, 3, 6, 1, 1, fixture_hills);
    fixture_samples(&fx, samples_x, samples_y);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    int32_t last_x = (int32_t)samples_x - 1, last_y = (int32_t)samples_y - 1, z,
            east = last_x * CELL_WU, north = last_y * CELL_WU;
    for (unsigned depth = 1; depth <= 4; depth++) {
        fixture_tree(&fx, 2000, 64);
        quality.depth_max = (uint8_t)depth;
        ff_view view = fixture_view(last_x * 10 - 10, last_y * 10, 300, 225, -20);
        fixture_settle(&fx, &view, &quality, 100);
        for (int32_t along = 0; along <= last_x; along++) {
            assert_int_equal(ff_tree_drawn_height(fx.tree, along * CELL_WU, north, &z), 1);
            assert_int_equal(ff_tree_drawn_height(fx.tree, along * CELL_WU, north + 1, &z), 0);
            assert_int_equal(ff_tree_drawn_height(fx.tree, along * CELL_WU, -1, &z), 0);
        }
        for (int32_t along = 0; along <= last_y; along++) {
            assert_int_equal(ff_tree_drawn_height(fx.tree, east, along * CELL_WU, &z), 1);
            assert_int_equal(ff_tree_drawn_height(fx.tree, east + 1, along * CELL_WU, &z), 0);
            assert_int_equal(ff_tree_drawn_height(fx.tree, -1, along * CELL_WU, &z), 0);
        }
        /* The corner is a sample, however coarse its node; so are those of the rim. */
        assert_int_equal(ff_tree_drawn_height(fx.tree, east, north, &z), 1);
        assert_int_equal(z, ff_height_wu(&fx.info, fixture_hills(samples_x - 1, samples_y - 1)));
        assert_int_equal(ff_tree_drawn_height(fx.tree, east, 64 * CELL_WU, &z), 1);
        assert_int_equal(z, ff_height_wu(&fx.info, fixture_hills(samples_x - 1, 64)));
        fixture_free(&fx);
    }
}

static void heights_end_with_the_ground(void **state)
{
    (void)state;
    check_heights(100, 70);
    check_heights(97, 97); /* in the middle of a root */
    check_heights(81, 73); /* and of its children */
}

/* The judge's triangles, in double precision, and the tree's own answer. */
static void the_judge_finds_the_same_heights(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 8, 8);
    for (unsigned round = 0; round < 30; round++) {
        terrain_fixture fx;
        sim_ground ground = { .hscale_m = 1 };
        const ff_drawn *cut;
        fixture_make(&fx, 3, 5 + round % 2, 1, 1, fixture_hills);
        fixture_samples(&fx, 20 + sys_random_below(&random, 100),
                        20 + sys_random_below(&random, 60));
        fixture_tree(&fx, 900, 64);
        ff_view view = random_view(&random, &fx.info);
        ff_quality quality = random_quality(&random);
        fixture_settle(&fx, &view, &quality, 1 + sys_random_below(&random, 6));
        uint32_t count = ff_tree_cut(fx.tree, &cut), found = 0;
        sim_auditor *auditor = sim_auditor_create(&ground, &fx.info, 8);
        assert_non_null(auditor);
        for (unsigned i = 0; i < 500; i++) {
            int32_t x = between(&random, -300, (int32_t)fx.info.samples_x * CELL_WU),
                    y = between(&random, -300, (int32_t)fx.info.samples_y * CELL_WU), z;
            double z_m;
            int drawn = ff_tree_drawn_height(fx.tree, x, y, &z);
            assert_int_equal(
                sim_audit_drawn_height(auditor, cut, count, x / 256.0, y / 256.0, &z_m), drawn);
            if (drawn && fabs(z_m - z / 256.0) > 0.02)
                fail_msg("round %u, at %d, %d: judge %g, tree %g", round, x, y, z_m, z / 256.0);
            found += (unsigned)drawn;
        }
        assert_true(found > 0);
        sim_auditor_destroy(auditor);
        fixture_free(&fx);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flights_along_the_edge_are_whole),
        cmocka_unit_test(terrains_of_any_size_end_at_their_last_sample),
        cmocka_unit_test(every_settled_cut_covers_the_ground_exactly),
        cmocka_unit_test(padding_is_neither_held_nor_asked_for),
        cmocka_unit_test(heights_end_with_the_ground),
        cmocka_unit_test(the_judge_finds_the_same_heights),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
