/* The top of a tile: its levels down to that of the blocks' nodes, from a lattice of the samples
 * that are vertices there. So memory does not grow with a tile but by a 2^-14 of its samples.
 *
 * It is decoded first, as blocks start from it. Their samples tell how far all nodes above are from
 * the ground; then its records can be made. */
#ifndef BAKE_TOP_H
#define BAKE_TOP_H

#include "bake_levels.h"

typedef struct bake_top {
    bake_levels levels;
    uint32_t stride_log2;    /* samples from a point of the lattice to the next */
    uint32_t tile;           /* that is loaded; UINT32_MAX: none */
    const bake_known *known; /* of all nodes, while records are made: bake_top_number */
} bake_top;

/* Blocks of 2^block_log2 samples a side, a tile at most and a node at least. `info` must outlive
 * the top. Close it whatever comes back: 0 or -1 (said). */
int bake_top_open(bake_top *top, const ff_terrain_info *info, uint32_t block_log2);
void bake_top_close(bake_top *top);
/* Reads a tile's lattice from the samples, and decodes it; nothing when it is there already. 0 or
 * -1 (said). */
int bake_top_load(bake_top *top, const bake_samples *samples, uint32_t tile);
/* Makes the records of the loaded tile, when all of its nodes are known. 0 or -1 (said). */
int bake_top_encode(bake_top *top, const bake_known *known);

/* The level of the blocks' nodes. */
static inline uint32_t bake_top_bottom(const bake_top *top) { return top->levels.bottom; }
/* Samples along a block's side: 2^that and one. */
static inline uint32_t bake_top_block_log2(const bake_top *top)
{
    return top->levels.info->tile_log2 - top->levels.bottom;
}
/* Number of a node among all down to the blocks', level by level. */
static inline size_t bake_top_number(ff_key key)
{
    return (((size_t)1 << 2 * ff_key_level(key)) - 1) / 3 + ff_key_code(key);
}
/* The heights that are decoded of a node, by its south-west one. */
const uint16_t *bake_top_decoded(const bake_top *top, ff_key key);

#endif
