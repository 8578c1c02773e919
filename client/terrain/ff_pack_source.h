/* A tree's wishes answered from a pack in memory: the local source behind the server's renderer,
 * tests and terrains on the device. */
#ifndef FF_PACK_SOURCE_H
#define FF_PACK_SOURCE_H

#include "../../protocol/ff_pack.h"
#include "ff_tree.h"

/* Reads, decodes and delivers one wish, a root or a refinement; `values` has FF_REFINED_HEIGHTS_MAX
 * entries. FF_OK, or an error of ff_pack_record, of the codec or of the tree. */
int ff_pack_source_serve(const ff_pack *pack, ff_decoder *decoder, int32_t *values, ff_tree *tree,
                         enum ff_kind kind, ff_key key);

#endif
