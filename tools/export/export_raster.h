/* Ground as one raster. */
#ifndef EXPORT_RASTER_H
#define EXPORT_RASTER_H

#include "export_ground.h"
#include "export_options.h"

/* 1 when the ending of `path` is one of a raster: .tif, .png, .jpg, .r16. */
int export_raster_is(const char *path);
/* Refuses, before the ground is read, what a raster of this ending cannot hold. 0 or -1 (said). */
int export_raster_check(const export_options *options);
/* Writes the ground, which --voids nodata marks: whole or not at all. 0 or -1 (said). */
int export_raster_write(const export_options *options, export_ground *ground);

#endif
