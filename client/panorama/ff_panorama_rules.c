#include "ff_panorama_rules.h"
#include "../../protocol/ff_assert.h"

const ff_face_axis ff_face_axes[FF_FACE_COUNT] = {
    [FF_FACE_NORTH] = { 1, 1 }, [FF_FACE_EAST] = { 0, 1 }, [FF_FACE_SOUTH] = { 1, -1 },
    [FF_FACE_WEST] = { 0, -1 }, [FF_FACE_UP] = { 2, 1 },   [FF_FACE_DOWN] = { 2, -1 }
};

int64_t ff_panorama_sideways_max(int64_t error_px_q8, int64_t z_wu, int64_t focal_q8)
{
    FF_ASSERT(focal_q8 > 0 && z_wu > 0);
    return c3d_muldiv64(error_px_q8, z_wu, focal_q8);
}

int64_t ff_panorama_forwards_max(int64_t error_px_q8, int64_t z_wu, int64_t half_width_px_q8)
{
    FF_ASSERT(half_width_px_q8 >= 0 && z_wu > 0);
    if (error_px_q8 <= 0) return 0;
    return c3d_muldiv64(error_px_q8, z_wu, error_px_q8 + half_width_px_q8);
}

int ff_panorama_left_behind(const int32_t viewer_wu[3], const int32_t taken_wu[3], int32_t z_wu)
{
    int64_t most_wu = z_wu / 2;
    FF_ASSERT(z_wu > 0);
    for (int axis = 0; axis < 3; axis++) {
        int64_t away_wu = (int64_t)viewer_wu[axis] - taken_wu[axis];
        if (away_wu > most_wu || away_wu < -most_wu) return 1;
    }
    return 0;
}

#define RAY_MAX (INT64_C(1) << 38)

/* A view as four rays from the camera: world directions of any length below RAY_MAX. */
typedef struct view_rays {
    int64_t ray[4][3];
} view_rays;

static void make_rays(const c3d_camera *camera, const c3d_rotation *rotation, view_rays *rays)
{
    int64_t half_x_q8 = (int64_t)camera->width * 128, half_y_q8 = (int64_t)camera->height * 128;
    for (int corner = 0; corner < 4; corner++) {
        int64_t x = corner == 0 || corner == 3 ? -half_x_q8 : half_x_q8; /* round the rim */
        int64_t y = corner < 2 ? -half_y_q8 : half_y_q8;
        for (int axis = 0; axis < 3; axis++) {
            rays->ray[corner][axis] = (x * rotation->m[0][axis] + y * rotation->m[1][axis] +
                                       (int64_t)camera->focal_q8 * rotation->m[2][axis]) >>
                                      24;
            FF_ASSERT(rays->ray[corner][axis] > -RAY_MAX && rays->ray[corner][axis] < RAY_MAX);
        }
    }
}

/* A face's pyramid is |right| <= forward, |up| <= forward along its axes: the view touches it
 * unless all its rays lie beyond one of those four planes. */
static int view_outside_face(const view_rays *rays, int forward_axis, int sign)
{
    FF_ASSERT((sign == 1 || sign == -1) && forward_axis >= 0 && forward_axis < 3);
    for (int other = 0; other < 3; other++) {
        if (other == forward_axis) continue;
        for (int side = -1; side <= 1; side += 2) {
            int outside = 0;
            for (int corner = 0; corner < 4; corner++)
                outside += sign * rays->ray[corner][forward_axis] < side * rays->ray[corner][other];
            if (outside == 4) return 1;
        }
    }
    return 0;
}

/* The view's own planes: |x| * d <= z * half etc. in eye space; the face is outside when its four
 * corner rays are beyond one. */
static int face_outside_view(const c3d_camera *camera, const c3d_rotation *rotation,
                             int forward_axis, int sign)
{
    int64_t half_q8[2] = { (int64_t)camera->width * 128, (int64_t)camera->height * 128 };
    unsigned beyond_all = 0xf; /* bit per plane: every corner so far is beyond it */
    for (int corner = 0; corner < 4; corner++) {
        int64_t eye[3];
        int ray[3];
        ray[forward_axis] = sign;
        ray[(forward_axis + 1) % 3] = corner & 1 ? 1 : -1;
        ray[(forward_axis + 2) % 3] = corner & 2 ? 1 : -1;
        for (int row = 0; row < 3; row++)
            eye[row] = ((int64_t)ray[0] * rotation->m[row][0] +
                        (int64_t)ray[1] * rotation->m[row][1] +
                        (int64_t)ray[2] * rotation->m[row][2]) >>
                       8;
        /* half of the cube's diagonal, Q22; times a focal distance of 31 bits */
        FF_ASSERT(eye[2] > -(1 << 24) && eye[2] < 1 << 24);
        unsigned beyond = 0;
        for (int i = 0; i < 2; i++) {
            int64_t reach = eye[2] * half_q8[i], off = eye[i] * camera->focal_q8;
            beyond |= (unsigned)(off > reach) << (2 * i) | (unsigned)(-off > reach) << (2 * i + 1);
        }
        beyond_all &= beyond;
    }
    return beyond_all != 0;
}

unsigned ff_panorama_faces_in_view(const c3d_camera *camera)
{
    c3d_rotation rotation;
    view_rays rays;
    unsigned faces = 0;
    c3d_rotation_from_camera(camera, &rotation);
    make_rays(camera, &rotation, &rays);
    for (unsigned i = 0; i < FF_FACE_COUNT; i++)
        if (!view_outside_face(&rays, ff_face_axes[i].axis, ff_face_axes[i].sign) &&
            !face_outside_view(camera, &rotation, ff_face_axes[i].axis, ff_face_axes[i].sign))
            faces |= 1u << i;
    FF_ASSERT(faces != 0); /* the ray through the middle meets one */
    return faces;
}
