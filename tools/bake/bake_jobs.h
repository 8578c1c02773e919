/* Jobs over several threads whose results are taken in order, so that the outcome does not depend
 * on the threads. */
#ifndef BAKE_JOBS_H
#define BAKE_JOBS_H

#include <stdint.h>

typedef struct bake_jobs {
    const char *stage; /* for the progress bar */
    uint32_t job_count;
    int thread_count;
    void *context;
    /* Both 0 or -1 (said), which ends everything. `worker` is 0..thread_count-1. `make` runs at the
     * same time for several jobs; `take` for one at a time, in order of `job`, by the worker that
     * made it. */
    int (*make)(void *context, int worker, uint32_t job);
    int (*take)(void *context, int worker, uint32_t job);
} bake_jobs;

/* Runs all jobs. 0 or -1 (said). */
int bake_jobs_run(const bake_jobs *jobs);

#endif
