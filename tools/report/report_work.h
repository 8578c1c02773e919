/* Instructions and error over a sweep of quality, as make bench-handheld counts them
 * (work-precision.csv): columns quality, panorama, instructions (of a frame), err_px_p95; others
 * are not looked at. */
#ifndef REPORT_WORK_H
#define REPORT_WORK_H

#include <stddef.h>

#define REPORT_WORK_ROWS_MAX   64
#define REPORT_WORK_WORD_BYTES 16

typedef struct report_work_row {
    char quality[REPORT_WORK_WORD_BYTES], panorama[REPORT_WORK_WORD_BYTES];
    double instructions, err_px_p95;
} report_work_row;

typedef struct report_work {
    report_work_row row[REPORT_WORK_ROWS_MAX];
    size_t row_count; /* at least 1 */
} report_work;

/* 0, or -1 with the reason in `why`. */
int report_work_load(report_work *work, const char *path, char *why, size_t why_bytes);

#endif
