#include "sys_sim.h"

#include <assert.h>

static int64_t simulated_now_us(void *context) { return ((const sys_sim_clock *)context)->now_us; }

void sys_sim_clock_use(sys_sim_clock *clock)
{
    sys_clock_replace(clock ? simulated_now_us : NULL, clock);
}

void sys_sim_clock_advance(sys_sim_clock *clock, int64_t us)
{
    assert(us >= 0);
    clock->now_us += us;
}

uint32_t sys_sim_script_run(sys_sim_script *script, int64_t now_us)
{
    uint32_t first = script->next;
    while (script->next < script->count && script->events[script->next].time_us <= now_us) {
        if (sys_event_inject(&script->events[script->next]) < 0) break;
        script->next++;
    }
    return script->next - first;
}
