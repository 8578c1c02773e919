#include "sim_eye.h"

#include "../../protocol/ff_terrain.h"

#include <math.h>

#define PI        3.14159265358979323846
#define NEAREST_M 0.01 /* points nearer to the eye plane have no pixel */

void sim_eye_of(const c3d_camera *camera, sim_eye *e)
{
    double yaw = camera->yaw * (PI / 32768), pitch = camera->pitch * (PI / 32768),
           roll = camera->roll * (PI / 32768);
    double level_right[3] = { cos(yaw), -sin(yaw), 0 };
    double level_up[3] = { -sin(yaw) * sin(pitch), -cos(yaw) * sin(pitch), cos(pitch) };
    e->forward[0] = sin(yaw) * cos(pitch);
    e->forward[1] = cos(yaw) * cos(pitch);
    e->forward[2] = sin(pitch);
    for (int i = 0; i < 3; i++) { /* roll clockwise: the right hand sinks */
        e->pos_m[i] = (double)camera->pos_wu[i] / FF_WU_PER_METRE;
        e->right[i] = level_right[i] * cos(roll) - level_up[i] * sin(roll);
        e->up[i] = level_up[i] * cos(roll) + level_right[i] * sin(roll);
    }
    e->focal_px = camera->focal_q8 / 256.0;
    e->centre_px[0] = camera->width / 2.0;
    e->centre_px[1] = camera->height / 2.0;
}

void sim_eye_ray(const sim_eye *e, const double pixel[2], double along[3])
{
    for (int i = 0; i < 3; i++)
        along[i] = e->forward[i] + e->right[i] * (pixel[0] - e->centre_px[0]) / e->focal_px +
                   e->up[i] * (e->centre_px[1] - pixel[1]) / e->focal_px;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void sim_eye_turn(const sim_eye *e, const double direction[3], double turned[3])
{
    turned[0] = dot(direction, e->right);
    turned[1] = dot(direction, e->up);
    turned[2] = dot(direction, e->forward);
}

int sim_eye_project(const sim_eye *e, const double direction[3], double pixel[2])
{
    double turned[3];
    sim_eye_turn(e, direction, turned);
    if (turned[2] < NEAREST_M) return 0;
    pixel[0] = e->centre_px[0] + turned[0] * e->focal_px / turned[2];
    pixel[1] = e->centre_px[1] - turned[1] * e->focal_px / turned[2];
    return 1;
}
