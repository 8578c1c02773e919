#include "server_options.h"
#include "../client/farfield.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: farfield-server --pack PACK [OPTION]...\n"
    "Serves terrain and panoramas from a pack to many clients.\n"
    "\n"
    "  --pack PACK               the terrain, made by farfield-bake\n"
    "  --listen ADDR:PORT        where to listen (default 127.0.0.1:7788; port 0: any, printed)\n"
    "  --workers N               processes that serve clients, 1..64 (default 2)\n"
    "  --renderers N             processes that draw panoramas, 0..64 (default 1; 0: none)\n"
    "  --gl osmesa|egl|egl-gles1 what they draw with (default osmesa)\n"
    "  --single                  everything in one process, for debugging\n"
    "  --max-clients N           clients of one worker, 1..4096 (default 256)\n"
    "  --idle S                  close a client silent for S seconds (default 600)\n"
    "  --panoramas-per-minute N  of one client (default 120)\n"
    "  --render-timeout S        give a face up after S seconds (default 10)\n"
    "  --json                    messages as JSON lines\n"
    "  --quiet                   nothing but errors\n"
    "  --help, --version\n"
    "\n"
    "SIGTERM and SIGINT stop it cleanly. A process that dies is replaced.\n";

enum {
    OPT_PACK = 256,
    OPT_LISTEN,
    OPT_WORKERS,
    OPT_RENDERERS,
    OPT_GL,
    OPT_SINGLE,
    OPT_MAX_CLIENTS,
    OPT_IDLE,
    OPT_PANORAMAS,
    OPT_RENDER_TIMEOUT,
    OPT_JSON,
    OPT_QUIET,
    OPT_HELP,
    OPT_VERSION
};

static const struct option long_options[] = {
    { "pack", required_argument, 0, OPT_PACK },
    { "listen", required_argument, 0, OPT_LISTEN },
    { "workers", required_argument, 0, OPT_WORKERS },
    { "renderers", required_argument, 0, OPT_RENDERERS },
    { "gl", required_argument, 0, OPT_GL },
    { "single", no_argument, 0, OPT_SINGLE },
    { "max-clients", required_argument, 0, OPT_MAX_CLIENTS },
    { "idle", required_argument, 0, OPT_IDLE },
    { "panoramas-per-minute", required_argument, 0, OPT_PANORAMAS },
    { "render-timeout", required_argument, 0, OPT_RENDER_TIMEOUT },
    { "json", no_argument, 0, OPT_JSON },
    { "quiet", no_argument, 0, OPT_QUIET },
    { "help", no_argument, 0, OPT_HELP },
    { "version", no_argument, 0, OPT_VERSION },
    { 0, 0, 0, 0 },
};

static int take_number(const char *name, const char *text, unsigned least, unsigned most,
                       unsigned *value)
{
    char *end;
    errno = 0;
    unsigned long number = strtoul(text, &end, 10);
    if (errno || end == text || *end || text[0] == '-' || number < least || number > most) {
        fprintf(stderr, "farfield-server: --%s must be %u..%u, not \"%s\"\n", name, least, most,
                text);
        return -1;
    }
    *value = (unsigned)number;
    return 0;
}

static int take_gl(const char *text, enum server_gl *gl)
{
    static const char *const names[] = {
        [SERVER_GL_OSMESA] = "osmesa", [SERVER_GL_EGL] = "egl", [SERVER_GL_EGL_GLES1] = "egl-gles1"
    };
    for (unsigned i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(text, names[i]) == 0) {
            *gl = (enum server_gl)i;
            return 0;
        }
    fprintf(stderr, "farfield-server: --gl must be osmesa, egl or egl-gles1, not \"%s\"\n", text);
    return -1;
}

static int take_option(server_options *o, int option, const char *arg)
{
    switch (option) {
        case OPT_PACK: o->pack = arg; return 0;
        case OPT_LISTEN: o->listen = arg; return 0;
        case OPT_WORKERS: return take_number("workers", arg, 1, SERVER_WORKERS_MAX, &o->workers);
        case OPT_RENDERERS:
            return take_number("renderers", arg, 0, SERVER_RENDERERS_MAX, &o->renderers);
        case OPT_GL: return take_gl(arg, &o->gl);
        case OPT_SINGLE: o->single = 1; return 0;
        case OPT_MAX_CLIENTS: return take_number("max-clients", arg, 1, 4096, &o->max_clients);
        case OPT_IDLE: return take_number("idle", arg, 1, 86400, &o->idle_s);
        case OPT_PANORAMAS:
            return take_number("panoramas-per-minute", arg, 1, 60000, &o->panoramas_per_minute);
        case OPT_RENDER_TIMEOUT:
            return take_number("render-timeout", arg, 1, 600, &o->render_timeout_s);
        case OPT_JSON: o->json = 1; return 0;
        case OPT_QUIET: o->quiet = 1; return 0;
        case OPT_HELP: fputs(usage, stdout); return 1;
        case OPT_VERSION: puts("farfield-server " FARFIELD_VERSION); return 1;
        default: return -1;
    }
}

int server_options_parse(server_options *options, int argc, char **argv)
{
    *options = (server_options){ .listen = "127.0.0.1:7788",
                                 .workers = 2,
                                 .renderers = 1,
                                 .max_clients = 256,
                                 .idle_s = 600,
                                 .panoramas_per_minute = 120,
                                 .render_timeout_s = 10 };
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, ":", long_options, NULL)) != -1;) {
        int rc = take_option(options, option, optarg);
        if (option == ':' || option == '?')
            fprintf(stderr, "farfield-server: %s \"%s\"; see --help\n",
                    option == ':' ? "a value is missing after" : "what is", argv[optind - 1]);
        if (rc) return rc;
    }
    if (optind < argc) {
        fprintf(stderr, "farfield-server: what is \"%s\"; see --help\n", argv[optind]);
        return -1;
    }
    if (!options->pack) {
        fputs("farfield-server: --pack PACK is missing; see --help\n", stderr);
        return -1;
    }
    return 0;
}
