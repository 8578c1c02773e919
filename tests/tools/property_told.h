/* What farfield-bake told of a shift between datums, held against PROJ. */
#ifndef PROPERTY_TOLD_H
#define PROPERTY_TOLD_H

#include "property_draw.h"

typedef struct property_told {
    double accuracy_m;                      /* infinite: not known */
    OGRCoordinateTransformationH to_source; /* from the pack's plane, the way that was told back;
                                               NULL: no shift was told */
} property_told;

/* Reads the bake's summary and notes, and finds the operation of that name and accuracy in PROJ's
 * list for the place. 0, or -1: PROJ knows none, or no note told one that may be off by more than
 * half of `cell_m`. */
int property_told_read(const property_draw *d, const char *json, const char *said,
                       OGRSpatialReferenceH pack, double cell_m, property_told *told);
void property_told_free(property_told *told);

/* How far, in metres, a place of the pack lies from where PROJ's best operation puts it. */
double property_told_offset(const property_draw *d, const property_told *told,
                            OGRSpatialReferenceH pack, double x, double y);

#endif
