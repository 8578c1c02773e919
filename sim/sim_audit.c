#include "sim_audit.h"

#include "../client/terrain/ff_strips.h"
#include "../protocol/ff_message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define NEAREST_M 0.01 /* points nearer to the eye plane have no pixel */

typedef struct triangles { uint32_t count; uint16_t (*vertex)[3]; } triangles;

struct sim_auditor {
    const sim_ground *ground;
    ff_terrain_info info;
    unsigned step_px;
    triangles strip[32];      /* by strip id, degenerate ones left out */
    double *error;            /* of one frame */
    size_t error_capacity;
};

/* ---- strips as triangles ---- */

static int unpack_strip(triangles *out, const uint16_t *index, uint32_t length)
{
    out->vertex = malloc((length + 1u) * sizeof *out->vertex);
    if (!out->vertex)
        return FF_ERR_MEMORY;
    for (uint32_t i = 0; i + 2 < length; i++) {
        uint16_t a = index[i], b = index[i + 1], c = index[i + 2];
        if (a == b || b == c || a == c)
            continue;
        out->vertex[out->count][0] = a;
        out->vertex[out->count][1] = b;
        out->vertex[out->count++][2] = c;
    }
    return FF_OK;
}

sim_auditor *sim_auditor_create(const sim_ground *ground, const ff_terrain_info *info, unsigned step_px)
{
    sim_auditor *auditor = calloc(1, sizeof *auditor);
    ff_strips *strips = malloc(sizeof *strips);
    int rc = auditor && strips ? ff_strips_make(strips, info->node_log2) : FF_ERR_MEMORY;
    if (rc == FF_OK) {
        auditor->ground = ground;
        auditor->info = *info;
        auditor->step_px = step_px;
        for (uint32_t i = 0; rc == FF_OK && i < strips->count; i++)
            rc = unpack_strip(&auditor->strip[i], strips->index + strips->first[i], strips->length[i]);
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
    if (!auditor)
        return;
    for (size_t i = 0; i < sizeof auditor->strip / sizeof auditor->strip[0]; i++)
        free(auditor->strip[i].vertex);
    free(auditor->error);
    free(auditor);
}

/* ---- projection ---- */

typedef struct eye { double pos_m[3], right[3], up[3], forward[3], focal_px, centre_px[2]; } eye;

static void eye_of(const c3d_camera *camera, eye *e)
{
    double yaw = camera->yaw * (PI / 32768), pitch = camera->pitch * (PI / 32768), roll = camera->roll * (PI / 32768);
    double level_right[3] = { cos(yaw), -sin(yaw), 0 };
    double level_up[3] = { -sin(yaw) * sin(pitch), -cos(yaw) * sin(pitch), cos(pitch) };
    e->forward[0] = sin(yaw) * cos(pitch);
    e->forward[1] = cos(yaw) * cos(pitch);
    e->forward[2] = sin(pitch);
    for (int i = 0; i < 3; i++) { /* roll clockwise: the right hand sinks */
        e->pos_m[i] = (double)camera->pos_wu[i] / FF_WU_PER_METRE;
        e->right[i] = level_right[i] * cos(roll) - level_up[i] * sin(roll);
        e->up[i] = level_up[i] * cos(roll) + level_right[i] * sin(roll);
    }
    e->focal_px = camera->focal_q8 / 256.0;
    e->centre_px[0] = camera->width / 2.0;
    e->centre_px[1] = camera->height / 2.0;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Pixel of a direction from the eye. */
static int project_direction(const eye *e, const double direction[3], double pixel[2])
{
    double depth = dot(direction, e->forward);
    if (depth < NEAREST_M)
        return 0;
    pixel[0] = e->centre_px[0] + dot(direction, e->right) * e->focal_px / depth;
    pixel[1] = e->centre_px[1] - dot(direction, e->up) * e->focal_px / depth;
    return 1;
}

int sim_audit_project(const c3d_camera *camera, const double point_m[3], double pixel[2])
{
    eye e;
    eye_of(camera, &e);
    const double direction[3] = { point_m[0] - e.pos_m[0], point_m[1] - e.pos_m[1], point_m[2] - e.pos_m[2] };
    return project_direction(&e, direction, pixel);
}

/* ---- what the client draws ---- */

static double vertex_height_m(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t index)
{
    return auditor->ground->hoffset_m + auditor->ground->hscale_m * drawn->heights[index];
}

/* Height of triangle (a, b, c) of a node at (x, y) in its cells: 1 and *z_m, or 0 outside. */
static int triangle_height(const sim_auditor *auditor, const ff_drawn *drawn, const uint16_t vertex[3], double x, double y, double *z_m)
{
    uint32_t side = ff_node_side(&auditor->info);
    double at[3][2], z[3];
    for (int i = 0; i < 3; i++) {
        at[i][0] = vertex[i] % side;
        at[i][1] = vertex[i] / side;
    }
    double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
    double b = ((x - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (y - at[0][1])) / area;
    double c = ((at[1][0] - at[0][0]) * (y - at[0][1]) - (x - at[0][0]) * (at[1][1] - at[0][1])) / area;
    if (!(b >= -1e-9 && c >= -1e-9 && b + c <= 1 + 1e-9))
        return 0;
    for (int i = 0; i < 3; i++)
        z[i] = vertex_height_m(auditor, drawn, vertex[i]);
    *z_m = z[0] + b * (z[1] - z[0]) + c * (z[2] - z[0]);
    return 1;
}

static int node_height(const sim_auditor *auditor, const ff_drawn *drawn, double x, double y, double *z_m)
{
    uint8_t strip[5];
    unsigned count = ff_strips_for(drawn->coarser, strip);
    for (unsigned i = 0; i < count; i++) {
        const triangles *list = &auditor->strip[strip[i]];
        for (uint32_t j = 0; j < list->count; j++)
            if (triangle_height(auditor, drawn, list->vertex[j], x, y, z_m))
                return 1;
    }
    return 0;
}

int sim_audit_drawn_height(const sim_auditor *auditor, const ff_drawn *drawn, uint32_t count, double x_m, double y_m, double *z_m)
{
    double side = (double)(1u << auditor->info.node_log2);
    for (uint32_t i = 0; i < count; i++) {
        double cell_m = (double)drawn[i].cell_wu / FF_WU_PER_METRE;
        double x = (x_m - (double)drawn[i].origin_wu[0] / FF_WU_PER_METRE) / cell_m;
        double y = (y_m - (double)drawn[i].origin_wu[1] / FF_WU_PER_METRE) / cell_m;
        if (x >= 0 && y >= 0 && x <= side && y <= side && node_height(auditor, &drawn[i], x, y, z_m))
            return 1;
    }
    return 0;
}

/* The direction in which the panorama shows a point: 1, or 0 when it does not. */
static int panorama_direction(const sim_audit_view *view, const double point_m[3], double direction[3])
{
    static const enum ff_face_name positive[3] = { FF_FACE_EAST, FF_FACE_NORTH, FF_FACE_UP };
    static const enum ff_face_name negative[3] = { FF_FACE_WEST, FF_FACE_SOUTH, FF_FACE_DOWN };
    int axis = 0;
    if (!view->panorama)
        return 0;
    for (int i = 0; i < 3; i++) {
        direction[i] = point_m[i] - (double)view->panorama_pos_wu[i] / FF_WU_PER_METRE;
        if (fabs(direction[i]) > fabs(direction[axis]))
            axis = i;
    }
    double reach_wu = fabs(direction[axis]) * FF_WU_PER_METRE;
    enum ff_face_name face = direction[axis] > 0 ? positive[axis] : negative[axis];
    return (view->faces >> face & 1u) && reach_wu >= view->front_wu && reach_wu <= view->back_wu;
}

/* ---- a frame ---- */

/* Error of a pixel, or -1 when nothing is drawn there. */
static double pixel_error(const sim_auditor *auditor, const sim_audit_view *view, const eye *e, const double pixel[2],
                          const double point_m[3], sim_audit_result *result)
{
    double shown[3], shown_px[2], z_m, most = hypot(e->centre_px[0], e->centre_px[1]) * 2;
    if (sim_audit_drawn_height(auditor, view->drawn, view->drawn_count, point_m[0], point_m[1], &z_m)) {
        result->ground_pixels++;
        for (int i = 0; i < 3; i++)
            shown[i] = (i == 2 ? z_m : point_m[i]) - e->pos_m[i];
    } else if (panorama_direction(view, point_m, shown)) {
        result->panorama_pixels++;
    } else {
        result->undrawn_pixels++;
        return -1;
    }
    if (!project_direction(e, shown, shown_px))
        return most; /* shown behind the eye: as wrong as the picture is large */
    return fmin(most, hypot(shown_px[0] - pixel[0], shown_px[1] - pixel[1]));
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void summarise(double *error, size_t count, sim_audit_result *result)
{
    uint32_t all = result->ground_pixels + result->panorama_pixels + result->undrawn_pixels;
    double sum = 0;
    result->undrawn_percent = all ? 100.0 * result->undrawn_pixels / all : 0;
    if (!count)
        return;
    qsort(error, count, sizeof *error, by_value);
    for (size_t i = 0; i < count; i++)
        sum += error[i] * error[i];
    result->err_px_rms = sqrt(sum / (double)count);
    result->err_px_p95 = error[(count - 1) * 95 / 100];
    result->err_px_max = error[count - 1];
}

int sim_audit_frame(sim_auditor *auditor, const sim_audit_view *view, sim_audit_result *result)
{
    const c3d_camera *camera = &view->camera;
    unsigned step = auditor->step_px;
    size_t most = ((size_t)camera->width / step + 1) * ((size_t)camera->height / step + 1), count = 0;
    eye e;
    eye_of(camera, &e);
    memset(result, 0, sizeof *result);
    if (most > auditor->error_capacity) {
        double *grown = realloc(auditor->error, most * sizeof *grown);
        if (!grown)
            return FF_ERR_MEMORY;
        auditor->error = grown;
        auditor->error_capacity = most;
    }
    double reach_m = 4.0 * auditor->ground->cell_m * ((double)auditor->ground->columns + auditor->ground->rows);
    for (unsigned y = step / 2; y < camera->height; y += step)
        for (unsigned x = step / 2; x < camera->width; x += step) {
            double pixel[2] = { x + 0.5, y + 0.5 }, along[3], point_m[3], t;
            for (int i = 0; i < 3; i++)
                along[i] = e.forward[i] + e.right[i] * (pixel[0] - e.centre_px[0]) / e.focal_px
                         + e.up[i] * (e.centre_px[1] - pixel[1]) / e.focal_px;
            if (!sim_ground_cast(auditor->ground, e.pos_m, along, reach_m, &t) || t <= NEAREST_M)
                continue;
            for (int i = 0; i < 3; i++)
                point_m[i] = e.pos_m[i] + t * along[i];
            double error = pixel_error(auditor, view, &e, pixel, point_m, result);
            if (error >= 0)
                auditor->error[count++] = error;
        }
    summarise(auditor->error, count, result);
    return FF_OK;
}
