/* All tiles of a ground, in blocks over several threads, to the records of a pack. The blocks and
 * the threads change neither the records nor their order. */
#ifndef BAKE_TILES_H
#define BAKE_TILES_H

#include "image/bake_image.h"
#include "bake_block.h"

#define BAKE_BLOCK_LOG2 10

typedef struct bake_tiles {
    const ff_terrain_info *info;
    const bake_samples *samples; /* as many as the terrain has */
    const bake_image *image;     /* without levels: no textures */
    int texture_quality;
    int images_only;     /* 1: heights are neither made nor taken */
    uint32_t block_log2; /* memory grows with 4^that a job */
    uint32_t jobs;
    bake_off *off; /* NULL, or to be added to */
    void *context;
    /* Takes records of a section, as pack_writer_add does: one call at a time. 0 or -1 (said). */
    int (*take)(void *context, uint32_t section, const bake_blob *records, const bake_blob *above);
} bake_tiles;

/* 0 or -1 (said). */
int bake_tiles_make(const bake_tiles *tiles);
/* How many of so many jobs have work, and bytes of memory that they take: textures, and the records
 * of the tile's top, not counted. */
uint32_t bake_tiles_workers(const ff_terrain_info *info, uint32_t block_log2, uint32_t jobs);
double bake_tiles_bytes(const ff_terrain_info *info, uint32_t block_log2, uint32_t jobs);

#endif
