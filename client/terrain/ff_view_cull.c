/* The view pyramid against boxes. A box is left out only when all of it lies outside one plane by
 * more than the planes' own rounding could explain: what is visible is never left out. */
#include "ff_tree_local.h"

#define PLANE_BITS  28
#define PLANE_SLACK 16 /* units of 2^-28 by which a component of a normal may be off */
/* sums of three products: of any box, and of one whose corners have 32 bits */
#define SIZE_BITS 35
FF_STATIC_ASSERT(PLANE_BITS + SIZE_BITS <= 63 && PLANE_BITS + 31 + 2 <= 63);

static void plane_from(int32_t plane[3], const int64_t normal[3])
{
    uint64_t largest = 1;
    for (unsigned axis = 0; axis < 3; axis++) {
        uint64_t size = normal[axis] < 0 ? 0 - (uint64_t)normal[axis] : (uint64_t)normal[axis];
        if (size > largest) largest = size;
    }
    unsigned bits = 0;
    FF_ASSERT(largest < UINT64_C(1) << 63);
    while (largest >> bits >> PLANE_BITS) bits++;
    for (unsigned axis = 0; axis < 3; axis++) {
        plane[axis] = (int32_t)(normal[axis] / ((int64_t)1 << bits));
        FF_ASSERT(plane[axis] > -(1 << PLANE_BITS) && plane[axis] < 1 << PLANE_BITS);
    }
}

/* A point projects inside when |x_eye| * d <= z_eye * width/2 and the like for y (c3d.h); all
 * planes run through the eye. */
void ff_pyramid_make(ff_tree *tree)
{
    const c3d_camera *camera = &tree->view.camera;
    c3d_rotation rotation;
    c3d_rotation_from_camera(camera, &rotation);
    FF_ASSERT(camera->focal_q8 > 0);
    int64_t half_q8[2] = { camera->width * 128, camera->height * 128 };
    int64_t normal[3];
    for (unsigned side = 0; side < 4; side++) {
        int64_t lateral = side & 1 ? camera->focal_q8 : -(int64_t)camera->focal_q8;
        for (unsigned axis = 0; axis < 3; axis++)
            normal[axis] = lateral * rotation.m[side >> 1][axis] +
                           half_q8[side >> 1] * rotation.m[2][axis];
        plane_from(tree->plane[side], normal);
    }
    for (unsigned axis = 0; axis < 3; axis++) normal[axis] = rotation.m[2][axis];
    plane_from(tree->plane[4], normal);
}

static int64_t magnitude(int64_t value) { return value < 0 ? -value : value; }

static int64_t larger(int64_t a, int64_t b) { return a > b ? a : b; }

/* 1 when the box's innermost corner lies outside the plane by more than `slack`. */
static int beyond_plane(const int32_t plane[3], const ff_box *box, int64_t slack)
{
    int64_t height = 0;
    for (unsigned axis = 0; axis < 3; axis++)
        height += plane[axis] * (plane[axis] >= 0 ? box->hi[axis] : box->lo[axis]);
    return height < -slack;
}

/* The same where corners have 32 bits: sums of three products below 2^60. */
static int narrow_beyond_plane(const int32_t plane[3], const ff_box *box, int64_t slack)
{
    int64_t height = 0;
    FF_ASSERT(slack <= (int64_t)PLANE_SLACK * INT32_MAX);
    for (unsigned axis = 0; axis < 3; axis++)
        height += (int64_t)plane[axis] *
                  (int32_t)(plane[axis] >= 0 ? box->hi[axis] : box->lo[axis]);
    return height < -slack;
}

int ff_box_in_view(const ff_tree *tree, const ff_box *box)
{
    int64_t size = 1;
    for (unsigned axis = 0; axis < 3; axis++)
        size += larger(magnitude(box->lo[axis]), magnitude(box->hi[axis]));
    FF_ASSERT(size < INT64_C(1) << SIZE_BITS);
    int narrow = size <= INT32_MAX;
    for (unsigned i = 0; i < FF_PLANES; i++) {
        if ((narrow ? narrow_beyond_plane : beyond_plane)(tree->plane[i], box, PLANE_SLACK * size))
            return 0;
    }
    return 1;
}
