/* The integer core against the double-precision reference over random views of ordinary scenes, all
 * from one seed. VIEWS views (default 1,000,000) for each part; where a part looks at a share of
 * them, it says how many. */
#include "../../client/panorama/ff_panorama_rules.h"
#include "../../client/ground/ff_ground_frame.h"
#include "../../client/terrain/ff_strips.h"
#include "../../client/terrain/ff_tree_local.h"
#include "../../common3d/c3d_backend.h"
#include "../../common3d/gl/c3d_gl_local.h"
#include "../../common3d/soft/soft_local.h"
#include "reference.h"
#include "reference_views.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define M          FF_WU_PER_METRE
#define QUARTER_PX 0.25
/* Nearer ground may be more than 1/4 px off where a pixel is as narrow as here (20 degrees over 640
 * px): GL's single precision costs up to half a millimetre, the integer back end's units cost one
 * and a half where the far plane is 100 km away. */
#define NEAR_M    8
#define HEIGHTS_M 9000 /* between the lowest and the highest of ordinary terrains, at most */

/* ---- projection ---- */

static int project_q14(const c3d_camera *camera, const int64_t offset_wu[3], double px[2])
{
    c3d_rotation rotation;
    int64_t eye[3];
    c3d_rotation_from_camera(camera, &rotation);
    c3d_to_eye_q14(&rotation, offset_wu, eye);
    if (eye[2] <= 0) return 0;
    px[0] = camera->width / 2.0 + (double)eye[0] * (camera->focal_q8 / 256.0) / (double)eye[2];
    px[1] = camera->height / 2.0 - (double)eye[1] * (camera->focal_q8 / 256.0) / (double)eye[2];
    return 1;
}

static void projection_of_the_eye_path(void **state)
{
    (void)state;
    double worst = 0;
    sys_random random;
    sys_random_seed(&random, 1, 61);
    uint32_t compared = 0;
    for (uint32_t i = ref_views(1); i > 0; i--) {
        c3d_camera camera = ref_ordinary_camera(&random);
        ref_camera ref;
        double point[3], expected[2], got[2] = { 0 };
        int64_t offset[3];
        ref_camera_of(&camera, &ref);
        ref_point_in_view(&random, &ref, point);
        /* rounding to wu moved the point out of the picture */
        if (!ref_project(&ref, point, expected) || !ref_in_window(&ref, expected, 100)) continue;
        for (int axis = 0; axis < 3; axis++)
            offset[axis] = (int64_t)point[axis] - camera.pos_wu[axis];
        assert_true(project_q14(&camera, offset, got));
        worst = fmax(worst, ref_apart(expected, got));
        compared++;
    }
    print_message("# projection, eye space Q14: %u views, worst %.6f px\n", compared, worst);
    assert_true(compared > ref_views(2));
    assert_true(worst <= QUARTER_PX);
}

/* Ground as the client draws it: samples of an ordinary terrain, counted from the frame that
 * follows the camera. */
typedef struct ground_view {
    c3d_camera camera;
    ref_camera ref;
    c3d_draw draw;
    int32_t vertex[3]; /* a sample that shows in the window or a little beyond */
} ground_view;

/* Makes a terrain under the camera and takes the sample nearest to a random point in view; 0 when
 * there is none. The camera moves to a fitting height, and as far as the sample lies from the
 * point. */
static int try_ordinary_ground(sys_random *random, const c3d_camera *camera, ground_view *view)
{
    ff_terrain_info info = { .node_log2 = 3,
                             .tile_log2 = 10,
                             .tiles_x = 256,
                             .tiles_y = 256,
                             .samples_x = (256 << 10) + 1,
                             .samples_y = (256 << 10) + 1,
                             .spacing_wu = (uint32_t)ref_between(random, 1, 30) * M,
                             .hscale_q24 = (uint32_t)ref_between(random, 1 << 20, 1 << 24),
                             .hoffset_wu = ref_between(random, -400, 3000) * M };
    int64_t most = (int64_t)HEIGHTS_M * M * 65536 / info.hscale_q24;
    info.height_max = (uint16_t)ref_between(random, 1000, most < 60000 ? (int32_t)most : 60000);
    const double unit_wu[3] = { info.spacing_wu, info.spacing_wu, info.hscale_q24 / 65536.0 };
    view->camera = *camera;
    for (int axis = 0; axis < 2; axis++)
        view->camera.pos_wu[axis] = ref_between(random, 0, 256 * ff_node_edge_wu(&info, 0));
    view->camera.pos_wu[2] = ref_between(random, info.hoffset_wu,
                                         info.hoffset_wu + (int32_t)(info.height_max * unit_wu[2]) +
                                             500 * M);
    c3d_camera earlier = view->camera; /* the frame still follows this camera */
    for (int axis = 0; axis < 2; axis++)
        earlier.pos_wu[axis] += ref_between(random, -500 * M, 500 * M);
    ff_ground_frame frame = { .set = 0 };
    ff_ground_frame_follow(&frame, &info, 1, &earlier);
    double point[3];
    ref_camera_of(&view->camera, &view->ref);
    ref_point_in_view(random, &view->ref, point);
    view->draw = (c3d_draw){ .flags = C3D_DRAW_COLOURED };
    ff_ground_frame_draw(&frame, &info, &view->camera, &view->draw);
    for (int axis = 0; axis < 3; axis++) {
        double from_wu = (double)view->draw.origin_wu[axis] + view->ref.pos_wu[axis],
               at = floor((point[axis] - from_wu) / unit_wu[axis] + 0.5);
        if (axis == 2 && fabs(at) > info.height_max / 2) return 0;
        view->vertex[axis] = (int32_t)at;
        view->camera.pos_wu[axis] += (int32_t)floor(from_wu + at * unit_wu[axis] - point[axis] +
                                                    0.5);
    }
    ff_ground_frame_draw(&frame, &info, &view->camera, &view->draw);
    ref_camera_of(&view->camera, &view->ref);
    return 1;
}

static void ordinary_ground(sys_random *random, const c3d_camera *camera, ground_view *view)
{
    while (!try_ordinary_ground(random, camera, view))
        ;
}

/* Largest distance to the true pixel by depth: nearer than 1 m, 2 m, 4 m ..., and beyond. */
typedef struct by_depth {
    double worst[8];
    uint32_t compared;
} by_depth;

/* Judges one vertex: the back end shows vertex `at` of the draw at px. */
static void compare_vertex(const ground_view *view, const int32_t at[3], const double px[2],
                           by_depth *result)
{
    const double unit[3] = { view->draw.xy_scale_wu, view->draw.xy_scale_wu,
                             view->draw.z_scale_q16 / 65536.0 };
    double way[3], eye[3], expected[2];
    for (int axis = 0; axis < 3; axis++)
        way[axis] = (double)view->draw.origin_wu[axis] + at[axis] * unit[axis];
    ref_to_eye(&view->ref, way, eye);
    if (!ref_project_direction(&view->ref, way, expected) ||
        !ref_in_window(&view->ref, expected, 0))
        return;
    int bin = 0;
    while (bin < 7 && eye[2] >= M << bin) bin++;
    result->worst[bin] = fmax(result->worst[bin], ref_apart(expected, px));
    result->compared++;
}

static void assert_near_enough(const by_depth *result, const char *who, uint32_t least)
{
    print_message(
        "# projection, %s: %u vertices; worst px nearer than 1 m %.2f, 2 m %.2f, 4 m %.2f, 8 m %.2f, 16 m %.2f, 32 m %.2f, 64 m %.2f, "
        "beyond %.2f\n",
        who, result->compared, result->worst[0], result->worst[1], result->worst[2],
        result->worst[3], result->worst[4], result->worst[5], result->worst[6], result->worst[7]);
    assert_true(result->compared > least);
    for (int bin = 0; bin < 8; bin++)
        if (M << bin > NEAR_M * M) assert_true(result->worst[bin] <= QUARTER_PX);
}

/* The GL back ends: matrices of single precision, a vertex through both of them. */
static int project_by_matrices(const c3d_camera *camera, const c3d_draw *draw,
                               const int32_t vertex[3], double px[2])
{
    c3d_rotation rotation;
    c3d_resolved_draw resolved = { .draw = draw };
    float modelview[16], projection[16], eye[4], clip[4];
    const float at[4] = { (float)vertex[0], (float)vertex[1], (float)vertex[2], 1 };
    c3d_rotation_from_camera(camera, &rotation);
    c3d_to_eye_q14(&rotation, draw->origin_wu, resolved.eye_q14);
    c3d_gl_modelview(modelview, &resolved, &rotation);
    c3d_gl_projection(projection, camera);
    for (int row = 0; row < 4; row++) {
        eye[row] = 0;
        for (int column = 0; column < 4; column++)
            eye[row] += modelview[column * 4 + row] * at[column];
    }
    for (int row = 0; row < 4; row++) {
        clip[row] = 0;
        for (int column = 0; column < 4; column++)
            clip[row] += projection[column * 4 + row] * eye[column];
    }
    if (clip[3] < 0.25f) return 0;
    px[0] = camera->width * (0.5 + 0.5 * (double)(clip[0] / clip[3]));
    px[1] = camera->height * (0.5 - 0.5 * (double)(clip[1] / clip[3]));
    return 1;
}

static void projection_of_vertices_by_gl(void **state)
{
    (void)state;
    by_depth result = { .compared = 0 };
    sys_random random;
    sys_random_seed(&random, 2, 61);
    for (uint32_t i = ref_views(1); i > 0; i--) {
        ground_view view;
        double px[2];
        c3d_camera camera = ref_ordinary_camera(&random);
        ordinary_ground(&random, &camera, &view);
        if (project_by_matrices(&view.camera, &view.draw, view.vertex, px))
            compare_vertex(&view, view.vertex, px, &result);
    }
    assert_near_enough(&result, "GL's matrices in single precision", ref_views(2));
}

static void widen(c3d_mesh_data *mesh, int axis, int32_t at, int first)
{
    mesh->reach[axis] = (uint32_t)fmax(mesh->reach[axis], abs(at));
    if (first || at < mesh->least[axis]) mesh->least[axis] = at;
    if (first || at > mesh->most[axis]) mesh->most[axis] = at;
}

/* The integer back end: every vertex of the mesh round the sample that it puts on the screen, in
 * sixteenths of a pixel. */
static void compare_soft(soft_state *state, sys_random *random, const ground_view *view,
                         by_depth *result)
{
    static c3d_vertex vertex[9];
    c3d_mesh_data mesh = { .vertices = vertex, .count = 9 };
    c3d_resolved_draw resolved = { .draw = &view->draw, .mesh = &mesh };
    for (int i = 0; i < 9; i++) {
        const int32_t at[3] = { view->vertex[0] + (i % 3) - 1, view->vertex[1] + i / 3 - 1,
                                view->vertex[2] + (i == 4 ? 0 : ref_between(random, -20, 20)) };
        vertex[i] = (c3d_vertex){ .x = at[0], .y = at[1], .z = at[2] };
        for (int axis = 0; axis < 3; axis++) widen(&mesh, axis, at[axis], i == 0);
    }
    state->cached_mesh = NULL;
    soft_transform(state, &resolved);
    for (int i = 0; i < 9; i++) {
        const soft_vertex *got = &state->vertices[i];
        const double px[2] = { got->x / (double)SOFT_ONE, got->y / (double)SOFT_ONE };
        const int32_t at[3] = { vertex[i].x, vertex[i].y, vertex[i].z };
        if (!(got->out & SOFT_MUST_CLIP)) compare_vertex(view, at, px, result);
    }
}

static void projection_of_vertices_by_soft(void **state)
{
    (void)state;
    c3d_desc desc = { .mesh_count = 1,
                      .strip_count = 1,
                      .texture_count = 1,
                      .mesh_vertices_max = 81,
                      .strip_indices_max = 64,
                      .width = 640,
                      .height = 480 };
    int buffers = 0;
    by_depth result = { .compared = 0 };
    sys_random random;
    sys_random_seed(&random, 11, 61);
    soft_state *soft = calloc(1, c3d_backend_soft()->state_bytes(&desc));
    assert_int_equal(c3d_backend_soft()->open(soft, &desc, &buffers), FF_OK);
    for (uint32_t i = ref_views(10); i > 0; i--) { /* to begin a frame takes longer than all else */
        c3d_frame frame = { .camera = ref_ordinary_camera(&random) };
        c3d_rotation rotation;
        c3d_rotation_from_camera(&frame.camera, &rotation);
        c3d_backend_soft()->begin(soft, &frame, &rotation);
        for (int k = 0; k < 10; k++) {
            ground_view view;
            ordinary_ground(&random, &frame.camera, &view);
            compare_soft(soft, &random, &view, &result);
        }
    }
    free(soft);
    assert_near_enough(&result, "the integer back end", ref_views(1));
}

/* ---- culling ---- */

static ff_box random_box(sys_random *random, const ref_camera *ref)
{
    ff_box box;
    double point[3];
    ref_point_in_view(random, ref, point);
    for (int axis = 0; axis < 3; axis++) {
        int64_t size = 1 +
                       (int64_t)sys_random_below(random, 1u << (4 + sys_random_below(random, 20)));
        /* the box lies beside, over or beyond the point */
        int64_t shift = (int64_t)sys_random_below(random, 3) * size - size;
        box.lo[axis] = (int64_t)(point[axis] - ref->pos_wu[axis]) - size / 2 + shift;
        box.hi[axis] = box.lo[axis] + size;
    }
    return box;
}

/* 1 when one of the box's corners, or of some points inside it, is seen. */
static int box_seen(sys_random *random, const ref_camera *ref, const ff_box *box)
{
    for (unsigned i = 0; i < 12; i++) {
        double direction[3], px[2];
        for (int axis = 0; axis < 3; axis++) {
            int64_t size = box->hi[axis] - box->lo[axis];
            int64_t part = i < 8 ? (i >> axis & 1u) * size
                                 : (int64_t)sys_random_below(random, (uint32_t)size + 1);
            direction[axis] = (double)(box->lo[axis] + part);
        }
        if (ref_project_direction(ref, direction, px) && ref_in_window(ref, px, 0)) return 1;
    }
    return 0;
}

static void culling_drops_nothing_seen(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 3, 61);
    static struct ff_tree tree;
    uint32_t seen = 0, dropped = 0, all = ref_views(1);
    for (uint32_t i = 0; i < all; i++) {
        ref_camera ref;
        tree.view.camera = ref_ordinary_camera(&random);
        ref_camera_of(&tree.view.camera, &ref);
        ff_pyramid_make(&tree);
        ff_box box = random_box(&random, &ref);
        int drawn = ff_box_in_view(&tree, &box);
        dropped += !drawn;
        if (drawn && i % 8)
            /* only a culled box can be wrong; the test below looks at an eighth of the others to
             * keep the count honest */
            continue;
        int visible = box_seen(&random, &ref, &box);
        seen += (uint32_t)visible;
        assert_true(drawn || !visible);
    }
    print_message("# culling: %u views, %u boxes dropped, none of them seen\n", all, dropped);
    assert_true(seen > all / 50 && dropped > all / 50);
}

/* ---- node choice ---- */

static void random_node(sys_random *random, struct ff_tree *tree, ff_node *node)
{
    static ff_terrain_info ground;
    tree->view.camera = ref_ordinary_camera(random);
    ground = (ff_terrain_info){ .node_log2 = 3,
                                .tile_log2 = 10,
                                .tiles_x = 64, /* the node lies well inside */
                                .tiles_y = 64,
                                .samples_x = (64 << 10) + 1,
                                .samples_y = (64 << 10) + 1,
                                .spacing_wu = 10 * M,
                                .hscale_q24 = (uint32_t)ref_between(random, 1 << 20, 1 << 25),
                                .hoffset_wu = ref_between(random, -500 * M, 500 * M) };
    tree->view.camera.pos_wu[0] = ref_between(random, 0, 163840 * M);
    tree->view.camera.pos_wu[1] = ref_between(random, 0, 163840 * M);
    tree->ground = &ground;
    node->key = ff_key_make(0, sys_random_below(random, 8), 0);
    int32_t reach = 8 * ff_node_edge_wu(&ground, ff_key_level(node->key)); /* for the threshold */
    node->placed.planar.x_wu = tree->view.camera.pos_wu[0] + ref_between(random, -reach, reach);
    node->placed.planar.y_wu = tree->view.camera.pos_wu[1] + ref_between(random, -reach, reach);
    node->height_min = (uint16_t)ref_between(random, 0, 3000);
    node->height_max = (uint16_t)ref_between(random, node->height_min, 4000);
    node->height_mean = (uint16_t)ref_between(random, node->height_min, node->height_max);
    node->error_code = (uint8_t)ref_between(random, 1, 120);
}

/* 1 when f is 1 within the rounding of d to a wu and of 1/f to 2^-16: inside this band either
 * choice is right. */
static void node_choice_by_distance(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 4, 61);
    static struct ff_tree tree;
    ff_node node = { 0 };
    uint32_t split = 0, in_band = 0, all = ref_views(1);
    for (uint32_t i = 0; i < all; i++) {
        ref_camera ref;
        random_node(&random, &tree, &node);
        tree.quality = (ff_quality){ .measure = FF_MEASURE_DISTANCE,
                                     .c_q8 = ref_between(&random, 128, 12 * 256) };
        ref_camera_of(&tree.view.camera, &ref);
        double edge = ff_node_edge_wu(tree.ground, ff_key_level(node.key));
        double middle[3] = { node.placed.planar.x_wu + edge / 2, node.placed.planar.y_wu + edge / 2,
                             tree.ground->hoffset_wu +
                                 node.height_mean * (tree.ground->hscale_q24 / 65536.0) };
        double c = tree.quality.c_q8 / 256.0, f = ref_node_f(&ref, middle, edge, c);
        double band = 1.0 / 32768 + 3 / (edge * c);
        int wants = ff_value_of_split(&tree, &node) > FF_VALUE_ONE;
        split += (uint32_t)wants;
        if (fabs(f - 1) <= band)
            in_band++;
        else
            assert_int_equal(wants, f < 1);
    }
    print_message("# node choice by f: %u nodes, %u split, %u within 2^-15 + 3 wu/(e C) of 1\n",
                  all, split, in_band);
    assert_true(split > all / 20 && split < all - all / 20 && in_band * 200 < all);
}

static void node_choice_by_pixels(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 5, 61);
    static struct ff_tree tree;
    ff_node node = { 0 };
    uint32_t split = 0, in_band = 0, all = ref_views(1);
    for (uint32_t i = 0; i < all; i++) {
        ref_camera ref;
        random_node(&random, &tree, &node);
        tree.quality = (ff_quality){ .measure = FF_MEASURE_PIXELS,
                                     .error_px_q8 = ref_between(&random, 64, 8 * 256) };
        ref_camera_of(&tree.view.camera, &ref);
        double edge = ff_node_edge_wu(tree.ground, ff_key_level(node.key)),
               step = tree.ground->hscale_q24 / 65536.0;
        double error = ff_geometric_error_decode(node.error_code) * step;
        double low[3] = { node.placed.planar.x_wu, node.placed.planar.y_wu,
                          tree.ground->hoffset_wu + node.height_min * step - error };
        double high[3] = { node.placed.planar.x_wu + edge, node.placed.planar.y_wu + edge,
                           tree.ground->hoffset_wu + node.height_max * step + error };
        double px = ref_error_px(&ref, low, high, error),
               allowed = tree.quality.error_px_q8 / 256.0;
        int wants = ff_value_of_split(&tree, &node) > FF_VALUE_ONE;
        /* 1/256 px of rounding, the error to a wu, the distance to three of them */
        double distance = error * (tree.view.camera.focal_q8 / 256.0) / px;
        double band = 1.0 / 128 + px * (1 / error + 3 / fmax(1, distance));
        split += (uint32_t)wants;
        if (isinf(px))
            assert_int_equal(wants, 1);
        else if (fabs(px - allowed) <= band)
            in_band++;
        else
            assert_int_equal(wants, px > allowed);
    }
    print_message("# node choice by pixels: %u nodes, %u split, %u within the band of rounding\n",
                  all, split, in_band);
    assert_true(split > all / 20 && split < all - all / 20 && in_band * 20 < all);
}

/* ---- panorama ---- */

static void limits_of_motion(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 6, 61);
    for (uint32_t i = ref_views(1); i > 0; i--) {
        int32_t error_q8 = ref_between(&random, 1, 64 * 256),
                z = ref_between(&random, 100 * M, 100000 * M);
        int32_t focal_q8 = ref_between(&random, 60 * 256, 4000 * 256),
                half_q8 = ref_between(&random, 1, 2048) * 256;
        double sideways = ref_sideways_max(error_q8, z, focal_q8),
               forwards = ref_forwards_max(error_q8, z, half_q8);
        double off = sideways - (double)ff_panorama_sideways_max(error_q8, z, focal_q8);
        assert_true(off > -1e-3 && off < 1.001); /* rounded down to a wu */
        off = forwards - (double)ff_panorama_forwards_max(error_q8, z, half_q8);
        assert_true(off > -1e-3 && off < 1.001);
    }
}

/* ---- heights ---- */

static void interpolation_of_the_codec(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 8, 61);
    double worst = 0;
    uint32_t samples = 0;
    for (uint32_t i = ref_views(200); i > 0; i--) {
        ff_terrain_info info = { .node_log2 = (uint8_t)ref_between(&random, 2, 5),
                                 .tile_log2 = 8,
                                 .codec = FF_CODEC_RAW };
        uint32_t cells = 1u << info.node_log2, side = cells + 1, wide = 2 * cells + 1;
        static uint16_t parent[FF_NODE_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX];
        static int32_t zero[FF_REFINED_HEIGHTS_MAX];
        ff_residuals none = { .count = (uint16_t)(wide * wide - side * side), .value = zero };
        uint32_t range = 1u << ref_between(&random, 4, 16),
                 base = sys_random_below(&random, 65536 - range + 1);
        for (uint32_t v = 0; v < side * side; v++)
            parent[v] = (uint16_t)(base + sys_random_below(&random, range));
        ff_reconstruct_refinement(&info, parent, &none, refined, NULL);
        for (uint32_t row = 0; row < wide; row++) {
            for (uint32_t column = 0; column < wide; column++) {
                const uint16_t *p = refined + row * wide + column;
                double expected;
                if (row % 2 && column % 2) {
                    const double cross[4] = { p[-1], p[1], *(p - wide), p[wide] };
                    const double corner[4] = { *(p - wide - 1), *(p - wide + 1), p[wide - 1],
                                               p[wide + 1] };
                    expected = ref_predict_centre(cross, corner);
                } else if (row % 2 ||
                           column % 2) { /* along the row or the column, known samples two apart */
                    ptrdiff_t step = row % 2 ? (ptrdiff_t)wide : 1;
                    uint32_t at = row % 2 ? row : column;
                    expected = at == 1 ? ref_predict_end(*(p - step), p[step], p[3 * step])
                               : at == wide - 2
                                   ? ref_predict_end(p[step], *(p - step), *(p - 3 * step))
                                   : ref_predict_inside(*(p - 3 * step), *(p - step), p[step],
                                                        p[3 * step]);
                } else {
                    expected = parent[row / 2 * side + column / 2];
                }
                worst = fmax(worst, fabs(expected - *p));
                samples++;
            }
        }
    }
    print_message("# interpolation: %u samples, worst %.3f steps (rounding is half of one)\n",
                  samples, worst);
    assert_true(worst <= 0.5);
}

static void height_of_the_drawn_surface(void **state)
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
    const ff_drawn *cut;
    uint32_t count = ff_tree_cut(fx.tree, &cut), compared = 0;
    sys_random random;
    sys_random_seed(&random, 9, 61);
    double worst = 0, step = fx.info.hscale_q24 / 65536.0;
    for (uint32_t i = ref_views(1); i > 0; i--) {
        const ff_drawn *node = &cut[sys_random_below(&random, count)];
        /* a border strip has triangles of its own; test_tree_view.c tests those */
        int ring = node->coarser ? 1 : 0;
        uint32_t column = (uint32_t)ref_between(&random, ring, 7 - ring),
                 row = (uint32_t)ref_between(&random, ring, 7 - ring);
        int32_t dx = ref_between(&random, 0, node->cell_wu - 1),
                dy = ref_between(&random, 0, node->cell_wu - 1), got;
        const uint16_t *h = node->heights + row * 9 + column;
        const double corner[4] = { h[0], h[1], h[9], h[10] };
        double expected = fx.info.hoffset_wu + step * ref_cell_height(corner,
                                                                      (double)dx / node->cell_wu,
                                                                      (double)dy / node->cell_wu);
        assert_int_equal(
            ff_tree_drawn_height(fx.tree, node->origin_wu[0] + (int32_t)column * node->cell_wu + dx,
                                 node->origin_wu[1] + (int32_t)row * node->cell_wu + dy, &got),
            1);
        worst = fmax(worst, fabs(expected - got));
        compared++;
    }
    print_message("# drawn surface: %u points, worst %.3f wu\n", compared, worst);
    assert_true(worst <= 2);
    fixture_free(&fx);
}

/* ---- functions ---- */

static void functions(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 10, 61);
    double worst_sine = 0;
    for (uint32_t i = ref_views(1); i > 0; i--) {
        uint32_t angle = sys_random_u32(&random);
        worst_sine = fmax(worst_sine, fabs(c3d_sin_turn32_q30(angle) -
                                           sin(angle * (2 * REF_PI / 4294967296.0)) * C3D_ONE_Q30));
        worst_sine = fmax(worst_sine,
                          fabs(c3d_cos_q30((int32_t)angle) -
                               cos((int32_t)angle * (2 * REF_PI / 65536)) * C3D_ONE_Q30));
        uint64_t square = ((uint64_t)sys_random_u32(&random) << 20) >>
                          sys_random_below(&random, 40);
        /* below 2^53: exact in double */
        assert_true(c3d_isqrt64(square) == (uint32_t)floor(sqrt((double)square)));
        int64_t a = ref_between(&random, -(1 << 26), 1 << 26),
                b = ref_between(&random, -(1 << 26), 1 << 26), c = ref_between(&random, 1, 1 << 26);
        assert_true(c3d_muldiv64(a, b, c) == (int64_t)trunc((double)(a * b) / (double)c));
        a *= INT64_C(1) << 30; /* beyond 64 bits on the way */
        double product = (double)a * (double)b / (double)c, got = (double)c3d_muldiv64(a, b, c);
        assert_true(fabs(product) > 9e18 || fabs(product - got) <= 1 + fabs(product) * 1e-15);
    }
    print_message("# sine and cosine: worst %.3f units of 2^-30\n", worst_sine);
    assert_true(worst_sine <= 2.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(projection_of_the_eye_path),
                                        cmocka_unit_test(projection_of_vertices_by_gl),
                                        cmocka_unit_test(projection_of_vertices_by_soft),
                                        cmocka_unit_test(culling_drops_nothing_seen),
                                        cmocka_unit_test(node_choice_by_distance),
                                        cmocka_unit_test(node_choice_by_pixels),
                                        cmocka_unit_test(limits_of_motion),
                                        cmocka_unit_test(interpolation_of_the_codec),
                                        cmocka_unit_test(height_of_the_drawn_surface),
                                        cmocka_unit_test(functions) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
