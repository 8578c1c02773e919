#include "surface_local.h"

static _Thread_local sys_surface *current;
static _Thread_local void (*current_release)(void);

void sys_surface_take(sys_surface *surface, void (*release)(void))
{
    if (current) current_release();
    current = surface;
    current_release = release;
}

void sys_surface_drop(sys_surface *surface)
{
    if (current == surface) sys_surface_take(NULL, NULL);
}
