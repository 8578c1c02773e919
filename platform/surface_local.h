/* Shared by the surfaces (egl, osmesa, glfw): one thread has one current context, whichever library made it. */
#ifndef SURFACE_LOCAL_H
#define SURFACE_LOCAL_H

/* Says that a context is about to become current on this thread and how it is let go of. The previous one is let go of first:
 * each library believes its last context still current, and would skip the switch back to it. */
void sys_surface_take(void (*release)(void));

#endif
