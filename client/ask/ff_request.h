/* The request queue: one of the two places where the main thread and the network worker meet (the
 * other: ff_new_data.h).
 *
 * A request is a state machine. Each state has one owner, the only one who may move the request on;
 * every move happens under the pool's lock.
 *
 *   state      owner    meaning                                    next
 *   FREE       main     the slot is unused                         QUEUED
 *   QUEUED     worker   wanted, not sent yet                       SENT; CANCELLED ("dropped":
 *                                                                  main, when no longer wanted)
 *   SENT       worker   on its way or waiting for the answer       ARRIVING; QUEUED (the
 *                                                                  connection was lost)
 *   ARRIVING   main     the answer, refusal or last face lies on   DONE, FAILED, CANCELLED
 *                       the new-data list
 *   DONE       -        final: the answer was taken in             slot is FREE again
 *   FAILED     -        final: the server or the decoder refused   slot is FREE again
 *   CANCELLED  -        final: given up before an answer           slot is FREE again
 *
 * Every request ends in exactly one final state; `made` = done + failed + cancelled + dropped +
 * those still in a slot. No two requests with the same kind and key exist at a time, but for those
 * that are forgotten: their numbers stay taken until their answers have come.
 *
 * A request that is no longer wanted is dropped while it is not sent. Once it is sent, the answer
 * is let come: some hundred bytes cost less than the message that cancels them, so those for one
 * node cannot be cancelled. Who asks for kilobytes, or for work of the server's, as panoramas do,
 * cancels them.
 *
 * At most one request is of FF_KIND_VIEW, and none is sent while a forgotten one is out. It stands
 * for all that its answers may bring: who wants such a thing is told that it is under way.
 */
#ifndef FF_REQUEST_H
#define FF_REQUEST_H

#include "../../platform/sys.h"
#include "../../protocol/message/ff_message.h"

#define FF_REQUESTS_QUEUED_MAX 137 /* queued at a time, besides those in flight */
#define FF_REQUESTS_ASKS_MAX   8   /* of kinds whose key is the client's own, in any state */

enum ff_request_state {
    FF_REQUEST_FREE,
    FF_REQUEST_QUEUED,
    FF_REQUEST_SENT,
    FF_REQUEST_ARRIVING,
    FF_REQUEST_DONE,
    FF_REQUEST_FAILED,
    FF_REQUEST_CANCELLED
};
/* A request of a lower class goes first, whatever its value. */
enum ff_request_class { FF_CLASS_FIRST, FF_CLASS_IN_VIEW, FF_CLASS_PREFETCH, FF_CLASS_RESERVE };

typedef struct ff_request {
    ff_key key;              /* what it means says its kind: enum ff_kind_asks */
    uint32_t value;          /* within the class: priority per expected byte, higher first */
    uint32_t sequence;       /* ties: older first */
    uint32_t bytes_expected; /* of the answer */
    uint32_t order;          /* of sending: node by node answers come in it */
    int64_t sent_us;
    uint16_t id;               /* slot + 1; on the wire, where its kind has one */
    uint8_t kind, state, rank; /* enums ff_kind, ff_request_state, ff_request_class */
    uint8_t marked;            /* wanted by the ranking under way */
    uint8_t cancel;            /* 1: to be cancelled; 2: the cancellation was sent */
    uint8_t forgotten;         /* sent for a terrain that is no more: its answer passes by */
    uint16_t named;            /* FF_KIND_VIEW: bit i: what its view names at i has come */
    uint32_t bytes_came;       /* the same: of the answers so far */
    uint8_t ask;               /* of FF_ASKS_PANORAMA, FF_ASKS_FAR: ff_requests_ask_of */
    uint8_t sides;             /* of a refinement: as in ff_get */
    uint8_t layer;             /* of images, of which it is asked for */
} ff_request;

typedef struct ff_request_counts {
    uint32_t made, sent, done, failed, cancelled, dropped, queue_full;
    uint32_t queued, queued_high, in_flight, in_flight_high, arriving;
    uint32_t bytes_in_flight; /* expected */
    uint32_t held_high;       /* slots in use at once */
    /* of FF_CLASS_RESERVE, as they were sent; bytes of the answers, without headers */
    uint32_t reserve_sent, reserve_in_flight, reserve_bytes;
    struct {
        uint32_t sent, in_flight, in_flight_high;
    } of[FF_KIND_COUNT];
} ff_request_counts;

typedef struct ff_requests {
    sys_mutex mutex; /* guards everything below */
    ff_request *slot;
    uint16_t slot_count, queued_max;
    uint32_t sequence;
    uint64_t hash; /* over requests as sent */
    ff_request_counts counts;
    /* of FF_KIND_VIEW: its slot + 1, 0: there is none; what it asks. Main writes that while the
     * request is not sent, the worker reads it while it is */
    uint16_t view_id;
    ff_get_view view;
    /* of those whose key is the client's own; written and read likewise. Bit i: ask[i] is taken */
    ff_ask ask[FF_REQUESTS_ASKS_MAX];
    uint8_t asks_taken;
    uint8_t layer; /* of images, that are asked for now */
    /* bytes of an answer by kind and level, running mean, Q4; bit l: one of level l has come.
     * Until then it counts as the first of its kind did */
    uint32_t answer_q4[FF_KIND_COUNT][16];
    uint16_t met[FF_KIND_COUNT];
} ff_requests;

/* What a request of FF_ASKS_PANORAMA or FF_ASKS_FAR has besides its key. */
static inline const ff_ask *ff_requests_ask_of(const ff_requests *requests,
                                               const ff_request *request)
{
    FF_ASSERT(request->ask >= 1 && request->ask <= FF_REQUESTS_ASKS_MAX);
    return &requests->ask[request->ask - 1];
}

size_t ff_requests_bytes(unsigned in_flight_max);
void ff_requests_init(ff_requests *requests, unsigned in_flight_max, void *memory);
/* Forgets every request (another terrain); each one counts as cancelled or dropped. The connection
 * may be the same as before: those that are sent are cancelled, and their answers pass by. */
void ff_requests_clear(ff_requests *requests);

/* ---- main thread ---- */
/* Images are asked for of this layer from now on. Those of another one that are on their way are
 * not taken for it; what waits is dropped by the next ranking. */
static inline void ff_requests_set_layer(ff_requests *requests, uint8_t layer)
{
    sys_mutex_lock(&requests->mutex);
    requests->layer = layer;
    sys_mutex_unlock(&requests->mutex);
}
/* A ranking: begin, want everything worth having (most urgent first), end. Queued requests that
 * were not wanted again are dropped. */
void ff_requests_rank_begin(ff_requests *requests);
/* 1 when queued or already under way, 0 when the queue is full, or FF_REQUESTS_ASKS_MAX are out.
 * priority per byte decides within `rank`. `sides` of a refinement, bits of ff_side: they are held,
 * and may be left out. */
int ff_requests_want(ff_requests *requests, enum ff_kind kind, ff_key key,
                     enum ff_request_class rank, uint32_t priority, unsigned sides,
                     const ff_ask *ask);
/* The same for a view, before all else; 0 also while an older one is sent or arriving. */
int ff_requests_want_view(ff_requests *requests, const ff_get_view *view);
void ff_requests_rank_end(ff_requests *requests);
/* 1 while a request of this kind and key waits for its answer, or for being taken in. */
int ff_requests_out(ff_requests *requests, enum ff_kind kind, ff_key key);
/* 1 when a view that is out may bring it. */
int ff_requests_view_brings(ff_requests *requests, enum ff_kind kind, ff_key key);
/* Bytes that an answer of a kind is expected to have, of a node's level. */
uint32_t ff_requests_answer_bytes(ff_requests *requests, enum ff_kind kind, unsigned level);
/* 1 when something of class `last` or one before it is queued: wanted and not yet sent. */
int ff_requests_waiting(ff_requests *requests, enum ff_request_class last);
/* Cancels a request: drops a queued one, has a sent one cancelled by the server. 1 when it is still
 * under way. */
int ff_requests_cancel(ff_requests *requests, enum ff_kind kind, ff_key key);
/* The same for all of a kind. */
void ff_requests_cancel_all(ff_requests *requests, enum ff_kind kind);
/* Ends an ARRIVING request in a final state. */
void ff_requests_finish(ff_requests *requests, uint16_t id, enum ff_request_state final);

/* ---- worker ---- */
/* Takes the most urgent queued request while fewer than `in_flight_max` and `bytes_in_flight_max`
 * are out (two are always allowed): moves it to SENT, *copy describes it. prefetch 0 leaves the
 * classes from FF_CLASS_PREFETCH on alone. The reserve leaves while nothing else is out and only an
 * eighth of bytes_in_flight_max of its own, one at least: what comes into view then waits for no
 * more than that. 1, or 0 when there is none. */
int ff_requests_next(ff_requests *requests, int64_t now_us, unsigned in_flight_max,
                     uint32_t bytes_in_flight_max, int prefetch, ff_request *copy);
/* A sent request to be cancelled on the wire: its id, once, or 0. */
uint16_t ff_requests_next_cancel(ff_requests *requests);
/* A request waiting for an answer: 1 and *copy, or 0: unknown id (stale or nonsense). Checks ask
 * it, too. */
int ff_requests_answered(ff_requests *requests, uint16_t id, ff_request *copy);
/* The same for what is answered in order, or is one at a time: the oldest of those that ask so. */
int ff_requests_oldest(ff_requests *requests, enum ff_kind_asks asks, ff_request *copy);
/* 1 when that request is for the reserve. */
int ff_requests_is_reserve(ff_requests *requests, enum ff_kind kind, ff_key key);
/* The last answer to a forgotten request has passed by. */
void ff_requests_passed(ff_requests *requests, uint16_t id);
/* A part of a view's answer lies on the new-data list. */
void ff_requests_part(ff_requests *requests, uint16_t id, enum ff_kind kind, ff_key key,
                      uint32_t bytes);
/* One of several answers, not the last, lies on the new-data list. */
void ff_requests_came(ff_requests *requests, uint16_t id, uint32_t bytes);
/* SENT to ARRIVING once the answer lies on the new-data list; bytes: size of the answer, for the
 * means. */
void ff_requests_arrived(ff_requests *requests, uint16_t id, uint32_t bytes);
/* The connection is lost: SENT requests are queued again; those being cancelled end. */
void ff_requests_lost(ff_requests *requests);
void ff_requests_get_counts(ff_requests *requests, ff_request_counts *counts, uint64_t *hash);

#endif
