/* What all processes of one server share; made by the master before it forks. */
#ifndef SERVER_H
#define SERVER_H

#include "net/server_channel.h"
#include "../platform/sys.h"

/* Counters in shared memory: written by one process (or its successors), read by the master. */
typedef struct server_counters {
    uint64_t clients, bytes_in, bytes_out, nodes, textures, panoramas, faces, failed;
    uint64_t face_bytes, face_us, faces_empty;
} server_counters;

typedef struct server {
    server_options options;
    sys_mapping mapping;
    ff_pack pack;
    int listen_fd;
    uint16_t port;
    server_channels channels;
    server_counters *worker_counters, *renderer_counters;
    server_job *renderer_job; /* shared memory: what each renderer is at; serial 0: nothing */
    int ready_fd;             /* a child writes one byte when it is at work */
    int master_pid;
} server;

/* Exit statuses of children, beside 0. */
enum { SERVER_EXIT_CANNOT_START = 3 };

/* 1 once SIGTERM or SIGINT has come, or the master is gone. */
int server_stopping(const server *shared);
/* Handlers of SIGTERM and SIGINT; no SIGPIPE. */
void server_signals_begin(void);
/* Children: signals, death with the master. */
void server_child_begin(const server *shared);
void server_child_ready(const server *shared);
/* One line on stderr: "farfield-server: ...". */
void server_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Run until stopped; exit status. */
int server_worker_run(server *shared, unsigned number);
int server_renderer_run(server *shared, unsigned number);
int server_master_run(server *shared);

#endif
