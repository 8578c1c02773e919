/* From the source's own grid to a grid of squares in metres. */
#ifndef BAKE_PROJECT_H
#define BAKE_PROJECT_H

#include "bake_source.h"

/* Makes the spacing of `ground` square and metric: projects geographic rasters (local UTM zone, or
 * as told), resamples when --spacing asks for it, else keeps every sample. The ground must have no
 * voids; `marks` of those that it had, when open, go the same way. Samples of the new grid outside
 * the source's area become NaN, counted in ground->outside. *spacing_m receives the spacing. 0 or
 * -1 (said). */
int bake_project(const bake_options *options, bake_ground *ground, bake_grid *marks,
                 double *spacing_m);

#endif
