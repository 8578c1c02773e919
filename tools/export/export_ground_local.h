/* Private to export_ground.c, export_images.c and export_told.c: how a window's cells are read. */
#ifndef EXPORT_GROUND_LOCAL_H
#define EXPORT_GROUND_LOCAL_H

#include "export_ground.h"

/* Chooses the window and opens its cells; unpack, level, lattice and bands are set. 0 or -1 (said).
 */
int export_ground_begin(export_ground *ground, const bake_box *region, uint32_t cell_bytes);
/* Opens the data set, unless `rc` tells that reading failed: then all is closed. 0 or -1 (said). */
int export_ground_finish(export_ground *ground, int rc);

/* 1 when a node of so many points along its side has ground, and points of the window. Where the
 * points are finer than the window's lattice, so many times two. */
int export_meets(const export_ground *ground, ff_key key, uint32_t points, uint32_t finer_log2);
/* The same of heights, whatever the node's level. */
int export_meets_samples(const export_ground *ground, ff_key key);
/* Tells how far a walk over the nodes of `level` is that has come to `key` or beyond. */
void export_reading(const export_ground *ground, ff_key key, uint32_t level);
/* Writes what lies in the window of a row of cells that begins at a point of the lattice. 0 or -1
 * (said). */
int export_put_row(const export_ground *ground, uint32_t column, uint32_t row, uint32_t count,
                   const uint8_t *cells);
/* The same of the mask. */
int export_put_mask(const export_ground *ground, uint32_t column, uint32_t row, uint32_t count,
                    const uint8_t *mask);

/* How far samples, and the triangles between them, may be from the source. 0 or -1 (said). */
int export_told_error(const export_ground *ground, export_error *error);
/* Opens the mask, unless all of the window's ground is measured. 0 or -1 (said). */
int export_told_filled(const export_ground *ground, bake_grid *mask);

#endif
