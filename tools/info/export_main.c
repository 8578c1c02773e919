/* farfield-export: decodes the ground of a pack again. */
#include "../../client/farfield.h"
#include "bake_export.h"
#include "../bake/raster/bake_gdal.h"
#include "../bake/bake_say.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

static const char help_text[] =
    "Usage: farfield-export PACK [--level L] -o OUT.tif|OUT.png|OUT.r16\n"
    "\n"
    "Decodes a pack's ground: GeoTIFF with reference, scale and offset; 16-bit PNG or raw little-endian 16 bit\n"
    "(top row north) with the height steps alone.\n"
    "\n"
    "  -o, --output FILE\n"
    "  --level L            0: roots only .. the finest level (default)\n"
    "  --quiet              errors only\n"
    "  --help, --version\n";

typedef struct export_options {
    const char *pack_path, *out_path;
    long level; /* -1: the finest */
} export_options;

enum { OPT_LEVEL = 1000, OPT_QUIET, OPT_HELP, OPT_VERSION };

static const struct option long_options[] = {
    { "output", required_argument, 0, 'o' },    { "level", required_argument, 0, OPT_LEVEL },
    { "quiet", no_argument, 0, OPT_QUIET },     { "help", no_argument, 0, OPT_HELP },
    { "version", no_argument, 0, OPT_VERSION }, { 0, 0, 0, 0 }
};

/* 0: go on; 1: answered; -1: wrong, said why. */
static int parse(export_options *o, int argc, char **argv)
{
    *o = (export_options){ .level = -1 };
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "o:", long_options, NULL)) != -1;) {
        char *end = NULL;
        switch (option) {
            case 'o': o->out_path = optarg; break;
            case OPT_LEVEL:
                o->level = strtol(optarg, &end, 10);
                if (end == optarg || *end || o->level < 0)
                    return bake_fail("--level %s: a level is wanted", optarg);
                break;
            case OPT_QUIET: bake_say_setup("farfield-export", 1); break;
            case OPT_HELP: return fputs(help_text, stdout), 1;
            case OPT_VERSION: return puts("farfield-export " FARFIELD_VERSION), 1;
            default:
                return bake_fail("unknown or incomplete option %s; try --help", argv[optind - 1]);
        }
    }
    if (optind + 1 != argc) return bake_fail("one pack is wanted; try --help");
    o->pack_path = argv[optind];
    return o->out_path ? 0 : bake_fail("no output given: -o OUT.tif");
}

int main(int argc, char **argv)
{
    export_options options;
    bake_unpack unpack;
    bake_say_setup("farfield-export", 0);
    int rc = parse(&options, argc, argv);
    if (rc) return rc < 0;
    GDALAllRegister();
    CPLSetErrorHandler(CPLQuietErrorHandler);
    if (bake_unpack_open(&unpack, options.pack_path)) return 1;
    long finest = (long)ff_terrain_levels(&unpack.pack.header.info) - 1;
    if (options.level > finest)
        rc = bake_fail("--level %ld: %s has levels 0 to %ld", options.level, options.pack_path,
                       finest);
    else
        rc = bake_export(&unpack, (uint32_t)(options.level < 0 ? finest : options.level),
                         options.out_path);
    bake_unpack_close(&unpack);
    return rc ? 1 : 0;
}
