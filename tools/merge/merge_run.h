/* The whole merge: packs to one pack. */
#ifndef MERGE_RUN_H
#define MERGE_RUN_H

#include "merge_options.h"

/* 0 or -1 (said); writes the pack, and with --json the summary on stdout. */
int merge_run(const merge_options *options);

#endif
