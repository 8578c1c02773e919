/* What farfield-view was asked for. */
#ifndef VIEW_OPTIONS_H
#define VIEW_OPTIONS_H

#include "../../client/farfield.h"

#include <stddef.h>

typedef struct view_options {
    const char *target;  /* ADDR:PORT or PACK */
    const char *backend; /* "gles1", "gl", "soft"; NULL: the first that works */
    int width, height;
    const char *link; /* spec for sim_link_parse; NULL: none */
    ff_quality quality;
    ff_balance_desc balance;
    int panorama; /* 1 on, 0 off, -1 on for servers */
    int32_t fov_brad16;
    size_t memory_bytes;
    int has_place; /* --at */
    int32_t at_x_wu, at_y_wu, above_wu;
    int32_t yaw_brad16;
    const char *script, *keys, *events, *screenshot;
    uint32_t frames; /* 0: until quit */
    unsigned show;   /* enum ff_show, to begin with */
    int headless, no_hud, plain_arrays, json;
} view_options;

/* 0: go on; 1: --help or --version answered; -1: wrong, said why. */
int view_options_parse(view_options *options, int argc, char **argv);
/* "farfield-view: ..." on stderr; returns -1. */
int view_fail(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
