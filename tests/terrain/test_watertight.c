/* The drawn ground is whole whatever arrives in whatever order, however the camera jumps: flights
 * over made-up ground with random links, qualities and pools, every frame judged exactly. The judge
 * itself must find faults put in on purpose. */
#include "../../sim/judge/sim_watertight.h"
#include "../rig/slow_watertight.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

/* ---- random flights ---- */

static int32_t between(sys_random *random, int32_t lo, int32_t hi)
{
    return lo + (int32_t)sys_random_below(random, (uint32_t)(hi - lo) + 1);
}

static ff_quality random_quality(sys_random *random)
{
    ff_quality quality = fixture_quality(sys_random_below(random, 2) ? FF_MEASURE_PIXELS
                                                                     : FF_MEASURE_DISTANCE);
    quality.c_q8 = between(random, 128, 12 * 256);
    quality.error_px_q8 = between(random, 32, 20 * 256);
    quality.depth_max = (uint8_t)between(random, 0, 8);
    quality.sigma_q8 = between(random, 256, 600);
    quality.view_wu = between(random, 100, 20000) * FF_WU_PER_METRE;
    return quality;
}

static ff_view random_view(sys_random *random, const ff_terrain_info *info)
{
    int32_t width_m = (int32_t)(info->samples_x * 10), depth_m = (int32_t)(info->samples_y * 10);
    ff_view view = fixture_view(between(random, -500, width_m + 500),
                                between(random, -500, depth_m + 500), between(random, -200, 4000),
                                between(random, 0, 359), between(random, -90, 90));
    view.camera.roll = between(random, -8000, 8000);
    if (sys_random_below(random, 4) == 0)
        view.centre_wu[0] += between(random, -500, 500) * FF_WU_PER_METRE;
    return view;
}

/* A random flight over ground that is made; frees the fixture. */
static void fly(terrain_fixture *fx, uint64_t seed, uint32_t nodes)
{
    sys_random random;
    sys_random_seed(&random, seed, 1);
    fixture_tree(fx, nodes, 40);
    fixture_link link = { .loss_percent = sys_random_below(&random, 40),
                          .per_frame = 1 + sys_random_below(&random, 12) };
    sys_random_seed(&link.random, seed, 2);
    ff_quality quality = random_quality(&random);
    ff_view view = random_view(&random, &fx->info);
    for (unsigned frame = 0; frame < 40; frame++) {
        uint32_t what = sys_random_below(&random, 10);
        if (what == 0)
            view = random_view(&random, &fx->info); /* teleport */
        else if (what == 1)
            quality = random_quality(&random);
        view.camera.pos_wu[0] += 20 * FF_WU_PER_METRE;
        view.centre_wu[0] += 20 * FF_WU_PER_METRE;
        ff_tree_select(fx->tree, &view, &quality);
        fixture_assert_whole(fx);
        fixture_link_step(fx, &link);
    }
    fixture_free(fx);
}

static void fly_randomly(uint64_t seed, unsigned node_log2, unsigned tile_log2, uint32_t tiles_x,
                         uint32_t tiles_y, fixture_height height, uint32_t nodes)
{
    terrain_fixture fx;
    fixture_make(&fx, node_log2, tile_log2, tiles_x, tiles_y, height);
    fly(&fx, seed, nodes);
}

static void random_flights_are_watertight(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 120; seed++)
        fly_randomly(seed, 3, 7, 3, 2, fixture_hills, seed % 3 == 0 ? 60 : 1200);
}

static void random_flights_every_node_size(void **state)
{
    (void)state;
    for (unsigned k = 1; k <= 5; k++) {
        for (uint64_t seed = 0; seed < 8; seed++)
            fly_randomly(1000 + seed, k, 6, 2, 3, fixture_hills, 400);
    }
}

static void random_flights_over_hard_ground(void **state)
{
    (void)state;
    const fixture_height ground[] = { fixture_cliffs, fixture_noise, fixture_flat,
                                      fixture_half_flat };
    for (unsigned i = 0; i < 4; i++) {
        for (uint64_t seed = 0; seed < 10; seed++)
            fly_randomly(2000 + seed, 3, 7, 2, 2, ground[i], 700);
    }
}

static void random_flights_tiny_pools(void **state)
{
    (void)state;
    for (uint32_t nodes = 8; nodes < 40; nodes++)
        fly_randomly(3000 + nodes, 3, 7, 2, 2, fixture_hills, nodes);
}

/* Below leaves the tree makes the ground itself. */
static void ground_below_leaves_is_watertight(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 40; seed++) {
        terrain_fixture fx;
        fixture_make(&fx, 3, 7, 3, 2, fixture_hills);
        fx.leaf_level = seed % 4;
        fly(&fx, 4000 + seed, seed % 3 == 0 ? 60 : 1200);
    }
}

static void lossy_ground_is_watertight(void **state)
{
    (void)state;
    for (unsigned codec = 0; codec < FF_CODEC_COUNT; codec++) {
        terrain_fixture fx;
        fixture_make(&fx, 3, 6, 2, 2, fixture_hills);
        fx.info.max_error = 7;
        fx.info.flags = FF_TERRAIN_LOSSY;
        fx.info.codec = (uint8_t)codec;
        fixture_tree(&fx, 600, 40);
        ff_view view = fixture_view(640, 640, 900, 30, -20);
        ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
        quality.c_q8 = 512;
        for (unsigned round = 0; round < 30; round++) {
            view.camera.pos_wu[0] += 10 * FF_WU_PER_METRE;
            fixture_settle(&fx, &view, &quality, 1);
            fixture_assert_whole(&fx);
        }
        ff_tree_stats stats;
        ff_tree_get_stats(fx.tree, &stats);
        assert_true(stats.stitched > 0);
        fixture_free(&fx);
    }
}

/* ---- the judge ---- */

/* A settled, stitched cut, copied so that it may be spoilt. */
typedef struct spoilt {
    terrain_fixture fx;
    ff_drawn *list;
    uint32_t count;
    uint16_t *heights;
    char why[160];
} spoilt;

static void make_spoilt(spoilt *s)
{
    const ff_drawn *cut;
    fixture_make(&s->fx, 3, 7, 2, 2, fixture_hills);
    fixture_tree(&s->fx, 2000, 60);
    ff_view view = fixture_view(400, 500, 700, 0, -45);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 300;
    fixture_settle(&s->fx, &view, &quality, 100);
    s->count = ff_tree_cut(s->fx.tree, &cut);
    size_t grid = (size_t)ff_node_side(&s->fx.info) * ff_node_side(&s->fx.info);
    s->list = malloc((s->count + 1) * sizeof *s->list);
    s->heights = malloc(s->count * grid * sizeof *s->heights);
    memcpy(s->list, cut, s->count * sizeof *s->list);
    for (uint32_t i = 0; i < s->count; i++) {
        memcpy(s->heights + i * grid, cut[i].heights, grid * sizeof *s->heights);
        s->list[i].heights = s->heights + i * grid;
    }
    assert_true(sim_watertight_check(&s->fx.info, ff_tree_frame(s->fx.tree), s->list, s->count,
                                     s->why, sizeof s->why));
}

static void free_spoilt(spoilt *s)
{
    fixture_free(&s->fx);
    free(s->list);
    free(s->heights);
}

static void assert_found(spoilt *s, const char *what)
{
    assert_false(sim_watertight_check(&s->fx.info, ff_tree_frame(s->fx.tree), s->list, s->count,
                                      s->why, sizeof s->why));
    if (!strstr(s->why, what)) fail_msg("expected \"%s\" in: %s", what, s->why);
    free_spoilt(s);
}

static uint32_t first_stitched(const spoilt *s)
{
    uint32_t i = 0;
    while (i < s->count && s->list[i].coarser == 0) i++;
    assert_true(i < s->count);
    return i;
}

static void judge_finds_missing_stitch(void **state)
{
    (void)state;
    spoilt s;
    make_spoilt(&s);
    s.list[first_stitched(&s)].coarser = 0;
    assert_found(&s, "crack");
}

static void judge_finds_wrong_height(void **state)
{
    (void)state;
    spoilt s;
    make_spoilt(&s);
    s.heights[0] ^= 1; /* a corner, shared with other nodes */
    assert_found(&s, "crack");
}

static void judge_finds_doubled_ground(void **state)
{
    (void)state;
    spoilt s;
    make_spoilt(&s);
    s.list[s.count] = s.list[0];
    s.count++;
    assert_found(&s, "twice");
    make_spoilt(&s);
    uint32_t fine = first_stitched(&s);
    s.list[s.count] = s.list[fine];
    s.list[s.count].key = ff_key_parent(s.list[fine].key);
    fixture_origin(&s.fx.info, s.list[s.count].key, s.list[s.count].origin_wu);
    s.list[s.count].cell_wu *= 2;
    s.count++;
    assert_found(&s, "lies on");
}

static void judge_finds_wrong_place(void **state)
{
    (void)state;
    spoilt s;
    make_spoilt(&s);
    s.list[1].origin_wu[1]++;
    assert_found(&s, "wrong origin");
}

/* A node left out makes no crack, only an end of the view: any part of a whole cut is whole. */
static void the_judge_accepts_parts(void **state)
{
    (void)state;
    spoilt s;
    make_spoilt(&s);
    for (uint32_t part = s.count; part > 0; part--)
        assert_true(sim_watertight_check(&s.fx.info, ff_tree_frame(s.fx.tree), s.list, part, s.why,
                                         sizeof s.why));
    assert_true(sim_watertight_check(&s.fx.info, ff_tree_frame(s.fx.tree), s.list, 0, NULL, 0));
    s.list[0].key = FF_KEY_NONE;
    assert_found(&s, "not of this terrain");
}

/* ---- two judges ---- */

/* Puts in one fault, or what may look like one, at a random place. */
static void spoil(spoilt *s, sys_random *random)
{
    uint32_t i = sys_random_below(random, s->count), side = ff_node_side(&s->fx.info),
             grid = side * side;
    uint32_t rim = sys_random_below(random, side), row = sys_random_below(random, 2) ? 0 : side - 1;
    ff_drawn *drawn = &s->list[i];
    switch (sys_random_below(random, 7)) {
        case 0:
            s->heights[(drawn->heights - s->heights) + sys_random_below(random, grid)] ^= 1;
            break;
        case 1:
            s->heights[(drawn->heights - s->heights) +
                       (sys_random_below(random, 2) ? rim * side + row : row * side + rim)] ^= 4;
            break;
        case 2: drawn->coarser ^= (uint8_t)(1u << sys_random_below(random, 4)); break;
        case 3: /* one node gone */ *drawn = s->list[--s->count]; break;
        case 4: /* many nodes gone: only a part is left */
            while (s->count > 3 && sys_random_below(random, 40))
                s->list[sys_random_below(random, s->count)] = s->list[s->count - 1], s->count--;
            break;
        case 5: /* its parent, or its child, in its place */
            if (ff_key_level(drawn->key) && sys_random_below(random, 2))
                drawn->key = ff_key_parent(drawn->key);
            else if (ff_key_level(drawn->key) <
                     (uint32_t)(s->fx.info.tile_log2 - s->fx.info.node_log2))
                drawn->key = ff_key_child(drawn->key, sys_random_below(random, 4));
            fixture_origin(&s->fx.info, drawn->key, drawn->origin_wu);
            drawn->cell_wu = ff_node_cell_wu(&s->fx.info, ff_key_level(drawn->key));
            break;
        default: drawn->heights = s->list[sys_random_below(random, s->count)].heights; break;
    }
}

/* The quick judge and the slow judge, which looks at every triangle, agree on cuts with up to three
 * faults of any kind. */
static void the_judges_agree(void **state)
{
    (void)state;
    spoilt s, original;
    sys_random random;
    char slow_why[160];
    unsigned whole = 0, broken = 0;
    make_spoilt(&original);
    size_t heights = original.count * (size_t)ff_node_side(&original.fx.info) *
                     ff_node_side(&original.fx.info);
    sys_random_seed(&random, 77, 1);
    s = original;
    s.list = malloc(original.count * sizeof *s.list);
    s.heights = malloc(heights * sizeof *s.heights);
    for (unsigned trial = 0; trial < 3000; trial++) {
        s.count = original.count;
        memcpy(s.list, original.list, s.count * sizeof *s.list);
        memcpy(s.heights, original.heights, heights * sizeof *s.heights);
        for (uint32_t i = 0; i < s.count; i++)
            s.list[i].heights = s.heights + (original.list[i].heights - original.heights);
        for (uint32_t faults = sys_random_below(&random, 4); faults > 0; faults--)
            spoil(&s, &random);
        int quick = sim_watertight_check(&s.fx.info, ff_tree_frame(s.fx.tree), s.list, s.count,
                                         s.why, sizeof s.why);
        int slow = slow_watertight_check(&s.fx.info, s.list, s.count, slow_why, sizeof slow_why);
        if (quick != slow)
            fail_msg("trial %u: quick %d (%s), slow %d (%s)", trial, quick, quick ? "" : s.why,
                     slow, slow ? "" : slow_why);
        whole += (unsigned)quick;
        broken += (unsigned)!quick;
    }
    assert_true(whole > 500 && broken > 500);
    free(s.list);
    free(s.heights);
    free_spoilt(&original);
}

/* Nodes that touch in a corner alone agree on its height. */
static void judge_finds_wrong_corner(void **state)
{
    (void)state;
    spoilt s;
    make_spoilt(&s);
    uint32_t side = ff_node_side(&s.fx.info), pair[2] = { 0, 0 };
    for (uint32_t i = 0; i < s.count && !pair[1]; i++)
        for (uint32_t j = 0; j < s.count; j++)
            if (s.list[j].cell_wu == s.list[i].cell_wu &&
                s.list[j].origin_wu[0] == s.list[i].origin_wu[0] + s.list[i].cell_wu * 8 &&
                s.list[j].origin_wu[1] == s.list[i].origin_wu[1] + s.list[i].cell_wu * 8)
                pair[0] = i, pair[1] = j;
    assert_true(pair[1]);
    ff_drawn two[2] = { s.list[pair[0]], s.list[pair[1]] };
    memcpy(s.list, two, sizeof two);
    s.count = 2;
    assert_true(
        sim_watertight_check(&s.fx.info, ff_tree_frame(s.fx.tree), s.list, s.count, NULL, 0));
    s.heights[(s.list[0].heights - s.heights) + side * side - 1] ^= 1;
    assert_false(slow_watertight_check(&s.fx.info, s.list, s.count, NULL, 0));
    assert_found(&s, "corner");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_flights_are_watertight),
        cmocka_unit_test(random_flights_every_node_size),
        cmocka_unit_test(random_flights_over_hard_ground),
        cmocka_unit_test(random_flights_tiny_pools),
        cmocka_unit_test(ground_below_leaves_is_watertight),
        cmocka_unit_test(lossy_ground_is_watertight),
        cmocka_unit_test(judge_finds_missing_stitch),
        cmocka_unit_test(judge_finds_wrong_height),
        cmocka_unit_test(judge_finds_doubled_ground),
        cmocka_unit_test(judge_finds_wrong_place),
        cmocka_unit_test(the_judge_accepts_parts),
        cmocka_unit_test(judge_finds_wrong_corner),
        cmocka_unit_test(the_judges_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
