/* farfield-server: opens what all processes share, then becomes the master. */
#include "server.h"
#include "server_say.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#define OTHER_FILES 512 /* descriptors for channels, standard streams and GL */

static int open_packs(server *shared)
{
    int rc = ff_packs_open(&shared->packs, shared->options.pack, shared->options.packs.count);
    if (rc < 0) server_complain("%s", shared->packs.why);
    return rc;
}

static int open_listening(server *shared)
{
    errno = 0;
    shared->listen_fd = sys_tcp_listen(shared->options.listen, 0, &shared->port);
    if (shared->listen_fd >= 0) return FF_OK;
    server_complain("cannot listen on %s: %s", shared->options.listen,
                    shared->listen_fd == FF_ERR_SYSTEM && errno ? strerror(errno)
                                                                : ff_error_text(shared->listen_fd));
    return shared->listen_fd;
}

typedef struct shared_memory {
    server_counters worker[SERVER_WORKERS_MAX], renderer[SERVER_RENDERERS_MAX];
    server_job renderer_job[SERVER_RENDERERS_MAX];
} shared_memory;

static int open_shared(server *shared)
{
    struct rlimit files;
    shared_memory *memory = mmap(NULL, sizeof *memory, PROT_READ | PROT_WRITE,
                                 MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED ||
        server_channels_open(&shared->channels, shared->options.workers) < 0) {
        server_complain("cannot start: %s", strerror(errno));
        return FF_ERR_SYSTEM;
    }
    shared->worker_counters = memory->worker;
    shared->renderer_counters = memory->renderer;
    shared->renderer_job = memory->renderer_job;
    /* Where the system allows fewer, accepting stops at its limit. */
    if (getrlimit(RLIMIT_NOFILE, &files) == 0 &&
        files.rlim_cur < shared->options.max_clients + OTHER_FILES) {
        rlim_t wanted = shared->options.max_clients + OTHER_FILES;
        files.rlim_cur = files.rlim_max < wanted ? files.rlim_max : wanted;
        setrlimit(RLIMIT_NOFILE, &files);
    }
    return FF_OK;
}

/* --single: no channels, no children; the same loop. */
static int run_single(server *shared)
{
    shared->options.workers = 1;
    shared->options.renderers = shared->options.renderers ? 1 : 0;
    shared->ready_fd = -1;
    server_say_listening(shared);
    int status = server_worker_run(shared, 0);
    if (status == 0) server_say_stopped(shared);
    return status == 0 ? SYS_EXIT_DONE : SYS_EXIT_FAILED;
}

int main(int argc, char **argv)
{
    static server shared;
    int rc = server_options_parse(&shared.options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    shared.master_pid = (int)getpid();
    if (open_packs(&shared) < 0 || open_listening(&shared) < 0 || open_shared(&shared) < 0)
        return SYS_EXIT_FAILED;
    return shared.options.single ? run_single(&shared) : server_master_run(&shared);
}
