/* Outlines of ridges as rays find them, in double precision: what fins must lie on. */
#ifndef FAR_RAYS_H
#define FAR_RAYS_H

#include "../../protocol/ff_terrain.h"
#include "../../protocol/message/ff_message.h"

#define FAR_TRUE_OUTLINES 16

/* Height in steps of a metre of sample (x, y), as pack_fixture_desc's. */
typedef uint16_t far_height(void *context, uint32_t x, uint32_t y);

typedef struct far_true_outline {
    double up, distance_m; /* texels above the horizon; along the sector's axis */
} far_true_outline;

/* Outlines in a column of a sector, from the nearest to the skyline, which is the last: how many.
 * The ground is a square of samples that begins at (0, 0), the mesh of all of them. */
unsigned far_march(const ff_terrain_info *info, far_height *height, const ff_get_far *request,
                   unsigned sector, double column, far_true_outline out[FAR_TRUE_OUTLINES]);
/* How far a place of a fin is from the nearest of them, texels; distances that differ by more than
 * a tenth do not go together. */
double far_off_outline(const far_true_outline *outline, unsigned count, double up,
                       double distance_m);

#endif
