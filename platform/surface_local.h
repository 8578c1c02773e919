/* Shared by the surfaces (egl, osmesa, glfw): one thread has one current context, whichever library
 * made it. */
#ifndef SURFACE_LOCAL_H
#define SURFACE_LOCAL_H

#include "sys.h"

/* Says that the context of `surface` is about to become current on this thread, and how the context
 * is let go of. The previous context is let go of first: its library would believe it still
 * current, and skip a later switch back to it. */
void sys_surface_take(sys_surface *surface, void (*release)(void));
/* Lets go of the context of `surface` if it is the current one: before it is destroyed. */
void sys_surface_drop(sys_surface *surface);

#endif
