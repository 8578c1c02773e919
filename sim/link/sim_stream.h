/* The two ends of a simulated link as streams of platform/sys.h, over a clock that both share. */
#ifndef SIM_STREAM_H
#define SIM_STREAM_H

#include "sim_link.h"

typedef struct sim_stream {
    sim_link *link;
    enum sim_direction send_way;
    const int64_t *now_us; /* the simulation's clock */
    uint64_t bytes_sent, bytes_received;
} sim_stream;

/* `end` must stay where it is while `stream` is used. The client's end sends up and can connect
 * again; the server's end sends down and cannot (it sees a new connection by sim_link_connections).
 * close() cuts the link. Neither owns the link. */
void sim_stream_client(sim_stream *end, sim_link *link, const int64_t *now_us, sys_stream *stream);
void sim_stream_server(sim_stream *end, sim_link *link, const int64_t *now_us, sys_stream *stream);

#endif
