/* The whole bake: raster to pack. */
#ifndef BAKE_RUN_H
#define BAKE_RUN_H

#include "bake_options.h"

/* 0 or -1 (said); writes the pack, and with --json the summary on stdout. */
int bake_run(const bake_options *options);

/* Tile size for so many samples, so far apart, when none is told: one tile that holds all of them,
 * as small as may be. Where keys have no levels for that, or places no room for its padding, a
 * smaller one. */
uint32_t bake_choose_tile_log2(uint32_t node_log2, uint32_t width, uint32_t height,
                               uint32_t apart_wu);

#endif
