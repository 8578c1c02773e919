#include "reference_views.h"

#include <math.h>
#include <stdlib.h>

#define M FF_WU_PER_METRE

uint32_t ref_views(uint32_t share)
{
    const char *text = getenv("VIEWS");
    uint32_t all = text ? (uint32_t)strtoul(text, NULL, 10) : 1000000;
    return all / share ? all / share : 1;
}

int32_t ref_between(sys_random *random, int32_t lo, int32_t hi)
{
    return lo + (int32_t)sys_random_below(random, (uint32_t)(hi - lo) + 1);
}

/* Anywhere in the world, 240x320 to 640x480, 20 to 120 degrees wide. */
c3d_camera ref_ordinary_camera(sys_random *random)
{
    c3d_camera camera = { .yaw = ref_between(random, -65536, 65536),
                          .pitch = ref_between(random, -16384, 16384),
                          .near_wu = 64,
                          .far_wu = 100000 * M,
                          .width = (uint16_t)ref_between(random, 240, 640) };
    camera.height = (uint16_t)ref_between(random, 240, 480);
    if (sys_random_below(random, 2)) camera.roll = ref_between(random, -8192, 8192);
    camera.focal_q8 = c3d_focal_q8(ref_between(random, 20 * 65536 / 360, 120 * 65536 / 360),
                                   camera.width);
    for (int axis = 0; axis < 3; axis++)
        camera.pos_wu[axis] = ref_between(random, axis < 2 ? 0 : -400 * M,
                                          axis < 2 ? 4000000 * M : 9000 * M);
    return camera;
}

/* A point that shows in the window (or up to a quarter beyond), 0.25 m to 100 km deep, whole wu. */
void ref_point_in_view(sys_random *random, const ref_camera *ref, double point_wu[3])
{
    double depth = 64 * pow(2, sys_random_below(random, 18500) / 1000.0), eye[3] = { 0, 0, depth };
    for (int i = 0; i < 2; i++)
        eye[i] = ref_between(random, -1250, 1250) / 1000.0 * ref->half_px[i] * depth /
                 ref->focal_px;
    for (int axis = 0; axis < 3; axis++)
        point_wu[axis] = floor(ref->pos_wu[axis] + eye[0] * ref->right[axis] +
                               eye[1] * ref->up[axis] + depth * ref->forward[axis] + 0.5);
}

double ref_apart(const double a[2], const double b[2]) { return hypot(a[0] - b[0], a[1] - b[1]); }
