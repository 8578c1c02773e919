#include "c3d_gl_api.h"

#include <string.h>

/* Loads a function. Its address is copied byte by byte from a data pointer to a function pointer: a
 * conversion that ISO C leaves out and every GL needs. */
static int load(void *function, size_t size, const sys_surface_api *surface_api, const char *name)
{
    void *address = surface_api->gl_proc(name);
    memcpy(function, &address, size);
    return address != NULL;
}

int c3d_gl_load(c3d_gl_api *gl, const sys_surface_api *surface_api, int *buffers)
{
    int all = 1;
#define X(result, name, arguments) all &= load(&gl->name, sizeof gl->name, surface_api, "gl" #name);
    C3D_GL_FUNCTIONS(X)
    if (!all) return FF_ERR_UNSUPPORTED;
    C3D_GL_BUFFER_FUNCTIONS(X)
    *buffers = *buffers && all;
    C3D_GL_CLIP_FUNCTIONS(X)
#undef X
    return FF_OK;
}
