/* Grounds over each other: the finer is drawn where it stands, others are left out there, and where
 * it does not stand they are drawn as if it were not. */
#include "../../client/terrain/ff_tree_local.h"
#include "../rig/grounds_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

/* The same hills, every second sample, and every fourth. */
static uint16_t hills_2(uint32_t x, uint32_t y) { return fixture_hills(2 * x, 2 * y); }
static uint16_t hills_4(uint32_t x, uint32_t y) { return fixture_hills(4 * x, 4 * y); }

enum { COUNTRY, VALLEY, PROVINCE };

/* A country of 20 km, in it a valley of 2.56 km, or of several tiles, and over its border a
 * province that the valley lies half in, whose lattice fits neither. */
static void make(grounds_fixture *g, unsigned valley_log2, unsigned country_log2)
{
    terrain_fixture fx;
    memset(g, 0, sizeof *g);
    fixture_make(&fx, 3, country_log2, 512u >> country_log2, 512u >> country_log2, hills_4);
    fx.info.spacing_wu = 40 * M;
    grounds_add(g, &fx, 0, 0);
    fixture_make(&fx, 3, valley_log2, 256u >> valley_log2, 256u >> valley_log2, fixture_hills);
    fixture_samples(&fx, 250, 244);
    grounds_add(g, &fx, 4000 * M, 5000 * M);
    fixture_make(&fx, 3, 8, 1, 1, hills_2);
    fx.info.spacing_wu = 19 * M + 3;
    grounds_add(g, &fx, 5200 * M + 11, 4100 * M + 7);
}

static int lies_in(const ff_terrain_info *info, int32_t x_wu, int32_t y_wu, int32_t margin_wu)
{
    int64_t size_wu[2], x = (int64_t)x_wu - info->west_wu, y = (int64_t)y_wu - info->south_wu;
    ff_shape_size_wu(info, size_wu);
    return x >= margin_wu && y >= margin_wu && x <= size_wu[0] - margin_wu &&
           y <= size_wu[1] - margin_wu;
}

/* How many nodes of a ground's cut lie over a place. */
static int drawn_over(grounds_fixture *g, uint32_t ground, int32_t x_wu, int32_t y_wu)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_cut(g->tree, &list);
    int over = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!ff_terrain_has_node(&g->ground[ground].info, list[i].key)) continue;
        ff_area area = ff_area_of(g->tree, list[i].key, &list[i].node->placed);
        over += x_wu > area.lo[0] && x_wu < area.hi[0] && y_wu > area.lo[1] && y_wu < area.hi[1];
    }
    return over;
}

typedef struct found {
    uint32_t one, several, none;
} found;

/* At places by chance: each ground is drawn at most once, and something is drawn wherever any held
 * root has ground. */
static found look(grounds_fixture *g, sys_random *random, int places)
{
    found of = { 0 };
    for (int i = 0; i < places; i++) {
        int32_t x_wu = (int32_t)sys_random_below(random, 22000 * M) - 1000 * M,
                y_wu = (int32_t)sys_random_below(random, 22000 * M) - 1000 * M;
        if (i % 2) {
            x_wu = x_wu / 4 + 3500 * M;
            y_wu = y_wu / 4 + 3500 * M;
        }
        uint32_t grounds = 0, roots = 0;
        const int32_t place_wu[3] = { x_wu, y_wu, 0 };
        for (uint32_t k = 0; k < g->count; k++) {
            ff_spot spot;
            int over = drawn_over(g, k, x_wu, y_wu);
            assert_in_range(over, 0, 1);
            grounds += (uint32_t)over;
            roots += ff_shape_locate(&g->ground[k].info, ff_tree_frame(g->tree), place_wu, &spot) &&
                     ff_tree_find(g->tree, ff_key_make(spot.tile, 0, 0)) != FF_SLOT_NONE &&
                     ff_tile_active(g->tree, spot.tile);
        }
        if (roots) assert_true(grounds > 0);
        of.one += grounds == 1;
        of.several += grounds > 1;
        of.none += grounds == 0;
    }
    return of;
}

static ff_view view_of(int step)
{
    static const int32_t place[][5] = {
        { 5100, 6100, 900, 0, -30 },   { 4100, 5300, 700, 90, -20 }, { 9000, 9500, 800, 220, -10 },
        { 7000, 6000, 5000, 45, -60 }, { 3900, 5000, 600, 45, -20 }, { 6000, 7000, 500, 180, -30 }
    };
    const int32_t *at = place[step % 6];
    return fixture_view(at[0], at[1], at[2], at[3], at[4]);
}

static void every_place_is_drawn_by_one_ground_but_for_rims(void **state)
{
    (void)state;
    static const unsigned logs[][2] = { { 8, 9 }, { 6, 9 }, { 8, 7 }, { 6, 6 } };
    sys_random random;
    sys_random_seed(&random, 3, 7);
    for (int i = 0; i < 4; i++) {
        grounds_fixture g;
        make(&g, logs[i][0], logs[i][1]);
        grounds_tree(&g, 6000, 64);
        for (int step = 0; step < 6; step++) {
            ff_view view = view_of(step);
            ff_quality quality = fixture_quality((enum ff_measure)(step & 1));
            grounds_settle(&g, &view, &quality, 300);
            grounds_assert_whole(&g);
            found of = look(&g, &random, 600);
            assert_true(of.several < of.one);
            if (step >= 2) continue;
            /* near enough for small nodes: in the middle of the valley it is drawn alone */
            assert_int_equal(drawn_over(&g, VALLEY, 5000 * M + 1, 6000 * M + 1), 1);
            assert_int_equal(drawn_over(&g, COUNTRY, 5000 * M + 1, 6000 * M + 1), 0);
            assert_int_equal(drawn_over(&g, COUNTRY, 7500 * M + 1, 6500 * M + 1), 0);
            assert_int_equal(drawn_over(&g, PROVINCE, 6000 * M + 1, 6000 * M + 1), 0);
        }
        grounds_free(&g);
    }
}

/* Whatever has come. */
static void no_place_is_left_empty_on_the_way(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 8, 1);
    for (int i = 0; i < 6; i++) {
        grounds_fixture g;
        make(&g, i & 1 ? 6 : 8, i & 2 ? 7 : 9);
        grounds_tree(&g, i < 4 ? 4000 : 150, 32);
        for (int frame = 0; frame < 120; frame++) {
            ff_view view = view_of(frame / 40 + i);
            ff_quality quality = fixture_quality((enum ff_measure)(i & 1));
            const ff_wish *list;
            view.camera.pos_wu[0] += frame % 40 * 30 * M;
            view.centre_wu[0] = view.camera.pos_wu[0];
            ff_tree_select(g.tree, &view, &quality);
            grounds_assert_whole(&g);
            if (frame % 5 == 0) look(&g, &random, 100);
            uint32_t count = ff_tree_wishes(g.tree, &list);
            if (count == 0) continue;
            ff_wish wish = list[sys_random_below(&random, count)];
            fixture_deliver(grounds_of(&g, wish.key), wish.key, wish.kind);
        }
        grounds_free(&g);
    }
}

/* Neither in view nor ahead nor in reserve is there a wish for what a ground before covers. */
static void nothing_is_asked_for_below_a_ground_that_stands(void **state)
{
    (void)state;
    grounds_fixture g;
    uint32_t asked[3] = { 0 };
    make(&g, 8, 9);
    grounds_tree(&g, 6000, 64);
    for (uint32_t k = 0; k < 3; k++)
        fixture_deliver(&g.ground[k], ff_key_make(g.ground[k].info.first_tile, 0, 0), 0);
    for (int frame = 0; frame < 400; frame++) {
        ff_view view = view_of(frame / 70);
        ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
        ff_wish list[96];
        const ff_wish *now;
        ff_tree_select(g.tree, &view, &quality);
        uint32_t count = ff_tree_wishes(g.tree, &now);
        memcpy(list, now, count * sizeof *now);
        const int32_t ahead[3] = { view.camera.pos_wu[0] + 700 * M, view.camera.pos_wu[1],
                                   view.camera.pos_wu[2] };
        count += ff_tree_foresee(g.tree, ahead, 8000, 0, list + count, 16);
        count += ff_tree_reserve(g.tree, list + count, 16);
        for (uint32_t i = 0; i < count; i++) {
            terrain_fixture *fx = grounds_of(&g, list[i].key);
            uint32_t k = (uint32_t)(fx - g.ground);
            ff_placed placed = ff_shape_put(&fx->info, ff_tree_frame(g.tree), list[i].key);
            ff_area area = ff_area_of(g.tree, list[i].key, &placed);
            int32_t deep = 400 * M;
            asked[k]++;
            for (uint32_t f = VALLEY; f <= PROVINCE && k != VALLEY; f++)
                if (f != k && !(f == PROVINCE && k == VALLEY))
                    assert_false(lies_in(&g.ground[f].info, area.lo[0], area.lo[1], deep) &&
                                 lies_in(&g.ground[f].info, area.hi[0], area.hi[1], deep));
        }
        for (uint32_t i = 0; i < 6 && i < count; i++)
            fixture_deliver(grounds_of(&g, list[i].key), list[i].key, list[i].kind);
    }
    for (int k = 0; k < 3; k++) assert_true(asked[k] > 50);
    grounds_free(&g);
}

static uint64_t cut_of(ff_tree *tree, const ff_terrain_info *info)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_cut(tree, &list);
    uint64_t sum = 0;
    for (uint32_t i = 0; i < count; i++)
        if (ff_terrain_has_node(info, list[i].key))
            sum += (list[i].key + list[i].coarser) * UINT64_C(0x9E3779B97F4A7C15) ^
                   list[i].key >> 7;
    return sum;
}

/* Of a ground whose root has not come, or that would show as a speck, nothing is seen in the cut of
 * the others. */
static void a_ground_that_does_not_stand_changes_nothing(void **state)
{
    (void)state;
    for (int far_away = 0; far_away <= 1; far_away++) {
        grounds_fixture g;
        make(&g, 8, 9);
        g.count = 2;
        if (far_away) {
            g.ground[VALLEY].info.west_wu = 200 * M;
            g.ground[VALLEY].info.spacing_wu = M / 4;
            g.ground[VALLEY].info.height_max = 100;
        }
        grounds_tree(&g, 6000, 64);
        terrain_fixture alone = g.ground[COUNTRY];
        alone.decoder = NULL;
        alone.tree_memory = NULL;
        fixture_tree(&alone, 6000, 64);
        ff_view view = fixture_view(6000, 6000, 900, 270, -15);
        ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
        for (int round = 0; round < 300; round++) {
            const ff_wish *list;
            ff_tree_select(g.tree, &view, &quality);
            uint32_t count = ff_tree_wishes(g.tree, &list), at = 0;
            while (at < count && grounds_of(&g, list[at].key) != &g.ground[COUNTRY]) at++;
            if (far_away) assert_true(at == 0);
            if (at == count) break;
            ff_wish wish = list[at];
            fixture_deliver(&g.ground[COUNTRY], wish.key, wish.kind);
        }
        fixture_settle(&alone, &view, &quality, 300);
        assert_true(cut_of(g.tree, &alone.info) == cut_of(alone.tree, &alone.info));
        grounds_free(&g);
        fixture_free(&alone);
    }
}

static uint32_t lowered_in_view(const grounds_fixture *g)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_in_view(g->tree, &list), lowered = 0;
    for (uint32_t i = 0; i < count; i++) lowered += ff_tree_drop(g->tree, &list[i]) != NULL;
    return lowered;
}

/* A coarse node that dived under a fine ground is drawn as it is held once that is out of reach. */
static void nothing_is_lowered_where_one_ground_is_alone(void **state)
{
    (void)state;
    grounds_fixture g;
    terrain_fixture fx;
    memset(&g, 0, sizeof g);
    fixture_make(&fx, 3, 7, 1, 1, fixture_hills);
    fx.info.spacing_wu = 40 * M;
    grounds_add(&g, &fx, 0, 0);
    fixture_make(&fx, 3, 6, 1, 1, fixture_hills);
    grounds_add(&g, &fx, 2500 * M, 2000 * M);
    grounds_tree(&g, 2000, 64);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    quality.error_px_q8 = 1 << 20; /* roots alone */
    ff_view view = fixture_view(2300, 2300, 1500, 90, -60);
    grounds_settle(&g, &view, &quality, 300);
    assert_true(lowered_in_view(&g) > 0);
    quality.view_wu = 150 * M;
    for (int again = 0; again < 3; again++) {
        view.camera.pos_wu[0] -= 10 * M; /* it is not the same selection */
        view.camera.pos_wu[2] = view.centre_wu[2] = 300 * M;
        view.centre_wu[0] = view.camera.pos_wu[0];
        ff_tree_select(g.tree, &view, &quality);
        assert_true(fixture_stats(&g.ground[0]).nodes_drawn > 0);
        assert_int_equal(lowered_in_view(&g), 0);
        assert_int_equal(fixture_stats(&g.ground[0]).seams, 0);
    }
    grounds_free(&g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_place_is_drawn_by_one_ground_but_for_rims),
        cmocka_unit_test(no_place_is_left_empty_on_the_way),
        cmocka_unit_test(nothing_is_asked_for_below_a_ground_that_stands),
        cmocka_unit_test(a_ground_that_does_not_stand_changes_nothing),
        cmocka_unit_test(nothing_is_lowered_where_one_ground_is_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
