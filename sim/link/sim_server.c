#include "sim_server.h"

#include <stdlib.h>
#include <string.h>

int sim_server_init(sim_server *server, const ff_pack *pack, sim_link *link, const int64_t *now_us)
{
    memset(server, 0, sizeof *server);
    server->pack = pack;
    server->link = link;
    server->now_us = now_us;
    sim_stream_server(&server->end, link, now_us, &server->stream);
    server->face = malloc(FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX);
    return server->face ? FF_OK : FF_ERR_MEMORY;
}

void sim_server_free(sim_server *server)
{
    if (server->session) ff_session_destroy(server->session);
    if (server->renderer) ff_panorama_renderer_close(server->renderer);
    ff_far_renderer_close(server->far_renderer);
    free(server->face);
    memset(server, 0, sizeof *server);
}

/* A new connection gets a new session; what the old session had under way is gone. */
static int accept_connection(sim_server *server)
{
    const ff_session_desc desc = { .pack = server->pack };
    if (server->session && server->connection == sim_link_connections(server->link)) return FF_OK;
    if (server->session) ff_session_destroy(server->session);
    server->connection = sim_link_connections(server->link);
    server->closing = 0;
    server->input_count = 0;
    server->job_done_us = 0;
    server->session = ff_session_create(&desc);
    return server->session ? FF_OK : FF_ERR_MEMORY;
}

static void receive(sim_server *server)
{
    while (!server->closing) {
        int got = server->stream.recv(server->stream.state, server->input + server->input_count,
                                      sizeof server->input - server->input_count);
        if (got > 0) server->input_count += (size_t)got;
        if (!server->input_count) return;
        int taken = ff_session_receive(server->session, server->input, server->input_count,
                                       *server->now_us);
        if (taken < 0) server->closing = 1;
        if (taken <= 0) return;
        server->input_count -= (size_t)taken;
        memmove(server->input, server->input + taken, server->input_count);
    }
}

static int open_renderer(sim_server *server)
{
    if (!server->renderer && server->renderer_error == FF_OK) {
        const sys_surface_api *osmesa = sys_surface_osmesa();
        server->renderer_error = osmesa ? ff_panorama_renderer_open(server->pack, osmesa,
                                                                    c3d_backend_gl(),
                                                                    &server->renderer)
                                        : FF_ERR_UNSUPPORTED;
    }
    return server->renderer_error;
}

static int draw_face(sim_server *server)
{
    const ff_face_job *job = &server->job;
    int rc = open_renderer(server);
    if (rc != FF_OK) return rc;
    server->faces_rendered++;
    return ff_panorama_render_face(server->renderer, &job->request, job->face, job->last,
                                   server->face, FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX);
}

static int draw_sector(sim_server *server)
{
    const ff_face_job *job = &server->job;
    int rc = server->far_renderer ? FF_OK
                                  : ff_far_renderer_open(server->pack, &server->far_renderer);
    if (rc != FF_OK) return rc;
    return ff_far_render_sector(server->far_renderer, &job->far, job->face, job->last, server->face,
                                FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX);
}

static void render(sim_server *server)
{
    if (server->job_done_us && *server->now_us >= server->job_done_us) {
        ff_session_face_done(server->session, &server->job, server->face, server->face_bytes);
        server->job_done_us = 0;
    }
    if (server->job_done_us || !ff_session_next_face(server->session, &server->job)) return;
    server->face_bytes = server->job.kind == FF_KIND_FAR ? draw_sector(server) : draw_face(server);
    server->job_done_us = *server->now_us + SIM_SERVER_FACE_US;
}

static void transmit(sim_server *server)
{
    const uint8_t *bytes;
    size_t count;
    while ((count = ff_session_output(server->session, &bytes)) > 0) {
        int sent = server->stream.send(server->stream.state, bytes, count);
        if (sent <= 0) return;
        ff_session_sent(server->session, (size_t)sent);
    }
    if (server->closing) server->stream.close(server->stream.state);
}

int sim_server_step(sim_server *server)
{
    int rc = accept_connection(server);
    if (rc != FF_OK) return rc;
    receive(server);
    render(server);
    transmit(server);
    return FF_OK;
}
