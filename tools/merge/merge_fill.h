/* Heights for where no pack reaches, from what lies around. */
#ifndef MERGE_FILL_H
#define MERGE_FILL_H

#include "merge_samples.h"

/* Makes the fill of samples whose packs are open. 0 or -1 (said). */
int merge_fill_make(merge_samples *samples);

#endif
