#include "sim_pipe.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum random_stream { STREAM_STALLS = 1, STREAM_JITTER = 2 /* + direction */ };

/* ---- stalls ---- */

/* -ln((r + 1) / 2^32) in Q16, by squaring: integers, so that every machine draws the same
 * stalls. */
static uint32_t negative_ln_q16(uint32_t r)
{
    uint64_t x = (uint64_t)r + 1, log2_q24 = 0;
    int whole = 31;
    if (x > UINT32_MAX) return 0;
    while (x < (1u << 31)) {
        x <<= 1;
        whole--;
    }
    for (int bit = 23; bit >= 0; bit--) { /* x in 1..2, Q31 */
        x = (x * x) >> 31;
        if (x >> 32) {
            x >>= 1;
            log2_q24 |= 1u << bit;
        }
    }
    uint64_t missing_q24 = (32u << 24) - (((uint64_t)whole << 24) + log2_q24);
    return (uint32_t)((missing_q24 * 45426u) >> 24); /* ln 2 = 45426 / 2^16 */
}

static void next_stall(sim_stalls *stalls)
{
    uint64_t gap_us = ((uint64_t)stalls->every_ms * 1000u *
                       negative_ln_q16(sys_random_u32(&stalls->random))) >>
                      16;
    uint32_t spread_ms = stalls->ms_max - stalls->ms_min;
    uint32_t length_ms = stalls->ms_min +
                         (spread_ms ? sys_random_below(&stalls->random, spread_ms) : 0);
    stalls->start_us = stalls->end_us + (int64_t)gap_us;
    stalls->end_us = stalls->start_us + (int64_t)length_ms * 1000;
}

/* Prepares the stalls of a link; none begins before `from_us`. */
static void stalls_init(sim_stalls *stalls, const sim_link_desc *desc, uint64_t seed,
                        int64_t from_us)
{
    *stalls = (sim_stalls){ .end_us = from_us,
                            .every_ms = desc->stall_every_ms,
                            .ms_min = desc->stall_ms_min,
                            .ms_max = desc->stall_ms_max,
                            .bytes_s = desc->stall_bytes_s };
    if (stalls->ms_max < stalls->ms_min) stalls->ms_max = stalls->ms_min;
    if (!stalls->ms_max) stalls->every_ms = 0;
    sys_random_seed(&stalls->random, seed, STREAM_STALLS);
    if (stalls->every_ms) next_stall(stalls);
}

/* The rate at time_us, given the rate without stalls; *until_us receives until when it holds. Times
 * never go back. */
static uint32_t stalls_rate(sim_stalls *stalls, uint32_t bytes_s, int64_t time_us,
                            int64_t *until_us)
{
    *until_us = INT64_MAX;
    if (!stalls->every_ms) return bytes_s;
    while (time_us >= stalls->end_us) next_stall(stalls);
    int stalled = time_us >= stalls->start_us;
    *until_us = stalled ? stalls->end_us : stalls->start_us;
    return stalled ? stalls->bytes_s : bytes_s;
}

/* ---- spans ---- */

static sim_span *span_at(sim_spans *spans, uint32_t index)
{
    return &spans->item[(spans->first + index) % SIM_PIPE_SPANS];
}

static void span_push(sim_spans *spans, int64_t us, uint32_t count)
{
    if (spans->count && span_at(spans, spans->count - 1)->us == us && count <= UINT32_MAX / 2) {
        span_at(spans, spans->count - 1)->count += count;
        return;
    }
    assert(spans->count < SIM_PIPE_SPANS);
    *span_at(spans, spans->count++) = (sim_span){ us, count };
}

static void span_take(sim_spans *spans, uint32_t count)
{
    sim_span *span = span_at(spans, 0);
    assert(spans->count && span->count >= count);
    span->count -= count;
    if (!span->count) {
        spans->first = (spans->first + 1) % SIM_PIPE_SPANS;
        spans->count--;
    }
}

/* ---- the pipe ---- */

int sim_pipe_init(sim_pipe *pipe, const sim_link_desc *desc, enum sim_direction way, uint64_t seed)
{
    memset(pipe, 0, sizeof *pipe);
    pipe->desc = desc->way[way];
    if (!pipe->desc.queue_bytes) pipe->desc.queue_bytes = 1;
    stalls_init(&pipe->stalls, desc, seed, 0);
    sys_random_seed(&pipe->jitter, seed, STREAM_JITTER + (uint64_t)way);
    if (pipe->desc.trace) {
        int rc = sim_trace_read(&pipe->trace, pipe->desc.trace);
        if (rc != FF_OK) return rc;
    }
    pipe->ring_bytes = (size_t)pipe->desc.queue_bytes + SIM_LINK_WINDOW_BYTES;
    pipe->ring = malloc(pipe->ring_bytes);
    if (!pipe->ring) {
        sim_pipe_free(pipe);
        return FF_ERR_MEMORY;
    }
    return FF_OK;
}

void sim_pipe_free(sim_pipe *pipe)
{
    sim_trace_free(&pipe->trace);
    free(pipe->ring);
    pipe->ring = NULL;
}

void sim_pipe_flush(sim_pipe *pipe, int64_t now_us)
{
    pipe->stored = pipe->queued = 0;
    pipe->queue.count = pipe->wire.count = 0;
    pipe->free_us = now_us;
    pipe->surplus = 0;
}

/* When the transmitter can take the first queued byte. */
static int64_t start_us(const sim_pipe *pipe, uint64_t *opportunity)
{
    int64_t sent_us = pipe->queue.item[pipe->queue.first].us;
    int64_t start = sent_us > pipe->free_us ? sent_us : pipe->free_us;
    *opportunity = 0;
    if (!pipe->trace.count) return start;
    *opportunity = sim_trace_find(&pipe->trace, start);
    if (*opportunity < pipe->opportunity) *opportunity = pipe->opportunity;
    return sim_trace_time_us(&pipe->trace, *opportunity);
}

/* Takes up to `most` queued bytes that were sent by time_us off the queue; they are now on the
 * wire. */
static uint32_t take_packet(sim_pipe *pipe, uint32_t most, int64_t time_us)
{
    uint32_t packet = 0;
    while (packet < most && pipe->queue.count && span_at(&pipe->queue, 0)->us <= time_us) {
        uint32_t part = span_at(&pipe->queue, 0)->count;
        if (part > most - packet) part = most - packet;
        span_take(&pipe->queue, part);
        packet += part;
    }
    pipe->queued -= packet;
    return packet;
}

/* The time at which `count` bytes are out that the transmitter starts at time_us. The time is whole
 * microseconds; the part of a byte that was paid for and not used is carried over to the next
 * packet, so that a long row of packets takes exactly its bytes divided by the rate. */
static int64_t transmit(sim_pipe *pipe, uint32_t count, int64_t time_us)
{
    uint64_t need = (uint64_t)count * 1000000u;
    if (!pipe->desc.bytes_s) return time_us;
    if (time_us > pipe->free_us) pipe->surplus = 0;
    if (pipe->surplus >= need) {
        pipe->surplus -= need;
        return time_us;
    }
    need -= pipe->surplus;
    for (;;) {
        int64_t until_us;
        uint64_t rate = stalls_rate(&pipe->stalls, pipe->desc.bytes_s, time_us, &until_us);
        uint64_t long_us = rate ? (need + rate - 1) / rate : UINT64_MAX;
        if (long_us <= (uint64_t)(until_us - time_us)) {
            pipe->surplus = long_us * rate - need;
            return time_us + (int64_t)long_us;
        }
        need -= (uint64_t)(until_us - time_us) * rate;
        time_us = until_us;
    }
}

/* Moves all packets whose transmission starts before now_us to the wire. Not those that start at
 * now_us: bytes sent at the same moment by several calls go together. */
static void advance(sim_pipe *pipe, int64_t now_us)
{
    uint64_t opportunity;
    while (pipe->queue.count && pipe->wire.count < SIM_PIPE_SPANS) {
        int64_t time_us = start_us(pipe, &opportunity);
        if (time_us >= now_us) return;
        uint32_t most = pipe->trace.count ? SIM_TRACE_OPPORTUNITY_BYTES : SIM_PIPE_PACKET_BYTES;
        if (!pipe->trace.count && !pipe->desc.bytes_s) most = UINT32_MAX;
        uint32_t packet = take_packet(pipe, most, time_us);
        pipe->opportunity = opportunity + 1;
        pipe->free_us = pipe->trace.count ? time_us : transmit(pipe, packet, time_us);
        int64_t arrival_us = pipe->free_us + pipe->desc.delay_us;
        if (pipe->desc.jitter_us)
            arrival_us += sys_random_below(&pipe->jitter, pipe->desc.jitter_us);
        if (arrival_us > pipe->arrival_us) pipe->arrival_us = arrival_us;
        pipe->load.packets++;
        pipe->load.bytes += packet;
        pipe->load.delay_us += (uint64_t)(pipe->arrival_us - pipe->free_us);
        span_push(&pipe->wire, pipe->arrival_us, packet);
    }
}

size_t sim_pipe_room(sim_pipe *pipe, int64_t now_us)
{
    advance(pipe, now_us);
    /* more after a change */
    size_t room = pipe->desc.queue_bytes > pipe->queued ? pipe->desc.queue_bytes - pipe->queued : 0;
    if (room > pipe->ring_bytes - pipe->stored) room = pipe->ring_bytes - pipe->stored;
    return pipe->queue.count == SIM_PIPE_SPANS ? 0 : room;
}

int sim_pipe_widen(sim_pipe *pipe, uint32_t queue_bytes)
{
    size_t ring_bytes = (size_t)queue_bytes + SIM_LINK_WINDOW_BYTES,
           straight = pipe->ring_bytes - pipe->ring_first;
    if (ring_bytes <= pipe->ring_bytes) return FF_OK;
    uint8_t *ring = malloc(ring_bytes);
    if (!ring) return FF_ERR_MEMORY;
    if (straight > pipe->stored) straight = pipe->stored;
    memcpy(ring, pipe->ring + pipe->ring_first, straight);
    memcpy(ring + straight, pipe->ring, pipe->stored - straight);
    free(pipe->ring);
    pipe->ring = ring;
    pipe->ring_bytes = ring_bytes;
    pipe->ring_first = 0;
    return FF_OK;
}

void sim_pipe_change(sim_pipe *pipe, const sim_link_desc *desc, enum sim_direction way,
                     uint64_t seed, int64_t now_us)
{
    advance(pipe, now_us);
    assert((size_t)desc->way[way].queue_bytes + SIM_LINK_WINDOW_BYTES <= pipe->ring_bytes);
    sim_trace_free(&pipe->trace);
    pipe->trace = (sim_trace){ 0 };
    pipe->desc = desc->way[way];
    pipe->desc.trace = NULL;
    if (!pipe->desc.queue_bytes) pipe->desc.queue_bytes = 1;
    stalls_init(&pipe->stalls, desc, seed, now_us);
    pipe->surplus = 0;
    if (pipe->free_us <= now_us) return;
    /* The last packet on the wire is still being sent, perhaps for the rest of a long stall that
     * the link had before the change. */
    sim_span *last = span_at(&pipe->wire, pipe->wire.count - 1);
    int64_t before_us = pipe->wire.count > 1 ? span_at(&pipe->wire, pipe->wire.count - 2)->us
                                             : now_us;
    pipe->free_us = now_us;
    pipe->free_us = transmit(pipe, last->count, now_us);
    last->us = pipe->free_us + pipe->desc.delay_us > before_us ? pipe->free_us + pipe->desc.delay_us
                                                               : before_us;
    pipe->arrival_us = last->us;
}

int sim_pipe_send(sim_pipe *pipe, const uint8_t *bytes, size_t count, int64_t now_us)
{
    size_t room = sim_pipe_room(pipe, now_us);
    if (count > room) count = room;
    if (count > INT_MAX) count = INT_MAX;
    if (!count) return 0;
    size_t last = (pipe->ring_first + pipe->stored) % pipe->ring_bytes;
    size_t straight = pipe->ring_bytes - last < count ? pipe->ring_bytes - last : count;
    memcpy(pipe->ring + last, bytes, straight);
    memcpy(pipe->ring, bytes + straight, count - straight);
    pipe->stored += count;
    pipe->queued += count;
    span_push(&pipe->queue, now_us, (uint32_t)count);
    return (int)count;
}

int sim_pipe_recv(sim_pipe *pipe, uint8_t *bytes, size_t capacity, int64_t now_us)
{
    size_t taken = 0;
    if (capacity > INT_MAX) capacity = INT_MAX;
    advance(pipe, now_us);
    while (taken < capacity && pipe->wire.count && span_at(&pipe->wire, 0)->us <= now_us) {
        uint32_t part = span_at(&pipe->wire, 0)->count;
        if (part > capacity - taken) part = (uint32_t)(capacity - taken);
        if (part > pipe->ring_bytes - pipe->ring_first)
            part = (uint32_t)(pipe->ring_bytes - pipe->ring_first);
        memcpy(bytes + taken, pipe->ring + pipe->ring_first, part);
        pipe->ring_first = (pipe->ring_first + part) % pipe->ring_bytes;
        span_take(&pipe->wire, part);
        taken += part;
    }
    pipe->stored -= taken;
    return (int)taken;
}

int64_t sim_pipe_next_us(const sim_pipe *pipe)
{
    uint64_t opportunity;
    int64_t next = INT64_MAX;
    if (pipe->wire.count) next = pipe->wire.item[pipe->wire.first].us;
    if (pipe->queue.count && start_us(pipe, &opportunity) + 1 < next)
        next = start_us(pipe, &opportunity) + 1;
    return next;
}
