/* Shared by ff_intake*.c only. */
#ifndef FF_INTAKE_LOCAL_H
#define FF_INTAKE_LOCAL_H

#include "ff_intake.h"

/* A new item that answers `request`, with room for an image when `image`; NULL: the list is full.
 */
ff_new_item *ff_intake_begin(ff_intake *intake, const ff_request *request, int image,
                             uint32_t bytes);
/* Hands an item to the main thread. FF_OK. */
int ff_intake_put(ff_intake *intake, ff_new_item *item);

#endif
