#include "sim_trace.h"

#include "../../protocol/ff_error.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

static int append(sim_trace *trace, size_t *capacity, uint32_t at_ms)
{
    if (trace->count == *capacity) {
        size_t more = *capacity ? *capacity * 2 : 4096;
        uint32_t *grown = realloc(trace->at_ms, more * sizeof *grown);
        if (!grown) return FF_ERR_MEMORY;
        trace->at_ms = grown;
        *capacity = more;
    }
    trace->at_ms[trace->count++] = at_ms;
    return FF_OK;
}

static int parse_line(const char *line, uint32_t *at_ms)
{
    char *end;
    errno = 0;
    unsigned long value = strtoul(line, &end, 10);
    if (line[0] < '0' || line[0] > '9' || errno || value > UINT32_MAX ||
        (*end != '\n' && *end != '\r' && *end != '\0'))
        return FF_ERR_FORMAT;
    *at_ms = (uint32_t)value;
    return FF_OK;
}

int sim_trace_read(sim_trace *trace, const char *path)
{
    char line[64];
    size_t capacity = 0;
    int rc = FF_OK;
    *trace = (sim_trace){ 0 };
    FILE *file = fopen(path, "r");
    if (!file) return FF_ERR_NOT_FOUND;
    while (rc == FF_OK && fgets(line, sizeof line, file)) {
        uint32_t at_ms = 0;
        rc = parse_line(line, &at_ms);
        if (rc == FF_OK && trace->count && at_ms < trace->at_ms[trace->count - 1])
            rc = FF_ERR_FORMAT;
        if (rc == FF_OK) rc = append(trace, &capacity, at_ms);
    }
    if (rc == FF_OK && (ferror(file) || !trace->count)) rc = FF_ERR_FORMAT;
    fclose(file);
    if (rc != FF_OK) {
        sim_trace_free(trace);
        return rc;
    }
    trace->period_ms = trace->at_ms[trace->count - 1];
    if (!trace->period_ms) trace->period_ms = 1;
    return FF_OK;
}

void sim_trace_free(sim_trace *trace)
{
    free(trace->at_ms);
    *trace = (sim_trace){ 0 };
}

uint64_t sim_trace_find(const sim_trace *trace, int64_t time_us)
{
    uint64_t ms = ((uint64_t)time_us + 999) / 1000; /* the first whole one not before time_us */
    uint64_t turn = ms / trace->period_ms, rest = ms % trace->period_ms;
    /* the end of one turn is the start of the next: both lines count, the earlier number first */
    if (turn && !rest) {
        turn--;
        rest = trace->period_ms;
    }
    size_t low = 0, high = trace->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (trace->at_ms[middle] < rest)
            low = middle + 1;
        else
            high = middle;
    }
    return turn * trace->count + low;
}

int64_t sim_trace_time_us(const sim_trace *trace, uint64_t number)
{
    return (
        int64_t)((number / trace->count * trace->period_ms + trace->at_ms[number % trace->count]) *
                 1000u);
}
