/* The whole export: from a pack to a raster or to map tiles. */
#ifndef EXPORT_RUN_H
#define EXPORT_RUN_H

#include "export_options.h"

/* 0 or -1 (said). */
int export_run(const export_options *options);

#endif
