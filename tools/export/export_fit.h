/* How far map tiles are from the ground that they were made of: measured at the ground's own
 * samples, where tiles are read bilinearly between the centres of their pixels. */
#ifndef EXPORT_FIT_H
#define EXPORT_FIT_H

#include "export_about.h"
#include "export_tile.h"
#include "export_view.h"

typedef struct export_fit {
    uint64_t count;
    double sum, worst_m; /* of squares */
} export_fit;

/* A tile's heights, with `margin` pixels of its neighbours round it where they are known. */
typedef struct export_patch {
    const float *metres;
    const uint8_t *mask; /* enum export_cell */
    uint32_t side, margin;
} export_patch;

/* Adds every `stride`-th sample along both axes that lies in the tile, placed by its geotransform,
 * and between four pixels of ground, as they are painted. `map_px`: pixels once round the map. 0 or
 * -1 (said). */
int export_fit_add(const export_view *view, const export_paint *paint, const export_patch *patch,
                   const double geotransform[6], double map_px, uint32_t stride, export_fit *fit);
/* One more sample that is so far off. */
void export_fit_take(export_fit *fit, double off_m);
/* Says how far a zoom is off in the finest zooms of those that end with `high`; of what is not
 * measured it says that. */
void export_fit_tell(const export_fit *fit, uint32_t low, uint32_t high, export_about *about);

#endif
