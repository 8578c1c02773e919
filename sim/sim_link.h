/* Link models: two directions with rate, delay, jitter, queue, stalls and cuts, in simulated or real time, from one seed.
 * Constants for real links, each number with its source, are in sim_link_profiles.c.
 */
#ifndef SIM_LINK_H
#define SIM_LINK_H

#include "../platform/sys.h"

enum sim_direction { SIM_DOWN, SIM_UP }; /* to the client, to the server */

typedef struct sim_link_way {
    uint32_t bytes_s;         /* rate; 0: unlimited */
    uint32_t delay_us;        /* one way, without queueing */
    uint32_t jitter_us;       /* added to the delay, uniform 0..jitter, order kept */
    uint32_t queue_bytes;     /* bytes that fit before send() takes no more */
    const char *trace;        /* Mahimahi trace file replaces rate; or NULL */
} sim_link_way;

typedef struct sim_link_desc {
    const char *name, *source;
    sim_link_way way[2];
    uint32_t stall_every_ms;  /* mean time between stalls, exponential; 0: none */
    uint32_t stall_ms_min, stall_ms_max; /* uniform */
    uint32_t stall_bytes_s;   /* rate during a stall */
    uint32_t cut_every_ms;    /* the connection is lost after about this time; 0: never */
    uint32_t connect_ms;      /* to connect (again) */
} sim_link_desc;

/* "gprs", "edge", "umts", "lan", ... or NULL. sim_link_profile_at(i) walks all of them, NULL at the end. */
const sim_link_desc *sim_link_profile(const char *name);
const sim_link_desc *sim_link_profile_at(unsigned index);

typedef struct sim_link sim_link;
/* NULL when out of memory or a trace cannot be read. */
sim_link *sim_link_create(const sim_link_desc *desc, uint64_t seed);
void sim_link_destroy(sim_link *link);

/* Bytes taken now at `now_us` (times never go back); 0 when the queue is full; FF_ERR_CLOSED after a cut. */
int sim_link_send(sim_link *link, enum sim_direction way, const uint8_t *bytes, size_t count, int64_t now_us);
/* Bytes that have arrived by now_us; 0: none; FF_ERR_CLOSED after a cut. */
int sim_link_recv(sim_link *link, enum sim_direction way, uint8_t *bytes, size_t capacity, int64_t now_us);
/* When the next bytes arrive or the next cut happens: for sleeping. INT64_MAX: nothing under way. */
int64_t sim_link_next_us(const sim_link *link);
/* After a cut: starts connecting; FF_ERR_AGAIN until connect_ms have passed, then FF_OK; all bytes under way are lost. */
int sim_link_reconnect(sim_link *link, int64_t now_us);

#endif
