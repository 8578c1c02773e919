/* Heights that are encoded as colours: three bands of 8 bits, one number of 24. */
#ifndef BAKE_RGB_H
#define BAKE_RGB_H

#include "bake_gdal.h"
#include "../bake_options.h"

typedef struct bake_rgb { /* metres = number * scale + offset; scale 0: not encoded */
    double scale, offset;
} bake_rgb;

/* The encoding of the raster: --rgb, else what its metadata ("encoding") or its name says, told in
 * a line. Colours that nothing calls heights are refused, in one line. 0 or -1 (said). */
int bake_rgb_choose(const bake_options *options, GDALDatasetH set, bake_rgb *rgb);
/* Of enum bake_rgb_word: --rgb, else what the metadata `tag` (NULL: none) or HEIGHTS' name says.
 * -1: nothing does (said). */
int bake_rgb_told(const bake_options *options, const char *tag);
/* 1 when the raster is one band of indexes of colours: bake_colour_views shows the colours. */
int bake_rgb_is_palette(GDALDatasetH set);
/* Reads rows as numbers. `room` holds as many floats as there are values. 0 or -1 (GDAL's error).
 */
int bake_rgb_read(GDALDatasetH set, uint32_t width, uint32_t top, uint32_t rows, double *values,
                  float *room);

#endif
