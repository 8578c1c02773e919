/* Images of any make as bands of 8 bits: grey, or red, green and blue; and alpha where something
 * says what is covered. */
#ifndef BAKE_COLOUR_H
#define BAKE_COLOUR_H

#include "bake_gdal.h"

#include <stdint.h>

#define BAKE_COLOUR_VIEWS_MAX 2

/* Makes views in front of an image of 8 bits a band: a palette is expanded, its transparent entries
 * and nodata value are not covered; greys and colours of fewer bits reach to white; what a mask or
 * a nodata value excludes becomes alpha. Each view reads from the one before, the first one from
 * `set`: they are closed in reverse, before `set`. The number of views, or -1 (said). */
int bake_colour_views(GDALDatasetH set, const char *path, GDALDatasetH view[BAKE_COLOUR_VIEWS_MAX]);
/* 1 when the last band is alpha. */
int bake_colour_has_alpha(GDALDatasetH set);
/* Reads rows as RGBA; what has no alpha is covered. 0 or -1 (GDAL's error). */
int bake_colour_read(GDALDatasetH set, int top, int rows, uint8_t *rgba);

#endif
