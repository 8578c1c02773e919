/* A renderer process: takes jobs, draws, sends faces and sectors back. Its death costs the one it
 * was drawing. */
#include "server_renderer.h"

#include <poll.h>
#include <stdlib.h>

#define LOOK_AROUND_MS 500  /* how often it looks whether it should stop */
#define RESULT_WAIT_MS 2000 /* for a worker that does not take its face */

int server_renderer_open(const server *shared, server_renderer *renderer)
{
    enum server_gl gl = (enum server_gl)shared->options.gl;
    const sys_surface_api *surface_api = gl == SERVER_GL_OSMESA ? sys_surface_osmesa()
                                                                : sys_surface_egl();
    const struct c3d_backend *backend = gl == SERVER_GL_EGL_GLES1 ? c3d_backend_gles1()
                                                                  : c3d_backend_gl();
    const ff_pack *pack = &shared->packs.pack[0];
    *renderer = (server_renderer){ .faces = NULL };
    int rc = ff_panorama_renderer_open(pack, surface_api, backend, &renderer->faces);
    if (rc == FF_OK) rc = ff_far_renderer_open(pack, &renderer->far);
    if (rc < 0) server_renderer_close(renderer);
    return rc;
}

void server_renderer_close(server_renderer *renderer)
{
    ff_panorama_renderer_close(renderer->faces);
    ff_far_renderer_close(renderer->far);
    *renderer = (server_renderer){ .faces = NULL };
}

static int draw_face(server_renderer *renderer, const ff_face_job *job, server_counters *counters,
                     uint8_t *out, size_t capacity)
{
    ff_panorama_render_stats before, after;
    ff_panorama_renderer_get_stats(renderer->faces, &before);
    int rc = ff_panorama_render_face(renderer->faces, &job->request, job->face, job->last, out,
                                     capacity);
    ff_panorama_renderer_get_stats(renderer->faces, &after);
    counters->faces++;
    counters->face_bytes += after.bytes - before.bytes;
    counters->face_us += (uint64_t)(after.time_us - before.time_us);
    counters->faces_empty += after.empty_by_bounds + after.empty_drawn - before.empty_by_bounds -
                             before.empty_drawn;
    return rc;
}

static int draw_sector(server_renderer *renderer, const ff_face_job *job, server_counters *counters,
                       uint8_t *out, size_t capacity)
{
    ff_far_render_stats before, after;
    ff_far_renderer_get_stats(renderer->far, &before);
    int rc = ff_far_render_sector(renderer->far, &job->far, job->face, job->last, out, capacity);
    ff_far_renderer_get_stats(renderer->far, &after);
    counters->sectors++;
    counters->sector_bytes += after.bytes - before.bytes;
    counters->sector_us += (uint64_t)(after.time_us - before.time_us);
    counters->sectors_empty += after.sectors_empty - before.sectors_empty;
    return rc;
}

int server_renderer_draw(server_renderer *renderer, const ff_face_job *job,
                         server_counters *counters, uint8_t *out, size_t capacity)
{
    int rc = (job->kind == FF_KIND_FAR ? draw_sector : draw_face)(renderer, job, counters, out,
                                                                  capacity);
    counters->failed += rc < 0;
    return rc;
}

static void serve_jobs(server *shared, unsigned number, server_renderer *renderer, uint8_t *face)
{
    server_job job;
    while (!server_stopping(shared)) {
        struct pollfd jobs = { .fd = shared->channels.job_recv, .events = POLLIN };
        poll(&jobs, 1, LOOK_AROUND_MS);
        if (server_job_recv(&shared->channels, &job) != FF_OK) continue;
        if (job.worker >= shared->options.workers || sys_time_us() > job.deadline_us) continue;
        shared->renderer_job[number] = job;
        int rc = server_renderer_draw(renderer, &job.face, &shared->renderer_counters[number], face,
                                      SERVER_FACE_BYTES);
        server_result_send(&shared->channels, &job, number, face, rc, RESULT_WAIT_MS);
        /* cleared only now: when this process is killed before, the master answers for it */
        shared->renderer_job[number].serial = 0;
    }
}

int server_renderer_run(server *shared, unsigned number)
{
    server_renderer renderer;
    server_child_begin(shared);
    uint8_t *face = malloc(SERVER_FACE_BYTES);
    int rc = face ? server_renderer_open(shared, &renderer) : FF_ERR_MEMORY;
    if (rc < 0) {
        server_complain("renderer %u cannot draw: %s", number, ff_error_text(rc));
        free(face);
        return SERVER_EXIT_CANNOT_START;
    }
    server_child_ready(shared);
    serve_jobs(shared, number, &renderer, face);
    server_renderer_close(&renderer);
    free(face);
    return 0;
}
