/* Several grounds in one tree. */
#include "../rig/grounds_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

/* Samples every 10 m, and hills of 40 m and of 7 m samples, in other steps and depths. */
static void make_three(grounds_fixture *g)
{
    terrain_fixture fx;
    memset(g, 0, sizeof *g);
    fixture_make(&fx, 3, 7, 3, 2, fixture_hills);
    grounds_add(g, &fx, 0, 0);
    fixture_make(&fx, 3, 6, 1, 1, fixture_hills);
    fixture_samples(&fx, 60, 41);
    fx.info.spacing_wu = 40 * M;
    fx.info.hscale_q24 = 5 << 22;
    fx.info.hoffset_wu = -100 * M;
    grounds_add(g, &fx, 4000 * M + 77, -300 * M - 5);
    fixture_make(&fx, 3, 9, 1, 1, fixture_hills);
    fx.info.spacing_wu = 7 * M;
    grounds_add(g, &fx, -3700 * M, 1000 * M);
}

/* Each ground in a tree of its own. */
static void make_alone(const grounds_fixture *g, terrain_fixture alone[3])
{
    for (int i = 0; i < 3; i++) {
        alone[i] = g->ground[i];
        alone[i].decoder = NULL;
        alone[i].tree_memory = NULL;
        fixture_tree(&alone[i], 6000, 64);
    }
}

static ff_view view_of(int step)
{
    static const int32_t place[][4] = { { 1900, 1100, 900, 0 },   { 4100, 300, 700, 90 },
                                        { -200, 1500, 800, 280 }, { 2000, 2000, 5000, 45 },
                                        { 3900, 600, 400, 200 },  { 100, 1300, 1500, 120 } };
    const int32_t *at = place[step % 6];
    return fixture_view(at[0], at[1], at[2], at[3], -25);
}

static const ff_drawn *find(const ff_drawn *list, uint32_t count, ff_key key)
{
    for (uint32_t i = 0; i < count; i++)
        if (list[i].key == key) return &list[i];
    return NULL;
}

/* The nodes of the tree's cut that belong to a ground are those of the ground in a tree of its own,
 * drawn alike. */
static uint32_t expect_alike(grounds_fixture *g, terrain_fixture *alone)
{
    const ff_drawn *all, *own;
    uint32_t count = ff_tree_cut(g->tree, &all), of = ff_tree_cut(alone->tree, &own), found = 0;
    size_t bytes = ff_node_side(&alone->info) * ff_node_side(&alone->info) * sizeof(uint16_t);
    for (uint32_t i = 0; i < count; i++) found += ff_terrain_has_node(&alone->info, all[i].key);
    assert_int_equal(found, of);
    for (uint32_t i = 0; i < of; i++) {
        const ff_drawn *same = find(all, count, own[i].key);
        assert_non_null(same);
        assert_memory_equal(same->heights, own[i].heights, bytes);
        assert_memory_equal(same->origin_wu, own[i].origin_wu, sizeof same->origin_wu);
        assert_int_equal(same->coarser, own[i].coarser);
        assert_int_equal(same->cell_wu, own[i].cell_wu);
    }
    return of;
}

static void grounds_apart_are_drawn_as_each_by_itself(void **state)
{
    (void)state;
    grounds_fixture g;
    terrain_fixture alone[3];
    uint32_t drawn[3] = { 0 };
    make_three(&g);
    grounds_tree(&g, 6000, 64);
    make_alone(&g, alone);
    for (int step = 0; step < 12; step++) {
        ff_view view = view_of(step);
        ff_quality quality = fixture_quality((enum ff_measure)(step / 6));
        grounds_settle(&g, &view, &quality, 200);
        grounds_assert_whole(&g);
        for (int i = 0; i < 3; i++) {
            fixture_settle(&alone[i], &view, &quality, 200);
            drawn[i] += expect_alike(&g, &alone[i]);
        }
    }
    for (int i = 0; i < 3; i++) {
        assert_true(drawn[i] > 100);
        fixture_free(&alone[i]);
    }
    grounds_free(&g);
}

static void expect_same_wishes(const ff_tree *a, const ff_tree *b)
{
    const ff_wish *list_a, *list_b;
    uint32_t count = ff_tree_wishes(a, &list_a);
    assert_int_equal(count, ff_tree_wishes(b, &list_b));
    for (uint32_t i = 0; i < count; i++) {
        assert_int_equal(list_a[i].key, list_b[i].key);
        assert_int_equal(list_a[i].in_view, list_b[i].in_view);
        assert_int_equal(list_a[i].priority, list_b[i].priority);
    }
}

/* Brings the first few things wished for to both trees. */
static void bring(grounds_fixture *g, terrain_fixture *alone, uint32_t few)
{
    const ff_wish *list;
    ff_wish wish[4];
    uint32_t count = ff_tree_wishes(alone->tree, &list);
    count = count < few ? count : few;
    memcpy(wish, list, count * sizeof *wish);
    for (uint32_t i = 0; i < count; i++) {
        fixture_deliver(alone, wish[i].key, wish[i].kind == FF_KIND_REFINEMENT);
        fixture_deliver(grounds_of(g, wish[i].key), wish[i].key,
                        wish[i].kind == FF_KIND_REFINEMENT);
    }
}

static void ground_out_of_reach_changes_nothing(void **state)
{
    (void)state;
    grounds_fixture g;
    terrain_fixture alone[3];
    make_three(&g);
    g.hidden = g.ground[0].hidden;
    grounds_tree(&g, 6000, 64);
    make_alone(&g, alone);
    for (int step = 0; step < 200; step++) {
        /* over all tiles of the first ground, which begins where the third ends; the second begins
         * 160 m beyond it */
        ff_view view = fixture_view(300 + 15 * step, 700 + 5 * step, 900, (uint16_t)(7 * step),
                                    -25);
        ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
        quality.view_wu = 240 * M;
        view.camera.pos_wu[2] = view.centre_wu[2] = 300 * M;
        ff_tree_select(g.tree, &view, &quality);
        ff_tree_select(alone[0].tree, &view, &quality);
        expect_alike(&g, &alone[0]);
        expect_same_wishes(g.tree, alone[0].tree);
        bring(&g, &alone[0], 3);
    }
    for (int i = 0; i < 3; i++) fixture_free(&alone[i]);
    grounds_free(&g);
}

static void the_height_of_drawn_ground_is_that_of_the_ground_there(void **state)
{
    (void)state;
    grounds_fixture g;
    terrain_fixture alone[3];
    uint32_t found[3] = { 0 };
    make_three(&g);
    grounds_tree(&g, 6000, 64);
    ff_view view = view_of(3);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    grounds_settle(&g, &view, &quality, 200);
    make_alone(&g, alone);
    for (int i = 0; i < 3; i++) fixture_settle(&alone[i], &view, &quality, 200);
    for (int32_t x = -4000; x < 7000; x += 130)
        for (int32_t y = -600; y < 5000; y += 130) {
            int32_t all_wu, own_wu, any = 0;
            int is = ff_tree_drawn_height(g.tree, x * M + 3, y * M + 1, &all_wu);
            for (int i = 0; i < 3; i++) {
                if (!ff_tree_drawn_height(alone[i].tree, x * M + 3, y * M + 1, &own_wu)) continue;
                assert_int_equal(all_wu, own_wu);
                found[i]++;
                any = 1;
            }
            assert_int_equal(is, any);
        }
    for (int i = 0; i < 3; i++) {
        assert_true(found[i] > 100);
        fixture_free(&alone[i]);
    }
    grounds_free(&g);
}

/* With a pool too small for all, through a link, every cut of each ground is whole. */
static void grounds_share_a_pool(void **state)
{
    (void)state;
    for (uint32_t nodes = 12; nodes < 1200; nodes *= 3) {
        grounds_fixture g;
        make_three(&g);
        grounds_tree(&g, nodes, 16);
        for (int step = 0; step < 12; step++) {
            ff_view view = view_of(step);
            ff_quality quality = fixture_quality((enum ff_measure)(step & 1));
            quality.triangles_max = step % 3 ? 0 : 3000;
            grounds_settle(&g, &view, &quality, 20);
            grounds_assert_whole(&g);
            ff_wish list[32];
            const int32_t ahead[3] = { view.camera.pos_wu[0] + 2000 * M, view.camera.pos_wu[1],
                                       view.camera.pos_wu[2] };
            uint32_t count = ff_tree_foresee(g.tree, ahead, 9000, 0, list, 32);
            for (uint32_t i = 0; i < count; i++) (void)grounds_of(&g, list[i].key);
            count = ff_tree_reserve(g.tree, list, 32);
            for (uint32_t i = 0; i < count; i++)
                (void)fixture_deliver(grounds_of(&g, list[i].key), list[i].key, list[i].kind);
        }
        grounds_free(&g);
    }
}

static void prefetch_looks_at_all_grounds(void **state)
{
    (void)state;
    grounds_fixture g;
    ff_wish list[64];
    uint32_t of_ground[3] = { 0 };
    make_three(&g);
    grounds_tree(&g, 6000, 64);
    ff_view view = fixture_view(1000, 1000, 600, 0, -20);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    quality.view_wu = 1500 * M;
    grounds_settle(&g, &view, &quality, 200);
    for (int way = -1; way <= 1; way += 2) {
        const int32_t ahead[3] = { (1000 + way * 2500) * M, 1000 * M, 600 * M };
        uint32_t count = ff_tree_foresee(g.tree, ahead, way * 16384, 0, list, 64);
        for (uint32_t i = 0; i < count; i++) of_ground[grounds_of(&g, list[i].key) - g.ground]++;
    }
    assert_true(of_ground[1] > 0 && of_ground[2] > 0);
    grounds_free(&g);
}

static void colours_span_the_heights_of_all_grounds(void **state)
{
    (void)state;
    grounds_fixture g;
    terrain_fixture fx;
    c3d_vertex vertex[2][FF_NODE_HEIGHTS_MAX];
    memset(&g, 0, sizeof g);
    /* the same heights in other steps, and other ranges */
    fixture_make(&fx, 3, 3, 1, 1, fixture_flat);
    fx.info.height_min = 100;
    fx.info.height_max = 140;
    grounds_add(&g, &fx, 0, 0);
    fx.info.hscale_q24 = 1 << 23;
    fx.info.hoffset_wu = 60 * M; /* 120 m again */
    fx.info.height_min = 0;
    fx.info.height_max = 5000;
    grounds_add(&g, &fx, 1000 * M, 0);
    grounds_tree(&g, 64, 16);
    ff_view view = fixture_view(500, -800, 400, 0, -20);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    grounds_settle(&g, &view, &quality, 20);
    const ff_drawn *list;
    assert_int_equal(ff_tree_cut(g.tree, &list), 2);
    for (int i = 0; i < 2; i++) ff_tree_vertices(g.tree, &list[i], 1, vertex[i]);
    assert_memory_equal(vertex[0][40].rgba, vertex[1][40].rgba, 4);
    grounds_free(&g);
}

/* What was found last of two grounds does not stand for a third. */
static void a_ground_that_comes_later_is_found(void **state)
{
    (void)state;
    grounds_fixture g;
    make_three(&g);
    ff_tree_desc desc = {
        .info = g.ground[0].info, .node_count = 2000, .wish_count = 64, .ground_max = 3
    };
    void *memory = malloc(ff_tree_bytes(&desc));
    ff_tree *tree = ff_tree_create(&desc, memory, ff_tree_bytes(&desc));
    for (int i = 1; i < 3; i++) {
        const ff_terrain_info *info = &g.ground[i].info;
        assert_int_equal(ff_tree_add_ground(tree, info), i);
        const ff_terrain_info *found = ff_tree_ground(tree, ff_key_make(info->first_tile, 0, 0));
        assert_int_equal(found->first_tile, info->first_tile);
    }
    free(memory);
}

static void a_tree_takes_only_grounds_that_fit(void **state)
{
    (void)state;
    grounds_fixture g;
    make_three(&g);
    grounds_tree(&g, 64, 16);
    ff_terrain_info info = g.ground[2].info;
    info.first_tile += 1;
    assert_int_equal(ff_tree_add_ground(g.tree, &info), FF_ERR_FULL);
    info.first_tile -= 1;
    assert_int_equal(ff_tree_add_ground(g.tree, &info), FF_ERR_RANGE);
    info.first_tile += 1;
    info.node_log2 = 4;
    assert_int_equal(ff_tree_add_ground(g.tree, &info), FF_ERR_UNSUPPORTED);
    info.hscale_q24 = 0;
    assert_int_equal(ff_tree_add_ground(g.tree, &info), FF_ERR_RANGE);
    ff_tree_desc desc = { .info = info, .node_count = 64, .ground_max = FF_GROUNDS_MAX + 1 };
    assert_int_equal(ff_tree_bytes(&desc), 0);
    grounds_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grounds_apart_are_drawn_as_each_by_itself),
        cmocka_unit_test(ground_out_of_reach_changes_nothing),
        cmocka_unit_test(the_height_of_drawn_ground_is_that_of_the_ground_there),
        cmocka_unit_test(grounds_share_a_pool),
        cmocka_unit_test(prefetch_looks_at_all_grounds),
        cmocka_unit_test(colours_span_the_heights_of_all_grounds),
        cmocka_unit_test(a_ground_that_comes_later_is_found),
        cmocka_unit_test(a_tree_takes_only_grounds_that_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
