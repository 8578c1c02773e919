/* A tile encoded in one piece: what a decoder sees of it, beside its samples. */
#ifndef WHOLE_TILE_H
#define WHOLE_TILE_H

#include "../../tools/bake/bake_block.h"

typedef struct whole_tile {
    bake_top top;
    bake_block block;
    uint32_t number;
    const uint16_t *source, *decoded; /* (2^n+1)^2, south to north */
    bake_blob level[BAKE_LEVELS_MAX]; /* records, when it is encoded: as the top's and block's */
} whole_tile;

/* Loads a tile of the grid. `filled`: a byte beside each height, or closed. */
void whole_tile_open(whole_tile *tile, const ff_terrain_info *info, const bake_grid *grid,
                     const bake_grid *filled, uint32_t number);
void whole_tile_encode(whole_tile *tile);
void whole_tile_close(whole_tile *tile);

#endif
