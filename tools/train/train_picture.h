/* Learning the tables of pictures (SPEC.md, 5.2) from packs of pictures. */
#ifndef TRAIN_PICTURE_H
#define TRAIN_PICTURE_H

#include "../../protocol/picture/ff_picture_local.h"

#define TRAIN_PICTURE_LEVELS 16

/* All images of a pack, as they are in it. */
typedef struct train_pictures {
    const char *path;
    uint32_t tiles;
    unsigned log2, levels;
    uint8_t *rgb[TRAIN_PICTURE_LEVELS]; /* of all nodes of a level, tile by tile, by their codes */
    uint8_t *has[TRAIN_PICTURE_LEVELS]; /* 0: it has none */
} train_pictures;

/* 0 or -1 (said). */
int train_pictures_open(train_pictures *pictures, const char *path);
void train_pictures_close(train_pictures *pictures);

/* What is learned from: as many sums and counts as there are weights and decisions. */
typedef struct train_picture_sums {
    double weight[FF_PICTURE_ROWS][FF_PICTURE_KNOWN][FF_PICTURE_KNOWN + 1];
    double corner[FF_PICTURE_KINDS], corners[FF_PICTURE_KINDS];
    double decision[FF_PICTURE_CONTEXTS][2];
} train_picture_sums;

/* Codes all of them from the root down, several qualities; `count` of such grounds. 0 or -1 (said).
 */
int train_pictures_learn(const train_pictures *pictures, unsigned count, ff_picture_tables *tables);
/* Tells bytes of each level and the error, beside the bytes of JPEGs with that error. 0 or -1
 * (said). */
int train_pictures_measure(const train_pictures *pictures, const ff_picture_tables *tables);
/* 0 or -1 (said). */
int train_pictures_write(const char *path, const ff_picture_tables *tables);

#endif
