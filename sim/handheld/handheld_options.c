#include "handheld.h"

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(handheld_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { HANDHELD_OPTIONS(ROW) };
#undef ROW

static const sys_program program = {
    .name = "farfield-handheld",
    .version = FARFIELD_VERSION,
    .usage = "--pack PACK | --server ADDR:PORT | --tape FILE [OPTION]...",
    .about = "The client as it runs on a handheld: integers only, no GPU, one block of memory. "
             "Ends with its statistics on stdout.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

static int fail(const char *what) { return sys_options_fail(&program, "%s", what); }

int handheld_options_parse(handheld_options *options, int argc, char **argv)
{
    *options = (handheld_options){ .use_far = SYS_UNSET,
                                   .use_panorama = SYS_UNSET,
                                   .quality = { .view_wu = INT32_MAX } };
    int rc = sys_options_parse(&program, options, argc, argv);
    if (rc) return rc;
    sim_client_read(&options->quality_text, options->triangles, &options->size,
                    options->balance_text, &options->quality, &options->balance);
    sim_far_read(&options->balance, &options->use_far, &options->use_panorama);
    options->panorama.enabled = (uint8_t)options->use_panorama;
    options->far = SIM_FAR_DESC(options);
    if (!options->pack_path + !options->server + !options->tape_path != 2)
        return fail("one of --pack, --server and --tape is wanted; try --help");
    if (options->plan && !options->pack_path) return fail("--plan: --pack is wanted with it");
    if (options->map_m && !options->pack_path) return fail("--map: --pack is wanted with it");
    if (options->to.given && !options->at.given) return fail("--to needs --at");
    if (options->at.given && options->tape_path) return fail("--at: not with --tape");
    if (options->tape_path && options->balance.mode != FF_BALANCE_OFF)
        return fail("--balance: not with --tape");
    if ((options->fb_path || options->hash) && options->no_pictures)
        return fail("--fb and --hash: there are no pictures with --no-pictures");
    return 0;
}
