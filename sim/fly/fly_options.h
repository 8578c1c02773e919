/* What farfield-fly is told on its command line: a row for each option, see sys_options.h. */
#ifndef FLY_OPTIONS_H
#define FLY_OPTIONS_H

#include "../../protocol/message/ff_message.h"
#include "../link/sim_link_option.h"
#include "../options/sim_client_options.h"
#include "../options/sim_where.h"
#include "../../server/packs/ff_packs.h"
#include "fly_recording.h"

#define FLY_EVENTS_MAX 64
#define FLY_SECONDS    SYS_REAL(0, 1e6, "s")
#define FLY_INTERVAL   SYS_REAL(0.01, 1e6, "s")
#define FLY_DISTANCE   SYS_REAL(1, 8e6, "m")
#define FLY_TEXELS     SYS_WHOLE(FF_PANORAMA_FACE_MIN, FF_FACE_SIZE_MAX, "texels")

enum fly_backend { FLY_GLES1, FLY_GL, FLY_SOFT, FLY_SOFT_565, FLY_NONE };
enum fly_path_kind { FLY_DIAGONAL, FLY_CIRCLE, FLY_HOVER, FLY_TURN, FLY_RECORDED, FLY_STRAIGHT };
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
    FLY_BUDGET,
    FLY_TURN_BY,
    FLY_PITCH,
    FLY_FOV,
    FLY_LAYER
};

typedef struct fly_event {
    double at_s;
    enum fly_event_kind kind;
    sim_link_desc link; /* of FLY_LINK */
    uint32_t budget;    /* of FLY_BUDGET */
    /* of FLY_TELEPORT: share of the terrain's size from its south-west corner, 0..1 */
    double place[2];
    const char *layer; /* of FLY_LAYER */
    double degrees;    /* of FLY_TURN_BY, FLY_PITCH and FLY_FOV */
} fly_event;

typedef struct fly_events {
    fly_event event[FLY_EVENTS_MAX];
    unsigned count;
} fly_events;

extern const sys_option_type fly_events_option;

/* clang-format off */
#define FLY_OPTIONS(OPTION, HEADING, SHOW) \
    OPTION(sys_texts, packs, "pack", "PACK", NULL, SYS_FLAGS(SYS_NEEDED | SYS_REPEATABLE), \
           "the terrain, also with --server (the true ground the flight keeps above); more packs in " \
           "its reference system are shown with it, the finer where they lie over each other. The path and " \
           "the events' places are the first one's, in whose metres the CSV is") \
    OPTION(sys_texts, locals, "local", "PACK", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "a pack on the device: parts cut from that of the server, which is asked for the rest, or " \
           "other ground") \
    OPTION(sys_text, csv_path, "csv", "FILE", NULL, SYS_ANY, "one row per --sample seconds") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, \
           "a summary on stdout: means and totals after settling") \
    HEADING("The flight") \
    OPTION(sys_text, path_text, "path", "KIND|FILE", "diagonal", SYS_ANY, \
           "diagonal: along the terrain's diagonal towards its north-east corner, turning back " \
           "in a half circle before the border; circle; hover: in one place, turning 6 degrees " \
           "a second; turn: along the diagonal for 20 s, round on the spot within 2 s, back, " \
           "and so on; FILE: a recorded flight, CSV whose first line names columns t_s, x_m, " \
           "y_m (or lat_deg, lon_deg), z_m (above the terrain's zero) or h_m (above ground), heading_deg " \
           "(heading_true_deg) and pitch_deg (may be missing). Its times count from the start, --settle included. It " \
           "may leave the terrain: what was above ground is then above its rim. The CSV of an " \
           "earlier flight is one") \
    OPTION(sys_real, start, "start", "F", "0.4", SYS_REAL(0, 1, ""), "where on the diagonal") \
    SIM_SPOT_OPTIONS(OPTION, \
           "begins there instead: degrees north, degrees east, metres above ground (default: --height), of a " \
           "pack that says where on Earth it lies", \
           "with --at: flies there in a straight line, rising or sinking to that height above ground, and stays") \
    OPTION(sys_real, speed_kmh, "speed", "KMH", "150", SYS_REAL(0, SIM_SPEED_KMH_MAX, "km/h"), \
           "how fast") \
    OPTION(sys_real, height_m, "height", "M", "100", SYS_REAL(0.01, SIM_HEIGHT_M_MAX, "m"), \
           "above the highest ground within 150 m along the path, smoothed") \
    OPTION(sys_real, seconds, "seconds", "S", NULL, FLY_SECONDS, \
           "in flight; default 300, or to the end of a recorded flight, or until --to is reached") \
    OPTION(sys_real, settle_s, "settle", "S", "15", FLY_SECONDS, "standing still before") \
    OPTION(fly_events, events, "event", "T:WHAT", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "at T seconds. link: the link is another one from now on; teleport: to these shares " \
           "of the terrain's width and height (the path goes on from there and stays at a " \
           "border that it would cross); budget: triangles a frame, with --balance; turn: at once by so " \
           "many degrees to the right, on top of the path's own turns; pitch: looks so many degrees up " \
           "from now on; fov: the field of view, a zoom; layer: as --layer") \
    OPTION(sys_text, events_path, "events", "FILE", NULL, SYS_ANY, \
           "such events, one on a line; what follows a # is a comment") \
    HEADING("The link") \
    OPTION(sim_link_spec, link_text, "link", "SPEC", "umts", SYS_ANY, "between server and client") \
    SIM_LINK_OPTIONS(OPTION) \
    OPTION(sys_address, server, "server", "ADDR:PORT", NULL, SYS_ANY, \
           "a real server, real sockets and real time; --link and the traces are not used") \
    HEADING("The client") \
    OPTION(sys_text, layer, "layer", "LAYER", NULL, SYS_ANY, \
           "of the pack's layers of images the one of this name is shown, off: none; default: the first") \
    SIM_CLIENT_OPTIONS(OPTION, "4M", "the client's one block") \
    OPTION(sys_switch, reserve, "reserve", "on|off", "on", SYS_ANY, \
           "coarse ground, fins and paint in every direction while the link is idle") \
    OPTION(sys_switch, views, "views", "on|off", "on", SYS_ANY, \
           "ground that a view lacks comes in one answer; off: level by level") \
    OPTION(sys_switch, entry, "entry", "on|off", "on", SYS_ANY, \
           "levels that are too coarse for --view do not come; off: they do") \
    SIM_PANORAMA_OPTION(OPTION, "far ground as panoramas drawn by the server") \
    OPTION(sys_real, back_plane_m, "back-plane", "M", NULL, FLY_DISTANCE, \
           "where the panorama takes over; default 7500") \
    OPTION(sys_whole, face_texels, "face", "N", NULL, FLY_TEXELS, \
           "a panorama's face each way; default 256; a larger one needs more --memory") \
    SIM_FAR_OPTIONS(OPTION) \
    OPTION(sys_real, view_m, "view", "M", NULL, FLY_DISTANCE, \
           "how far ground is drawn without panorama; default: to the horizon") \
    SIM_PLAIN_ARRAYS_OPTION(OPTION) \
    HEADING("The picture") \
    OPTION(sys_word, backend, "backend", "KIND", "gl", SYS_WORDS(fly_backend_words), \
           "gles1: by EGL; gl: by OSMesa; soft: integers, RGBA8888; soft565; none: geometry only") \
    SIM_SIZE_OPTION(OPTION, "of the picture") \
    SIM_FOV_OPTION(OPTION) \
    OPTION(sys_whole, fps, "fps", "N", "30", SYS_WHOLE(1, 1000, ""), "frames a second") \
    OPTION(sys_text, png_dir, "png", "DIR", NULL, SYS_ANY, \
           "pictures every --every seconds into DIR") \
    OPTION(sys_real, every_s, "every", "S", "10", FLY_INTERVAL, "time between pictures") \
    OPTION(sys_text, reference_dir, "reference", "DIR", NULL, SYS_ANY, \
           "with --png: the same moments into DIR as they should look, drawn from the pack to the " \
           "horizon, with all images, at 3 x 3 samples a pixel") \
    SHOW \
    HEADING("Checking") \
    OPTION(sys_switch, audit, "audit", "on|off", "off", SYS_ANY, \
           "err_px against the whole true ground") \
    OPTION(sys_whole, audit_step_px, "audit-step", "N", "8", SYS_WHOLE(1, 64, ""), \
           "every N-th pixel each way is looked at") \
    OPTION(sys_switch, diff, "diff", "on|off", "off", SYS_ANY, \
           "diff_mean, diff_p95 and ssim: each row's picture against the one that --reference " \
           "draws, by luminance; some seconds a row") \
    OPTION(sys_texts, truths, "truth", "PACK", NULL, SYS_FLAGS(SYS_REPEATABLE), \
           "the ground the audit judges by, where it is not that of --pack: the same samples, the " \
           "same spacing and place, such as the same raster baked without error; of several the first " \
           "for the first --pack, and so on") \
    OPTION(sys_text, ground_cache, "ground-cache", "FILE", NULL, SYS_ANY, \
           "keeps the decoded true ground there for further flights over it; of several the second in " \
           "FILE.2, and so on") \
    OPTION(sys_switch, check, "check", "on|off", NULL, SYS_ANY, \
           "every frame searched for cracks on integer vertices; default: as --audit") \
    OPTION(sys_word, hidden, "hidden", "WHAT", "left-out", SYS_WORDS(fly_hidden_words), \
           "ground in view behind nearer ground: left-out; drawn: all the same, the pictures must " \
           "not differ; or fetched, too, as if nothing hid it") \
    OPTION(sys_real, sample_s, "sample", "S", "1", FLY_INTERVAL, "time between rows") \
    OPTION(sys_text, tape_path, "tape", "FILE", NULL, SYS_ANY, \
           "records all that comes to the client, for farfield-handheld --tape (not with " \
           "--server, --balance, --events, nor with events of battery, interruption, panorama " \
           "and budget)")
/* clang-format on */

typedef struct fly_options {
    FLY_OPTIONS(SYS_FIELD, SYS_NO_FIELD, sys_bits show;)
    const char *pack[FF_WELCOME_GROUNDS], *local[FF_SOURCES_MAX - 1];
    const char *truth[FF_WELCOME_GROUNDS];
    /* what follows from them */
    const char *pack_path;  /* the first pack */
    const char *truth_path; /* what that is judged by, or NULL */
    sim_link_desc link;
    ff_quality quality;
    ff_panorama_desc panorama;
    ff_far_desc far;
    ff_balance_desc balance;
    enum fly_path_kind path;
    fly_recording recording; /* of FLY_RECORDED */
    int until_there;         /* --seconds follows from --to */
} fly_options;

/* 0: fly; 1: --help or --version was answered; -1: wrong usage, said in one line on stderr. */
int fly_options_parse(fly_options *options, int argc, char **argv);
/* Reads the files with events and a recorded flight. 0, or -1 with one line on stderr. */
int fly_options_load(fly_options *options);
void fly_options_free(fly_options *options);
/* All options in one line on stderr, the seed first: what it takes to fly the same again. */
void fly_options_print(const fly_options *options);

const char *fly_backend_name(enum fly_backend backend);

#endif
