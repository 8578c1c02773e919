/* Geometric error of a node: how far the triangles drawn from its decoded heights are from the
 * ground. */
#ifndef BAKE_ERROR_H
#define BAKE_ERROR_H

#include "../../protocol/shape/ff_shape.h"

#include <stddef.h>

/* A node as it is drawn: vertices `cell` samples apart, diagonals of cells from south-west to
 * north-east (client/terrain/ff_strips.h). It has ground as far as `extent` says: the cells that
 * it ends in are drawn narrower. */
typedef struct bake_drawn {
    const uint16_t *vertex; /* the south-western one */
    size_t east, north;     /* entries from a vertex to the next one */
    uint32_t cell;
    ff_extent extent;
} bake_drawn;

/* Full-resolution samples of a part of the node: `first` from its south-west, as far as `size`,
 * both ends within. */
typedef struct bake_patch {
    const uint16_t *sample; /* the south-western one */
    const uint8_t *marks;   /* beside it, bits of enum bake_mark; NULL: all are measured */
    size_t pitch;           /* entries a row */
    ff_extent first, size;
} bake_patch;

/* The largest vertical distance, in height steps and rounded up, between the samples of a patch and
 * the triangles over it. So that of a node is the largest of the patches that make up its ground. 0
 * without ground. Integers only: exact. */
uint32_t bake_patch_error(const bake_patch *patch, const bake_drawn *drawn);
/* Of a whole node, whose vertices lie among the samples of a grid like the source's: both start at
 * its south-west sample and have `pitch` entries a row, and so do the marks. */
uint32_t bake_node_error(const uint16_t *source, const uint8_t *marks, const uint16_t *drawn,
                         size_t pitch, ff_extent extent, uint32_t cell);

#endif
