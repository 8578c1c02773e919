/* The emulator put together: a window (or a surface without one), a client, a pilot, and what the
 * keys have switched. */
#ifndef VIEW_APP_H
#define VIEW_APP_H

#include "../../server/packs/ff_packs.h"
#include "../options/sim_about.h"
#include "../options/sim_where.h"
#include "view_blit.h"
#include "view_fly.h"
#include "view_hud.h"
#include "view_link.h"
#include "view_map.h"
#include "view_options.h"
#include "view_script.h"

#include <stdio.h>

typedef struct view_app {
    const view_options *options;
    const struct c3d_backend *backend;
    const sys_surface_api *surface_api;
    sys_surface *surface;
    ff_packs packs; /* those on this machine, each for itself; the target first, if it is one */
    ff_source_desc more[FF_SOURCES_MAX - 1];
    sys_stream stream;
    view_link *link; /* NULL: the pack without a link */
    void *memory;
    ff_client *client;
    view_blit blit; /* with --backend soft: its picture into the window */
    view_fly fly;
    view_map map;
    uint8_t map_quality; /* 1: the ground has the map's */
    uint8_t map_begun;   /* --map has been done */
    sim_where where;
    view_hud hud;
    view_script script;
    FILE *events;
    /* switched by keys and events */
    unsigned show; /* enum ff_show */
    ff_panorama_desc panorama;
    ff_far_desc far;
    ff_quality quality;
    uint8_t show_hud, show_pools, show_help, battery_low, interrupted, tilted;
    uint8_t redraw, quit;
    uint8_t told;           /* bit i: that more[i] is not shown */
    uint8_t layer_known;    /* whether the ground has the layer asked for */
    const char *screenshot; /* file to be written after the next drawing; or NULL */
    unsigned screenshots;   /* taken by key */
    /* the loop */
    uint32_t frame, drawn, events_handled;
    int settling, still_frames;
    int64_t settle_until_us, hud_us;
} view_app;

/* Each 0, or -1 having said why. */
int view_app_open(view_app *app, const view_options *options);
int view_app_run(view_app *app);
int view_app_close(view_app *app);

/* view_input.c: one event from the window, the script or a function key. */
void view_handle(view_app *app, const sys_event *event);
/* Tells the client how fine its ground is to be, in flight or as a map. */
void view_set_quality(view_app *app);

#endif
