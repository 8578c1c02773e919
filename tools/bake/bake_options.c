#include "bake_options.h"

#include "bake_say.h"
#include "raster/bake_about.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RAW_SIDE_MAX     (1u << 24)
#define EPSG_MAX         999999
#define JOBS_DEFAULT_MAX 16

/* By number. */
#define ROW(number, constant, name, ...) name,
static const char *const codec_words[] = { FF_CODEC_LIST(ROW) NULL };
#undef ROW

static const char *const image_codec_words[] = { "picture", "jpeg", NULL };

/* By number of enum bake_rgb_word. */
static const char *const rgb_words[] = { "auto", "mapbox", "terrarium", "none", NULL };

/* What follows `word` in *text: 1, and *text behind it. */
static int skip(const char **text, const char *word)
{
    size_t length = strlen(word);
    if (strncmp(*text, word, length)) return 0;
    *text += length;
    return 1;
}

static int take_raw(const sys_option *option, const char *text, void *field)
{
    uint64_t width, height;
    bake_raw raw = { 0 };
    (void)option;
    if (sys_whole_at(&text, 1, RAW_SIDE_MAX, &width) || !skip(&text, "x") ||
        sys_whole_at(&text, 1, RAW_SIDE_MAX, &height))
        return SYS_NOT_ONE;
    raw.width = (uint32_t)width;
    raw.height = (uint32_t)height;
    while (*text)
        if (skip(&text, ":le"))
            raw.big_endian = 0;
        else if (skip(&text, ":be"))
            raw.big_endian = 1;
        else if (skip(&text, ":u16"))
            raw.is_signed = 0;
        else if (skip(&text, ":s16"))
            raw.is_signed = 1;
        else
            return SYS_NOT_ONE;
    *(bake_raw *)field = raw;
    return 0;
}

static int raw_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room, "each side 1 to %u", RAW_SIDE_MAX);
}

static int take_nodata(const sys_option *option, const char *text, void *field)
{
    bake_nodata nodata = { .is_given = 1, .is_none = !strcmp(text, "none") };
    char *end = (char *)text;
    (void)option;
    if (!nodata.is_none) nodata.value = strtod(text, &end);
    if (!nodata.is_none && (end == text || *end)) return SYS_NOT_ONE;
    *(bake_nodata *)field = nodata;
    return 0;
}

/* W,S,E,N; from 180 W to 180 E, and the end of the map in the north and the south. */
static int take_box(const sys_option *option, const char *text, void *field)
{
    double number[4];
    char *end = (char *)text;
    (void)option;
    for (int i = 0; i < 4; i++) {
        number[i] = strtod(text, &end);
        if (end == text || !(fabs(number[i]) <= (i & 1 ? 90 : 180))) return SYS_NOT_ONE;
        if (*end != (i < 3 ? ',' : 0)) return SYS_NOT_ONE;
        text = end + 1;
    }
    if (!(number[1] < number[3]) || number[0] == number[2]) return SYS_NOT_ONE;
    *(bake_box *)field = (bake_box){ number[0], number[1], number[2], number[3], 1 };
    return 0;
}

static int take_epsg(const sys_option *option, const char *text, void *field)
{
    uint64_t code;
    (void)option;
    if (!skip(&text, "EPSG:")) (void)skip(&text, "epsg:");
    if (sys_whole_at(&text, 1, EPSG_MAX, &code) || *text) return SYS_NOT_ONE;
    *(bake_epsg *)field = (int)code;
    return 0;
}

static int epsg_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room, "N 1 to %u", EPSG_MAX);
}

static int take_power_two(const sys_option *option, const char *text, void *field)
{
    uint32_t number;
    if (sys_whole_option.take(option, text, &number) || number & (number - 1)) return SYS_NOT_ONE;
    *(bake_power_two *)field = number;
    return 0;
}

static int power_two_range(const sys_option *option, char *text, size_t room)
{
    char range[64];
    (void)sys_whole_option.range(option, range, sizeof range);
    return snprintf(text, room, "a power of two, %s", range);
}

const sys_option_type bake_raw_option = { "WxH[:le|be][:u16|s16], ", raw_range, take_raw },
                      bake_nodata_option = { "a number or none", NULL, take_nodata },
                      bake_box_option = { "W,S,E,N in degrees, S below N", NULL, take_box },
                      bake_epsg_option = { "EPSG:N, ", epsg_range, take_epsg },
                      bake_power_two_option = { "", power_two_range, take_power_two };

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(bake_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { BAKE_OPTIONS(ROW, SYS_HEADING) };
#undef ROW

static const sys_program program = {
    .name = "farfield-bake",
    .version = FARFIELD_VERSION,
    .usage = "HEIGHTS [OPTION]... -o OUT.ffp",
    .about =
        "Makes a Farfield pack from a raster of heights: any raster GDAL reads, map tiles of "
        "encoded heights (PMTiles, MBTiles, folders), or raw 16 bit. Degrees, and planes far from "
        "true to scale, are projected to the local UTM zone; voids are filled and counted.",
    .more = "Memory: about 130 MiB for GDAL and its caches (more for inputs packed in large "
            "blocks), plus 9 MiB a job, whatever the raster's size and the tiles'. "
            "Disk while baking: about 12 bytes a sample beside OUT.ffp, or in FARFIELD_TMP or "
            "TMPDIR when set.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

uint32_t bake_processors(void)
{
    long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count < 1 ? 1 : count > JOBS_DEFAULT_MAX ? JOBS_DEFAULT_MAX : (uint32_t)count;
}

int bake_options_parse(bake_options *o, int argc, char **argv)
{
    *o = (bake_options){ .jobs = bake_processors(),
                         .refraction = NAN,
                         .void_height_m = NAN,
                         .rim_void_height_m = NAN,
                         .layers = { o->layer_text, 0, FF_LAYERS_MAX } };
    bake_say_setup("farfield-bake", 0);
    int rc = sys_options_parse(&program, o, argc, argv);
    if (rc) return rc;
    if (!o->heights_path) return bake_fail("HEIGHTS is missing; try --help");
    if (o->tile_log2 &&
        (o->tile_log2 < o->node_log2 || o->tile_log2 > o->node_log2 + FF_KEY_LEVEL_MAX))
        return bake_fail("--tile-log2 %u: not from --node-log2 %u up", o->tile_log2, o->node_log2);
    if (o->rms_error_m > 0 && (o->max_error_m > 0 || o->estimate))
        return bake_fail("--rms-error chooses --max-error, by baking: not with that, nor with "
                         "--estimate");
    if (o->no_project && o->target_epsg)
        return bake_fail("--no-project and --t-srs exclude each other");
    if (o->lattice_path && (o->target_epsg || o->no_project || o->hscale_m > 0 || o->densify > 1))
        return bake_fail("--lattice takes all that --t-srs, --no-project, --hscale and --densify "
                         "tell from its pack");
    bake_texts told = BAKE_TEXTS(o);
    if (bake_about_check(&told)) return -1;
    bake_say_setup("farfield-bake", o->quiet);
    return 0;
}
