#include "export_options.h"

#include "../bake/bake_say.h"
#include "export_pack.h"

#include <stdio.h>

#define NOT_GIVEN UINT32_MAX

/* By number of the enums. */
static const char *const export_voids_words[] = { "keep", "nodata", NULL };
static const char *const export_encoding_words[] = { "auto", "terrarium", "mapbox", NULL };
static const char *const export_picture_words[] = { "jpeg", "png", NULL };

static int take_zooms(const sys_option *option, const char *text, void *field)
{
    uint64_t low, high;
    (void)option;
    if (sys_whole_at(&text, 0, EXPORT_ZOOM_MAX, &low)) return SYS_NOT_ONE;
    high = low;
    if (*text == '-') {
        text++;
        if (sys_whole_at(&text, low, EXPORT_ZOOM_MAX, &high)) return SYS_NOT_ONE;
    }
    if (*text) return SYS_NOT_ONE;
    *(export_zooms *)field = (export_zooms){ (uint32_t)low, (uint32_t)high, 1 };
    return 0;
}

static int zooms_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room, "0 to %d", EXPORT_ZOOM_MAX);
}

const sys_option_type export_zooms_option = { "A-B, A no more than B, ", zooms_range, take_zooms };

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(export_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { EXPORT_OPTIONS(ROW, SYS_HEADING) };
#undef ROW

static const sys_program program = {
    .name = "farfield-export",
    .version = FARFIELD_VERSION,
    .usage = "PACK [OPTION]... -o OUT",
    .about =
        "Writes a pack's ground for other programs: heights, or the images laid over it, as "
        "cloud-optimised GeoTIFF, 16-bit PNG, raw little-endian 16 bit (top row north), or "
        "map tiles. GeoTIFF has place, scale and offset; PNG and raw the height steps alone. A "
        "part as a pack is drawn as the whole is, up to its edge; ground beyond is coarse. "
        "What is written says how far its heights may be off.",
    .more = "Map tiles are those of Web Mercator, 256 pixels wide. Tiles beside the ground are not "
            "written; in tiles that the ground ends in, what lies beyond has the height or colour "
            "of the nearest ground, since maps read heights of clear pixels as they stand; with "
            "--voids nodata it is clear. Meshes are tiles of degrees on WGS84, and the height is 0 "
            "beyond the ground. Memory: about 80 MiB for GDAL and its caches and 2 bytes "
            "x 4^N for tiles of 2^N, whatever the pack's size. Disk: 2 to 4 bytes a sample beside "
            "OUT, or in FARFIELD_TMP or TMPDIR when set.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

int export_options_parse(export_options *o, int argc, char **argv)
{
    *o = (export_options){ .level = NOT_GIVEN };
    bake_say_setup("farfield-export", 0);
    int rc = sys_options_parse(&program, o, argc, argv);
    if (rc) return rc;
    o->has_level = o->level != NOT_GIVEN;
    if (!o->pack_path) return bake_fail("--estimate needs PACK");
    if (o->estimate && o->out_path && !export_pack_is(o->out_path))
        return bake_fail("--estimate tells the size of a part as a pack: -o OUT.ffp, or none");
    if (o->layer && !o->images) return bake_fail("--layer is one of --images");
    if (o->images && o->voids == EXPORT_VOIDS_NODATA)
        return bake_fail("--voids nodata marks heights, not --images");
    if (!o->mesh && (o->mesh_error_m > 0 || o->normals || o->gzip))
        return bake_fail("--mesh-error, --normals and --gzip are for --mesh");
    bake_say_setup("farfield-export", o->quiet);
    return 0;
}
