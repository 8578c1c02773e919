#include "fly_options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const fly_backend_words[] = { "gles1", "gl", "soft", "soft565", "none", NULL };
static const char *const fly_hidden_words[] = { "left-out", "drawn", "fetched", NULL };
static const char *const path_words[] = { "diagonal", "circle", "hover", "turn", NULL };

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(fly_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { FLY_OPTIONS(ROW, SYS_HEADING, FF_SHOW_MODES(SIM_SHOW_ROW)) };
#undef ROW

static const sys_program program = {
    .name = "farfield-fly",
    .version = FARFIELD_VERSION,
    .usage = "--pack PACK [OPTION]...",
    .about = "Flies over a pack: server, link and client in one process over simulated time. The "
             "same options give the same bytes, the same CSV and the same pictures every time. "
             "With --server the same flight goes against a real server in real time.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

static int fail(const char *what) { return sys_options_fail(&program, "%s", what); }

/* What is not said follows from what is. */
static void complete(fly_options *options)
{
    options->pack_path = options->pack[0];
    if (options->audit)
        options->truth_path = options->truths.count ? options->truth[0] : options->pack[0];
    (void)sim_link_parse(options->link_text, &options->link);
    options->link.way[SIM_DOWN].trace = options->down_trace;
    options->link.way[SIM_UP].trace = options->up_trace;
    options->quality.view_wu = options->view_m > 0 ? (int32_t)(options->view_m * FF_WU_PER_METRE)
                                                   : INT32_MAX;
    sim_client_read(&options->quality_text, options->triangles, &options->size,
                    options->balance_text, &options->quality, &options->balance);
    sim_far_read(&options->balance, &options->use_far, &options->use_panorama);
    options->panorama =
        (ff_panorama_desc){ .enabled = (uint8_t)options->use_panorama,
                            .back_plane_wu = (int32_t)(options->back_plane_m * FF_WU_PER_METRE),
                            .face_size = (uint16_t)options->face_texels };
    options->far = SIM_FAR_DESC(options);
    int path = sys_word_index(path_words, options->path_text);
    options->path = options->to.given ? FLY_STRAIGHT
                    : path < 0        ? FLY_RECORDED
                                      : (enum fly_path_kind)path;
    if (options->check == SYS_UNSET) options->check = options->audit;
}

/* A tape holds cameras, what the link did, and layers chosen: no other way to the client. */
static int fits_tape(const fly_options *options)
{
    for (unsigned i = 0; i < options->events.count; i++) switch (options->events.event[i].kind) {
            case FLY_LOW_BATTERY:
            case FLY_BATTERY_OK:
            case FLY_INTERRUPTION:
            case FLY_RESUME:
            case FLY_PANORAMA_ON:
            case FLY_PANORAMA_OFF:
            case FLY_BUDGET: return 0;
            default: break;
        }
    return 1;
}

int fly_options_parse(fly_options *options, int argc, char **argv)
{
    *options = (fly_options){ .seconds = -1,
                              .use_far = SYS_UNSET,
                              .use_panorama = SYS_UNSET,
                              .check = SYS_UNSET,
                              .packs = { options->pack, 0, FF_WELCOME_GROUNDS },
                              .locals = { options->local, 0, FF_SOURCES_MAX - 1 },
                              .truths = { options->truth, 0, FF_WELCOME_GROUNDS } };
    int rc = sys_options_parse(&program, options, argc, argv);
    if (rc) return rc;
    complete(options);
    if (options->to.given && !options->at.given) return fail("--to needs --at");
    if (options->to.given && strcmp(options->path_text, path_words[FLY_DIAGONAL]))
        return fail("--to is a path of its own: without --path");
    if (options->at.given && options->path == FLY_RECORDED)
        return fail("--at: a recorded flight begins where it began");
    if (options->tape_path && (options->server || !fits_tape(options) || options->events_path ||
                               options->balance.mode != FF_BALANCE_OFF))
        return fail("--tape records simulated flights without --balance, --events and events of "
                    "battery, interruption, panorama and budget");
    if (options->locals.count && options->tape_path)
        return fail("--tape records flights of one source: without --local");
    if (options->truths.count && !options->audit) return fail("--truth needs --audit on");
    if (options->truths.count > options->packs.count) return fail("--truth: one for each --pack");
    if (options->reference_dir && !options->png_dir) return fail("--reference needs --png");
    if (options->png_dir && options->backend == FLY_NONE)
        return fail("--png needs a --backend other than none");
    if (options->diff && options->backend == FLY_NONE)
        return fail("--diff needs a --backend other than none");
    return 0;
}

/* An event on each line. */
static int load_events(fly_options *options, FILE *file)
{
    char line[1024];
    for (unsigned number = 1; fgets(line, sizeof line, file); number++) {
        line[strcspn(line, "#\r\n")] = '\0';
        char *first = line + strspn(line, " \t"), *last = first + strlen(first);
        while (last > first && (last[-1] == ' ' || last[-1] == '\t')) *--last = '\0';
        int rc = *first ? fly_events_option.take(NULL, first, &options->events) : 0;
        if (rc)
            return sys_options_fail(&program, "%s:%u: %s: %s", options->events_path, number, first,
                                    rc == SYS_TOO_MANY ? "too many events" : "not an event");
    }
    return 0;
}

int fly_options_load(fly_options *options)
{
    if (options->events_path) {
        FILE *file = fopen(options->events_path, "r");
        if (!file)
            return sys_options_fail(&program, "%s: %s", options->events_path, strerror(errno));
        int rc = load_events(options, file);
        fclose(file);
        if (rc) return rc;
    }
    if (options->path == FLY_RECORDED) {
        const fly_recording *recording = &options->recording;
        if (fly_recording_read(&options->recording, options->path_text)) return -1;
        if (options->seconds < 0)
            options->seconds = fmax(0,
                                    recording->fix[recording->count - 1].t_s - options->settle_s);
    }
    options->until_there = options->seconds < 0 && options->path == FLY_STRAIGHT;
    if (options->seconds < 0) options->seconds = 300;
    return 0;
}

void fly_options_free(fly_options *options) { fly_recording_free(&options->recording); }

const char *fly_backend_name(enum fly_backend backend) { return fly_backend_words[backend]; }

static void print_spot(const char *name, const sim_spot *spot)
{
    if (!spot->given) return;
    fprintf(stderr, ", %s %.9f,%.9f", name, (double)spot->latitude_e9 / 1e9,
            (double)spot->longitude_e9 / 1e9);
    if (spot->above_wu >= 0) fprintf(stderr, ",%g", (double)spot->above_wu / FF_WU_PER_METRE);
}

void fly_options_print(const fly_options *options)
{
    fprintf(stderr,
            "farfield-fly: seed %llu, pack %s, %s %s, %g km/h, %g s after %g s, %s from %g, "
            "%g m up, quality %s, panorama %s, far %s, balance %s, %ux%u at %g degrees, %u fps, "
            "backend %s, %u bytes, audit %s%s%s",
            (unsigned long long)options->seed, options->pack_path,
            options->server ? "server" : "link",
            options->server ? options->server : options->link_text, options->speed_kmh,
            options->seconds, options->settle_s, options->path_text, options->start,
            options->height_m, options->quality_text, sim_panorama_words[options->use_panorama],
            sim_far_words[options->use_far], options->balance_text, options->size.width,
            options->size.height, options->fov_degrees, options->fps,
            fly_backend_name((enum fly_backend)options->backend), options->memory_bytes,
            options->audit ? "on" : "off", options->truths.count ? " by " : "",
            options->truths.count ? options->truth_path : "");
    print_spot("at", &options->at);
    print_spot("to", &options->to);
    fputc('\n', stderr);
}
