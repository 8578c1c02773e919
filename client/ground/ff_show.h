/* What the ways to draw (FF_SHOW_MODES of farfield.h) put over the ground of a node. */
#ifndef FF_SHOW_H
#define FF_SHOW_H

#include "ff_terrain_view.h"

/* `ground` is the call that has drawn the node, but for its strip. */
void ff_show_over(const ff_terrain_view *view, const ff_drawn *drawn, const c3d_draw *ground,
                  unsigned show);

#endif
