/* What O sees in one sector, finely: colours and distances, several to a texel each way.
 *
 * The picture plane is that of protocol/far/ff_far.h; a `sub` is a pixel of this picture, `fine` of
 * them to a texel. Its width is odd, so that the middle of a column of subs stands on every whole
 * column of texels; its height is even, O's horizon in the middle. */
#ifndef FF_FAR_PICTURE_H
#define FF_FAR_PICTURE_H

#include "../../protocol/message/ff_message.h"
#include "../../protocol/shape/ff_shape.h"

#define FF_FAR_NOTHING INT32_MAX /* the distance of the sky */

typedef struct ff_far_picture {
    uint16_t width, height; /* subs */
    uint16_t fine;
    int32_t focal;           /* subs a unit of tangent */
    const uint8_t *rgba;     /* 4 bytes a sub, top row first */
    const int32_t *distance; /* along the sector's axis, wu */
} ff_far_picture;

/* Axes of a sector with the place and ground it is seen from. */
typedef struct ff_far_axis {
    const ff_terrain_info *info;
    int32_t forward_q30[2], right_q30[2];
} ff_far_axis;

/* A place: forward, right and up of O, and how far east and north that is. */
typedef struct ff_far_place {
    int64_t forward, right, up, east, north;
} ff_far_place;

/* Of a camera that looks along a sector. */
static inline int32_t ff_far_yaw(uint8_t sector) { return sector * (65536 / FF_FAR_SECTORS); }

static inline int32_t ff_far_middle(const ff_far_picture *picture) { return picture->width / 2; }

static inline int32_t ff_far_distance_at(const ff_far_picture *picture, int32_t column, int32_t row)
{
    return picture->distance[(size_t)row * picture->width + (size_t)column];
}

/* Where the ground stands that a sub shows; it shows some. */
void ff_far_place_of(const ff_far_picture *picture, const ff_far_axis *axis, int32_t column,
                     int32_t row, ff_far_place *place);

#endif
