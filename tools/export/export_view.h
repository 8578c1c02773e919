/* Windows of the ground in any reference system: projected by GDAL's warper, sharp, averaged only
 * where the window is coarser than the ground. */
#ifndef EXPORT_VIEW_H
#define EXPORT_VIEW_H

#include "../bake/raster/bake_shift.h"
#include "export_ground.h"

typedef struct export_view {
    const export_ground *ground;
    bake_shift shift;   /* from the pack's datum to the window's */
    void *transform;    /* between cells of the ground and those of the window */
    GDALDatasetH marks; /* over the ground's mask, or NULL */
} export_view;

/* The ground must have a reference system. `target`'s axes: east, north. A note tells of a shift
 * between datums that may be off by more than half a sample. 0 or -1 (said). */
int export_view_open(const export_ground *ground, OGRSpatialReferenceH target, export_view *view);
void export_view_close(export_view *view);

/* Reads a window, placed by GDAL's geotransform of its cells: its values lie at their centres.
 * `values` has width * height of each band, one band after the other: metres, or 0 .. 255; beyond
 * the ground those of the nearest ground. `mask`: enum export_cell. The number of cells that are
 * ground, or -1 (said). */
int64_t export_view_read(const export_view *view, const double geotransform[6], uint32_t width,
                         uint32_t height, float *values, uint8_t *mask);
/* Values that are NAN become those of the nearest ground. 0 or -1 (said). */
int export_view_reach(const export_view *view, const double geotransform[6], uint32_t width,
                      uint32_t height, float *values);

#endif
