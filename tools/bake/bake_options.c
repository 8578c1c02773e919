#include "bake_options.h"

#include "../../client/farfield.h"
#include "bake_say.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help_text[] =
    "Usage: farfield-bake HEIGHTS [options] -o OUT.ffp\n"
    "\n"
    "Makes a Farfield pack from a raster of heights: any raster GDAL reads, or raw 16 bit.\n"
    "Geographic rasters are projected to metres; voids are filled and counted.\n"
    "\n"
    "Input\n"
    "  --color IMAGE        image over the same ground, any resolution\n"
    "  --raw WxH[:le|be][:u16|s16]  HEIGHTS is headerless 16 bit, top row north (default le, u16)\n"
    "  --scale F            source value * F = metres (default: the source's unit, else 1)\n"
    "  --hscale M           metres a height step; alone with plain 16-bit images: metres a unit\n"
    "  --spacing M          metres between samples; resamples georeferenced rasters\n"
    "  --t-srs EPSG:N       project to this CRS (units metres) instead of the local UTM zone\n"
    "  --no-project         take the samples as they are\n"
    "  --densify N          insert N-1 invented samples between neighbours (N a power of two)\n"
    "Pack\n"
    "  -o, --output OUT.ffp\n"
    "  --max-error M        no decoded height further than M metres from its source (default 0)\n"
    "  --node-log2 K        nodes of (2^K+1)^2 heights, 1..5 (default 3)\n"
    "  --tile-log2 N        tiles of (2^N+1)^2 heights (default: at most 10, little padding)\n"
    "  --texture-log2 T     textures of (2^T)^2 texels, 4..8 (default 6)\n"
    "  --texture-levels L   levels with textures (default: down to the image's resolution)\n"
    "  --texture-quality Q  JPEG quality, 1..100 (default 75)\n"
    "  --codec NAME         %s (default %s); rice: for devices without zlib\n"
    "Run\n"
    "  --jobs N             threads (default: the processors, at most 16); any N gives the same bytes\n"
    "  --json               a summary on stdout\n"
    "  --quiet              errors only\n"
    "  --help, --version\n"
    "\n"
    "Memory: about 130 MiB for GDAL and its caches (more for inputs packed in large blocks), plus 9 bytes x 4^N a job\n"
    "(9 MiB at N = 10), whatever the raster's size. Disk while baking: about 12 bytes a sample beside OUT.ffp,\n"
    "or in FARFIELD_TMP or TMPDIR when set.\n";

enum {
    OPT_COLOR = 1000,
    OPT_RAW,
    OPT_SCALE,
    OPT_HSCALE,
    OPT_SPACING,
    OPT_T_SRS,
    OPT_NO_PROJECT,
    OPT_DENSIFY,
    OPT_MAX_ERROR,
    OPT_NODE_LOG2,
    OPT_TILE_LOG2,
    OPT_TEXTURE_LOG2,
    OPT_TEXTURE_LEVELS,
    OPT_TEXTURE_QUALITY,
    OPT_CODEC,
    OPT_JOBS,
    OPT_JSON,
    OPT_QUIET,
    OPT_HELP,
    OPT_VERSION
};

static const struct option long_options[] = {
    { "color", required_argument, 0, OPT_COLOR },
    { "raw", required_argument, 0, OPT_RAW },
    { "scale", required_argument, 0, OPT_SCALE },
    { "hscale", required_argument, 0, OPT_HSCALE },
    { "spacing", required_argument, 0, OPT_SPACING },
    { "t-srs", required_argument, 0, OPT_T_SRS },
    { "no-project", no_argument, 0, OPT_NO_PROJECT },
    { "densify", required_argument, 0, OPT_DENSIFY },
    { "max-error", required_argument, 0, OPT_MAX_ERROR },
    { "node-log2", required_argument, 0, OPT_NODE_LOG2 },
    { "tile-log2", required_argument, 0, OPT_TILE_LOG2 },
    { "texture-log2", required_argument, 0, OPT_TEXTURE_LOG2 },
    { "texture-levels", required_argument, 0, OPT_TEXTURE_LEVELS },
    { "texture-quality", required_argument, 0, OPT_TEXTURE_QUALITY },
    { "codec", required_argument, 0, OPT_CODEC },
    { "jobs", required_argument, 0, OPT_JOBS },
    { "json", no_argument, 0, OPT_JSON },
    { "quiet", no_argument, 0, OPT_QUIET },
    { "output", required_argument, 0, 'o' },
    { "help", no_argument, 0, OPT_HELP },
    { "version", no_argument, 0, OPT_VERSION },
    { 0, 0, 0, 0 }
};

/* Numbers are taken whole or not at all, and only within their range. */
static int take_real(const char *name, const char *text, double low, double high, double *out)
{
    char *end;
    errno = 0;
    double value = strtod(text, &end);
    if (end == text || *end || errno || !(value >= low && value <= high))
        return bake_fail("--%s %s: a number from %g to %g is wanted", name, text, low, high);
    *out = value;
    return 0;
}

static int take_whole(const char *name, const char *text, long low, long high, uint32_t *out)
{
    char *end;
    errno = 0;
    long value = strtol(text, &end, 10);
    if (end == text || *end || errno || value < low || value > high)
        return bake_fail("--%s %s: a whole number from %ld to %ld is wanted", name, text, low,
                         high);
    *out = (uint32_t)value;
    return 0;
}

static int take_raw(const char *text, bake_raw *raw)
{
    int used = 0;
    if (sscanf(text, "%ux%u%n", &raw->width, &raw->height, &used) != 2 || !raw->width ||
        !raw->height || raw->width > 1u << 24 || raw->height > 1u << 24)
        return bake_fail("--raw %s: WIDTHxHEIGHT[:le|be][:u16|s16] is wanted", text);
    for (const char *at = text + used; *at;) {
        if (!strncmp(at, ":le", 3))
            raw->big_endian = 0, at += 3;
        else if (!strncmp(at, ":be", 3))
            raw->big_endian = 1, at += 3;
        else if (!strncmp(at, ":u16", 4))
            raw->is_signed = 0, at += 4;
        else if (!strncmp(at, ":s16", 4))
            raw->is_signed = 1, at += 4;
        else
            return bake_fail("--raw %s: WIDTHxHEIGHT[:le|be][:u16|s16] is wanted", text);
    }
    return 0;
}

/* Names of all codecs: "a, b or c". */
static const char *codec_names(void)
{
    static char names[160];
    size_t used = 0;
    for (int codec = 0; ff_codec_name(codec) && used < sizeof names; codec++) {
        const char *before = codec == 0 ? "" : ff_codec_name(codec + 1) ? ", " : " or ";
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%s", before,
                                 ff_codec_name(codec));
    }
    return names;
}

static int take_codec(const char *text, int *codec)
{
    for (*codec = 0; ff_codec_name(*codec); ++*codec)
        if (!strcmp(text, ff_codec_name(*codec))) return 0;
    return bake_fail("--codec %s: %s is wanted", text, codec_names());
}

static int take_epsg(const char *text, int *epsg)
{
    uint32_t code;
    const char *digits = strncmp(text, "EPSG:", 5) && strncmp(text, "epsg:", 5) ? text : text + 5;
    if (take_whole("t-srs", digits, 1, 999999, &code)) return -1;
    *epsg = (int)code;
    return 0;
}

static int take_densify(const char *text, uint32_t *densify)
{
    if (take_whole("densify", text, 1, 64, densify)) return -1;
    if (*densify & (*densify - 1)) return bake_fail("--densify %s: a power of two is wanted", text);
    return 0;
}

static int take_option(bake_options *o, int option, const char *arg)
{
    uint32_t whole = 0;
    int rc = 0;
    switch (option) {
        case OPT_COLOR: o->color_path = arg; return 0;
        case 'o': o->out_path = arg; return 0;
        case OPT_RAW: return take_raw(arg, &o->raw);
        case OPT_SCALE: return take_real("scale", arg, 1e-6, 1e6, &o->scale);
        case OPT_HSCALE: return take_real("hscale", arg, 1e-6, 200, &o->hscale_m);
        case OPT_SPACING:
            return take_real("spacing", arg, 1.0 / FF_WU_PER_METRE, 1e6, &o->spacing_m);
        case OPT_T_SRS: return take_epsg(arg, &o->target_epsg);
        case OPT_NO_PROJECT: o->no_project = 1; return 0;
        case OPT_DENSIFY: return take_densify(arg, &o->densify);
        case OPT_MAX_ERROR: return take_real("max-error", arg, 0, 1e6, &o->max_error_m);
        case OPT_NODE_LOG2: return take_whole("node-log2", arg, 1, FF_NODE_LOG2_MAX, &o->node_log2);
        case OPT_TILE_LOG2: return take_whole("tile-log2", arg, 1, 15, &o->tile_log2);
        case OPT_TEXTURE_LOG2: return take_whole("texture-log2", arg, 4, 8, &o->texture_log2);
        case OPT_TEXTURE_LEVELS:
            return take_whole("texture-levels", arg, 1, 15, &o->texture_levels);
        case OPT_TEXTURE_QUALITY:
            rc = take_whole("texture-quality", arg, 1, 100, &whole);
            o->texture_quality = (int)whole;
            return rc;
        case OPT_CODEC: return take_codec(arg, &o->codec);
        case OPT_JOBS:
            rc = take_whole("jobs", arg, 1, 64, &whole);
            o->jobs = (int)whole;
            return rc;
        case OPT_JSON: o->json = 1; return 0;
        case OPT_QUIET: o->quiet = 1; return 0;
        default: return bake_fail("try farfield-bake --help");
    }
}

static void set_defaults(bake_options *o)
{
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    *o = (bake_options){ .node_log2 = 3,
                         .densify = 1,
                         .texture_log2 = 6,
                         .texture_quality = 75,
                         .codec = FF_CODEC_DEFLATE,
                         .jobs = processors < 1    ? 1
                                 : processors > 16 ? 16
                                                   : (int)processors };
}

int bake_options_parse(bake_options *o, int argc, char **argv)
{
    set_defaults(o);
    bake_say_setup("farfield-bake", 0);
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "o:", long_options, NULL)) != -1;) {
        if (option == OPT_HELP) return printf(help_text, codec_names(), ff_codec_name(o->codec)), 1;
        if (option == OPT_VERSION) return puts("farfield-bake " FARFIELD_VERSION), 1;
        if (option == '?')
            return bake_fail("unknown or incomplete option %s; try --help", argv[optind - 1]);
        if (take_option(o, option, optarg)) return -1;
    }
    if (optind + 1 != argc)
        return bake_fail(optind == argc ? "no heights given; try --help"
                                        : "one raster of heights only");
    o->heights_path = argv[optind];
    if (!o->out_path) return bake_fail("no output given: -o OUT.ffp");
    if (o->tile_log2 && (o->tile_log2 < o->node_log2 || o->tile_log2 > o->node_log2 + 15))
        return bake_fail("--tile-log2 %u: not from --node-log2 %u up", o->tile_log2, o->node_log2);
    if (o->no_project && o->target_epsg)
        return bake_fail("--no-project and --t-srs exclude each other");
    bake_say_setup("farfield-bake", o->quiet);
    return 0;
}
