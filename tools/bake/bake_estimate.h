/* What a bake will take, before it is done (--estimate).
 *
 * The raster is read, and its projection planned; of the rest only a sample of windows is made,
 * spread over the ground, by the bake's own code. Bytes of refinements go with the roughness of the
 * ground, which is known of all of it: so they are estimated by linear regression on it (Cochran
 * 1977, "Sampling Techniques", chapter 7), textures by the mean. Coarse levels, of which a window
 * shows none, cost a record what the coarsest one in it costs; there are few of them.
 */
#ifndef BAKE_ESTIMATE_H
#define BAKE_ESTIMATE_H

#include "bake_run_local.h"

/* A guess and its standard deviation. */
typedef struct bake_guess {
    double value, deviation;
} bake_guess;

/* Tells on stdout, as JSON with --json. 0 or -1 (said). */
int bake_estimate(bake *b);

#endif
