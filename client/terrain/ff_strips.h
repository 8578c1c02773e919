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

/* Parts of a node: squares of one or more cells, 8 x 8 or, in smaller nodes, one for each cell. A
 * bit each, row * 8 + column from the south-west. A triangle is part of the square in which its
 * middle lies. */
#define FF_SQUARES_LOG2 3
#define FF_SQUARES_ROW  (1u << FF_SQUARES_LOG2)
typedef uint64_t ff_squares;

static inline unsigned ff_squares_log2(unsigned node_log2)
{
    return node_log2 < FF_SQUARES_LOG2 ? node_log2 : FF_SQUARES_LOG2;
}

/* What is left of such a strip without some squares, at most three times as many indices, written
 * to out[count] and so on: how many there are then. Triangles keep their corners' order, so that
 * they are drawn alike, pixel for pixel. */
uint32_t ff_strips_without(const uint16_t *index, uint32_t length, unsigned node_log2,
                           ff_squares squares, uint16_t *out, uint32_t count);
/* Indices that all strips of such a node take so, at most: they have two for each height and four
 * more. */
#define FF_STRIPS_PART(heights) (3 * (2 * (heights) + 4))
static inline uint32_t ff_strips_part(uint32_t heights) { return FF_STRIPS_PART(heights); }

#endif
