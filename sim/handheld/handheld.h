/* farfield-handheld: the client as it runs on the device: integers only, no GPU, one block of
 * memory. It uses protocol, client, common3d and platform/posix and nothing else, so that it
 * cross-builds (make handheld). Ground comes from a pack, a server, or a tape that farfield-fly
 * recorded: the same flight, call by call. */
#ifndef HANDHELD_H
#define HANDHELD_H

#include "../tape/sim_tape.h"

typedef struct handheld_options {
    const char *pack_path, *server, *tape_path; /* exactly one */
    const char *fb_path;                        /* the last frame as PPM, or NULL */
    uint32_t frames;
    uint32_t memory_bytes; /* 0: the tape's, or 4 MiB */
    uint16_t width, height;
    int32_t speed_kmh, height_m;
    ff_quality quality;
    ff_panorama_desc panorama;
    ff_balance_desc balance;
    int json, hud, hash, no_pictures, no_textures, plan;
} handheld_options;

/* 0: fly; 1: --help or --version was answered; -1: an error, said in one line on stderr. */
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
    handheld_totals totals;
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

/* Draws figures over the picture; does nothing in a build without HUD. */
void handheld_hud(handheld *device);

/* ---- marks: where tools/scripts/tcg_count.c cuts time into phases; each is a function of its own
 * that does next to nothing ---- */
void handheld_mark_outside(void);
void handheld_mark_work(void);   /* ff_client_work: link and decoding */
void handheld_mark_update(void); /* ff_client_update */
void handheld_mark_draw(void);   /* ff_client_draw */
void handheld_mark_frame(void);  /* a frame of the flight that was drawn ends */
void handheld_mark_start(void);  /* settled: what was counted so far is forgotten */

#endif
