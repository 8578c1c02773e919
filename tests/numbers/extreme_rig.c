#include "extreme_rig.h"
#include "../../sim/judge/sim_watertight.h"
#include "reference.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define M              FF_WU_PER_METRE
#define MEMORY_BYTES   (4u << 20)
#define AUDIT_STEP_PX  8
#define CALM_FRAMES    40
#define SETTLED_FRAMES 10
#define TIMED_EVERY    3 /* frames; prime to the periods in the cases */

uint16_t extreme_cliffs(void *context, uint32_t x, uint32_t y)
{
    (void)context;
    uint32_t h = (x >> 3) * 0x9E3779B1u ^ (y >> 3) * 0x85EBCA77u;
    return (h ^ h >> 15) & 4 ? 65535 : 0;
}

uint16_t extreme_flat(void *context, uint32_t x, uint32_t y)
{
    (void)context, (void)x, (void)y;
    return 120;
}

/* ---- life ---- */

void extreme_open(extreme_rig *rig, extreme_row *row, const ff_terrain_info *info,
                  uint16_t (*height)(void *, uint32_t, uint32_t))
{
    size_t bytes = 0;
    memset(rig, 0, sizeof *rig);
    pack_fixture_desc desc = { .info = info ? *info : pack_fixture_info(6, 2, 2),
                               .height = height };
    desc.info.height_max = 65535;
    rig->row = row;
    rig->tick_us = 10000;
    rig->now_us = 1000000;
    rig->pack_bytes = pack_fixture_make(&desc, &bytes);
    if (!rig->pack_bytes || ff_pack_open(&rig->pack, rig->pack_bytes, bytes) != FF_OK ||
        sim_ground_load(&rig->ground, &rig->pack, UINT64_MAX) != FF_OK)
        abort();
    rig->auditor = sim_auditor_create(&rig->ground, &rig->pack.header.info, AUDIT_STEP_PX);
    rig->memory = malloc(MEMORY_BYTES);
    if (!rig->auditor || !rig->memory) abort();
    rig->desc = (ff_client_desc){ .memory = rig->memory,
                                  .memory_bytes = MEMORY_BYTES,
                                  .width = 240,
                                  .height = 320,
                                  .quality = { .measure = FF_MEASURE_PIXELS,
                                               .error_px_q8 = EXTREME_ERROR_PX * 256,
                                               .sigma_q8 = 320,
                                               .view_wu = INT32_MAX } };
    rig->camera = (c3d_camera){
        .width = 240, .height = 320, .focal_q8 = c3d_focal_q8(10923, 240), .pitch = -1500
    };
    double middle_m = rig->ground.cell_m * (rig->ground.columns - 1) / 2,
           south_m = rig->ground.cell_m * (rig->ground.rows - 1) / 2;
    extreme_place(rig, middle_m + 3, south_m + 5,
                  extreme_ground_m(rig, middle_m + 3, south_m + 5) + 200);
}

void extreme_start(extreme_rig *rig, const sim_link_desc *link)
{
    rig->desc.pack = link ? NULL : &rig->pack;
    if (link) {
        rig->link = sim_link_create(link, 7);
        if (!rig->link ||
            sim_server_init(&rig->server, &rig->pack, rig->link, &rig->now_us) != FF_OK)
            abort();
        sim_stream_client(&rig->end, rig->link, &rig->now_us, &rig->stream);
        rig->desc.stream = &rig->stream;
    }
    if (!rig->desc.backend) {
        sys_surface_desc surface = { "extremes", rig->desc.width, rig->desc.height,
                                     SYS_GL_DESKTOP };
        rig->desc.backend = c3d_backend_soft();
        rig->desc.surface_api = sys_surface_memory();
        if (rig->desc.surface_api->open(&surface, &rig->surface) != FF_OK) abort();
    }
    int rc = ff_client_create(&rig->desc, &rig->client);
    if (!extreme_row_expect(rig->row, rc == FF_OK, "the client could not be made")) abort();
}

void extreme_close(extreme_rig *rig)
{
    ff_client_stats stats;
    ff_client_get_stats(rig->client, &stats);
    rig->row->work.selects += stats.tree.selects;
    rig->row->work.requests += stats.requests_sent;
    rig->row->work.bytes += stats.bytes_down;
    extreme_row_expect(rig->row, stats.c3d.stale_handles == 0, "stale handles drawn");
    ff_client_destroy(rig->client);
    if (rig->link) {
        sim_server_free(&rig->server);
        sim_link_destroy(rig->link);
    }
    if (rig->surface) rig->desc.surface_api->close(rig->surface);
    sim_auditor_destroy(rig->auditor);
    sim_ground_free(&rig->ground);
    free(rig->memory);
    free(rig->pack_bytes);
}

double extreme_ground_m(const extreme_rig *rig, double x_m, double y_m)
{
    return sim_ground_height_m(&rig->ground, x_m, y_m);
}

void extreme_place(extreme_rig *rig, double x_m, double y_m, double z_m)
{
    const double at[3] = { x_m, y_m, z_m };
    for (int axis = 0; axis < 3; axis++)
        rig->camera.pos_wu[axis] = (int32_t)fmax(INT32_MIN,
                                                 fmin(INT32_MAX, floor(at[axis] * M + 0.5)));
}

/* ---- frames ---- */

static void check_whole(extreme_rig *rig)
{
    char why[160] = "";
    const ff_drawn *list;
    const ff_tree *tree = ff_client_tree(rig->client);
    uint32_t cut = tree ? ff_tree_cut(tree, &list) : 0;
    if (cut && !sim_watertight_check(&rig->pack.header.info, ff_tree_frame(tree), list, cut, why,
                                     sizeof why))
        extreme_row_expect(rig->row, 0, why);
}

/* The client's own part of a frame; 1 when the picture changed. */
static int client_frame(extreme_rig *rig, int draw)
{
    int changed = ff_client_update(rig->client, rig->now_us, &rig->camera);
    if (changed && draw) ff_client_draw(rig->client);
    return changed;
}

/* ---- the ordinary case ---- */

static extreme_rig *ordinary; /* made when first needed */
static extreme_row ordinary_row;

static void ordinary_open(void)
{
    ordinary = malloc(sizeof *ordinary);
    if (!ordinary) abort();
    extreme_open(ordinary, &ordinary_row, NULL, pack_fixture_hills);
    ordinary->untimed = 1;
    extreme_start(ordinary, NULL);
    extreme_settle(ordinary, 33000, 600);
}

void extreme_ordinary_close(void)
{
    if (ordinary) extreme_close(ordinary);
    free(ordinary);
    ordinary = NULL;
}

static void time_ordinary(extreme_cost *cost)
{
    if (!ordinary) ordinary_open();
    ordinary->camera.pos_wu[0] += cost->ordinary_times & 1 ? -M : M;
    ordinary->now_us += 33000;
    double begin_s = extreme_processor_s();
    (void)ff_client_work(ordinary->client, ordinary->now_us);
    cost->ordinary_times += (uint64_t)client_frame(ordinary, 1);
    cost->ordinary_s += extreme_processor_s() - begin_s;
}

/* ---- frames of a case ---- */

static void serve_link(extreme_rig *rig, int64_t until_us)
{
    rig->now_us = until_us - rig->now_us < rig->tick_us ? until_us : rig->now_us + rig->tick_us;
    if (rig->link)
        extreme_row_expect(rig->row, sim_server_step(&rig->server) == FF_OK,
                           "the server has no memory");
}

int extreme_frame(extreme_rig *rig, int64_t step_us)
{
    int64_t until_us = rig->now_us + step_us;
    int timed = !rig->untimed && rig->row->work.frames % TIMED_EVERY == 0;
    double own_s = 0, begin_s;
    do {
        serve_link(rig, until_us);
        begin_s = extreme_processor_s();
        (void)ff_client_work(rig->client, rig->now_us);
        own_s += extreme_processor_s() - begin_s;
    } while (rig->now_us < until_us);
    begin_s = extreme_processor_s();
    int changed = client_frame(rig, timed);
    own_s += extreme_processor_s() - begin_s;
    if (timed) {
        rig->row->cost.own_s += own_s;
        rig->row->cost.own_times += (uint64_t)changed;
        time_ordinary(&rig->row->cost);
    }
    ff_client_stats stats;
    ff_client_get_stats(rig->client, &stats);
    rig->row->work.frames++;
    rig->changes += (uint32_t)changed;
    if (changed) {
        rig->row->work.triangles += stats.tree.triangles;
        check_whole(rig);
    }
    extreme_row_expect(rig->row, stats.in_flight_high <= 32,
                       "more requests in flight than allowed");
    extreme_row_expect(rig->row, stats.protocol_errors == 0, "protocol error");
    return changed;
}

void extreme_settle(extreme_rig *rig, int64_t step_us, unsigned frames_max)
{
    unsigned calm = 0;
    for (unsigned i = 0; i < frames_max && calm < SETTLED_FRAMES; i++) {
        int changed = extreme_frame(rig, step_us);
        ff_client_stats stats;
        ff_client_get_stats(rig->client, &stats);
        calm = stats.have_terrain && !changed && !stats.queued && !stats.in_flight ? calm + 1 : 0;
    }
    extreme_row_expect(rig->row, calm == SETTLED_FRAMES, "does not settle");
}

/* ---- judging ---- */

static uint32_t requests_of(const extreme_rig *rig)
{
    ff_client_stats stats;
    ff_client_get_stats(rig->client, &stats);
    return stats.requests_sent;
}

void extreme_calm(extreme_rig *rig)
{
    uint32_t changes = rig->changes, requests = requests_of(rig);
    for (unsigned i = 0; i < CALM_FRAMES; i++) extreme_frame(rig, 33000);
    extreme_row_expect(rig->row, rig->changes == changes, "a still picture changes");
    extreme_row_expect(rig->row, requests_of(rig) == requests, "a still camera asks for more");
    c3d_camera home = rig->camera;
    for (unsigned i = 0; i < 2 * CALM_FRAMES; i++) {
        rig->camera = home;
        int step = i & 1 ? 1 : 0;
        rig->camera.pos_wu[0] += home.pos_wu[0] < 0 ? step : -step;
        rig->camera.yaw += step;
        extreme_frame(rig, 33000);
        if (i == CALM_FRAMES) requests = requests_of(rig);
    }
    extreme_row_expect(rig->row, requests_of(rig) == requests,
                       "asks again and again while the camera trembles");
    rig->camera = home;
    extreme_frame(rig, 33000);
}

/* Random points, half of them near the camera: drawn height against true height, both projected. */
static double error_of_points(extreme_rig *rig)
{
    double worst = 0, size_m[2] = { rig->ground.cell_m * (rig->ground.columns - 1),
                                    rig->ground.cell_m * (rig->ground.rows - 1) };
    sys_random random;
    ref_camera ref;
    sys_random_seed(&random, 3, 9);
    ref_camera_of(&rig->camera, &ref);
    for (int i = 0; i < 2000; i++) {
        double drawn[3], truth[3], drawn_px[2], true_px[2];
        int32_t z_wu;
        for (int axis = 0; axis < 2; axis++) {
            double part = sys_random_below(&random, 1000001) / 1e6, at = part * size_m[axis];
            if (i & 1) at = fmax(0, fmin(size_m[axis], ref.pos_wu[axis] / M + (part - 0.5) * 200));
            drawn[axis] = truth[axis] = floor(at * M);
        }
        if (!ff_client_ground(rig->client, (int32_t)truth[0], (int32_t)truth[1], &z_wu)) continue;
        drawn[2] = z_wu;
        truth[2] = extreme_ground_m(rig, truth[0] / M, truth[1] / M) * M;
        if (!ref_project(&ref, drawn, drawn_px) || !ref_project(&ref, truth, true_px) ||
            !ref_in_window(&ref, true_px, 0))
            continue;
        rig->row->work.audited++;
        worst = fmax(worst, hypot(drawn_px[0] - true_px[0], drawn_px[1] - true_px[1]));
    }
    return worst;
}

double extreme_audit(extreme_rig *rig)
{
    sim_audit_view view = { .camera = rig->camera };
    sim_audit_result result;
    const ff_tree *tree = ff_client_tree(rig->client);
    if (tree) view.drawn_count = ff_tree_drawn(tree, &view.drawn);
    if (sim_audit_frame(rig->auditor, &view, &result) != FF_OK) abort();
    extreme_row_expect(rig->row, result.undrawn_pixels == 0, "ground in sight is not drawn");
    rig->row->work.audited += result.ground_pixels;
    return result.ground_pixels ? result.err_px_max : error_of_points(rig);
}

double extreme_error_bound(const c3d_camera *camera)
{
    double focal_px = camera->focal_q8 / 256.0, x = camera->width / 2.0 / focal_px,
           y = camera->height / 2.0 / focal_px;
    return EXTREME_ERROR_PX * (1 + x * x + y * y) + 0.5;
}

void extreme_judge(extreme_rig *rig)
{
    extreme_settle(rig, 33000, 600);
    extreme_row_value(rig->row, extreme_audit(rig));
    extreme_calm(rig);
}

int extreme_same_picture(const extreme_rig *a, const extreme_rig *b)
{
    const ff_drawn *list_a, *list_b;
    const ff_tree *tree_a = ff_client_tree(a->client), *tree_b = ff_client_tree(b->client);
    if (!tree_a || !tree_b) return 0;
    uint32_t count = ff_tree_drawn(tree_a, &list_a), side = ff_node_side(&a->pack.header.info);
    if (!count || count != ff_tree_drawn(tree_b, &list_b)) return 0;
    for (uint32_t i = 0; i < count; i++)
        if (list_a[i].key != list_b[i].key || memcmp(list_a[i].heights, list_b[i].heights,
                                                     (size_t)side * side * sizeof(uint16_t)) != 0)
            return 0;
    return 1;
}

double extreme_error_near(const terrain_fixture *fx, const ff_view *view, sys_random *random)
{
    double worst = 0;
    for (int i = 0; i < 400; i++) {
        int64_t reach = (int64_t)64 << sys_random_below(random, 9),
                x = view->camera.pos_wu[0] / (10 * M), y = view->camera.pos_wu[1] / (10 * M);
        x += (int64_t)sys_random_below(random, (uint32_t)(2 * reach)) - reach;
        y += (int64_t)sys_random_below(random, (uint32_t)(2 * reach)) - reach;
        int32_t drawn;
        if (x < 0 || y < 0 || x > 65535 || y > 65535 ||
            !ff_tree_drawn_height(fx->tree, (int32_t)x * 10 * M, (int32_t)y * 10 * M, &drawn))
            continue;
        double truth = (double)fx->height((uint32_t)x, (uint32_t)y) * M;
        double dx = (double)x * 10 * M - view->camera.pos_wu[0],
               dy = (double)y * 10 * M - view->camera.pos_wu[1];
        double distance = sqrt(dx * dx + dy * dy +
                               (truth - view->camera.pos_wu[2]) * (truth - view->camera.pos_wu[2]));
        worst = fmax(worst, fabs(drawn - truth) * view->camera.focal_q8 / 256.0 / distance);
    }
    return worst;
}
