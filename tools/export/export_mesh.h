/* The ground as quantized-mesh tiles for Cesium: a folder with layer.json and {z}/{x}/{y}.terrain.
 *
 * Zooms go from 0, of which both tiles are there, to the one whose points lie as close as the
 * ground's samples. The mesh of the finest zoom is off its points by --mesh-error at most, and each
 * coarser one by twice as much as the one below; vertices lie on the ground at every zoom. Where
 * the pack has no ground, the height is 0. Tiles that touch have the same vertices on their common
 * side.
 */
#ifndef EXPORT_MESH_H
#define EXPORT_MESH_H

#include "export_ground.h"
#include "export_options.h"

/* Refuses options that make no meshes. 0 or -1 (said). */
int export_mesh_check(const export_options *options);
/* Writes the folder. 0 or -1 (said). */
int export_mesh_write(const export_options *options, const export_ground *ground);

#endif
