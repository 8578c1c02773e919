/* The table of stiff and extreme cases: a row for each, collected while they run and written as
 * Markdown. */
#ifndef EXTREME_TABLE_H
#define EXTREME_TABLE_H

#include <stdint.h>

/* Counted: the same everywhere. audited: pixels whose error was looked at. */
typedef struct extreme_work {
    uint64_t frames, selects, triangles, requests, bytes, audited;
} extreme_work;

/* Processor time of the case, and of an ordinary one taken in turns with it in the same run: on a
 * loaded machine, or a slow one, both take longer and their ratio stays. Shown, never judged. */
typedef struct extreme_cost {
    double own_s, ordinary_s;
    uint64_t own_times, ordinary_times;
} extreme_cost;

typedef struct extreme_row {
    const char *name, *measured, *unit;
    double worst, bound; /* of what was measured */
    extreme_work work;
    extreme_cost cost;
    int failed;
    char verdict[200]; /* what went wrong first */
} extreme_row;

/* Begins a row, which stays valid; at most 64. */
extreme_row *extreme_row_begin(const char *name, const char *measured, const char *unit,
                               double bound);
/* A larger value than before is kept; one above the bound, or NAN, fails the row. */
void extreme_row_value(extreme_row *row, double value);
/* Fails the row when `holds` is 0; returns `holds`. */
int extreme_row_expect(extreme_row *row, int holds, const char *what);
/* Processor time of this process, to take differences of. */
double extreme_processor_s(void);

/* FF_OK or an error of the file. */
int extreme_table_write(const char *path);

#endif
