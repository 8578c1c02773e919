#include "sim_link.h"

#include "sim_pipe.h"

#include <stdlib.h>

enum link_state { LINK_UP, LINK_CUT, LINK_CONNECTING };
enum { STREAM_CUTS = 16 };

struct sim_link {
    sim_link_desc desc;
    sim_pipe pipe[2];
    sys_random cuts;
    enum link_state state;
    int started;
    int64_t epoch_us;     /* the first time given; all times below count from it */
    int64_t cut_us;       /* of the next cut */
    int64_t connected_us; /* when the connection under way is there */
    unsigned connections, changes;
    uint64_t seed;
};

static void plan_cut(sim_link *link, int64_t time_us)
{
    uint64_t every_ms = link->desc.cut_every_ms;
    link->cut_us = INT64_MAX;
    if (every_ms)
        link->cut_us = time_us +
                       (int64_t)(every_ms * 500u + every_ms * sys_random_below(&link->cuts, 1001));
}

/* Time since the link's start. Cuts that are due happen here. */
static int64_t link_time(sim_link *link, int64_t now_us)
{
    if (!link->started) {
        link->started = 1;
        link->epoch_us = now_us;
        plan_cut(link, 0);
    }
    int64_t time_us = now_us - link->epoch_us;
    if (link->state == LINK_UP && time_us >= link->cut_us) link->state = LINK_CUT;
    return time_us;
}

uint32_t sim_link_answer_ms(const sim_link_desc *desc)
{
    uint64_t us = 0;
    for (int way = 0; way < 2; way++) us += desc->way[way].delay_us + desc->way[way].jitter_us / 2u;
    return (uint32_t)(us / 1000);
}

sim_link *sim_link_create(const sim_link_desc *desc, uint64_t seed)
{
    sim_link *link = calloc(1, sizeof *link);
    if (!link) return NULL;
    link->desc = *desc;
    link->cut_us = INT64_MAX;
    link->connections = 1;
    link->seed = seed;
    sys_random_seed(&link->cuts, seed, STREAM_CUTS);
    if (sim_pipe_init(&link->pipe[SIM_DOWN], desc, SIM_DOWN, seed) != FF_OK) {
        free(link);
        return NULL;
    }
    if (sim_pipe_init(&link->pipe[SIM_UP], desc, SIM_UP, seed) != FF_OK) {
        sim_pipe_free(&link->pipe[SIM_DOWN]);
        free(link);
        return NULL;
    }
    return link;
}

void sim_link_destroy(sim_link *link)
{
    if (!link) return;
    sim_pipe_free(&link->pipe[SIM_DOWN]);
    sim_pipe_free(&link->pipe[SIM_UP]);
    free(link);
}

int sim_link_send(sim_link *link, enum sim_direction way, const uint8_t *bytes, size_t count,
                  int64_t now_us)
{
    int64_t time_us = link_time(link, now_us);
    return link->state == LINK_UP ? sim_pipe_send(&link->pipe[way], bytes, count, time_us)
                                  : FF_ERR_CLOSED;
}

size_t sim_link_room(sim_link *link, enum sim_direction way, int64_t now_us)
{
    int64_t time_us = link_time(link, now_us);
    return link->state == LINK_UP ? sim_pipe_room(&link->pipe[way], time_us) : 0;
}

int sim_link_recv(sim_link *link, enum sim_direction way, uint8_t *bytes, size_t capacity,
                  int64_t now_us)
{
    int64_t time_us = link_time(link, now_us);
    return link->state == LINK_UP ? sim_pipe_recv(&link->pipe[way], bytes, capacity, time_us)
                                  : FF_ERR_CLOSED;
}

int64_t sim_link_next_us(const sim_link *link)
{
    int64_t next = INT64_MAX;
    if (link->state == LINK_CONNECTING) next = link->connected_us;
    if (link->state == LINK_UP) {
        next = link->cut_us;
        for (int way = 0; way < 2; way++)
            if (sim_pipe_next_us(&link->pipe[way]) < next)
                next = sim_pipe_next_us(&link->pipe[way]);
    }
    return next == INT64_MAX ? next : next + link->epoch_us;
}

int sim_link_change(sim_link *link, const sim_link_desc *desc, int64_t now_us)
{
    int64_t time_us = link_time(link, now_us);
    for (int way = 0; way < 2; way++)
        if (sim_pipe_widen(&link->pipe[way], desc->way[way].queue_bytes) != FF_OK)
            return FF_ERR_MEMORY;
    link->changes++;
    for (int way = 0; way < 2; way++)
        sim_pipe_change(&link->pipe[way], desc, (enum sim_direction)way, link->seed + link->changes,
                        time_us);
    link->desc = *desc;
    if (link->state == LINK_UP) plan_cut(link, time_us);
    return FF_OK;
}

void sim_link_cut(sim_link *link, int64_t now_us)
{
    (void)link_time(link, now_us);
    link->state = LINK_CUT;
}

sim_link_load sim_link_get_load(const sim_link *link, enum sim_direction way)
{
    return link->pipe[way].load;
}

unsigned sim_link_connections(const sim_link *link) { return link->connections; }

int sim_link_reconnect(sim_link *link, int64_t now_us)
{
    int64_t time_us = link_time(link, now_us);
    if (link->state == LINK_UP) return FF_OK;
    if (link->state == LINK_CUT) {
        link->state = LINK_CONNECTING;
        link->connected_us = time_us + (int64_t)link->desc.connect_ms * 1000;
    }
    if (time_us < link->connected_us) return FF_ERR_AGAIN;
    for (int way = 0; way < 2; way++) sim_pipe_flush(&link->pipe[way], time_us);
    link->state = LINK_UP;
    link->connections++;
    plan_cut(link, time_us);
    return FF_OK;
}
