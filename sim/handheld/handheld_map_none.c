/* Stands in for handheld_map.c in builds without maps: the camera stays. */
#include "handheld.h"

void handheld_map(handheld *device, int32_t ground_wu, c3d_camera *camera)
{
    (void)device, (void)ground_wu, (void)camera;
}
