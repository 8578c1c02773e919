/* What every process of the server does: stop when told, die with its master, speak one line at a
 * time. */
#include "../server.h"

#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

static volatile sig_atomic_t stop_wanted;

static void on_stop(int signal_number)
{
    (void)signal_number;
    stop_wanted = 1;
}

void server_signals_begin(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_stop;
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGINT, &action, NULL);
    action.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &action, NULL);
}

int server_stopping(const server *shared)
{
    return stop_wanted || (getpid() != shared->master_pid && getppid() != shared->master_pid);
}

void server_child_begin(const server *shared)
{
    sigset_t none;
    server_signals_begin();
    if (getpid() != shared->master_pid) /* not --single */
        prctl(PR_SET_PDEATHSIG, SIGTERM);
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
}

void server_child_ready(const server *shared)
{
    char byte = 1;
    ssize_t written = write(shared->ready_fd, &byte, 1);
    (void)written; /* a master that does not hear it is gone, which server_stopping tells */
}

void server_complain(const char *format, ...)
{
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    fprintf(stderr, "farfield-server: %s\n", line);
}
