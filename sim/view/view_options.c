#include "view_options.h"

#include "view_fly.h"

#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MEMORY_MB_DEFAULT 16
#define KILOMETRE_WU      (1000 * FF_WU_PER_METRE)

/* Before and after the ways to draw. */
static const char usage[] =
    "Usage: farfield-view [OPTION]... ADDR:PORT | PACK\n"
    "Fly over terrain from a server or a pack: the desktop emulator.\n"
    "\n"
    "Display:\n"
    "      --backend gles1|gl|soft  graphics library, or integers alone (default: gles1, else gl)\n"
    "      --size WxH            window in pixels (default 240x320)\n"
    "      --fov DEGREES         horizontal field of view, 0.1 to 170 (default 60)\n"
    "      --headless            no window: draw off screen\n"
    "      --plain-arrays        no vertex buffers\n"
    "      --no-hud              begin without the text\n";

static const char usage_terrain[] =
    "\n"
    "Terrain:\n"
    "      --quality Q           low (default), high, C:DEPTH, or px:E for E pixels of error\n"
    "      --panorama on|off     far ground as panoramas (default: on for a server)\n"
    "      --balance TRIANGLES   the client's share of the work follows the link and this\n"
    "                            budget for a frame (0: as many as it takes); quality and\n"
    "                            panorama as set are the finest (default: all as set)\n"
    "      --link SPEC           link model between client and server: none, gprs, umts,\n"
    "                            ... or NAME,KEY=VALUE,...; with PACK the server's logic\n"
    "                            runs inside this program\n"
    "      --memory MB           the client's memory block (default 16)\n"
    "      --at X,Y[,H]          start there, metres from the south-west corner, H metres\n"
    "                            above ground (default: the middle, 500 m)\n"
    "      --yaw DEGREES         first direction, clockwise from north (default 0)\n"
    "\n"
    "Driving it from a file:\n"
    "      --script FILE         lines FRAME COMMAND; see sim/view/view_script.h\n"
    "      --keys TEXT           press these keys one after the other\n"
    "      --frames N            stop after N frames\n"
    "      --screenshot FILE     write the last picture as PNG\n"
    "      --events FILE         write each event handled (\"-\": standard output)\n"
    "      --json                print the counters at the end\n"
    "\n"
    "      --help                show this help and exit\n"
    "      --version             show the version and exit\n"
    "\n"
    "Keys: F1 lists them in the window.\n";

enum option_id {
    OPT_BACKEND = 256,
    OPT_SIZE,
    OPT_FOV,
    OPT_HEADLESS,
    OPT_PLAIN,
    OPT_NO_HUD,
    OPT_QUALITY,
    OPT_PANORAMA,
    OPT_LINK,
    OPT_MEMORY,
    OPT_AT,
    OPT_YAW,
    OPT_SCRIPT,
    OPT_KEYS,
    OPT_FRAMES,
    OPT_SCREENSHOT,
    OPT_EVENTS,
    OPT_JSON,
    OPT_BALANCE,
    OPT_HELP,
    OPT_VERSION,
    OPT_SHOW /* the first of FF_SHOW_MODES; none comes after them */
};

static const struct option long_options[] = { { "backend", required_argument, NULL, OPT_BACKEND },
                                              { "size", required_argument, NULL, OPT_SIZE },
                                              { "fov", required_argument, NULL, OPT_FOV },
                                              { "headless", no_argument, NULL, OPT_HEADLESS },
                                              { "plain-arrays", no_argument, NULL, OPT_PLAIN },
/* clang-format off */
#define X(NAME, option, key, name, help) { option, no_argument, NULL, OPT_SHOW + FF_SHOW_INDEX_##NAME },
                                              FF_SHOW_MODES(X)
#undef X
                                              /* clang-format on */
                                              { "no-hud", no_argument, NULL, OPT_NO_HUD },
                                              { "quality", required_argument, NULL, OPT_QUALITY },
                                              { "panorama", required_argument, NULL, OPT_PANORAMA },
                                              { "link", required_argument, NULL, OPT_LINK },
                                              { "memory", required_argument, NULL, OPT_MEMORY },
                                              { "at", required_argument, NULL, OPT_AT },
                                              { "yaw", required_argument, NULL, OPT_YAW },
                                              { "script", required_argument, NULL, OPT_SCRIPT },
                                              { "keys", required_argument, NULL, OPT_KEYS },
                                              { "frames", required_argument, NULL, OPT_FRAMES },
                                              { "screenshot", required_argument, NULL,
                                                OPT_SCREENSHOT },
                                              { "events", required_argument, NULL, OPT_EVENTS },
                                              { "json", no_argument, NULL, OPT_JSON },
                                              { "balance", required_argument, NULL, OPT_BALANCE },
                                              { "help", no_argument, NULL, OPT_HELP },
                                              { "version", no_argument, NULL, OPT_VERSION },
                                              { NULL, 0, NULL, 0 } };

int view_fail(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fputs("farfield-view: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    return -1;
}

/* A number and nothing after it, low..high; 0, or -1. */
static int read_number(const char *text, double low, double high, double *value)
{
    char *end;
    errno = 0;
    *value = strtod(text, &end);
    return end == text || *end || errno || !(*value >= low && *value <= high) ? -1 : 0;
}

static int read_quality(const char *text, ff_quality *quality)
{
    double value;
    unsigned depth;
    int end = 0;
    *quality = (ff_quality){ .measure = FF_MEASURE_DISTANCE,
                             .sigma_q8 = 320,
                             .view_wu = 30 * KILOMETRE_WU };
    if (!strcmp(text, "low")) text = "3:4";
    if (!strcmp(text, "high")) text = "9:8";
    if (!strncmp(text, "px:", 3)) {
        if (read_number(text + 3, 0.05, 1000, &value)) return -1;
        quality->measure = FF_MEASURE_PIXELS;
        quality->error_px_q8 = (int32_t)(value * 256);
        return 0;
    }
    if (sscanf(text, "%lf:%u%n", &value, &depth, &end) != 2 || text[end]) return -1;
    if (!(value >= 0.1 && value <= 100) || depth > FF_KEY_LEVEL_MAX + 1) return -1;
    quality->c_q8 = (int32_t)(value * 256);
    quality->depth_max = (uint8_t)depth;
    return 0;
}

static int read_place(const char *text, view_options *o)
{
    double x, y, h = VIEW_START_ABOVE_WU / FF_WU_PER_METRE;
    int end = 0;
    int got = sscanf(text, "%lf,%lf%n,%lf%n", &x, &y, &end, &h, &end);
    if (got < 2 || text[end] || !(x > -8e6 && x < 8e6) || !(y > -8e6 && y < 8e6) ||
        !(h >= 0 && h <= 1e6))
        return -1;
    o->has_place = 1;
    o->at_x_wu = (int32_t)(x * FF_WU_PER_METRE);
    o->at_y_wu = (int32_t)(y * FF_WU_PER_METRE);
    o->above_wu = (int32_t)(h * FF_WU_PER_METRE);
    return 0;
}

static int read_size(const char *text, view_options *o)
{
    int end = 0;
    if (sscanf(text, "%dx%d%n", &o->width, &o->height, &end) != 2 || text[end]) return -1;
    return o->width < 1 || o->height < 1 || o->width > 4096 || o->height > 4096 ? -1 : 0;
}

static int read_switch(const char *text)
{
    return !strcmp(text, "on") ? 1 : !strcmp(text, "off") ? 0 : -1;
}

/* An option with a value to be read; 0, or -1 when the value is wrong. */
static int take_value(view_options *o, int option, const char *text)
{
    double value;
    switch (option) {
        case OPT_BACKEND:
            o->backend = text;
            return strcmp(text, "gles1") && strcmp(text, "gl") && strcmp(text, "soft") ? -1 : 0;
        case OPT_SIZE: return read_size(text, o);
        case OPT_QUALITY: return read_quality(text, &o->quality);
        case OPT_PANORAMA: return (o->panorama = read_switch(text)) < 0 ? -1 : 0;
        case OPT_AT: return read_place(text, o);
        case OPT_FOV:
            if (read_number(text, 0.1, 170, &value)) return -1;
            o->fov_brad16 = (int32_t)(value * 65536 / 360 + 0.5);
            return 0;
        case OPT_YAW:
            if (read_number(text, -360, 360, &value)) return -1;
            o->yaw_brad16 = (int32_t)(value * 65536 / 360) & 65535;
            return 0;
        case OPT_BALANCE:
            if (read_number(text, 0, 1e9, &value)) return -1;
            o->balance = (ff_balance_desc){ .mode = FF_BALANCE_ON,
                                            .frame_budget = (uint32_t)value };
            return 0;
        case OPT_MEMORY:
            if (read_number(text, 0.01, 4096, &value)) return -1;
            o->memory_bytes = (size_t)(value * 1048576);
            return 0;
        default: /* OPT_FRAMES */
            if (read_number(text, 1, 1e9, &value)) return -1;
            o->frames = (uint32_t)value;
            return 0;
    }
}

/* An option that needs no reading: 1 taken. */
static int take_plain(view_options *o, int option, const char *text)
{
    switch (option) {
        case OPT_HEADLESS: o->headless = 1; return 1;
        case OPT_PLAIN: o->plain_arrays = 1; return 1;
        case OPT_NO_HUD: o->no_hud = 1; return 1;
        case OPT_JSON: o->json = 1; return 1;
        case OPT_LINK: o->link = text; return 1;
        case OPT_SCRIPT: o->script = text; return 1;
        case OPT_KEYS: o->keys = text; return 1;
        case OPT_SCREENSHOT: o->screenshot = text; return 1;
        case OPT_EVENTS: o->events = text; return 1;
        default: break;
    }
    if (option < OPT_SHOW) return 0;
    o->show |= 1u << (option - OPT_SHOW);
    return 1;
}

static void print_usage(void)
{
    fputs(usage, stdout);
#define X(NAME, option, key, name, help) printf("      --%-20sbegin with: %s\n", option, help);
    FF_SHOW_MODES(X)
#undef X
    fputs(usage_terrain, stdout);
}

int view_options_parse(view_options *o, int argc, char **argv)
{
    int option, index = 0;
    *o = (view_options){ .width = 240,
                         .height = 320,
                         .panorama = -1,
                         .fov_brad16 = 65536 / 6,
                         .memory_bytes = (size_t)MEMORY_MB_DEFAULT << 20,
                         .above_wu = VIEW_START_ABOVE_WU };
    read_quality("low", &o->quality);
    while ((option = getopt_long(argc, argv, "", long_options, &index)) != -1) {
        if (option == OPT_HELP) return print_usage(), 1;
        if (option == OPT_VERSION) return puts("farfield-view " FARFIELD_VERSION), 1;
        if (option == '?') return view_fail("try --help");
        if (take_plain(o, option, optarg)) continue;
        if (take_value(o, option, optarg))
            return view_fail("--%s: not understood: %s", long_options[index].name, optarg);
    }
    if (optind + 1 != argc) return view_fail("one server or pack is needed; try --help");
    o->target = argv[optind];
    if (o->script && o->keys) return view_fail("--script and --keys exclude each other");
    return 0;
}
