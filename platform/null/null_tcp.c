/* No network: for the blank port, and for builds of other ports that leave the network out. */
#include "../sys.h"

static int no_send(void *state, const uint8_t *bytes, size_t count)
{
    (void)state, (void)bytes, (void)count;
    return FF_ERR_CLOSED;
}

static int no_recv(void *state, uint8_t *bytes, size_t capacity)
{
    (void)state, (void)bytes, (void)capacity;
    return FF_ERR_CLOSED;
}

static void no_close(void *state) { (void)state; }
static int no_reconnect(void *state) { return (void)state, FF_ERR_UNSUPPORTED; }

int sys_tcp_client(sys_tcp *tcp, const char *address, sys_stream *stream)
{
    (void)address;
    sys_tcp_adopt(tcp, -1, stream);
    stream->reconnect = no_reconnect;
    return FF_ERR_UNSUPPORTED;
}

int sys_tcp_listen(const char *address, int reuse_port, uint16_t *port)
{
    (void)address, (void)reuse_port, (void)port;
    return FF_ERR_UNSUPPORTED;
}

int sys_tcp_accept(int listen_fd) { return (void)listen_fd, FF_ERR_UNSUPPORTED; }

void sys_tcp_adopt(sys_tcp *tcp, int fd, sys_stream *stream)
{
    tcp->fd = fd;
    tcp->connecting = 0;
    tcp->address[0] = 0;
    stream->state = tcp;
    stream->send = no_send;
    stream->recv = no_recv;
    stream->close = no_close;
    stream->reconnect = NULL;
}

void sys_wait_ready(const sys_ready *list, unsigned count, int64_t us)
{
    (void)list, (void)count;
    sys_sleep_us(us);
}
