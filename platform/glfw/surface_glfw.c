/* The desktop emulator's window: GLFW with GL ES 1.1 (through EGL) or desktop GL. GLFW wants one
 * thread, the main one. */
#include "../surface_local.h"
#include "../sys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <stdlib.h>

#define QUEUE_CAPACITY 64 /* events of one window not yet polled; further ones are lost */

struct sys_surface {
    GLFWwindow *window;
    sys_event queue[QUEUE_CAPACITY];
    unsigned head, tail; /* counts put in and taken out */
    int pressed_button;  /* of the drag under way, -1: none */
};

static int open_windows;

static void put(GLFWwindow *window, sys_event event)
{
    sys_surface *surface = glfwGetWindowUserPointer(window);
    event.time_us = sys_time_us();
    if (surface->head - surface->tail < QUEUE_CAPACITY)
        surface->queue[surface->head++ % QUEUE_CAPACITY] = event;
}

static int key_code(int key)
{
    static const struct {
        int glfw, sys;
    } named[] = { { GLFW_KEY_LEFT, SYS_KEY_LEFT },
                  { GLFW_KEY_RIGHT, SYS_KEY_RIGHT },
                  { GLFW_KEY_UP, SYS_KEY_UP },
                  { GLFW_KEY_DOWN, SYS_KEY_DOWN },
                  { GLFW_KEY_PAGE_UP, SYS_KEY_PAGE_UP },
                  { GLFW_KEY_PAGE_DOWN, SYS_KEY_PAGE_DOWN },
                  { GLFW_KEY_ESCAPE, SYS_KEY_ESCAPE },
                  { GLFW_KEY_ENTER, SYS_KEY_ENTER },
                  { GLFW_KEY_SPACE, SYS_KEY_SPACE },
                  { GLFW_KEY_LEFT_SHIFT, SYS_KEY_SHIFT },
                  { GLFW_KEY_RIGHT_SHIFT, SYS_KEY_SHIFT } };
    for (size_t i = 0; i < sizeof named / sizeof *named; i++)
        if (named[i].glfw == key) return named[i].sys;
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12) return SYS_KEY_F1 + key - GLFW_KEY_F1;
    if (key >= 'A' && key <= 'Z') return key - 'A' + 'a';
    return key > ' ' && key < 127 ? key : 0;
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods)
{
    (void)scancode;
    (void)mods;
    int code = key_code(key);
    if (code && action != GLFW_REPEAT)
        put(window, (sys_event){ .type = SYS_EVENT_KEY, .u.key = { code, action == GLFW_PRESS } });
}

static void put_pointer(GLFWwindow *window, enum sys_pointer_action action, int button)
{
    double x, y;
    glfwGetCursorPos(window, &x, &y);
    put(window,
        (sys_event){ .type = SYS_EVENT_POINTER, .u.pointer = { action, (int)x, (int)y, button } });
}

static void on_button(GLFWwindow *window, int button, int action, int mods)
{
    (void)mods;
    sys_surface *surface = glfwGetWindowUserPointer(window);
    surface->pressed_button = action == GLFW_PRESS ? button : -1;
    put_pointer(window, action == GLFW_PRESS ? SYS_POINTER_DOWN : SYS_POINTER_UP, button);
}

/* As a touch screen would: movement counts while a button is held. */
static void on_move(GLFWwindow *window, double x, double y)
{
    sys_surface *surface = glfwGetWindowUserPointer(window);
    if (surface->pressed_button < 0) return;
    put(window,
        (sys_event){ .type = SYS_EVENT_POINTER,
                     .u.pointer = { SYS_POINTER_MOVE, (int)x, (int)y, surface->pressed_button } });
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    (void)x;
    put_pointer(window, SYS_POINTER_SCROLL, y > 0 ? 1 : -1);
}

static void on_resize(GLFWwindow *window, int width, int height)
{
    if (width > 0 && height > 0)
        put(window, (sys_event){ .type = SYS_EVENT_RESIZE, .u.resize = { width, height } });
}

static void on_close(GLFWwindow *window) { put(window, (sys_event){ .type = SYS_EVENT_QUIT }); }

static void glfw_release(void) { glfwMakeContextCurrent(NULL); }

static int surface_make_current(sys_surface *surface)
{
    sys_surface_take(surface, glfw_release);
    glfwMakeContextCurrent(surface->window);
    return glfwGetCurrentContext() == surface->window ? FF_OK : FF_ERR_SYSTEM;
}

static void surface_close(sys_surface *surface)
{
    sys_surface_drop(surface);
    if (surface->window) glfwDestroyWindow(surface->window);
    free(surface);
    if (--open_windows == 0) glfwTerminate();
}

static GLFWwindow *create_window(const sys_surface_desc *desc)
{
    glfwDefaultWindowHints();
    if (desc->gl == SYS_GL_ES1) {
        glfwWindowHint(GLFW_CLIENT_API, GLFW_OPENGL_ES_API);
        glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 1);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 1);
    }
    glfwWindowHint(GLFW_DEPTH_BITS, 24);
    return glfwCreateWindow(desc->width, desc->height, desc->title ? desc->title : "Farfield", NULL,
                            NULL);
}

static int surface_open(const sys_surface_desc *desc, sys_surface **surface)
{
    if (desc->width < 1 || desc->height < 1 || desc->width > 4096 || desc->height > 4096)
        return FF_ERR_ARGUMENT;
    if (!glfwInit()) return FF_ERR_SYSTEM;
    sys_surface *opened = calloc(1, sizeof *opened);
    if (!opened) return FF_ERR_MEMORY;
    open_windows++;
    opened->pressed_button = -1;
    opened->window = create_window(desc);
    int rc = opened->window ? surface_make_current(opened) : FF_ERR_UNSUPPORTED;
    if (rc < 0) {
        surface_close(opened);
        return rc;
    }
    glfwSetWindowUserPointer(opened->window, opened);
    glfwSetKeyCallback(opened->window, on_key);
    glfwSetMouseButtonCallback(opened->window, on_button);
    glfwSetCursorPosCallback(opened->window, on_move);
    glfwSetScrollCallback(opened->window, on_scroll);
    glfwSetFramebufferSizeCallback(opened->window, on_resize);
    glfwSetWindowCloseCallback(opened->window, on_close);
    glfwSwapInterval(1);
    *surface = opened;
    return FF_OK;
}

static void *surface_proc(const char *name)
{
    union {
        GLFWglproc function;
        void *address;
    } proc = { glfwGetProcAddress(name) };
    return proc.address;
}

static int surface_present(sys_surface *surface)
{
    glfwSwapBuffers(surface->window);
    return FF_OK;
}

static int surface_poll(sys_surface *surface, sys_event *event)
{
    if (surface->head == surface->tail) glfwPollEvents();
    if (surface->head == surface->tail) return sys_event_take(event);
    *event = surface->queue[surface->tail++ % QUEUE_CAPACITY];
    return 1;
}

const sys_surface_api *sys_surface_glfw(void)
{
    static const sys_surface_api api = { "glfw",        surface_open,
                                         surface_close, surface_make_current,
                                         surface_proc,  surface_present,
                                         surface_poll };
    return &api;
}
