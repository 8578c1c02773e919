/* farfield-link: a real link's rate, delay, gaps and cuts between real TCP sockets, in real
 * time. */
#include "../../client/farfield.h"
#include "link_proxy.h"
#include "sim_link_option.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

/* clang-format off */
#define LINK_OPTIONS(OPTION) \
    OPTION(sim_link_spec, profile, "profile", "SPEC", NULL, SYS_FLAGS(SYS_NEEDED), "the link") \
    OPTION(sys_listening, listen, "listen", "ADDR:PORT", NULL, SYS_FLAGS(SYS_NEEDED), \
           "where to wait for connections; port 0 chooses one, which is told on stderr") \
    OPTION(sys_address, connect, "connect", "ADDR:PORT", NULL, SYS_FLAGS(SYS_NEEDED), \
           "where they are passed on to") \
    SIM_LINK_OPTIONS(OPTION) \
    OPTION(sys_flag, list, "list", NULL, NULL, SYS_FLAGS(SYS_ALONE), \
           "the profiles with their numbers and sources") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "totals on stdout at the end")

typedef struct link_options {
    LINK_OPTIONS(SYS_FIELD)
} link_options;

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(link_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { LINK_OPTIONS(ROW) };
#undef ROW
/* clang-format on */

static const sys_program program = {
    .name = "farfield-link",
    .version = FARFIELD_VERSION,
    .usage = "--profile SPEC --listen ADDR:PORT --connect ADDR:PORT [OPTION]...",
    .about = "Passes TCP connections on from --listen to --connect as if a slow link lay between. "
             "Every connection has a link of its own, connection n with seed N + n: they do not "
             "share one rate. Ends cleanly on SIGTERM or SIGINT.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

static volatile sig_atomic_t stop;

static void on_signal(int number)
{
    (void)number;
    stop = 1;
}

static int fail(const char *what, const char *why)
{
    return sys_options_fail(&program, "%s: %s", what, why);
}

static void list_profiles(void)
{
    printf("%-8s %9s %9s %9s %9s %9s %9s  %s\n", "name", "down B/s", "up B/s", "delay ms",
           "jitter ms", "stall s", "every s", "source");
    for (unsigned i = 0; sim_link_profile_at(i); i++) {
        const sim_link_desc *d = sim_link_profile_at(i);
        printf("%-8s %9" PRIu32 " %9" PRIu32 " %9" PRIu32 " %9" PRIu32 " %9" PRIu32 " %9" PRIu32
               "  %s\n",
               d->name, d->way[SIM_DOWN].bytes_s, d->way[SIM_UP].bytes_s,
               d->way[SIM_DOWN].delay_us / 1000, d->way[SIM_DOWN].jitter_us / 1000,
               d->stall_ms_max / 1000, d->stall_every_ms / 1000, d->source);
    }
}

static int prepare(const link_options *options, sim_link_desc *desc, int *listen_fd)
{
    uint16_t port = 0;
    (void)sim_link_parse(options->profile, desc);
    desc->way[SIM_DOWN].trace = options->down_trace;
    desc->way[SIM_UP].trace = options->up_trace;
    *listen_fd = sys_tcp_listen(options->listen, 0, &port);
    if (*listen_fd < 0) return fail(options->listen, ff_error_text(*listen_fd));
    fprintf(stderr, "farfield-link: listening on %.*s:%u, %s to %s, seed %" PRIu64 "\n",
            (int)(strrchr(options->listen, ':') - options->listen), options->listen, port,
            options->profile, options->connect, options->seed);
    return 0;
}

static void print_totals(const link_options *options, const link_proxy_totals *totals)
{
    printf("{\n  \"profile\": \"%s\",\n  \"seed\": %" PRIu64 ",\n  \"connections\": %" PRIu32
           ",\n  \"cut\": %" PRIu32 ",\n  \"bytes_down\": %" PRIu64 ",\n  \"bytes_up\": %" PRIu64
           "\n}\n",
           options->profile, options->seed, totals->accepted, totals->cut, totals->bytes[SIM_DOWN],
           totals->bytes[SIM_UP]);
}

int main(int argc, char **argv)
{
    link_options options = { 0 };
    sim_link_desc desc;
    link_proxy_totals totals;
    int listen_fd, rc = sys_options_parse(&program, &options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    if (options.list) return list_profiles(), SYS_EXIT_DONE;
    if (prepare(&options, &desc, &listen_fd)) return SYS_EXIT_FAILED;
    link_proxy *proxy = link_proxy_create(&desc, options.seed, listen_fd, options.connect);
    if (!proxy) {
        fail(options.profile, "out of memory, or a trace that cannot be read");
        return SYS_EXIT_FAILED;
    }
    signal(SIGTERM, on_signal);
    signal(SIGINT, on_signal);
    while (!stop) {
        int64_t now_us = sys_time_us();
        link_proxy_step(proxy, now_us);
        link_proxy_wait(proxy, now_us);
    }
    link_proxy_get_totals(proxy, &totals);
    if (options.json) print_totals(&options, &totals);
    link_proxy_destroy(proxy);
    return SYS_EXIT_DONE;
}
