/* The table of stiff and extreme cases: a row for each, collected while they run and written as
 * Markdown. */
#ifndef EXTREME_TABLE_H
#define EXTREME_TABLE_H

#include <stdint.h>

/* Work that is counted, and so the same on every machine. audited: pixels whose error was computed.
 */
typedef struct extreme_work {
    uint64_t frames, selects, triangles, requests, bytes, audited;
} extreme_work;

/* Processor time of the case, and of an ordinary case run in turns with it: on a loaded or slow
 * machine both take longer, and their ratio stays. Shown, never judged. */
typedef struct extreme_cost {
    double own_s, ordinary_s;
    uint64_t own_times, ordinary_times;
} extreme_cost;

typedef struct extreme_row {
    const char *name, *measured, *unit;
    double worst, bound; /* the worst value measured, and its limit */
    extreme_work work;
    extreme_cost cost;
    int failed;
    char verdict[200]; /* the first fault */
} extreme_row;

/* Begins a row. The pointer stays valid; at most 64 rows. */
extreme_row *extreme_row_begin(const char *name, const char *measured, const char *unit,
                               double bound);
/* Keeps the largest value; a value above the bound, or NAN, fails the row. */
void extreme_row_value(extreme_row *row, double value);
/* Fails the row when `holds` is 0; returns `holds`. */
int extreme_row_expect(extreme_row *row, int holds, const char *what);
/* Processor time of this process so far. */
double extreme_processor_s(void);

/* FF_OK or an error of the file. */
int extreme_table_write(const char *path);

#endif
