/* What a pack's heights take for one who fetches all of them and no side of a refinement twice. */
#ifndef BAKE_INFO_SIDES_H
#define BAKE_INFO_SIDES_H

#include "../../protocol/ff_pack.h"

/* Bytes of all roots and refinements; of each the western and the southern side are left out where
 * the node there has a refinement, too. A damaged record counts as none. */
uint64_t bake_info_sides_once(const ff_pack *pack);

#endif
