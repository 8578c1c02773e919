#include "ff_gaze.h"

#include <string.h>

#define NARROW 4 /* a square is looked at whole when it is so many times as far as wide */
/* what keeps products within 64 bits */
#define EXTENT_MAX_Q6 (1 << 22)
#define SLOPE_MAX_Q12 (1 << 24)

static void find_middle(const ff_gaze *at, ff_square *s)
{
    for (unsigned i = 0; i < 3; i++)
        s->middle[i] = (int32_t)(((int64_t)s->corner[0][i] + s->corner[1][i] + s->corner[2][i] +
                                  s->corner[3][i]) /
                                 4);
    for (unsigned row = 0; row < 3; row++) {
        int64_t sum = 0;
        for (unsigned i = 0; i < 3; i++) sum += (int64_t)at->rotation_q14[row][i] * s->middle[i];
        s->eye[row] = (int32_t)(sum >> 14);
    }
    s->away = about_length(s->middle[0], s->middle[1], s->middle[2]);
    s->wide = (size_of((int64_t)s->corner[3][0] - s->corner[0][0]) +
               size_of((int64_t)s->corner[3][1] - s->corner[0][1])) /
              2;
}

/* 1 when the middle lies in the picture, or not further beside it than `slack`. */
static int in_picture(const ff_gaze *at, const ff_square *s, int64_t slack)
{
    if (s->eye[2] + slack <= 0) return 0;
    for (unsigned i = 0; i < 2; i++)
        if (size_of(s->eye[i]) * at->tree->view.camera.focal_q8 -
                (int64_t)s->eye[2] * at->half_q8[i] >
            slack * at->normal_q8[i])
            return 0;
    return 1;
}

enum ff_sight ff_gaze_look(const ff_gaze *at, ff_square *s, int may_split)
{
    find_middle(at, s);
    int64_t relief = (size_of((int64_t)s->corner[3][2] - s->corner[0][2]) +
                      size_of((int64_t)s->corner[2][2] - s->corner[1][2])) /
                     2;
    if (!in_picture(at, s, s->wide * 3 / 4 + relief)) return FF_UNSEEN;
    if (may_split && s->wide * NARROW > s->away) return FF_TOO_WIDE;
    if (s->eye[2] <= 0 || !in_picture(at, s, 0)) return FF_UNSEEN;
    s->inverse_q40 = (INT64_C(1) << 40) / s->eye[2];
    return FF_SEEN;
}

int64_t ff_gaze_pixels_q8(const ff_gaze *at, const ff_square *s, int64_t length)
{
    int64_t by_depth_q20 = (length * (s->inverse_q40 >> 10)) >> 10;
    if (by_depth_q20 > INT64_C(1) << 31) by_depth_q20 = INT64_C(1) << 31;
    return (by_depth_q20 * at->tree->view.camera.focal_q8) >> 20;
}

/* The same of a length of either sign, pixels Q6; no longer than a picture may be many times. */
static int64_t extent_q6(const ff_gaze *at, const ff_square *s, int64_t length)
{
    int64_t pixels_q6 = ff_gaze_pixels_q8(at, s, size_of(length)) >> 2;
    return within(length < 0 ? -pixels_q6 : pixels_q6, EXTENT_MAX_Q6);
}

uint32_t ff_gaze_covers_q4(const ff_gaze *at, const ff_square *s, int tilt)
{
    int64_t rising[3], falling[3], facing_q22 = 0;
    for (unsigned i = 0; i < 3; i++) {
        rising[i] = extent_q6(at, s, (int64_t)s->corner[3][i] - s->corner[0][i]);
        falling[i] = extent_q6(at, s, (int64_t)s->corner[2][i] - s->corner[1][i]);
    }
    for (unsigned i = 0; i < 3; i++) {
        unsigned j = (i + 1) % 3, k = (i + 2) % 3;
        int64_t sight_q10 = (s->middle[i] * (s->inverse_q40 >> 15)) >> 15;
        facing_q22 -= (rising[j] * falling[k] - rising[k] * falling[j]) * sight_q10;
    }
    if (facing_q22 < 0 && at->under) facing_q22 = -facing_q22;
    if (tilt) {
        int64_t level_q12 = size_of(rising[0] * falling[1] - rising[1] * falling[0]),
                least_q22 = level_q12 * ((s->away * (s->inverse_q40 >> 15)) >> 15) / tilt;
        facing_q22 = facing_q22 > least_q22 ? facing_q22 : least_q22;
    }
    int64_t covered_q4 = facing_q22 >> 19, all_q4 = (int64_t)at->half_q8[0] * at->half_q8[1] >> 10;
    return covered_q4 <= 0 ? 0 : (uint32_t)(covered_q4 < all_q4 ? covered_q4 : all_q4);
}

/* ---- what hides what ---- */

unsigned ff_gaze_sector(const ff_square *s)
{
    int64_t x = size_of(s->middle[0]), y = size_of(s->middle[1]);
    unsigned part = (unsigned)(y * (FF_GAZE_SECTORS / 4) / (x + y + 1)),
             quarter = (s->middle[1] < 0 ? 2u : 0u) + (s->middle[0] < 0);
    FF_ASSERT(part < FF_GAZE_SECTORS / 4);
    return quarter * (FF_GAZE_SECTORS / 4) + part;
}

int32_t ff_gaze_slope_q12(const ff_square *s)
{
    int64_t across = about_length(s->middle[0], s->middle[1], 0);
    int64_t slope = (int64_t)s->middle[2] * 4096 / (across + 1);
    return (int32_t)within(slope, SLOPE_MAX_Q12);
}

void ff_gaze_open(ff_gaze *at, const ff_tree *tree)
{
    const c3d_camera *camera = &tree->view.camera;
    c3d_rotation rotation;
    int32_t ground_wu;
    memset(at, 0, sizeof *at);
    at->tree = tree;
    c3d_rotation_from_camera(camera, &rotation);
    for (unsigned row = 0; row < 3; row++)
        for (unsigned i = 0; i < 3; i++) at->rotation_q14[row][i] = rotation.m[row][i] >> 16;
    at->half_q8[0] = camera->width * 128;
    at->half_q8[1] = camera->height * 128;
    for (unsigned i = 0; i < 2; i++)
        at->normal_q8[i] = c3d_isqrt64((uint64_t)camera->focal_q8 * (uint64_t)camera->focal_q8 +
                                       (uint64_t)at->half_q8[i] * (uint64_t)at->half_q8[i]);
    for (unsigned i = 0; i < FF_GAZE_SECTORS; i++) at->horizon_q12[i] = INT32_MIN;
    at->under =
        (uint8_t)(ff_tree_drawn_height(tree, camera->pos_wu[0], camera->pos_wu[1], &ground_wu) &&
                  ground_wu > camera->pos_wu[2]);
}
