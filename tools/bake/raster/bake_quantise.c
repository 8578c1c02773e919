#include "bake_quantise.h"

#include "../bake_say.h"
#include "bake_lattice.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define STEPS_MAX       65535.0
#define FINEST_CHOSEN_M 0.01
#define MAX_ERROR_STEPS 32767.0 /* residuals are quantised by 2*max_error + 1 */
#define Q24             16777216.0
#define COARSEST_M      100.0 /* a step in Q24 ends at 128 m */
#define OFFSET_ERROR_M  1e-4
#define SAME_ERROR_M    1e-9 /* of two steps that are told as well the higher one is chosen */
#define BASE_TOLERANCE  0.02 /* of a step */
#define MM_TOLERANCE_M  4e-4
#define TRIES_MAX       4096

/* Chooses the height of step 0: zero when all heights fit above it, else just below the lowest
 * height, on a whole metre if there is room. */
static double choose_first(double step_m, double low, double high)
{
    if (low >= 0 && high <= STEPS_MAX) return 0;
    double per_metre = nearbyint(1 / step_m);
    if (per_metre > 1 && fabs(per_metre * step_m - 1) < 1e-6) {
        double first = floor(low / per_metre) * per_metre;
        if (high - first <= STEPS_MAX) return first;
    }
    return low;
}

/* How far the height of a step is from the world unit that it is written in. */
static double offset_error_m(double base_m, double step_m, double step)
{
    double wu = (base_m + step * step_m) * FF_WU_PER_METRE;
    return fabs(wu - nearbyint(wu)) / FF_WU_PER_METRE;
}

/* The same choice where heights are no whole steps above 0: of the steps that leave room for all
 * heights, the highest one that a world unit tells within OFFSET_ERROR_M, else the nearest. */
static double choose_first_above(double base_m, double step_m, double low, double high)
{
    double best = low, best_m = INFINITY;
    for (double first = low; first > low - TRIES_MAX && high - first <= STEPS_MAX; first--) {
        double error_m = offset_error_m(base_m, step_m, first);
        if (error_m < best_m - SAME_ERROR_M) {
            best = first;
            best_m = error_m;
        }
        if (best_m <= OFFSET_ERROR_M) break;
    }
    return best;
}

double bake_steps_first(double base_m, double step_m, double low, double high)
{
    double first = choose_first(step_m, low, high);
    return offset_error_m(base_m, step_m, first) > OFFSET_ERROR_M
               ? choose_first_above(base_m, step_m, low, high)
               : first;
}

/* A part of a metre, where it is one. */
static double step_of(uint32_t hscale_q24)
{
    double step_m = hscale_q24 / Q24, parts = nearbyint(1 / step_m);
    return parts >= 1 && nearbyint(Q24 / parts) == hscale_q24 ? 1 / parts : step_m;
}

void bake_steps_of(const ff_terrain_info *info, double *step_m, double *base_m)
{
    double zero_m = (double)info->hoffset_wu / FF_WU_PER_METRE;
    *step_m = step_of(info->hscale_q24);
    *base_m = zero_m - nearbyint(zero_m / *step_m) * *step_m;
    double mm = nearbyint(*base_m * 1000) / 1000;
    if (fabs(*base_m) <= fmax(BASE_TOLERANCE * *step_m, 0.5 / FF_WU_PER_METRE))
        *base_m = 0;
    else if (fabs(*base_m - mm) < MM_TOLERANCE_M)
        *base_m = mm;
}

static int set_step(bake_steps *steps, double wanted_m)
{
    double q24 = fmax(1, nearbyint(wanted_m * Q24));
    double low = nearbyint(steps->min_m / wanted_m), high = nearbyint(steps->max_m / wanted_m);
    if (high - low > STEPS_MAX) return 0;
    steps->step_m = q24 / Q24;
    steps->base_m = 0;
    steps->first_step = choose_first(wanted_m, low, high);
    return 1;
}

/* The source's own steps: step 0 lies where one of them lies, and so do all above it as far as a
 * step in Q24 is the source's. */
static int set_own_step(bake_steps *steps, double own_m, double base_m)
{
    base_m -= own_m * nearbyint(base_m / own_m);
    if (fabs(base_m) < 1e-6 * own_m) base_m = 0;
    steps->min_m -= base_m;
    steps->max_m -= base_m;
    int fits = set_step(steps, own_m);
    double low = nearbyint(steps->min_m / own_m), high = nearbyint(steps->max_m / own_m);
    steps->min_m += base_m;
    steps->max_m += base_m;
    if (!fits) return 0;
    steps->first_step = bake_steps_first(base_m, own_m, low, high);
    steps->base_m = base_m + steps->first_step * (own_m - steps->step_m);
    double drift_m = (high - low) * fabs(own_m - steps->step_m),
           float_m = fmax(fabs(steps->min_m), fabs(steps->max_m)) * FLT_EPSILON;
    if (fmax(drift_m, float_m) > own_m / 4)
        bake_note("the source's steps of %.9g m are finer than what a pack tells: heights are "
                  "within %.2g m, not exact",
                  own_m, own_m / 2 + fmin(drift_m, own_m / 2) + float_m);
    return 1;
}

static double next_nice(double step_m)
{
    double decade = pow(10, floor(log10(step_m) + 1e-9)), digit = step_m / decade;
    return digit < 1.5 ? 2 * decade : digit < 3.5 ? 5 * decade : 10 * decade;
}

int bake_steps_choose(const bake_options *o, const bake_ground *ground, bake_steps *steps)
{
    float low_m, high_m;
    if (bake_grid_range(&ground->grid, &low_m, &high_m)) return -1;
    *steps = (bake_steps){ .min_m = low_m, .max_m = high_m };
    if (o->hscale_m > 0) {
        if (set_step(steps, o->hscale_m)) return 0;
        return bake_fail("--hscale %g: heights from %g to %g m span more than 65536 steps",
                         o->hscale_m, steps->min_m, steps->max_m);
    }
    if (o->lattice) {
        double step_m, base_m;
        bake_steps_of(&o->lattice->info, &step_m, &base_m);
        if (set_own_step(steps, step_m, base_m)) return 0;
        return bake_fail("heights from %g to %g m span more than 65536 of the %.9g m steps of %s",
                         steps->min_m, steps->max_m, step_m, o->lattice->path);
    }
    if (ground->step_m > 0) {
        /* Invented detail needs finer steps than the source's, as far as they fit. */
        double own_m = ground->step_m;
        while (own_m > COARSEST_M) own_m /= 2; /* steps of a kilometre are whole ones of 125/2 m */
        for (double step_m = o->densify > 1 ? own_m / 8 : own_m; step_m <= own_m * 1.001;
             step_m *= 2)
            if (set_own_step(steps, step_m, ground->base_m)) return 0;
        bake_note(
            "heights span more than 65536 of their own steps of %g m: coarser steps are chosen",
            ground->step_m);
    }
    for (double step_m = FINEST_CHOSEN_M; step_m <= COARSEST_M; step_m = next_nice(step_m))
        if (set_step(steps, step_m)) return 0;
    return bake_fail("heights from %g to %g m do not fit a pack", steps->min_m, steps->max_m);
}

static void quantise_row(const bake_steps *steps, const float *metres, uint16_t *heights,
                         uint32_t count, ff_terrain_info *info)
{
    for (uint32_t i = 0; i < count; i++) {
        double h = nearbyint(((double)metres[i] - steps->base_m) / steps->step_m -
                             steps->first_step);
        heights[i] = (uint16_t)(!(h > 0) ? 0 : h < STEPS_MAX ? h : STEPS_MAX);
        if (heights[i] < info->height_min) info->height_min = heights[i];
        if (heights[i] > info->height_max) info->height_max = heights[i];
    }
}

void bake_set_error(ff_terrain_info *info, double steps)
{
    info->max_error = (uint16_t)fmin(steps, MAX_ERROR_STEPS);
    info->flags &= (uint8_t)~FF_TERRAIN_LOSSY;
    if (info->max_error) info->flags |= FF_TERRAIN_LOSSY;
}

static int set_units(const bake_options *o, const bake_steps *steps, ff_terrain_info *info)
{
    double offset_wu = nearbyint((steps->base_m + steps->first_step * steps->step_m) *
                                 FF_WU_PER_METRE);
    if (fabs(offset_wu) > INT32_MAX / 2)
        return bake_fail("heights of %g m lie outside the world", steps->min_m);
    info->hscale_q24 = (uint32_t)(steps->step_m * Q24);
    info->hoffset_wu = (int32_t)offset_wu;
    double error_steps = floor(o->max_error_m / step_of(info->hscale_q24) + 1e-6);
    bake_set_error(info, error_steps);
    if (!info->max_error && o->max_error_m > 0)
        bake_note("--max-error %g m is less than a height step of %g m: lossless", o->max_error_m,
                  steps->step_m);
    return 0;
}

int bake_quantise(const bake_options *o, const bake_ground *ground, const bake_steps *steps,
                  ff_terrain_info *info, bake_grid *grid)
{
    const bake_grid *from = &ground->grid;
    if (set_units(o, steps, info)) return -1;
    if (bake_grid_open(grid, from->width, from->height, sizeof(uint16_t))) return -1;
    float *metres = malloc(from->width * sizeof *metres);
    uint16_t *heights = malloc(from->width * sizeof *heights);
    int rc = metres && heights ? 0 : bake_fail("out of memory");
    int north_up = ground->geotransform[5] < 0;
    info->height_min = UINT16_MAX;
    info->height_max = 0;
    for (uint32_t j = 0; !rc && j < from->height; j++) {
        rc = bake_grid_read(from, j, 0, from->width, metres);
        if (rc) break;
        quantise_row(steps, metres, heights, from->width, info);
        rc = bake_grid_write(grid, north_up ? from->height - 1 - j : j, 0, from->width, heights);
        bake_progress("quantising", j + 1, from->height);
    }
    free(metres);
    free(heights);
    return rc;
}
