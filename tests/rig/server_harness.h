/* A real farfield-server started by a test, and plain blocking clients of it. */
#ifndef SERVER_HARNESS_H
#define SERVER_HARNESS_H

#include "../../protocol/message/ff_message.h"

#include <sys/types.h>

#define HARNESS_CHILDREN_MAX 16
#define HARNESS_TRIES        1500 /* waits are bounded: this many looks, HARNESS_LOOK_US apart */
#define HARNESS_LOOK_US      20000

typedef struct harness_server {
    pid_t pid;
    int port;
    int out_fd;
    char pack_path[640];
} harness_server;

/* Writes pack_fixture_usual() to a file and starts build's farfield-server on it with `options`
 * (separated by blanks) on any port. 1 when it listens. */
int harness_start(harness_server *server, const char *options);
/* SIGTERM; exit status of the master (-1: killed or stuck). Removes the pack. */
int harness_stop(harness_server *server);
/* Pids of the master's children, workers first as they were started; count. */
int harness_children(const harness_server *server, pid_t children[HARNESS_CHILDREN_MAX]);
/* 1 when none of these processes is alive. */
int harness_gone(pid_t pid);
/* Waits until `count` children live, none of them `not_this`. */
int harness_wait_children(const harness_server *server, int count, pid_t not_this);

typedef struct harness_client {
    int fd;
    size_t count;
    uint8_t bytes[FF_MESSAGE_BODY_MAX + 8];
    size_t used; /* bytes of the message handed out last */
} harness_client;

/* Connects, and with `greet` sends HELLO and waits for WELCOME; NULL when that fails. */
harness_client *harness_connect(const harness_server *server, int greet);
void harness_close(harness_client *client);
/* Sends bytes; 1 when all are sent. */
int harness_send(harness_client *client, const void *bytes, size_t count);
int harness_tell(harness_client *client, const ff_message *message);
/* The next message: 1; 0 when the connection has ended; -1 after HARNESS_TRIES looks without
 * one. */
int harness_hear(harness_client *client, ff_message *message);
/* The child that serves this client, or 0. */
pid_t harness_served_by(const harness_server *server, const harness_client *client);
/* Asks for a root and waits for it. 1 when it came. */
int harness_root_comes(harness_client *client, uint32_t tile);
/* Asks for a panorama of four faces and waits for them: 1, or 0 when the panorama failed; -1
 * otherwise. */
int harness_panorama_comes(harness_client *client, uint16_t id);

#endif
