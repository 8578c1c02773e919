#include "handheld.h"

#include <getopt.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char help[] =
    "Usage: farfield-handheld --pack PACK | --server ADDR:PORT | --tape FILE [options]\n"
    "\n"
    "The client as it runs on a handheld: integers only, no GPU, one block of memory. Ends with its statistics on stdout.\n"
    "\n"
    "  --pack PACK           a pack on this device\n"
    "  --server ADDR:PORT    a farfield-server, in real time\n"
    "  --tape FILE           a flight recorded by farfield-fly --tape: fails unless everything goes as recorded\n"
    "  --frames N            default 300; 30 a second (a tape has its own)\n"
    "  --size WxH            default 240x320 (a tape has its own)\n"
    "  --quality Q           low (C 3, depth 4: default), high (C 9, depth 8), C:DEPTH, or px:E for E pixels of error, all whole numbers\n"
    "  --panorama on|off     default on with --server; a tape has its own\n"
    "  --balance TRIANGLES   the client's share of the work follows the link and this budget for a frame, 0: as many as it takes; --quality\n"
    "                        and the panorama's usual error are the finest (not with --tape); default: all as set\n"
    "  --speed KMH           default 150\n"
    "  --height M            above the ground drawn, default 100\n"
    "  --memory BYTES        of the client's block, with K or M; default 4M, or what the tape says\n"
    "  --no-textures         images of the ground are not asked for\n"
    "  --no-pictures         geometry only, nothing is drawn\n"
    "  --hud                 figures over the picture\n"
    "  --hash                a hash over the pixels of all frames, among the statistics\n"
    "  --fb FILE             the last frame as PPM\n"
    "  --json                statistics as JSON\n"
    "  --plan                no flight: how blocks of 1, 2, 4 and 8 MB are shared out for this pack's ground, over a link\n"
    "  --help, --version\n";

enum option_id {
    OPT_PACK = 256,
    OPT_SERVER,
    OPT_TAPE,
    OPT_FRAMES,
    OPT_SIZE,
    OPT_QUALITY,
    OPT_PANORAMA,
    OPT_SPEED,
    OPT_HEIGHT,
    OPT_MEMORY,
    OPT_NO_TEXTURES,
    OPT_NO_PICTURES,
    OPT_BALANCE,
    OPT_HUD,
    OPT_HASH,
    OPT_FB,
    OPT_JSON,
    OPT_PLAN,
    OPT_HELP,
    OPT_VERSION
};

static const struct option long_options[] = { { "pack", 1, NULL, OPT_PACK },
                                              { "server", 1, NULL, OPT_SERVER },
                                              { "tape", 1, NULL, OPT_TAPE },
                                              { "frames", 1, NULL, OPT_FRAMES },
                                              { "size", 1, NULL, OPT_SIZE },
                                              { "quality", 1, NULL, OPT_QUALITY },
                                              { "panorama", 1, NULL, OPT_PANORAMA },
                                              { "speed", 1, NULL, OPT_SPEED },
                                              { "height", 1, NULL, OPT_HEIGHT },
                                              { "memory", 1, NULL, OPT_MEMORY },
                                              { "no-textures", 0, NULL, OPT_NO_TEXTURES },
                                              { "balance", 1, NULL, OPT_BALANCE },
                                              { "no-pictures", 0, NULL, OPT_NO_PICTURES },
                                              { "hud", 0, NULL, OPT_HUD },
                                              { "hash", 0, NULL, OPT_HASH },
                                              { "fb", 1, NULL, OPT_FB },
                                              { "json", 0, NULL, OPT_JSON },
                                              { "plan", 0, NULL, OPT_PLAN },
                                              { "help", 0, NULL, OPT_HELP },
                                              { "version", 0, NULL, OPT_VERSION },
                                              { NULL, 0, NULL, 0 } };

static int fail(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    fputs("farfield-handheld: ", stderr);
    vfprintf(stderr, format, list);
    fputc('\n', stderr);
    va_end(list);
    return -1;
}

/* The number at *text, and what comes after it in *text; -1 when there is none or it is out of
 * range. */
static long number_at(const char **text, long low, long high)
{
    char *end;
    if (**text < '0' || **text > '9') return -1;
    long number = strtol(*text, &end, 10);
    *text = end;
    return number >= low && number <= high ? number : -1;
}

static int parse_number(const char *name, const char *text, long low, long high, long *number)
{
    const char *rest = text;
    *number = number_at(&rest, low, high);
    return *number >= 0 && !*rest
               ? 0
               : fail("--%s: %s is not a whole number from %ld to %ld", name, text, low, high);
}

static int parse_quality(ff_quality *quality, const char *text)
{
    const char *at = !strcmp(text, "low") ? "3:4" : !strcmp(text, "high") ? "9:8" : text;
    int pixels = !strncmp(at, "px:", 3);
    at += pixels ? 3 : 0;
    long first = number_at(&at, 1, 1000), depth = 0;
    if (first > 0 && !pixels && *at == ':') {
        at++;
        depth = number_at(&at, 1, 15);
    }
    if (first < 0 || *at || (!pixels && depth <= 0))
        return fail("--quality: %s is not low, high, C:DEPTH or px:E", text);
    quality->measure = pixels ? FF_MEASURE_PIXELS : FF_MEASURE_DISTANCE;
    *(pixels ? &quality->error_px_q8 : &quality->c_q8) = (int32_t)first * 256;
    quality->depth_max = (uint8_t)depth;
    return 0;
}

static int parse_size(handheld_options *options, const char *text)
{
    const char *at = text;
    long width = number_at(&at, 16, 4096);
    int cross = *at == 'x';
    at += cross;
    long height = number_at(&at, 16, 4096);
    if (width < 0 || !cross || height < 0 || *at)
        return fail("--size: %s is not WIDTHxHEIGHT, each 16 to 4096", text);
    options->width = (uint16_t)width;
    options->height = (uint16_t)height;
    return 0;
}

static int parse_memory(handheld_options *options, const char *text)
{
    const char *at = text;
    long number = number_at(&at, 1, 1L << 30), unit = *at == 'M'   ? 1 << 20
                                                      : *at == 'K' ? 1 << 10
                                                                   : 1;
    at += unit != 1;
    if (number < 0 || *at || number > (1L << 30) / unit)
        return fail("--memory: %s is not a number of bytes up to 1024M", text);
    options->memory_bytes = (uint32_t)(number * unit);
    return 0;
}

static int parse_panorama(handheld_options *options, const char *text)
{
    if (strcmp(text, "on") && strcmp(text, "off"))
        return fail("--panorama: %s is not on or off", text);
    options->panorama.enabled = !strcmp(text, "on");
    return 0;
}

static int parse_one(handheld_options *options, int id, const char *text)
{
    long number = 0;
    int rc = 0;
    switch (id) {
        case OPT_PACK: options->pack_path = text; break;
        case OPT_SERVER: options->server = text; break;
        case OPT_TAPE: options->tape_path = text; break;
        case OPT_FB: options->fb_path = text; break;
        case OPT_JSON: options->json = 1; break;
        case OPT_PLAN: options->plan = 1; break;
        case OPT_HUD: options->hud = 1; break;
        case OPT_HASH: options->hash = 1; break;
        case OPT_NO_PICTURES: options->no_pictures = 1; break;
        case OPT_NO_TEXTURES: options->no_textures = 1; break;
        case OPT_SIZE: rc = parse_size(options, text); break;
        case OPT_QUALITY: rc = parse_quality(&options->quality, text); break;
        case OPT_PANORAMA: rc = parse_panorama(options, text); break;
        case OPT_MEMORY: rc = parse_memory(options, text); break;
        case OPT_BALANCE:
            rc = parse_number("balance", text, 0, 1000000, &number);
            options->balance = (ff_balance_desc){ .mode = FF_BALANCE_ON,
                                                  .frame_budget = (uint32_t)number };
            break;
        case OPT_FRAMES:
            rc = parse_number("frames", text, 1, 1000000, &number);
            options->frames = (uint32_t)number;
            break;
        case OPT_SPEED:
            rc = parse_number("speed", text, 0, 10000, &number);
            options->speed_kmh = (int32_t)number;
            break;
        default:
            rc = parse_number("height", text, 1, 100000, &number);
            options->height_m = (int32_t)number;
    }
    return rc;
}

int handheld_options_parse(handheld_options *options, int argc, char **argv)
{
    *options =
        (handheld_options){ .frames = 300,
                            .width = 240,
                            .height = 320,
                            .speed_kmh = 150,
                            .height_m = 100,
                            .panorama = { .enabled = 1 },
                            .quality = { .sigma_q8 = 320, .view_wu = 30000 * FF_WU_PER_METRE } };
    (void)parse_quality(&options->quality, "low");
    for (int id; (id = getopt_long(argc, argv, "", long_options, NULL)) != -1;) {
        if (id == OPT_HELP || id == OPT_VERSION) {
            fputs(id == OPT_HELP ? help : "farfield-handheld " FARFIELD_VERSION "\n", stdout);
            return 1;
        }
        if (id == '?' || parse_one(options, id, optarg)) return -1;
    }
    if (optind < argc) return fail("unexpected argument %s", argv[optind]);
    if ((options->pack_path != NULL) + (options->server != NULL) + (options->tape_path != NULL) !=
        1)
        return fail("one of --pack, --server and --tape is wanted (see --help)");
    if (options->plan && !options->pack_path) return fail("--plan: --pack is wanted with it");
    if (options->tape_path && options->balance.mode != FF_BALANCE_OFF)
        return fail("--balance: not with --tape");
    if ((options->fb_path || options->hash) && options->no_pictures)
        return fail("--fb and --hash: there are no pictures with --no-pictures");
    return 0;
}
