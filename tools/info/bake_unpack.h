/* Reading a pack back: what farfield-info and farfield-export share. */
#ifndef BAKE_UNPACK_H
#define BAKE_UNPACK_H

#include "../../platform/sys.h"
#include "../../protocol/ff_pack.h"

typedef struct bake_unpack {
    const char *path;
    sys_mapping mapping;
    ff_pack pack;
    ff_decoder *decoder;
    void *decoder_memory;
} bake_unpack;

/* What a pack tells of a node besides its heights. */
typedef struct bake_told {
    uint8_t error_code; /* its geometric error (ff_codec.h) */
    uint8_t has_filled; /* some of the ground below it was void in the source */
    uint8_t is_leaf;    /* nothing finer is stored: it is prediction */
    uint8_t is_stub;    /* nothing finer is stored, though there is finer ground */
} bake_told;

/* Maps and checks a pack. 0 or -1 (said). */
int bake_unpack_open(bake_unpack *unpack, const char *path);
void bake_unpack_close(bake_unpack *unpack);

/* Who goes over the heights of a level, block by block: memory does not grow with a tile. */
typedef struct bake_unpack_walk {
    void *context;
    /* 0: nothing is wanted of a node with ground, or of what is below it */
    int (*wants)(void *context, ff_key key);
    /* Takes what is below a node: side^2 heights of the level, south to north; below stubs those of
     * their triangles. `known` is 0 for such: on a rim the block beside may know better. NULL:
     * there are none. 0 or -1 (said). */
    int (*take)(void *context, ff_key key, uint32_t side, const uint16_t *heights,
                const uint8_t *known);
} bake_unpack_walk;

/* The level of the nodes that blocks are of, when the heights are those of `level`. */
uint32_t bake_unpack_block_level(uint32_t level);
/* Decodes all tiles down to `level`. 0 or -1 (said). */
int bake_unpack_heights(const bake_unpack *unpack, uint32_t level, const bake_unpack_walk *walk);
/* What is told of a tile's root, and of the four children of a node. 0 or -1 (said). */
int bake_unpack_told_root(const bake_unpack *unpack, uint32_t tile, bake_told *told);
int bake_unpack_told_below(const bake_unpack *unpack, ff_key key, const bake_told *node,
                           bake_told told[4]);

#endif
