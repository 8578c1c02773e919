/* Map tiles of the ground: those of the finest zoom are projected, each coarser one is made of its
 * four children. */
#ifndef EXPORT_PYRAMID_H
#define EXPORT_PYRAMID_H

#include "export_ground.h"
#include "export_options.h"

/* Refuses, before the ground is read, what map tiles cannot hold. 0 or -1 (said). */
int export_pyramid_check(const export_options *options, const ff_terrain_info *info);
/* Writes the tiles that have ground: all of them or nothing. 0 or -1 (said). */
int export_pyramid_write(const export_options *options, const export_ground *ground);

#endif
