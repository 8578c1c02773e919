/* TCP as sys_stream: non-blocking, no delay, never SIGPIPE. A client walks through all addresses of
 * its host, one after the other: sys_tcp.connecting is the number (from 1) of the address being
 * tried, 0 when connected or closed. */
#include "../address.h"
#include "../sys.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define LISTEN_BACKLOG 128

static int resolve(const char *address, int flags, struct addrinfo **list)
{
    char host[128], port[8];
    if (!sys_address_split(address, host, port)) return FF_ERR_ARGUMENT;
    struct addrinfo hints = { .ai_flags = flags | AI_NUMERICSERV, .ai_socktype = SOCK_STREAM };
    return getaddrinfo(*host ? host : NULL, port, &hints, list) ? FF_ERR_NOT_FOUND : FF_OK;
}

static void set_no_delay(int fd)
{
    int on = 1;
    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

static void drop(sys_tcp *tcp)
{
    if (tcp->fd >= 0) close(tcp->fd);
    tcp->fd = -1;
    tcp->connecting = 0;
}

/* Starts connecting to the host's addresses from number `attempt` (1 is the first) on. */
static int start_connecting(sys_tcp *tcp, int attempt)
{
    struct addrinfo *list;
    int rc = resolve(tcp->address, 0, &list);
    if (rc < 0) return rc;
    rc = FF_ERR_SYSTEM;
    int number = 1;
    for (struct addrinfo *at = list; at && rc == FF_ERR_SYSTEM; at = at->ai_next, number++) {
        if (number < attempt) continue;
        int fd = socket(at->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        if (fd < 0) continue;
        set_no_delay(fd);
        if (connect(fd, at->ai_addr, at->ai_addrlen) == 0 || errno == EINPROGRESS) {
            tcp->fd = fd;
            tcp->connecting = number;
            rc = FF_ERR_AGAIN;
        } else {
            close(fd);
        }
    }
    freeaddrinfo(list);
    return rc;
}

/* FF_OK connected, FF_ERR_AGAIN under way, else closed and failed. */
static int check_connecting(sys_tcp *tcp)
{
    if (tcp->fd < 0) return FF_ERR_CLOSED;
    if (!tcp->connecting) return FF_OK;
    struct pollfd ready = { .fd = tcp->fd, .events = POLLOUT };
    if (poll(&ready, 1, 0) <= 0) return FF_ERR_AGAIN;
    int error = 0;
    socklen_t size = sizeof error;
    if (getsockopt(tcp->fd, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
    if (error == 0) {
        tcp->connecting = 0;
        return FF_OK;
    }
    int next = tcp->connecting + 1;
    drop(tcp);
    return start_connecting(tcp, next);
}

static int would_block(int error)
{
    return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

static int tcp_send(void *state, const uint8_t *bytes, size_t count)
{
    sys_tcp *tcp = state;
    int rc = check_connecting(tcp);
    if (rc == FF_ERR_AGAIN) return 0;
    if (rc < 0) return FF_ERR_CLOSED;
    if (count == 0) return 0;
    if (count > INT32_MAX) count = INT32_MAX;
    ssize_t sent = send(tcp->fd, bytes, count, MSG_NOSIGNAL);
    if (sent >= 0) return (int)sent;
    if (would_block(errno)) return 0;
    drop(tcp);
    return FF_ERR_CLOSED;
}

static int tcp_recv(void *state, uint8_t *bytes, size_t capacity)
{
    sys_tcp *tcp = state;
    int rc = check_connecting(tcp);
    if (rc == FF_ERR_AGAIN) return 0;
    if (rc < 0) return FF_ERR_CLOSED;
    if (capacity == 0) return 0; /* else recv's 0 would look like the end of the stream */
    if (capacity > INT32_MAX) capacity = INT32_MAX;
    ssize_t got = recv(tcp->fd, bytes, capacity, 0);
    if (got > 0) return (int)got;
    if (got < 0 && would_block(errno)) return 0;
    drop(tcp);
    return FF_ERR_CLOSED;
}

static void tcp_close(void *state) { drop(state); }

static int tcp_reconnect(void *state)
{
    sys_tcp *tcp = state;
    if (tcp->fd < 0) {
        int rc = start_connecting(tcp, 1);
        if (rc != FF_ERR_AGAIN) return rc;
    }
    return check_connecting(tcp);
}

int sys_tcp_client(sys_tcp *tcp, const char *address, sys_stream *stream)
{
    char host[128], port[8];
    if (strlen(address) >= sizeof tcp->address || !sys_address_split(address, host, port) || !*host)
        return FF_ERR_ARGUMENT;
    memset(tcp, 0, sizeof *tcp);
    tcp->fd = -1;
    memcpy(tcp->address, address, strlen(address) + 1);
    *stream = (sys_stream){ tcp, tcp_send, tcp_recv, tcp_close, tcp_reconnect };
    /* a failure shows as FF_ERR_CLOSED at the first use: the same path as a lost connection */
    start_connecting(tcp, 1);
    return FF_OK;
}

void sys_tcp_adopt(sys_tcp *tcp, int fd, sys_stream *stream)
{
    memset(tcp, 0, sizeof *tcp);
    tcp->fd = fd;
    *stream = (sys_stream){ tcp, tcp_send, tcp_recv, tcp_close, NULL };
}

static int bound_port(int fd, uint16_t *port)
{
    struct sockaddr_storage bound;
    socklen_t size = sizeof bound;
    if (getsockname(fd, (struct sockaddr *)&bound, &size) != 0) return FF_ERR_SYSTEM;
    *port = ntohs(bound.ss_family == AF_INET6 ? ((struct sockaddr_in6 *)(void *)&bound)->sin6_port
                                              : ((struct sockaddr_in *)(void *)&bound)->sin_port);
    return FF_OK;
}

int sys_tcp_listen(const char *address, int reuse_port, uint16_t *port)
{
    struct addrinfo *list;
    int rc = resolve(address, AI_PASSIVE, &list);
    if (rc < 0) return rc;
    rc = FF_ERR_SYSTEM;
    for (struct addrinfo *at = list; at && rc < 0; at = at->ai_next) {
        int fd = socket(at->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        if (fd < 0) continue;
        int on = 1;
        setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
        if (reuse_port) setsockopt(fd, SOL_SOCKET, SO_REUSEPORT, &on, sizeof on);
        if (bind(fd, at->ai_addr, at->ai_addrlen) == 0 && listen(fd, LISTEN_BACKLOG) == 0 &&
            (!port || bound_port(fd, port) == FF_OK))
            rc = fd;
        else
            close(fd);
    }
    freeaddrinfo(list);
    return rc;
}

int sys_tcp_accept(int listen_fd)
{
    int fd = accept4(listen_fd, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd >= 0) {
        set_no_delay(fd);
        return fd;
    }
    return would_block(errno) || errno == ECONNABORTED ? FF_ERR_AGAIN : FF_ERR_SYSTEM;
}

void sys_wait_ready(const sys_ready *list, unsigned count, int64_t us)
{
    struct pollfd fds[SYS_READY_MAX];
    if (count > SYS_READY_MAX) count = SYS_READY_MAX;
    if (us < 0) us = 0;
    for (unsigned i = 0; i < count; i++) {
        fds[i] = (struct pollfd){ .fd = list[i].fd };
        if (list[i].events & SYS_READY_RECV) fds[i].events |= POLLIN;
        if (list[i].events & SYS_READY_SEND) fds[i].events |= POLLOUT;
    }
    struct timespec time = { .tv_sec = (time_t)(us / 1000000),
                             .tv_nsec = (long)(us % 1000000) * 1000 };
    (void)ppoll(fds, count, &time, NULL);
}
