/* How a reference system is projected, as text and as numbers for those who have no table of
 * systems. */
#ifndef BAKE_PROJECTION_H
#define BAKE_PROJECTION_H

#include "bake_gdal.h"

#include <stdint.h>

#define BAKE_PROJECTION_BYTES_MAX 256

/* WKT 2 (ISO 19162:2015) in one line, to be freed with CPLFree, or NULL. */
char *bake_projection_wkt(OGRSpatialReferenceH srs);
/* Leaves out of it what is not needed to have the system again: codes, and where it is used. */
void bake_projection_shorten(OGRSpatialReferenceH srs, char *wkt);
/* The value of the entry FF_ABOUT_PROJECTION, read off that text: bytes, or 0: the system is not
 * projected, or by a method that has no number. */
uint32_t bake_projection_numbers(OGRSpatialReferenceH srs, const char *wkt,
                                 uint8_t numbers[BAKE_PROJECTION_BYTES_MAX]);

#endif
