/* The picture as it should be: the same view of the same pack, drawn by the same back end as finely
 * as the ground needs, with all images, no link and no panorama, however long it takes. */
#ifndef FLY_REFERENCE_H
#define FLY_REFERENCE_H

#include "fly_options.h"

typedef struct fly_reference {
    const sys_surface_api *surface_api;
    sys_surface *surface; /* of its own */
    void *memory;
    ff_client *client;
    int64_t now_us; /* a clock of its own */
} fly_reference;

/* FF_OK or an error of the surface or the client. `pack` must outlive the reference. Call close in
 * both cases. */
int fly_reference_open(fly_reference *reference, const fly_options *options, const ff_pack *pack,
                       const sys_surface_api *surface_api, const sys_surface_desc *surface,
                       const struct c3d_backend *backend);
/* The view's picture, RGB888 of the options' size. FF_OK, FF_ERR_AGAIN when it did not settle, or
 * an error of the back end. Leaves the reference's context current. */
int fly_reference_draw(fly_reference *reference, const c3d_camera *camera, uint8_t *rgb);
void fly_reference_close(fly_reference *reference);

#endif
