#include "server_say.h"

#include "../protocol/shape/ff_shape.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>

/* ADDR as given, with the port that was bound. */
static void bound_address(const server *shared, char *out, size_t capacity)
{
    const char *listen = shared->options.listen, *colon = strrchr(listen, ':');
    snprintf(out, capacity, "%.*s:%u", (int)(colon - listen), listen, shared->port);
}

void server_say_listening(const server *shared)
{
    char address[256];
    ff_sheet samples = ff_shape_sheet_samples(&shared->packs.pack[0].header.info);
    bound_address(shared, address, sizeof address);
    if (shared->options.json)
        printf(
            "{\"event\":\"listening\",\"address\":\"%s\",\"port\":%u,\"workers\":%u,\"renderers\":%u,\"gl\":\"%s\"}\n",
            address, shared->port, shared->options.workers, shared->options.renderers,
            server_gl_name((enum server_gl)shared->options.gl));
    else if (!shared->options.quiet)
        printf("farfield-server: listening on %s, %" PRIu32 "x%" PRIu32
               " samples, %u workers, %u renderers (%s)\n",
               address, samples.x, samples.y, shared->options.workers, shared->options.renderers,
               server_gl_name((enum server_gl)shared->options.gl));
    fflush(stdout);
}

void server_say_child(const server *shared, int renderer, unsigned number, int pid)
{
    if (shared->options.json)
        printf("{\"event\":\"started\",\"process\":\"%s\",\"number\":%u,\"pid\":%d}\n",
               renderer ? "renderer" : "worker", number, pid);
    fflush(stdout);
}

static void cause(int status, char *out, size_t capacity)
{
    if (WIFSIGNALED(status) && WTERMSIG(status) == SIGBUS)
        snprintf(
            out, capacity,
            "could not read the pack any more (SIGBUS: the file was cut short, or its disk fails)");
    else if (WIFSIGNALED(status))
        snprintf(out, capacity, "was killed by signal %d", WTERMSIG(status));
    else
        snprintf(out, capacity, "exited with status %d", WEXITSTATUS(status));
}

void server_say_death(const server *shared, int renderer, unsigned number, int pid, int status)
{
    char why[128];
    const char *process = renderer ? "renderer" : "worker";
    cause(status, why, sizeof why);
    server_complain("%s %u (pid %d) %s", process, number, pid, why);
    if (shared->options.json)
        printf("{\"event\":\"died\",\"process\":\"%s\",\"number\":%u,\"pid\":%d,\"why\":\"%s\"}\n",
               process, number, pid, why);
    fflush(stdout);
}

static void add(server_counters *sum, const server_counters *one)
{
    sum->clients += one->clients;
    sum->bytes_in += one->bytes_in;
    sum->bytes_out += one->bytes_out;
    sum->nodes += one->nodes;
    sum->textures += one->textures;
    sum->panoramas += one->panoramas;
    sum->faces += one->faces;
    sum->failed += one->failed;
    sum->face_bytes += one->face_bytes;
    sum->face_us += one->face_us;
    sum->faces_empty += one->faces_empty;
    sum->far_sets += one->far_sets;
    sum->sectors += one->sectors;
    sum->sector_bytes += one->sector_bytes;
    sum->sector_us += one->sector_us;
    sum->sectors_empty += one->sectors_empty;
}

/* Of so many, but for those that do not count. */
static uint64_t a_piece(uint64_t sum, uint64_t count, uint64_t without)
{
    return count > without ? sum / (count - without) : 0;
}

void server_say_stopped(const server *shared)
{
    server_counters workers = { 0 }, renderers = { 0 };
    for (unsigned i = 0; i < shared->options.workers; i++)
        add(&workers, &shared->worker_counters[i]);
    for (unsigned i = 0; i < shared->options.renderers; i++)
        add(&renderers, &shared->renderer_counters[i]);
    uint64_t us_a_face = a_piece(renderers.face_us, renderers.faces, 0),
             bytes_a_face = a_piece(renderers.face_bytes, renderers.faces, renderers.faces_empty),
             us_a_sector = a_piece(renderers.sector_us, renderers.sectors, 0),
             bytes_a_sector = a_piece(renderers.sector_bytes, renderers.sectors,
                                      renderers.sectors_empty);
    const char *format =
        shared->options.json
            ? "{\"event\":\"stopped\",\"clients\":%" PRIu64 ",\"bytes_in\":%" PRIu64
              ",\"bytes_out\":%" PRIu64 ",\"nodes\":%" PRIu64 ",\"textures\":%" PRIu64
              ",\"panoramas\":%" PRIu64 ",\"faces\":%" PRIu64 ",\"faces_empty\":%" PRIu64
              ",\"failed\":%" PRIu64 ",\"us_a_face\":%" PRIu64 ",\"bytes_a_face\":%" PRIu64
              ",\"far_sets\":%" PRIu64 ",\"sectors\":%" PRIu64 ",\"sectors_empty\":%" PRIu64
              ",\"us_a_sector\":%" PRIu64 ",\"bytes_a_sector\":%" PRIu64 "}\n"
            : "farfield-server: stopped: %" PRIu64 " clients, %" PRIu64 " bytes in, %" PRIu64
              " out, %" PRIu64 " nodes, %" PRIu64 " textures, %" PRIu64 " panoramas, %" PRIu64
              " faces (%" PRIu64 " empty), %" PRIu64 " failed, %" PRIu64 " us and %" PRIu64
              " bytes a face, %" PRIu64 " far sets, %" PRIu64 " sectors (%" PRIu64
              " empty), %" PRIu64 " us and %" PRIu64 " bytes a sector\n";
    if (shared->options.json || !shared->options.quiet)
        printf(format, workers.clients, workers.bytes_in, workers.bytes_out, workers.nodes,
               workers.textures, workers.panoramas, renderers.faces, renderers.faces_empty,
               workers.failed, us_a_face, bytes_a_face, workers.far_sets, renderers.sectors,
               renderers.sectors_empty, us_a_sector, bytes_a_sector);
    fflush(stdout);
}
