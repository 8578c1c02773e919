/* Which field of a terrain is out of range, and what its range is, in words. */
#ifndef BAKE_FAULT_H
#define BAKE_FAULT_H

#include "../../protocol/ff_terrain.h"

#include <stddef.h>

/* 1 and "spacing_wu 600000 is not from 1 to 524287" in `text` when ff_terrain_check finds a field
 * out of range; else 0. */
int bake_fault(const ff_terrain_info *info, char *text, size_t room);

#endif
