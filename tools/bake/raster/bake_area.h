/* The rectangle that a raster covers in its plane, and how large a bake may be. */
#ifndef BAKE_AREA_H
#define BAKE_AREA_H

#include <stdint.h>

/* No raster is walked that has, or whose view over the ground has, more samples than this. */
#define BAKE_SAMPLES_MAX 2e10
#define BAKE_EDGE_MAX_M  8388607.0 /* edges of a terrain stay below 2^31 world units */

typedef struct bake_area {
    double west, south, east, north;
} bake_area;

/* The smallest that holds all of a raster, however its geotransform (GDAL's) turns it. */
bake_area bake_area_of(const double *geotransform, uint32_t width, uint32_t height);
/* Whether the two have more than an edge in common. */
int bake_area_meets(const bake_area *area, const bake_area *other);

#endif
