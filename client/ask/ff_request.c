#include "ff_request_local.h"
#include "../../protocol/ff_assert.h"

#include <string.h>

#define IN_FLIGHT_ALWAYS 2u
#define RESERVE_SHARE    8u /* of the bytes that may be in flight */

FF_STATIC_ASSERT(FF_REQUESTS_QUEUED_MAX <= UINT16_MAX); /* queued_max */

static size_t slots_for(unsigned in_flight_max)
{
    return (size_t)in_flight_max + FF_REQUESTS_QUEUED_MAX;
}

size_t ff_requests_bytes(unsigned in_flight_max)
{
    return slots_for(in_flight_max) * sizeof(ff_request);
}

void ff_requests_init(ff_requests *requests, unsigned in_flight_max, void *memory)
{
    FF_ASSERT(slots_for(in_flight_max) <= UINT16_MAX); /* ids on the wire are slots + 1 */
    memset(requests, 0, sizeof *requests);
    sys_mutex_init(&requests->mutex);
    requests->slot = memory;
    requests->slot_count = (uint16_t)slots_for(in_flight_max);
    requests->queued_max = FF_REQUESTS_QUEUED_MAX;
    requests->hash = FF_REQUEST_HASH_START;
    memset(requests->slot, 0, ff_requests_bytes(in_flight_max));
    ff_request_guess_bytes(requests);
}

/* Every way out of QUEUED, SENT and ARRIVING passes here, so that the counts stay true. */
static void leave_state(ff_requests *requests, const ff_request *request)
{
    ff_request_counts *counts = &requests->counts;
    if (request->state == FF_REQUEST_QUEUED) {
        FF_ASSERT(counts->queued > 0);
        counts->queued--;
    } else if (request->state == FF_REQUEST_SENT) {
        FF_ASSERT(counts->in_flight >= counts->of[request->kind].in_flight);
        FF_ASSERT(counts->of[request->kind].in_flight > 0);
        FF_ASSERT(counts->bytes_in_flight >= request->bytes_expected);
        counts->in_flight--;
        counts->of[request->kind].in_flight--;
        counts->bytes_in_flight -= request->bytes_expected;
        counts->reserve_in_flight -= request->rank == FF_CLASS_RESERVE;
        FF_ASSERT(counts->reserve_in_flight <= counts->in_flight);
    } else if (request->state == FF_REQUEST_ARRIVING) {
        FF_ASSERT(counts->arriving > 0);
        counts->arriving--;
    }
}

static void free_slot(ff_requests *requests, ff_request *request, uint32_t *final_count)
{
    FF_ASSERT(request->state != FF_REQUEST_FREE);
    leave_state(requests, request);
    request->state = FF_REQUEST_FREE;
    if (request->ask) requests->asks_taken &= (uint8_t) ~(1u << (request->ask - 1));
    request->ask = 0;
    if (request->id == requests->view_id) requests->view_id = 0;
    ++*final_count;
}

static void enqueue(ff_requests *requests, ff_request *request)
{
    ff_request_counts *counts = &requests->counts;
    FF_ASSERT(request->state == FF_REQUEST_FREE || request->state == FF_REQUEST_SENT);
    request->state = FF_REQUEST_QUEUED;
    request->named = 0;
    request->bytes_came = 0;
    if (++counts->queued > counts->queued_high) counts->queued_high = counts->queued;
    uint32_t held = counts->queued + counts->in_flight + counts->arriving;
    FF_ASSERT(held <= requests->slot_count);
    if (held > counts->held_high) counts->held_high = held;
}

void ff_requests_clear(ff_requests *requests)
{
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; i < requests->slot_count; i++) {
        ff_request *request = &requests->slot[i];
        if (request->state == FF_REQUEST_SENT) {
            request->forgotten = 1;
            if (!request->cancel) request->cancel = 1;
        } else if (request->state == FF_REQUEST_QUEUED) {
            free_slot(requests, request, &requests->counts.dropped);
        } else if (request->state != FF_REQUEST_FREE) {
            free_slot(requests, request, &requests->counts.cancelled);
        }
    }
    requests->view_id = 0;
    FF_ASSERT(requests->counts.queued + requests->counts.arriving == 0);
    sys_mutex_unlock(&requests->mutex);
}

static uint8_t layer_of(const ff_requests *requests, unsigned kind)
{
    return ff_kind[kind].has_image ? requests->layer : 0;
}

static ff_request *find(ff_requests *requests, unsigned kind, ff_key key)
{
    for (unsigned i = 0; i < requests->slot_count; i++) {
        ff_request *request = &requests->slot[i];
        if (request->state != FF_REQUEST_FREE && !request->forgotten && request->kind == kind &&
            request->key == key && request->layer == layer_of(requests, kind))
            return request;
    }
    return NULL;
}

static ff_request *find_free(ff_requests *requests)
{
    for (unsigned i = 0; i < requests->slot_count; i++)
        if (requests->slot[i].state == FF_REQUEST_FREE) return &requests->slot[i];
    return NULL;
}

void ff_requests_rank_begin(ff_requests *requests)
{
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; i < requests->slot_count; i++) requests->slot[i].marked = 0;
    sys_mutex_unlock(&requests->mutex);
}

/* A slot for a new request. In a full queue a request that this ranking has not wanted so far makes
 * room; NULL when there is none. */
static ff_request *slot_for_new(ff_requests *requests)
{
    if (requests->counts.queued >= requests->queued_max) {
        for (unsigned i = 0; i < requests->slot_count; i++) {
            ff_request *request = &requests->slot[i];
            if (request->state == FF_REQUEST_QUEUED && !request->marked) {
                free_slot(requests, request, &requests->counts.dropped);
                return request;
            }
        }
        return NULL;
    }
    return find_free(requests);
}

/* The request of this kind and key, marked, queued now if there was none; NULL: the queue is
 * full. */
static ff_request *mark(ff_requests *requests, enum ff_kind kind, ff_key key)
{
    ff_request *request = find(requests, kind, key);
    if (!request) {
        request = slot_for_new(requests);
        if (!request) {
            requests->counts.queue_full++;
            return NULL;
        }
        memset(request, 0, sizeof *request);
        request->key = key;
        request->kind = (uint8_t)kind;
        request->layer = layer_of(requests, kind);
        request->id = (uint16_t)(request - requests->slot + 1);
        request->sequence = requests->sequence++;
        requests->counts.made++;
        enqueue(requests, request);
    }
    request->marked = 1;
    return request;
}

static ff_request *view_of(ff_requests *requests)
{
    FF_ASSERT(requests->view_id <= requests->slot_count);
    return requests->view_id ? &requests->slot[requests->view_id - 1] : NULL;
}

/* Is it among what the view brings that is out, or wanted by the ranking under way? */
static int view_brings(ff_requests *requests, enum ff_kind kind, ff_key key)
{
    const ff_request *view = view_of(requests);
    if (!view || (view->state == FF_REQUEST_QUEUED && !view->marked)) return 0;
    return (kind == FF_KIND_ROOT || kind == FF_KIND_REFINEMENT) &&
           ff_view_covers(&requests->view, kind, key);
}

/* 0: there is no room, and the request is given up. */
static int keep_ask(ff_requests *requests, ff_request *request, const ff_ask *ask)
{
    if (request->state != FF_REQUEST_QUEUED) return 1; /* it is asked as it was */
    for (unsigned i = 0; !request->ask && i < FF_REQUESTS_ASKS_MAX; i++) {
        if (requests->asks_taken >> i & 1u) continue;
        requests->asks_taken |= (uint8_t)(1u << i);
        request->ask = (uint8_t)(i + 1);
    }
    if (request->ask)
        requests->ask[request->ask - 1] = *ask;
    else
        free_slot(requests, request, &requests->counts.dropped);
    return request->ask != 0;
}

int ff_requests_want(ff_requests *requests, enum ff_kind kind, ff_key key,
                     enum ff_request_class rank, uint32_t priority, unsigned sides,
                     const ff_ask *ask)
{
    FF_ASSERT(rank <= FF_CLASS_RESERVE && kind != FF_KIND_VIEW);
    FF_ASSERT((ask != NULL) == (ff_kind[kind].asks != FF_ASKS_NODE));
    sys_mutex_lock(&requests->mutex);
    int brought = view_brings(requests, kind, key);
    ff_request *request = brought ? NULL : mark(requests, kind, key);
    if (request && request->state == FF_REQUEST_QUEUED) {
        request->rank = (uint8_t)rank;
        request->sides = (uint8_t)sides;
        request->value = ff_request_value(requests, kind, ff_request_level(request), priority);
    }
    if (request && ask && !keep_ask(requests, request, ask)) request = NULL;
    sys_mutex_unlock(&requests->mutex);
    return brought || request;
}

int ff_requests_want_view(ff_requests *requests, const ff_get_view *view)
{
    FF_ASSERT(view->count <= FF_VIEW_KEYS_MAX);
    sys_mutex_lock(&requests->mutex);
    ff_request *request = mark(requests, FF_KIND_VIEW, 0);
    int taken = request && request->state == FF_REQUEST_QUEUED;
    if (taken) {
        request->rank = FF_CLASS_FIRST;
        request->value = UINT32_MAX;
        requests->view_id = request->id;
        requests->view = *view;
        requests->view.id = request->id;
    }
    sys_mutex_unlock(&requests->mutex);
    return taken;
}

int ff_requests_out(ff_requests *requests, enum ff_kind kind, ff_key key)
{
    sys_mutex_lock(&requests->mutex);
    const ff_request *request = find(requests, kind, key);
    int out = request && request->state != FF_REQUEST_QUEUED;
    sys_mutex_unlock(&requests->mutex);
    return out;
}

int ff_requests_view_brings(ff_requests *requests, enum ff_kind kind, ff_key key)
{
    sys_mutex_lock(&requests->mutex);
    int brought = view_brings(requests, kind, key);
    sys_mutex_unlock(&requests->mutex);
    return brought;
}

void ff_requests_rank_end(ff_requests *requests)
{
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; i < requests->slot_count; i++) {
        ff_request *request = &requests->slot[i];
        if (request->state == FF_REQUEST_QUEUED && !request->marked)
            free_slot(requests, request, &requests->counts.dropped);
    }
    sys_mutex_unlock(&requests->mutex);
}

/* Cancels a request; 1 when it is still under way. */
static int cancel(ff_requests *requests, ff_request *request)
{
    FF_ASSERT(request->state <= FF_REQUEST_ARRIVING); /* the others are ends, no slot is in one */
    if (request->state == FF_REQUEST_QUEUED) {
        free_slot(requests, request, &requests->counts.dropped);
        return 0;
    }
    if (request->state == FF_REQUEST_SENT && !request->cancel) request->cancel = 1;
    return 1;
}

int ff_requests_cancel(ff_requests *requests, enum ff_kind kind, ff_key key)
{
    sys_mutex_lock(&requests->mutex);
    ff_request *request = find(requests, kind, key);
    int under_way = request ? cancel(requests, request) : 0;
    sys_mutex_unlock(&requests->mutex);
    return under_way;
}

void ff_requests_cancel_all(ff_requests *requests, enum ff_kind kind)
{
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; i < requests->slot_count; i++)
        if (requests->slot[i].state != FF_REQUEST_FREE && requests->slot[i].kind == kind)
            (void)cancel(requests, &requests->slot[i]);
    sys_mutex_unlock(&requests->mutex);
}

void ff_requests_finish(ff_requests *requests, uint16_t id, enum ff_request_state final)
{
    sys_mutex_lock(&requests->mutex);
    FF_ASSERT(id >= 1 && id <= requests->slot_count);
    ff_request *request = &requests->slot[id - 1];
    FF_ASSERT(request->state == FF_REQUEST_ARRIVING && final > FF_REQUEST_ARRIVING);
    ff_request_counts *counts = &requests->counts;
    free_slot(requests, request,
              final == FF_REQUEST_DONE     ? &counts->done
              : final == FF_REQUEST_FAILED ? &counts->failed
                                           : &counts->cancelled);
    sys_mutex_unlock(&requests->mutex);
}

/* ---- worker ---- */
static int goes_before(const ff_request *a, const ff_request *b)
{
    if (a->rank != b->rank) return a->rank < b->rank;
    if (a->value != b->value) return a->value > b->value;
    FF_ASSERT(a->sequence != b->sequence);
    return a->sequence < b->sequence;
}

static unsigned answers_to(const ff_requests *requests, const ff_request *request)
{
    switch ((enum ff_kind_asks)ff_kind[request->kind].asks) {
        case FF_ASKS_PANORAMA: return ff_requests_ask_of(requests, request)->panorama.face_count;
        case FF_ASKS_FAR: return ff_requests_ask_of(requests, request)->far.sector_count;
        case FF_ASKS_NODE:
        case FF_ASKS_VIEW: break;
    }
    return 1;
}

static void count_one(uint32_t *count, uint32_t *high)
{
    if (++*count > *high) *high = *count;
}

static void count_sent(ff_requests *requests, const ff_request *request)
{
    ff_request_counts *counts = &requests->counts;
    counts->sent++;
    counts->of[request->kind].sent++;
    count_one(&counts->in_flight, &counts->in_flight_high);
    count_one(&counts->of[request->kind].in_flight, &counts->of[request->kind].in_flight_high);
    FF_ASSERT(counts->bytes_in_flight <= UINT32_MAX - request->bytes_expected);
    counts->bytes_in_flight += request->bytes_expected;
    counts->reserve_sent += request->rank == FF_CLASS_RESERVE;
    counts->reserve_in_flight += request->rank == FF_CLASS_RESERVE;
    ff_request_hash(&requests->hash, requests, request);
}

/* The last class that may leave now: the reserve is for a link that has nothing else to do. */
static enum ff_request_class last_class(const ff_request_counts *counts,
                                        uint32_t bytes_in_flight_max, int prefetch)
{
    if (!prefetch) return FF_CLASS_IN_VIEW;
    int idle = counts->in_flight == counts->reserve_in_flight &&
               (!counts->in_flight ||
                counts->bytes_in_flight < bytes_in_flight_max / RESERVE_SHARE);
    return idle ? FF_CLASS_RESERVE : FF_CLASS_PREFETCH;
}

/* An image may be a difference to the one above it, which goes before it. */
static ff_request *first_above(ff_requests *requests, ff_request *request)
{
    while (ff_kind[request->kind].has_image && ff_request_level(request) > 0) {
        ff_request *above = find(requests, request->kind, ff_key_parent(request->key));
        if (!above || above->state != FF_REQUEST_QUEUED) break;
        request = above;
    }
    FF_ASSERT(request->state == FF_REQUEST_QUEUED);
    return request;
}

int ff_requests_next(ff_requests *requests, int64_t now_us, unsigned in_flight_max,
                     uint32_t bytes_in_flight_max, int prefetch, ff_request *copy)
{
    ff_request *best = NULL;
    sys_mutex_lock(&requests->mutex);
    const ff_request_counts *counts = &requests->counts;
    int room = counts->in_flight < IN_FLIGHT_ALWAYS ||
               (counts->in_flight < in_flight_max && counts->bytes_in_flight < bytes_in_flight_max);
    enum ff_request_class last = last_class(counts, bytes_in_flight_max, prefetch);
    for (unsigned i = 0; room && i < requests->slot_count; i++) {
        ff_request *request = &requests->slot[i];
        if (request->state == FF_REQUEST_QUEUED && request->rank <= last &&
            (request->kind != FF_KIND_VIEW || !counts->of[FF_KIND_VIEW].in_flight) &&
            (!best || goes_before(request, best)))
            best = request;
    }
    if (best) {
        best = first_above(requests, best);
        leave_state(requests, best);
        best->state = FF_REQUEST_SENT;
        best->sent_us = now_us;
        best->order = counts->sent;
        best->cancel = 0;
        if (best->ask) requests->ask[best->ask - 1].id = best->id;
        best->bytes_expected = (requests->answer_q4[best->kind][ff_request_level(best)] >> 4) *
                               answers_to(requests, best);
        count_sent(requests, best);
        FF_ASSERT(counts->in_flight <= in_flight_max || counts->in_flight <= IN_FLIGHT_ALWAYS);
        *copy = *best;
    }
    sys_mutex_unlock(&requests->mutex);
    return best != NULL;
}

uint16_t ff_requests_next_cancel(ff_requests *requests)
{
    uint16_t id = 0;
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; !id && i < requests->slot_count; i++) {
        ff_request *request = &requests->slot[i];
        if (request->state == FF_REQUEST_SENT && request->cancel == 1 &&
            ff_kind[request->kind].asks != FF_ASKS_NODE) {
            FF_ASSERT(request->id == i + 1);
            request->cancel = 2;
            id = request->id;
        }
    }
    sys_mutex_unlock(&requests->mutex);
    return id;
}

int ff_requests_answered(ff_requests *requests, uint16_t id, ff_request *copy)
{
    int known = 0;
    sys_mutex_lock(&requests->mutex);
    if (id >= 1 && id <= requests->slot_count && requests->slot[id - 1].state == FF_REQUEST_SENT) {
        *copy = requests->slot[id - 1];
        FF_ASSERT(copy->id == id);
        known = 1;
    }
    sys_mutex_unlock(&requests->mutex);
    return known;
}

int ff_requests_oldest(ff_requests *requests, enum ff_kind_asks asks, ff_request *copy)
{
    const ff_request *oldest = NULL;
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; i < requests->slot_count; i++) {
        const ff_request *request = &requests->slot[i];
        if (request->state == FF_REQUEST_SENT && ff_kind[request->kind].asks == asks &&
            (!oldest || request->order - oldest->order > UINT32_MAX / 2))
            oldest = request;
    }
    if (oldest) *copy = *oldest;
    sys_mutex_unlock(&requests->mutex);
    return oldest != NULL;
}

int ff_requests_is_reserve(ff_requests *requests, enum ff_kind kind, ff_key key)
{
    sys_mutex_lock(&requests->mutex);
    const ff_request *request = find(requests, kind, key);
    enum ff_request_class rank = request ? (enum ff_request_class)request->rank : FF_CLASS_FIRST;
    sys_mutex_unlock(&requests->mutex);
    return rank == FF_CLASS_RESERVE;
}

void ff_requests_passed(ff_requests *requests, uint16_t id)
{
    sys_mutex_lock(&requests->mutex);
    FF_ASSERT(id >= 1 && id <= requests->slot_count);
    ff_request *request = &requests->slot[id - 1];
    FF_ASSERT(request->state == FF_REQUEST_SENT && request->forgotten);
    free_slot(requests, request, &requests->counts.cancelled);
    sys_mutex_unlock(&requests->mutex);
}

/* Some of its answer is here, the rest is still out. */
static void expect_less(ff_requests *requests, ff_request *request, uint32_t bytes)
{
    uint32_t less = bytes < request->bytes_expected ? bytes : request->bytes_expected;
    request->bytes_expected -= less;
    requests->counts.bytes_in_flight -= less;
}

void ff_requests_part(ff_requests *requests, uint16_t id, enum ff_kind kind, ff_key key,
                      uint32_t bytes)
{
    sys_mutex_lock(&requests->mutex);
    FF_ASSERT(id >= 1 && id <= requests->slot_count && id == requests->view_id);
    ff_request *request = &requests->slot[id - 1];
    FF_ASSERT(request->state == FF_REQUEST_SENT);
    request->named |= (uint16_t)ff_view_names(&requests->view, kind, key);
    expect_less(requests, request, bytes);
    request->bytes_came += bytes;
    sys_mutex_unlock(&requests->mutex);
}

void ff_requests_came(ff_requests *requests, uint16_t id, uint32_t bytes)
{
    sys_mutex_lock(&requests->mutex);
    FF_ASSERT(id >= 1 && id <= requests->slot_count);
    ff_request *request = &requests->slot[id - 1];
    FF_ASSERT(request->state == FF_REQUEST_SENT);
    expect_less(requests, request, bytes);
    if (request->rank == FF_CLASS_RESERVE) requests->counts.reserve_bytes += bytes;
    sys_mutex_unlock(&requests->mutex);
}

void ff_requests_arrived(ff_requests *requests, uint16_t id, uint32_t bytes)
{
    sys_mutex_lock(&requests->mutex);
    FF_ASSERT(id >= 1 && id <= requests->slot_count);
    ff_request *request = &requests->slot[id - 1];
    FF_ASSERT(request->state == FF_REQUEST_SENT);
    leave_state(requests, request);
    request->state = FF_REQUEST_ARRIVING;
    requests->counts.arriving++;
    bytes += request->bytes_came;
    if (request->rank == FF_CLASS_RESERVE) requests->counts.reserve_bytes += bytes;
    if (bytes) ff_request_learn_bytes(requests, request, bytes);
    sys_mutex_unlock(&requests->mutex);
}

void ff_requests_lost(ff_requests *requests)
{
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; i < requests->slot_count; i++) {
        ff_request *request = &requests->slot[i];
        if (request->state != FF_REQUEST_SENT) continue;
        leave_state(requests, request);
        enqueue(requests, request);
        if (request->cancel) free_slot(requests, request, &requests->counts.cancelled);
    }
    FF_ASSERT(requests->counts.in_flight == 0 && requests->counts.bytes_in_flight == 0);
    sys_mutex_unlock(&requests->mutex);
}

int ff_requests_waiting(ff_requests *requests, enum ff_request_class last)
{
    int waiting = 0;
    sys_mutex_lock(&requests->mutex);
    for (unsigned i = 0; !waiting && i < requests->slot_count; i++)
        waiting = requests->slot[i].state == FF_REQUEST_QUEUED && requests->slot[i].marked &&
                  requests->slot[i].rank <= last;
    sys_mutex_unlock(&requests->mutex);
    return waiting;
}

void ff_requests_get_counts(ff_requests *requests, ff_request_counts *counts, uint64_t *hash)
{
    sys_mutex_lock(&requests->mutex);
    *counts = requests->counts;
    FF_ASSERT(counts->held_high <= requests->slot_count);
    /* every request ends once */
    FF_ASSERT(counts->made == counts->done + counts->failed + counts->cancelled + counts->dropped +
                                  counts->queued + counts->in_flight + counts->arriving);
    if (hash) *hash = requests->hash;
    sys_mutex_unlock(&requests->mutex);
}
