/* A terrain on this device: the same requests, answered from a pack in memory, without a link. */
#ifndef FF_LOCAL_H
#define FF_LOCAL_H

#include "../ask/ff_intake.h"
#include "../../protocol/ff_pack.h"

/* Answers queued requests, the most urgent first, until the new-data list is full. 1 when any was
 * answered. */
int ff_local_step(ff_intake *intake, const ff_pack *pack, int prefetch, int64_t now_us);

#endif
