/* When is a panorama too old? The error rules of Hybrid, section 6.2 (eq. 6, 7 and 13), in exact integers.
 *
 * A panorama taken at O shows ground at depth z and beyond. Seen from O', each of its points is off on the screen by at most
 *   sideways and vertically:  |OO'| * d / z          pixels   (d: focal distance in pixels)
 *   forwards:                 |OO'| * w / (z - |OO'|) pixels  (w: half the window, where the error is largest)
 * so with `error` pixels allowed the viewer may move
 *   sideways  error * z / d        forwards  z * error / (error + w)  =  z * (1 - w / (error + w)).
 * Limits: w = 0 leaves only |OO'| < z; error = 0 allows no movement at all; |OO'| >= z always asks for a new one.
 */
#ifndef FF_PANORAMA_RULES_H
#define FF_PANORAMA_RULES_H

#include "../common3d/c3d.h"

/* All lengths in wu, pixels in Q8; z, d >= 1; w, error >= 0. Rounded down: never more than allowed. */
int64_t ff_panorama_sideways_max(int64_t error_px_q8, int64_t z_wu, int64_t focal_q8);
int64_t ff_panorama_forwards_max(int64_t error_px_q8, int64_t z_wu, int64_t half_width_px_q8);

/* 1 when the panorama taken at `taken_wu` shows more than `error_px_q8` of error to this camera. Motion is taken apart along the
 * camera's axes: right and up by the sideways rule, forward (and, being the milder case, backward) by the forward rule. */
int ff_panorama_outdated(const c3d_camera *camera, const int32_t taken_wu[3], int32_t z_wu, int32_t error_px_q8);

/* Bit per enum ff_face_name the view pyramid touches: conservative, a face too many at most. */
unsigned ff_panorama_faces_in_view(const c3d_camera *camera);

#endif
