/* A link model between two real sockets: what comes in on one side leaves on the other when the
 * model says so. */
#ifndef LINK_PROXY_H
#define LINK_PROXY_H

#include "sim_link.h"

typedef struct link_proxy link_proxy;

typedef struct link_proxy_totals {
    uint32_t accepted, open, cut; /* connections; cut: lost by the model */
    uint64_t bytes[2];            /* delivered, by enum sim_direction */
} link_proxy_totals;

/* Every connection has its own link, all alike, the n-th one seeded with seed + n. `listen_fd`
 * (from sys_tcp_listen) and `connect` (ADDR:PORT) must outlive the proxy. NULL when out of memory
 * or when desc's trace cannot be read. */
link_proxy *link_proxy_create(const sim_link_desc *desc, uint64_t seed, int listen_fd,
                              const char *connect);
void link_proxy_destroy(link_proxy *proxy);
/* Accepts, receives and sends what is due at now_us; never blocks. */
void link_proxy_step(link_proxy *proxy, int64_t now_us);
/* Sleeps until there is something to do: a socket is ready, bytes arrive from a link, a signal
 * comes, or 0.1 s has passed. */
void link_proxy_wait(link_proxy *proxy, int64_t now_us);
void link_proxy_get_totals(const link_proxy *proxy, link_proxy_totals *totals);

#endif
