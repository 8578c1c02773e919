/* How raster values become metres, and how far from 0 a height can be. */
#ifndef BAKE_UNIT_H
#define BAKE_UNIT_H

#include "bake_gdal.h"
#include "bake_rgb.h"
#include "bake_source.h"

typedef struct bake_unit {
    double scale, offset; /* metres = value * scale + offset */
    double absurd_m;      /* what is further from 0 is no height */
    int is_rgb;           /* values are colours: bake_rgb.h */
} bake_unit;

/* From --scale, else --hscale for plain images, else the raster's own scale, offset and unit; an
 * unknown unit is told, and taken as metres. Of encoded colours from --scale and the encoding. */
bake_unit bake_unit_read(const bake_options *options, GDALDatasetH set, const bake_rgb *rgb,
                         const bake_ground *ground);
/* Metres a unit that is spelled so ("US survey foot", "ftUS", "dm"), or 0. */
double bake_unit_metres(const char *spelling);

#endif
