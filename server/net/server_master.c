/* The master: starts workers and renderers, replaces those that die, stops all. It touches no
 * data. */
#include "../server.h"
#include "../server_say.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define CHILDREN_MAX     (SERVER_WORKERS_MAX + SERVER_RENDERERS_MAX)
#define YOUNG_US         5000000 /* a child that dies younger is replaced later and later */
#define BACKOFF_FIRST_US 100000
#define BACKOFF_LAST_US  5000000
#define STOP_PATIENCE_US 5000000

typedef struct child {
    pid_t pid; /* 0: dead, to be replaced at respawn_us */
    int renderer;
    unsigned number;
    int64_t born_us, respawn_us, backoff_us;
} child;

typedef struct master {
    server *shared;
    child child[CHILDREN_MAX];
    unsigned count, ready;
    int started; /* all have been ready once */
    int failed;
    int ready_fd;
    sigset_t wait_mask; /* signals come in only while waiting */
} master;

static void on_child(int signal_number) { (void)signal_number; /* ends the wait */ }

static int spawn(master *m, child *c)
{
    fflush(NULL);
    pid_t pid = fork();
    if (pid < 0) return FF_ERR_SYSTEM;
    if (pid == 0) {
        close(m->ready_fd);
        /* No exit handlers: what the GL libraries keep, the system takes back. */
        _exit(c->renderer ? server_renderer_run(m->shared, c->number)
                          : server_worker_run(m->shared, c->number));
    }
    c->pid = pid;
    c->born_us = sys_time_us();
    return FF_OK;
}

static void spawn_due(master *m)
{
    for (unsigned i = 0; i < m->count; i++) {
        child *c = &m->child[i];
        if (c->pid || sys_time_us() < c->respawn_us) continue;
        if (spawn(m, c) < 0) {
            server_complain("cannot start a process: %s", strerror(errno));
            c->respawn_us = sys_time_us() + BACKOFF_LAST_US;
            m->failed |= !m->started;
        } else {
            server_say_child(m->shared, c->renderer, c->number, (int)c->pid);
        }
    }
}

static void schedule(child *c, int64_t now_us)
{
    int young = now_us - c->born_us < YOUNG_US;
    int64_t longer_us = c->backoff_us ? 2 * c->backoff_us : BACKOFF_FIRST_US;
    c->backoff_us = !young ? 0 : longer_us > BACKOFF_LAST_US ? BACKOFF_LAST_US : longer_us;
    c->respawn_us = now_us + c->backoff_us;
    c->pid = 0;
}

/* Fails the job that a dead renderer was at, so that its worker need not wait for it. */
static void fail_job(master *m, unsigned renderer)
{
    static const uint8_t no_message[1];
    server_job *job = &m->shared->renderer_job[renderer];
    if (job->serial && job->worker < m->shared->options.workers)
        server_result_send(&m->shared->channels, job, renderer, no_message, FF_ERR_SYSTEM, 0);
    job->serial = 0;
}

static void bury(master *m, pid_t pid, int status)
{
    for (unsigned i = 0; i < m->count; i++) {
        child *c = &m->child[i];
        if (c->pid != pid) continue;
        server_say_death(m->shared, c->renderer, c->number, (int)pid, status);
        if (c->renderer) fail_job(m, c->number);
        schedule(c, sys_time_us());
        if (!m->started) m->failed = 1;
    }
}

static void reap(master *m)
{
    int status;
    for (pid_t pid; (pid = waitpid(-1, &status, WNOHANG)) > 0;) bury(m, pid, status);
}

/* Waits for a signal, news from a child, or the time to replace a child. */
static void wait_for_news(master *m)
{
    int64_t now_us = sys_time_us(), until_us = now_us + 60000000;
    for (unsigned i = 0; i < m->count; i++)
        if (!m->child[i].pid && m->child[i].respawn_us < until_us)
            until_us = m->child[i].respawn_us > now_us ? m->child[i].respawn_us : now_us;
    struct timespec timeout = { .tv_sec = (until_us - now_us) / 1000000,
                                .tv_nsec = (until_us - now_us) % 1000000 * 1000 };
    struct pollfd news = { .fd = m->ready_fd, .events = POLLIN };
    char bytes[64];
    if (ppoll(&news, 1, &timeout, &m->wait_mask) <= 0 || !news.revents) return;
    ssize_t got = read(m->ready_fd, bytes, sizeof bytes);
    m->ready += got > 0 ? (unsigned)got : 0;
    if (!m->started && m->ready >= m->count) {
        m->started = 1;
        server_say_listening(m->shared);
    }
}

static int any_alive(const master *m)
{
    for (unsigned i = 0; i < m->count; i++)
        if (m->child[i].pid) return 1;
    return 0;
}

static void signal_all(const master *m, int signal_number)
{
    for (unsigned i = 0; i < m->count; i++)
        if (m->child[i].pid) kill(m->child[i].pid, signal_number);
}

static void stop_children(master *m)
{
    int64_t patience_us = sys_time_us() + STOP_PATIENCE_US;
    int status, killed = 0;
    signal_all(m, SIGTERM);
    while (any_alive(m)) {
        pid_t pid = waitpid(-1, &status, WNOHANG);
        for (unsigned i = 0; pid > 0 && i < m->count; i++)
            if (m->child[i].pid == pid) m->child[i].pid = 0;
        if (pid < 0 && errno == ECHILD) return;
        if (!killed && sys_time_us() > patience_us) {
            signal_all(m, SIGKILL);
            killed = 1;
        }
        if (pid <= 0) sys_sleep_us(10000);
    }
}

static int open_master(master *m, server *shared)
{
    int fd[2];
    struct sigaction action;
    sigset_t held;
    *m = (master){ .shared = shared };
    for (unsigned i = 0; i < shared->options.workers; i++)
        m->child[m->count++] = (child){ .number = i };
    for (unsigned i = 0; i < shared->options.renderers; i++)
        m->child[m->count++] = (child){ .number = i, .renderer = 1 };
    if (pipe2(fd, O_CLOEXEC | O_NONBLOCK) != 0) return FF_ERR_SYSTEM;
    m->ready_fd = fd[0];
    shared->ready_fd = fd[1];
    memset(&action, 0, sizeof action);
    action.sa_handler = on_child;
    sigaction(SIGCHLD, &action, NULL);
    sigemptyset(&held);
    sigaddset(&held, SIGCHLD);
    sigaddset(&held, SIGTERM);
    sigaddset(&held, SIGINT);
    return sigprocmask(SIG_BLOCK, &held, &m->wait_mask) == 0 ? FF_OK : FF_ERR_SYSTEM;
}

int server_master_run(server *shared)
{
    static master m;
    server_signals_begin();
    if (open_master(&m, shared) < 0) {
        server_complain("cannot start: %s", strerror(errno));
        return 1;
    }
    while (!server_stopping(shared) && !m.failed) {
        spawn_due(&m);
        wait_for_news(&m);
        reap(&m);
    }
    stop_children(&m);
    if (m.failed) {
        server_complain("a process did not come up; stopped");
        return 1;
    }
    server_say_stopped(shared);
    return 0;
}
