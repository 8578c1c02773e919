/* Strip masks: 16-bit triangle-strip indices into a node's grid of (2^k+1)^2 vertices, made once
 * and shared by all nodes (Hybrid, section 7.3 and figure 20; Planet's edge strip masks).
 *
 * A node whose neighbours are all at least as fine is drawn as one strip, FF_STRIP_FULL. Else its
 * inside (one ring of cells left out) is FF_STRIP_INNER and each side is a border strip:
 * FF_STRIP_SIDE(side, difference) joins the inside to a border that uses every 2^difference-th
 * vertex. All triangles run counter-clockwise seen from above; rows are joined by degenerate
 * triangles. Cell diagonals: from south-west to north-east in every cell of FULL and INNER.
 */
#ifndef FF_STRIPS_H
#define FF_STRIPS_H

#include "../../protocol/ff_key.h"

#include <stddef.h>

#define FF_STRIP_FULL                   0
#define FF_STRIP_INNER                  1
#define FF_STRIP_SIDE(side, difference) (2 + (difference)*FF_SIDE_COUNT + (side))

typedef struct ff_strips {
    uint16_t count;     /* of strips: 2 + 4*(k+1) */
    uint16_t first[32]; /* strip i has indices first[i] .. first[i]+length[i]-1 */
    uint16_t length[32];
    uint16_t triangles[32]; /* not degenerate ones */
    uint16_t index[8192];
} ff_strips;

/* node_log2 1..5 (1: INNER is empty). FF_OK or FF_ERR_RANGE. */
int ff_strips_make(ff_strips *strips, unsigned node_log2);

/* Indices of all strips of such a node together. */
uint32_t ff_strips_indices(unsigned node_log2);

/* The strips that draw a node with the given mask of coarser sides: count (1, or INNER and four
 * sides), ids into `strip`. */
unsigned ff_strips_for(unsigned coarser, uint8_t strip[5]);

#endif
