/* The rims of a node as its strips draw it: which vertices of each side are used. */
#ifndef SIM_RIM_H
#define SIM_RIM_H

#include "../../client/terrain/ff_strips.h"

/* Bit i of a side: its i-th vertex, counted to the east (south, north) or to the north (west,
 * east), is an end of a drawn edge. */
typedef struct sim_rim {
    uint64_t used[FF_SIDE_COUNT];
} sim_rim;

/* Grid index of the i-th vertex of a side, for nodes of n by n cells. */
unsigned sim_rim_vertex(unsigned n, enum ff_side side, unsigned i);

/* Forms the triangles of a node with `coarser` sides and checks that they tile the node exactly
 * (see sim_watertight.h). Returns NULL and the rims in *rim, or what is wrong. */
const char *sim_rim_of_strips(const ff_strips *strips, unsigned node_log2, unsigned coarser,
                              sim_rim *rim);

#endif
