/* How far map tiles are from the ground that they were made of: measured at the ground's own
 * samples, where tiles are read bilinearly between the centres of their pixels. */
#ifndef EXPORT_FIT_H
#define EXPORT_FIT_H

#include "export_tile.h"
#include "export_view.h"

typedef struct export_fit {
    uint64_t count;
    double sum, worst_m; /* of squares */
} export_fit;

/* Adds every `stride`-th sample along both axes that lies between four pixels of ground of one
 * tile, placed by its geotransform, as it is painted. `map_cells`: pixels once round the map. 0 or
 * -1 (said). */
int export_fit_add(const export_view *view, const export_paint *paint, const export_tile *tile,
                   const double geotransform[6], double map_cells, uint32_t stride,
                   export_fit *fit);
double export_fit_rms(const export_fit *fit);

#endif
