/* What is seen: culling judged in double precision, drawing order, vertices, heights of the drawn
 * surface. */
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#define M FF_WU_PER_METRE

/* ---- culling, against a reference in double precision ---- */

static int projects_inside(const c3d_camera *camera, const double point[3])
{
    double turn = 2 * 3.14159265358979323846 / 65536, yaw = camera->yaw * turn,
           pitch = camera->pitch * turn;
    double roll = camera->roll * turn, d[3];
    for (int axis = 0; axis < 3; axis++) d[axis] = point[axis] - camera->pos_wu[axis];
    double forward[3] = { sin(yaw) * cos(pitch), cos(yaw) * cos(pitch), sin(pitch) };
    double level[3] = { cos(yaw), -sin(yaw), 0 };
    double over[3] = { -sin(yaw) * sin(pitch), -cos(yaw) * sin(pitch), cos(pitch) };
    double right = 0, up = 0, depth = 0;
    for (int axis = 0; axis < 3; axis++) {
        right += d[axis] * (level[axis] * cos(roll) - over[axis] * sin(roll));
        up += d[axis] * (level[axis] * sin(roll) + over[axis] * cos(roll));
        depth += d[axis] * forward[axis];
    }
    double focal = camera->focal_q8 / 256.0;
    return depth > 0 && fabs(right) * focal <= depth * camera->width / 2 &&
           fabs(up) * focal <= depth * camera->height / 2;
}

static void assert_nothing_visible_culled(terrain_fixture *fx, const ff_view *view, uint32_t *seen)
{
    const ff_drawn *cut;
    uint32_t drawn = ff_tree_drawn(fx->tree, &cut), count = ff_tree_cut(fx->tree, &cut),
             side = ff_node_side(&fx->info);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t v = 0; v < side * side; v++) {
            double point[3] = { cut[i].origin_wu[0] + (double)(v % side) * cut[i].cell_wu,
                                cut[i].origin_wu[1] + (double)(v / side) * cut[i].cell_wu,
                                ff_height_wu(&fx->info, cut[i].heights[v]) };
            int inside = projects_inside(&view->camera, point);
            *seen += (uint32_t)inside;
            if (inside) assert_true(i < drawn);
        }
    }
}

static void culling_never_drops_what_is_visible(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 600;
    quality.view_wu = INT32_MAX;
    ff_view home = fixture_view(1500, 1000, 300, 0, 0);
    fixture_settle(&fx, &home, &quality, 200);
    sys_random random;
    sys_random_seed(&random, 9, 9);
    uint32_t seen = 0, culled = 0;
    for (unsigned i = 0; i < 600; i++) {
        int32_t z = i % 5 == 0   ? -500
                    : i % 7 == 0 ? 1000 * 1000
                                 : (int32_t)sys_random_below(&random, 3000);
        ff_view view = fixture_view((int32_t)sys_random_below(&random, 6000) - 1000,
                                    (int32_t)sys_random_below(&random, 5000) - 1000, z, 0, 0);
        view.camera.yaw = (int32_t)sys_random_below(&random, 65536);
        view.camera.pitch = i % 7 == 0 ? -16384 : (int32_t)sys_random_below(&random, 32768) - 16384;
        view.camera.roll = (int32_t)sys_random_below(&random, 65536);
        const int32_t tenths[] = { 1, 10, 600, 1200, 1700 };
        /* a steep look at one spot from above it: many node borders at the screen's edge */
        if (i % 3 == 0) view.camera.pitch = -14000;
        view.camera.focal_q8 = c3d_focal_q8((int32_t)((int64_t)tenths[i % 5] * 65536 / 3600), 240);
        ff_tree_select(fx.tree, &view, &quality);
        assert_nothing_visible_culled(&fx, &view, &seen);
        culled += fixture_stats(&fx).nodes_cut - fixture_stats(&fx).nodes_drawn;
    }
    assert_true(seen > 1000 && culled > 1000);
    fixture_free(&fx);
}

static void culling_is_of_use(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view(1920, 1280, 500, 0, 0);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    fixture_settle(&fx, &view, &quality, 200);
    ff_tree_stats stats = fixture_stats(&fx);
    /* 60 degrees of 360, and the nearest */
    assert_true(stats.nodes_drawn * 3 < stats.nodes_cut);
    const ff_drawn *drawn;
    uint32_t count = ff_tree_drawn(fx.tree, &drawn);
    for (uint32_t i = 0; i < count; i++)
        assert_true(drawn[i].origin_wu[1] + 8 * drawn[i].cell_wu >= view.camera.pos_wu[1] - M);
    fixture_free(&fx);
}

/* Nodes of the cut that lie beyond fine_wu of the camera along x or y, and the others. */
static void count_beyond(const terrain_fixture *fx, const ff_view *view, int32_t fine_wu,
                         uint32_t count[2])
{
    const ff_drawn *cut;
    uint32_t nodes = ff_tree_cut(fx->tree, &cut);
    count[0] = count[1] = 0;
    for (uint32_t i = 0; i < nodes; i++) {
        int beyond = 0;
        for (int axis = 0; axis < 2; axis++) {
            int32_t from = cut[i].origin_wu[axis] - view->camera.pos_wu[axis];
            beyond |= from > fine_wu || from + 8 * cut[i].cell_wu < -fine_wu;
        }
        count[beyond]++;
    }
}

static void far_ground_may_be_coarser_and_near_ground_stays_as_it_is(void **state)
{
    (void)state;
    static const enum ff_measure measures[] = { FF_MEASURE_PIXELS, FF_MEASURE_DISTANCE };
    for (int m = 0; m < 2; m++) {
        terrain_fixture fx;
        uint32_t plain[2], coarse[2];
        fixture_usual(&fx, 3000);
        ff_view view = fixture_view(1920, 1280, 300, 0, 0);
        ff_quality quality = fixture_quality(measures[m]);
        quality.c_q8 = 900;
        quality.error_px_q8 = 256;
        quality.view_wu = INT32_MAX;
        fixture_settle(&fx, &view, &quality, 200);
        count_beyond(&fx, &view, 500 * M, plain);
        quality.fine_wu = 500 * M;
        quality.coarse = 1; /* as wrong as others */
        ff_tree_select(fx.tree, &view, &quality);
        count_beyond(&fx, &view, 500 * M, coarse);
        assert_memory_equal(coarse, plain, sizeof plain);
        quality.coarse = 8;
        ff_tree_select(fx.tree, &view, &quality);
        count_beyond(&fx, &view, 500 * M, coarse);
        assert_true(coarse[1] * 3 < plain[1] * 2);
        assert_true(coarse[0] * 10 >=
                    plain[0] * 9); /* but for those whose neighbours are coarser */
        fixture_free(&fx);
    }
}

static void nodes_are_drawn_nearest_first(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view(300, 300, 700, 45, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    fixture_settle(&fx, &view, &quality, 200);
    const ff_drawn *drawn;
    uint32_t count = ff_tree_drawn(fx.tree, &drawn);
    double last = 0;
    for (uint32_t i = 0; i < count; i++) {
        double edge = 8.0 * drawn[i].cell_wu, dx = drawn[i].origin_wu[0] - view.camera.pos_wu[0];
        double dy = drawn[i].origin_wu[1] - view.camera.pos_wu[1];
        dx = dx > 0 ? dx : dx + edge < 0 ? dx + edge : 0;
        dy = dy > 0 ? dy : dy + edge < 0 ? dy + edge : 0;
        double flat_distance = sqrt(dx * dx + dy * dy);
        assert_true(flat_distance > last - 700 * M); /* in order, but for differences in height */
        last = flat_distance > last ? flat_distance : last;
    }
    assert_true(count > 20);
    fixture_free(&fx);
}

/* ---- the drawn surface ---- */

static void vertices_and_height_agree(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_make(&fx, 3, 7, 3, 2, fixture_hills);
    fx.info.hscale_q24 = 12345678;
    fx.info.hoffset_wu = -5000;
    fixture_tree(&fx, 3000, 64);
    ff_view view = fixture_view(1500, 1100, 700, 45, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 300;
    fixture_settle(&fx, &view, &quality, 200);
    assert_true(fixture_stats(&fx).stitched > 0);
    const ff_drawn *cut;
    c3d_vertex vertex[81];
    uint32_t count = ff_tree_cut(fx.tree, &cut);
    for (uint32_t i = 0; i < count; i++) {
        ff_tree_vertices(fx.tree, &cut[i], (int)(i & 1), vertex);
        for (uint32_t v = 0; v < 81; v++) {
            assert_int_equal(vertex[v].x, v % 9);
            assert_int_equal(vertex[v].y, v / 9);
            int32_t x = cut[i].origin_wu[0] + vertex[v].x * cut[i].cell_wu;
            int32_t y = cut[i].origin_wu[1] + vertex[v].y * cut[i].cell_wu, z;
            double drawn = cut[i].origin_wu[2] + vertex[v].z * (fx.info.hscale_q24 / 65536.0);
            assert_true(vertex[v].rgba[3] == 255);
            assert_int_equal(ff_tree_drawn_height(fx.tree, x, y, &z), 1);
            int on_rim = v % 9 == 0 || v % 9 == 8 || v / 9 == 0 || v / 9 == 8;
            if (!on_rim) /* a rim vertex may be left out and lie above the drawn edge */
                assert_true(fabs(z - drawn) <= 2);
        }
    }
    int32_t z;
    assert_int_equal(ff_tree_drawn_height(fx.tree, -1, 5, &z), 0);
    assert_int_equal(ff_tree_drawn_height(fx.tree, 3 * 1280 * M, 2 * 1280 * M, &z), 1);
    assert_int_equal(ff_tree_drawn_height(fx.tree, 3 * 1280 * M + 1, 5, &z), 0);
    fixture_free(&fx);
}

/* Across every border of nodes the surface goes on without a step: the two sides' triangles
 * meet. */
static void height_has_no_steps(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view(1500, 1100, 700, 45, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.c_q8 = 250;
    fixture_settle(&fx, &view, &quality, 200);
    const ff_drawn *cut;
    uint32_t count = ff_tree_cut(fx.tree, &cut), stitched = 0;
    for (uint32_t i = 0; i < count; i++) {
        stitched += cut[i].coarser != 0;
        for (uint32_t step = 1; step < 64; step++) {
            int32_t x = cut[i].origin_wu[0],
                    y = cut[i].origin_wu[1] + (int32_t)step * cut[i].cell_wu / 8, a, b;
            if (x == 0) continue;
            assert_int_equal(ff_tree_drawn_height(fx.tree, x - 1, y, &a), 1);
            assert_int_equal(ff_tree_drawn_height(fx.tree, x, y, &b), 1);
            assert_true(abs(a - b) <= 256 / 8); /* slopes here are below 8 */
        }
    }
    assert_true(stitched > 0);
    fixture_free(&fx);
}

static void nothing_drawn_beyond_view(void **state)
{
    (void)state;
    terrain_fixture fx;
    fixture_usual(&fx, 3000);
    ff_view view = fixture_view_above(&fx, 1920, 1280, 200, 0, -10);
    ff_quality quality = fixture_quality(FF_MEASURE_DISTANCE);
    quality.view_wu = 400 * M;
    quality.c_q8 = 6 * 256;
    fixture_settle(&fx, &view, &quality, 200);
    const ff_drawn *drawn;
    uint32_t count = ff_tree_drawn(fx.tree, &drawn);
    assert_true(count > 5);
    for (uint32_t i = 0; i < count; i++)
        assert_true(drawn[i].origin_wu[1] <= view.centre_wu[1] + 400 * M);
    uint32_t cut = ff_tree_cut(fx.tree, &drawn);
    for (uint32_t i = 0; i < cut; i++) { /* far ground is as coarse as its neighbours allow */
        int far = drawn[i].origin_wu[1] > view.centre_wu[1] + 750 * M;
        assert_true(!far || ff_key_level(drawn[i].key) <= 2);
    }
    fixture_free(&fx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(culling_never_drops_what_is_visible),
        cmocka_unit_test(culling_is_of_use),
        cmocka_unit_test(nothing_drawn_beyond_view),
        cmocka_unit_test(far_ground_may_be_coarser_and_near_ground_stays_as_it_is),
        cmocka_unit_test(nodes_are_drawn_nearest_first),
        cmocka_unit_test(vertices_and_height_agree),
        cmocka_unit_test(height_has_no_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
