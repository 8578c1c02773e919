/* The ground of a draw: heights as a function of longitude and latitude (of planes: of x and y),
 * reckoned from PROJ alone, and a raster's samples of it with their voids. */
#ifndef PROPERTY_SURFACE_H
#define PROPERTY_SURFACE_H

#include "property_draw.h"

/* What a sample is. */
enum property_mark { MARK_GROUND, MARK_HOLE, MARK_RIM };

typedef struct property_raster {
    double *value;  /* as the file holds them */
    double *metres; /* of the values; NaN: void */
    uint8_t *mark;
    uint32_t holes, rims; /* samples */
    double lowest_m, highest_m;
} property_raster;

/* Heights at `count` places given in the plane of `srs` (NULL: of a plane without one). 0, or -1
 * when PROJ does not show them. The places are overwritten. */
int property_heights(const property_draw *d, OGRSpatialReferenceH srs, int count, double *x,
                     double *y, double *heights);

/* The steepest slope, in metres a cell, and how fine the waves are: radians in the longer side of a
 * cell. */
double property_slope(const property_draw *d);
double property_wave(const property_draw *d);

/* The root of the area of the middle cell, on the ground. */
double property_cell_m(const property_draw *d);

/* Makes the samples and punches voids into them. 0 or -1. */
int property_raster_make(property_draw *d, property_raster *raster);
void property_raster_free(property_raster *raster);

/* What a cubic filter (Keys 1981, a = -1/2) makes of the samples round (u, v), 0 in the middle of
 * the first, kept to their range; NaN where one of them is void or beyond the rim. */
double property_raster_between(const property_draw *d, const property_raster *raster, double u,
                               double v);

/* Writes the raster in the draw's format: `path` gets the name, in folder `folder`. 0 or -1. */
int property_raster_write(const property_draw *d, const property_raster *raster, const char *folder,
                          char *path, size_t size);

#endif
