/* When is a panorama too old? The error rules of Hybrid, section 6.2 (eq. 6, 7 and 13), in exact
 * integers.
 *
 * A panorama taken at O shows ground at depth z and beyond. Seen from O', each of its points is off
 * on the screen by at most
 *   sideways and vertically:  |OO'| * d / z          pixels   (d: focal distance in pixels)
 *   forwards:                 |OO'| * w / (z - |OO'|) pixels  (w: half the window, where the error
 *                             is largest)
 * so with `error` pixels allowed the viewer may move
 *   sideways  error * z / d        forwards  z * error / (error + w)  =  z * (1 - w / (error + w)).
 * Limits: w = 0 leaves only |OO'| < z; error = 0 allows no movement at all; |OO'| >= z always asks
 * for a new one.
 */
#ifndef FF_PANORAMA_RULES_H
#define FF_PANORAMA_RULES_H

#include "../../common3d/c3d.h"
#include "../../protocol/message/ff_message.h"

typedef struct ff_face_axis {
    int8_t axis, sign;
} ff_face_axis;
/* by enum ff_face_name: the world axis a face looks along */
extern const ff_face_axis ff_face_axes[FF_FACE_COUNT];

/* Sight: between which heights above O each face of a set shows ground, on the cube of half-edge z
 * round O; by enum ff_face_name; low > high: the face shows none. Upper and lower face are taken
 * whole when they show any. */
typedef struct ff_panorama_sight {
    int32_t low_wu[FF_FACE_COUNT], high_wu[FF_FACE_COUNT];
} ff_panorama_sight;

/* All lengths in wu, pixels in Q8; z, d >= 1; w, error >= 0. Rounded down: never more than
 * allowed. */
int64_t ff_panorama_sideways_max(int64_t error_px_q8, int64_t z_wu, int64_t focal_q8);
int64_t ff_panorama_forwards_max(int64_t error_px_q8, int64_t z_wu, int64_t half_width_px_q8);

/* 1 when the panorama taken at `taken_wu` may show a point more than `error_px_q8` from its place
 * to this camera, in any direction of motion and for any point in the window: the two rules above
 * tested one by one would let their errors add up, and take the depth of ground to be z, which it
 * is only where the camera looks along an axis of the cube. */
int ff_panorama_outdated(const c3d_camera *camera, const int32_t taken_wu[3],
                         const ff_panorama_sight *sight, int32_t z_wu, int32_t error_px_q8);

/* What a set may show of a terrain whose lowest and highest ground is ground_wu: the lowest as it
 * lies in the frame at O z away from there, the highest where it lies highest. */
void ff_panorama_sight_terrain(ff_panorama_sight *sight, const int32_t taken_wu[3],
                               const int32_t ground_wu[2], int32_t z_wu);
/* What a face shows whose image has these of its rows; row_count 0: nothing. Between the image's
 * uppermost and lowest texel lies all ground beyond z as seen from O, also what other ground hides;
 * one row is added for a summit between two texels. */
void ff_panorama_sight_face(ff_panorama_sight *sight, unsigned face, unsigned face_size,
                            unsigned top_row, unsigned row_count, int32_t z_wu);

/* 1 when the viewer has left a panorama behind, and with it the client's own ground, the box of z
 * round `taken_wu`: by more than half of z along an axis. By then a point ahead may be shown half
 * the window from its place (the rule forwards with |OO'| = z / 2), and half of the box ahead is
 * used up: ground round the viewer, without a panorama, is better. */
int ff_panorama_left_behind(const int32_t viewer_wu[3], const int32_t taken_wu[3], int32_t z_wu);

/* Bit per enum ff_face_name the view pyramid touches: conservative, a face too many at most. */
unsigned ff_panorama_faces_in_view(const c3d_camera *camera);

#endif
