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

/* Heights along a tile's side at a level: 2^(k+level) + 1. */
uint32_t bake_unpack_side(const ff_terrain_info *info, uint32_t level);
/* Samples along a tile's western and southern rim, a byte each: 0 where one lies on a stub's
 * triangles, so that the tile beside may know it better. */
typedef struct bake_rims {
    uint8_t *west, *south;
} bake_rims;
/* Decodes one tile down to `level`, below stubs their triangles, into `heights` (side^2, south to
 * north). `known`: NULL, or room for a side's samples each. 0 or -1 (said). */
int bake_unpack_tile(const bake_unpack *unpack, uint32_t tile, uint32_t level, uint16_t *heights,
                     bake_rims *known);
/* What is told of a tile's root, and of the four children of a node. 0 or -1 (said). */
int bake_unpack_told_root(const bake_unpack *unpack, uint32_t tile, bake_told *told);
int bake_unpack_told_below(const bake_unpack *unpack, ff_key key, const bake_told *node,
                           bake_told told[4]);

#endif
