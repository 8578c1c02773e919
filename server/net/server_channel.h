/* What workers and renderers say to each other, over datagram sockets that the master makes before
 * it forks: a process that is replaced finds its channels as they were. Nothing here blocks for
 * long, and every message may get lost with its process.
 *
 *   jobs: one queue, every worker writes, every renderer reads; the kernel bounds it and gives each
 *       job to one reader.
 *   results: one queue a worker, every renderer writes; a face comes in chunks.
 */
#ifndef SERVER_CHANNEL_H
#define SERVER_CHANNEL_H

#include "../server_options.h"
#include "../session/ff_session.h"

#define SERVER_FACE_BYTES  (FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX)
#define SERVER_CHUNK_BYTES 16384

typedef struct server_job {
    uint64_t serial; /* never used twice, not even by the worker's successor */
    uint32_t worker;
    /* of sys_time_us, which all processes share: nobody waits for it after that */
    int64_t deadline_us;
    ff_face_job face;
} server_job;

typedef struct server_chunk {
    uint64_t serial;
    uint32_t renderer;
    int32_t total; /* bytes of the face message, or a negative error */
    uint32_t offset, count;
    uint8_t bytes[SERVER_CHUNK_BYTES];
} server_chunk;

typedef struct server_channels {
    int job_send, job_recv;
    int result_send[SERVER_WORKERS_MAX], result_recv[SERVER_WORKERS_MAX];
} server_channels;

/* FF_OK or FF_ERR_SYSTEM. */
int server_channels_open(server_channels *channels, unsigned workers);

/* FF_OK, or FF_ERR_AGAIN: the queue is full (or empty). */
int server_job_send(const server_channels *channels, const server_job *job);
int server_job_recv(const server_channels *channels, server_job *job);

/* Sends a face in chunks, waiting at most wait_ms for room between them; FF_ERR_AGAIN: given up,
 * the receiver is stuck or gone. */
int server_result_send(const server_channels *channels, const server_job *job, uint32_t renderer,
                       const uint8_t *message, int bytes_or_error, int wait_ms);
int server_chunk_recv(const server_channels *channels, uint32_t worker, server_chunk *chunk);

/* Puts the chunks of one renderer together again. */
typedef struct server_assembly {
    uint64_t serial;
    uint32_t count;
    uint8_t bytes[SERVER_FACE_BYTES];
} server_assembly;
/* 1 when `chunk` completes a message (chunk->total bytes in assembly->bytes, or an error); 0: more
 * to come, or nonsense, dropped. */
int server_assemble(server_assembly *assembly, const server_chunk *chunk);

#endif
