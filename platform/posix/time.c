/* Monotonic clock, replaceable by a simulated one. */
#include "../sys.h"

#include <errno.h>
#include <time.h>

static int64_t (*replaced_now_us)(void *context);
static void *replaced_context;

void sys_clock_replace(int64_t (*now_us)(void *context), void *context)
{
    replaced_now_us = now_us;
    replaced_context = context;
}

int64_t sys_time_us(void)
{
    if (replaced_now_us) return replaced_now_us(replaced_context);
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

void sys_sleep_us(int64_t us)
{
    if (replaced_now_us || us <= 0) return;
    struct timespec rest = { .tv_sec = (time_t)(us / 1000000),
                             .tv_nsec = (long)(us % 1000000) * 1000 };
    while (nanosleep(&rest, &rest) != 0 && errno == EINTR) {
    }
}
