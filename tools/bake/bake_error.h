/* Geometric error of a node: how far the triangles drawn from its decoded heights are from the
 * ground. */
#ifndef BAKE_ERROR_H
#define BAKE_ERROR_H

#include <stddef.h>
#include <stdint.h>

/* The largest vertical distance, in height steps and rounded up, between the full-resolution
 * samples of `source` and the triangles of a node of `cells` x `cells` cells, `cell` samples wide
 * each; cell diagonals run from south-west to north-east (client/terrain/ff_strips.h). Both arrays
 * start at the node's south-west sample and have `pitch` entries a row; of `drawn` only every
 * cell-th row and column is read. Integers only: exact. */
uint32_t bake_node_error(const uint16_t *source, const uint16_t *drawn, size_t pitch,
                         uint32_t cells, uint32_t cell);

#endif
