/* What farfield-fly is told on its command line. */
#ifndef FLY_OPTIONS_H
#define FLY_OPTIONS_H

#include "../../client/farfield.h"
#include "fly_recording.h"
#include "../link/sim_link.h"

#define FLY_EVENTS_MAX 64

enum fly_backend { FLY_GLES1, FLY_GL, FLY_SOFT, FLY_SOFT_565, FLY_NONE };
enum fly_path_kind { FLY_DIAGONAL, FLY_CIRCLE, FLY_HOVER, FLY_TURN, FLY_RECORDED };
enum fly_event_kind {
    FLY_LOW_BATTERY,
    FLY_BATTERY_OK,
    FLY_INTERRUPTION,
    FLY_RESUME,
    FLY_CUT,
    FLY_PANORAMA_ON,
    FLY_PANORAMA_OFF,
    FLY_LINK,
    FLY_TELEPORT,
    FLY_BUDGET
};

typedef struct fly_event {
    double at_s;
    enum fly_event_kind kind;
    sim_link_desc link; /* of FLY_LINK */
    uint32_t budget;    /* of FLY_BUDGET */
    /* of FLY_TELEPORT: share of the terrain's size from its south-west corner, 0..1 */
    double place[2];
} fly_event;

typedef struct fly_options {
    const char *pack_path;
    const char *server; /* ADDR:PORT: real sockets in real time; NULL: simulated */
    const char *link_text;
    sim_link_desc link;
    double speed_kmh, seconds, settle_s, height_m;
    double start; /* where on the diagonal, 0..1 */
    const char *quality_text;
    ff_quality quality;
    ff_panorama_desc panorama;
    const char *balance_text;
    ff_balance_desc balance;
    uint64_t seed;
    uint32_t fps;
    uint16_t width, height; /* of the picture, pixels */
    double fov_degrees;     /* across the width */
    enum fly_backend backend;
    enum fly_path_kind path;
    const char *path_text;
    fly_recording recording; /* of FLY_RECORDED */
    /* decoded heights of the pack, for the audit; NULL: decoded for this flight alone */
    const char *ground_cache;
    uint32_t audit_step_px;
    int audit, check, json, plain_arrays;
    unsigned show; /* enum ff_show */
    const char *csv_path, *png_dir;
    /* all that comes to the client, for farfield-handheld; NULL: not recorded */
    const char *tape_path;
    const char *reference_dir; /* the same moments as they should look; NULL: not drawn */
    double every_s, sample_s;  /* between pictures; between rows */
    size_t memory_bytes;
    fly_event event[FLY_EVENTS_MAX];
    unsigned event_count;
} fly_options;

/* 0: fly; 1: --help or --version was answered; -1: an error, said in one line on stderr. */
int fly_options_parse(fly_options *options, int argc, char **argv);
/* All options in one line on stderr, the seed first: what it takes to fly the same again. */
void fly_options_print(const fly_options *options);

void fly_options_free(fly_options *options);

const char *fly_backend_name(enum fly_backend backend);

#endif
