#include "view_wait.h"

#include "../../protocol/ff_terrain.h"

#include <stdlib.h>

#define GROUND_COLOUR 0xff604830u
#define NEAR_WU       FF_WU_PER_METRE
#define FAR_WU        (1000 * FF_WU_PER_METRE)
#define TEXT_BYTES    (272u << 10) /* the text's picture with its rim */

static c3d_device *open_device(view_wait *wait, const struct c3d_backend *backend,
                               const sys_surface_api *surface_api, const c3d_camera *camera)
{
    const c3d_desc desc = { .surface_api = surface_api,
                            .mesh_count = 1,
                            .strip_count = 1,
                            .texture_count = 1,
                            .mesh_vertices_max = 4,
                            .strip_indices_max = 4,
                            .frame_format = C3D_RGBA8888,
                            .width = camera->width,
                            .height = camera->height,
                            .texture_bytes = TEXT_BYTES };
    size_t bytes = c3d_bytes(backend, &desc);
    wait->memory = malloc(bytes);
    if (wait->memory && c3d_open(backend, &desc, wait->memory, bytes, &wait->device) < 0)
        wait->device = NULL;
    if (!wait->device) view_wait_close(wait);
    return wait->device;
}

c3d_device *view_wait_draw(view_wait *wait, const struct c3d_backend *backend,
                           const sys_surface_api *surface_api, const c3d_camera *camera)
{
    c3d_frame frame = { .camera = *camera, .clear_colour = GROUND_COLOUR };
    if (!wait->device && !open_device(wait, backend, surface_api, camera)) return NULL;
    frame.camera.near_wu = NEAR_WU;
    frame.camera.far_wu = FAR_WU;
    c3d_begin(wait->device, &frame);
    c3d_end(wait->device);
    return wait->device;
}

void view_wait_close(view_wait *wait)
{
    if (wait->device) c3d_close(wait->device);
    free(wait->memory);
    wait->device = NULL;
    wait->memory = NULL;
}
