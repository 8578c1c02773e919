/* What the joint pack says of itself: what its packs say, each word once. */
#ifndef MERGE_ABOUT_H
#define MERGE_ABOUT_H

#include "../info/bake_unpack.h"
#include "merge_options.h"

/* Writes the list: texts as told by options, else those of the packs, different ones in their order
 * with "; " between; the reference system of the first that tells it. 0 or -1 (said): a text would
 * be too long, or what a pack says is damaged. */
int merge_about_make(const merge_options *options, const bake_unpack unpack[], uint32_t count,
                     uint8_t list[FF_ABOUT_BYTES_MAX], ff_list *about);
/* 1 when two packs have the same reference system, or both have none: by its code, else by its
 * words. */
int merge_about_same_system(const ff_pack *a, const ff_pack *b);

#endif
