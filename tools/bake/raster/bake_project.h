/* From the source's own grid to a grid of squares in metres. */
#ifndef BAKE_PROJECT_H
#define BAKE_PROJECT_H

#include "bake_source.h"
#include "bake_warp.h"

/* What projection does with a ground, known before a sample is made. */
typedef struct bake_plan {
    bake_warp warp;   /* warp.to, width and height: the new grid, resampled or not */
    double spacing_m; /* of the new grid */
    int is_resampled; /* 0: every sample is kept */
    int is_forced;    /* nobody asked for it: the cells are no squares */
} bake_plan;

/* Chooses the projection and the new grid of `ground`, whose samples are not looked at. Whoever
 * does not hand the plan on owns plan->warp.target. 0 or -1 (said). */
int bake_project_plan(const bake_options *options, bake_ground *ground, bake_plan *plan);

/* Makes the spacing of `ground` square and metric: projects geographic rasters (local UTM zone, or
 * as told), resamples when --spacing asks for it, else keeps every sample. The ground must have no
 * voids; `marks` of those that it had, when open, go the same way. Samples of the new grid outside
 * the source's area become NaN, counted in ground->outside. *spacing_m receives the spacing. 0 or
 * -1 (said). */
int bake_project(const bake_options *options, bake_ground *ground, bake_grid *marks,
                 double *spacing_m);

#endif
