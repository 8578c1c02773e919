/* farfield-info: what is inside a pack. */
#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"
#include "bake_info.h"
#include "../bake/bake_say.h"
#include "bake_unpack.h"

#include <inttypes.h>
#include <stdio.h>

/* clang-format off */
#define INFO_OPTIONS(OPTION) \
    OPTION(sys_text, path, NULL, "PACK", NULL, SYS_FLAGS(SYS_NEEDED), "the pack") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "as JSON") \
    OPTION(sys_flag, verify, "verify", NULL, NULL, SYS_ANY, \
           "checks every record's checksum and decodes every height")
/* clang-format on */

typedef struct info_options {
    INFO_OPTIONS(SYS_FIELD)
} info_options;

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(info_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { INFO_OPTIONS(ROW) };
#undef ROW

static const sys_program program = {
    .name = "farfield-info",
    .version = FARFIELD_VERSION,
    .usage = "[--json] [--verify] PACK",
    .about = "Shows what a pack holds: its terrain, and bytes and bits a sample by level.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

static int want_all(void *context, ff_key key) { return (void)context, (void)key, 1; }

static int leave(void *context, ff_key key, uint32_t side, const uint16_t *heights,
                 const uint8_t *known)
{
    return (void)context, (void)key, (void)side, (void)heights, (void)known, 0;
}

/* Checks the checksums of all records, then decodes every tile: intact bytes may still make no
 * sense. */
static int verify(const bake_unpack *unpack)
{
    const bake_unpack_walk walk = { .wants = want_all, .take = leave };
    uint64_t bad;
    int rc = ff_pack_verify(&unpack->pack, &bad);
    if (rc == FF_ERR_CHECKSUM && bad)
        return bake_fail("%s: %" PRIu64 " damaged records", unpack->path, bad);
    if (rc == FF_ERR_CHECKSUM) return bake_fail("%s: %s", unpack->path, ff_error_text(rc));
    if (rc) /* its bytes are sound, and records are */
        return bake_fail("%s: what it says of itself: %s", unpack->path, ff_error_text(rc));
    return bake_unpack_heights(unpack, ff_terrain_levels(&unpack->pack.header.info) - 1, &walk);
}

int main(int argc, char **argv)
{
    info_options options = { 0 };
    bake_unpack unpack;
    bake_say_setup("farfield-info", 0);
    int rc = sys_options_parse(&program, &options, argc, argv);
    if (rc) return rc < 0 ? SYS_EXIT_USAGE : SYS_EXIT_DONE;
    if (bake_unpack_open(&unpack, options.path)) return SYS_EXIT_FAILED;
    if (options.verify) rc = verify(&unpack);
    if (!rc && options.json)
        bake_info_print_json(&unpack.pack);
    else if (!rc)
        bake_info_print(&unpack.pack, options.path);
    if (!rc && options.verify && !options.json) puts("verified: every record is whole and decodes");
    bake_unpack_close(&unpack);
    return rc ? SYS_EXIT_FAILED : SYS_EXIT_DONE;
}
