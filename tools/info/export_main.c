/* farfield-export: decodes the ground of a pack again. */
#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"
#include "bake_export.h"
#include "../bake/raster/bake_gdal.h"
#include "../bake/bake_say.h"

#define FINEST UINT32_MAX

/* clang-format off */
#define EXPORT_OPTIONS(OPTION) \
    OPTION(sys_text, pack_path, NULL, "PACK", NULL, SYS_FLAGS(SYS_NEEDED), "the pack") \
    OPTION(sys_text, out_path, "output", "FILE", NULL, SYS_FLAGS(SYS_NEEDED | SYS_LETTER), \
           "OUT.tif, OUT.png or OUT.r16") \
    OPTION(sys_whole, level, "level", "L", NULL, SYS_WHOLE(0, FF_KEY_LEVEL_MAX, ""), \
           "0: roots only; default: the finest level") \
    OPTION(sys_flag, quiet, "quiet", NULL, NULL, SYS_ANY, "errors only")
/* clang-format on */

typedef struct export_options {
    EXPORT_OPTIONS(SYS_FIELD)
} export_options;

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(export_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { EXPORT_OPTIONS(ROW) };
#undef ROW

static const sys_program program = {
    .name = "farfield-export",
    .version = FARFIELD_VERSION,
    .usage = "PACK [--level L] -o OUT.tif|OUT.png|OUT.r16",
    .about = "Decodes a pack's ground: GeoTIFF with reference, scale and offset; 16-bit PNG or raw "
             "little-endian 16 bit (top row north) with the height steps alone.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

int main(int argc, char **argv)
{
    export_options options = { .level = FINEST };
    bake_unpack unpack;
    bake_say_setup("farfield-export", 0);
    int rc = sys_options_parse(&program, &options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    bake_say_setup("farfield-export", options.quiet);
    GDALAllRegister();
    CPLSetErrorHandler(CPLQuietErrorHandler);
    if (bake_unpack_open(&unpack, options.pack_path)) return SYS_EXIT_FAILED;
    uint32_t finest = ff_terrain_levels(&unpack.pack.header.info) - 1,
             level = options.level == FINEST ? finest : options.level;
    if (level > finest)
        rc = bake_fail("--level %u: %s has levels 0 to %u", level, options.pack_path, finest);
    else
        rc = bake_export(&unpack, level, options.out_path);
    bake_unpack_close(&unpack);
    return rc ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
