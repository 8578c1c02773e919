/* A paper's table of flights (tools/report/hybrid_table3.csv), to stand beside our own. */
#ifndef REPORT_PAPER_H
#define REPORT_PAPER_H

#include <stddef.h>

#define REPORT_PAPER_ROWS_MAX   64
#define REPORT_PAPER_WORD_BYTES 16

/* What the paper does not tell is NAN. */
typedef struct report_paper_row {
    char link[REPORT_PAPER_WORD_BYTES], speed_kmh[REPORT_PAPER_WORD_BYTES];
    char quality[REPORT_PAPER_WORD_BYTES], panorama[REPORT_PAPER_WORD_BYTES];
    char name[4 * REPORT_PAPER_WORD_BYTES]; /* LINK-SPEED-QUALITY-PANORAMA: our flight's name */
    double triangles, kilobytes, stable_from_s, stable_to_s;
} report_paper_row;

typedef struct report_paper {
    report_paper_row row[REPORT_PAPER_ROWS_MAX];
    size_t row_count; /* at least 1 */
} report_paper;

/* 0, or -1 with the reason in `why`. */
int report_paper_load(report_paper *paper, const char *path, char *why, size_t why_bytes);

#endif
