/* Where tcg_count.c begins to count and changes phases: functions with a block of their own. */
#ifndef COUNT_MARKS_H
#define COUNT_MARKS_H

#define COUNT_MARK(phase)             \
    void handheld_mark_##phase(void); \
    __attribute__((noinline)) void handheld_mark_##phase(void) { __asm__ volatile(""); }
COUNT_MARK(start)
COUNT_MARK(work)
COUNT_MARK(outside)

#endif
