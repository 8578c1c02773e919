#include "ff_face_view.h"

#include <string.h>

typedef struct face_axis {
    int32_t yaw, pitch;
    uint8_t axis;
    int8_t sign;
} face_axis;

static const face_axis face_axes[FF_FACE_COUNT] = {
    [FF_FACE_NORTH] = { 0, 0, 1, 1 },      [FF_FACE_EAST] = { 16384, 0, 0, 1 },
    [FF_FACE_SOUTH] = { 32768, 0, 1, -1 }, [FF_FACE_WEST] = { 49152, 0, 0, -1 },
    [FF_FACE_UP] = { 0, 16384, 2, 1 },     [FF_FACE_DOWN] = { 0, -16384, 2, -1 },
};

void ff_face_camera(const ff_get_panorama *request, enum ff_face_name face, c3d_camera *camera)
{
    memset(camera, 0, sizeof *camera);
    memcpy(camera->pos_wu, request->position_wu, sizeof camera->pos_wu);
    camera->yaw = face_axes[face].yaw;
    camera->pitch = face_axes[face].pitch;
    camera->focal_q8 = request->face_size * 128; /* half the width: 45 degrees to either side */
    camera->width = camera->height = request->face_size;
    camera->near_wu = ff_face_near_wu(request);
    camera->far_wu = request->back_wu;
}

int ff_face_sees_box(const ff_get_panorama *request, enum ff_face_name face, const ff_box *box)
{
    const face_axis *forward = &face_axes[face];
    const int64_t *low = box->lo, *high = box->hi;
    int64_t nearest = forward->sign > 0 ? low[forward->axis] : -high[forward->axis];
    int64_t farthest = forward->sign > 0 ? high[forward->axis] : -low[forward->axis];
    if (farthest > request->back_wu) farthest = request->back_wu;
    if (nearest > request->back_wu || farthest < ff_face_near_wu(request)) return 0;
    /* The pyramid is widest where the box is farthest: there it reaches `farthest` to every
     * side. */
    for (int i = 0; i < 3; i++)
        if (i != forward->axis && (low[i] > farthest || high[i] < -farthest)) return 0;
    return 1;
}
