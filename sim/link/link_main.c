/* farfield-link: a real link's rate, delay, gaps and cuts between real TCP sockets, in real
 * time. */
#include "../../client/farfield.h"
#include "link_proxy.h"

#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: farfield-link --profile SPEC --listen ADDR:PORT --connect ADDR:PORT [options]\n"
    "\n"
    "Passes TCP connections on from --listen to --connect as if a slow link lay between. Every connection has a link of its own: they\n"
    "do not share one rate. Ends cleanly on SIGTERM or SIGINT.\n"
    "\n"
    "  --profile SPEC        " SIM_LINK_SPEC_HELP "\n"
    "  --listen ADDR:PORT    port 0 chooses one; the port is told on stderr\n"
    "  --connect ADDR:PORT\n"
    "  --down-trace FILE, --up-trace FILE  recorded link in Mahimahi's format in place of the rate; down: to the one who connects here\n"
    "  --seed N              default 1; connection n has seed N + n\n"
    "  --list                the profiles with their numbers and sources\n"
    "  --json                totals on stdout at the end\n";

enum option_id {
    OPT_PROFILE = 256,
    OPT_LISTEN,
    OPT_CONNECT,
    OPT_DOWN,
    OPT_UP,
    OPT_SEED,
    OPT_LIST,
    OPT_JSON,
    OPT_HELP,
    OPT_VERSION
};
static const struct option long_options[] = { { "profile", 1, NULL, OPT_PROFILE },
                                              { "listen", 1, NULL, OPT_LISTEN },
                                              { "connect", 1, NULL, OPT_CONNECT },
                                              { "down-trace", 1, NULL, OPT_DOWN },
                                              { "up-trace", 1, NULL, OPT_UP },
                                              { "seed", 1, NULL, OPT_SEED },
                                              { "list", 0, NULL, OPT_LIST },
                                              { "json", 0, NULL, OPT_JSON },
                                              { "help", 0, NULL, OPT_HELP },
                                              { "version", 0, NULL, OPT_VERSION },
                                              { NULL, 0, NULL, 0 } };

typedef struct link_options {
    const char *profile, *listen, *connect, *trace[2];
    uint64_t seed;
    int json;
} link_options;

static volatile sig_atomic_t stop;

static void on_signal(int number)
{
    (void)number;
    stop = 1;
}

static int fail(const char *what, const char *why)
{
    fprintf(stderr, "farfield-link: %s: %s\n", what, why);
    return -1;
}

static int list_profiles(void)
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
    return 1;
}

static int parse_seed(const char *text, uint64_t *seed)
{
    char *end;
    errno = 0;
    *seed = strtoull(text, &end, 10);
    return text[0] < '0' || text[0] > '9' || *end || errno ? fail("--seed", "not a whole number")
                                                           : 0;
}

/* 0: go on; 1: answered; -1: error. */
static int parse(link_options *options, int argc, char **argv)
{
    *options = (link_options){ .seed = 1 };
    for (int id; (id = getopt_long(argc, argv, "", long_options, NULL)) != -1;) {
        switch (id) {
            case OPT_PROFILE: options->profile = optarg; break;
            case OPT_LISTEN: options->listen = optarg; break;
            case OPT_CONNECT: options->connect = optarg; break;
            case OPT_DOWN: options->trace[SIM_DOWN] = optarg; break;
            case OPT_UP: options->trace[SIM_UP] = optarg; break;
            case OPT_JSON: options->json = 1; break;
            case OPT_LIST: return list_profiles();
            case OPT_HELP: fputs(help, stdout); return 1;
            case OPT_VERSION: puts("farfield-link " FARFIELD_VERSION); return 1;
            case OPT_SEED:
                if (parse_seed(optarg, &options->seed)) return -1;
                break;
            default: return -1;
        }
    }
    if (optind < argc) return fail(argv[optind], "unexpected argument");
    if (!options->profile || !options->listen || !options->connect)
        return fail("--profile, --listen and --connect", "all are needed (see --help)");
    return 0;
}

static int prepare(const link_options *options, sim_link_desc *desc, int *listen_fd)
{
    uint16_t port = 0;
    sys_tcp tcp;
    sys_stream probe;
    int rc = sim_link_parse(options->profile, desc);
    if (rc != FF_OK)
        return fail(options->profile, rc == FF_ERR_NOT_FOUND ? "no such profile (see --list)"
                                                             : "not NAME[,KEY=VALUE...]");
    for (int way = 0; way < 2; way++) desc->way[way].trace = options->trace[way];
    /* asks only whether the address can be one: the connection is not used */
    rc = sys_tcp_client(&tcp, options->connect, &probe);
    if (rc != FF_OK) return fail(options->connect, ff_error_text(rc));
    probe.close(probe.state);
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
    link_options options;
    sim_link_desc desc;
    link_proxy_totals totals;
    int listen_fd, rc = parse(&options, argc, argv);
    if (rc) return rc < 0 ? 2 : 0;
    if (prepare(&options, &desc, &listen_fd)) return 1;
    link_proxy *proxy = link_proxy_create(&desc, options.seed, listen_fd, options.connect);
    if (!proxy) {
        fail(options.profile, "out of memory, or a trace that cannot be read");
        return 1;
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
    return 0;
}
