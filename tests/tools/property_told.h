/* What farfield-bake told of a shift between datums, held against PROJ. */
#ifndef PROPERTY_TOLD_H
#define PROPERTY_TOLD_H

#include "property_draw.h"

typedef struct property_told {
    double accuracy_m;                      /* as it was told */
    OGRCoordinateTransformationH to_source; /* from the pack's plane, the way that was told back;
                                               NULL: nothing was told */
} property_told;

/* Reads the note in `said`, and finds the operation that it names in PROJ's list for the place. 0,
 * or -1: PROJ knows none of that name and accuracy. */
int property_told_read(const property_draw *d, const char *said, OGRSpatialReferenceH pack,
                       property_told *told);
void property_told_free(property_told *told);

/* How far, in metres, a place of the pack lies from where PROJ's best operation puts it. */
double property_told_offset(const property_draw *d, const property_told *told,
                            OGRSpatialReferenceH pack, double x, double y);

#endif
