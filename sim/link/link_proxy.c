#include "link_proxy.h"

#include <stdlib.h>
#include <string.h>

#define CONNECTIONS_MAX 64
#define PIECE_BYTES     16384
#define HELD_US         1000   /* pace while a socket takes no more of what has arrived */
#define IDLE_US         100000 /* longest wait: a signal just before it is seen only after it */

/* One accepted connection: WAITING for the model's connect time, then OPEN.
 *   client socket ──▶ link (up) ──▶ held[UP] ──▶ server socket, and the same down. */
enum pass_state { PASS_FREE, PASS_WAITING, PASS_OPEN };

typedef struct held {
    uint8_t bytes[PIECE_BYTES];
    size_t first, count;
} held;

typedef struct pass {
    enum pass_state state;
    int64_t open_us; /* WAITING until then */
    sim_link *link;
    sys_tcp client_tcp, server_tcp;
    sys_stream client, server;
    held out[2];         /* bytes that left the link and that the socket has not taken yet */
    int closed[2];       /* no more bytes come from: [UP] the client, [DOWN] the server */
    uint64_t pending[2]; /* bytes in the link */
} pass;

struct link_proxy {
    sim_link_desc desc;
    uint64_t seed;
    int listen_fd;
    const char *connect;
    link_proxy_totals totals;
    pass pass[CONNECTIONS_MAX];
};

link_proxy *link_proxy_create(const sim_link_desc *desc, uint64_t seed, int listen_fd,
                              const char *connect)
{
    link_proxy *proxy = calloc(1, sizeof *proxy);
    /* made only so that a bad trace is told at the start */
    sim_link *trial = sim_link_create(desc, seed);
    sim_link_destroy(trial);
    if (!proxy || !trial) {
        free(proxy);
        return NULL;
    }
    proxy->desc = *desc;
    proxy->seed = seed;
    proxy->listen_fd = listen_fd;
    proxy->connect = connect;
    return proxy;
}

static void drop(link_proxy *proxy, pass *p)
{
    p->client.close(p->client.state);
    if (p->server.close) p->server.close(p->server.state);
    sim_link_destroy(p->link);
    memset(p, 0, sizeof *p);
    proxy->totals.open--;
}

void link_proxy_destroy(link_proxy *proxy)
{
    if (!proxy) return;
    for (int i = 0; i < CONNECTIONS_MAX; i++)
        if (proxy->pass[i].state != PASS_FREE) drop(proxy, &proxy->pass[i]);
    free(proxy);
}

static pass *free_pass(link_proxy *proxy)
{
    for (int i = 0; i < CONNECTIONS_MAX; i++)
        if (proxy->pass[i].state == PASS_FREE) return &proxy->pass[i];
    return NULL;
}

/* While all passes are taken, connections wait in the listening socket's own queue. */
static void accept_new(link_proxy *proxy, int64_t now_us)
{
    pass *p;
    while ((p = free_pass(proxy)) != NULL) {
        int fd = sys_tcp_accept(proxy->listen_fd);
        if (fd < 0) return;
        proxy->totals.accepted++;
        proxy->totals.open++;
        p->state = PASS_WAITING;
        p->open_us = now_us + (int64_t)proxy->desc.connect_ms * 1000;
        sys_tcp_adopt(&p->client_tcp, fd, &p->client);
        p->link = sim_link_create(&proxy->desc, proxy->seed + proxy->totals.accepted - 1);
        if (!p->link) drop(proxy, p);
    }
}

/* Moves bytes from a socket into the link. No more is received than the link takes: its full queue
 * holds the sender back, as TCP would. */
static int fill_link(pass *p, enum sim_direction way, int64_t now_us)
{
    uint8_t bytes[PIECE_BYTES];
    sys_stream *from = way == SIM_UP ? &p->client : &p->server;
    while (!p->closed[way]) {
        size_t room = sim_link_room(p->link, way, now_us);
        int got = room ? from->recv(from->state, bytes, room < sizeof bytes ? room : sizeof bytes)
                       : 0;
        if (got < 0) p->closed[way] = 1;
        if (got <= 0) return FF_OK;
        int sent = sim_link_send(p->link, way, bytes, (size_t)got, now_us);
        if (sent < 0) return sent;
        p->pending[way] += (uint64_t)sent;
    }
    return FF_OK;
}

/* Moves bytes from the link into a socket. */
static int drain_link(link_proxy *proxy, pass *p, enum sim_direction way, int64_t now_us)
{
    held *out = &p->out[way];
    sys_stream *to = way == SIM_UP ? &p->server : &p->client;
    for (;;) {
        if (!out->count) {
            int got = sim_link_recv(p->link, way, out->bytes, sizeof out->bytes, now_us);
            if (got <= 0) return got;
            out->first = 0;
            out->count = (size_t)got;
        }
        int sent = to->send(to->state, out->bytes + out->first, out->count);
        if (sent <= 0) return sent;
        out->first += (size_t)sent;
        out->count -= (size_t)sent;
        p->pending[way] -= (uint64_t)sent;
        proxy->totals.bytes[way] += (uint64_t)sent;
    }
}

/* 1 when the connection has ended: a side is closed, and all its bytes have been delivered. */
static int finished(const pass *p)
{
    return (p->closed[SIM_UP] && !p->pending[SIM_UP]) ||
           (p->closed[SIM_DOWN] && !p->pending[SIM_DOWN]);
}

static void step_pass(link_proxy *proxy, pass *p, int64_t now_us)
{
    if (p->state == PASS_WAITING) {
        if (now_us < p->open_us) return;
        if (sys_tcp_client(&p->server_tcp, proxy->connect, &p->server) != FF_OK) {
            drop(proxy, p);
            return;
        }
        p->state = PASS_OPEN;
    }
    int rc = FF_OK;
    for (int way = 0; way < 2 && rc >= 0; way++) rc = fill_link(p, way, now_us);
    for (int way = 0; way < 2 && rc >= 0; way++) rc = drain_link(proxy, p, way, now_us);
    if (rc < 0 && !p->closed[SIM_UP] && !p->closed[SIM_DOWN]) proxy->totals.cut++;
    if (rc < 0 || finished(p)) drop(proxy, p);
}

void link_proxy_step(link_proxy *proxy, int64_t now_us)
{
    accept_new(proxy, now_us);
    for (int i = 0; i < CONNECTIONS_MAX; i++)
        if (proxy->pass[i].state != PASS_FREE) step_pass(proxy, &proxy->pass[i], now_us);
}

/* Lists the sockets that `p` waits for (two at most) and returns when its link or its state has
 * something new. */
static int64_t wait_for(pass *p, int64_t now_us, sys_ready *list, unsigned *count)
{
    if (p->state == PASS_WAITING) return p->open_us;
    sys_ready ready[2] = {
        [SIM_UP] = { .fd = p->client_tcp.fd }, [SIM_DOWN] = { .fd = p->server_tcp.fd }
    };
    for (int way = 0; way < 2; way++) {
        if (!p->closed[way] && sim_link_room(p->link, (enum sim_direction)way, now_us))
            ready[way].events |= SYS_READY_RECV;
        if (p->out[!way].count) ready[way].events |= SYS_READY_SEND;
    }
    if (p->server_tcp.connecting) ready[SIM_DOWN].events = SYS_READY_SEND;
    for (int way = 0; way < 2; way++)
        if (ready[way].fd >= 0 && ready[way].events) list[(*count)++] = ready[way];
    int64_t next_us = sim_link_next_us(p->link);
    if ((p->out[SIM_UP].count || p->out[SIM_DOWN].count) && next_us < now_us + HELD_US)
        return now_us + HELD_US;
    return next_us;
}

void link_proxy_wait(link_proxy *proxy, int64_t now_us)
{
    sys_ready list[2 * CONNECTIONS_MAX + 1];
    unsigned count = 0;
    int64_t until_us = now_us + IDLE_US;
    for (int i = 0; i < CONNECTIONS_MAX; i++) {
        if (proxy->pass[i].state == PASS_FREE) continue;
        int64_t next_us = wait_for(&proxy->pass[i], now_us, list, &count);
        until_us = next_us < until_us ? next_us : until_us;
    }
    if (free_pass(proxy)) list[count++] = (sys_ready){ proxy->listen_fd, SYS_READY_RECV };
    sys_wait_ready(list, count, until_us - sys_time_us());
}

void link_proxy_get_totals(const link_proxy *proxy, link_proxy_totals *totals)
{
    *totals = proxy->totals;
}
