/* Off-screen desktop GL by OSMesa: a context and a plain buffer in memory, no window system, no
 * EGL. */
#include "../surface_local.h"
#include "../sys.h"

#include <GL/osmesa.h>
#include <stdlib.h>

struct sys_surface {
    OSMesaContext context;
    void *pixels; /* RGBA8888, bottom row first */
    int width, height;
};

static void osmesa_release(void) { OSMesaMakeCurrent(NULL, NULL, 0, 0, 0); }

static int osmesa_make_current(sys_surface *surface)
{
    sys_surface_take(surface, osmesa_release);
    return OSMesaMakeCurrent(surface->context, surface->pixels, GL_UNSIGNED_BYTE, surface->width,
                             surface->height)
               ? FF_OK
               : FF_ERR_SYSTEM;
}

static void osmesa_close(sys_surface *surface)
{
    sys_surface_drop(surface);
    if (surface->context) OSMesaDestroyContext(surface->context);
    free(surface->pixels);
    free(surface);
}

static int osmesa_open(const sys_surface_desc *desc, sys_surface **surface)
{
    static const int attributes[] = { OSMESA_FORMAT,
                                      OSMESA_RGBA,
                                      OSMESA_DEPTH_BITS,
                                      24,
                                      OSMESA_STENCIL_BITS,
                                      0,
                                      OSMESA_ACCUM_BITS,
                                      0,
                                      OSMESA_PROFILE,
                                      OSMESA_COMPAT_PROFILE,
                                      0,
                                      0 };
    if (desc->gl != SYS_GL_DESKTOP) return FF_ERR_UNSUPPORTED;
    if (desc->width < 1 || desc->height < 1 || desc->width > 4096 || desc->height > 4096)
        return FF_ERR_ARGUMENT;
    sys_surface *opened = calloc(1, sizeof *opened);
    if (!opened) return FF_ERR_MEMORY;
    opened->width = desc->width;
    opened->height = desc->height;
    opened->pixels = calloc((size_t)desc->width * (size_t)desc->height, 4);
    opened->context = OSMesaCreateContextAttribs(attributes, NULL);
    int rc = !opened->pixels    ? FF_ERR_MEMORY
             : !opened->context ? FF_ERR_SYSTEM
                                : osmesa_make_current(opened);
    if (rc < 0) {
        osmesa_close(opened);
        return rc;
    }
    *surface = opened;
    return FF_OK;
}

static void *osmesa_proc(const char *name)
{
    union {
        OSMESAproc function;
        void *address;
    } proc = { OSMesaGetProcAddress(name) };
    return proc.address;
}

static int osmesa_present(sys_surface *surface)
{
    (void)surface; /* nothing to swap; reading pixels waits for the drawing */
    return FF_OK;
}

static int osmesa_poll(sys_surface *surface, sys_event *event)
{
    (void)surface;
    return sys_event_take(event);
}

const sys_surface_api *sys_surface_osmesa(void)
{
    static const sys_surface_api api = { "osmesa",     osmesa_open,
                                         osmesa_close, osmesa_make_current,
                                         osmesa_proc,  osmesa_present,
                                         osmesa_poll };
    return &api;
}
