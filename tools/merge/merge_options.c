#include "merge_options.h"

#include "../bake/bake_say.h"
#include "../bake/raster/bake_about.h"

#define ROW(type, field, name, value, fallback, range, help) \
    SYS_OPTION(merge_options, type, field, name, value, fallback, help, range)
static const sys_option row[] = { MERGE_OPTIONS(ROW, SYS_HEADING) };
#undef ROW

static const sys_program program = {
    .name = "farfield-merge",
    .version = FARFIELD_VERSION,
    .usage = "PACK PACK... [OPTION]... -o OUT.ffp",
    .about =
        "Joins packs on one lattice to one pack: parts that were baked apart, fine ground in coarse "
        "ground, or parts cut from one pack by farfield-export --region. Where packs lie over each "
        "other the finer one holds, else the one named first; heights stay bit for bit, and ground "
        "that was filled gives way. Parts of a raster give the pack that the raster gives in one "
        "piece.",
    .more = "Packs are on one lattice when they have the same reference system and height step, "
            "spacings a power of two apart, and the coarser ones' samples among the places of the "
            "finer ones: farfield-bake --lattice PACK makes such packs. What no pack covers within "
            "the rectangle round all of them is filled from around it, and told as filled. Memory: "
            "as farfield-bake. Disk: 2 to 4 bytes a sample of the packs beside OUT.ffp, or in "
            "FARFIELD_TMP or TMPDIR when set.",
    .option = row,
    .option_count = sizeof row / sizeof *row
};

int merge_options_parse(merge_options *o, int argc, char **argv)
{
    *o = (merge_options){ .jobs = bake_processors() };
    o->pack = (sys_texts){ .text = o->path, .room = MERGE_PACKS_MAX };
    bake_say_setup("farfield-merge", 0);
    int rc = sys_options_parse(&program, o, argc, argv);
    if (rc) return rc;
    bake_texts told = BAKE_TEXTS(o);
    if (bake_about_check(&told)) return -1;
    bake_say_setup("farfield-merge", o->quiet);
    return 0;
}
