/* A tree's wishes answered from a pack in memory: the local source behind the server's renderer,
 * tests and terrains on the device. */
#ifndef FF_PACK_SOURCE_H
#define FF_PACK_SOURCE_H

#include "../../protocol/ff_pack.h"
#include "ff_tree.h"

/* How many grounds a pack has, with those joined to it; and gives a tree that was made for so many,
 * and has the first, the others. FF_OK or an error of ff_tree_add_ground. */
uint32_t ff_pack_source_grounds(const ff_pack *pack);
int ff_pack_source_add(const ff_pack *pack, ff_tree *tree);
/* Bytes of a decoder for all of them. */
size_t ff_pack_source_decoder_bytes(const ff_pack *pack);
/* Reads, decodes and delivers one wish, a root or a refinement; `values` has FF_REFINED_HEIGHTS_MAX
 * entries. FF_OK, or an error of ff_pack_record, of the codec or of the tree. */
int ff_pack_source_serve(const ff_pack *pack, ff_decoder *decoder, int32_t *values, ff_tree *tree,
                         enum ff_kind kind, ff_key key);

#endif
