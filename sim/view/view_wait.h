/* What the emulator draws with while no terrain is known: a device of its own on the window's
 * context, for a plain ground and text. The client's device comes with the terrain. */
#ifndef VIEW_WAIT_H
#define VIEW_WAIT_H

#include "../../common3d/c3d.h"

typedef struct view_wait {
    c3d_device *device;
    void *memory;
} view_wait;

/* Begins and ends an empty frame; opens the device at the first call. NULL when that is not
 * possible. */
c3d_device *view_wait_draw(view_wait *wait, const struct c3d_backend *backend,
                           const sys_surface_api *surface_api, const c3d_camera *camera);
/* May be called when nothing was opened. The context is current. */
void view_wait_close(view_wait *wait);

#endif
