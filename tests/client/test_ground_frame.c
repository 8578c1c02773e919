/* All nodes lie in one frame of coordinates, however far away and however large the terrain: their
 * vertices are where the terrain has them, and what nodes share is the same. */
#include "../../client/ground/ff_ground_frame.h"
#include "../../platform/sys.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { NODE_LOG2 = 3, SIDE = (1 << NODE_LOG2) + 1, COUNT = SIDE * SIDE };

/* Tiles of 2^15 samples, two by two. */
static ff_terrain_info terrain(uint32_t spacing_wu)
{
    return (ff_terrain_info){ .node_log2 = NODE_LOG2,
                              .tile_log2 = 15,
                              .tiles_x = 2,
                              .tiles_y = 2,
                              .samples_x = (2 << 15) + 1,
                              .samples_y = (2 << 15) + 1,
                              .spacing_wu = spacing_wu,
                              .hscale_q24 = 1 << 24,
                              .hoffset_wu = -1000,
                              .height_max = 16384 };
}

/* Of a slope that is linear, so that a coarse node has what a fine one has. */
static int32_t height_at(int64_t column, int64_t row) { return (int32_t)((column + row) / 8); }

/* The node of a level at a place in tiles and nodes, placed as the client does it. */
static ff_drawn place(const ff_ground_frame *frame, const ff_terrain_info *info, uint32_t tile,
                      uint32_t level, uint32_t x, uint32_t y, c3d_vertex vertex[COUNT])
{
    ff_drawn drawn = { .key = ff_key_make(tile, level, ff_morton_encode(x, y)) };
    const ff_frame world = { 0 };
    ff_placed placed = ff_shape_put(info, &world, drawn.key);
    ff_shape_place(info, drawn.key, &placed, 0, 0, 32768, drawn.origin_wu);
    drawn.cell_wu = ff_node_cell_wu(info, level);
    for (int i = 0; i < COUNT; i++) {
        int64_t at[2] = { drawn.origin_wu[0] + (int64_t)(i % SIDE) * drawn.cell_wu,
                          drawn.origin_wu[1] + (int64_t)(i / SIDE) * drawn.cell_wu };
        int32_t height = height_at(at[0] / info->spacing_wu, at[1] / info->spacing_wu);
        vertex[i] = (c3d_vertex){ .x = i % SIDE, .y = i / SIDE, .z = height - 32768 };
    }
    ff_ground_frame_vertices(frame, info, &drawn, vertex, COUNT);
    return drawn;
}

static void assert_places(const ff_terrain_info *info, const c3d_camera *camera,
                          const c3d_draw *draw, const ff_drawn *drawn, const c3d_vertex *vertex)
{
    for (int i = 0; i < COUNT; i++) {
        int64_t wanted[2] = { drawn->origin_wu[0] + (int64_t)(i % SIDE) * drawn->cell_wu,
                              drawn->origin_wu[1] + (int64_t)(i / SIDE) * drawn->cell_wu };
        int32_t height = height_at(wanted[0] / info->spacing_wu, wanted[1] / info->spacing_wu);
        int64_t z_wu = draw->origin_wu[2] + (((int64_t)vertex[i].z * draw->z_scale_q16) >> 16);
        assert_true(draw->origin_wu[0] + (int64_t)vertex[i].x * draw->xy_scale_wu +
                        camera->pos_wu[0] ==
                    wanted[0]);
        assert_true(draw->origin_wu[1] + (int64_t)vertex[i].y * draw->xy_scale_wu +
                        camera->pos_wu[1] ==
                    wanted[1]);
        assert_true(z_wu + camera->pos_wu[2] == ff_height_wu(info, (uint32_t)height));
    }
}

/* 40 000 samples away, at the border of two tiles: a node and its coarser neighbour to the west,
 * whose rims meet in every second vertex of the finer. */
static void far_nodes_lie_in_the_same_frame_as_near_ones(void **state)
{
    (void)state;
    const ff_terrain_info info = terrain(77);
    const c3d_camera camera = { .pos_wu = { 60000 * 77 + 5, 60000 * 77, 20000 } };
    ff_ground_frame frame = { .set = 0 };
    c3d_draw draw = { .flags = 0 };
    c3d_vertex fine[COUNT], coarse[COUNT], near[COUNT];
    ff_ground_frame_follow(&frame, &info, 1, &camera);
    ff_ground_frame_draw(&frame, &info, &camera, &draw);
    /* the borders of both lie at sample 20 000 */
    ff_drawn a = place(&frame, &info, 0, 12, 20000 / 8, 20000 / 8, fine),
             b = place(&frame, &info, 0, 11, 20000 / 16 - 1, 20000 / 16, coarse),
             c = place(&frame, &info, 3, 12, (60000 - 32768) / 8, (60000 - 32768) / 8, near);
    assert_places(&info, &camera, &draw, &a, fine);
    assert_places(&info, &camera, &draw, &b, coarse);
    assert_places(&info, &camera, &draw, &c, near);
    assert_int_equal(fine[0].x, -40000);
    for (int row = 0; row < SIDE; row += 2) {
        const c3d_vertex *of_fine = &fine[row * SIDE], *of_coarse = &coarse[row / 2 * SIDE + 8];
        assert_int_equal(of_fine->x, of_coarse->x);
        assert_int_equal(of_fine->y, of_coarse->y);
        assert_int_equal(of_fine->z, of_coarse->z);
    }
}

/* The smallest and the largest spacing there is, the camera anywhere in 32 bits: nothing
 * overflows. */
static void frames_follow_any_camera(void **state)
{
    (void)state;
    static const uint32_t spacings[] = { 1, 77, INT32_MAX >> 16 };
    sys_random random;
    sys_random_seed(&random, 1, 1);
    for (int i = 0; i < 3000; i++) {
        const ff_terrain_info info = terrain(spacings[i % 3]);
        const c3d_camera camera = { .pos_wu = { (int32_t)sys_random_u32(&random),
                                                i % 7 ? (int32_t)sys_random_u32(&random)
                                                      : INT32_MIN } };
        ff_ground_frame frame = { .set = 0 };
        c3d_draw draw = { .flags = 0 };
        c3d_vertex vertex[COUNT];
        assert_int_equal(ff_terrain_check(&info), FF_OK);
        assert_int_equal(ff_ground_frame_follow(&frame, &info, 1, &camera), 1);
        assert_int_equal(ff_ground_frame_follow(&frame, &info, 1, &camera), 0);
        ff_ground_frame_draw(&frame, &info, &camera, &draw);
        uint32_t level = sys_random_below(&random, 13);
        ff_drawn drawn = place(&frame, &info, sys_random_below(&random, 4), level,
                               sys_random_below(&random, 1u << level),
                               sys_random_below(&random, 1u << level), vertex);
        assert_places(&info, &camera, &draw, &drawn, vertex);
    }
}

/* Elevation of a point seen from `eye_m` above a sphere: `away_m` along it, `height_m` above it. */
static double true_elevation(double radius_m, double eye_m, double away_m, double height_m)
{
    double angle = away_m / radius_m;
    return atan2((radius_m + height_m) * cos(angle) - radius_m - eye_m,
                 (radius_m + height_m) * sin(angle));
}

static double metres(int64_t wu) { return (double)wu / FF_WU_PER_METRE; }

/* How far one vertex, drawn from wherever a viewer is within 512 m of the frame's centre, lies from
 * where a sphere has it, in radians; 0 for one further than 100 km away. */
static double off_by(sys_random *random, double radius_m)
{
    ff_terrain_info info = terrain(3 * FF_WU_PER_METRE);
    unsigned level = 12, coarse = sys_random_u32(random) % 2;
    if (coarse) { /* samples of 6 km: the frame's origin is far from its centre */
        info.spacing_wu = 6000 * FF_WU_PER_METRE;
        info.tile_log2 = 9;
        info.samples_x = info.samples_y = (2 << 9) + 1;
        level = 6;
    }
    c3d_camera camera = { .pos_wu = { 98304 * FF_WU_PER_METRE, 98304 * FF_WU_PER_METRE, 0 } };
    if (coarse) camera.pos_wu[0] = camera.pos_wu[1] = (512 * 6000 + 5000) * FF_WU_PER_METRE;
    ff_ground_frame frame = { .set = 0 };
    c3d_draw draw = { .flags = 0 };
    c3d_vertex vertex[COUNT];
    info.curve_q60 = (uint32_t)(ldexp(1, 60) / (2 * radius_m * FF_WU_PER_METRE) + 0.5);
    info.hscale_q24 = 1u << (18 + sys_random_u32(random) % 6); /* ground up to 8 km */
    ff_ground_frame_follow(&frame, &info, 1, &camera);
    for (int axis = 0; axis < 2; axis++)
        camera.pos_wu[axis] += ((int32_t)(sys_random_u32(random) % 1001) - 500) * FF_WU_PER_METRE;
    camera.pos_wu[2] = (int32_t)(sys_random_u32(random) % (12000 * FF_WU_PER_METRE));
    assert_int_equal(ff_ground_frame_follow(&frame, &info, 1, &camera), 0);
    ff_ground_frame_draw(&frame, &info, &camera, &draw);
    uint32_t at = sys_random_u32(random) % (1u << 24);
    place(&frame, &info, sys_random_u32(random) % 4, level, at % (1u << level),
          at / 4096 % (1u << level), vertex);
    const c3d_vertex *one = &vertex[sys_random_u32(random) % COUNT];
    const int64_t flat_wu[2] = { draw.origin_wu[0] + (int64_t)one->x * draw.xy_scale_wu,
                                 draw.origin_wu[1] + (int64_t)one->y * draw.xy_scale_wu };
    double away_m = hypot(metres(flat_wu[0]), metres(flat_wu[1])),
           z_m = metres(draw.origin_wu[2]) + ldexp((double)one->z * draw.z_scale_q16, -24),
           height_m = metres(info.hoffset_wu) +
                      ldexp((double)height_at((flat_wu[0] + camera.pos_wu[0]) / info.spacing_wu,
                                              (flat_wu[1] + camera.pos_wu[1]) / info.spacing_wu) *
                                info.hscale_q24,
                            -24);
    if (away_m > 100000 || away_m < 10) return 0;
    return atan2(z_m, away_m) -
           true_elevation(radius_m, metres(camera.pos_wu[2]), away_m, height_m);
}

/* The Earth as light shows it, refraction 0.13: within a quarter of a pixel of a picture 640 pixels
 * and 60 degrees wide, up to 100 km away. */
static void curved_ground_lies_where_a_sphere_has_it(void **state)
{
    (void)state;
    const double focal_px = 320 / tan(30 * 3.14159265358979 / 180);
    double worst_px = 0;
    sys_random random;
    sys_random_seed(&random, 3, 3);
    for (int i = 0; i < 20000; i++)
        worst_px = fmax(worst_px, fabs(off_by(&random, 6371000 / 0.87)) * focal_px);
    print_message("at most %.3f px off\n", worst_px);
    assert_true(worst_px < 0.25 && worst_px > 0.001);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(far_nodes_lie_in_the_same_frame_as_near_ones),
        cmocka_unit_test(frames_follow_any_camera),
        cmocka_unit_test(curved_ground_lies_where_a_sphere_has_it)
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
