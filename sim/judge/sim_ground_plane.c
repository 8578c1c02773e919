/* The true ground of a planar terrain: x and y are columns and rows, z is height. Curved ground is
 * not bent for that: the ray is bent up instead, by as much as the ground has fallen away, and so
 * is a parabola over the plane. Another shape asks the same questions of another file. One ground
 * alone: those beside and over it are sim_ground_chain.c's. */
#include "sim_ground_local.h"

#include <math.h>

static double sample_m(const sim_ground *ground, uint32_t column, uint32_t row)
{
    return ground->hoffset_m +
           ground->hscale_m * ground->height[(size_t)row * ground->columns + column];
}

/* Of a column's or row's cells: where the ground ends inside, less than 1. */
static double width(const sim_ground *ground, int axis, uint32_t number)
{
    return fmin(1, ground->size[axis] - number);
}

/* Height of one of a cell's two triangles' planes at (u, v) within the cell, 0..1. */
static double plane_m(const sim_ground *ground, uint32_t column, uint32_t row, int south_east,
                      double u, double v)
{
    double sw = sample_m(ground, column, row), ne = sample_m(ground, column + 1, row + 1);
    if (south_east) {
        double se = sample_m(ground, column + 1, row);
        return sw + u * (se - sw) + v * (ne - se);
    }
    double nw = sample_m(ground, column, row + 1);
    return sw + v * (nw - sw) + u * (ne - nw);
}

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

int sim_ground_own_has(const sim_ground *ground, double x_m, double y_m)
{
    x_m -= ground->west_m;
    y_m -= ground->south_m;
    return x_m >= 0 && y_m >= 0 && x_m <= ground->size[0] * ground->cell_m &&
           y_m <= ground->size[1] * ground->cell_m;
}

void sim_ground_own_nearest(const sim_ground *ground, double x_m, double y_m, double place_m[2])
{
    place_m[0] = ground->west_m + clamp(x_m - ground->west_m, 0, ground->size[0] * ground->cell_m);
    place_m[1] = ground->south_m +
                 clamp(y_m - ground->south_m, 0, ground->size[1] * ground->cell_m);
}

int sim_ground_own_filled(const sim_ground *ground, double x_m, double y_m)
{
    double node_m = ground->cell_m * ground->node_cells;
    uint32_t column = (uint32_t)fmin((x_m - ground->west_m) / node_m, ground->node_columns - 1),
             row = (uint32_t)fmin((y_m - ground->south_m) / node_m, ground->node_rows - 1);
    return ground->filled[(size_t)row * ground->node_columns + column];
}

double sim_ground_own_height_m(const sim_ground *ground, double x_m, double y_m)
{
    double x = clamp((x_m - ground->west_m) / ground->cell_m, 0, ground->size[0]),
           y = clamp((y_m - ground->south_m) / ground->cell_m, 0, ground->size[1]);
    uint32_t column = (uint32_t)clamp(floor(x), 0, ground->columns - 2),
             row = (uint32_t)clamp(floor(y), 0, ground->rows - 2);
    double u = (x - column) / width(ground, 0, column), v = (y - row) / width(ground, 1, row);
    return plane_m(ground, column, row, u >= v, u, v);
}

/* A ray in cells (x, y) and metres (z): z = from + t along + t^2 bend. */
typedef struct ray {
    const sim_ground *ground;
    double from[3], along[3], bend;
    double side; /* 1: it comes from above the ground; -1: from below */
} ray;

static double ray_height(const ray *r, double t)
{
    return r->from[2] + t * (r->along[2] + t * r->bend);
}

/* The least of a parabola that is `bend` bent, on a way of length 1: its values at both ends are a
 * and b. */
static double lowest_between(double a, double b, double bend)
{
    double where = bend > 0 ? clamp((bend - (b - a)) / (2 * bend), 0, 1) : b < a;
    return a + where * (b - a) - bend * where * (1 - where);
}

/* First ground on t0..t1 in one triangle's plane: over it the ray is a parabola, met where it first
 * changes sides. */
static int cast_plane(const ray *r, uint32_t column, uint32_t row, int south_east, double t0,
                      double t1, double *t_hit)
{
    double above[2], t[2] = { t0, t1 }, bend = r->side * r->bend * (t1 - t0) * (t1 - t0);
    for (int i = 0; i < 2; i++)
        above[i] =
            r->side *
            (ray_height(r, t[i]) -
             plane_m(r->ground, column, row, south_east,
                     (r->from[0] + t[i] * r->along[0] - column) / width(r->ground, 0, column),
                     (r->from[1] + t[i] * r->along[1] - row) / width(r->ground, 1, row)));
    *t_hit = t0;
    if (above[0] <= 0) return 1;
    if (lowest_between(above[0], above[1], bend) > 0) return 0;
    /* bend p^2 - slope p + above = 0, the first root, in the form that does not cancel */
    double slope = bend - (above[1] - above[0]),
           root = sqrt(fmax(0, slope * slope - 4 * bend * above[0]));
    *t_hit = t0 + (t1 - t0) * clamp(2 * above[0] / (slope + root), 0, 1);
    return 1;
}

static int cast_cell(const ray *r, uint32_t column, uint32_t row, double t0, double t1,
                     double *t_hit)
{
    if (column >= r->ground->columns - 1 || row >= r->ground->rows - 1) return 0;
    /* u - v along the ray */
    double wide = width(r->ground, 0, column), deep = width(r->ground, 1, row),
           difference = (r->from[0] - column) / wide - (r->from[1] - row) / deep,
           slope = r->along[0] / wide - r->along[1] / deep;
    double crossing = slope != 0 ? -difference / slope : INFINITY;
    if (crossing > t0 && crossing < t1) {
        int first = difference + (t0 + crossing) / 2 * slope >= 0;
        return cast_plane(r, column, row, first, t0, crossing, t_hit) ||
               cast_plane(r, column, row, !first, crossing, t1, t_hit);
    }
    return cast_plane(r, column, row, difference + (t0 + t1) / 2 * slope >= 0, t0, t1, t_hit);
}

/* Looks for ground in the block (column, row) of 2^log2 cells a side, which the ray crosses on
 * t0..t1: in its quarters, in the ray's order. */
static int cast_block(const ray *r, unsigned log2, uint32_t column, uint32_t row, double t0,
                      double t1, double *t_hit)
{
    const sim_ground *ground = r->ground;
    if (log2 >= SIM_GROUND_PYRAMID_FIRST) {
        if (column >= ground->pyramid[log2].columns || row >= ground->pyramid[log2].rows) return 0;
        double lowest = lowest_between(ray_height(r, t0), ray_height(r, t1),
                                       r->bend * (t1 - t0) * (t1 - t0));
        uint16_t most =
            ground->pyramid[log2].max[(size_t)row * ground->pyramid[log2].columns + column];
        if (lowest > ground->hoffset_m + ground->hscale_m * most) return 0;
    }
    if (!log2) return cast_cell(r, column, row, t0, t1, t_hit);
    double middle_x = (double)((uint64_t)(column * 2 + 1) << (log2 - 1)),
           middle_y = (double)((uint64_t)(row * 2 + 1) << (log2 - 1));
    double at[4] = { t0, t0, t0, t1 };
    int count = 1;
    double cross_x = r->along[0] != 0 ? (middle_x - r->from[0]) / r->along[0] : -1;
    double cross_y = r->along[1] != 0 ? (middle_y - r->from[1]) / r->along[1] : -1;
    double early = fmin(cross_x, cross_y), late = fmax(cross_x, cross_y);
    if (early > t0 && early < t1) at[count++] = early;
    if (late > t0 && late < t1 && late > early) at[count++] = late;
    at[count] = t1;
    for (int i = 0; i < count; i++) {
        double t = (at[i] + at[i + 1]) / 2;
        uint32_t east = r->from[0] + t * r->along[0] >= middle_x,
                 north = r->from[1] + t * r->along[1] >= middle_y;
        if (cast_block(r, log2 - 1, column * 2 + east, row * 2 + north, at[i], at[i + 1], t_hit))
            return 1;
    }
    return 0;
}

/* The ray of sim_ground_cast, over this ground. */
static ray ray_over(const sim_ground *ground, const double from_m[3], const double direction[3],
                    double bend_m)
{
    ray r = { .ground = ground, .bend = bend_m, .side = 1 };
    const double south_west_m[3] = { ground->west_m, ground->south_m, 0 };
    for (int axis = 0; axis < 3; axis++) {
        double scale = axis < 2 ? ground->cell_m : 1;
        r.from[axis] = (from_m[axis] - south_west_m[axis]) / scale;
        r.along[axis] = direction[axis] / scale;
    }
    return r;
}

int sim_ground_own_span(const sim_ground *ground, const double from_m[3], const double direction[3],
                        double t[2])
{
    ray r = ray_over(ground, from_m, direction, 0);
    for (int axis = 0; axis < 2; axis++) {
        if (r.along[axis] == 0) {
            if (r.from[axis] < 0 || r.from[axis] > ground->size[axis]) return 0;
            continue;
        }
        double a = -r.from[axis] / r.along[axis],
               b = (ground->size[axis] - r.from[axis]) / r.along[axis];
        t[0] = fmax(t[0], fmin(a, b));
        t[1] = fmin(t[1], fmax(a, b));
    }
    return t[0] < t[1];
}

double sim_ground_own_above_m(const sim_ground *ground, const double from_m[3],
                              const double direction[3], double bend_m, double t)
{
    ray r = ray_over(ground, from_m, direction, bend_m);
    return ray_height(&r, t) - sim_ground_own_height_m(ground, from_m[0] + t * direction[0],
                                                       from_m[1] + t * direction[1]);
}

int sim_ground_own_cast(const sim_ground *ground, const double from_m[3], const double direction[3],
                        double bend_m, const double t[2], double *t_hit)
{
    ray r = ray_over(ground, from_m, direction, bend_m);
    if (t[0] > 0 && sim_ground_own_above_m(ground, from_m, direction, bend_m, t[0]) < 0)
        r.side = -1; /* it comes in below the ground's edge */
    return cast_block(&r, ground->top, 0, 0, t[0], t[1], t_hit);
}
