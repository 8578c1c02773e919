/* Which places somebody in the region round O can see.
 *
 * Eyes stand about the region. For each the ground is drawn as a picture of distances, near ground
 * too, looking as O looks but wider; a place is seen when nothing in this picture stands clearly
 * before it. What lies outside an eye's picture counts as seen, and so does everything when there
 * is no eye above ground: it errs towards more. */
#ifndef FF_FAR_SEEN_H
#define FF_FAR_SEEN_H

#include "ff_far_picture.h"
#include "ff_far_stage.h"

/* A sub whose place is asked about. */
typedef struct ff_far_spot {
    uint16_t column, row;
    uint8_t seen;
} ff_far_spot;

typedef struct ff_far_spots {
    ff_far_spot *spot;
    uint32_t count, capacity;
} ff_far_spots;

/* The number of the spot; FF_ERR_MEMORY. */
int64_t ff_far_spots_add(ff_far_spots *spots, uint32_t column, uint32_t row);

/* Scratch of distances, grown as needed. */
typedef struct ff_far_room {
    int32_t *value;
    size_t count;
} ff_far_room;
int ff_far_room_fit(ff_far_room *room, size_t count);

/* What a search is about. `request` has O as a point of the frame. */
typedef struct ff_far_search {
    const ff_get_far *request;
    const ff_frame *frame;
    const ff_far_axis *axis;
    const ff_far_picture *picture;
    uint8_t sector;
    int32_t far_wu; /* no ground is farther from anywhere in the region */
} ff_far_search;

/* Pixels of an eye's picture: `room` and `stage` must have them. */
size_t ff_far_eye_pixels(int32_t focal);
/* Marks spots that are seen. FF_OK or a negative error. */
int ff_far_find_seen(ff_far_stage *stage, ff_far_room *room, const ff_far_search *search,
                     ff_far_spots *spots);

#endif
