/* Parts of one pack, as farfield-export --region cuts them, become what they are parts of: records
 * are taken as they are, and a node is a stub only where no part has what is below. */
#ifndef MERGE_PARTS_H
#define MERGE_PARTS_H

#include "../bake/pack_writer.h"
#include "../info/bake_unpack.h"
#include "merge_lattice.h"

/* *are: 1 when the packs tell of one terrain, and one of them has stubs. 0 or -1 (said). */
int merge_parts_are(const bake_unpack unpack[], uint32_t count, int *are);
/* Puts all records of the parts into a writer of their terrain. 0 or -1 (said): they differ. */
int merge_parts_write(const bake_unpack unpack[], uint32_t count, pack_writer *writer);

#endif
