#include "server_client.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>

#define FLUSH_US     5000000
#define LINGER_US    1000000
#define UNSENT_BYTES 16384 /* more would only wait in the system, where no CANCEL reaches it */
#define READS_MAX    16    /* in one step: others wait too */

int server_client_open(server_client *client, int fd, const ff_session_desc *desc, int64_t now_us)
{
    int unsent = UNSENT_BYTES;
    ff_session_desc mine = *desc;
    mine.now_us = now_us;
    memset(client, 0, sizeof *client);
    sys_tcp_adopt(&client->tcp, fd, &client->stream);
    client->session = ff_session_create(&mine);
    if (!client->session) {
        client->stream.close(client->stream.state);
        return FF_ERR_MEMORY;
    }
    setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
    return FF_OK;
}

void server_client_close(server_client *client)
{
    client->stream.close(client->stream.state);
    ff_session_destroy(client->session);
    client->session = NULL;
    client->state = SERVER_CLIENT_CLOSED;
}

short server_client_events(const server_client *client)
{
    const uint8_t *bytes;
    short events = 0;
    if (ff_session_output(client->session, &bytes) > 0) events |= POLLOUT;
    if (client->state == SERVER_CLIENT_LINGERING ||
        (client->state == SERVER_CLIENT_OPEN && client->in_first == client->in_end))
        events |= POLLIN;
    return events;
}

static void begin_flushing(server_client *client, int64_t now_us)
{
    client->state = SERVER_CLIENT_FLUSHING;
    client->deadline_us = now_us + FLUSH_US;
}

/* Offers the session what has come; 1 when it took some. */
static int offer(server_client *client, int64_t now_us)
{
    int taken = ff_session_receive(client->session, client->in + client->in_first,
                                   client->in_end - client->in_first, now_us);
    if (taken < 0) {
        begin_flushing(client, now_us);
        return 0;
    }
    client->in_first += (size_t)taken;
    if (client->in_first == client->in_end) client->in_first = client->in_end = 0;
    return taken > 0;
}

/* Sends until the socket or the session has had enough; 1 when some went out. */
static int send_pending(server_client *client)
{
    const uint8_t *bytes;
    int any = 0;
    for (size_t count; (count = ff_session_output(client->session, &bytes)) > 0;) {
        int sent = client->stream.send(client->stream.state, bytes, count);
        if (sent < 0) client->state = SERVER_CLIENT_CLOSED;
        if (sent <= 0) break;
        ff_session_sent(client->session, (size_t)sent);
        any = 1;
    }
    return any;
}

static void receive(server_client *client, int64_t now_us)
{
    for (int reads = 0;
         reads < READS_MAX && client->state == SERVER_CLIENT_OPEN && client->in_end == 0; reads++) {
        int got = client->stream.recv(client->stream.state, client->in, sizeof client->in);
        if (got < 0) client->state = SERVER_CLIENT_CLOSED;
        if (got <= 0) return;
        client->in_end = (size_t)got;
        offer(client, now_us);
    }
}

static void linger(server_client *client)
{
    for (int reads = 0; reads < READS_MAX; reads++) {
        int got = client->stream.recv(client->stream.state, client->in, sizeof client->in);
        if (got < 0) client->state = SERVER_CLIENT_CLOSED;
        if (got <= 0) return;
    }
}

static void finish(server_client *client, int64_t now_us)
{
    const uint8_t *bytes;
    if (client->state == SERVER_CLIENT_FLUSHING &&
        ff_session_output(client->session, &bytes) == 0) {
        shutdown(client->tcp.fd, SHUT_WR);
        client->state = SERVER_CLIENT_LINGERING;
        client->deadline_us = now_us + LINGER_US;
    }
    if (client->state != SERVER_CLIENT_OPEN && now_us > client->deadline_us)
        client->state = SERVER_CLIENT_CLOSED;
}

void server_client_step(server_client *client, int readable, int64_t now_us)
{
    if (client->state == SERVER_CLIENT_OPEN && readable) receive(client, now_us);
    if (client->state == SERVER_CLIENT_LINGERING && readable) linger(client);
    if (client->state == SERVER_CLIENT_OPEN && ff_session_idle(client->session, now_us))
        server_client_end(client, FF_ERR_CLOSED, now_us);
    int moving = 1;
    while (moving && client->state <= SERVER_CLIENT_FLUSHING) {
        moving = send_pending(client);
        if (client->state == SERVER_CLIENT_OPEN && client->in_first < client->in_end)
            moving |= offer(client, now_us);
    }
    if (client->state != SERVER_CLIENT_OPEN && client->state != SERVER_CLIENT_CLOSED)
        finish(client, now_us);
}

void server_client_end(server_client *client, int reason, int64_t now_us)
{
    if (client->state != SERVER_CLIENT_OPEN) return;
    ff_session_end(client->session, reason);
    begin_flushing(client, now_us);
}
