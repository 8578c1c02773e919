/* Recorded links in Mahimahi's format: a text file, one line for each opportunity to deliver 1500
 * bytes, the time in whole milliseconds since the start; the recording repeats from its end
 * (mm-link(1)).
 */
#ifndef SIM_TRACE_H
#define SIM_TRACE_H

#include <stddef.h>
#include <stdint.h>

#define SIM_TRACE_OPPORTUNITY_BYTES 1500

typedef struct sim_trace {
    uint32_t *at_ms; /* never falling */
    size_t count;
    uint64_t period_ms; /* the last line, at least 1 */
} sim_trace;

/* FF_OK; FF_ERR_NOT_FOUND, FF_ERR_MEMORY, FF_ERR_FORMAT (empty, not numbers, or times that go
 * back). */
int sim_trace_read(sim_trace *trace, const char *path);
void sim_trace_free(sim_trace *trace);
/* Number (over all repetitions) of the first opportunity at or after time_us, and the time of an
 * opportunity. */
uint64_t sim_trace_find(const sim_trace *trace, int64_t time_us);
int64_t sim_trace_time_us(const sim_trace *trace, uint64_t number);

#endif
