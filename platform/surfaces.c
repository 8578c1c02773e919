#include "surface_local.h"

#include <stddef.h>

static _Thread_local void (*current_release)(void);

void sys_surface_take(void (*release)(void))
{
    if (current_release) current_release();
    current_release = release;
}
