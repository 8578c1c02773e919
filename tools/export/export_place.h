/* Where a pack's samples lie: its reference system, its lattices, parts of them, degrees. */
#ifndef EXPORT_PLACE_H
#define EXPORT_PLACE_H

#include "../../protocol/ff_terrain.h"
#include "../bake/bake_options.h"
#include "../bake/raster/bake_gdal.h"

/* All points of a level, of heights or of texels: point 0, 0 is the terrain's south-west sample. */
typedef struct export_lattice {
    uint32_t width, height;
    double spacing_m;
} export_lattice;

/* The points of a lattice that are exported, counted from the south-west. */
typedef struct export_window {
    uint32_t left, bottom, width, height;
} export_window;

/* Degrees; east may be beyond 180, west of it never. */
typedef struct export_bounds {
    double west, south, east, north;
} export_bounds;

/* Samples of a level of nodes, and texels of a level of textures, those up to the last sample's. */
export_lattice export_lattice_samples(const ff_terrain_info *info, uint32_t level);
export_lattice export_lattice_texels(const ff_terrain_info *info, uint32_t level);

/* The system that the pack's place is told in, to be destroyed; NULL: none, or one that is not
 * known here. Axes: east, north. */
OGRSpatialReferenceH export_place_srs(const ff_terrain_info *info);
/* GDAL's geotransform of a window whose first row is its northern one, cells round the points. */
void export_place_geotransform(const ff_terrain_info *info, const export_lattice *lattice,
                               const export_window *window, double geotransform[6]);
/* Holds all points of a box in the pack's plane. 0 or -1 (said). */
int export_place_degrees(OGRSpatialReferenceH srs, const export_bounds *plane,
                         export_bounds *bounds);
/* The smallest window that holds the region's part of the terrain, at least 2 x 2 points; all of it
 * without a region. 0 or -1 (said). */
int export_place_window(const ff_terrain_info *info, const export_lattice *lattice,
                        const bake_box *region, export_window *window);

#endif
