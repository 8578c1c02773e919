/* Is the drawn ground whole? An exact check on integer vertices, made for every simulated frame.
 *
 * For a list of drawn nodes (all of a cut, or only what the view sees) it forms the triangles their strips draw and checks that
 *   - keys, origins and cells agree, and no node covers another one: each ground point is drawn at most once;
 *   - every triangle is counter-clockwise from above, inside its node, and together they cover each node exactly;
 *   - every edge between triangles is used once in each direction, so there is neither a gap nor a T-junction; an edge used only
 *     once is allowed on a node's border with no listed ground beyond it (the terrain's border, the end of the cut or of the view);
 *   - all triangles that share a vertex agree on its height, bit for bit.
 */
#ifndef SIM_WATERTIGHT_H
#define SIM_WATERTIGHT_H

#include "../client/terrain/ff_tree.h"

/* 1: whole. 0: not, and `why` (may be NULL) says what and where in one line; also 0 when out of memory. */
int sim_watertight_check(const ff_terrain_info *info, const ff_drawn *list, uint32_t count, char *why, size_t why_bytes);

#endif
