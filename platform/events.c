/* Ring of injected device events. Any thread may inject or take: a spin lock guards it, held for
 * one copy only. */
#include "sys.h"

#include <stdatomic.h>

#define EVENT_CAPACITY 64 /* a power of two */

static sys_event ring[EVENT_CAPACITY];
static unsigned ring_head, ring_tail; /* count put in, count taken out */
static atomic_flag ring_lock = ATOMIC_FLAG_INIT;

static void lock(void)
{
    while (atomic_flag_test_and_set_explicit(&ring_lock, memory_order_acquire)) {
    }
}

static void unlock(void) { atomic_flag_clear_explicit(&ring_lock, memory_order_release); }

int sys_event_inject(const sys_event *event)
{
    int rc = FF_ERR_FULL;
    lock();
    if (ring_head - ring_tail < EVENT_CAPACITY) {
        ring[ring_head++ % EVENT_CAPACITY] = *event;
        rc = FF_OK;
    }
    unlock();
    return rc;
}

int sys_event_take(sys_event *event)
{
    int taken = 0;
    lock();
    if (ring_head != ring_tail) {
        *event = ring[ring_tail++ % EVENT_CAPACITY];
        taken = 1;
    }
    unlock();
    return taken;
}
