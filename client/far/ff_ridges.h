/* What ridges hide from O: of ground behind one of a sector's fins and lower than its line, as seen
 * from O, the paint shows the ridge, not that ground.
 *
 * A sector is cut into columns of equal width. Of each the lines of fins that cross its middle are
 * kept, the nearest first, as long as each is higher than those before it: what is lower and
 * farther away is hidden itself. Ground is behind a ridge from an eighth farther away on: what is
 * nearer may be the ridge itself, in a coarse tree. */
#ifndef FF_RIDGES_H
#define FF_RIDGES_H

#include "../../protocol/far/ff_far.h"

#define FF_RIDGES_COLUMNS 32
#define FF_RIDGES_LINES   4 /* of a column at most: where there are more, the lowest step is lost */

typedef struct ff_ridge {
    uint16_t behind;   /* from so far away on, 4 m each, ground is behind it */
    int16_t slope_q14; /* ground is hidden that rises less than so much a unit forward */
} ff_ridge;

typedef struct ff_ridges {
    ff_ridge line[FF_RIDGES_COLUMNS][FF_RIDGES_LINES];
    uint8_t count[FF_RIDGES_COLUMNS];
} ff_ridges;

/* Of a sector's fins, seen at a focal length. */
void ff_ridges_make(ff_ridges *ridges, int32_t focal, const ff_fin_vertex *fin, uint32_t count);
/* 1 when a place is hidden: f > 0 forward of O, r to the right within the sector, u up. */
int ff_ridges_hide(const ff_ridges *ridges, int64_t forward_wu, int64_t right_wu, int64_t up_wu);

#endif
