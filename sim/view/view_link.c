#include "view_link.h"

#include <stdlib.h>
#include <string.h>

#define RELAY_BYTES 4096
#define SEED        1

typedef struct relay { /* bytes taken from one side that the other side has not taken yet */
    uint8_t bytes[RELAY_BYTES];
    size_t count;
} relay;

struct view_link {
    sys_mutex lock;     /* guards desc, next_profile and changed */
    sim_link_desc desc; /* the profile chosen */
    unsigned next_profile;
    int changed; /* 1: the worker has not yet made a link of `desc` */
    /* the worker's */
    int64_t now_us;
    sim_link *link;
    sim_stream end;
    sys_stream client; /* the client's end of `link` */
    sys_tcp tcp;
    sys_stream wire; /* to a real server; state NULL: `server` instead */
    sim_server server;
    int has_server;
    relay up, down;
    const ff_pack *pack;
};

static const sim_link_desc no_limits = {
    .name = "none",
    .way = { [SIM_DOWN] = { .queue_bytes = 1 << 16 }, [SIM_UP] = { .queue_bytes = 1 << 16 } }
};

static void drop_link(view_link *link)
{
    if (link->has_server) sim_server_free(&link->server);
    link->has_server = 0;
    sim_link_destroy(link->link);
    link->link = NULL;
    link->up.count = link->down.count = 0;
}

/* Makes a link of the profile chosen last, with the server's end where the server is ours. */
static int make_link(view_link *link)
{
    sim_link_desc desc;
    drop_link(link);
    sys_mutex_lock(&link->lock);
    desc = link->desc;
    link->changed = 0;
    sys_mutex_unlock(&link->lock);
    link->link = sim_link_create(&desc, SEED);
    if (!link->link) return FF_ERR_MEMORY;
    sim_stream_client(&link->end, link->link, &link->now_us, &link->client);
    if (link->wire.state) return FF_OK;
    int rc = sim_server_init(&link->server, link->pack, link->link, &link->now_us);
    link->has_server = rc == FF_OK;
    return rc;
}

static int has_changed(view_link *link)
{
    sys_mutex_lock(&link->lock);
    int changed = link->changed;
    sys_mutex_unlock(&link->lock);
    return changed;
}

static int relay_up(view_link *link)
{
    for (;;) {
        int got = sim_link_recv(link->link, SIM_UP, link->up.bytes + link->up.count,
                                RELAY_BYTES - link->up.count, link->now_us);
        if (got < 0) return got;
        link->up.count += (size_t)got;
        int sent = link->up.count
                       ? link->wire.send(link->wire.state, link->up.bytes, link->up.count)
                       : 0;
        if (sent < 0) return sent;
        memmove(link->up.bytes, link->up.bytes + sent, link->up.count -= (size_t)sent);
        if (sent == 0) return FF_OK;
    }
}

static int relay_down(view_link *link)
{
    for (;;) {
        int got = link->down.count < RELAY_BYTES
                      ? link->wire.recv(link->wire.state, link->down.bytes + link->down.count,
                                        RELAY_BYTES - link->down.count)
                      : 0;
        if (got < 0) return got;
        link->down.count += (size_t)got;
        int sent = sim_link_send(link->link, SIM_DOWN, link->down.bytes, link->down.count,
                                 link->now_us);
        if (sent < 0) return sent;
        memmove(link->down.bytes, link->down.bytes + sent, link->down.count -= (size_t)sent);
        if (sent == 0) return FF_OK;
    }
}

static void link_close(void *state)
{
    view_link *link = state;
    if (link->wire.state) link->wire.close(link->wire.state);
    if (link->link) link->client.close(link->client.state);
}

/* Lets what lies behind the link do its part. FF_ERR_CLOSED when the connection is lost. */
static int pump(view_link *link)
{
    int rc;
    link->now_us = sys_time_us();
    if (!link->link || has_changed(link))
        rc = FF_ERR_CLOSED;
    else if (link->has_server)
        rc = sim_server_step(&link->server);
    else if ((rc = relay_up(link)) == FF_OK)
        rc = relay_down(link);
    if (rc == FF_OK) return FF_OK;
    link_close(link);
    return FF_ERR_CLOSED;
}

static int link_send(void *state, const uint8_t *bytes, size_t count)
{
    view_link *link = state;
    int rc = pump(link);
    if (rc < 0) return rc;
    int sent = link->client.send(link->client.state, bytes, count);
    rc = pump(link);
    return rc < 0 ? rc : sent;
}

static int link_recv(void *state, uint8_t *bytes, size_t capacity)
{
    view_link *link = state;
    int rc = pump(link);
    return rc < 0 ? rc : link->client.recv(link->client.state, bytes, capacity);
}

static int link_reconnect(void *state)
{
    view_link *link = state;
    int rc = FF_OK;
    link->now_us = sys_time_us();
    if (!link->link || has_changed(link)) {
        rc = make_link(link);
        /* connecting takes its time on the new link too */
        if (rc == FF_OK) sim_link_cut(link->link, link->now_us);
    }
    if (rc == FF_OK && link->wire.state) rc = link->wire.reconnect(link->wire.state);
    if (rc == FF_OK) {
        link->up.count = link->down.count = 0;
        rc = link->client.reconnect(link->client.state);
    }
    return rc;
}

int view_link_create(const char *address, const ff_pack *pack, const char *spec, view_link **out,
                     sys_stream *stream)
{
    view_link *link = calloc(1, sizeof *link);
    int rc = FF_OK;
    if (!link) return FF_ERR_MEMORY;
    link->pack = pack;
    link->desc = no_limits;
    link->now_us = sys_time_us();
    sys_mutex_init(&link->lock);
    if (spec && strcmp(spec, no_limits.name)) rc = sim_link_parse(spec, &link->desc);
    if (rc == FF_OK && address) rc = sys_tcp_client(&link->tcp, address, &link->wire);
    if (rc == FF_OK) rc = make_link(link);
    if (rc < 0) {
        view_link_destroy(link);
        return rc;
    }
    *stream = (sys_stream){ link, link_send, link_recv, link_close, link_reconnect };
    *out = link;
    return FF_OK;
}

void view_link_destroy(view_link *link)
{
    if (!link) return;
    if (link->wire.state) link->wire.close(link->wire.state);
    drop_link(link);
    sys_mutex_destroy(&link->lock);
    free(link);
}

void view_link_cycle(view_link *link)
{
    sys_mutex_lock(&link->lock);
    const sim_link_desc *next = sim_link_profile_at(link->next_profile);
    link->next_profile = next ? link->next_profile + 1 : 0;
    link->desc = next ? *next : no_limits;
    link->changed = 1;
    sys_mutex_unlock(&link->lock);
}

const char *view_link_name(view_link *link)
{
    sys_mutex_lock(&link->lock);
    const char *name = link->desc.name;
    sys_mutex_unlock(&link->lock);
    return name;
}
