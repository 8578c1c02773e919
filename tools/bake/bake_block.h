/* A block: a node of a tile and all below it, from full-resolution heights, where the levels above
 * are decoded already (bake_top.h). A tile that is no larger than a block is one. */
#ifndef BAKE_BLOCK_H
#define BAKE_BLOCK_H

#include "bake_levels.h"
#include "bake_top.h"
#include "raster/bake_grid.h"

typedef struct bake_block {
    bake_levels levels; /* of all samples; records of the levels below the block's node */
    uint8_t *filled;    /* the same grid, 1 for samples that were filled; NULL: there are none */
    ff_key key;         /* the node */
    bake_known above[BAKE_LEVELS_MAX]; /* what the block adds to its node and those above, by
                                          level */
} bake_block;

/* For blocks of nodes of the level `top` ends with; both must outlive the block. Close it whatever
 * comes back: 0 or -1 (said). */
int bake_block_open(bake_block *block, const bake_top *top);
void bake_block_close(bake_block *block);
/* Reads the block of a node with ground from the grid (uint16, south to north), the grid's rim
 * repeated beyond its edge. `filled`: a byte beside each height, or closed. 0 or -1 (said). */
int bake_block_load(bake_block *block, const bake_grid *grid, const bake_grid *filled, ff_key key);
/* Encodes what is loaded, below the top of its tile. 0 or -1 (said). */
int bake_block_encode(bake_block *block, const bake_top *top);

#endif
