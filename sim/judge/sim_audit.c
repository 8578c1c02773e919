#include "sim_audit.h"

#include "sim_cover.h"
#include "sim_cube.h"
#include "sim_eye.h"
#include "sim_mesh.h"
#include "sim_place.h"
#include "sim_skyline.h"
#include "sim_spread.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEAREST_M 0.01 /* points nearer to the eye have no pixel */
#define EDGE_PX   0.5  /* how exactly the drawn ground's edge is found */

struct sim_auditor {
    const sim_ground *ground;
    unsigned step_px;
    sim_mesh mesh;
    sim_faces faces;
    /* of one frame */
    sim_cover cover;
    struct look *look;
    double *error;                        /* of looks, then of columns */
    double *true_px, *drawn_px, *hint_px; /* skylines, a place for each column of pixels */
    size_t looks, columns;                /* room for so many */
};

/* A frame being audited. */
typedef struct frame {
    sim_auditor *auditor;
    const sim_audit_view *view;
    sim_eye e;
    size_t looks;
} frame;

sim_auditor *sim_auditor_create(const sim_ground *ground, const ff_terrain_info *info,
                                unsigned step_px)
{
    sim_auditor *auditor = calloc(1, sizeof *auditor);
    if (!auditor) return NULL;
    auditor->ground = auditor->faces.ground = ground;
    auditor->step_px = step_px;
    if (sim_mesh_make(&auditor->mesh, info) != FF_OK) {
        sim_auditor_destroy(auditor);
        return NULL;
    }
    return auditor;
}

static void free_room(sim_auditor *auditor)
{
    free(auditor->look);
    free(auditor->error);
    free(auditor->true_px);
    free(auditor->drawn_px);
    free(auditor->hint_px);
}

void sim_auditor_destroy(sim_auditor *auditor)
{
    if (!auditor) return;
    sim_mesh_free(&auditor->mesh);
    sim_cover_free(&auditor->cover);
    free_room(auditor);
    free(auditor);
}

/* ---- projection ---- */

int sim_audit_project(const c3d_camera *camera, const double point_m[3], double pixel[2])
{
    sim_eye e;
    sim_eye_of(camera, &e);
    const double direction[3] = { point_m[0] - e.pos_m[0], point_m[1] - e.pos_m[1],
                                  point_m[2] - e.pos_m[2] };
    return sim_eye_project(&e, direction, pixel);
}

/* ---- what the client draws ---- */

/* The node drawn over or under a point and its height there, or NULL. Only several grounds have
 * more than one: the upper is seen. */
static const ff_drawn *drawn_at(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t count,
                                const double point_m[3], double *z_m)
{
    const ff_drawn *found = NULL;
    double cell[2], height_m;
    for (uint32_t i = 0; i < count && (!found || auditor->mesh.grounds > 1); i++) {
        if (!sim_place_in_node(auditor->mesh.info, &drawn[i], point_m, cell) ||
            !sim_mesh_height(&auditor->mesh, &drawn[i], cell, &height_m) ||
            (found && height_m <= *z_m))
            continue;
        found = &drawn[i];
        *z_m = height_m;
    }
    return found;
}

int sim_audit_drawn_height(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t count,
                           double x_m, double y_m, double *z_m)
{
    const double point_m[3] = { x_m, y_m, 0 };
    return drawn_at(auditor, drawn, count, point_m, z_m) != NULL;
}

/* How many times as wrong as near ground a node may be: the quality allows it when all of the node
 * is far away. */
static double coarse_times(const frame *of, const ff_terrain_info *info, const ff_drawn *drawn)
{
    const ff_quality *quality = &of->view->quality;
    double middle_m[3],
        half_m = (double)drawn->cell_wu * (1u << info->node_log2) / 2 / FF_WU_PER_METRE,
        fine_m = (double)quality->fine_wu / FF_WU_PER_METRE;
    if (quality->coarse <= 1) return 1;
    sim_place_middle(info, drawn, middle_m);
    return fabs(middle_m[0] - of->e.pos_m[0]) - half_m > fine_m ||
                   fabs(middle_m[1] - of->e.pos_m[1]) - half_m > fine_m
               ? quality->coarse
               : 1;
}

/* Why is the ground no finer here? Asked in the terms of the quality, not of the client's
 * selection. */
static enum sim_audit_cause cause_of(const frame *of, const ff_drawn *drawn, double error_px)
{
    const sim_auditor *auditor = of->auditor;
    const ff_quality *quality = &of->view->quality;
    const ff_terrain_info *info = sim_mesh_info(&auditor->mesh, drawn);
    uint32_t next = ff_key_level(drawn->key) + 1;
    double edge_m = (double)drawn->cell_wu * (1u << info->node_log2) / FF_WU_PER_METRE;
    double times = coarse_times(of, info, drawn);
    int splits = error_px > times * quality->error_px_q8 / 256.0;
    if (quality->measure == FF_MEASURE_DISTANCE) {
        double middle_m[3], d[3];
        sim_place_middle(info, drawn, middle_m);
        sim_place_lift(auditor->ground, of->e.pos_m, middle_m,
                       sim_ground_height_m(auditor->ground, middle_m[0], middle_m[1]), middle_m);
        for (int i = 0; i < 3; i++) d[i] = middle_m[i] - of->e.pos_m[i];
        splits = times * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) <
                 edge_m * quality->c_q8 / 256.0;
    }
    if (!splits || next >= ff_terrain_levels(info)) return SIM_CAUSE_QUALITY;
    if (quality->depth_max && next >= quality->depth_max) return SIM_CAUSE_DEPTH;
    return drawn->stub ? SIM_CAUSE_STUB : SIM_CAUSE_WAITING;
}

/* The direction in which the panorama shows a point, and where on its cube: 1, or 0 when it does
 * not. */
static int panorama_direction(const frame *of, const double point_m[3], double direction[3],
                              sim_cube_place *place)
{
    const sim_panorama *panorama = &of->view->panorama;
    if (!of->view->faces) return 0;
    sim_place_seen_from(of->auditor->ground, panorama->pos_wu, of->e.pos_m, point_m, direction);
    sim_cube_meet(direction, panorama->face_size, place);
    double reach_wu = place->reach * FF_WU_PER_METRE;
    return (of->view->faces >> place->face & 1u) && reach_wu >= panorama->front_wu &&
           reach_wu <= panorama->back_wu;
}

static double most_px(const sim_eye *e) { return hypot(e->centre_px[0], e->centre_px[1]) * 2; }

/* How far two places on the cube lie apart in the picture. */
static double apart_px(const sim_eye *e, unsigned size, const sim_cube_place place[2])
{
    double direction[3], pixel[2][2];
    for (int i = 0; i < 2; i++) {
        sim_cube_direction(&place[i], size, direction);
        if (!sim_eye_project(e, direction, pixel[i])) return most_px(e);
    }
    return hypot(pixel[1][0] - pixel[0][0], pixel[1][1] - pixel[0][1]);
}

/* Half of what a texel of the face measures in the picture, its longer way. */
static double half_texel_px(const sim_eye *e, unsigned size, const sim_cube_place *at)
{
    sim_cube_place wide[2] = { *at, *at }, high[2] = { *at, *at };
    wide[0].column -= 0.5;
    wide[1].column += 0.5;
    high[0].row -= 0.5;
    high[1].row += 0.5;
    return fmax(apart_px(e, size, wide), apart_px(e, size, high)) / 2;
}

/* ---- a pixel ---- */

/* A pixel of the grid: what it truly shows and what is drawn there. */
typedef struct look {
    double pixel[2], error_px;
    int ground, drawn;    /* it truly shows ground; and that is drawn, somewhere */
    int filled;           /* it truly shows ground that was void in the source */
    int seam;             /* it truly shows ground near another one's */
    const ff_drawn *node; /* that draws the ground there, or NULL */
    int wrong;            /* it has an error: it truly shows ground, or shows ground over the sky */
    enum sim_audit_cause cause;
} look;

/* The true ground a pixel shows: 1 and the point, or 0. */
static int true_point(const frame *of, const double pixel[2], double point_m[3])
{
    const sim_ground *ground = of->auditor->ground;
    const sim_eye *e = &of->e;
    double along[3], t, reach_m = sim_ground_reach_m(ground);
    sim_eye_ray(e, pixel, along);
    if (!sim_ground_cast(ground, e->pos_m, along, reach_m, &t) || t <= NEAREST_M) return 0;
    for (int i = 0; i < 3; i++) point_m[i] = e->pos_m[i] + t * along[i];
    return 1;
}

static int truth_shows(void *context, const double pixel[2])
{
    double point_m[3];
    return true_point(context, pixel, point_m);
}

/* Asks the faces held about a pixel. */
static int ask_faces(const frame *of, const double pixel[2],
                     int (*question)(sim_faces *faces, const double direction[3]))
{
    sim_faces *faces = &of->auditor->faces;
    sim_cube_place place;
    double along[3];
    if (!of->view->faces) return 0;
    sim_eye_ray(&of->e, pixel, along);
    sim_cube_meet(along, faces->of.face_size, &place);
    return (of->view->faces >> place.face & 1u) && question(faces, along);
}

static int panorama_reaches(void *context, const double pixel[2])
{
    return ask_faces(context, pixel, sim_faces_reach);
}

/* Looks at one pixel; where ground is not drawn the error is left for later. */
static void look_at(const frame *of, look *at)
{
    double point_m[3], shown[3], shown_px[2], z_m, most = most_px(&of->e);
    sim_cube_place place;
    at->drawn = 0;
    at->wrong = at->ground = true_point(of, at->pixel, point_m);
    if (!at->ground) return;
    at->filled = sim_ground_filled(of->auditor->ground, point_m[0], point_m[1]);
    at->seam = sim_ground_near_border(of->auditor->ground, point_m[0], point_m[1], SIM_SEAM_CELLS);
    const ff_drawn *node = drawn_at(of->auditor, of->view->drawn, of->view->drawn_count, point_m,
                                    &z_m);
    at->node = node;
    if (node) {
        sim_place_lift(of->auditor->ground, of->e.pos_m, point_m, z_m, shown);
        for (int i = 0; i < 3; i++) shown[i] -= of->e.pos_m[i];
    } else if (!panorama_direction(of, point_m, shown, &place)) {
        at->cause = SIM_CAUSE_UNDRAWN;
        return;
    }
    at->drawn = 1;
    at->error_px = most; /* the point is shown behind the eye: as wrong as the picture is large */
    if (sim_eye_project(&of->e, shown, shown_px))
        at->error_px = hypot(shown_px[0] - at->pixel[0], shown_px[1] - at->pixel[1]);
    if (!node) at->error_px += half_texel_px(&of->e, of->view->panorama.face_size, &place);
    at->error_px = fmin(at->error_px, most);
    at->cause = node ? cause_of(of, node, at->error_px) : SIM_CAUSE_PANORAMA;
}

/* The error of ground that is not drawn: how far the drawn ground's edge is. The edge is found by
 * halving the way to the nearest pixel that shows drawn ground. */
static double undrawn_error(const frame *of, const look *at)
{
    double nearest = most_px(&of->e), low = 0, high = 1;
    const look *other = NULL;
    for (size_t i = 0; i < of->looks; i++) {
        const look *there = &of->auditor->look[i];
        double distance = hypot(there->pixel[0] - at->pixel[0], there->pixel[1] - at->pixel[1]);
        if (there->drawn && distance < nearest) {
            nearest = distance;
            other = there;
        }
    }
    while (other && (high - low) * nearest > EDGE_PX) {
        double middle = (low + high) / 2;
        look between = { .pixel = { at->pixel[0] + middle * (other->pixel[0] - at->pixel[0]),
                                    at->pixel[1] + middle * (other->pixel[1] - at->pixel[1]) } };
        look_at(of, &between);
        if (between.drawn)
            high = middle;
        else
            low = middle;
    }
    return high * nearest;
}

/* The error of ground drawn over the sky: how far the true ground is, by the true skyline and by
 * the pixels that show it. */
static double sky_error(const frame *of, const look *at)
{
    const sim_auditor *auditor = of->auditor;
    const c3d_camera *camera = &of->view->camera;
    double nearest = most_px(&of->e);
    for (unsigned i = 0; i < camera->width; i++)
        if (auditor->true_px[i] < camera->height)
            nearest = fmin(nearest,
                           hypot(i + 0.5 - at->pixel[0], auditor->true_px[i] - at->pixel[1]));
    for (size_t i = 0; i < of->looks; i++)
        if (auditor->look[i].ground)
            nearest = fmin(nearest, hypot(auditor->look[i].pixel[0] - at->pixel[0],
                                          auditor->look[i].pixel[1] - at->pixel[1]));
    return fmax(nearest, SIM_SKYLINE_PX);
}

/* ---- a frame ---- */

static int make_room(sim_auditor *auditor, size_t looks, size_t columns)
{
    if (looks <= auditor->looks && columns <= auditor->columns) return FF_OK;
    free_room(auditor);
    auditor->look = malloc(looks * sizeof *auditor->look);
    auditor->error = malloc((looks + columns) * sizeof *auditor->error);
    auditor->true_px = malloc(columns * sizeof *auditor->true_px);
    auditor->drawn_px = malloc(columns * sizeof *auditor->drawn_px);
    auditor->hint_px = malloc((columns + 1) * sizeof *auditor->hint_px);
    auditor->looks = auditor->columns = 0;
    if (!auditor->look || !auditor->error || !auditor->true_px || !auditor->drawn_px ||
        !auditor->hint_px)
        return FF_ERR_MEMORY;
    auditor->looks = looks;
    auditor->columns = columns;
    return FF_OK;
}

static void look_at_all(frame *of)
{
    const c3d_camera *camera = &of->view->camera;
    unsigned step = of->auditor->step_px;
    of->looks = 0;
    for (unsigned y = step / 2; y < camera->height; y += step)
        for (unsigned x = step / 2; x < camera->width; x += step) {
            look *at = &of->auditor->look[of->looks++];
            *at = (look){ .pixel = { x + 0.5, y + 0.5 } };
            look_at(of, at);
        }
}

/* Finds the true skyline, or the panorama's. */
static void find_skyline(frame *of, int truth, double *top_px)
{
    sim_auditor *auditor = of->auditor;
    const c3d_camera *camera = &of->view->camera;
    unsigned across = sim_looked_at(camera->width, auditor->step_px);
    for (unsigned i = 0; i <= camera->width / auditor->step_px; i++)
        auditor->hint_px[i] = camera->height;
    for (size_t i = 0; i < of->looks; i++) {
        const look *at = &auditor->look[i];
        double *hint = &auditor->hint_px[i % across];
        if (at->pixel[1] < *hint && (truth ? at->ground : panorama_reaches(of, at->pixel)))
            *hint = at->pixel[1];
    }
    sim_skyline_find(&(sim_skyline){ .width = camera->width,
                                     .height = camera->height,
                                     .step_px = auditor->step_px,
                                     .shows = truth ? truth_shows : panorama_reaches,
                                     .context = of,
                                     .hint_px = auditor->hint_px },
                     top_px);
}

/* The two skylines, true_px and drawn_px. */
static void find_skylines(frame *of)
{
    sim_auditor *auditor = of->auditor;
    unsigned width = of->view->camera.width;
    find_skyline(of, 1, auditor->true_px);
    if (!of->view->faces) {
        memcpy(auditor->drawn_px, auditor->cover.top_px, width * sizeof *auditor->drawn_px);
        return;
    }
    find_skyline(of, 0, auditor->drawn_px);
    for (unsigned i = 0; i < width; i++)
        auditor->drawn_px[i] = fmin(auditor->drawn_px[i], auditor->cover.top_px[i]);
}

/* 1 when the sky shows through between drawn ground and drawn ground: none is drawn at pixel i, but
 * some above it. */
static int is_gap(const frame *of, size_t i)
{
    const sim_auditor *auditor = of->auditor;
    const look *at = &auditor->look[i];
    return at->node && !auditor->cover.node[i] &&
           auditor->cover.top_px[(unsigned)at->pixel[0]] < at->pixel[1] &&
           !ask_faces(of, at->pixel, sim_faces_show);
}

/* The errors that hang on other pixels: ground not drawn, and ground drawn over the sky. */
static void look_around(frame *of)
{
    sim_auditor *auditor = of->auditor;
    for (size_t i = 0; auditor->mesh.grounds > 1 && i < of->looks; i++)
        if (is_gap(of, i)) auditor->look[i].cause = SIM_CAUSE_UNDRAWN;
    for (size_t i = 0; i < of->looks; i++) {
        look *at = &auditor->look[i];
        uint32_t node = auditor->cover.node[i];
        if (at->ground && !at->drawn) at->error_px = undrawn_error(of, at);
        if (at->ground || (!node && !ask_faces(of, at->pixel, sim_faces_show))) continue;
        at->wrong = 1;
        at->error_px = sky_error(of, at);
        at->cause = !node ? SIM_CAUSE_PANORAMA
                    : node == SIM_COVER_FIN
                        ? SIM_CAUSE_FAR
                        : cause_of(of, &of->view->drawn[node - 1], at->error_px);
    }
}

/* The errors near borders, by way of auditor->error. */
static void summarise_seam(const frame *of, sim_audit_result *result)
{
    sim_auditor *auditor = of->auditor;
    size_t count = 0;
    for (size_t i = 0; i < of->looks; i++)
        if (auditor->look[i].wrong && auditor->look[i].seam)
            auditor->error[count++] = auditor->look[i].error_px;
    sim_spread seam = sim_spread_of(auditor->error, count);
    result->seam_pixels = (uint32_t)count;
    result->seam_px_p95 = seam.p95;
    result->seam_px_max = seam.max;
}

static void summarise(const frame *of, sim_audit_result *result)
{
    sim_auditor *auditor = of->auditor;
    const c3d_camera *camera = &of->view->camera;
    size_t count = 0, filled = 0;
    for (size_t i = 0; i < of->looks; i++) {
        const look *at = &auditor->look[i];
        if (!at->wrong) continue;
        auditor->error[count++] = at->error_px;
        result->square_px[at->cause] += at->error_px * at->error_px;
        result->sky_pixels += !at->ground;
        filled += at->ground && at->filled;
        result->undrawn_pixels += at->cause == SIM_CAUSE_UNDRAWN;
        result->panorama_pixels += at->ground && at->cause == SIM_CAUSE_PANORAMA;
        if (at->node && at->cause != SIM_CAUSE_UNDRAWN)
            result->drawn_pixels[sim_mesh_ground(&auditor->mesh, at->node)]++;
    }
    result->ground_pixels = (uint32_t)count - result->undrawn_pixels - result->panorama_pixels -
                            result->sky_pixels;
    for (int cause = 0; cause < SIM_CAUSES && count; cause++)
        result->square_px[cause] /= (double)count;
    if (count > result->sky_pixels) {
        double ground = (double)(count - result->sky_pixels);
        result->undrawn_percent = 100.0 * result->undrawn_pixels / ground;
        result->filled_percent = 100.0 * (double)filled / ground;
    }
    sim_spread all = sim_spread_of(auditor->error, count);
    count = sim_skyline_compare(auditor->true_px, auditor->drawn_px, camera->width, camera->height,
                                auditor->error);
    result->skyline_columns = (uint32_t)count;
    sim_spread skyline = sim_spread_of(auditor->error, count);
    result->err_px_rms = all.rms;
    result->err_px_p95 = all.p95;
    result->err_px_max = all.max;
    result->skyline_px_rms = skyline.rms;
    result->skyline_px_p95 = skyline.p95;
    result->skyline_px_max = skyline.max;
}

int sim_audit_frame(sim_auditor *auditor, const sim_audit_view *view, sim_audit_result *result)
{
    const c3d_camera *camera = &view->camera;
    frame of = { .auditor = auditor, .view = view };
    memset(result, 0, sizeof *result);
    sim_mesh_use(&auditor->mesh, &view->grounds);
    int rc = make_room(auditor,
                       (size_t)sim_looked_at(camera->width, auditor->step_px) *
                           sim_looked_at(camera->height, auditor->step_px),
                       camera->width);
    if (rc == FF_OK)
        rc = sim_cover_make(&auditor->cover, &auditor->mesh, camera, auditor->step_px, view->drawn,
                            view->drawn_count);
    if (rc != FF_OK) return rc;
    sim_cover_fins(&auditor->cover, camera, &view->fins);
    sim_eye_of(camera, &of.e);
    if (view->faces) sim_faces_use(&auditor->faces, &view->panorama);
    look_at_all(&of);
    find_skylines(&of);
    look_around(&of);
    summarise(&of, result);
    summarise_seam(&of, result);
    return FF_OK;
}
