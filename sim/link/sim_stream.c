#include "sim_stream.h"

static int end_send(void *state, const uint8_t *bytes, size_t count)
{
    sim_stream *end = state;
    int sent = sim_link_send(end->link, end->send_way, bytes, count, *end->now_us);
    if (sent > 0) end->bytes_sent += (uint64_t)sent;
    return sent;
}

static int end_recv(void *state, uint8_t *bytes, size_t capacity)
{
    sim_stream *end = state;
    enum sim_direction way = end->send_way == SIM_UP ? SIM_DOWN : SIM_UP;
    int received = sim_link_recv(end->link, way, bytes, capacity, *end->now_us);
    if (received > 0) end->bytes_received += (uint64_t)received;
    return received;
}

static void end_close(void *state)
{
    sim_stream *end = state;
    sim_link_cut(end->link, *end->now_us);
}

static int end_reconnect(void *state)
{
    sim_stream *end = state;
    return sim_link_reconnect(end->link, *end->now_us);
}

static void make(sim_stream *end, sim_link *link, enum sim_direction send_way,
                 const int64_t *now_us, sys_stream *stream)
{
    *end = (sim_stream){ .link = link, .send_way = send_way, .now_us = now_us };
    *stream = (sys_stream){ .state = end, .send = end_send, .recv = end_recv, .close = end_close };
}

void sim_stream_client(sim_stream *end, sim_link *link, const int64_t *now_us, sys_stream *stream)
{
    make(end, link, SIM_UP, now_us, stream);
    stream->reconnect = end_reconnect;
}

void sim_stream_server(sim_stream *end, sim_link *link, const int64_t *now_us, sys_stream *stream)
{
    make(end, link, SIM_DOWN, now_us, stream);
}
