/* Every stiff and extreme case of DESIGN.md (Judging the picture) with the real client: a row each
 * in build/extremes.md (or $EXTREMES). In each: no crack in any changed frame, nothing in sight
 * undrawn, requests bounded, no oscillation, and the largest error told. Overflow and division by
 * zero end the sanitized run. */
#include "../../client/panorama/ff_panorama_rules.h"
#include "extreme_rig.h"
#include "reference.h"
#include "../rig/terrain_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define M        FF_WU_PER_METRE
#define FRAME_US 33000

static void end_row(const extreme_row *row)
{
    if (row->failed)
        fail_msg("%s: %s (largest %g %s, bound %g)", row->name, row->verdict, row->worst, row->unit,
                 row->bound);
}

static void end_case(extreme_rig *rig)
{
    extreme_row *row = rig->row;
    extreme_close(rig);
    end_row(row);
}

/* ---- ground ---- */

static void cliffs(void **state)
{
    (void)state;
    extreme_rig rig;
    extreme_row *row = extreme_row_begin("cliffs 0-65535", "err_px, flight and stop", "px", 0);
    ff_terrain_info info = pack_fixture_info(6, 2, 2);
    info.hscale_q24 = 1 << 20; /* 4 km high, 256 m apart */
    extreme_open(&rig, row, &info, extreme_cliffs);
    extreme_place(&rig, 300, 300, 6500);
    rig.camera.pitch = -9000;
    rig.camera.yaw = 8192;
    row->bound = extreme_error_bound(&rig.camera);
    extreme_start(&rig, NULL);
    for (int i = 0; i < 60; i++) {
        rig.camera.pos_wu[0] += 10 * M;
        rig.camera.pos_wu[2] -= 30 * M;
        extreme_frame(&rig, FRAME_US);
    }
    extreme_judge(&rig);
    end_case(&rig);
}

static void flat(void **state)
{
    (void)state;
    extreme_rig rig;
    extreme_row *row = extreme_row_begin("flat ground", "err_px", "px", 1e-6);
    extreme_open(&rig, row, NULL, extreme_flat);
    extreme_start(&rig, NULL);
    extreme_judge(&rig);
    ff_client_stats stats;
    ff_client_get_stats(rig.client, &stats);
    extreme_row_expect(row, stats.requests_sent == 4, "flat ground asks for more than its roots");
    end_case(&rig);
}

static void one_node(void **state)
{
    (void)state;
    extreme_rig rig;
    ff_terrain_info info = pack_fixture_info(3, 1, 1);
    extreme_row *row = extreme_row_begin("one-node terrain", "err_px", "px", 1e-6);
    extreme_open(&rig, row, &info, pack_fixture_hills);
    rig.camera.pitch = -9000;
    extreme_start(&rig, NULL);
    extreme_judge(&rig);
    ff_client_stats stats;
    ff_client_get_stats(rig.client, &stats);
    extreme_row_expect(row, stats.requests_sent == 1 && stats.tree.nodes_held == 1,
                       "more than one node");
    end_case(&rig);
}

/* Selects at the same place of both terrains in turns. */
static void time_selections(terrain_fixture *own, terrain_fixture *ordinary, ff_view view,
                            const ff_quality *quality, extreme_cost *cost)
{
    for (int i = 0; i < 100; i++) {
        view.camera.pos_wu[0] += 10 * M;
        double begin_s = extreme_processor_s();
        (void)ff_tree_select(own->tree, &view, quality);
        double middle_s = extreme_processor_s();
        (void)ff_tree_select(ordinary->tree, &view, quality);
        cost->ordinary_s += extreme_processor_s() - middle_s;
        cost->own_s += middle_s - begin_s;
    }
    cost->own_times += 100;
    cost->ordinary_times += 100;
}

/* 2 x 2 tiles of 2^15 cells, encoded as they are asked for; the tree alone. */
static void terrain_of_64k(void **state)
{
    (void)state;
    terrain_fixture fx;
    /* The fixture measures the error of wide nodes at some samples only: the drawn error may be a
     * little larger than the one asked for. */
    extreme_row *row = extreme_row_begin("64k x 64k terrain, 655 km", "err_px round the camera",
                                         "px", 3);
    static const int32_t at_m[][2] = {
        { 327680, 327680 }, { 5, 5 }, { 655350, 655350 }, { 100000, 500000 }
    };
    sys_random random;
    sys_random_seed(&random, 64, 1);
    fixture_make(&fx, 3, 15, 2, 2, fixture_hills);
    fixture_tree(&fx, 4000, 64);
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    for (unsigned i = 0; i < sizeof at_m / sizeof *at_m; i++) { /* teleports across it */
        ff_view view = fixture_view_above(&fx, at_m[i][0], at_m[i][1], 150, 30 + 90 * (int)i, -8);
        row->work.requests += fixture_settle(&fx, &view, &quality, 100);
        fixture_assert_whole(&fx);
        extreme_row_value(row, extreme_error_near(&fx, &view, &random));
        const ff_wish *wish;
        extreme_row_expect(row, ff_tree_wishes(fx.tree, &wish) == 0, "wishes remain");
        extreme_row_expect(row, ff_tree_select(fx.tree, &view, &quality) == 0,
                           "a still cut is made anew");
        row->work.frames++;
    }
    ff_tree_stats stats;
    ff_tree_get_stats(fx.tree, &stats);
    row->work.selects = stats.selects;
    row->work.triangles = stats.triangles;
    extreme_row_expect(row, row->work.requests < 8000, "requests without end");
    terrain_fixture small;
    fixture_make(&small, 3, 9, 2, 2, fixture_hills);
    fixture_tree(&small, 4000, 64);
    ff_view view = fixture_view_above(&fx, 5000, 5000, 150, 30, -8);
    fixture_settle(&fx, &view, &quality, 100);
    fixture_settle(&small, &view, &quality, 100);
    time_selections(&fx, &small, view, &quality, &row->cost);
    fixture_free(&small);
    fixture_free(&fx);
    end_row(row);
}

/* ---- places ---- */

typedef struct place {
    const char *name;
    double x_m, y_m, above_m; /* x, y below 0: the middle */
    int32_t pitch, yaw;
    double fov_deg;
} place;

static void judge_place(const place *p, const ff_terrain_info *info)
{
    extreme_rig rig;
    extreme_row *row = extreme_row_begin(p->name, "err_px", "px", 0);
    extreme_open(&rig, row, info, pack_fixture_hills);
    double x_m = p->x_m < 0 ? rig.camera.pos_wu[0] / (double)M : p->x_m,
           y_m = p->y_m < 0 ? rig.camera.pos_wu[1] / (double)M : p->y_m;
    extreme_place(&rig, x_m, y_m, extreme_ground_m(&rig, x_m, y_m) + p->above_m);
    rig.camera.pitch = p->pitch;
    rig.camera.yaw = p->yaw;
    if (p->fov_deg > 0)
        rig.camera.focal_q8 = c3d_focal_q8((int32_t)(p->fov_deg * 65536 / 360 + 0.5), 240);
    row->bound = fmin(extreme_error_bound(&rig.camera), 800);
    extreme_start(&rig, NULL);
    extreme_judge(&rig);
    end_case(&rig);
}

static void camera_places(void **state)
{
    (void)state;
    static const place list[] = {
        { "camera on a vertex", 2048, 1024, 0, -1500, 0, 0 },
        { "camera on a tile corner", 2048, 2048, 0, -1500, 8192, 0 },
        { "camera 50 m below ground", -1, -1, -50, 1500, 0, 0 },
        { "camera 1 cm above ground", -1, -1, 0.01, -1500, 0, 0 },
        { "camera 1000 km above, straight down", -1, -1, 1e6, -16384, 0, 1 },
        { "straight down from 300 m", -1, -1, 300, -16384, 0, 0 },
        { "straight up", -1, -1, 300, 16384, 0, 0 },
        { "terrain's south-west corner", 0, 0, 2, -1000, 8192, 0 },
        { "terrain's north-east corner", 4096, 4096, 2, -1000, 40960, 0 },
        { "field of view 0.1 degrees", -1, -1, 200, -900, 3000, 0.1 },
        { "field of view 170 degrees", -1, -1, 200, -3000, 3000, 170 },
    };
    for (unsigned i = 0; i < sizeof list / sizeof *list; i++) judge_place(&list[i], NULL);
}

/* The widest terrain that fits the world: its far corner is 8388 km out. */
static void world_limits(void **state)
{
    (void)state;
    ff_terrain_info info = pack_fixture_info(5, 2, 2);
    info.spacing_wu = INT32_MAX / 64;
    static const place corner = {
        "far corner of an 8388 km terrain", 8388607, 8388607, 1000, -1500, 40960, 0
    };
    judge_place(&corner, &info);

    static const int32_t limit[][3] = { { INT32_MAX, INT32_MAX, INT32_MAX },
                                        { INT32_MIN, INT32_MIN, INT32_MIN },
                                        { INT32_MAX, INT32_MIN, 0 },
                                        { INT32_MIN, 0, INT32_MAX } };
    extreme_rig rig;
    extreme_row *row = extreme_row_begin("camera at the world's limits", "err_px", "px",
                                         EXTREME_ERROR_PX + 2);
    extreme_open(&rig, row, NULL, pack_fixture_hills);
    extreme_start(&rig, NULL);
    for (unsigned i = 0; i < sizeof limit / sizeof *limit; i++) {
        memcpy(rig.camera.pos_wu, limit[i], sizeof limit[i]);
        rig.camera.yaw = (int32_t)i * 16384 + 8192;
        rig.camera.pitch = i & 1 ? 9000 : -9000;
        extreme_judge(&rig);
    }
    end_case(&rig);
}

/* ---- near and far ---- */

/* Seconds that drawing and reading back take. */
static double render(extreme_rig *rig, int32_t near_wu, int32_t far_wu, uint8_t *rgb)
{
    rig->camera.near_wu = near_wu;
    rig->camera.far_wu = far_wu;
    extreme_frame(rig, FRAME_US);
    double begin_s = extreme_processor_s();
    ff_client_draw(rig->client);
    extreme_row_expect(rig->row, c3d_read_rgb(ff_client_device(rig->client), rgb) == FF_OK,
                       "no picture");
    return extreme_processor_s() - begin_s;
}

static void judge_near_far(const char *name, const struct c3d_backend *backend,
                           const sys_surface_api *api)
{
    static uint8_t wide[240 * 320 * 3], narrow[240 * 320 * 3];
    extreme_rig rig;
    extreme_row *row = extreme_row_begin(name, "pixels unlike those of ratio 10^3", "%", 2);
    extreme_open(&rig, row, NULL, pack_fixture_hills);
    sys_surface_desc surface = { "extremes", 240, 320, SYS_GL_DESKTOP };
    rig.desc.surface_api = api;
    if (!api || api->open(&surface, &rig.surface) != FF_OK) abort();
    rig.desc.backend = backend;
    rig.untimed = 1;
    extreme_start(&rig, NULL);
    extreme_settle(&rig, FRAME_US, 600);
    extreme_calm(&rig);
    for (int i = 0; i < 8; i++) { /* the first is not counted */
        double narrow_s = render(&rig, 8 * M, 8000 * M, narrow),
               wide_s = render(&rig, 64, 64000000, wide);
        row->cost.ordinary_s += i ? narrow_s : 0;
        row->cost.own_s += i ? wide_s : 0;
    }
    row->cost.own_times = row->cost.ordinary_times = 7;
    uint32_t unlike = 0;
    for (uint32_t i = 0; i < 240 * 320; i++)
        unlike += abs(wide[3 * i] - narrow[3 * i]) > 8 ||
                  abs(wide[3 * i + 1] - narrow[3 * i + 1]) > 8;
    extreme_row_value(row, unlike * 100.0 / (240 * 320));
    ff_client_stats stats;
    ff_client_get_stats(rig.client, &stats);
    extreme_row_expect(row, stats.c3d.stale_handles == 0 && stats.c3d.frame_triangles > 1000,
                       "not drawn");
    end_case(&rig);
}

static void near_far_ratio(void **state)
{
    (void)state;
    judge_near_far("near/far ratio 10^6, GL", c3d_backend_gl(), sys_surface_osmesa());
    judge_near_far("near/far ratio 10^6, integers", c3d_backend_soft(), sys_surface_memory());
}

/* ---- time and motion ---- */

/* Once settled over a link the client shows what a client with the pack itself shows. */
static void expect_same_as_local(extreme_rig *rig)
{
    extreme_rig local;
    extreme_open(&local, rig->row, NULL, pack_fixture_hills);
    local.camera = rig->camera;
    extreme_start(&local, NULL);
    extreme_settle(&local, FRAME_US, 600);
    extreme_row_expect(rig->row, extreme_same_picture(rig, &local),
                       "ends with another picture than without a link");
    extreme_close(&local);
}

static void begin_over(extreme_rig *rig, extreme_row *row, const char *link)
{
    sim_link_desc desc;
    extreme_open(rig, row, NULL, pack_fixture_hills);
    assert_int_equal(sim_link_parse(link, &desc), FF_OK);
    rig->camera.pos_wu[2] += 500 * M;
    row->bound = extreme_error_bound(&rig->camera);
    extreme_start(rig, &desc);
}

static void frames_of_no_time(void **state)
{
    (void)state;
    extreme_rig rig;
    extreme_row *row = extreme_row_begin("frames of 0 ms", "err_px at the end", "px", 0);
    begin_over(&rig, row, "umts");
    for (int i = 0; i < 300; i++) {
        rig.camera.pos_wu[1] += M;
        extreme_frame(&rig, i % 10 ? 0 : 100000);
    }
    extreme_judge(&rig);
    expect_same_as_local(&rig);
    end_case(&rig);
}

static void frames_of_ten_seconds(void **state)
{
    (void)state;
    extreme_rig rig;
    extreme_row *row = extreme_row_begin("frames of 10 s", "err_px at the end", "px", 0);
    begin_over(&rig, row, "umts");
    for (int i = 0; i < 30; i++) {
        rig.camera.pos_wu[1] += 40 * M;
        extreme_frame(&rig, 10000000);
    }
    extreme_judge(&rig);
    expect_same_as_local(&rig);
    end_case(&rig);
}

static void teleports(void **state)
{
    (void)state;
    extreme_rig rig;
    sys_random random;
    extreme_row *row = extreme_row_begin("teleport every 5 frames", "err_px at the end", "px", 0);
    sys_random_seed(&random, 5, 5);
    begin_over(&rig, row, "umts");
    for (int i = 0; i < 300; i++) {
        if (i % 5 == 0)
            for (int axis = 0; axis < 3; axis++)
                rig.camera.pos_wu[axis] = (int32_t)sys_random_below(
                    &random, (uint32_t)(axis < 2 ? 4096 : 3000) * M);
        if (i == 150) rig.camera.pos_wu[0] = INT32_MIN;
        extreme_frame(&rig, FRAME_US);
    }
    extreme_place(&rig, 1500, 1400, extreme_ground_m(&rig, 1500, 1400) + 100);
    row->bound = extreme_error_bound(&rig.camera);
    extreme_judge(&rig);
    expect_same_as_local(&rig);
    end_case(&rig);
}

/* Standing still with a receiver that is up to 8 m wrong, ten times a second: once all those places
 * have been seen, nothing more is asked for. */
static void gps_noise(void **state)
{
    (void)state;
    extreme_rig rig;
    sys_random random;
    extreme_row *row = extreme_row_begin("GPS noise of 8 m, 10 Hz, 120 s",
                                         "requests in the second minute", "", 4);
    sys_random_seed(&random, 6, 5);
    begin_over(&rig, row, "umts");
    row->bound = 4;
    const c3d_camera home = rig.camera;
    ff_client_stats half, stats;
    for (int i = 0; i < 1200; i++) {
        for (int axis = 0; axis < 3; axis++)
            rig.camera.pos_wu[axis] = home.pos_wu[axis] +
                                      (int32_t)sys_random_below(&random, 16 * M) - 8 * M;
        extreme_frame(&rig, 100000);
        if (i == 599) ff_client_get_stats(rig.client, &half);
    }
    ff_client_get_stats(rig.client, &stats);
    extreme_row_value(row, stats.requests_sent - half.requests_sent);
    extreme_row_expect(row, stats.requests_sent < 340, "more requests than the terrain has nodes");
    end_case(&rig);
}

/* ---- links ---- */

typedef struct link_case {
    const char *name, *link;
    unsigned seconds; /* flies 800 m in this time, then stops and settles within the same time */
    int whole;        /* the client settles */
} link_case;

static void fly_over_link(const link_case *c)
{
    extreme_rig rig;
    sim_link_desc desc;
    extreme_row *row = extreme_row_begin(c->name, "err_px at the end", "px", 0);
    extreme_open(&rig, row, NULL, pack_fixture_hills);
    assert_int_equal(sim_link_parse(c->link, &desc), FF_OK);
    rig.camera.pos_wu[2] += 500 * M;
    const c3d_camera home = rig.camera;
    extreme_start(&rig, &desc);
    /* on slow links a picture a second is plenty */
    int64_t frame_us = c->seconds < 600 ? 100000 : 1000000;
    rig.tick_us = frame_us / 10;
    unsigned frames = c->seconds * 10 / (unsigned)(frame_us / 100000);
    for (unsigned i = 0; i < frames; i++) {
        rig.camera.pos_wu[1] = home.pos_wu[1] + (int32_t)((int64_t)i * 800 * M / frames);
        extreme_frame(&rig, frame_us);
    }
    if (c->whole) {
        row->bound = extreme_error_bound(&rig.camera);
        extreme_settle(&rig, frame_us, frames + 100);
        extreme_row_value(row, extreme_audit(&rig));
        extreme_calm(&rig);
        expect_same_as_local(&rig);
    } else { /* the picture is coarser, and the statistics say so */
        row->bound = 400;
        ff_client_stats stats;
        ff_client_get_stats(rig.client, &stats);
        extreme_row_expect(row, stats.have_terrain && stats.tree.nodes_held > 0,
                           "nothing arrived at all");
        extreme_row_value(row, extreme_audit(&rig));
    }
    if (desc.way[SIM_DOWN].bytes_s) {
        ff_client_stats stats;
        ff_client_get_stats(rig.client, &stats);
        extreme_row_expect(row,
                           stats.bytes_down <= (uint64_t)desc.way[SIM_DOWN].bytes_s *
                                                   (uint64_t)(rig.now_us / 1000000),
                           "more bytes than the link carries");
    }
    end_case(&rig);
}

static void links(void **state)
{
    (void)state;
    static const link_case list[] = {
        { "link of 10 B/s", "lan,down.bytes_s=10,up.bytes_s=10", 600, 0 },
        { "link of 1 GB/s", "lan,down.bytes_s=1000000000,up.bytes_s=1000000000", 20, 1 },
        { "delay of 0", "ideal", 20, 1 },
        { "delay of 60 s each way", "umts,down.delay_us=60000000,up.delay_us=60000000", 1500, 1 },
        { "cut every second",
          "umts,down.delay_us=20000,up.delay_us=20000,connect_ms=100,cut_every_ms=1000", 120, 1 },
    };
    for (unsigned i = 0; i < sizeof list / sizeof *list; i++) fly_over_link(&list[i]);
}

/* ---- limits of the panorama's rules ---- */

#define RULE_Z_WU  (7500 * M)
#define RULE_TIMES 2000
static const int32_t any_ground[2] = { INT32_MIN, INT32_MAX };

static int outdated(const c3d_camera *camera, const int32_t taken_wu[3], int32_t error_px_q8)
{
    ff_panorama_sight sight;
    ff_panorama_sight_terrain(&sight, taken_wu, any_ground, RULE_Z_WU);
    return ff_panorama_outdated(camera, taken_wu, &sight, RULE_Z_WU, error_px_q8);
}

/* Times a rule's evaluation at a limit against an ordinary one. */
static void time_limit(extreme_cost *cost, int64_t error, int64_t w)
{
    static volatile int64_t kept;
    double begin_s = extreme_processor_s();
    for (int i = 0; i < RULE_TIMES; i++) kept = ff_panorama_forwards_max(error, RULE_Z_WU, w);
    double middle_s = extreme_processor_s();
    for (int i = 0; i < RULE_TIMES; i++) kept = ff_panorama_forwards_max(256, RULE_Z_WU, 30720);
    (void)kept;
    cost->ordinary_s += extreme_processor_s() - middle_s;
    cost->own_s += middle_s - begin_s;
    cost->own_times += RULE_TIMES;
    cost->ordinary_times += RULE_TIMES;
}

static void width_to_zero(void **state)
{
    (void)state;
    extreme_row *row = extreme_row_begin("w to 0 (1 px ... 1/256 px, 0)",
                                         "forward limit off the reference", "wu", 1.001);
    for (int64_t w = 256; w >= 0; w = w ? w / 2 : -1) {
        extreme_row_value(row, fabs((double)ff_panorama_forwards_max(256, RULE_Z_WU, w) -
                                    ref_forwards_max(256, RULE_Z_WU, (double)w)));
        time_limit(&row->cost, 256, w);
    }
    end_row(row);
}

static c3d_camera rule_camera(int64_t moved_wu)
{
    return (c3d_camera){
        .pos_wu = { 0, (int32_t)moved_wu, 0 }, .width = 240, .height = 320, .focal_q8 = 53209
    };
}

static void allowed_error_to_zero(void **state)
{
    (void)state;
    static const int32_t taken[3] = { 0, 0, 0 };
    extreme_row *row = extreme_row_begin("error allowed to 0 (64 px ... 1/256 px, 0)",
                                         "limits of motion off the reference", "wu", 1.001);
    for (int64_t error = 64 * 256; error >= 0; error = error ? error / 2 : -1) {
        double ahead = ref_forwards_max((double)error, RULE_Z_WU, 30720),
               aside = ref_sideways_max((double)error, RULE_Z_WU, 53209);
        extreme_row_value(row,
                          fabs((double)ff_panorama_forwards_max(error, RULE_Z_WU, 30720) - ahead));
        extreme_row_value(row,
                          fabs((double)ff_panorama_sideways_max(error, RULE_Z_WU, 53209) - aside));
        time_limit(&row->cost, error, 30720);
    }
    extreme_row_expect(row, ff_panorama_forwards_max(0, RULE_Z_WU, 0) == 0,
                       "motion with neither error nor width");
    c3d_camera camera = rule_camera(1);
    extreme_row_expect(row, outdated(&camera, taken, 0), "motion without any error allowed");
    camera = rule_camera(0);
    extreme_row_expect(row, !outdated(&camera, taken, 0), "asks again without any motion");
    end_row(row);
}

/* 1 when the joint rule keeps a set taken at O after this motion; timed against an ordinary case,
 * half a pixel's motion with one pixel allowed. */
static int set_is_kept(extreme_cost *cost, int64_t moved_wu, int32_t error)
{
    static const int32_t taken[3] = { 0, 0, 0 };
    c3d_camera far_off = rule_camera(moved_wu), near_by = rule_camera(RULE_Z_WU / 416);
    double begin_s = extreme_processor_s();
    int far_outdated = outdated(&far_off, taken, error);
    double middle_s = extreme_processor_s();
    (void)outdated(&near_by, taken, 256);
    cost->ordinary_s += extreme_processor_s() - middle_s;
    cost->own_s += middle_s - begin_s;
    cost->own_times++;
    cost->ordinary_times++;
    return !far_outdated;
}

static void motion_to_z(void **state)
{
    (void)state;
    extreme_row *row = extreme_row_begin("OO' to z and beyond", "sets kept although OO' >= z", "",
                                         0);
    for (int32_t error = 1; error > 0; error = error < INT32_MAX / 2 ? error * 2
                                               : error < INT32_MAX   ? INT32_MAX
                                                                     : -1) {
        for (int64_t more = -1; more <= 1; more++)
            extreme_row_value(row, set_is_kept(&row->cost, RULE_Z_WU + more, error) && more >= 0);
        extreme_row_value(row, set_is_kept(&row->cost, INT32_MIN, error));
    }
    end_row(row);
}

static int write_table(void **state)
{
    (void)state;
    const char *path = getenv("EXTREMES");
    (void)sys_make_folder("build");
    extreme_ordinary_close();
    return extreme_table_write(path ? path : "build/extremes.md") == FF_OK ? 0 : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(cliffs),
                                        cmocka_unit_test(flat),
                                        cmocka_unit_test(one_node),
                                        cmocka_unit_test(terrain_of_64k),
                                        cmocka_unit_test(camera_places),
                                        cmocka_unit_test(world_limits),
                                        cmocka_unit_test(near_far_ratio),
                                        cmocka_unit_test(frames_of_no_time),
                                        cmocka_unit_test(frames_of_ten_seconds),
                                        cmocka_unit_test(teleports),
                                        cmocka_unit_test(gps_noise),
                                        cmocka_unit_test(links),
                                        cmocka_unit_test(width_to_zero),
                                        cmocka_unit_test(allowed_error_to_zero),
                                        cmocka_unit_test(motion_to_z) };
    return cmocka_run_group_tests(tests, NULL, write_table);
}
