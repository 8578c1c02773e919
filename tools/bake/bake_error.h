/* Geometric error of a node: how far the triangles drawn from its decoded heights are from the
 * ground. */
#ifndef BAKE_ERROR_H
#define BAKE_ERROR_H

#include "../../protocol/shape/ff_shape.h"

#include <stddef.h>

/* The largest vertical distance, in height steps and rounded up, between the full-resolution
 * samples of `source` and the triangles of a node whose cells are `cell` samples wide; cell
 * diagonals run from south-west to north-east (client/terrain/ff_strips.h). The node has ground as
 * far as `extent` says: beyond it nothing is compared, and the cells that it ends in are drawn
 * narrower. Both arrays start at the node's south-west sample and have `pitch` entries a row; of
 * `drawn` only every cell-th row and column is read. Integers only: exact. */
uint32_t bake_node_error(const uint16_t *source, const uint16_t *drawn, size_t pitch,
                         ff_extent extent, uint32_t cell);

#endif
