/* Outlines of ridges in a picture of distances, and fins made of them. Pure functions. */
#ifndef FF_FAR_OUTLINE_H
#define FF_FAR_OUTLINE_H

#include "ff_far_seen.h"

/* In a column of texels: above `row` (subs) there is sky or ground clearly farther. */
typedef struct ff_far_outline {
    int16_t column;
    uint16_t row;
    int32_t distance_wu, behind_wu; /* FF_FAR_NOTHING: sky */
    uint32_t spot;
} ff_far_outline;

typedef struct ff_far_outlines {
    ff_far_outline *outline; /* column by column, in each from the top */
    uint32_t count, capacity;
} ff_far_outlines;

/* Finds them, and lists the spots that are to be looked at. Ground nearer than near_wu is the edge
 * of what was cut away. FF_OK or FF_ERR_MEMORY. */
int ff_far_outlines_find(ff_far_outlines *outlines, const ff_far_picture *picture,
                         const ff_get_far *request, int32_t near_wu, ff_far_spots *spots);

/* Makes fins of those that are seen: at most FF_FAR_VERTICES_MAX vertices, far ones first. Their
 * number, or FF_ERR_MEMORY. */
int ff_far_fins_make(const ff_far_outlines *outlines, const ff_far_picture *picture,
                     const ff_far_spots *spots, uint8_t tolerance_q2, ff_fin_vertex *vertex);

#endif
