/* POSIX threads inside the opaque structs of sys.h. */
#include "../sys.h"

#include <pthread.h>
#include <stdlib.h>

_Static_assert(sizeof(pthread_mutex_t) <= sizeof(sys_mutex), "sys_mutex holds a pthread_mutex_t");
_Static_assert(sizeof(pthread_t) <= sizeof(sys_thread), "sys_thread holds a pthread_t");

struct start {
    void (*run)(void *arg);
    void *arg;
};

static pthread_mutex_t *mutex_of(sys_mutex *mutex) { return (pthread_mutex_t *)(void *)&mutex->u; }
static pthread_t *thread_of(sys_thread *thread) { return (pthread_t *)(void *)&thread->u; }

int sys_mutex_init(sys_mutex *mutex)
{
    return pthread_mutex_init(mutex_of(mutex), NULL) ? FF_ERR_SYSTEM : FF_OK;
}
void sys_mutex_destroy(sys_mutex *mutex) { pthread_mutex_destroy(mutex_of(mutex)); }
void sys_mutex_lock(sys_mutex *mutex) { pthread_mutex_lock(mutex_of(mutex)); }
void sys_mutex_unlock(sys_mutex *mutex) { pthread_mutex_unlock(mutex_of(mutex)); }

static void *trampoline(void *opaque)
{
    struct start start = *(struct start *)opaque;
    free(opaque);
    start.run(start.arg);
    return NULL;
}

int sys_thread_start(sys_thread *thread, void (*run)(void *arg), void *arg)
{
    struct start *start = malloc(sizeof *start);
    if (!start) return FF_ERR_MEMORY;
    *start = (struct start){ run, arg };
    if (pthread_create(thread_of(thread), NULL, trampoline, start) != 0) {
        free(start);
        return FF_ERR_SYSTEM;
    }
    return FF_OK;
}

void sys_thread_join(sys_thread *thread) { pthread_join(*thread_of(thread), NULL); }
