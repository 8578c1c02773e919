/* Several true grounds together: which of them counts where, rays from one to another, walls and
 * slits between them; and what the auditor says of pictures that show several. */
#include "../rig/pack_fixture.h"
#include "../rig/scene_fixture.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 3 };

/* Packs joined, and their grounds. */
typedef struct several {
    uint8_t *bytes[MOST];
    ff_pack pack[MOST];
    sim_ground ground[MOST];
    unsigned count;
} several;

typedef struct piece {
    double west_m, south_m;
    unsigned spacing_m, samples; /* each way */
    uint16_t (*height)(void *context, uint32_t x, uint32_t y);
    int (*filled)(void *context, uint32_t x, uint32_t y);
} piece;

static void add(several *s, const piece *of)
{
    size_t bytes;
    unsigned at = s->count++;
    pack_fixture_desc desc = { .info = pack_fixture_info(5, (of->samples + 30) / 32,
                                                         (of->samples + 30) / 32),
                               .height = of->height,
                               .filled = of->filled };
    desc.info.spacing_wu = of->spacing_m * FF_WU_PER_METRE;
    desc.info.samples_x = desc.info.samples_y = of->samples;
    desc.info.epsg = 32632;
    desc.info.origin_x_mm = (int64_t)(of->west_m * 1000) + 500000000;
    desc.info.origin_y_mm = (int64_t)(of->south_m * 1000) + 5000000000;
    s->bytes[at] = pack_fixture_make(&desc, &bytes);
    assert_int_equal(ff_pack_open(&s->pack[at], s->bytes[at], bytes), FF_OK);
    if (at > 0) assert_int_equal(ff_pack_join(&s->pack[0], &s->pack[at]), FF_OK);
    assert_int_equal(sim_ground_load(&s->ground[at], &s->pack[at], UINT64_MAX), FF_OK);
    if (at > 0) sim_ground_join(&s->ground[0], &s->ground[at]);
}

static void several_free(several *s)
{
    for (unsigned i = 0; i < s->count; i++) {
        sim_ground_free(&s->ground[i]);
        free(s->bytes[i]);
    }
}

static uint16_t low(void *context, uint32_t x, uint32_t y)
{
    return (void)context, (void)x, (void)y, 0;
}
static uint16_t high(void *context, uint32_t x, uint32_t y)
{
    return (void)context, (void)x, (void)y, 100;
}
/* Other hills than the usual ones. */
static uint16_t more_hills(void *context, uint32_t x, uint32_t y)
{
    return pack_fixture_hills(context, x + 1000, y + 77);
}
static uint16_t fine_hills(void *context, uint32_t x, uint32_t y)
{
    return (uint16_t)(500 + pack_fixture_hills(context, x / 2, y / 3) / 2);
}
static int all(void *context, uint32_t x, uint32_t y) { return (void)context, (void)x, (void)y, 1; }

/* A country of 2 km; fine ground inset, not on the country's samples; another country, as coarse,
 * that begins over the first one's last 224 m and ends further north. */
static const piece country[MOST] = {
    { 0, 0, 32, 65, pack_fixture_hills, NULL },
    { 500.5, 700.25, 8, 65, fine_hills, all },
    { 1824, 320, 32, 65, more_hills, NULL },
};

static void several_country(several *s)
{
    memset(s, 0, sizeof *s);
    for (unsigned i = 0; i < MOST; i++) add(s, &country[i]);
}

/* The number of the piece that counts at a place, or -1, said once more. */
static int counts_at(double x, double y)
{
    for (int i = 0; i < MOST; i++) {
        int of = i == 0 ? 1 : i == 1 ? 0 : 2;
        double size_m = country[of].spacing_m * (country[of].samples - 1.0);
        x -= country[of].west_m, y -= country[of].south_m;
        if (x >= 0 && y >= 0 && x <= size_m && y <= size_m) return of;
        x += country[of].west_m, y += country[of].south_m;
    }
    return -1;
}

/* Samples of each where it counts, and nothing of the others. */
static void the_finest_that_has_a_place_counts_else_the_first(void **state)
{
    (void)state;
    several s;
    int seen[MOST] = { 0 };
    several_country(&s);
    for (unsigned of = 0; of < MOST; of++)
        for (uint32_t row = 0; row < country[of].samples; row++)
            for (uint32_t column = 0; column < country[of].samples; column++) {
                double x = country[of].west_m + column * country[of].spacing_m,
                       y = country[of].south_m + row * country[of].spacing_m;
                assert_true(sim_ground_has(&s.ground[0], x, y));
                if (counts_at(x, y) != (int)of) {
                    assert_ptr_not_equal(sim_ground_at(&s.ground[0], x, y), &s.ground[of]);
                    continue;
                }
                seen[of]++;
                assert_ptr_equal(sim_ground_at(&s.ground[0], x, y), &s.ground[of]);
                assert_int_equal(sim_ground_filled(&s.ground[0], x, y), of == 1);
                scene_assert_near(sim_ground_height_m(&s.ground[0], x, y),
                                  country[of].height(NULL, column, row));
            }
    assert_int_equal(seen[0], 65 * 65 - 16 * 16); /* 16 by 16 lie under the inset */
    assert_int_equal(seen[1], 65 * 65);
    assert_int_equal(seen[2], 65 * 65 - 8 * 55);
    several_free(&s);
}

/* Where there is none, a height is that of the nearest rim. */
static void outside_of_all_the_nearest_rim_counts(void **state)
{
    (void)state;
    several s;
    several_country(&s);
    const sim_ground *ground = &s.ground[0];
    assert_false(sim_ground_has(ground, 1000, 2048.5));
    assert_false(sim_ground_has(ground, -0.5, 1000));
    assert_false(sim_ground_filled(ground, 1000, 2100));
    scene_assert_near(sim_ground_height_m(ground, 960, 2080), pack_fixture_hills(NULL, 30, 64));
    scene_assert_near(sim_ground_height_m(ground, 1824 + 704, 200), more_hills(NULL, 22, 0));
    scene_assert_near(sim_ground_height_m(ground, 5000, 320 + 640), more_hills(NULL, 64, 20));
    several_free(&s);
}

/* How far a place on a ray is above the ground that counts there. */
static double above_m(const sim_ground *ground, const double from[3], const double along[3],
                      double t)
{
    return from[2] + t * along[2] + sim_ground_drop_m(ground, t * along[0], t * along[1]) -
           sim_ground_height_m(ground, from[0] + t * along[0], from[1] + t * along[1]);
}

/* What is known of a hit: it lies on the ground, or before a wall that it is not over. */
static void check_hit(const sim_ground *ground, const double from[3], const double along[3],
                      double t, int *walls)
{
    double at = above_m(ground, from, along, t);
    if (fabs(at) <= 1e-6) return;
    double length = hypot(along[0], along[1]), step = 1e-6 / length;
    assert_true(above_m(ground, from, along, t - step) >= -1e-3);
    assert_true(above_m(ground, from, along, t + step) < 0);
    assert_ptr_not_equal(
        sim_ground_at(ground, from[0] + (t - step) * along[0], from[1] + (t - step) * along[1]),
        sim_ground_at(ground, from[0] + (t + step) * along[0], from[1] + (t + step) * along[1]));
    ++*walls;
}

/* Small steps along a ray find no ground before its hit, whichever grounds it passes. */
static void rays_over_several_grounds_hit_where_steps_do(void **state)
{
    (void)state;
    several s;
    sys_random random;
    int hits = 0, walls = 0, crossed = 0;
    several_country(&s);
    sys_random_seed(&random, 11, 11);
    for (int i = 0; i < 600; i++) {
        const sim_ground *ground = &s.ground[0];
        s.ground[0].curve_per_m = i % 3 == 0 ? 0 : 8e-7 * (i % 3) * (i % 5 + 1);
        double from[3] = { scene_uniform(&random, 0, 3800), scene_uniform(&random, 0, 2300), 0 },
               along[3], t = 0;
        from[2] = fmax(900, sim_ground_height_m(ground, from[0], from[1])) +
                  scene_uniform(&random, 1, 300);
        along[0] = i % 10 ? scene_uniform(&random, -1, 1) : 0;
        along[1] = i % 11 ? scene_uniform(&random, -1, 1) : 0;
        along[2] = scene_uniform(&random, -0.6, 0.05);
        int hit = sim_ground_cast(ground, from, along, 9000, &t), side = 0;
        const sim_ground *before = NULL;
        for (double u = 0; u < (hit ? t - 1e-6 : 9000); u += 0.7) {
            const sim_ground *here = sim_ground_at(ground, from[0] + u * along[0],
                                                   from[1] + u * along[1]);
            double above = here ? above_m(ground, from, along, u) : 0;
            int from_above = before ? side > 0 : above >= 0;
            if (here && before && here != before && side < 0) from_above = above >= 0;
            crossed += here && before && here != before;
            side = !here ? 0 : from_above ? 1 : -1;
            if (here && side * above < -1e-6)
                fail_msg("ray %d meets ground at %g, not %g", i, u, t);
            before = here;
        }
        hits += hit;
        if (hit) check_hit(ground, from, along, t, &walls);
    }
    assert_in_range(hits, 200, 599);
    assert_in_range(walls, 10, 300);
    assert_in_range(crossed, 100, 2000);
    several_free(&s);
}

static int cast(const several *s, double x, double z, double east, double up, double *t)
{
    const double from[3] = { x, 100, z }, along[3] = { east, 0, up };
    return sim_ground_cast(&s->ground[0], from, along, 5000, t);
}

/* Level ground at 0 m up to x = 512, from there at 100 m. */
static void a_step_between_grounds_is_a_wall_seen_from_below(void **state)
{
    (void)state;
    several s = { .count = 0 };
    const piece west = { 0, 0, 32, 17, low, NULL }, east = { 512, 0, 8, 65, high, NULL };
    double t;
    add(&s, &west);
    add(&s, &east);
    assert_true(cast(&s, 12, 50, 1, 0, &t));
    scene_assert_near(t, 500);
    assert_false(cast(&s, 12, 50, 1, 0.11, &t)); /* over it, and never down */
    assert_true(cast(&s, 12, 160, 1, -0.11, &t));
    scene_assert_near(t, 60 / 0.11);
    assert_true(cast(&s, 552, 120, -1, -0.6, &t));
    scene_assert_near(t, 20 / 0.6);
    assert_true(cast(&s, 552, 120, -1, -0.4, &t)); /* past the edge of the upper one */
    scene_assert_near(t, 120 / 0.4);
    several_free(&s);
}

/* The same with the higher ground 1 m further on: through the slit one sees what is behind. */
static void a_slit_between_grounds_is_no_wall_and_rounding_is_no_slit(void **state)
{
    (void)state;
    for (int rounding = 0; rounding < 2; rounding++) {
        several s = { .count = 0 };
        const piece west = { 0, 0, 32, 17, low, NULL },
                    east = { rounding ? 512.004 : 513, 0, 8, 65, high, NULL };
        double t;
        add(&s, &west);
        add(&s, &east);
        assert_int_equal(cast(&s, 12, 50, 1, 0, &t), rounding);
        assert_int_equal(sim_ground_has(&s.ground[0], 512.5, 100), rounding);
        several_free(&s);
    }
}

/* Within 4 cells of 32 m of the other ground, on both sides of the border; not at other edges. */
static void near_a_border_is_near_ground_of_another_one(void **state)
{
    (void)state;
    several s;
    several_country(&s);
    const sim_ground *ground = &s.ground[0];
    const struct {
        double x, y;
        int near;
    } place[] = { { 500.5 - 127, 900, 1 },
                  { 500.5 - 129, 900, 0 },
                  { 500.5 + 127, 950, 1 },
                  { 500.5 + 256, 956, 0 },
                  { 756, 700.25 - 127, 1 },
                  { 756, 700.25 - 129, 0 },
                  { 10, 1000, 0 },
                  { 1000, 2040, 0 },
                  { 2048 - 127, 1000, 1 },
                  { 2048 + 127, 1000, 1 },
                  { 2048 + 129, 1000, 0 },
                  { 2040, 100, 0 },
                  { 2047, 400, 1 },
                  { 3000, 2360, 0 },
                  { 2048 - 129, 1000, 0 },
                  { 5000, 1000, 0 },
                  { 500.5 - 80, 700.25 - 80, 1 },
                  { 500.5 - 100, 700.25 - 100, 0 } };
    for (size_t i = 0; i < sizeof place / sizeof *place; i++)
        if (sim_ground_near_border(ground, place[i].x, place[i].y, 4) != place[i].near)
            fail_msg("%g, %g is not near: %d", place[i].x, place[i].y, place[i].near);
    sim_ground alone = s.ground[0];
    alone.next = NULL;
    assert_false(sim_ground_near_border(&alone, 500, 900, 4));
    several_free(&s);
}

/* ---- pictures ---- */

/* Two level grounds of 8 km, side by side at x = 0, drawn by a node each; the viewer over the
 * western one, 200 m up, 3 km from the border, looks east. */
typedef struct pair {
    several s;
    sim_auditor *auditor;
    uint16_t height_m[2][SCENE_SIDE * SCENE_SIDE];
    ff_drawn drawn[2];
    ff_terrain_info info[2];
    sim_audit_view view;
    sim_audit_result result;
} pair;

static void pair_make(pair *p)
{
    const piece west = { 0, 0, 256, 33, low, NULL }, east = { 8192, 0, 256, 33, low, NULL };
    memset(p, 0, sizeof *p);
    add(&p->s, &west);
    add(&p->s, &east);
    p->auditor = sim_auditor_create(&p->s.ground[0], &p->s.pack[0].header.info, 2);
    for (unsigned i = 0; i < 2; i++) {
        p->info[i] = p->s.pack[i].header.info;
        p->drawn[i] = (ff_drawn){ .key = ff_key_make(p->info[i].first_tile, 0, 0),
                                  .heights = p->height_m[i],
                                  .cell_wu = 1024 * FF_WU_PER_METRE };
        fixture_origin(&p->info[i], p->drawn[i].key, p->drawn[i].origin_wu);
    }
    p->view = (sim_audit_view){ .camera = { .pos_wu = { 5192 * 256, 4096 * 256, 200 * 256 },
                                            .yaw = 16384,
                                            .width = 120,
                                            .height = 120,
                                            .focal_q8 = 120 * 256 },
                                .quality = { .measure = FF_MEASURE_PIXELS, .error_px_q8 = 256 },
                                .drawn = p->drawn,
                                .drawn_count = 2,
                                .grounds = { .info = p->info, .count = 2 } };
}

static void draw(pair *p, unsigned ground, uint16_t metres)
{
    for (unsigned i = 0; i < SCENE_SIDE * SCENE_SIDE; i++) p->height_m[ground][i] = metres;
}

static void judge(pair *p)
{
    assert_int_equal(sim_audit_frame(p->auditor, &p->view, &p->result), FF_OK);
}

static void pair_free(pair *p)
{
    sim_auditor_destroy(p->auditor);
    several_free(&p->s);
}

/* Rows of the picture at which flat ground so far away is seen. */
static double row_of(double away_m) { return 60 + 120 * 200 / away_m; }

static void shares_and_seams_are_told_by_ground(void **state)
{
    (void)state;
    static pair p;
    pair_make(&p);
    judge(&p);
    double all = 120 - row_of(11192), west = 120 - row_of(3000);
    assert_true(p.result.err_px_max < 1e-6 && p.result.undrawn_pixels == 0);
    assert_true(fabs(p.result.drawn_pixels[0] / (double)p.result.ground_pixels - west / all) <
                0.03);
    assert_int_equal(p.result.drawn_pixels[0] + p.result.drawn_pixels[1], p.result.ground_pixels);
    assert_true(p.result.seam_pixels > 0 && p.result.seam_px_max < 1e-6);
    draw(&p, 1, 20); /* too high by 20 m, 0.8 pixels of them at the border */
    judge(&p);
    assert_true(p.result.err_px_max > 0.7 && p.result.err_px_max < 0.9);
    assert_true(p.result.seam_px_max == p.result.err_px_max && p.result.seam_px_p95 > 0.5);
    draw(&p, 0, 20); /* near the viewer that is more, but not at the border */
    judge(&p);
    assert_true(p.result.err_px_max > 5 && p.result.seam_px_max < 5);
    pair_free(&p);
}

/* Where two grounds are drawn over each other the upper one is seen. */
static void of_grounds_over_each_other_the_upper_is_judged(void **state)
{
    (void)state;
    static pair p;
    pair_make(&p);
    p.drawn[1].origin_wu[0] -= 4096 * FF_WU_PER_METRE;
    draw(&p, 1, 60);
    judge(&p);
    uint32_t upper = p.result.drawn_pixels[1];
    draw(&p, 0, 120);
    judge(&p);
    assert_true(p.result.drawn_pixels[1] < upper / 2);
    assert_true(p.result.err_px_max > 1);
    pair_free(&p);
}

/* The eastern ground is drawn 300 m high, above the viewer: where its true ground is seen the sky
 * shows, below drawn ground. */
static void sky_between_drawn_grounds_is_undrawn(void **state)
{
    (void)state;
    static pair p;
    pair_make(&p);
    draw(&p, 1, 300);
    judge(&p);
    uint32_t seen = p.result.ground_pixels + p.result.undrawn_pixels;
    assert_int_equal(p.result.drawn_pixels[1], 0);
    double share = (row_of(3000) - row_of(11192)) / (120 - row_of(11192));
    assert_true(fabs(p.result.undrawn_pixels / (double)seen - share) < 0.03);
    assert_true(p.result.undrawn_percent > 5);
    pair_free(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_finest_that_has_a_place_counts_else_the_first),
        cmocka_unit_test(outside_of_all_the_nearest_rim_counts),
        cmocka_unit_test(rays_over_several_grounds_hit_where_steps_do),
        cmocka_unit_test(a_step_between_grounds_is_a_wall_seen_from_below),
        cmocka_unit_test(a_slit_between_grounds_is_no_wall_and_rounding_is_no_slit),
        cmocka_unit_test(near_a_border_is_near_ground_of_another_one),
        cmocka_unit_test(shares_and_seams_are_told_by_ground),
        cmocka_unit_test(of_grounds_over_each_other_the_upper_is_judged),
        cmocka_unit_test(sky_between_drawn_grounds_is_undrawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
