/* Link models: two directions with rate, delay, jitter, queue, stalls and cuts, in simulated or
 * real time, from one seed. Constants for real links, each number with its source, are in
 * sim_link_profiles.c.
 */
#ifndef SIM_LINK_H
#define SIM_LINK_H

#include "../../platform/sys.h"

enum sim_direction { SIM_DOWN, SIM_UP }; /* to the client, to the server */

/* Bytes stored in one direction beyond the queue: under way or arrived and not yet taken. Like a
 * TCP window: a receiver that does not read, or a rate times delay above this, holds the sender
 * back. */
#define SIM_LINK_WINDOW_BYTES (1u << 20)

typedef struct sim_link_way {
    /* rate, byte-exact: n bytes after an idle time take n/bytes_s, no drift; 0: unlimited */
    uint32_t bytes_s;
    uint32_t delay_us;    /* one way, without queueing */
    uint32_t jitter_us;   /* added to the delay, uniform 0..jitter, order kept */
    uint32_t queue_bytes; /* bytes that fit before send() takes no more; at least 1 */
    const char *trace;    /* Mahimahi trace file replaces rate and stalls of this way; or NULL */
} sim_link_way;

typedef struct sim_link_desc {
    const char *name, *source;
    sim_link_way way[2];
    /* mean time from one stall's end to the next one's start, exponential; 0: none. Both ways stall
     * together */
    uint32_t stall_every_ms;
    uint32_t stall_ms_min, stall_ms_max; /* uniform */
    uint32_t stall_bytes_s;              /* rate during a stall */
    /* the connection is lost after 0.5 .. 1.5 times this, uniform; 0: never */
    uint32_t cut_every_ms;
    uint32_t connect_ms; /* to connect (again) */
    uint32_t
        header_bytes; /* of IP and TCP before each packet: counted, no time is taken for them */
} sim_link_desc;

/* "gprs", "edge", "umts", "lan", ... or NULL. sim_link_profile_at(i) walks all of them, NULL at the
 * end. */
const sim_link_desc *sim_link_profile(const char *name);
const sim_link_desc *sim_link_profile_at(unsigned index);

/* How long it takes on average until what is answered at once is there, without what transmitting
 * takes: who knows the kind of a link knows this beforehand. */
uint32_t sim_link_answer_ms(const sim_link_desc *desc);

/* A profile's name, then changes: "gprs,cut_every_ms=10000". FF_OK, FF_ERR_NOT_FOUND (no such
 * profile), FF_ERR_ARGUMENT. */
int sim_link_parse(const char *spec, sim_link_desc *desc);
/* Names of what can be changed, NULL at the end. */
const char *sim_link_key_at(unsigned index);

typedef struct sim_link sim_link;
/* A new link is connected; its clock (stalls, traces, cuts) starts at the first time that is given.
 * The same description, seed and bytes at the same times give the same arrivals, however often the
 * link is looked at in between. NULL when out of memory or a trace cannot be read. */
sim_link *sim_link_create(const sim_link_desc *desc, uint64_t seed);
void sim_link_destroy(sim_link *link);

/* Bytes taken now at `now_us` (times never go back); 0 when the queue is full; FF_ERR_CLOSED after
 * a cut. */
int sim_link_send(sim_link *link, enum sim_direction way, const uint8_t *bytes, size_t count,
                  int64_t now_us);
/* Bytes that send() would take now. */
size_t sim_link_room(sim_link *link, enum sim_direction way, int64_t now_us);
/* Bytes that have arrived by now_us; 0: none; FF_ERR_CLOSED after a cut. */
int sim_link_recv(sim_link *link, enum sim_direction way, uint8_t *bytes, size_t capacity,
                  int64_t now_us);
/* When the next bytes arrive or the next cut happens: for sleeping. INT64_MAX: nothing under
 * way. */
int64_t sim_link_next_us(const sim_link *link);
/* From now on the link is as `desc` says, as when a phone changes from one radio network to
 * another. Bytes queued or under way arrive later, in order; a trace ends, and the traces of `desc`
 * are not used. FF_OK or FF_ERR_MEMORY (the link is as before). */
int sim_link_change(sim_link *link, const sim_link_desc *desc, int64_t now_us);
/* Loses the connection now. */
void sim_link_cut(sim_link *link, int64_t now_us);
/* What a direction has carried since the start: packets that left the transmitter, their bytes
 * without headers, and how long they were under way from there, all together. */
typedef struct sim_link_load {
    uint64_t packets, bytes, delay_us;
} sim_link_load;
sim_link_load sim_link_get_load(const sim_link *link, enum sim_direction way);
/* Connections made so far, the first included: the server's end notices a new connection by it. */
unsigned sim_link_connections(const sim_link *link);
/* After a cut: starts connecting; FF_ERR_AGAIN until connect_ms have passed, then FF_OK; all bytes
 * under way are lost. */
int sim_link_reconnect(sim_link *link, int64_t now_us);

#endif
