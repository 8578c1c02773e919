/* One connection of a worker: its socket, its session and the face it waits for. */
#ifndef SERVER_CLIENT_H
#define SERVER_CLIENT_H

#include "../server.h"

enum server_client_state {
    SERVER_CLIENT_OPEN,
    SERVER_CLIENT_FLUSHING, /* the session is over: what is pending goes out, nothing comes in */
    /* all is sent: the peer's last bytes are thrown away, so that our GOODBYE is not reset away */
    SERVER_CLIENT_LINGERING,
    SERVER_CLIENT_CLOSED
};
enum server_job_state {
    SERVER_JOB_NONE,
    SERVER_JOB_WAITING, /* for room in the queue */
    SERVER_JOB_SENT
};

#define SERVER_CLIENT_IN_BYTES 4096

typedef struct server_client {
    enum server_client_state state;
    sys_tcp tcp;
    sys_stream stream;
    ff_session *session;
    int64_t deadline_us; /* of flushing and lingering */
    /* [in_first, in_end) received, not yet taken by the session */
    uint8_t in[SERVER_CLIENT_IN_BYTES];
    size_t in_first, in_end;
    enum server_job_state job_state;
    server_job job;
} server_client;

/* FF_OK, or FF_ERR_MEMORY with the socket closed. */
int server_client_open(server_client *client, int fd, const ff_session_desc *desc, int64_t now_us);
void server_client_close(server_client *client);

/* The events of poll() that the client waits for. */
short server_client_events(const server_client *client);
/* Receives, answers and sends what is possible now, and notices silence and lateness. Afterwards
 * the state is CLOSED when the connection is done with. */
void server_client_step(server_client *client, int readable, int64_t now_us);
/* Says GOODBYE with `reason` and closes in a while. */
void server_client_end(server_client *client, int reason, int64_t now_us);

#endif
