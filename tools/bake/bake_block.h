/* A block: a node of a tile and all below it, from full-resolution heights, where the levels above
 * are decoded already (bake_top.h). A tile that is no larger than a block is one. */
#ifndef BAKE_BLOCK_H
#define BAKE_BLOCK_H

#include "bake_levels.h"
#include "bake_top.h"

/* How far decoded heights are from their samples; one on the line between two blocks counts for
 * both. */
typedef struct bake_off {
    double squares; /* sum of them, steps */
    uint64_t samples;
} bake_off;

typedef struct bake_block {
    bake_levels levels;  /* of its samples; records of the levels below the block's node */
    uint32_t side_log2;  /* of a block: 2^that places further each way */
    uint32_t apart_log2; /* places from a point of the levels' lattices to the next */
    ff_key key;          /* the node */
    bake_known above[BAKE_LEVELS_MAX]; /* what the block adds to its node and those above, by
                                          level */
} bake_block;

/* For blocks of nodes of the level `top` ends with; both must outlive the block. Close it whatever
 * comes back: 0 or -1 (said). */
int bake_block_open(bake_block *block, const bake_top *top);
void bake_block_close(bake_block *block);
/* Reads the block of a node with ground, the last samples repeated beyond their edge; where samples
 * are further apart, no more than there are. 0 or -1 (said). */
int bake_block_load(bake_block *block, const bake_samples *samples, ff_key key);
/* Encodes what is loaded, below the top of its tile. 0 or -1 (said). */
int bake_block_encode(bake_block *block, const bake_top *top);
/* How far what was encoded is from what was loaded. */
bake_off bake_block_off(const bake_block *block);

#endif
