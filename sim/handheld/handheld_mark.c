/* Marks for the instruction counter. They differ from each other, and are called, never inlined:
 * each has its own address. */
#include "handheld.h"

static volatile int last_mark;

#define MARK(name, number) \
    __attribute__((noinline)) void handheld_mark_##name(void) { last_mark = number; }

MARK(outside, 0)
MARK(work, 1)
MARK(update, 2)
MARK(draw, 3)
MARK(frame, 4)
MARK(start, 5)
