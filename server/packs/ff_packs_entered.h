/* The packs of one session, entered below their tops for a view that ends near (ff_entry.h). */
#ifndef FF_PACKS_ENTERED_H
#define FF_PACKS_ENTERED_H

#include "../../protocol/ff_pack.h"

typedef struct ff_packs_entered ff_packs_entered;

/* `pack` and those joined to it, which stay where they are, for views that reach so far along each
 * axis. FF_OK and *entered; NULL where none of them is entered below its top. FF_ERR_MEMORY. */
int ff_packs_enter(const ff_pack *pack, int32_t reach_wu, ff_packs_entered **entered);
/* The first of them, joined with the others. One thread reads at a time. */
const ff_pack *ff_packs_entered_first(const ff_packs_entered *entered);
void ff_packs_leave(ff_packs_entered *entered); /* NULL: nothing */

#endif
