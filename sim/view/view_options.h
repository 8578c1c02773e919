/* What farfield-view was asked for: a row for each option, see sys_options.h. */
#ifndef VIEW_OPTIONS_H
#define VIEW_OPTIONS_H

#include "../link/sim_link_option.h"
#include "../options/sim_client_options.h"
#include "../options/sim_where.h"

typedef struct view_place {
    int given;
    int32_t x_wu, y_wu, above_wu;
} view_place;
extern const sys_option_type view_place_option;

/* clang-format off */
#define VIEW_OPTIONS(OPTION, HEADING, SHOW) \
    OPTION(sys_text, target, NULL, "ADDR:PORT | PACK", NULL, SYS_ANY, \
           "a server, or a pack on this machine") \
    OPTION(sys_texts, packs, "pack", "PACK", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "a pack on this machine: instead, or together with that and with others: parts of the " \
           "same ground, or grounds of one reference system, the finer shown where they lie over " \
           "each other") \
    HEADING("Display") \
    OPTION(sys_choice, backend, "backend", "KIND", NULL, SYS_WORDS(backend_words), \
           "graphics library, or integers alone; default: gles1, else gl") \
    SIM_SIZE_OPTION(OPTION, "of the window") \
    SIM_FOV_OPTION(OPTION) \
    OPTION(sys_flag, headless, "headless", NULL, NULL, SYS_ANY, "no window: draws off screen") \
    SIM_PLAIN_ARRAYS_OPTION(OPTION) \
    OPTION(sys_flag, no_hud, "no-hud", NULL, NULL, SYS_ANY, "begins without the text") \
    SHOW \
    HEADING("Terrain") \
    OPTION(sys_text, layer, "layer", "LAYER", NULL, SYS_ANY, \
           "the layer of images that is shown first; default: the first one") \
    SIM_CLIENT_OPTIONS(OPTION, "16M", "the client's one block") \
    SIM_PANORAMA_OPTION(OPTION, "far ground as panoramas") \
    SIM_FAR_OPTIONS(OPTION) \
    OPTION(sim_link_spec, link, "link", "SPEC", NULL, SYS_WORDS(no_link_words), \
           "link model between client and server; with PACK the server's logic runs inside this " \
           "program") \
    OPTION(sys_flag, map, "map", NULL, NULL, SYS_ANY, "begins with the map") \
    OPTION(view_place, place, "place", "X,Y[,H]", NULL, SYS_ANY, \
           "starts there; default: the middle, 500 m up") \
    SIM_SPOT_OPTIONS(OPTION, \
           "starts there instead: degrees north, degrees east, metres above ground (default: 500), of ground " \
           "that says where on Earth it lies", \
           "looks there, and flies there, rising or sinking to that height above ground, until a key is pressed") \
    OPTION(sys_real, yaw_degrees, "yaw", "DEGREES", "0", SYS_REAL(-360, 360, "degrees"), \
           "first direction, clockwise from the ground's north") \
    HEADING("Driving it from a file") \
    OPTION(sys_text, script, "script", "FILE", NULL, SYS_ANY, \
           "lines FRAME COMMAND; see sim/view/view_script.h") \
    OPTION(sys_text, keys, "keys", "TEXT", NULL, SYS_ANY, \
           "presses these keys one after the other") \
    OPTION(sys_whole, frames, "frames", "N", NULL, SYS_WHOLE(1, SIM_FRAMES_MAX, ""), \
           "stops after N frames") \
    OPTION(sys_text, screenshot, "screenshot", "FILE", NULL, SYS_ANY, \
           "writes the last picture as PNG") \
    OPTION(sys_text, events, "events", "FILE", NULL, SYS_ANY, \
           "writes each event handled (-: standard output)") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "prints the counters at the end")
/* clang-format on */

typedef struct view_options {
    VIEW_OPTIONS(SYS_FIELD, SYS_NO_FIELD, sys_bits show;)
    const char *pack[FF_SOURCES_MAX];
    /* what follows from them */
    ff_quality quality;
    ff_far_desc far;
    uint8_t far_given;
    ff_balance_desc balance;
    int32_t fov_brad16, yaw_brad16;
} view_options;

/* 0: go on; 1: --help or --version answered; -1: wrong usage, said in one line on stderr. */
int view_options_parse(view_options *options, int argc, char **argv);
/* "farfield-view: ..." on stderr; returns -1. */
int view_fail(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
