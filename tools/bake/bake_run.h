/* The whole bake: raster to pack. */
#ifndef BAKE_RUN_H
#define BAKE_RUN_H

#include "bake_options.h"

/* 0 or -1 (said); writes the pack, and with --json the summary on stdout. */
int bake_run(const bake_options *options);

/* Tile size for a raster when none is told: the largest of 2^10 or less with little padding, at
 * least one node. */
uint32_t bake_choose_tile_log2(uint32_t node_log2, uint32_t width, uint32_t height);

#endif
