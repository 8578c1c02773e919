/* Which nodes of a pack belong to a part of it, that is to be drawn down to a level up to its edge.
 *
 * A node may be drawn split only beside edge neighbours of its own level. So each level has a ring:
 * where nodes are split, the parents of all nodes beside them are split, too. In the sheet of nodes
 * of a level (ff_shape_sheet) what is split is a rectangle. */
#ifndef EXPORT_PART_H
#define EXPORT_PART_H

#include "export_place.h"

typedef struct export_rectangle {
    uint32_t left, bottom, right, top; /* nodes of a level, all inside */
} export_rectangle;

typedef struct export_part {
    const ff_terrain_info *info;
    uint32_t level;
    export_rectangle split[FF_KEY_LEVEL_MAX + 1]; /* of levels below `level` */
    export_rectangle shown[FF_KEY_LEVEL_MAX + 1]; /* nodes with ground of the window */
} export_part;

/* `window`: samples of the finest level. */
void export_part_make(const ff_terrain_info *info, const export_window *window, uint32_t level,
                      export_part *part);
/* 1 when the part has the children of a node. */
int export_part_splits(const export_part *part, ff_key key);
/* 1 when the part has a node's image: down to its level, and below that where that is the finest.
 */
int export_part_pictures(const export_part *part, ff_key key);

#endif
