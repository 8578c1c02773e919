/* One direction of a link: a byte queue, a transmitter of exact rate, a wire with delay, and what
 * has arrived.
 *
 *      send ──▶ [ queue ] ──transmitter──▶ [ wire: delay, jitter ] ──▶ [ arrived ] ──▶ recv
 *
 * The transmitter takes what is queued in packets of up to SIM_PIPE_PACKET_BYTES. Which bytes share
 * a packet depends only on when they were sent, never on when the pipe is looked at. Times are
 * microseconds since the link's start and never go back.
 */
#ifndef SIM_PIPE_H
#define SIM_PIPE_H

#include "sim_link.h"
#include "sim_trace.h"

/* A common packet size of 2.5G links; jitter is drawn for each packet. */
#define SIM_PIPE_PACKET_BYTES 512
/* The most sends that wait, and the most packets under way; more hold the sender back. */
#define SIM_PIPE_SPANS 4096

/* The stalls of a link in order of time; both directions make the same ones from the same seed. */
typedef struct sim_stalls {
    sys_random random;
    uint32_t every_ms, ms_min, ms_max, bytes_s;
    int64_t start_us, end_us; /* of the present or next one */
} sim_stalls;

typedef struct sim_span {
    int64_t us;
    uint32_t count;
} sim_span;
typedef struct sim_spans {
    sim_span item[SIM_PIPE_SPANS];
    uint32_t first, count;
} sim_spans;

typedef struct sim_pipe {
    sim_link_way desc;
    sim_stalls stalls;
    sim_trace trace;
    sys_random jitter;
    uint8_t *ring;
    size_t ring_bytes, ring_first, stored; /* arrived, under way and queued bytes, in order */
    size_t queued;                         /* of the stored bytes, the last ones */
    sim_spans queue, wire;                 /* times: when bytes were sent; when they arrive */
    int64_t free_us;                       /* the transmitter is busy until then */
    uint64_t surplus;     /* part of a byte already paid for, in millionths of a byte */
    uint64_t opportunity; /* with a trace: the first opportunity not used up */
    int64_t arrival_us;   /* of the last packet: order is kept */
    sim_link_load load;
} sim_pipe;

/* FF_OK, FF_ERR_MEMORY, or an error of the trace. */
int sim_pipe_init(sim_pipe *pipe, const sim_link_desc *desc, enum sim_direction way, uint64_t seed);
void sim_pipe_free(sim_pipe *pipe);
/* Loses all bytes stored. */
void sim_pipe_flush(sim_pipe *pipe, int64_t now_us);
/* Makes room for a queue of queue_bytes, if there is less. FF_OK or FF_ERR_MEMORY (nothing
 * happened). */
int sim_pipe_widen(sim_pipe *pipe, uint32_t queue_bytes);
/* Another rate, delay, jitter, queue (sim_pipe_widen first) and stalls from now on; the packet
 * being sent starts again. */
void sim_pipe_change(sim_pipe *pipe, const sim_link_desc *desc, enum sim_direction way,
                     uint64_t seed, int64_t now_us);
size_t sim_pipe_room(sim_pipe *pipe, int64_t now_us);
int sim_pipe_send(sim_pipe *pipe, const uint8_t *bytes, size_t count, int64_t now_us);
int sim_pipe_recv(sim_pipe *pipe, uint8_t *bytes, size_t capacity, int64_t now_us);
int64_t sim_pipe_next_us(const sim_pipe *pipe);

#endif
