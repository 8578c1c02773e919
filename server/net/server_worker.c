/* A worker process: one loop over the listening socket, its clients and the faces that come back
 * from renderers. */
#include "server_client.h"
#include "server_renderer.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOOK_AROUND_MS  250     /* for lateness, silence, and whether to stop */
#define STOP_US         1500000 /* to say GOODBYE to everybody */
#define ACCEPT_PAUSE_US 100000  /* after the system had no room for another connection */
#define POLL_FIXED      3       /* listening socket, results, room for jobs; clients follow */

typedef struct worker {
    server *shared;
    unsigned number;
    server_counters *counters;
    server_client **client; /* [0, count) */
    unsigned count;
    struct pollfd *poll;
    uint64_t next_serial;
    unsigned first_job; /* whose turn it is */
    int64_t now_us, accept_again_us;
    server_assembly *assembly;    /* of each renderer */
    server_renderer own_renderer; /* --single: */
    int draws;
    uint8_t *own_face;
} worker;

/* ---- clients ---- */

static void count_session(worker *w, const server_client *client)
{
    ff_session_stats stats;
    ff_session_get_stats(client->session, &stats);
    w->counters->bytes_in += stats.bytes_in;
    w->counters->bytes_out += stats.bytes_out;
    w->counters->nodes += stats.answers[FF_DATA_HEIGHTS];
    w->counters->textures += stats.answers[FF_DATA_IMAGES];
    w->counters->panoramas += stats.panoramas;
    w->counters->faces += stats.answers[FF_DATA_FACES];
    w->counters->far_sets += stats.far_sets;
    w->counters->sectors += stats.answers[FF_DATA_FAR];
    w->counters->failed += stats.failed;
    if (stats.damaged)
        server_complain("%s%s is damaged: %u answers to a client were lost (farfield-info --verify "
                        "shows where)",
                        w->shared->options.pack[0],
                        w->shared->packs.count > 1 ? ", or another pack," : "", stats.damaged);
}

static void remove_closed(worker *w)
{
    for (unsigned i = 0; i < w->count;) {
        server_client *client = w->client[i];
        if (client->state != SERVER_CLIENT_CLOSED) {
            i++;
            continue;
        }
        count_session(w, client);
        server_client_close(client);
        free(client);
        w->client[i] = w->client[--w->count];
    }
}

/* Bits of FF_LACKS_. What a renderer's process lacks is not known here. */
static uint32_t lacks(const worker *w)
{
    if (w->draws) return w->own_renderer.faces ? 0 : FF_LACKS_PANORAMAS;
    return w->shared->options.renderers ? 0 : FF_LACKS_PANORAMAS | FF_LACKS_FAR;
}

static void accept_clients(worker *w)
{
    const server_options *o = &w->shared->options;
    ff_session_desc desc = { .pack = &w->shared->packs.pack[0],
                             .idle_ms_max = o->idle_s * 1000u,
                             .lacks = lacks(w),
                             .panoramas_per_minute = o->panoramas_per_minute };
    while (w->count < o->max_clients) {
        int fd = sys_tcp_accept(w->shared->listen_fd);
        if (fd == FF_ERR_SYSTEM) w->accept_again_us = w->now_us + ACCEPT_PAUSE_US;
        if (fd < 0) return;
        server_client *client = malloc(sizeof *client);
        if (!client) {
            close(fd);
            return;
        }
        if (server_client_open(client, fd, &desc, w->now_us) < 0) {
            free(client);
            return;
        }
        w->client[w->count++] = client;
        w->counters->clients++;
    }
}

/* ---- panoramas and far sets ---- */

static void face_back(server_client *client, const uint8_t *message, int bytes_or_error)
{
    client->job_state = SERVER_JOB_NONE;
    ff_session_face_done(client->session, &client->job.face, message, bytes_or_error);
}

static void take_results(worker *w)
{
    server_chunk chunk;
    while (server_chunk_recv(&w->shared->channels, w->number, &chunk) == FF_OK) {
        if (chunk.renderer >= w->shared->options.renderers) continue;
        server_assembly *assembly = &w->assembly[chunk.renderer];
        if (!server_assemble(assembly, &chunk)) continue;
        for (unsigned i = 0; i < w->count; i++)
            if (w->client[i]->job_state == SERVER_JOB_SENT &&
                w->client[i]->job.serial == chunk.serial) {
                face_back(w->client[i], assembly->bytes, chunk.total);
                break;
            }
    }
}

/* Gives the client's next face or sector to somebody who draws it; 0 when the queue of jobs is
 * full. */
static int place_job(worker *w, server_client *client)
{
    if (client->job_state == SERVER_JOB_NONE &&
        ff_session_next_face(client->session, &client->job.face)) {
        client->job.serial = w->next_serial++;
        client->job.worker = w->number;
        client->job.deadline_us = w->now_us +
                                  (int64_t)w->shared->options.render_timeout_s * 1000000;
        client->job_state = SERVER_JOB_WAITING;
    }
    if (client->job_state != SERVER_JOB_WAITING) return 1;
    if (w->draws) {
        face_back(client, w->own_face,
                  server_renderer_draw(&w->own_renderer, &client->job.face,
                                       w->shared->renderer_counters, w->own_face,
                                       SERVER_FACE_BYTES));
        return 1;
    }
    if (w->shared->options.renderers == 0) {
        face_back(client, NULL, FF_ERR_UNSUPPORTED);
        return 1;
    }
    if (server_job_send(&w->shared->channels, &client->job) != FF_OK) return 0;
    client->job_state = SERVER_JOB_SENT;
    return 1;
}

/* Takes clients in turn, so that one client's six faces do not go before another's first. Returns 0
 * when the queue of jobs is full. */
static int place_jobs(worker *w)
{
    for (unsigned i = 0; i < w->count; i++) {
        unsigned at = (w->first_job + i) % w->count;
        if (!place_job(w, w->client[at])) {
            w->first_job = at;
            return 0;
        }
    }
    return 1;
}

static void fail_late_jobs(worker *w)
{
    for (unsigned i = 0; i < w->count; i++)
        if (w->client[i]->job_state != SERVER_JOB_NONE && w->now_us > w->client[i]->job.deadline_us)
            face_back(w->client[i], NULL, FF_ERR_AGAIN);
}

/* ---- loop ---- */

static nfds_t watch(worker *w, int listening, int queue_full)
{
    int accepting = listening && w->count < w->shared->options.max_clients &&
                    w->now_us >= w->accept_again_us;
    w->poll[0] = (struct pollfd){ .fd = accepting ? w->shared->listen_fd : -1, .events = POLLIN };
    w->poll[1] = (struct pollfd){ .fd = w->shared->channels.result_recv[w->number],
                                  .events = POLLIN };
    w->poll[2] = (struct pollfd){ .fd = queue_full ? w->shared->channels.job_send : -1,
                                  .events = POLLOUT };
    for (unsigned i = 0; i < w->count; i++)
        w->poll[POLL_FIXED + i] = (struct pollfd){ .fd = w->client[i]->tcp.fd,
                                                   .events = server_client_events(w->client[i]) };
    return POLL_FIXED + w->count;
}

/* One round: waits, receives, draws, sends. */
static void round_trip(worker *w, int listening)
{
    int queue_full = !place_jobs(w);
    nfds_t watched = watch(w, listening, queue_full);
    if (poll(w->poll, watched, LOOK_AROUND_MS) < 0) memset(w->poll, 0, sizeof *w->poll * watched);
    w->now_us = sys_time_us();
    take_results(w);
    fail_late_jobs(w);
    for (unsigned i = 0; i < w->count; i++)
        server_client_step(w->client[i],
                           (w->poll[POLL_FIXED + i].revents & (POLLIN | POLLHUP | POLLERR)) != 0,
                           w->now_us);
    if (w->poll[0].revents) accept_clients(w);
    remove_closed(w);
}

static void run(worker *w)
{
    while (!server_stopping(w->shared)) round_trip(w, 1);
    for (unsigned i = 0; i < w->count; i++)
        server_client_end(w->client[i], FF_ERR_CLOSED, w->now_us);
    for (int64_t until_us = w->now_us + STOP_US; w->count > 0 && w->now_us < until_us;)
        round_trip(w, 0);
    for (unsigned i = 0; i < w->count; i++) w->client[i]->state = SERVER_CLIENT_CLOSED;
    remove_closed(w);
}

static int open_worker(worker *w, server *shared, unsigned number)
{
    const server_options *o = &shared->options;
    *w = (worker){ .shared = shared,
                   .number = number,
                   .counters = &shared->worker_counters[number],
                   .now_us = sys_time_us(),
                   .next_serial = (uint64_t)getpid() << 32 | 1u };
    w->client = calloc(o->max_clients, sizeof *w->client);
    w->poll = calloc(POLL_FIXED + o->max_clients, sizeof *w->poll);
    w->assembly = calloc(o->renderers ? o->renderers : 1, sizeof *w->assembly);
    if (!w->client || !w->poll || !w->assembly) return FF_ERR_MEMORY;
    if (!o->single || o->renderers == 0) return FF_OK;
    w->own_face = malloc(SERVER_FACE_BYTES);
    int rc = w->own_face ? server_renderer_open(shared, &w->own_renderer) : FF_ERR_MEMORY;
    w->draws = rc == FF_OK;
    return rc;
}

int server_worker_run(server *shared, unsigned number)
{
    worker w;
    server_child_begin(shared);
    int rc = open_worker(&w, shared, number);
    if (rc < 0)
        server_complain("worker %u cannot start: %s", number, ff_error_text(rc));
    else {
        server_child_ready(shared);
        run(&w);
    }
    server_renderer_close(&w.own_renderer);
    free(w.own_face);
    free(w.assembly);
    free(w.poll);
    free(w.client);
    return rc < 0 ? SERVER_EXIT_CANNOT_START : 0;
}
