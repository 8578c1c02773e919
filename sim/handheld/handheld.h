/* farfield-handheld: the client as it runs on the device: integers only, no GPU, one block of
 * memory. It uses protocol, client, common3d and platform/posix and nothing else, so that it
 * cross-builds (make handheld). Ground comes from a pack, a server, or a tape that farfield-fly
 * recorded: the same flight, call by call. */
#ifndef HANDHELD_H
#define HANDHELD_H

#include "../options/sim_about.h"
#include "../options/sim_client_options.h"
#include "../options/sim_where.h"
#include "../tape/sim_tape.h"

#define HANDHELD_FRAME_US 33333

/* clang-format off */
#define HANDHELD_OPTIONS(OPTION) \
    OPTION(sys_text, pack_path, "pack", "PACK", NULL, SYS_ANY, "a pack on this device") \
    OPTION(sys_address, server, "server", "ADDR:PORT", NULL, SYS_ANY, \
           "a farfield-server, in real time") \
    OPTION(sys_text, tape_path, "tape", "FILE", NULL, SYS_ANY, \
           "a flight recorded by farfield-fly --tape: fails unless everything goes as recorded") \
    OPTION(sys_whole, frames, "frames", "N", "300", SYS_WHOLE(1, SIM_FRAMES_MAX, ""), \
           "30 a second (a tape has its own)") \
    SIM_SIZE_OPTION(OPTION, "of the picture (a tape has its own)") \
    SIM_CLIENT_OPTIONS(OPTION, NULL, "the client's one block; default 4M, or what the tape says") \
    SIM_PANORAMA_OPTION(OPTION, \
           "far ground as panoramas, with --server; a tape has its own") \
    SIM_FAR_OPTIONS(OPTION) \
    OPTION(sys_whole, speed_kmh, "speed", "KMH", "150", SYS_WHOLE(0, SIM_SPEED_KMH_MAX, "km/h"), \
           "how fast") \
    OPTION(sys_whole, height_m, "height", "M", "100", SYS_WHOLE(1, SIM_HEIGHT_M_MAX, "m"), \
           "above the ground drawn") \
    OPTION(sys_whole, map_m, "map", "M", "0", SYS_WHOLE(0, 20000, "m"), \
           "with --pack: a map with contours of so many metres a pixel, in place of a flight") \
    SIM_SPOT_OPTIONS(OPTION, \
           "begins there instead of on the ground's diagonal: degrees north, degrees east, metres above ground " \
           "(default: --height), of ground that says where on Earth it lies; not with --tape", \
           "with --at: flies there, rising or sinking to that height above ground, and stays") \
    OPTION(sys_text, layer, "layer", "LAYER", NULL, SYS_ANY, \
           "the layer of images that is shown, as the flight on a tape had it; default: the first") \
    OPTION(sys_flag, no_textures, "no-textures", NULL, NULL, SYS_ANY, \
           "images of the ground are not asked for") \
    OPTION(sys_flag, no_pictures, "no-pictures", NULL, NULL, SYS_ANY, \
           "geometry only, nothing is drawn") \
    OPTION(sys_flag, hud, "hud", NULL, NULL, SYS_ANY, "figures over the picture") \
    OPTION(sys_flag, hash, "hash", NULL, NULL, SYS_ANY, \
           "a hash over the pixels of all frames, among the statistics") \
    OPTION(sys_text, fb_path, "fb", "FILE", NULL, SYS_ANY, "the last frame as PPM") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "statistics as JSON") \
    OPTION(sys_flag, plan, "plan", NULL, NULL, SYS_ANY, \
           "no flight: how blocks of 1, 2, 4 and 8 MB are shared out for this pack's ground, over " \
           "a link")
/* clang-format on */

typedef struct handheld_options {
    HANDHELD_OPTIONS(SYS_FIELD)
    /* what follows from them */
    ff_quality quality;
    ff_panorama_desc panorama;
    ff_far_desc far;
    ff_balance_desc balance;
} handheld_options;

/* 0: fly; 1: --help or --version was answered; -1: wrong usage, said in one line on
 * stderr. */
int handheld_options_parse(handheld_options *options, int argc, char **argv);

/* Sums over the frames flown (a tape's settling not counted), and what had to hold. */
typedef struct handheld_totals {
    uint32_t frames, drawn;
    uint64_t triangles, submitted; /* of the ground, and all that the back end was given */
    uint32_t triangles_max;
    uint64_t pictures_hash; /* FNV-1a over the pixels of every frame drawn, with --hash */
    int same_flight;        /* of a tape: 1 when both hashes at the end are those recorded */
} handheld_totals;

typedef struct handheld {
    const handheld_options *options;
    sys_mapping mapping; /* the pack or the tape */
    ff_pack pack;
    sys_tcp tcp;
    sys_stream stream;
    sim_tape_player tape;
    const sys_surface_api *surface_api;
    sys_surface *surface; /* NULL: no pictures */
    uint16_t width, height;
    void *memory; /* the block: the one allocation */
    size_t memory_bytes;
    ff_client *client;
    uint8_t map_told; /* 1: its quality is that of a map */
    handheld_totals totals;
    uint32_t about_frames; /* in which it was told whose the ground is */
    sim_where where;       /* asked for with --at, and for the HUD */
    uint8_t has_way;       /* what follows is known */
    int32_t at_wu[2];      /* where the flight begins */
    int64_t way_wu[2];     /* and its direction, as long as the way to --to */
} handheld;

/* 0, or -1 with one line on stderr; close in both cases. */
int handheld_open(handheld *device, const handheld_options *options);
void handheld_close(handheld *device);
/* The client's settings, but for its memory and what it flies over. */
ff_client_desc handheld_client_desc(const handheld *device);
/* Flies all frames. 0, or -1 with one line on stderr. */
int handheld_fly(handheld *device);
/* Prints the flight's statistics on stdout, as text or JSON, and writes the last frame to
 * options->fb_path. 0 or -1. */
int handheld_report(handheld *device);

/* Prints, instead of flying, how blocks of several sizes would be shared out. */
void handheld_plan(const handheld *device);

/* Camera of a frame of a flight of its own. 0, or -1 with one line on stderr: --at or --to is no
 * place on this ground. */
int handheld_way(handheld *device, uint32_t frame, c3d_camera *camera);

/* Draws figures over the picture, where on Earth the camera is, and at the start whose the ground
 * is; does nothing in a build without HUD. */
void handheld_hud(handheld *device, const c3d_camera *camera);
/* What of what the pack says of itself is shown there: FF_ABOUT_BIT of each; 0 without HUD. */
uint32_t handheld_hud_about(void);

/* Turns a flight's camera into that of a map (--map) of where it is, and has contours drawn; does
 * nothing in a build without maps. */
void handheld_map(handheld *device, int32_t ground_wu, c3d_camera *camera);

/* ---- marks: where tools/scripts/tcg_count.c cuts time into phases; each is a function of its own
 * that does next to nothing ---- */
void handheld_mark_outside(void);
void handheld_mark_work(void);   /* ff_client_work: link and decoding */
void handheld_mark_update(void); /* ff_client_update */
void handheld_mark_draw(void);   /* ff_client_draw */
void handheld_mark_frame(void);  /* a frame of the flight that was drawn ends */
void handheld_mark_start(void);  /* settled: what was counted so far is forgotten */

#endif
