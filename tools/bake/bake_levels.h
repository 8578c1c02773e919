/* Several levels of a tile below one of its nodes: from heights to records, level by level in
 * Morton order. The heights are a lattice, so that the levels above those that are near the samples
 * are encoded without them. */
#ifndef BAKE_LEVELS_H
#define BAKE_LEVELS_H

#include "../../protocol/codec/ff_codec.h"
#include "bake_blob.h"
#include "bake_samples.h"

#define BAKE_LEVELS_MAX 16

/* What the payload above tells of a node. */
typedef struct bake_known {
    uint8_t code;   /* of its geometric error */
    uint8_t filled; /* 1: some of its ground was */
    uint8_t leaf;   /* 1: nothing finer need be stored */
} bake_known;

typedef struct bake_levels {
    const ff_terrain_info *info;
    uint32_t bottom;   /* the last level: the cells of its nodes are those of the lattice */
    size_t pitch;      /* of the lattice: points a row */
    uint16_t *source;  /* south to north */
    uint8_t *marks;    /* beside the source, bits of enum bake_mark; NULL: all are measured */
    uint16_t *decoded; /* the same as every decoder will see it, filled level by level */
    bake_blob level[BAKE_LEVELS_MAX]; /* [0]: the root; [l]: refinements of level l-1 */
    /* What is known of a decoded node whose south-west point is `at`, its cells `cell` points wide.
     * `leaf` is looked at on the last level, elsewhere it is found out. */
    bake_known (*know)(const struct bake_levels *levels, ff_key key, size_t at, uint32_t cell);
} bake_levels;

/* The lattices of `side` points a side, and no records. Close it whatever comes back: 0 or -1
 * (said). */
int bake_levels_open(bake_levels *levels, const ff_terrain_info *info, uint32_t bottom,
                     size_t side);
void bake_levels_close(bake_levels *levels);
/* Gives the lattices of `side` points a side, which are open, marks. 0 or -1 (said). */
int bake_levels_mark(bake_levels *levels, size_t side);

/* Decodes a tile down to the last level, and makes no records. */
void bake_levels_decode(bake_levels *levels, uint32_t tile);
/* Makes all records of a tile down to the last level. 0 or -1 (said). */
int bake_levels_encode(bake_levels *levels, uint32_t tile);
/* The same of all below a node whose decoded heights lie in the lattice's first columns and rows;
 * of `node` the leaf is found out. */
int bake_levels_encode_below(bake_levels *levels, ff_key key, bake_known *node);

#endif
