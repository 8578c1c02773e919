/* Several true grounds together: which of them counts where, and rays that pass from one to
 * another. Grounds are rectangles: along a ray each is a span of it, and the spans' ends cut the
 * ray into legs over one ground each. */
#include "sim_ground_local.h"

#include <math.h>

#define BEYOND_M 1e-6 /* of an edge: a place that is not on it */
#define SLIT_M   0.01 /* between grounds that touch: places are rounded to 1/256 m */

void sim_ground_join(sim_ground *first, sim_ground *more)
{
    while (first->next) first = first->next;
    first->next = more;
}

/* ---- places ---- */

const sim_ground *sim_ground_at(const sim_ground *ground, double x_m, double y_m)
{
    const sim_ground *best = NULL;
    for (; ground; ground = ground->next)
        if (sim_ground_own_has(ground, x_m, y_m) && (!best || ground->cell_m < best->cell_m))
            best = ground;
    return best;
}

int sim_ground_has(const sim_ground *ground, double x_m, double y_m)
{
    return sim_ground_at(ground, x_m, y_m) != NULL;
}

int sim_ground_filled(const sim_ground *ground, double x_m, double y_m)
{
    const sim_ground *at = sim_ground_at(ground, x_m, y_m);
    return at && sim_ground_own_filled(at, x_m, y_m);
}

/* The one whose rim is nearest to a place outside of all. */
static const sim_ground *nearest(const sim_ground *ground, double x_m, double y_m)
{
    const sim_ground *best = ground;
    for (double least_m = INFINITY; ground; ground = ground->next) {
        double place_m[2];
        sim_ground_own_nearest(ground, x_m, y_m, place_m);
        double away_m = hypot(place_m[0] - x_m, place_m[1] - y_m);
        if (away_m >= least_m) continue;
        least_m = away_m;
        best = ground;
    }
    return best;
}

double sim_ground_height_m(const sim_ground *ground, double x_m, double y_m)
{
    if (ground->next) {
        const sim_ground *at = sim_ground_at(ground, x_m, y_m);
        ground = at ? at : nearest(ground, x_m, y_m);
    }
    return sim_ground_own_height_m(ground, x_m, y_m);
}

double sim_ground_drop_m(const sim_ground *ground, double east_m, double north_m)
{
    return ground->curve_per_m * (east_m * east_m + north_m * north_m);
}

double sim_ground_reach_m(const sim_ground *ground)
{
    double reach_m = 0;
    for (; ground; ground = ground->next)
        reach_m += 4.0 * (ground->cell_m * ((double)ground->columns + ground->rows) +
                          fabs(ground->west_m) + fabs(ground->south_m));
    return reach_m;
}

/* ---- borders ---- */

/* 1 when a place of another ground than `here` lies within so many cells of the coarser one. */
static int is_within(const sim_ground *first, const sim_ground *here, const double from_m[2],
                     double x_m, double y_m, double cells)
{
    const sim_ground *other = sim_ground_at(first, x_m, y_m);
    return other && other != here &&
           hypot(x_m - from_m[0], y_m - from_m[1]) <= cells * fmax(here->cell_m, other->cell_m);
}

int sim_ground_near_border(const sim_ground *ground, double x_m, double y_m, double cells)
{
    const sim_ground *here = ground->next ? sim_ground_at(ground, x_m, y_m) : NULL;
    const double from_m[2] = { x_m, y_m };
    if (!here) return 0;
    for (const sim_ground *other = ground; other; other = other->next) {
        double place_m[2];
        if (other == here) continue;
        sim_ground_own_nearest(other, x_m, y_m, place_m);
        for (int axis = 0; axis < 2; axis++) /* onto it */
            place_m[axis] += copysign(BEYOND_M, place_m[axis] - from_m[axis]) *
                             (place_m[axis] != from_m[axis]);
        if (is_within(ground, here, from_m, place_m[0], place_m[1], cells)) return 1;
    }
    double east_m = here->west_m + here->size[0] * here->cell_m + BEYOND_M,
           north_m = here->south_m + here->size[1] * here->cell_m + BEYOND_M;
    return is_within(ground, here, from_m, here->west_m - BEYOND_M, y_m, cells) ||
           is_within(ground, here, from_m, east_m, y_m, cells) ||
           is_within(ground, here, from_m, x_m, here->south_m - BEYOND_M, cells) ||
           is_within(ground, here, from_m, x_m, north_m, cells);
}

/* ---- rays ---- */

typedef struct chain_ray {
    const sim_ground *first;
    const double *from_m, *direction;
    double bend_m, t_max;
} chain_ray;

/* The ground that counts right behind t on the ray, or NULL, and where it is another one or no more
 * than the end of the ray. */
static const sim_ground *leg_from(const chain_ray *r, double t, double *end)
{
    const sim_ground *best = NULL;
    *end = r->t_max;
    for (const sim_ground *ground = r->first; ground; ground = ground->next) {
        double span[2] = { 0, r->t_max };
        if (!sim_ground_own_span(ground, r->from_m, r->direction, span) || span[1] <= t) continue;
        *end = fmin(*end, span[0] > t ? span[0] : span[1]);
        if (span[0] <= t && (!best || ground->cell_m < best->cell_m)) best = ground;
    }
    return best;
}

static double above_m(const chain_ray *r, const sim_ground *ground, double t)
{
    return sim_ground_own_above_m(ground, r->from_m, r->direction, r->bend_m, t);
}

static int cast_chain(const chain_ray *r, double *t_hit)
{
    const sim_ground *before = NULL;
    double t[2] = { 0, 0 };
    while (t[0] < r->t_max) {
        const sim_ground *here = leg_from(r, t[0], &t[1]);
        for (double end; here && t[1] < r->t_max && leg_from(r, t[1], &end) == here;) t[1] = end;
        if (here && before && above_m(r, before, t[0]) >= 0 && above_m(r, here, t[0]) < 0) {
            *t_hit = t[0]; /* the step between them */
            return 1;
        }
        if (here && sim_ground_own_cast(here, r->from_m, r->direction, r->bend_m, t, t_hit))
            return 1;
        if (here || (t[1] - t[0]) * hypot(r->direction[0], r->direction[1]) > SLIT_M) before = here;
        t[0] = t[1];
    }
    return 0;
}

int sim_ground_cast(const sim_ground *ground, const double from_m[3], const double direction[3],
                    double t_max, double *t_hit)
{
    double bend_m = sim_ground_drop_m(ground, direction[0], direction[1]), t[2] = { 0, t_max };
    if (ground->next)
        return cast_chain(&(chain_ray){ ground, from_m, direction, bend_m, t_max }, t_hit);
    return sim_ground_own_span(ground, from_m, direction, t) &&
           sim_ground_own_cast(ground, from_m, direction, bend_m, t, t_hit);
}
