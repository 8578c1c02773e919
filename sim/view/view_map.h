/* The emulator's map: the same ground from straight above, with contours, a scale and the pilot's
 * place; and the way from the flight to it and back. */
#ifndef VIEW_MAP_H
#define VIEW_MAP_H

#include "view_fly.h"

typedef struct view_map {
    uint8_t wanted;   /* 1: shown, or on the way there */
    uint8_t contours; /* 1: in flight, too */
    uint8_t dragging;
    uint32_t part_q16; /* of the way to the flight: 65536 there, 0 the map */
    ff_map map;
    int drag_x, drag_y;
    int64_t px_wu_q8; /* of the picture: wu a pixel in its middle */
    ff_map_show told; /* to the client */
} view_map;

/* 1: it is seen, or the way to it or from it. */
static inline int view_map_shown(const view_map *map) { return map->part_q16 < 65536; }

/* Shows the map of where the pilot is, or leads back to the flight; at once when not `smoothly`. */
void view_map_toggle(view_map *map, const view_fly *fly, const ff_client *client, int smoothly);
/* Takes a drag or the wheel while the map is wanted. */
void view_map_pointer(view_map *map, enum sys_pointer_action action, int x, int y, int button);
/* Moves by what keys are held, on the way by dt_us; *camera is what is seen. 1 when the ground is
 * to have a map's quality. */
int view_map_step(view_map *map, const view_fly *fly, int64_t dt_us, const ff_client *client,
                  c3d_camera *camera);
/* Has the client draw contours and the pilot's place as they are now. */
void view_map_tell(view_map *map, const view_fly *fly, ff_client *client);

#endif
