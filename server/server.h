/* What all processes of one server share; made by the master before it forks. */
#ifndef SERVER_H
#define SERVER_H

#include "net/server_channel.h"
#include "../platform/sys.h"

/* Counters in shared memory: written by one process (or its successors), read by the master. */
typedef struct server_counters {
    uint64_t clients, bytes_in, bytes_out, nodes, textures, panoramas, faces, failed;
    uint64_t face_bytes, face_us, faces_empty;
    uint64_t far_sets, sectors, sector_bytes, sector_us, sectors_empty;
} server_counters;

typedef struct server {
    server_options options;
    ff_packs packs;
    int listen_fd;
    uint16_t port;
    server_channels channels;
    server_counters *worker_counters, *renderer_counters;
    server_job *renderer_job; /* shared memory: the job each renderer is at; serial 0: none */
    int ready_fd;             /* a child writes one byte when it is at work */
    int master_pid;
} server;

/* Exit statuses of children, beside 0. */
enum { SERVER_EXIT_CANNOT_START = 3 };

/* 1 once SIGTERM or SIGINT has come, or the master is gone. */
int server_stopping(const server *shared);
/* Installs handlers of SIGTERM and SIGINT, and ignores SIGPIPE. */
void server_signals_begin(void);
/* Begins a child: its signals, and its death with the master. */
void server_child_begin(const server *shared);
void server_child_ready(const server *shared);
/* One line on stderr: "farfield-server: ...". */
void server_complain(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Each runs until it is stopped, and returns an exit status. */
int server_worker_run(server *shared, unsigned number);
int server_renderer_run(server *shared, unsigned number);
int server_master_run(server *shared);

#endif
