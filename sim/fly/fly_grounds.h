/* The grounds of a flight: those of the server's packs, and other ground on the device. How they
 * lie together, what the path keeps above, and the truth that pictures are judged by. */
#ifndef FLY_GROUNDS_H
#define FLY_GROUNDS_H

#include "fly_options.h"
#include "../judge/sim_ground.h"

typedef struct fly_grounds {
    ff_packs packs; /* joined: a ground each, in the order of a tree's */
    const char *path[FF_PACKS_MAX];
    /* a moderate level of each, for the path; with an audit each whole; each joined to the first */
    sim_ground moderate[FF_PACKS_MAX], truth[FF_PACKS_MAX];
    double truth_error_m; /* no true height is further than this from its source */
} fly_grounds;

/* `served`: the server's packs, `locals`: those on the device, whose parts of grounds that are
 * there already are no ground of their own. 0, or -1 with one line on stderr. Call close in both
 * cases. */
int fly_grounds_open(fly_grounds *grounds, const fly_options *options, const ff_packs *served,
                     const ff_packs *locals);
void fly_grounds_close(fly_grounds *grounds);

#endif
