#include "c3d_backend.h"

static int32_t clamp32(int64_t value, int32_t low, int32_t high)
{
    return (int32_t)(value < low ? low : value > high ? high : value);
}

/* The unrolled camera looks along (sin yaw cos pitch, cos yaw cos pitch, sin pitch); rolling turns
 * right and up about it. */
void c3d_rotation_from_camera(const c3d_camera *camera, c3d_rotation *rotation)
{
    int32_t sin_yaw = c3d_sin_q30(camera->yaw), cos_yaw = c3d_cos_q30(camera->yaw);
    int32_t sin_pitch = c3d_sin_q30(camera->pitch), cos_pitch = c3d_cos_q30(camera->pitch);
    int32_t sin_roll = c3d_sin_q30(camera->roll), cos_roll = c3d_cos_q30(camera->roll);
    const int32_t right[3] = { cos_yaw, -sin_yaw, 0 };
    const int32_t up[3] = { -c3d_mul_q30(sin_yaw, sin_pitch), -c3d_mul_q30(cos_yaw, sin_pitch),
                            cos_pitch };
    const int32_t forward[3] = { c3d_mul_q30(sin_yaw, cos_pitch), c3d_mul_q30(cos_yaw, cos_pitch),
                                 sin_pitch };
    for (int i = 0; i < 3; i++) {
        rotation->m[0][i] = c3d_mul_q30(right[i], cos_roll) - c3d_mul_q30(up[i], sin_roll);
        rotation->m[1][i] = c3d_mul_q30(right[i], sin_roll) + c3d_mul_q30(up[i], cos_roll);
        rotation->m[2][i] = forward[i];
        /* of unit vectors, rounding apart */
        C3D_ASSERT(rotation->m[0][i] <= C3D_ONE_Q30 + 4 && rotation->m[0][i] >= -C3D_ONE_Q30 - 4);
        C3D_ASSERT(rotation->m[1][i] <= C3D_ONE_Q30 + 4 && rotation->m[1][i] >= -C3D_ONE_Q30 - 4);
    }
}

/* d = width/2 / tan(fov/2). The angle is halved in units of 2^-32 turn: at 0.1 degrees half a
 * brad16 counts. */
int32_t c3d_focal_q8(int32_t fov_brad16, int32_t width_px)
{
    uint32_t half = (uint32_t)clamp32(fov_brad16, 18, 30948) << 15;
    int32_t sine = c3d_sin_turn32_q30(half),
            cosine = c3d_sin_turn32_q30(half + (UINT32_C(1) << 30));
    C3D_ASSERT(sine > 0 && cosine > 0);
    int64_t focal = ((int64_t)width_px * 128 * cosine + sine / 2) / sine;
    return clamp32(focal, 256, INT32_MAX);
}

/* An offset of 34 bits times a rotation of 31 bits exceeds 64 bits: so offsets are taken in two
 * halves, the lower of 16 bits. `high` is below 3 * 2^17 * 2^30 < 2^49; it counts 2^16 wu with 30
 * fraction bits, that is wu with 14 fraction bits. */
void c3d_to_eye_q14(const c3d_rotation *rotation, const int64_t offset_wu[3], int64_t eye_q14[3])
{
    for (int row = 0; row < 3; row++) {
        int64_t high = 0, low = 0;
        for (int i = 0; i < 3; i++) {
            high += rotation->m[row][i] * (offset_wu[i] >> 16);
            low += rotation->m[row][i] * (offset_wu[i] & 0xFFFF);
        }
        C3D_ASSERT(high > -(INT64_C(1) << 49) && high < INT64_C(1) << 49);
        eye_q14[row] = high + ((low + (1 << 15)) >> 16);
    }
}

void c3d_to_eye(const c3d_rotation *rotation, const int64_t offset_wu[3], int64_t eye_wu[3])
{
    int64_t eye_q14[3];
    c3d_to_eye_q14(rotation, offset_wu, eye_q14);
    for (int i = 0; i < 3; i++)
        eye_wu[i] = (eye_q14[i] + (1 << (C3D_EYE_SHIFT - 1))) >> C3D_EYE_SHIFT;
}
