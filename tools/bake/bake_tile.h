/* One tile from full-resolution heights to the records of its nodes, level by level in Morton
 * order. */
#ifndef BAKE_TILE_H
#define BAKE_TILE_H

#include "../../protocol/codec/ff_codec.h"
#include "bake_blob.h"
#include "raster/bake_grid.h"

#define BAKE_LEVELS_MAX 16

typedef struct bake_tile {
    const ff_terrain_info *info;
    uint32_t number;   /* of the tile that is loaded */
    uint16_t *source;  /* (2^n+1)^2, south to north */
    uint16_t *decoded; /* the same grid as every decoder will see it, filled level by level */
    uint8_t *filled;   /* the same grid, 1 for samples that were filled; NULL: there are none */
    bake_blob level[BAKE_LEVELS_MAX]; /* [0]: the root; [l]: refinements of level l-1 */
} bake_tile;

/* `info` must outlive the tile. 0 or -1 (said). */
int bake_tile_open(bake_tile *tile, const ff_terrain_info *info);
void bake_tile_close(bake_tile *tile);
/* Reads tile `number` from the grid (uint16, south to north), the grid's rim repeated beyond its
 * edge. `filled`: a byte beside each height, or closed. 0 or -1 (said). */
int bake_tile_load(bake_tile *tile, const bake_grid *grid, const bake_grid *filled,
                   uint32_t number);
/* Encodes all levels of the loaded tile into tile->level. 0 or -1 (said). */
int bake_tile_encode(bake_tile *tile);

#endif
