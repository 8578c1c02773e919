#include "view_options.h"

#include "view_fly.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define PLACE_M_MAX 8e6 /* 32 bits of 1/256 m */

static const char *const backend_words[] = { "gles1", "gl", "soft", NULL };
static const char *const no_link_words[] = { "none", NULL };

static int take_place(const sys_option *option, const char *text, void *field)
{
    double x, y, h = VIEW_START_ABOVE_WU / FF_WU_PER_METRE;
    int end = 0;
    int got = sscanf(text, "%lf,%lf%n,%lf%n", &x, &y, &end, &h, &end);
    (void)option;
    if (got < 2 || text[end] || !(x > -PLACE_M_MAX && x < PLACE_M_MAX) ||
        !(y > -PLACE_M_MAX && y < PLACE_M_MAX) || !(h >= 0 && h <= SIM_HEIGHT_M_MAX))
        return SYS_NOT_ONE;
    *(view_place *)field = (view_place){ .given = 1,
                                         .x_wu = (int32_t)(x * FF_WU_PER_METRE),
                                         .y_wu = (int32_t)(y * FF_WU_PER_METRE),
                                         .above_wu = (int32_t)(h * FF_WU_PER_METRE) };
    return 0;
}

static int place_range(const sys_option *option, char *text, size_t room)
{
    (void)option;
    return snprintf(text, room,
                    "metres from the south-west corner, less than %.0f, and metres above ground, "
                    "0 to %d",
                    PLACE_M_MAX, SIM_HEIGHT_M_MAX);
}

const sys_option_type view_place_option = { "X,Y[,H], ", place_range, take_place };

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(view_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { VIEW_OPTIONS(ROW, SYS_HEADING, FF_SHOW_MODES(SIM_SHOW_ROW)) };
#undef ROW

static const sys_program program = {
    .name = "farfield-view",
    .version = FARFIELD_VERSION,
    .usage = "[OPTION]... ADDR:PORT | PACK",
    .about = "Flies over terrain from a server or a pack: the desktop emulator.",
    .more = "Keys: F1 lists them in the window.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

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

int view_options_parse(view_options *o, int argc, char **argv)
{
    *o = (view_options){ .use_far = SYS_UNSET,
                         .use_panorama = SYS_UNSET,
                         .place = { .above_wu = VIEW_START_ABOVE_WU },
                         .packs = { o->pack, 0, FF_SOURCES_MAX },
                         .quality = { .view_wu = INT32_MAX } };
    int rc = sys_options_parse(&program, o, argc, argv);
    if (rc) return rc;
    sim_client_read(&o->quality_text, o->triangles, &o->size, o->balance_text, &o->quality,
                    &o->balance);
    o->far_given = o->use_far > FF_FAR_OFF;
    sim_far_read(&o->balance, &o->use_far, &o->use_panorama);
    o->far = SIM_FAR_DESC(o);
    o->fov_brad16 = (int32_t)(o->fov_degrees * 65536 / 360 + 0.5);
    o->yaw_brad16 = (int32_t)(o->yaw_degrees * 65536 / 360) & 65535;
    if (o->script && o->keys) return view_fail("--script and --keys exclude each other");
    if (!o->target && !o->packs.count)
        return view_fail("ADDR:PORT or a pack is wanted; try --help");
    if (!o->target) { /* the first pack is */
        o->target = o->packs.text[0];
        o->packs.text++;
        o->packs.count--;
    }
    if (o->packs.count >= FF_SOURCES_MAX)
        return view_fail("--pack: at most %d besides %s", FF_SOURCES_MAX - 1, o->target);
    return 0;
}
