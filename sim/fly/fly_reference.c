#include "fly_reference.h"

#include <stdlib.h>
#include <string.h>

#define MEMORY_BYTES ((size_t)192 << 20) /* the client's pools at their largest */
#define ERROR_PX_Q8  64                  /* a quarter of a pixel: finer ground shows the same */
#define VIEW_WU      (200000 * FF_WU_PER_METRE)
#define STEP_US      20000
#define STEPS_MAX    20000
#define STEPS_IDLE   10 /* this many steps without news: nothing is missing any more */

int fly_reference_open(fly_reference *reference, const fly_options *options, const ff_pack *pack,
                       const sys_surface_api *surface_api, const sys_surface_desc *surface,
                       const struct c3d_backend *backend)
{
    memset(reference, 0, sizeof *reference);
    reference->surface_api = surface_api;
    int rc = surface_api->open(surface, &reference->surface);
    if (rc != FF_OK) {
        reference->surface = NULL;
        return rc;
    }
    reference->memory = malloc(MEMORY_BYTES);
    if (!reference->memory) return FF_ERR_MEMORY;
    ff_client_desc desc = { .memory = reference->memory,
                            .memory_bytes = MEMORY_BYTES,
                            .pack = pack,
                            .surface_api = surface_api,
                            .backend = backend,
                            .width = options->size.width,
                            .height = options->size.height,
                            .no_prefetch = 1,
                            .quality = { .measure = FF_MEASURE_PIXELS,
                                         .error_px_q8 = ERROR_PX_Q8,
                                         .sigma_q8 = 320,
                                         .view_wu = VIEW_WU },
                            .frame_format = options->backend == FLY_SOFT ? C3D_RGBA8888
                                                                         : C3D_RGB565 };
    return ff_client_create(&desc, &reference->client);
}

int fly_reference_draw(fly_reference *reference, const c3d_camera *camera, uint8_t *rgb)
{
    int rc = reference->surface_api->make_current(reference->surface);
    if (rc != FF_OK) return rc;
    for (unsigned step = 0, idle = 0; idle < STEPS_IDLE; step++) {
        if (step == STEPS_MAX) return FF_ERR_AGAIN;
        reference->now_us += STEP_US;
        int moved = ff_client_work(reference->client, reference->now_us);
        moved |= ff_client_update(reference->client, reference->now_us, camera);
        idle = moved ? 0 : idle + 1;
    }
    ff_client_draw(reference->client);
    return c3d_read_rgb(ff_client_device(reference->client), rgb);
}

void fly_reference_close(fly_reference *reference)
{
    if (reference->surface) (void)reference->surface_api->make_current(reference->surface);
    if (reference->client) ff_client_destroy(reference->client);
    if (reference->surface) reference->surface_api->close(reference->surface);
    free(reference->memory);
    memset(reference, 0, sizeof *reference);
}
