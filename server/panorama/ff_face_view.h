/* The six views of a panorama's cube and what each can see. The cube is upright at O, aligned with
 * the axes of the frame there; position_wu of the requests below is a point of it. Pure functions.
 */
#ifndef FF_FACE_VIEW_H
#define FF_FACE_VIEW_H

#include "../../common3d/c3d.h"
#include "../../protocol/message/ff_message.h"
#include "../../protocol/shape/ff_shape.h"

/* Ground nearer than front_wu less one eighth is left out: the join with the client's own ground
 * overlaps by that much. */
static inline int32_t ff_face_near_wu(const ff_get_panorama *request)
{
    return request->front_wu - request->front_wu / 8;
}

/* 90 degrees wide, near and far plane by the request. NORTH, EAST, SOUTH, WEST look level; UP's
 * image has south at its top, DOWN's north. */
void ff_face_camera(const ff_get_panorama *request, enum ff_face_name face, c3d_camera *camera);

/* 1 when a box relative to O reaches into the face's pyramid between its near and far plane.
 * Exact. */
int ff_face_sees_box(const ff_get_panorama *request, enum ff_face_name face, const ff_box *box);

#endif
