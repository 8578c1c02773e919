/* Simulated time and device events, to plug into the Common System API.
 *
 *   sys_sim_clock clock = {0};
 *   sys_sim_clock_use(&clock);                     // sys_time_us() is clock.now_us from now on,
 *                                                  // sys_sleep_us() returns at once
 *   sys_sim_script script = {events, count, 0};    // events ordered by time_us
 *   sys_sim_clock_advance(&clock, 33333);
 *   sys_sim_script_run(&script, clock.now_us);     // injects what is due: sys_event_take() and
 *                                                  // every surface hand it out
 *   sys_sim_clock_use(NULL);                       // the real clock again
 */
#ifndef SYS_SIM_H
#define SYS_SIM_H

#include "../sys.h"

typedef struct sys_sim_clock {
    int64_t now_us;
} sys_sim_clock;

/* Makes `clock` the clock of the process, NULL the real one. The clock must outlive its use; one
 * thread advances it. */
void sys_sim_clock_use(sys_sim_clock *clock);
void sys_sim_clock_advance(sys_sim_clock *clock, int64_t us); /* us >= 0 */

/* Device events at given times, the caller's array, ordered by time_us. */
typedef struct sys_sim_script {
    const sys_event *events;
    uint32_t count, next;
} sys_sim_script;
/* Injects all events with time_us <= now_us that are not injected yet, and returns how many. When
 * the queue is full the rest waits for the next call. */
uint32_t sys_sim_script_run(sys_sim_script *script, int64_t now_us);

#endif
