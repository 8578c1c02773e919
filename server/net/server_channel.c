#include "server_channel.h"

#include <errno.h>
#include <poll.h>
#include <stddef.h>
#include <string.h>
#include <sys/socket.h>

static int pair_open(int *send_end, int *recv_end)
{
    int fd[2];
    if (socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, fd) != 0)
        return FF_ERR_SYSTEM;
    *send_end = fd[0];
    *recv_end = fd[1];
    return FF_OK;
}

int server_channels_open(server_channels *channels, unsigned workers)
{
    int rc = pair_open(&channels->job_send, &channels->job_recv);
    for (unsigned i = 0; rc == FF_OK && i < workers; i++)
        rc = pair_open(&channels->result_send[i], &channels->result_recv[i]);
    return rc;
}

static int datagram_send(int fd, const void *bytes, size_t count)
{
    return send(fd, bytes, count, MSG_NOSIGNAL) == (ssize_t)count ? FF_OK : FF_ERR_AGAIN;
}

/* Bytes received; 0: none. */
static size_t datagram_recv(int fd, void *bytes, size_t capacity)
{
    ssize_t count = recv(fd, bytes, capacity, 0);
    return count < 0 ? 0 : (size_t)count;
}

int server_job_send(const server_channels *channels, const server_job *job)
{
    return datagram_send(channels->job_send, job, sizeof *job);
}

int server_job_recv(const server_channels *channels, server_job *job)
{
    return datagram_recv(channels->job_recv, job, sizeof *job) == sizeof *job ? FF_OK
                                                                              : FF_ERR_AGAIN;
}

static int chunk_send(int fd, const server_chunk *chunk, int wait_ms)
{
    size_t bytes = offsetof(server_chunk, bytes) + chunk->count;
    if (datagram_send(fd, chunk, bytes) == FF_OK) return FF_OK;
    struct pollfd room = { .fd = fd, .events = POLLOUT };
    if (poll(&room, 1, wait_ms) <= 0) return FF_ERR_AGAIN;
    return datagram_send(fd, chunk, bytes);
}

int server_result_send(const server_channels *channels, const server_job *job, uint32_t renderer,
                       const uint8_t *message, int bytes_or_error, int wait_ms)
{
    server_chunk chunk = { .serial = job->serial, .renderer = renderer, .total = bytes_or_error };
    uint32_t total = bytes_or_error > 0 ? (uint32_t)bytes_or_error : 0;
    int fd = channels->result_send[job->worker];
    do {
        chunk.count = total - chunk.offset < SERVER_CHUNK_BYTES ? total - chunk.offset
                                                                : SERVER_CHUNK_BYTES;
        memcpy(chunk.bytes, message + chunk.offset, chunk.count);
        int rc = chunk_send(fd, &chunk, wait_ms);
        if (rc < 0) return rc;
        chunk.offset += chunk.count;
    } while (chunk.offset < total);
    return FF_OK;
}

int server_chunk_recv(const server_channels *channels, uint32_t worker, server_chunk *chunk)
{
    size_t count = datagram_recv(channels->result_recv[worker], chunk, sizeof *chunk);
    if (count == 0) return FF_ERR_AGAIN;
    if (count < offsetof(server_chunk, bytes) ||
        count - offsetof(server_chunk, bytes) != chunk->count)
        chunk->serial = chunk->count = 0; /* nobody's */
    return FF_OK;
}

int server_assemble(server_assembly *assembly, const server_chunk *chunk)
{
    if (chunk->total < 0) return 1;
    if (chunk->offset == 0) {
        assembly->serial = chunk->serial;
        assembly->count = 0;
    }
    if (chunk->serial != assembly->serial || chunk->offset != assembly->count ||
        chunk->total > (int32_t)SERVER_FACE_BYTES ||
        chunk->count > (uint32_t)chunk->total - assembly->count)
        return 0;
    memcpy(assembly->bytes + assembly->count, chunk->bytes, chunk->count);
    assembly->count += chunk->count;
    return assembly->count == (uint32_t)chunk->total;
}
