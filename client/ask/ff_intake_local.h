/* How each kind is taken in by the worker; shared by ff_intake*.c only. */
#ifndef FF_INTAKE_LOCAL_H
#define FF_INTAKE_LOCAL_H

#include "ff_intake.h"

/* One kind's answer into `item`, whose head is filled in. FF_OK; an error of the payload, which the
 * item then tells; or FF_ERR_AGAIN: no image slot is free, try the whole answer later. */
#define X(kind, name, ...) \
    int ff_intake_##name(ff_intake *intake, const ff_message *answer, ff_new_item *item);
FF_KIND_LIST(X)
#undef X

#endif
