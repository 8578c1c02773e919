/* The paint of a sector: texels from the picture's subs, blocks that are there, filled where
 * nothing is needed. */
#ifndef FF_FAR_PAINT_H
#define FF_FAR_PAINT_H

#include "ff_far_fill.h"
#include "ff_far_seen.h"

typedef struct ff_far_paint {
    int32_t focal;                /* texels a unit of tangent */
    uint32_t width, height;       /* texels, whole blocks; the middle column is the sector's */
    int32_t top;                  /* rows above O's horizon that the first one begins */
    ff_far_texel *texel;          /* and all smaller pictures of the fill behind it */
    uint32_t *nearest, *farthest; /* spots, plus 1; 0: no ground in this texel */
    uint8_t *there;               /* of each block */
    uint8_t *rgb, *needed;        /* texels, and which of them somebody sees */
    uint32_t blocks_there;
    uint32_t ground, seen; /* texels that show ground, and those that somebody sees */
} ff_far_paint;

/* Takes colours from the picture, and lists the spots that are to be looked at. */
int ff_far_paint_take(ff_far_paint *paint, const ff_far_picture *picture, const ff_get_far *request,
                      ff_far_spots *spots);
/* Keeps what is seen, cuts off rows of blocks with nothing, fills the rest, and lays out blocks. */
int ff_far_paint_keep(ff_far_paint *paint, const ff_far_spots *spots);
void ff_far_paint_free(ff_far_paint *paint);

#endif
