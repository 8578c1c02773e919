/* A blank port: every function of sys.h that a system must answer, answered as a system without
 * anything would. It builds with any C99 compiler and no header of a system. A port to a new system
 * starts as a copy in which one function after the other is made real. Randomness and injected
 * events (platform/random.c, platform/events.c) ask nothing of a system and are shared by all
 * ports.
 *
 * What works: the clock steps a millisecond at every look, so that loops waiting for time end;
 * locks do nothing, as there are no threads. Everything else says FF_ERR_UNSUPPORTED.
 */
#include "../sys.h"

#define STEP_US 1000

static int64_t (*replaced_now_us)(void *context);
static void *replaced_context;
static int64_t stepped_us;

int64_t sys_time_us(void)
{
    if (replaced_now_us) return replaced_now_us(replaced_context);
    return stepped_us += STEP_US;
}

void sys_sleep_us(int64_t us)
{
    if (!replaced_now_us && us > 0) stepped_us += us;
}

void sys_clock_replace(int64_t (*now_us)(void *context), void *context)
{
    replaced_now_us = now_us;
    replaced_context = context;
}

int sys_mutex_init(sys_mutex *mutex) { return (void)mutex, FF_OK; }
void sys_mutex_destroy(sys_mutex *mutex) { (void)mutex; }
void sys_mutex_lock(sys_mutex *mutex) { (void)mutex; }
void sys_mutex_unlock(sys_mutex *mutex) { (void)mutex; }

int sys_thread_start(sys_thread *thread, void (*run)(void *arg), void *arg)
{
    (void)thread, (void)run, (void)arg;
    return FF_ERR_UNSUPPORTED;
}

void sys_thread_join(sys_thread *thread) { (void)thread; }

int sys_map_file(const char *path, sys_mapping *mapping)
{
    (void)path;
    mapping->bytes = NULL;
    mapping->size = 0;
    return FF_ERR_UNSUPPORTED;
}

void sys_unmap_file(sys_mapping *mapping) { mapping->bytes = NULL; }

int sys_write_file(const char *path, const void *bytes, size_t count)
{
    (void)path, (void)bytes, (void)count;
    return FF_ERR_UNSUPPORTED;
}

int sys_make_folder(const char *path)
{
    (void)path;
    return FF_ERR_UNSUPPORTED;
}

int sys_stderr_is_terminal(void) { return 0; }

int sys_png_write(const char *path, const uint8_t *rgb, uint32_t width, uint32_t height)
{
    (void)path, (void)rgb, (void)width, (void)height;
    return FF_ERR_UNSUPPORTED;
}

int sys_png_read(const char *path, uint8_t **rgb, uint32_t *width, uint32_t *height)
{
    (void)path, (void)rgb, (void)width, (void)height;
    return FF_ERR_UNSUPPORTED;
}

const sys_surface_api *sys_surface_glfw(void) { return NULL; }
const sys_surface_api *sys_surface_egl(void) { return NULL; }
const sys_surface_api *sys_surface_osmesa(void) { return NULL; }
const sys_surface_api *sys_surface_memory(void) { return NULL; }
