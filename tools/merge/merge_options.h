/* What farfield-merge was asked for: a row for each option, see sys_options.h. */
#ifndef MERGE_OPTIONS_H
#define MERGE_OPTIONS_H

#include "../bake/bake_options.h"
#include "merge_lattice.h"

/* clang-format off */
#define MERGE_OPTIONS(OPTION, HEADING) \
    OPTION(sys_texts, pack, NULL, "PACK", NULL, SYS_FLAGS(SYS_NEEDED | SYS_REPEATABLE), "the packs") \
    OPTION(sys_text, out_path, "output", "OUT.ffp", NULL, SYS_FLAGS(SYS_NEEDED | SYS_LETTER), \
           "the pack that they make") \
    HEADING("What the pack says of itself; default: what the packs say, one after the other") \
    BAKE_ABOUT_OPTIONS(OPTION) \
    HEADING("Run") \
    OPTION(sys_whole, texture_quality, "texture-quality", "Q", "75", SYS_WHOLE(1, 100, ""), \
           "JPEG quality of images, which are made anew") \
    BAKE_JOBS_OPTION(OPTION) \
    BAKE_SAY_OPTIONS(OPTION)
/* clang-format on */

typedef struct merge_options {
    MERGE_OPTIONS(SYS_FIELD, SYS_NO_FIELD)
    const char *path[MERGE_PACKS_MAX];
} merge_options;

/* 0: go on; 1: --help or --version answered; -1: wrong usage, said in one line on stderr. */
int merge_options_parse(merge_options *options, int argc, char **argv);

#endif
