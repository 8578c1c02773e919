/* What becomes of a node whose mesh is there: its strips, the images that it or its parts wear,
 * pictures thrown on it, contours over it. Apart from where meshes are made, whose scratch would
 * else lie on the stack below its own. */
#ifndef FF_NODE_DRAW_H
#define FF_NODE_DRAW_H

#include "ff_terrain_view.h"

/* `draw` has the mesh and what all calls have in common; it comes back dressed for the node's first
 * part. `entry` is the node's, or NULL. */
void ff_node_draw(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                  const ff_view_node *entry, c3d_draw *draw);
/* Contours over it: view->contours has an interval. `ground` is the call that all nodes have in
 * common. */
void ff_node_contours(ff_terrain_view *view, const ff_terrain_info *info, const ff_drawn *drawn,
                      const c3d_draw *ground);

#endif
