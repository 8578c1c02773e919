/* Remembers requests that were refused: each is made again a few times, then no more. The memory is
 * short: its oldest entry gives way. */
#ifndef FF_REFUSALS_H
#define FF_REFUSALS_H

#include "ff_request.h"

#define FF_REFUSALS_KEPT  32u
#define FF_REFUSALS_TRIES 3u

typedef struct ff_refusal {
    ff_key key;
    uint8_t kind, tries;
} ff_refusal;
typedef struct ff_refusals {
    ff_refusal entry[FF_REFUSALS_KEPT];
    uint8_t next;
} ff_refusals;

/* `final`: it need not be tried again. */
void ff_refusals_note(ff_refusals *refusals, unsigned kind, ff_key key, int final);
/* 1 when the key was refused FF_REFUSALS_TRIES times: it is not asked for again, and no image below
 * an image is: it may be a difference to it. */
int ff_refusals_final(const ff_refusals *refusals, unsigned kind, ff_key key);

#endif
