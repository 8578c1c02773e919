/* One draw from raster to verdict: baked by farfield-bake, exported by farfield-export, and held
 * against the surface. */
#ifndef PROPERTY_JUDGE_H
#define PROPERTY_JUDGE_H

#include "property_fit.h"
#include "property_surface.h"

typedef struct property_run {
    const char *programs; /* folder of farfield-bake and -export */
    const char *folder;   /* for files */
    char command[2000];   /* the bake's */
    char said[4000];      /* its errors and notes */
    char wrong[400];      /* what is wrong; empty: nothing */
    const char *refusal;  /* the kind of an allowed refusal, or NULL */
    property_fit fit;
    double drift;     /* of kept samples whose cells were rounded: a part of 1, told by a note */
    double allowed_m; /* of any sample */
} property_run;

/* Bakes, exports and judges; removes the draw's files unless it fails. */
void property_judge(property_draw *d, property_run *run);

/* Kinds of refusals that README.md and --help tell: NULL behind the last. */
const char *property_refusal(int kind);

#endif
