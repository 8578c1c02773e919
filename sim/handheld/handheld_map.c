/* A map in place of the flight. */
#include "handheld.h"

#include <string.h>

void handheld_map(handheld *device, int32_t ground_wu, c3d_camera *camera)
{
    const int32_t place_wu[3] = { camera->pos_wu[0], camera->pos_wu[1], ground_wu };
    int64_t px_wu_q8 = (int64_t)device->options->map_m * FF_WU_PER_METRE << 8;
    ff_map map = ff_map_make(place_wu, camera->yaw, px_wu_q8, camera);
    ff_map_show show = { .contour_wu = ff_map_contour_wu(px_wu_q8), .has_place = 1 };
    ff_quality quality = device->options->quality;
    memcpy(show.place_wu, place_wu, sizeof show.place_wu);
    quality.measure = FF_MEASURE_PIXELS;
    quality.error_px_q8 = FF_MAP_ERROR_PX_Q8;
    quality.triangles_max = ff_map_triangles(device->width, device->height);
    if (!device->map_told) ff_client_set_quality(device->client, &quality);
    device->map_told = 1;
    (void)ff_client_set_map(device->client, &show); /* without pictures there is none */
    ff_map_camera(&map, camera);
}
