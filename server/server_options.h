/* Command line of farfield-server: a row for each option, see sys_options.h. */
#ifndef SERVER_OPTIONS_H
#define SERVER_OPTIONS_H

#include "packs/ff_packs.h"
#include "../platform/options/sys_options.h"

#define SERVER_WORKERS_MAX   64
#define SERVER_RENDERERS_MAX 64

enum server_gl { SERVER_GL_OSMESA, SERVER_GL_EGL, SERVER_GL_EGL_GLES1 };

/* clang-format off */
#define SERVER_OPTIONS(OPTION) \
    OPTION(sys_texts, packs, "pack", "PACK", NULL, SYS_FLAGS(SYS_NEEDED | SYS_REPEATABLE), \
           "the terrain, made by farfield-bake; up to 7 of one reference system are shown together: " \
           "the finer where they lie over each other, else the one named first") \
    OPTION(sys_listening, listen, "listen", "ADDR:PORT", "127.0.0.1:7788", SYS_ANY, \
           "where to listen; port 0: any, printed") \
    OPTION(sys_whole, workers, "workers", "N", "2", SYS_WHOLE(1, SERVER_WORKERS_MAX, ""), \
           "processes that serve clients") \
    OPTION(sys_whole, renderers, "renderers", "N", "1", SYS_WHOLE(0, SERVER_RENDERERS_MAX, ""), \
           "processes that draw panoramas and far sets; 0: none, as clients are told") \
    OPTION(sys_word, gl, "gl", "KIND", "osmesa", SYS_WORDS(gl_words), "what they draw with") \
    OPTION(sys_flag, single, "single", NULL, NULL, SYS_ANY, \
           "everything in one process, for debugging") \
    OPTION(sys_whole, max_clients, "max-clients", "N", "256", SYS_WHOLE(1, 4096, ""), \
           "clients of one worker") \
    OPTION(sys_whole, idle_s, "idle", "S", "600", SYS_WHOLE(1, 86400, "s"), \
           "closes a client silent for so long") \
    OPTION(sys_whole, panoramas_per_minute, "panoramas-per-minute", "N", "120", \
           SYS_WHOLE(1, 60000, ""), "of one client") \
    OPTION(sys_whole, render_timeout_s, "render-timeout", "S", "10", SYS_WHOLE(1, 600, "s"), \
           "gives up a face not back by then") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "messages as JSON lines") \
    OPTION(sys_flag, quiet, "quiet", NULL, NULL, SYS_ANY, "nothing but errors")
/* clang-format on */

typedef struct server_options {
    SERVER_OPTIONS(SYS_FIELD)
    const char *pack[FF_WELCOME_GROUNDS];
} server_options;

/* 0: go on; 1: --help or --version has been answered; -1: wrong usage, said on stderr. */
int server_options_parse(server_options *options, int argc, char **argv);
const char *server_gl_name(enum server_gl gl);

#endif
