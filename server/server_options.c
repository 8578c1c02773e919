#include "server_options.h"
#include "../client/farfield.h"

static const char *const gl_words[] = { [SERVER_GL_OSMESA] = "osmesa",
                                        [SERVER_GL_EGL] = "egl",
                                        [SERVER_GL_EGL_GLES1] = "egl-gles1",
                                        NULL };

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(server_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { SERVER_OPTIONS(ROW) };
#undef ROW

static const sys_program program = {
    .name = "farfield-server",
    .version = FARFIELD_VERSION,
    .usage = "--pack PACK [OPTION]...",
    .about = "Serves terrain and panoramas from a pack to many clients.",
    .more = "SIGTERM and SIGINT stop it cleanly. A process that dies is replaced.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

int server_options_parse(server_options *options, int argc, char **argv)
{
    *options = (server_options){ 0 };
    options->packs = (sys_texts){ options->pack, 0, FF_WELCOME_GROUNDS };
    return sys_options_parse(&program, options, argc, argv);
}

const char *server_gl_name(enum server_gl gl) { return gl_words[gl]; }
