#include "sim_audit.h"

#include "../../client/terrain/ff_strips.h"
#include "../../protocol/message/ff_message.h"
#include "sim_eye.h"
#include "sim_place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEAREST_M 0.01 /* points nearer to the eye have no pixel */
#define EDGE_PX   0.5  /* how exactly the drawn ground's edge is found */

typedef struct triangles {
    uint32_t count;
    uint16_t (*vertex)[3];
} triangles;

struct sim_auditor {
    const sim_ground *ground;
    ff_terrain_info info;
    unsigned step_px;
    triangles strip[32]; /* by strip id, degenerate ones left out */
    double *error;       /* of one frame */
    struct look *look;
    size_t capacity; /* of both */
};

/* ---- strips as triangles ---- */

static int unpack_strip(triangles *out, const uint16_t *index, uint32_t length)
{
    out->vertex = malloc((length + 1u) * sizeof *out->vertex);
    if (!out->vertex) return FF_ERR_MEMORY;
    for (uint32_t i = 0; i + 2 < length; i++) {
        uint16_t a = index[i], b = index[i + 1], c = index[i + 2];
        if (a == b || b == c || a == c) continue;
        out->vertex[out->count][0] = a;
        out->vertex[out->count][1] = b;
        out->vertex[out->count++][2] = c;
    }
    return FF_OK;
}

sim_auditor *sim_auditor_create(const sim_ground *ground, const ff_terrain_info *info,
                                unsigned step_px)
{
    sim_auditor *auditor = calloc(1, sizeof *auditor);
    ff_strips *strips = malloc(sizeof *strips);
    int rc = auditor && strips ? ff_strips_make(strips, info->node_log2) : FF_ERR_MEMORY;
    if (rc == FF_OK) {
        auditor->ground = ground;
        auditor->info = *info;
        auditor->step_px = step_px;
        for (uint32_t i = 0; rc == FF_OK && i < strips->count; i++)
            rc = unpack_strip(&auditor->strip[i], strips->index + strips->first[i],
                              strips->length[i]);
    }
    free(strips);
    if (rc != FF_OK) {
        sim_auditor_destroy(auditor);
        return NULL;
    }
    return auditor;
}

void sim_auditor_destroy(sim_auditor *auditor)
{
    if (!auditor) return;
    for (size_t i = 0; i < sizeof auditor->strip / sizeof auditor->strip[0]; i++)
        free(auditor->strip[i].vertex);
    free(auditor->error);
    free(auditor->look);
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

static double vertex_height_m(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t index)
{
    return auditor->ground->hoffset_m + auditor->ground->hscale_m * drawn->heights[index];
}

/* Height of a node's triangle at (x, y), counted in the node's cells, the last ones at `last`: 1
 * and *z_m, or 0 outside. */
static int triangle_height(const sim_auditor *auditor, const ff_drawn *drawn,
                           const uint16_t vertex[3], const double last[2], double x, double y,
                           double *z_m)
{
    uint32_t side = ff_node_side(&auditor->info);
    double at[3][2], z[3];
    for (int i = 0; i < 3; i++) {
        at[i][0] = fmin(vertex[i] % side, last[0]);
        at[i][1] = fmin(vertex[i] / side, last[1]);
    }
    double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                  (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
    if (area == 0) return 0; /* of padding */
    double b = ((x - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (y - at[0][1])) /
               area;
    double c = ((at[1][0] - at[0][0]) * (y - at[0][1]) - (x - at[0][0]) * (at[1][1] - at[0][1])) /
               area;
    if (!(b >= -1e-9 && c >= -1e-9 && b + c <= 1 + 1e-9)) return 0;
    for (int i = 0; i < 3; i++) z[i] = vertex_height_m(auditor, drawn, vertex[i]);
    *z_m = z[0] + b * (z[1] - z[0]) + c * (z[2] - z[0]);
    return 1;
}

static int node_height(const sim_auditor *auditor, const ff_drawn *drawn, double x, double y,
                       double *z_m)
{
    uint8_t strip[5];
    unsigned count = ff_strips_for(drawn->coarser, strip);
    double last[2];
    sim_place_last(&auditor->info, drawn, last);
    for (unsigned i = 0; i < count; i++) {
        const triangles *list = &auditor->strip[strip[i]];
        for (uint32_t j = 0; j < list->count; j++)
            if (triangle_height(auditor, drawn, list->vertex[j], last, x, y, z_m)) return 1;
    }
    return 0;
}

/* The node drawn over or under a point and its height there, or NULL. */
static const ff_drawn *drawn_at(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t count,
                                const double point_m[3], double *z_m)
{
    double cell[2];
    for (uint32_t i = 0; i < count; i++)
        if (sim_place_in_node(&auditor->info, &drawn[i], point_m, cell) &&
            node_height(auditor, &drawn[i], cell[0], cell[1], z_m))
            return &drawn[i];
    return NULL;
}

int sim_audit_drawn_height(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t count,
                           double x_m, double y_m, double *z_m)
{
    const double point_m[3] = { x_m, y_m, 0 };
    return drawn_at(auditor, drawn, count, point_m, z_m) != NULL;
}

/* Why is the ground no finer here? Asked in the terms of the quality, not of the client's
 * selection. */
static enum sim_audit_cause cause_of(const sim_auditor *auditor, const sim_audit_view *view,
                                     const sim_eye *e, const ff_drawn *drawn, double error_px)
{
    const ff_quality *quality = &view->quality;
    uint32_t next = ff_key_level(drawn->key) + 1;
    double edge_m = (double)drawn->cell_wu * (1u << auditor->info.node_log2) / FF_WU_PER_METRE;
    int splits = error_px > quality->error_px_q8 / 256.0;
    if (quality->measure == FF_MEASURE_DISTANCE) {
        double middle_m[3], d[3];
        sim_place_middle(&auditor->info, drawn, middle_m);
        sim_place_lift(auditor->ground, e->pos_m, middle_m,
                       sim_ground_height_m(auditor->ground, middle_m[0], middle_m[1]), middle_m);
        for (int i = 0; i < 3; i++) d[i] = middle_m[i] - e->pos_m[i];
        splits = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) < edge_m * quality->c_q8 / 256.0;
    }
    if (!splits || next >= ff_terrain_levels(&auditor->info)) return SIM_CAUSE_QUALITY;
    return quality->depth_max && next >= quality->depth_max ? SIM_CAUSE_DEPTH : SIM_CAUSE_WAITING;
}

/* The direction in which the panorama shows a point: 1, or 0 when it does not. */
static int panorama_direction(const sim_auditor *auditor, const sim_audit_view *view,
                              const sim_eye *e, const double point_m[3], double direction[3])
{
    static const enum ff_face_name positive[3] = { FF_FACE_EAST, FF_FACE_NORTH, FF_FACE_UP };
    static const enum ff_face_name negative[3] = { FF_FACE_WEST, FF_FACE_SOUTH, FF_FACE_DOWN };
    int axis = 0;
    if (!view->panorama) return 0;
    sim_place_seen_from(auditor->ground, view->panorama_pos_wu, e->pos_m, point_m, direction);
    for (int i = 1; i < 3; i++)
        if (fabs(direction[i]) > fabs(direction[axis])) axis = i;
    double reach_wu = fabs(direction[axis]) * FF_WU_PER_METRE;
    enum ff_face_name face = direction[axis] > 0 ? positive[axis] : negative[axis];
    return (view->faces >> face & 1u) && reach_wu >= view->front_wu && reach_wu <= view->back_wu;
}

/* ---- a frame ---- */

/* A pixel of the grid: what it truly shows and what is drawn there. */
typedef struct look {
    double pixel[2], error_px;
    int ground, drawn;
    enum sim_audit_cause cause;
} look;

/* The true ground a pixel shows: 1 and the point, or 0. */
static int true_point(const sim_auditor *auditor, const sim_eye *e, const double pixel[2],
                      double point_m[3])
{
    double along[3], t,
        reach_m = 4.0 * auditor->ground->cell_m *
                  ((double)auditor->ground->columns + auditor->ground->rows);
    sim_eye_ray(e, pixel, along);
    if (!sim_ground_cast(auditor->ground, e->pos_m, along, reach_m, &t) || t <= NEAREST_M) return 0;
    for (int i = 0; i < 3; i++) point_m[i] = e->pos_m[i] + t * along[i];
    return 1;
}

/* Looks at one pixel; where nothing is drawn the error is left for later. */
static void look_at(const sim_auditor *auditor, const sim_audit_view *view, const sim_eye *e,
                    look *at)
{
    double point_m[3], shown[3], shown_px[2], z_m,
        most = hypot(e->centre_px[0], e->centre_px[1]) * 2;
    at->drawn = 0;
    at->ground = true_point(auditor, e, at->pixel, point_m);
    if (!at->ground) return;
    const ff_drawn *node = drawn_at(auditor, view->drawn, view->drawn_count, point_m, &z_m);
    if (node) {
        sim_place_lift(auditor->ground, e->pos_m, point_m, z_m, shown);
        for (int i = 0; i < 3; i++) shown[i] -= e->pos_m[i];
    } else if (!panorama_direction(auditor, view, e, point_m, shown)) {
        at->cause = SIM_CAUSE_UNDRAWN;
        return;
    }
    at->drawn = 1;
    at->error_px = most; /* the point is shown behind the eye: as wrong as the picture is large */
    if (sim_eye_project(e, shown, shown_px))
        at->error_px = fmin(most, hypot(shown_px[0] - at->pixel[0], shown_px[1] - at->pixel[1]));
    at->cause = node ? cause_of(auditor, view, e, node, at->error_px) : SIM_CAUSE_PANORAMA;
}

/* The error of ground that is not drawn: how far the drawn ground's edge is. The edge is found by
 * halving the way to the nearest pixel that shows drawn ground. */
static double undrawn_error(const sim_auditor *auditor, const sim_audit_view *view,
                            const sim_eye *e, const look *list, size_t count, const look *at)
{
    double nearest = hypot(e->centre_px[0], e->centre_px[1]) * 2, low = 0, high = 1;
    const look *other = NULL;
    for (size_t i = 0; i < count; i++) {
        double distance = hypot(list[i].pixel[0] - at->pixel[0], list[i].pixel[1] - at->pixel[1]);
        if (list[i].drawn && distance < nearest) {
            nearest = distance;
            other = &list[i];
        }
    }
    while (other && (high - low) * nearest > EDGE_PX) {
        double middle = (low + high) / 2;
        look between = { .pixel = { at->pixel[0] + middle * (other->pixel[0] - at->pixel[0]),
                                    at->pixel[1] + middle * (other->pixel[1] - at->pixel[1]) } };
        look_at(auditor, view, e, &between);
        if (between.drawn)
            high = middle;
        else
            low = middle;
    }
    return high * nearest;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void summarise(const look *list, size_t looks, double *error, sim_audit_result *result)
{
    size_t count = 0;
    double sum = 0;
    for (size_t i = 0; i < looks; i++) {
        if (!list[i].ground) continue;
        error[count++] = list[i].error_px;
        sum += list[i].error_px * list[i].error_px;
        result->square_px[list[i].cause] += list[i].error_px * list[i].error_px;
        result->undrawn_pixels += list[i].cause == SIM_CAUSE_UNDRAWN;
        result->panorama_pixels += list[i].cause == SIM_CAUSE_PANORAMA;
    }
    result->ground_pixels = (uint32_t)count - result->undrawn_pixels - result->panorama_pixels;
    if (!count) return;
    qsort(error, count, sizeof *error, by_value);
    for (int cause = 0; cause < SIM_CAUSES; cause++) result->square_px[cause] /= (double)count;
    result->undrawn_percent = 100.0 * result->undrawn_pixels / (double)count;
    result->err_px_rms = sqrt(sum / (double)count);
    result->err_px_p95 = error[(count - 1) * 95 / 100];
    result->err_px_max = error[count - 1];
}

static int make_room(sim_auditor *auditor, size_t most)
{
    if (most <= auditor->capacity) return FF_OK;
    double *error = realloc(auditor->error, most * sizeof *error);
    if (error) auditor->error = error;
    look *list = realloc(auditor->look, most * sizeof *list);
    if (list) auditor->look = list;
    if (!error || !list) return FF_ERR_MEMORY;
    auditor->capacity = most;
    return FF_OK;
}

int sim_audit_frame(sim_auditor *auditor, const sim_audit_view *view, sim_audit_result *result)
{
    const c3d_camera *camera = &view->camera;
    unsigned step = auditor->step_px;
    size_t count = 0;
    sim_eye e;
    sim_eye_of(camera, &e);
    memset(result, 0, sizeof *result);
    if (make_room(auditor, ((size_t)camera->width / step + 1) *
                               ((size_t)camera->height / step + 1)) != FF_OK)
        return FF_ERR_MEMORY;
    for (unsigned y = step / 2; y < camera->height; y += step)
        for (unsigned x = step / 2; x < camera->width; x += step) {
            look *at = &auditor->look[count++];
            *at = (look){ .pixel = { x + 0.5, y + 0.5 } };
            look_at(auditor, view, &e, at);
        }
    for (size_t i = 0; i < count; i++)
        if (auditor->look[i].ground && !auditor->look[i].drawn)
            auditor->look[i].error_px = undrawn_error(auditor, view, &e, auditor->look, count,
                                                      &auditor->look[i]);
    summarise(auditor->look, count, auditor->error, result);
    return FF_OK;
}
