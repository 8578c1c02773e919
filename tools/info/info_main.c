/* farfield-info: what is inside a pack. */
#include "../../client/farfield.h"
#include "../../protocol/shape/ff_shape.h"
#include "bake_info.h"
#include "../bake/bake_say.h"
#include "bake_unpack.h"

#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static const char help_text[] =
    "Usage: farfield-info [--json] [--verify] PACK\n"
    "\n"
    "Shows what a pack holds: its terrain, and bytes and bits a sample by level.\n"
    "\n"
    "  --json               as JSON\n"
    "  --verify             check every record's checksum and decode every height\n"
    "  --help, --version\n";

typedef struct info_options {
    const char *path;
    int json, verify;
} info_options;

enum { OPT_JSON = 1000, OPT_VERIFY, OPT_HELP, OPT_VERSION };

static const struct option long_options[] = { { "json", no_argument, 0, OPT_JSON },
                                              { "verify", no_argument, 0, OPT_VERIFY },
                                              { "help", no_argument, 0, OPT_HELP },
                                              { "version", no_argument, 0, OPT_VERSION },
                                              { 0, 0, 0, 0 } };

/* 0: go on; 1: answered; -1: wrong, said why. */
static int parse(info_options *o, int argc, char **argv)
{
    *o = (info_options){ 0 };
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "", long_options, NULL)) != -1;) {
        switch (option) {
            case OPT_JSON: o->json = 1; break;
            case OPT_VERIFY: o->verify = 1; break;
            case OPT_HELP: return fputs(help_text, stdout), 1;
            case OPT_VERSION: return puts("farfield-info " FARFIELD_VERSION), 1;
            default: return bake_fail("unknown option %s; try --help", argv[optind - 1]);
        }
    }
    if (optind + 1 != argc) return bake_fail("one pack is wanted; try --help");
    o->path = argv[optind];
    return 0;
}

/* Checks the checksums of all records, then decodes every tile: intact bytes may still make no
 * sense. */
static int verify(const bake_unpack *unpack)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    uint32_t finest = ff_terrain_levels(info) - 1, side = bake_unpack_side(info, finest);
    uint64_t bad;
    int rc = ff_pack_verify(&unpack->pack, &bad);
    if (rc && bad) return bake_fail("%s: %" PRIu64 " damaged records", unpack->path, bad);
    if (rc) return bake_fail("%s: %s", unpack->path, ff_error_text(rc));
    uint16_t *heights = malloc((size_t)side * side * sizeof *heights);
    if (!heights) return bake_fail("out of memory");
    for (uint32_t tile = 0; !rc && tile < ff_shape_tiles(info); tile++)
        rc = bake_unpack_tile(unpack, tile, finest, heights);
    free(heights);
    return rc;
}

int main(int argc, char **argv)
{
    info_options options;
    bake_unpack unpack;
    bake_say_setup("farfield-info", 0);
    int rc = parse(&options, argc, argv);
    if (rc) return rc < 0;
    if (bake_unpack_open(&unpack, options.path)) return 1;
    if (options.verify) rc = verify(&unpack);
    if (!rc && options.json)
        bake_info_print_json(&unpack.pack);
    else if (!rc)
        bake_info_print(&unpack.pack, options.path);
    if (!rc && options.verify && !options.json) puts("verified: every record is whole and decodes");
    bake_unpack_close(&unpack);
    return rc ? 1 : 0;
}
