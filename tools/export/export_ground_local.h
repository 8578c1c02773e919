/* Private to export_ground.c, export_images.c and export_told.c: how a window's cells are read. */
#ifndef EXPORT_GROUND_LOCAL_H
#define EXPORT_GROUND_LOCAL_H

#include "export_ground.h"

/* Chooses the window and opens its cells; unpack, level, lattice and bands are set. 0 or -1 (said).
 */
int export_ground_begin(export_ground *ground, const bake_box *region, uint32_t cell_bytes);
/* Opens the data set, unless `rc` tells that reading failed: then all is closed. 0 or -1 (said). */
int export_ground_finish(export_ground *ground, int rc);

typedef int (*export_tile_fn)(void *context, uint32_t tile);
/* Calls `visit` for every tile that has points of the window, of tiles that are so many points
 * wide, until one answers -1. 0 or -1. */
int export_each_tile(const export_ground *ground, uint32_t tile_points, export_tile_fn visit,
                     void *context);
/* Writes what lies in the window of a row of cells that begins at a point of the lattice. 0 or -1
 * (said). */
int export_put_row(const export_ground *ground, uint32_t column, uint32_t row, uint32_t count,
                   const uint8_t *cells);

/* How far samples, and the triangles between them, may be from the source. 0 or -1 (said). */
int export_told_error(const export_ground *ground, export_error *error);
/* Opens the mask, unless all of the window's ground is measured. 0 or -1 (said). */
int export_told_filled(const export_ground *ground, bake_grid *mask);

#endif
