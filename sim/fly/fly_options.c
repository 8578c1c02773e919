#include "fly_options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: farfield-fly --pack PACK [options]\n"
    "\n"
    "Flies over a pack: server, link and client in one process over simulated time. The same options give the same bytes, the same\n"
    "CSV and the same pictures every time. With --server the same flight goes against a real server in real time.\n"
    "\n"
    "  --pack PACK           the terrain, also with --server (the true ground the flight keeps above)\n"
    "  --csv FILE            one row per --sample seconds\n"
    "  --json                a summary on stdout: means and totals after settling\n"
    "\n"
    " the flight\n"
    "  --path KIND           diagonal (default): along the terrain's diagonal towards its north-east corner, turning back in a half\n"
    "                        circle before the border; circle; hover: in one place, turning 6 degrees a second; turn: along\n"
    "                        the diagonal for 20 s, round on the spot within 2 s, back, and so on\n"
    "  --path FILE           a recorded flight: CSV whose first line names columns t_s, x_m, y_m, z_m (above the terrain's zero) or h_m\n"
    "                        (above ground), heading_deg and pitch_deg (may be missing); its times count from the start, --settle\n"
    "                        included, and --seconds ends with it. The CSV of an earlier flight is one\n"
    "  --start F             where on the diagonal, 0 to 1, default 0.4\n"
    "  --speed KMH           default 150\n"
    "  --height M            above the highest ground within 150 m along the path, smoothed; default 100\n"
    "  --seconds S           in flight, default 300\n"
    "  --settle S            standing still before, default 15\n"
    "  --seed N              default 1\n"
    "  --event T:WHAT        at T seconds: low-battery battery-ok interruption resume cut panorama-on panorama-off, link=SPEC (the link\n"
    "                        is another one from now on), teleport=X,Y (shares of the terrain's width and height, each 0 to 1; the\n"
    "                        path goes on from there and stays at a border that it would cross), budget=TRIANGLES (a frame, with\n"
    "                        --balance); may be repeated\n"
    "  --events FILE         such events, one on a line; what follows a # is a comment\n"
    "\n"
    " the link\n"
    "  --link SPEC           default umts. " SIM_LINK_SPEC_HELP "\n"
    "  --down-trace FILE, --up-trace FILE  recorded link in Mahimahi's format in place of the rate\n"
    "  --server ADDR:PORT    a real server, real sockets and real time; --link and the traces are not used\n"
    "\n"
    " the client\n"
    "  --quality Q           low (C 3, depth 4: default), high (C 9, depth 8), C:DEPTH, or px:E for E pixels of error\n"
    "  --panorama on|off     default on\n"
    "  --back-plane M        where the panorama takes over, default 7500\n"
    "  --face N              texels of a panorama's face each way, 64 to 1024, default 256; a larger one needs more --memory\n"
    "  --view M              how far ground is drawn without panorama, default 30000\n"
    "  --balance SPEC        the client's share of the work follows budgets, --quality and --panorama are the finest: TRIANGLES a frame\n"
    "                        (0: as many as it takes), or TRIANGLES,BYTES with the bytes that may come a second (at most 80 % of what the\n"
    "                        link carries). server or client: stays at that end. Default: off, all as set\n"
    "  --memory BYTES        of the client, with K or M; default 4M\n"
    "  --plain-arrays        no vertex buffers\n"
    "\n";

static const char help_picture[] = /* compilers need not take longer strings */
    " the picture\n"
    "  --backend KIND        gles1 (EGL), gl (OSMesa, default), soft (integers, RGBA8888), soft565, none (geometry only)\n"
    "  --size WxH            default 240x320\n"
    "  --fov DEGREES         across the width, default 60\n"
    "  --fps N               frames a second, default 30\n"
    "  --png DIR             pictures every --every seconds (default 10) into DIR\n"
    "  --every S\n"
    "  --reference DIR       with --png: the same moments into DIR as they should look, drawn from the pack without a link, to a quarter\n"
    "                        of a pixel and with all images\n";

static const char help_checking[] =
    "\n"
    " checking\n"
    "  --audit on|off        err_px against the whole true ground, default off\n"
    "  --audit-step N        every N-th pixel each way is looked at, default 8\n"
    "  --ground-cache FILE   keeps the decoded true ground there for further flights over this pack\n"
    "  --check on|off        every frame searched for cracks on integer vertices; default: as --audit\n"
    "  --sample S            time between rows, default 1\n"
    "  --tape FILE           records all that comes to the client, for farfield-handheld --tape (not with --server, --event, --balance)\n";

static void print_help(void)
{
    fputs(help, stdout);
    fputs(help_picture, stdout);
#define X(NAME, option, key, name, help) printf("  --%-20s%s\n", option, help);
    FF_SHOW_MODES(X)
#undef X
    fputs(help_checking, stdout);
}

enum option_id {
    OPT_PACK = 256,
    OPT_CSV,
    OPT_JSON,
    OPT_PATH,
    OPT_START,
    OPT_SPEED,
    OPT_HEIGHT,
    OPT_SECONDS,
    OPT_SETTLE,
    OPT_SEED,
    OPT_EVENT,
    OPT_EVENTS,
    OPT_LINK,
    OPT_DOWN_TRACE,
    OPT_UP_TRACE,
    OPT_SERVER,
    OPT_QUALITY,
    OPT_PANORAMA,
    OPT_BACK_PLANE,
    OPT_FACE,
    OPT_VIEW,
    OPT_MEMORY,
    OPT_PLAIN,
    OPT_BACKEND,
    OPT_SIZE,
    OPT_FOV,
    OPT_FPS,
    OPT_PNG,
    OPT_REFERENCE,
    OPT_EVERY,
    OPT_AUDIT,
    OPT_CHECK,
    OPT_SAMPLE,
    OPT_TAPE,
    OPT_AUDIT_STEP,
    OPT_GROUND_CACHE,
    OPT_BALANCE,
    OPT_HELP,
    OPT_VERSION,
    OPT_SHOW /* the first of FF_SHOW_MODES; none comes after them */
};

static const struct option long_options[] = { { "pack", 1, NULL, OPT_PACK },
                                              { "csv", 1, NULL, OPT_CSV },
                                              { "json", 0, NULL, OPT_JSON },
                                              { "start", 1, NULL, OPT_START },
                                              { "path", 1, NULL, OPT_PATH },
                                              { "speed", 1, NULL, OPT_SPEED },
                                              { "height", 1, NULL, OPT_HEIGHT },
                                              { "seconds", 1, NULL, OPT_SECONDS },
                                              { "settle", 1, NULL, OPT_SETTLE },
                                              { "seed", 1, NULL, OPT_SEED },
                                              { "event", 1, NULL, OPT_EVENT },
                                              { "events", 1, NULL, OPT_EVENTS },
                                              { "link", 1, NULL, OPT_LINK },
                                              { "down-trace", 1, NULL, OPT_DOWN_TRACE },
                                              { "up-trace", 1, NULL, OPT_UP_TRACE },
                                              { "server", 1, NULL, OPT_SERVER },
                                              { "quality", 1, NULL, OPT_QUALITY },
                                              { "panorama", 1, NULL, OPT_PANORAMA },
                                              { "back-plane", 1, NULL, OPT_BACK_PLANE },
                                              { "view", 1, NULL, OPT_VIEW },
                                              { "memory", 1, NULL, OPT_MEMORY },
                                              { "plain-arrays", 0, NULL, OPT_PLAIN },
                                              { "backend", 1, NULL, OPT_BACKEND },
                                              { "face", 1, NULL, OPT_FACE },
                                              { "size", 1, NULL, OPT_SIZE },
                                              { "fov", 1, NULL, OPT_FOV },
                                              { "fps", 1, NULL, OPT_FPS },
                                              { "reference", 1, NULL, OPT_REFERENCE },
                                              { "png", 1, NULL, OPT_PNG },
                                              { "every", 1, NULL, OPT_EVERY },
/* clang-format off */
#define X(NAME, option, key, name, help) { option, 0, NULL, OPT_SHOW + FF_SHOW_INDEX_##NAME },
                                              FF_SHOW_MODES(X)
#undef X
                                              /* clang-format on */
                                              { "audit", 1, NULL, OPT_AUDIT },
                                              { "check", 1, NULL, OPT_CHECK },
                                              { "sample", 1, NULL, OPT_SAMPLE },
                                              { "tape", 1, NULL, OPT_TAPE },
                                              { "audit-step", 1, NULL, OPT_AUDIT_STEP },
                                              { "ground-cache", 1, NULL, OPT_GROUND_CACHE },
                                              { "balance", 1, NULL, OPT_BALANCE },
                                              { "help", 0, NULL, OPT_HELP },
                                              { "version", 0, NULL, OPT_VERSION },
                                              { NULL, 0, NULL, 0 } };

static int fail(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    fputs("farfield-fly: ", stderr);
    vfprintf(stderr, format, list);
    fputc('\n', stderr);
    va_end(list);
    return -1;
}

static int parse_number(const char *name, const char *text, double low, double high, double *value)
{
    char *end;
    errno = 0;
    double number = strtod(text, &end);
    if (end == text || *end || errno || !(number >= low && number <= high))
        return fail("--%s: %s is not a number from %g to %g", name, text, low, high);
    *value = number;
    return 0;
}

/* Index of `text` among `count` words, or -1 with a line on stderr. */
static int parse_word(const char *name, const char *text, const char *const *word, int count)
{
    for (int i = 0; i < count; i++)
        if (!strcmp(word[i], text)) return i;
    return fail("--%s: unknown word %s", name, text);
}

static int parse_switch(const char *name, const char *text, int *value)
{
    static const char *const word[] = { "off", "on" };
    int index = parse_word(name, text, word, 2);
    *value = index;
    return index < 0 ? -1 : 0;
}

static int parse_quality(fly_options *options, const char *text)
{
    double a, b;
    char rest;
    ff_quality *quality = &options->quality;
    if (!strcmp(text, "low"))
        text = "3:4";
    else if (!strcmp(text, "high"))
        text = "9:8";
    if (sscanf(text, "px:%lf%c", &a, &rest) == 1 && a >= 0.01 && a <= 1000) {
        quality->measure = FF_MEASURE_PIXELS;
        quality->error_px_q8 = (int32_t)(a * 256 + 0.5);
        quality->depth_max = 0;
    } else if (sscanf(text, "%lf:%lf%c", &a, &b, &rest) == 2 && a > 0 && a <= 1000 && b >= 1 &&
               b <= 15) {
        quality->measure = FF_MEASURE_DISTANCE;
        quality->c_q8 = (int32_t)(a * 256 + 0.5);
        quality->depth_max = (uint8_t)b;
    } else {
        return fail("--quality: %s is not low, high, C:DEPTH or px:E", text);
    }
    return 0;
}

static int parse_balance(fly_options *options, const char *text)
{
    double triangles, bytes_s = 0;
    char rest;
    ff_balance_desc *balance = &options->balance;
    *balance = (ff_balance_desc){ .mode = FF_BALANCE_ON };
    options->balance_text = text;
    if (!strcmp(text, "off"))
        balance->mode = FF_BALANCE_OFF;
    else if (!strcmp(text, "server"))
        balance->mode = FF_BALANCE_ALL_SERVER;
    else if (!strcmp(text, "client"))
        balance->mode = FF_BALANCE_ALL_CLIENT;
    else if ((sscanf(text, "%lf%c", &triangles, &rest) != 1 &&
              sscanf(text, "%lf,%lf%c", &triangles, &bytes_s, &rest) != 2) ||
             !(triangles >= 0 && triangles <= 1e9) || !(bytes_s >= 0 && bytes_s <= 1e9))
        return fail("--balance: %s is not off, server, client or TRIANGLES[,BYTES]", text);
    else
        balance->frame_budget = (uint32_t)triangles, balance->link_bytes_s = (uint32_t)bytes_s;
    return 0;
}

static int parse_size(fly_options *options, const char *text)
{
    unsigned width, height;
    char rest;
    if (sscanf(text, "%4ux%4u%c", &width, &height, &rest) != 2 || width < 16 || height < 16 ||
        width > 4096 || height > 4096)
        return fail("--size: %s is not WIDTHxHEIGHT, each 16 to 4096", text);
    options->width = (uint16_t)width;
    options->height = (uint16_t)height;
    return 0;
}

static int parse_memory(fly_options *options, const char *text)
{
    char *end;
    double number = strtod(text, &end);
    if (*end == 'K' || *end == 'M') number *= *end++ == 'K' ? 1024.0 : 1048576.0;
    if (*end || !(number >= 1 && number <= 4294967295.0))
        return fail("--memory: %s is not a number of bytes", text);
    options->memory_bytes = (size_t)number;
    return 0;
}

/* "link=SPEC", "teleport=X,Y", "budget=N": 1 and all but the time; 0 when `what` is neither; -1
 * with a line on stderr. */
static int parse_event_value(const char *what, fly_event *event)
{
    char rest;
    if (!strncmp(what, "link=", 5)) {
        event->kind = FLY_LINK;
        return sim_link_parse(what + 5, &event->link) == FF_OK
                   ? 1
                   : fail("--event: no link %s", what + 5);
    }
    if (!strncmp(what, "budget=", 7)) {
        event->kind = FLY_BUDGET;
        return sscanf(what + 7, "%9u%c", &event->budget, &rest) == 1
                   ? 1
                   : fail("--event: %s is not budget=TRIANGLES", what);
    }
    if (strncmp(what, "teleport=", 9)) return 0;
    event->kind = FLY_TELEPORT;
    if (sscanf(what + 9, "%lf,%lf%c", &event->place[0], &event->place[1], &rest) == 2 &&
        event->place[0] >= 0 && event->place[0] <= 1 && event->place[1] >= 0 &&
        event->place[1] <= 1)
        return 1;
    return fail("--event: %s is not teleport=X,Y, each 0 to 1", what);
}

static int parse_event(fly_options *options, const char *text)
{
    static const char *const word[] = { "low-battery", "battery-ok",  "interruption", "resume",
                                        "cut",         "panorama-on", "panorama-off" };
    fly_event event = { 0 };
    char *what;
    double at_s = strtod(text, &what);
    if (what == text || *what != ':' || !(at_s >= 0 && at_s <= 1e6))
        return fail("--event: %s is not T:WHAT", text);
    if (options->event_count == FLY_EVENTS_MAX)
        return fail("--event: more than %d", FLY_EVENTS_MAX);
    int rc = parse_event_value(what + 1, &event),
        kind = rc ? 0 : parse_word("event", what + 1, word, 7);
    if (rc < 0 || kind < 0) return -1;
    if (!rc) event.kind = (enum fly_event_kind)kind;
    event.at_s = at_s;
    options->event[options->event_count++] = event;
    return 0;
}

/* An event on each line. */
static int parse_events(fly_options *options, const char *path)
{
    char line[1024];
    FILE *file = fopen(path, "r");
    int rc = file ? 0 : fail("--events: %s: %s", path, strerror(errno));
    while (!rc && fgets(line, sizeof line, file)) {
        line[strcspn(line, "#\r\n")] = '\0';
        char *first = line + strspn(line, " \t"), *last = first + strlen(first);
        while (last > first && (last[-1] == ' ' || last[-1] == '\t')) *--last = '\0';
        if (*first) rc = parse_event(options, first);
    }
    if (file) fclose(file);
    return rc;
}

static int parse_link(fly_options *options, const char *text)
{
    options->link_text = text;
    const char *down = options->link.way[SIM_DOWN].trace, *up = options->link.way[SIM_UP].trace;
    int rc = sim_link_parse(text, &options->link);
    options->link.way[SIM_DOWN].trace = down;
    options->link.way[SIM_UP].trace = up;
    if (rc == FF_OK) return 0;
    return rc == FF_ERR_NOT_FOUND ? fail("--link: no profile %s", text)
                                  : fail("--link: %s is not NAME[,KEY=VALUE...]", text);
}

static const char *const backend_word[] = { "gles1", "gl", "soft", "soft565", "none" };

static int parse_backend(fly_options *options, const char *text)
{
    int kind = parse_word("backend", text, backend_word,
                          sizeof backend_word / sizeof *backend_word);
    options->backend = (enum fly_backend)kind;
    return kind < 0 ? -1 : 0;
}

static const char *const path_word[] = { "diagonal", "circle", "hover", "turn" };

static int parse_path(fly_options *options, const char *text)
{
    fly_recording_free(&options->recording);
    options->path_text = text;
    for (unsigned i = 0; i < sizeof path_word / sizeof *path_word; i++)
        if (!strcmp(path_word[i], text)) {
            options->path = (enum fly_path_kind)i;
            return 0;
        }
    options->path = FLY_RECORDED;
    return fly_recording_read(&options->recording, text);
}

static int parse_metres_wu(const char *name, const char *text, int32_t *value_wu)
{
    double metres;
    if (parse_number(name, text, 1, 8000000, &metres)) return -1;
    *value_wu = (int32_t)(metres * FF_WU_PER_METRE);
    return 0;
}

static int parse_one_number(fly_options *options, int id, const char *text)
{
    double number;
    switch (id) {
        case OPT_START: return parse_number("start", text, 0, 1, &options->start);
        case OPT_SPEED: return parse_number("speed", text, 0, 1e5, &options->speed_kmh);
        case OPT_HEIGHT: return parse_number("height", text, 0.01, 1e6, &options->height_m);
        case OPT_SECONDS: return parse_number("seconds", text, 0, 1e6, &options->seconds);
        case OPT_SETTLE: return parse_number("settle", text, 0, 1e6, &options->settle_s);
        case OPT_FOV: return parse_number("fov", text, 0.1, 170, &options->fov_degrees);
        case OPT_EVERY: return parse_number("every", text, 0.01, 1e6, &options->every_s);
        case OPT_SAMPLE: return parse_number("sample", text, 0.01, 1e6, &options->sample_s);
        case OPT_SEED:
            if (parse_number("seed", text, 0, 9007199254740992.0, &number)) return -1;
            options->seed = (uint64_t)number;
            return 0;
        case OPT_FACE:
            if (parse_number("face", text, 64, 1024, &number)) return -1;
            options->panorama.face_size = (uint16_t)number;
            return 0;
        case OPT_AUDIT_STEP:
            if (parse_number("audit-step", text, 1, 64, &number)) return -1;
            options->audit_step_px = (uint32_t)number;
            return 0;
        default: /* OPT_FPS */
            if (parse_number("fps", text, 1, 1000, &number)) return -1;
            options->fps = (uint32_t)number;
            return 0;
    }
}

static int parse_one(fly_options *options, int id, const char *text)
{
    int on = 0;
    switch (id) {
        case OPT_PACK: options->pack_path = text; return 0;
        case OPT_CSV: options->csv_path = text; return 0;
        case OPT_PNG: options->png_dir = text; return 0;
        case OPT_REFERENCE: options->reference_dir = text; return 0;
        case OPT_TAPE: options->tape_path = text; return 0;
        case OPT_GROUND_CACHE: options->ground_cache = text; return 0;
        case OPT_SERVER: options->server = text; return 0;
        case OPT_DOWN_TRACE: options->link.way[SIM_DOWN].trace = text; return 0;
        case OPT_UP_TRACE: options->link.way[SIM_UP].trace = text; return 0;
        case OPT_JSON: options->json = 1; return 0;
        case OPT_PLAIN: options->plain_arrays = 1; return 0;
        case OPT_LINK: return parse_link(options, text);
        case OPT_QUALITY: options->quality_text = text; return parse_quality(options, text);
        case OPT_BALANCE: return parse_balance(options, text);
        case OPT_BACK_PLANE:
            return parse_metres_wu("back-plane", text, &options->panorama.back_plane_wu);
        case OPT_VIEW: return parse_metres_wu("view", text, &options->quality.view_wu);
        case OPT_MEMORY: return parse_memory(options, text);
        case OPT_SIZE: return parse_size(options, text);
        case OPT_EVENT: return parse_event(options, text);
        case OPT_EVENTS: return parse_events(options, text);
        case OPT_BACKEND: return parse_backend(options, text);
        case OPT_PATH: return parse_path(options, text);
        case OPT_AUDIT: return parse_switch("audit", text, &options->audit);
        case OPT_CHECK: return parse_switch("check", text, &options->check);
        case OPT_PANORAMA:
            if (parse_switch("panorama", text, &on)) return -1;
            options->panorama.enabled = (uint8_t)on;
            return 0;
        default: break;
    }
    if (id < OPT_SHOW) return parse_one_number(options, id, text);
    options->show |= 1u << (id - OPT_SHOW);
    return 0;
}

int fly_options_parse(fly_options *options, int argc, char **argv)
{
    *options = (fly_options){ .link_text = "umts",
                              .speed_kmh = 150,
                              .seconds = -1,
                              .settle_s = 15,
                              .height_m = 100,
                              .start = 0.4,
                              .quality_text = "low",
                              .balance_text = "off",
                              .panorama = { .enabled = 1 },
                              .seed = 1,
                              .fps = 30,
                              .width = 240,
                              .height = 320,
                              .fov_degrees = 60,
                              .backend = FLY_GL,
                              .path_text = "diagonal",
                              .check = -1,
                              .audit_step_px = 8,
                              .every_s = 10,
                              .sample_s = 1,
                              .memory_bytes = 4u << 20,
                              .quality = { .sigma_q8 = 320, .view_wu = 30000 * FF_WU_PER_METRE } };
    options->link = *sim_link_profile("umts");
    (void)parse_quality(options, "low");
    for (int id; (id = getopt_long(argc, argv, "", long_options, NULL)) != -1;) {
        if (id == OPT_HELP || id == OPT_VERSION) {
            if (id == OPT_HELP)
                print_help();
            else
                puts("farfield-fly " FARFIELD_VERSION);
            return 1;
        }
        if (id == '?' || parse_one(options, id, optarg)) return -1;
    }
    if (optind < argc) return fail("unexpected argument %s", argv[optind]);
    if (!options->pack_path) return fail("--pack is missing (see --help)");
    if (options->seconds < 0 && options->path == FLY_RECORDED)
        options->seconds = fmax(0, options->recording.fix[options->recording.count - 1].t_s -
                                       options->settle_s);
    if (options->seconds < 0) options->seconds = 300;
    if (options->check < 0) options->check = options->audit;
    if (options->tape_path &&
        (options->server || options->event_count || options->balance.mode != FF_BALANCE_OFF))
        return fail("--tape records simulated flights without events and without --balance");
    if (options->reference_dir && !options->png_dir) return fail("--reference needs --png");
    if (options->png_dir && options->backend == FLY_NONE)
        return fail("--png needs a --backend other than none");
    return 0;
}

void fly_options_free(fly_options *options) { fly_recording_free(&options->recording); }

const char *fly_backend_name(enum fly_backend backend) { return backend_word[backend]; }

void fly_options_print(const fly_options *options)
{
    fprintf(
        stderr,
        "farfield-fly: seed %llu, pack %s, %s %s, %g km/h, %g s after %g s, %s from %g, %g m up, quality %s, panorama %s, balance %s, "
        "%ux%u at %g degrees, %u fps, backend %s, %zu bytes, audit %s\n",
        (unsigned long long)options->seed, options->pack_path, options->server ? "server" : "link",
        options->server ? options->server : options->link_text, options->speed_kmh,
        options->seconds, options->settle_s, options->path_text, options->start, options->height_m,
        options->quality_text, options->panorama.enabled ? "on" : "off", options->balance_text,
        options->width, options->height, options->fov_degrees, options->fps,
        fly_backend_name(options->backend), options->memory_bytes, options->audit ? "on" : "off");
}
