/* Common System API: all that Farfield asks of an operating system (Hybrid, section 4.1).
 *
 * The build picks the files behind it: platform/posix (clock, threads, sockets, files),
 * platform/glfw (window with a GL context), platform/egl and platform/osmesa (GL contexts without a
 * window), platform/sim (simulated clock and events), platform/null (a blank port: builds anywhere,
 * answers FF_ERR_UNSUPPORTED). Errors are those of protocol/ff_error.h.
 */
#ifndef SYS_H
#define SYS_H

#include "../protocol/ff_error.h"

#include <stddef.h>
#include <stdint.h>

/* ---- clock: monotonic microseconds since an arbitrary start ---- */
int64_t sys_time_us(void);
void sys_sleep_us(int64_t us);
/* Replaces the clock of this process (simulation, tests); NULL brings the real one back.
 * sys_sleep_us then does nothing. */
void sys_clock_replace(int64_t (*now_us)(void *context), void *context);

/* ---- randomness: PCG32 streams, all from one seed; the same seed gives the same numbers on every
 * machine ---- */
typedef struct sys_random {
    uint64_t state, stream;
} sys_random;
void sys_random_seed(sys_random *random, uint64_t seed, uint64_t stream);
uint32_t sys_random_u32(sys_random *random);
/* 0 .. limit-1, unbiased; limit > 0 */
uint32_t sys_random_below(sys_random *random, uint32_t limit);

/* ---- threads ---- */
/* Platforms without threads: sys_thread_start returns FF_ERR_UNSUPPORTED and locks do nothing. */
typedef struct sys_mutex {
    union {
        void *align;
        unsigned char bytes[64];
    } u;
} sys_mutex;
typedef struct sys_thread {
    union {
        void *align;
        unsigned char bytes[32];
    } u;
} sys_thread;
int sys_mutex_init(sys_mutex *mutex);
void sys_mutex_destroy(sys_mutex *mutex);
void sys_mutex_lock(sys_mutex *mutex);
void sys_mutex_unlock(sys_mutex *mutex);
int sys_thread_start(sys_thread *thread, void (*run)(void *arg), void *arg);
void sys_thread_join(sys_thread *thread);

/* ---- byte streams: a connection seen from one end; real sockets, in-process pipes and simulated
 * links alike ---- */
typedef struct sys_stream {
    void *state;
    /* Bytes taken (0: would block) or FF_ERR_CLOSED. Never block. */
    int (*send)(void *state, const uint8_t *bytes, size_t count);
    int (*recv)(void *state, uint8_t *bytes, size_t capacity);
    void (*close)(void *state);
    /* Start connecting again after FF_ERR_CLOSED: FF_OK when connected, FF_ERR_AGAIN while under
     * way, else an error (try later). */
    int (*reconnect)(void *state);
} sys_stream;

/* TCP, non-blocking, no delay. `address` is HOST:PORT ([HOST]:PORT for IPv6). One thing does block:
 * a host's *name* is looked up by the system when connecting starts, and at every reconnect; where
 * DNS may be slow or gone, give an address. */
typedef struct sys_tcp {
    int fd;
    int connecting;
    char address[128];
} sys_tcp;
/* Sets `tcp` up and starts connecting; `stream` drives it. `tcp` must stay where it is.
 * FF_ERR_ARGUMENT for a bad address. */
int sys_tcp_client(sys_tcp *tcp, const char *address, sys_stream *stream);
/* Listening socket (fd) or a negative error; reuse_port lets several processes share it; *port
 * receives the bound port. */
int sys_tcp_listen(const char *address, int reuse_port, uint16_t *port);
/* Accepted fd (non-blocking) or FF_ERR_AGAIN, FF_ERR_SYSTEM. */
int sys_tcp_accept(int listen_fd);
/* A stream over an accepted fd; reconnect is NULL. */
void sys_tcp_adopt(sys_tcp *tcp, int fd, sys_stream *stream);
/* Sleeps until one of the sockets is ready for what it is listed with, a signal comes, or `us` of
 * real time have passed. */
enum {
    SYS_READY_RECV = 1,
    SYS_READY_SEND = 2,
    SYS_READY_MAX = 256 /* sockets in a list, at most */
};
typedef struct sys_ready {
    int fd, events;
} sys_ready;
void sys_wait_ready(const sys_ready *list, unsigned count, int64_t us);

/* ---- files ---- */
typedef struct sys_mapping {
    const void *bytes;
    uint64_t size;
} sys_mapping;
/* read-only; FF_ERR_NOT_FOUND, FF_ERR_SYSTEM */
int sys_map_file(const char *path, sys_mapping *mapping);
void sys_unmap_file(sys_mapping *mapping);
/* Writes a whole file by way of a temporary one and a rename: the old or the new content, never
 * half of it. */
int sys_write_file(const char *path, const void *bytes, size_t count);
/* Makes a folder; FF_OK also when it is there already, else FF_ERR_SYSTEM. */
int sys_make_folder(const char *path);
/* 1 when stderr is a terminal: progress is shown there and nowhere else. */
int sys_stderr_is_terminal(void);

/* ---- images (libjpeg-turbo, libpng behind it; allocate inside) ---- */
/* Images travel as bare JPEGs (protocol/SPEC.md, "Images"): a byte of quality and the scan of a
 * baseline JPEG, without headers and tables. */
/* Decodes a bare JPEG to tightly packed RGB888, top row first, width and height 1..65500. FF_OK,
 * FF_ERR_FORMAT (damaged, cut short, not bare), FF_ERR_ARGUMENT. Takes the memory of one row of
 * blocks. */
int sys_jpeg_decode(const uint8_t *bytes, size_t byte_count, uint32_t width, uint32_t height,
                    uint8_t *rgb);
/* Encodes RGB888, top row first, quality 1..100. Bytes written, or FF_ERR_FULL; encoding needs up
 * to 64 bytes more than the result has. */
int sys_jpeg_encode(const uint8_t *rgb, uint32_t width, uint32_t height, int quality, uint8_t *out,
                    size_t capacity);
/* Writes RGB888, top row first, as a PNG file. */
int sys_png_write(const char *path, const uint8_t *rgb, uint32_t width, uint32_t height);
/* Any PNG of at most 2^26 pixels as RGB888, top row first; *rgb is the caller's to free().
 * FF_ERR_FORMAT: damaged, FF_ERR_RANGE: larger. */
int sys_png_read(const char *path, uint8_t **rgb, uint32_t *width, uint32_t *height);

/* ---- window, GL context and device events ---- */
enum sys_event_type {
    SYS_EVENT_NONE,
    SYS_EVENT_QUIT,
    SYS_EVENT_RESIZE,
    SYS_EVENT_KEY,
    SYS_EVENT_POINTER,  /* touch or mouse */
    SYS_EVENT_POSITION, /* position fix (GPS) */
    SYS_EVENT_ACCELEROMETER,
    SYS_EVENT_BATTERY,
    SYS_EVENT_INTERRUPTION /* an incoming call begins or ends */
};
enum sys_pointer_action { SYS_POINTER_DOWN, SYS_POINTER_MOVE, SYS_POINTER_UP, SYS_POINTER_SCROLL };
typedef struct sys_event {
    enum sys_event_type type;
    int64_t time_us;
    union {
        struct {
            int width, height;
        } resize;
        /* ASCII for printable keys (lower case), SYS_KEY_* otherwise */
        struct {
            int code;
            int down;
        } key;
        struct {
            enum sys_pointer_action action;
            int x, y, button;
        } pointer;
        struct {
            int32_t x_wu, y_wu, z_wu;
            int32_t accuracy_wu;
        } position;
        /* thousandths of g; device axes: x right, y up, z to the user */
        struct {
            int32_t x_mg, y_mg, z_mg;
        } accelerometer;
        struct {
            int percent;
            int low;
        } battery;
        struct {
            int begins;
        } interruption;
    } u;
} sys_event;
enum sys_key {
    SYS_KEY_LEFT = 256,
    SYS_KEY_RIGHT,
    SYS_KEY_UP,
    SYS_KEY_DOWN,
    SYS_KEY_PAGE_UP,
    SYS_KEY_PAGE_DOWN,
    SYS_KEY_ESCAPE,
    SYS_KEY_ENTER,
    SYS_KEY_SPACE,
    SYS_KEY_F1 /* F12 = F1 + 11 */,
    SYS_KEY_SHIFT = 300
};

enum sys_gl_kind { SYS_GL_ES1, SYS_GL_DESKTOP, SYS_GL_NONE };
typedef struct sys_surface sys_surface;
typedef struct sys_surface_desc {
    const char *title;
    int width, height;
    enum sys_gl_kind gl;
} sys_surface_desc;
/* The functions of one kind of surface: a place to draw, with its GL context. Several kinds may
 * live in one process. */
typedef struct sys_surface_api {
    const char *name; /* "glfw", "egl", "osmesa", "memory" */
    /* makes current; FF_ERR_UNSUPPORTED, FF_ERR_SYSTEM */
    int (*open)(const sys_surface_desc *desc, sys_surface **surface);
    void (*close)(sys_surface *surface);
    int (*make_current)(sys_surface *surface);
    /* address of a GL function for the current context, or NULL */
    void *(*gl_proc)(const char *name);
    int (*present)(sys_surface *surface);                /* swap; offscreen: finish */
    int (*poll)(sys_surface *surface, sys_event *event); /* 1: an event; 0: none */
} sys_surface_api;
const sys_surface_api *sys_surface_glfw(void); /* NULL when not built in */
const sys_surface_api *sys_surface_egl(void);
const sys_surface_api *sys_surface_osmesa(void);
/* no GL: for back ends that hold the picture themselves */
const sys_surface_api *sys_surface_memory(void);

/* Injected device events (emulator, simulator): poll() of any surface hands them out too, first in
 * first out; FF_ERR_FULL. */
int sys_event_inject(const sys_event *event);
/* Takes one injected event: 1, or 0 when there is none. For programs without a surface. */
int sys_event_take(sys_event *event);

#endif
