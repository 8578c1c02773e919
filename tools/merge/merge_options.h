/* What farfield-merge was asked for: a row for each option, see sys_options.h. */
#ifndef MERGE_OPTIONS_H
#define MERGE_OPTIONS_H

#include "../../client/farfield.h"
#include "../../platform/options/sys_options.h"
#include "merge_lattice.h"

/* clang-format off */
#define MERGE_OPTIONS(OPTION, HEADING) \
    OPTION(sys_texts, pack, NULL, "PACK", NULL, SYS_FLAGS(SYS_NEEDED | SYS_REPEATABLE), "the packs") \
    OPTION(sys_text, out_path, "output", "OUT.ffp", NULL, SYS_FLAGS(SYS_NEEDED | SYS_LETTER), \
           "the pack that they make") \
    HEADING("What the pack says of itself; default: what the packs say, one after the other") \
    OPTION(sys_text, name, "name", "TEXT", NULL, SYS_ANY, "what ground it is") \
    OPTION(sys_text, attribution, "attribution", "TEXT", NULL, SYS_ANY, \
           "whose it is, as it is to be shown") \
    OPTION(sys_text, licence, "licence", "TEXT", NULL, SYS_ANY, "what may be done with it") \
    OPTION(sys_text, date, "date", "TEXT", NULL, SYS_ANY, "of the source") \
    OPTION(sys_text, vertical_datum, "vertical-datum", "TEXT", NULL, SYS_ANY, \
           "what heights are above") \
    HEADING("Run") \
    OPTION(sys_whole, texture_quality, "texture-quality", "Q", "75", SYS_WHOLE(1, 100, ""), \
           "JPEG quality of images, which are made anew") \
    OPTION(sys_whole, jobs, "jobs", "N", NULL, SYS_WHOLE(1, 64, ""), \
           "threads; default: the processors, at most 16; any N gives the same bytes") \
    OPTION(sys_flag, json, "json", NULL, NULL, SYS_ANY, "a summary on stdout") \
    OPTION(sys_flag, quiet, "quiet", NULL, NULL, SYS_ANY, "errors only")
/* clang-format on */

typedef struct merge_options {
    MERGE_OPTIONS(SYS_FIELD, SYS_NO_FIELD)
    const char *path[MERGE_PACKS_MAX];
} merge_options;

/* 0: go on; 1: --help or --version answered; -1: wrong usage, said in one line on stderr. */
int merge_options_parse(merge_options *options, int argc, char **argv);

#endif
