/* The true ground in memory: it is the source, ends with it, tells filled from measured ground, and
 * rays meet it where small steps do, over flat ground and ground that falls away. */
#include "../rig/pack_fixture.h"
#include "../rig/scene_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The usual pack, ending with so many samples. */
static void ending_ground(uint8_t **bytes, ff_pack *pack, sim_ground *ground, uint32_t samples_x,
                          uint32_t samples_y, uint64_t samples_max)
{
    size_t count;
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 2), .height = pack_fixture_hills };
    desc.info.samples_x = samples_x;
    desc.info.samples_y = samples_y;
    *bytes = pack_fixture_make(&desc, &count);
    assert_non_null(*bytes);
    assert_int_equal(ff_pack_open(pack, *bytes, count), FF_OK);
    assert_int_equal(sim_ground_load(ground, pack, samples_max), FF_OK);
}

/* The ground in memory is what the encoder was given, sample by sample (the usual pack is
 * lossless). */
static void ground_is_the_source(void **state)
{
    (void)state;
    uint8_t *bytes;
    ff_pack pack;
    sim_ground ground;
    scene_usual_ground(&bytes, &pack, &ground);
    assert_int_equal(ground.columns, 129);
    assert_int_equal(ground.rows, 129);
    for (uint32_t y = 0; y < 129; y++)
        for (uint32_t x = 0; x < 129; x++) {
            assert_int_equal(ground.height[y * 129 + x], pack_fixture_hills(NULL, x, y));
            scene_assert_near(sim_ground_height_m(&ground, x * 32.0, y * 32.0),
                              pack_fixture_hills(NULL, x, y));
        }
    sim_ground_free(&ground);
    assert_int_equal(sim_ground_load(&ground, &pack, 33 * 33), FF_OK); /* a coarser level */
    assert_int_equal(ground.columns, 33);
    assert_int_equal(ground.height[34], pack_fixture_hills(NULL, 4, 4));
    sim_ground_free(&ground);
    free(bytes);
}

static uint16_t no_height(void *context, uint32_t x, uint32_t y)
{
    return (void)context, (void)x, (void)y, 0;
}

/* The judge tells filled ground from measured ground, by nodes, from memory and from a cache, and
 * how much of the picture it is. */
static void filled_ground_is_judged(void **state)
{
    (void)state;
    char path[] = "/tmp/test_auditor_XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    close(fd);
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 2),
                               .height = no_height,
                               .filled = pack_fixture_hole };
    size_t bytes;
    uint8_t *pack_bytes = pack_fixture_make(&desc, &bytes);
    ff_pack pack;
    assert_int_equal(ff_pack_open(&pack, pack_bytes, bytes), FF_OK);
    for (int again = 0; again < 2; again++) {
        sim_ground ground;
        assert_int_equal(sim_ground_load_cached(&ground, &pack, UINT64_MAX, path), FF_OK);
        for (uint32_t y = 0; y < 128; y++)
            for (uint32_t x = 0; x < 128; x++)
                assert_int_equal(sim_ground_filled(&ground, x * 32 + 5, y * 32 + 5),
                                 x >= 32 && x < 56 && y >= 16 && y < 32);
        assert_false(sim_ground_filled(&ground, -1, 20 * 32));
        sim_auditor *auditor = sim_auditor_create(&ground, &pack.header.info, 4);
        sim_audit_result result;
        /* from straight above: 50 by 49 samples of ground, of which 24 by 16 are filled */
        sim_audit_view view = { .camera = { .pos_wu = { 44 * 32 * 256, 24 * 32 * 256, 1600 * 256 },
                                            .pitch = -16384,
                                            .width = 256,
                                            .height = 256,
                                            .focal_q8 = 256 * 256 } };
        assert_int_equal(sim_audit_frame(auditor, &view, &result), FF_OK);
        assert_true(fabs(result.filled_percent - 100.0 * 24 * 16 / (50 * 49)) < 1);
        sim_auditor_destroy(auditor);
        sim_ground_free(&ground);
    }
    unlink(path);
    free(pack_bytes);
}

/* The ground in memory ends where the source does, at every level: where a cell is longer than
 * what is left, the last sample's place has the rim's height. */
static void ground_ends_with_the_source(void **state)
{
    (void)state;
    for (int level = 3; level >= 0; level--) {
        uint8_t *bytes;
        ff_pack pack;
        sim_ground ground;
        ending_ground(&bytes, &pack, &ground, 100, 70, (99 / 8 + 2) * (69 / 8 + 2) << 2 * level);
        double cell = 8 >> level, east = 99 * 32, north = 69 * 32;
        assert_int_equal(ground.level, level);
        assert_int_equal(ground.columns, ceil(99 / cell) + 1);
        assert_int_equal(ground.rows, ceil(69 / cell) + 1);
        scene_assert_near(sim_ground_height_m(&ground, east, north),
                          pack_fixture_hills(NULL, 99, 69));
        scene_assert_near(sim_ground_height_m(&ground, east, 64 * 32),
                          pack_fixture_hills(NULL, 99, 64));
        scene_assert_near(sim_ground_height_m(&ground, 96 * 32, north),
                          pack_fixture_hills(NULL, 96, 69));
        assert_true(sim_ground_has(&ground, east, north) && sim_ground_has(&ground, 0, 0));
        assert_false(sim_ground_has(&ground, east + 0.1, north) ||
                     sim_ground_has(&ground, east, north + 0.1) ||
                     sim_ground_has(&ground, -0.1, 0) || sim_ground_has(&ground, 0, -0.1));
        double t, down[3] = { 0, 0, -1 }, inside[3] = { east - 0.1, north - 0.1, 4000 },
                  outside[3] = { east + 0.1, north - 0.1, 4000 };
        assert_true(sim_ground_cast(&ground, inside, down, 9000, &t));
        assert_false(sim_ground_cast(&ground, outside, down, 9000, &t));
        sim_ground_free(&ground);
        free(bytes);
    }
}

/* Rays in all directions: the hit lies on the ground, and small steps find no ground before it. */
static void check_rays(uint32_t samples_x, uint32_t samples_y, uint64_t samples_max)
{
    uint8_t *bytes;
    ff_pack pack;
    sim_ground ground;
    sys_random random;
    int hits = 0, below = 0;
    double east = (samples_x - 1) * 32, north = (samples_y - 1) * 32;
    ending_ground(&bytes, &pack, &ground, samples_x, samples_y, samples_max);
    sys_random_seed(&random, 5, 5);
    for (int i = 0; i < 400; i++) {
        /* over flat ground, ground that falls away 12 times as steeply as the Earth's or more, and
         * ground that falls away so steeply that a ray may dip into a cell and come out again */
        ground.curve_per_m = i % 2 == 0 ? 0 : i % 4 == 3 ? 3e-4 : 8e-7 * (1 + i % 3);
        double from[3] = { scene_uniform(&random, 0, 4096), scene_uniform(&random, 0, 4096), 0 },
               along[3], t = -1;
        from[2] = fmax(1600, sim_ground_height_m(&ground, from[0], from[1])) +
                  scene_uniform(&random, 0, 200);
        along[0] = i % 10 ? scene_uniform(&random, -1, 1) : 0;
        along[1] = i % 11 ? scene_uniform(&random, -1, 1) : 0;
        along[2] = scene_uniform(&random, -1, 0.05);
        int hit = sim_ground_cast(&ground, from, along, 20000, &t), side = 0;
        hits += hit;
        for (double u = 0; u < (hit ? t - 1e-6 : 20000); u += 0.9) {
            double x = from[0] + u * along[0], y = from[1] + u * along[1],
                   z = from[2] + u * along[2] +
                       sim_ground_drop_m(&ground, u * along[0], u * along[1]);
            if (x < 0 || y < 0 || x > east || y > north) continue;
            double above = z - sim_ground_height_m(&ground, x, y);
            if (!side) side = above < 0 ? -1 : 1; /* it may have come in below the edge */
            if (side * above < -1e-6) fail_msg("ray %d meets ground at %g, before %g", i, u, t);
        }
        below += side < 0;
        if (hit) {
            double x = from[0] + t * along[0], y = from[1] + t * along[1];
            double drop_m = sim_ground_drop_m(&ground, t * along[0], t * along[1]);
            assert_true(x < east + 1e-6 && y < north + 1e-6);
            scene_assert_near(from[2] + t * along[2] + drop_m, sim_ground_height_m(&ground, x, y));
        }
    }
    assert_in_range(hits, 60, 399);
    assert_int_equal(below > 0, samples_x < 129);
    sim_ground_free(&ground);
    free(bytes);
}

static void rays_hit_where_steps_do(void **state)
{
    (void)state;
    check_rays(129, 129, UINT64_MAX);
    check_rays(100, 70, UINT64_MAX);
    check_rays(100, 70, 27 * 19); /* a level whose cells do not end there */
}

/* Over level ground that falls away a ray 10 m up, sinking by 0.065, is at 0 after 250 m and after
 * 400 m: it meets ground at the first, though it is above it where it enters and leaves the cell.
 */
static void a_ray_that_dips_into_a_cell_meets_it(void **state)
{
    (void)state;
    static scene s;
    const double from[3] = { 8192, 8202, 10 }, along[3] = { 1, 0, -0.065 };
    double t;
    scene_flat(&s);
    s.ground.curve_per_m = 1e-4;
    assert_int_equal(sim_ground_cast(&s.ground, from, along, 9000, &t), 1);
    scene_assert_near(t, 250);
    scene_free(&s);
}

/* Ground may be judged by another pack's when that has the same samples in the same place. */
static void truth_is_of_the_same_grid(void **state)
{
    (void)state;
    ff_terrain_info info = pack_fixture_info(3, 4, 4), other = info;
    assert_null(sim_ground_differs(&info, &other));
    other.tile_log2 = 5;
    other.tiles_x = other.tiles_y = 1;
    other.max_error = 4;
    other.hscale_q24 *= 2;
    assert_null(sim_ground_differs(&info, &other));
    other.samples_y--;
    assert_string_equal(sim_ground_differs(&info, &other), "it has another number of samples");
    other = info;
    other.spacing_wu++;
    assert_string_equal(sim_ground_differs(&info, &other), "its samples lie otherwise apart");
    other = info;
    other.origin_y_mm += 1000;
    assert_string_equal(sim_ground_differs(&info, &other), "it lies elsewhere");
    other = info;
    other.epsg++;
    assert_string_equal(sim_ground_differs(&info, &other), "it lies elsewhere");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_is_the_source),
        cmocka_unit_test(filled_ground_is_judged),
        cmocka_unit_test(ground_ends_with_the_source),
        cmocka_unit_test(rays_hit_where_steps_do),
        cmocka_unit_test(a_ray_that_dips_into_a_cell_meets_it),
        cmocka_unit_test(truth_is_of_the_same_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
