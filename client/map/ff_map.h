/* A map: the same ground seen from straight above, through a long lens, so that hills hardly lean
 * outwards; and what leads from it to a flight (Blocks' zooming map on the machinery of the
 * flight). Nothing here knows a client: a program turns an ff_map into a camera for
 * ff_client_update, takes the quality for ff_client_set_quality, and has contours and its own place
 * drawn by ff_client_set_map. Integers, no state, nothing fails. */
#ifndef FF_MAP_H
#define FF_MAP_H

#include "../../common3d/c3d.h"

/* How many times as far away, and as long a lens, as the flight's at the same scale. */
#define FF_MAP_LENS 4
/* How far away the eye may be: of wide windows at large scales that is what ends a zoom. */
#define FF_MAP_AWAY_WU_MAX ((int64_t)1 << 30)

/* A view of a place, from above or aslant: any camera without roll is one. */
typedef struct ff_map {
    int32_t place_wu[3]; /* on the ground, in the middle of the picture; axes as the camera's */
    int32_t yaw;         /* brad16, clockwise from north: what is up in the picture */
    int32_t tilt;        /* brad16 from straight down; 16384: level */
    int64_t away_wu;     /* of the eye from the place, 1 to FF_MAP_AWAY_WU_MAX */
    int32_t focal_q8;    /* of its lens, as c3d_camera's */
} ff_map;

/* A map of a scale: px_wu_q8 is world units a pixel, Q8 (65536: 1 m a pixel). `lens` is the
 * flight's camera, of which focal_q8 is used. */
ff_map ff_map_make(const int32_t place_wu[3], int32_t yaw, int64_t px_wu_q8,
                   const c3d_camera *lens);
/* A camera as a view of what it looks at so far away; its roll is left out. */
ff_map ff_map_of_camera(const c3d_camera *camera, int64_t away_wu);
/* Sets place, angles and focal distance; the rest of the camera stays. */
void ff_map_camera(const ff_map *map, c3d_camera *camera);
/* The scale in the middle of the picture, wu a pixel, Q8; at least 1. */
int64_t ff_map_px_wu_q8(const ff_map *map);
/* From one to the other: part_q16 0 is `from`, 65536 is `to`; distances and lenses by their ratios,
 * so that the scale changes steadily; yaw the shorter way round. */
ff_map ff_map_between(const ff_map *from, const ff_map *to, uint32_t part_q16);

/* How far contours lie apart at a scale: 1, 2 or 5 times a power of ten metres, at least 1 m; on
 * ground that rises by one in one they come FF_MAP_CONTOUR_PX pixels apart or more. wu. */
#define FF_MAP_CONTOUR_PX 2
int32_t ff_map_contour_wu(int64_t px_wu_q8);
/* The longest bar of 1, 2 or 5 times a power of ten metres that is no longer than most_px at a
 * scale: its pixels, and its metres; 0 and 0: a metre is longer. */
uint32_t ff_map_bar(int64_t px_wu_q8, uint32_t most_px, uint32_t *metres);

/* Quality of a map's ground: error_px_q8 of FF_MEASURE_PIXELS, so small that hill shading shows
 * what there is, and triangles_max, which it nearly always reaches, so that all scales cost about
 * the same. */
#define FF_MAP_ERROR_PX_Q8 32
uint32_t ff_map_triangles(uint32_t width, uint32_t height);

#endif
