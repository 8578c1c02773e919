#include "reference.h"

#include <math.h>

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void ref_camera_of(const c3d_camera *camera, ref_camera *ref)
{
    double turn = 2 * REF_PI / 65536, yaw = camera->yaw * turn, pitch = camera->pitch * turn,
           roll = camera->roll * turn;
    const double level_right[3] = { cos(yaw), -sin(yaw), 0 };
    const double level_up[3] = { -sin(yaw) * sin(pitch), -cos(yaw) * sin(pitch), cos(pitch) };
    const double forward[3] = { sin(yaw) * cos(pitch), cos(yaw) * cos(pitch), sin(pitch) };
    for (int axis = 0; axis < 3; axis++) { /* roll clockwise: the right hand sinks */
        ref->pos_wu[axis] = camera->pos_wu[axis];
        ref->right[axis] = level_right[axis] * cos(roll) - level_up[axis] * sin(roll);
        ref->up[axis] = level_right[axis] * sin(roll) + level_up[axis] * cos(roll);
        ref->forward[axis] = forward[axis];
    }
    ref->focal_px = camera->focal_q8 / 256.0;
    ref->half_px[0] = camera->width / 2.0;
    ref->half_px[1] = camera->height / 2.0;
}

void ref_to_eye(const ref_camera *ref, const double direction_wu[3], double eye_wu[3])
{
    eye_wu[0] = dot(direction_wu, ref->right);
    eye_wu[1] = dot(direction_wu, ref->up);
    eye_wu[2] = dot(direction_wu, ref->forward);
}

int ref_project_direction(const ref_camera *ref, const double direction_wu[3], double px[2])
{
    double eye[3];
    ref_to_eye(ref, direction_wu, eye);
    if (eye[2] <= 0) return 0;
    px[0] = ref->half_px[0] + eye[0] * ref->focal_px / eye[2];
    px[1] = ref->half_px[1] - eye[1] * ref->focal_px / eye[2];
    return 1;
}

int ref_project(const ref_camera *ref, const double point_wu[3], double px[2])
{
    const double direction[3] = { point_wu[0] - ref->pos_wu[0], point_wu[1] - ref->pos_wu[1],
                                  point_wu[2] - ref->pos_wu[2] };
    return ref_project_direction(ref, direction, px);
}

int ref_in_window(const ref_camera *ref, const double px[2], double margin_px)
{
    return fabs(px[0] - ref->half_px[0]) <= ref->half_px[0] + margin_px &&
           fabs(px[1] - ref->half_px[1]) <= ref->half_px[1] + margin_px;
}

double ref_node_f(const ref_camera *ref, const double middle_wu[3], double edge_wu, double c)
{
    double d[3];
    for (int axis = 0; axis < 3; axis++) d[axis] = middle_wu[axis] - ref->pos_wu[axis];
    return sqrt(dot(d, d)) / (edge_wu * c);
}

double ref_error_px(const ref_camera *ref, const double low_wu[3], const double high_wu[3],
                    double error_wu)
{
    double d[3];
    for (int axis = 0; axis < 3; axis++)
        d[axis] = fmax(0,
                       fmax(low_wu[axis] - ref->pos_wu[axis], ref->pos_wu[axis] - high_wu[axis]));
    return error_wu * ref->focal_px / sqrt(dot(d, d));
}

double ref_sideways_max(double error_px, double z, double focal_px)
{
    return error_px * z / focal_px;
}

double ref_forwards_max(double error_px, double z, double half_width_px)
{
    return error_px <= 0 ? 0 : z * (1 - half_width_px / (error_px + half_width_px));
}

double ref_panorama_error_px(const ref_camera *ref, const double taken_wu[3],
                             const double point_wu[3])
{
    const double direction[3] = { point_wu[0] - taken_wu[0], point_wu[1] - taken_wu[1],
                                  point_wu[2] - taken_wu[2] };
    double shown_px[2], true_px[2];
    if (!ref_project_direction(ref, direction, shown_px) || !ref_project(ref, point_wu, true_px))
        return -1;
    if (!ref_in_window(ref, shown_px, 0) && !ref_in_window(ref, true_px, 0)) return -1;
    return hypot(shown_px[0] - true_px[0], shown_px[1] - true_px[1]);
}

static double clamped(double height) { return fmin(65535, fmax(0, height)); }

double ref_predict_inside(double a, double b, double c, double d)
{
    return clamped((9 * (b + c) - a - d) / 16);
}

double ref_predict_end(double a, double b, double c) { return clamped((7 * a + 10 * b - c) / 16); }

double ref_predict_centre(const double cross[4], const double corner[4])
{
    return clamped((7 * (cross[0] + cross[1] + cross[2] + cross[3]) -
                    3 * (corner[0] + corner[1] + corner[2] + corner[3])) /
                   16);
}

double ref_cell_height(const double corner[4], double u, double v)
{
    if (u >= v) return corner[0] + (corner[1] - corner[0]) * u + (corner[3] - corner[1]) * v;
    return corner[0] + (corner[2] - corner[0]) * v + (corner[3] - corner[2]) * u;
}
