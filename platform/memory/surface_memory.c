/* A surface without any graphics library: the back end keeps the picture in its own memory
 * (common3d/soft). Events pass as elsewhere. */
#include "../surface_local.h"
#include "../sys.h"

#include <stdlib.h>

struct sys_surface {
    int width, height;
};

static void memory_release(void) {}

static int memory_make_current(sys_surface *surface)
{
    sys_surface_take(surface, memory_release);
    return FF_OK;
}

static void memory_close(sys_surface *surface)
{
    sys_surface_drop(surface);
    free(surface);
}

static int memory_open(const sys_surface_desc *desc, sys_surface **surface)
{
    if (desc->width < 1 || desc->height < 1 || desc->width > 4096 || desc->height > 4096)
        return FF_ERR_ARGUMENT;
    sys_surface *opened = malloc(sizeof *opened);
    if (!opened) return FF_ERR_MEMORY;
    *opened = (sys_surface){ desc->width, desc->height };
    *surface = opened;
    return memory_make_current(opened);
}

static void *memory_proc(const char *name)
{
    (void)name;
    return NULL;
}

static int memory_present(sys_surface *surface)
{
    (void)surface;
    return FF_OK;
}

static int memory_poll(sys_surface *surface, sys_event *event)
{
    (void)surface;
    return sys_event_take(event);
}

const sys_surface_api *sys_surface_memory(void)
{
    static const sys_surface_api api = { "memory",     memory_open,
                                         memory_close, memory_make_current,
                                         memory_proc,  memory_present,
                                         memory_poll };
    return &api;
}
