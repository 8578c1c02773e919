/* Entering a terrain below its top (SPEC.md, "Entry"). A view that ends near has no use for levels
 * whose nodes are larger than the view, and there are the more of them the larger the terrain is.
 * So a server hands out the same pack as a terrain of more and smaller tiles: the nodes of one
 * level are its tiles, the levels above are left out. Everything below is as it is stored; roots
 * alone are made, exact to the step, since what follows them was coded for just these heights. */
#ifndef FF_ENTRY_H
#define FF_ENTRY_H

#include "ff_terrain.h"

#define FF_ENTRY_TILES_MAX 65536u /* of an entered terrain: a client walks over those in reach */

/* The level at which a view is entered that reaches so far along each axis: its nodes are the
 * smallest of which no more than two lie in it along an axis. 0: the top. */
uint32_t ff_entry_level(const ff_terrain_info *whole, int32_t reach_wu);
/* The terrain entered there; level below ff_terrain_levels. Its place among others (first_tile) is
 * that of the whole: who holds several gives it another. */
ff_terrain_info ff_entry_terrain(const ff_terrain_info *whole, uint32_t level);
/* Nodes of a level, of heights or images, that have ground. */
uint64_t ff_entry_nodes(const ff_terrain_info *whole, uint32_t level);
/* The key in the whole of a node of the entered terrain. */
ff_key ff_entry_key(const ff_terrain_info *whole, const ff_terrain_info *entered, ff_key key);

#endif
