/* Ground on its way into a pack: a grid of float metres, row 0 north, with its place on the
 * Earth. */
#ifndef BAKE_SOURCE_H
#define BAKE_SOURCE_H

#include "bake_gdal.h"
#include "bake_grid.h"
#include "../bake_options.h"
#include "bake_about.h"
#include "bake_shift.h"

typedef struct bake_ground {
    bake_grid grid; /* float32 metres; NaN: void */
    /* GDAL's, of the grid; without georeference {0, 1, 0, height, 0, -1} */
    double geotransform[6];
    int has_place; /* the geotransform is the raster's own */
    int is_geographic;
    OGRSpatialReferenceH srs; /* owned; NULL: none */
    /* as read, before any turn or projection: where an image without georeference lies */
    double source_geotransform[6];
    uint32_t source_width, source_height;
    OGRSpatialReferenceH source_srs;
    double step_m; /* heights are whole multiples of this above base_m; 0: of nothing known */
    double base_m;
    /* samples filled: void in the source; beyond its area after projection */
    uint64_t voids, outside;
    uint64_t given; /* samples void in the source that were given a height */
    int resampled;
    bake_shift shift; /* from the source's datum to that of `srs` */
    bake_about about; /* whose it is */
} bake_ground;

/* Reads `set`, or the raster named in `options` when it is NULL, into `ground`, voids as NaN and
 * counted. 0, or -1 after saying why. */
int bake_source_read(const bake_options *options, GDALDatasetH set, bake_ground *ground);
/* Makes it ground that lies nowhere, its samples as they are. */
void bake_ground_forget_place(bake_ground *ground);
void bake_ground_close(bake_ground *ground);

#endif
