/* A list of errors in three figures. */
#ifndef SIM_SPREAD_H
#define SIM_SPREAD_H

#include <stddef.h>

typedef struct sim_spread {
    double rms, p95, max; /* 0 of an empty list */
} sim_spread;

/* Sorts the list. */
sim_spread sim_spread_of(double *list, size_t count);

#endif
