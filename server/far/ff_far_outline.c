#include "ff_far_outline.h"

#include <stdlib.h>

#define JUMP_Q4 24 /* ground 1.5 times as far stands behind an outline */

static int add(ff_far_outlines *outlines, const ff_far_outline *outline)
{
    if (outlines->count == outlines->capacity) {
        uint32_t capacity = outlines->capacity ? 2 * outlines->capacity : 4096;
        ff_far_outline *grown = realloc(outlines->outline, capacity * sizeof *grown);
        if (!grown) return FF_ERR_MEMORY;
        outlines->outline = grown;
        outlines->capacity = capacity;
    }
    outlines->outline[outlines->count++] = *outline;
    return FF_OK;
}

static int find_in_column(ff_far_outlines *outlines, const ff_far_picture *picture, int32_t column,
                          int32_t end_row, int32_t near_wu, ff_far_spots *spots)
{
    int32_t at = ff_far_middle(picture) + column * picture->fine, above = FF_FAR_NOTHING;
    for (int32_t row = 0; row < end_row; row++) {
        int32_t here = ff_far_distance_at(picture, at, row);
        int jump = here != FF_FAR_NOTHING &&
                   (above == FF_FAR_NOTHING || (int64_t)here * JUMP_Q4 < (int64_t)above * 16);
        if (jump && here > near_wu) {
            int64_t spot = ff_far_spots_add(spots, (uint32_t)at, (uint32_t)row);
            if (spot < 0) return (int)spot;
            ff_far_outline outline = { (int16_t)column, (uint16_t)row, here, above,
                                       (uint32_t)spot };
            if (add(outlines, &outline) < 0) return FF_ERR_MEMORY;
        }
        above = here;
    }
    return FF_OK;
}

int ff_far_outlines_find(ff_far_outlines *outlines, const ff_far_picture *picture,
                         const ff_get_far *request, int32_t near_wu, ff_far_spots *spots)
{
    int32_t half = ff_far_half(request->focal), end_row = picture->height;
    outlines->count = 0;
    if (!request->tolerance_q2) return FF_OK;
    if (half > FF_FAR_COLUMN_MAX) half = FF_FAR_COLUMN_MAX;
    for (int32_t column = -half; column <= half; column++) {
        int rc = find_in_column(outlines, picture, column, end_row, near_wu, spots);
        if (rc < 0) return rc;
    }
    return FF_OK;
}
