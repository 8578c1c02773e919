/* A part of a pack as a pack: all that its ground needs to be drawn down to a level up to the
 * part's edge, and what lies above. Payloads stay as they are, but for marks where finer ground is
 * left out; nothing is decoded. */
#ifndef EXPORT_PACK_H
#define EXPORT_PACK_H

#include "../info/bake_unpack.h"
#include "export_options.h"

/* 1 when a path is to be a pack. */
int export_pack_is(const char *path);
/* 0, or -1 (said): the options do not go with a pack. */
int export_pack_check(const export_options *options);
/* Writes the pack, or, with --estimate, tells its size. 0 or -1 (said). */
int export_pack_write(const export_options *options, const bake_unpack *unpack, uint32_t level);

#endif
