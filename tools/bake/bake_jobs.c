#include "bake_jobs.h"

#include "bake_say.h"

#include <pthread.h>
#include <stdlib.h>

typedef struct bake_crew {
    const bake_jobs *jobs;
    pthread_mutex_t lock;
    pthread_cond_t turn;
    uint32_t next_job, next_take;
    int failed;
} bake_crew;

typedef struct bake_hand {
    bake_crew *crew;
    int worker;
    pthread_t thread;
} bake_hand;

/* Waits until all jobs before this one are taken; then takes it. */
static void take_in_turn(bake_crew *crew, int worker, uint32_t job, int made)
{
    const bake_jobs *jobs = crew->jobs;
    pthread_mutex_lock(&crew->lock);
    while (crew->next_take != job && !crew->failed) pthread_cond_wait(&crew->turn, &crew->lock);
    if (!crew->failed && (made || jobs->take(jobs->context, worker, job))) crew->failed = 1;
    crew->next_take++;
    if (!crew->failed) bake_progress(jobs->stage, job + 1, jobs->job_count);
    pthread_cond_broadcast(&crew->turn);
    pthread_mutex_unlock(&crew->lock);
}

static void *work(void *argument)
{
    bake_hand *me = argument;
    bake_crew *crew = me->crew;
    for (;;) {
        pthread_mutex_lock(&crew->lock);
        uint32_t job = crew->next_job;
        int done = crew->failed || job >= crew->jobs->job_count;
        if (!done) crew->next_job++;
        pthread_mutex_unlock(&crew->lock);
        if (done) return NULL;
        take_in_turn(crew, me->worker, job, crew->jobs->make(crew->jobs->context, me->worker, job));
    }
}

int bake_jobs_run(const bake_jobs *jobs)
{
    bake_crew crew = { .jobs = jobs,
                       .lock = PTHREAD_MUTEX_INITIALIZER,
                       .turn = PTHREAD_COND_INITIALIZER };
    bake_hand *hands = calloc((size_t)jobs->thread_count, sizeof *hands);
    if (!hands) return bake_fail("out of memory");
    int started = 1; /* hand 0 is this thread */
    for (int i = 0; i < jobs->thread_count; i++)
        hands[i] = (bake_hand){ .crew = &crew, .worker = i };
    while (started < jobs->thread_count &&
           !pthread_create(&hands[started].thread, NULL, work, &hands[started]))
        started++;
    work(&hands[0]);
    for (int i = 1; i < started; i++) pthread_join(hands[i].thread, NULL);
    free(hands);
    return crew.failed ? -1 : 0;
}
