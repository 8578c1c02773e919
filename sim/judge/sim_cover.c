#include "sim_cover.h"

#include "../../client/terrain/ff_strips.h"
#include "sim_place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEAREST_M   0.01 /* what is nearer to the eye plane has no pixel */
#define CORNERS_MAX 4    /* of a triangle with a corner cut off */

/* ---- memory ---- */

static int make_room(sim_cover *cover, size_t columns, size_t pixels, size_t points)
{
    if (columns <= cover->columns && pixels <= cover->pixels && points <= cover->points)
        return FF_OK;
    sim_cover_free(cover);
    cover->top_px = malloc(columns * sizeof *cover->top_px);
    cover->node = malloc(pixels * sizeof *cover->node);
    cover->closeness = malloc(pixels * sizeof *cover->closeness);
    cover->point = malloc(points * sizeof *cover->point);
    if (!cover->top_px || !cover->node || !cover->closeness || !cover->point) return FF_ERR_MEMORY;
    cover->columns = columns;
    cover->pixels = pixels;
    cover->points = points;
    return FF_OK;
}

/* An empty picture. */
static int begin(sim_cover *cover, const sim_mesh *mesh, const c3d_camera *camera, unsigned step_px)
{
    uint32_t side = ff_node_side(mesh->info);
    size_t pixels = (size_t)sim_looked_at(camera->width, step_px) *
                    sim_looked_at(camera->height, step_px);
    int rc = make_room(cover, camera->width, pixels, side * side);
    if (rc != FF_OK) return rc;
    cover->width = camera->width;
    cover->height = camera->height;
    cover->step_px = step_px;
    for (unsigned i = 0; i < camera->width; i++) cover->top_px[i] = camera->height;
    memset(cover->node, 0, pixels * sizeof *cover->node);
    memset(cover->closeness, 0, pixels * sizeof *cover->closeness);
    return FF_OK;
}

void sim_cover_free(sim_cover *cover)
{
    free(cover->top_px);
    free(cover->node);
    free(cover->closeness);
    free(cover->point);
    memset(cover, 0, sizeof *cover);
}

/* ---- polygons ---- */

/* First and last middle of a pixel within from..to, of `size` pixels: 1, or 0 when there is none.
 */
static int middles(double from, double to, unsigned size, unsigned *first, unsigned *last)
{
    if (!(to >= 0.5 && from <= size - 0.5)) return 0;
    *first = from > 0.5 ? (unsigned)(from - 0.5) : 0;
    *first += *first + 0.5 < from;
    *last = to < size ? (unsigned)(to - 0.5) : size - 1;
    return *first <= *last;
}

/* Where a convex polygon meets the line at x: its upper and lower end, or 0. */
static int cut_at(const sim_corner *list, unsigned count, double x, sim_corner end[2])
{
    int any = 0;
    const sim_corner *a = &list[count - 1], *b = list;
    for (unsigned i = 0; i < count; i++, a = b++) {
        if (a->x == b->x || (a->x < x && b->x < x) || (a->x > x && b->x > x)) continue;
        double t = (x - a->x) / (b->x - a->x);
        sim_corner at = { x, a->y + t * (b->y - a->y),
                          a->closeness + t * (b->closeness - a->closeness) };
        if (!any || at.y < end[0].y) end[0] = at;
        if (!any || at.y > end[1].y) end[1] = at;
        any = 1;
    }
    return any;
}

/* Ground of a node between two ends in a column of pixels. */
static void cover_column(sim_cover *cover, unsigned column, const sim_corner end[2], uint32_t node)
{
    unsigned step = cover->step_px, across = sim_looked_at(cover->width, step), first, last;
    if (end[1].y < 0 || end[0].y >= cover->height) return;
    if (end[0].y < cover->top_px[column]) cover->top_px[column] = end[0].y > 0 ? end[0].y : 0;
    if (column % step != step / 2 || !middles(end[0].y, end[1].y, cover->height, &first, &last))
        return;
    double length = end[1].y - end[0].y,
           slope = length > 0 ? (end[1].closeness - end[0].closeness) / length : 0;
    for (unsigned j = (first + step - 1 - step / 2) / step; j * step + step / 2 <= last; j++) {
        size_t at = (size_t)j * across + column / step;
        double closeness = end[0].closeness + (j * step + step / 2 + 0.5 - end[0].y) * slope;
        if (closeness <= cover->closeness[at]) continue;
        cover->closeness[at] = closeness;
        cover->node[at] = node;
    }
}

static void cover_polygon(sim_cover *cover, const sim_corner *list, unsigned count, uint32_t node)
{
    double left = list[0].x, right = left, top = list[0].y, bottom = top;
    unsigned first, last;
    for (unsigned i = 1; i < count; i++) {
        left = list[i].x < left ? list[i].x : left;
        right = list[i].x > right ? list[i].x : right;
        top = list[i].y < top ? list[i].y : top;
        bottom = list[i].y > bottom ? list[i].y : bottom;
    }
    if (bottom < 0 || top >= cover->height || !middles(left, right, cover->width, &first, &last))
        return;
    for (unsigned column = first; column <= last; column++) {
        sim_corner end[2] = { { 0 } };
        if (cut_at(list, count, column + 0.5, end)) cover_column(cover, column, end, node);
    }
}

/* ---- triangles ---- */

static sim_corner project(const sim_eye *e, const double eye[3])
{
    double closeness = 1 / eye[2], scale = e->focal_px * closeness;
    return (sim_corner){ e->centre_px[0] + eye[0] * scale, e->centre_px[1] - eye[1] * scale,
                         closeness };
}

/* A triangle's part before the eye, as a polygon of the picture: its corners. */
static unsigned cut_triangle(const sim_eye *e, const sim_vertex *const point[3],
                             sim_corner list[CORNERS_MAX])
{
    unsigned count = 0;
    for (int i = 0; i < 3; i++) {
        const sim_vertex *a = point[i], *b = point[(i + 1) % 3];
        if (a->before) list[count++] = a->at;
        if (a->before == b->before) continue;
        double t = (NEAREST_M - a->eye[2]) / (b->eye[2] - a->eye[2]), between[3];
        for (int k = 0; k < 2; k++) between[k] = a->eye[k] + t * (b->eye[k] - a->eye[k]);
        between[2] = NEAREST_M;
        list[count++] = project(e, between);
    }
    return count;
}

/* A node's vertices as seen from the eye. */
static void place_vertices(sim_cover *cover, const sim_mesh *mesh, const sim_eye *e,
                           const ff_drawn *drawn)
{
    const ff_terrain_info *info = sim_mesh_info(mesh, drawn);
    uint32_t side = ff_node_side(info);
    double last[2];
    sim_place_last(info, drawn, last);
    for (uint32_t i = 0; i < side * side; i++) {
        sim_vertex *point = &cover->point[i];
        double cell[2], way[3];
        sim_mesh_vertex_cell(info, last, i, cell);
        sim_place_of_cell(drawn, cell, sim_mesh_vertex_m(mesh, info, drawn, i), way);
        for (int k = 0; k < 3; k++) way[k] -= e->pos_m[k];
        way[2] -= mesh->curve_per_m * (way[0] * way[0] + way[1] * way[1]);
        sim_eye_turn(e, way, point->eye);
        point->before = point->eye[2] >= NEAREST_M;
        if (point->before) point->at = project(e, point->eye);
    }
}

static void cover_node(sim_cover *cover, const sim_mesh *mesh, const sim_eye *e,
                       const ff_drawn *drawn, uint32_t node)
{
    uint8_t strip[5];
    unsigned strips = ff_strips_for(drawn->coarser, strip);
    place_vertices(cover, mesh, e, drawn);
    for (unsigned i = 0; i < strips; i++) {
        const sim_triangles *list = &mesh->strip[strip[i]];
        for (uint32_t j = 0; j < list->count; j++) {
            const sim_vertex *point[3];
            sim_corner polygon[CORNERS_MAX];
            for (int k = 0; k < 3; k++) point[k] = &cover->point[list->vertex[j][k]];
            unsigned count = cut_triangle(e, point, polygon);
            if (count) cover_polygon(cover, polygon, count, node);
        }
    }
}

int sim_cover_make(sim_cover *cover, const sim_mesh *mesh, const c3d_camera *camera,
                   unsigned step_px, const ff_drawn *drawn, uint32_t count)
{
    sim_eye e;
    sim_eye_of(camera, &e);
    int rc = begin(cover, mesh, camera, step_px);
    for (uint32_t i = 0; rc == FF_OK && i < count; i++)
        cover_node(cover, mesh, &e, &drawn[i], i + 1);
    return rc;
}

/* ---- fins ---- */

/* As they are drawn: ground has fallen away from O in them, and does not once more. */
static void cover_fin(sim_cover *cover, const sim_eye *e, const double origin_m[3],
                      const sim_fin *fin)
{
    sim_vertex corner[3];
    const sim_vertex *const point[3] = { &corner[0], &corner[1], &corner[2] };
    sim_corner polygon[CORNERS_MAX];
    for (int i = 0; i < 3; i++) {
        double way[3];
        for (int k = 0; k < 3; k++) way[k] = origin_m[k] + fin->corner_m[i][k] - e->pos_m[k];
        sim_eye_turn(e, way, corner[i].eye);
        corner[i].before = corner[i].eye[2] >= NEAREST_M;
        if (corner[i].before) corner[i].at = project(e, corner[i].eye);
    }
    unsigned count = cut_triangle(e, point, polygon);
    if (count) cover_polygon(cover, polygon, count, SIM_COVER_FIN);
}

void sim_cover_fins(sim_cover *cover, const c3d_camera *camera, const sim_drawn_fins *drawn)
{
    sim_eye e;
    double origin_m[3];
    if (!drawn->fins) return;
    sim_eye_of(camera, &e);
    for (int k = 0; k < 3; k++) origin_m[k] = (double)drawn->position_wu[k] / FF_WU_PER_METRE;
    for (size_t i = 0; i < drawn->fins->count; i++) {
        const sim_fin *fin = &drawn->fins->fin[i];
        if (fin->set == drawn->set && (drawn->sectors >> fin->sector & 1u))
            cover_fin(cover, &e, origin_m, fin);
    }
}
