/* From float metres to the 16-bit steps of a pack. */
#ifndef BAKE_QUANTISE_H
#define BAKE_QUANTISE_H

#include "../../../protocol/ff_terrain.h"
#include "bake_source.h"

typedef struct bake_steps {
    double step_m;     /* metres a step; what hscale_q24 says, exactly */
    double first_step; /* height of step 0 above base_m, in steps: a whole number */
    double base_m;     /* heights are whole steps above this */
    double min_m, max_m;
} bake_steps;

/* Chooses the step: as told, else the source's own when its range fits 16 bits, else the finest of
 * 1-2-5 x 10^i from 1 cm up that fits. 0 or -1 (said). */
int bake_steps_choose(const bake_options *options, const bake_ground *ground, bake_steps *steps);

/* What a pack's steps were before they were rounded to what its description tells: metres each, and
 * how far whole ones lie from 0 m. */
void bake_steps_of(const ff_terrain_info *info, double *step_m, double *base_m);
/* Which step becomes height 0 where heights are from `low` to `high` whole steps above base_m. */
double bake_steps_first(double base_m, double step_m, double low, double high);

/* The largest error, in steps, of decoded heights; 32767 at most. */
void bake_set_error(ff_terrain_info *info, double steps);
/* Writes `grid` (uint16, rows south to north) from the ground's floats; sets hscale, hoffset,
 * height_min, height_max and max_error of `info`. 0 or -1 (said). */
int bake_quantise(const bake_options *options, const bake_ground *ground, const bake_steps *steps,
                  ff_terrain_info *info, bake_grid *grid);

#endif
