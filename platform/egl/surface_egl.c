/* Off-screen GL or GL ES 1.1 by EGL on Mesa's surfaceless platform (a GPU's render node or
 * llvmpipe), drawn into a pbuffer. */
#include "../surface_local.h"
#include "../sys.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdlib.h>

#ifndef EGL_PLATFORM_SURFACELESS_MESA
#define EGL_PLATFORM_SURFACELESS_MESA 0x31DD
#endif

struct sys_surface {
    EGLDisplay display;
    EGLContext context;
    EGLSurface pbuffer;
    EGLenum api;
};

/* The display stays initialised until the process ends, because eglTerminate would end it for
 * everyone in the process. */
static EGLDisplay open_display(void)
{
    EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA,
                                               (void *)EGL_DEFAULT_DISPLAY, NULL);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL)) return display;
    display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, NULL, NULL)) return display;
    return EGL_NO_DISPLAY;
}

static void egl_release(void)
{
    EGLDisplay display = eglGetCurrentDisplay();
    if (display != EGL_NO_DISPLAY)
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static int egl_make_current(sys_surface *surface)
{
    sys_surface_take(surface, egl_release);
    eglBindAPI(surface->api);
    return eglMakeCurrent(surface->display, surface->pbuffer, surface->pbuffer, surface->context)
               ? FF_OK
               : FF_ERR_SYSTEM;
}

static void egl_close(sys_surface *surface)
{
    sys_surface_drop(surface);
    if (surface->pbuffer != EGL_NO_SURFACE) eglDestroySurface(surface->display, surface->pbuffer);
    if (surface->context != EGL_NO_CONTEXT) eglDestroyContext(surface->display, surface->context);
    free(surface);
}

static int create(sys_surface *surface, const sys_surface_desc *desc)
{
    int es = desc->gl == SYS_GL_ES1;
    const EGLint wanted[] = { EGL_SURFACE_TYPE,
                              EGL_PBUFFER_BIT,
                              EGL_RENDERABLE_TYPE,
                              es ? EGL_OPENGL_ES_BIT : EGL_OPENGL_BIT,
                              EGL_RED_SIZE,
                              8,
                              EGL_GREEN_SIZE,
                              8,
                              EGL_BLUE_SIZE,
                              8,
                              EGL_ALPHA_SIZE,
                              8,
                              EGL_DEPTH_SIZE,
                              24,
                              EGL_NONE };
    const EGLint size[] = { EGL_WIDTH, desc->width, EGL_HEIGHT, desc->height, EGL_NONE };
    const EGLint version[] = { EGL_CONTEXT_MAJOR_VERSION, 1, EGL_NONE };
    EGLConfig config;
    EGLint count = 0;
    surface->api = es ? EGL_OPENGL_ES_API : EGL_OPENGL_API;
    if (!eglBindAPI(surface->api)) return FF_ERR_UNSUPPORTED;
    if (!eglChooseConfig(surface->display, wanted, &config, 1, &count) || count < 1)
        return FF_ERR_UNSUPPORTED;
    surface->context = eglCreateContext(surface->display, config, EGL_NO_CONTEXT,
                                        es ? version : NULL);
    if (surface->context == EGL_NO_CONTEXT) return FF_ERR_UNSUPPORTED;
    surface->pbuffer = eglCreatePbufferSurface(surface->display, config, size);
    if (surface->pbuffer == EGL_NO_SURFACE) return FF_ERR_SYSTEM;
    return egl_make_current(surface);
}

static int egl_open(const sys_surface_desc *desc, sys_surface **surface)
{
    if (desc->width < 1 || desc->height < 1 || desc->width > 4096 || desc->height > 4096)
        return FF_ERR_ARGUMENT;
    sys_surface *opened = calloc(1, sizeof *opened);
    if (!opened) return FF_ERR_MEMORY;
    opened->context = EGL_NO_CONTEXT;
    opened->pbuffer = EGL_NO_SURFACE;
    opened->display = open_display();
    if (opened->display == EGL_NO_DISPLAY) {
        free(opened);
        return FF_ERR_SYSTEM;
    }
    int rc = create(opened, desc);
    if (rc < 0) {
        egl_close(opened);
        return rc;
    }
    *surface = opened;
    return FF_OK;
}

static void *egl_proc(const char *name)
{
    union {
        __eglMustCastToProperFunctionPointerType function;
        void *address;
    } proc = { eglGetProcAddress(name) };
    return proc.address;
}

static int egl_present(sys_surface *surface)
{
    return eglSwapBuffers(surface->display, surface->pbuffer) ? FF_OK : FF_ERR_SYSTEM;
}

static int egl_poll(sys_surface *surface, sys_event *event)
{
    (void)surface;
    return sys_event_take(event);
}

const sys_surface_api *sys_surface_egl(void)
{
    static const sys_surface_api api = { "egl",    egl_open,    egl_close, egl_make_current,
                                         egl_proc, egl_present, egl_poll };
    return &api;
}
