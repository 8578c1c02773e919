/* Is the drawn ground whole? An exact check on integer vertices, made for every simulated frame.
 *
 * For a list of drawn nodes (all of a cut, or only what the view sees) it checks that
 *   - keys, origins and cells agree, no node lies beyond the terrain's last sample, and no node
 *     covers another one: each ground point is drawn at most once;
 *   - the strips of each kind of node in the list draw triangles that are counter-clockwise from
 *     above, inside the node, and together cover it exactly; every edge inside is used once in each
 *     direction; what is used once lies on the node's border;
 *   - where two listed nodes touch along a side, whatever their levels, both draw the very same
 *     vertices there, and those have the same heights, bit for bit: neither a gap nor a T-junction.
 *     Nodes that touch in a corner agree on its height;
 *   - a node in which the ground ends is drawn up to its last column and row of samples and no
 *     further: there the shape places all its vertices beyond. Places follow from a vertex's
 *     sample alone, and never change their order: so what is whole on the grid is whole there.
 * A side with no listed ground beyond it may look as it likes: the terrain's border, the end of the
 * cut or of the view.
 *
 * Triangles are looked at once for each kind of node, nodes by their rims alone.
 * tests/rig/slow_watertight.c forms all triangles of all nodes and must come to the same verdict.
 */
#ifndef SIM_WATERTIGHT_H
#define SIM_WATERTIGHT_H

#include "../../client/terrain/ff_tree.h"

/* `frame`: ff_tree_frame of the tree that listed them. 1: whole. 0: not, and `why` (may be NULL)
 * says what and where in one line; also 0 when out of memory. */
int sim_watertight_check(const ff_terrain_info *info, const ff_frame *frame, const ff_drawn *list,
                         uint32_t count, char *why, size_t why_bytes);
/* The same of nodes of a tree with several grounds, each ground by itself. lowered: as its seams
 * lower them, which is known of nodes in view. */
int sim_watertight_check_tree(const ff_tree *tree, int lowered, const ff_drawn *list,
                              uint32_t count, char *why, size_t why_bytes);

#endif
