/* Pictures that were made without a graphics library, into a window that has one: a device of the
 * window's GL shows each as an overlay. */
#ifndef VIEW_BLIT_H
#define VIEW_BLIT_H

#include "../../common3d/c3d.h"

typedef struct view_blit {
    c3d_device *device; /* of the window; NULL: not open */
    void *memory;
    uint8_t *rgb, *rgba; /* the picture; the texture, its sizes rounded up to powers of two */
    int width, height, texture_width, texture_height;
    int window_width, window_height;
} view_blit;

/* Opens a blit for pictures of width x height, in a window of that size at first. The window's
 * context is current. FF_OK or an error of c3d_open. */
int view_blit_open(view_blit *blit, const struct c3d_backend *backend,
                   const sys_surface_api *surface_api, int width, int height);
/* May be called when nothing was opened. */
void view_blit_close(view_blit *blit);
/* Fills the window with the finished frame of `device`. */
int view_blit_show(view_blit *blit, c3d_device *device);

#endif
