#include "sys_output.h"

#include "sys_options.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char *watched_program;

/* The error of an earlier write is not known any more. */
static int tell(const char *program, const char *path, int error)
{
    fprintf(stderr, "%s: cannot write %s: %s\n", program, path,
            error ? strerror(error) : "an earlier part was not written, the disk may be full");
    return -1;
}

int sys_output_close(const char *program, FILE *file, const char *path)
{
    int bad = ferror(file);
    errno = 0;
    if (!fclose(file) && !bad) return 0;
    return tell(program, path, errno);
}

static void check_output(void)
{
    int bad = ferror(stdout);
    errno = 0;
    if (!fflush(stdout) && !bad) return;
    tell(watched_program, "to standard output", errno);
    _Exit(SYS_EXIT_FAILED);
}

void sys_output_watch(const char *program)
{
    if (!watched_program) atexit(check_output);
    watched_program = program;
}
