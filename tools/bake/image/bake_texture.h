/* One image of the ground, as a terrain's flags say: a picture (protocol/picture), or a JPEG. */
#ifndef BAKE_TEXTURE_H
#define BAKE_TEXTURE_H

#include "bake_image.h"

/* What clients see of a node's parent, and which of its children the node is; NULL: a root. */
typedef struct bake_texture_above {
    const uint8_t *rgb;
    unsigned quadrant;
} bake_texture_above;

/* Room that coding takes, and for what is coded. 0 or -1 (said). */
typedef struct bake_texture_room {
    void *picture;
    uint8_t *coded;
} bake_texture_room;

int bake_texture_room_make(bake_texture_room *room, const ff_terrain_info *info);
void bake_texture_room_free(bake_texture_room *room);

/* Codes `rgb`, top row first, to room->coded; `decoded` receives what clients see.
 * Bytes, or -1 (said). */
int bake_texture_code(const bake_texture_room *room, const ff_terrain_info *info, int quality,
                      bake_texture_above above, const uint8_t *rgb, uint8_t *decoded);

#endif
