/* The ground of a pack at one level, or a part of it, as a raster that is read by windows of any
 * reference system.
 *
 * The level is decoded once, into temporary files: memory does not grow with the pack. To read
 * heights of 65 x 65 points in degrees:
 *
 *   export_ground ground;
 *   export_view view;                               (export_view.h)
 *   if (export_ground_open(&unpack, level, &region, &ground)) ...
 *   if (export_view_open(&ground, wgs84, &view)) ...
 *   found = export_view_read(&view, geotransform, 65, 65, heights, mask);
 */
#ifndef EXPORT_GROUND_H
#define EXPORT_GROUND_H

#include "../bake/raster/bake_grid.h"
#include "../info/bake_unpack.h"
#include "export_place.h"

/* What a cell is. */
enum export_cell {
    EXPORT_BEYOND,   /* no ground: what is told there is that of the nearest ground */
    EXPORT_MEASURED, /* ground */
    EXPORT_FILLED    /* ground that may have been void in the source, and filled */
};

/* How far exported heights may be from the pack's source, in metres. */
typedef struct export_error {
    double samples_m; /* at samples: what the pack was baked with, or more where it has stubs */
    double between_m; /* on the triangles between them: the level's geometric error */
} export_error;

typedef struct export_ground {
    const bake_unpack *unpack;
    uint32_t level;
    export_lattice lattice;
    export_window window;
    int bands; /* 1: heights, uint16 steps; 3: colours, bytes, and a 4th in cells and set: alpha */
    int has_open;    /* of colours: alpha is not 255 everywhere; the mask has such as beyond */
    bake_grid cells; /* of the window, row 0 north */
    bake_grid mask;  /* bytes of enum export_cell; closed: all is measured */
    double geotransform[6];
    OGRSpatialReferenceH srs; /* NULL: the pack tells none that is known here */
    GDALDatasetH set;         /* over cells, with place, scale and offset */
    double scale, offset;     /* metres = cell * scale + offset; of colours 1 and 0 */
    double low, high;         /* no cell's value is beyond: metres, or 0 and 255 */
    export_error error;       /* of heights */
} export_ground;

/* Heights of a level (0 roots .. levels - 1) in a region, or all. bake_temp_setup comes before. 0
 * or -1 (said). */
int export_ground_open(const bake_unpack *unpack, uint32_t level, const bake_box *region,
                       export_ground *ground);
/* Colours of a level of a layer of textures (0 .. ff_pack_image_levels - 1). */
int export_ground_open_images(const bake_unpack *unpack, unsigned layer, uint32_t level,
                              const bake_box *region, export_ground *ground);
void export_ground_close(export_ground *ground);

#endif
