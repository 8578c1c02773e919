/* Command line of farfield-server. */
#ifndef SERVER_OPTIONS_H
#define SERVER_OPTIONS_H

#define SERVER_WORKERS_MAX   64
#define SERVER_RENDERERS_MAX 64

enum server_gl { SERVER_GL_OSMESA, SERVER_GL_EGL, SERVER_GL_EGL_GLES1 };

typedef struct server_options {
    const char *pack, *listen;
    unsigned workers, renderers;
    enum server_gl gl;
    unsigned max_clients; /* of one worker */
    unsigned idle_s, panoramas_per_minute;
    unsigned render_timeout_s; /* a face not back by then has failed */
    int single, json, quiet;
} server_options;

/* 0: go on; 1: --help or --version has been answered; -1: an error has been said on stderr. */
int server_options_parse(server_options *options, int argc, char **argv);

#endif
