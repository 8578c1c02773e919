/* How much of a pack's ground a layer of images covers. */
#ifndef BAKE_INFO_COVER_H
#define BAKE_INFO_COVER_H

#include "../../protocol/ff_pack.h"

/* Its share, 0 to 1: what lies in no node that is told to be open (ff_image_marks). What is damaged
 * counts as covered. */
double bake_info_covered(const ff_pack *pack, unsigned layer);

#endif
