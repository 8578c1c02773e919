/* A small, complete pack in memory, made with the encoder. Tests serve it, fly over it and break
 * it. */
#ifndef PACK_FIXTURE_H
#define PACK_FIXTURE_H

#include "../../protocol/ff_pack.h"

typedef struct pack_fixture_desc {
    ff_terrain_info info; /* the fixture fills in the checksum; the caller sets the rest */
    /* Height in steps of sample (x, y) counted from the south-west */
    uint16_t (*height)(void *context, uint32_t x, uint32_t y);
    /* 1: that sample was filled; NULL: none was */
    int (*filled)(void *context, uint32_t x, uint32_t y);
    /* Colour of a point of the ground in wu, when info.texture_log2 is not 0. */
    void (*colour)(void *context, int64_t x_wu, int64_t y_wu, uint8_t rgb[3]);
    void *context;
    ff_list about; /* what the pack says of itself; empty: nothing */
    /* nodes of this level are leaves, and nothing is stored below; 0: nowhere */
    uint32_t leaf_level;
    /* nodes of this level are stubs, and nothing is stored below; 0: nowhere */
    uint32_t stub_level;
    /* images of this level have none below them; 0: all levels have images */
    uint32_t bare_level;
} pack_fixture_desc;

/* The pack's bytes (free them), or NULL. Textures are JPEGs, or pictures
 * of 32 x 32 texels at most where info.flags say so, north up, texel i at i/(T-1) of the
 * node's edge. */
uint8_t *pack_fixture_make(const pack_fixture_desc *desc, size_t *bytes);

/* tiles_x by tiles_y tiles of 2^tile_log2 cells (nodes of 2^3), 32 m a cell, 1 m a step, without
 * images, all zero but that. */
ff_terrain_info pack_fixture_info(uint8_t tile_log2, uint32_t tiles_x, uint32_t tiles_y);

/* Hills of several sizes, 0..~1500 steps; a pure function of its arguments. */
uint16_t pack_fixture_hills(void *context, uint32_t x, uint32_t y);
/* Samples 40..50, 20..30 were void. */
int pack_fixture_hole(void *context, uint32_t x, uint32_t y);
/* The usual pack: 2 by 2 tiles of 2^6 cells of hills. */
uint8_t *pack_fixture_usual(size_t *bytes);

#endif
