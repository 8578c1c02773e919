/* Flights beside a paper's: its table with ours and ratios, error since the start for each link,
 * error against work. */
#ifndef REPORT_MATRIX_H
#define REPORT_MATRIX_H

#include "report_page.h"

#include <stdio.h>

/* Our side of a row; NAN where the flight lacks a figure. All but kilobytes and stable_s are means
 * over the rows from settle_s on. */
typedef struct report_figures {
    double triangles, kilobytes; /* kilobytes: all that came down, standing still included */
    double stable_s;             /* see report_stable_s */
    double err_p95, undrawn;
} report_figures;

/* `reference` may be NULL. */
void report_figures_of(const report_flight *flight, const report_flight *reference, double settle_s,
                       report_figures *figures);
/* Seconds until the picture is stable: for three rows the error's 95th percentile is at most 10 %
 * and 0.1 px above that of `reference`, and at most 1 % more of the ground's pixels are undrawn.
 * The reference is the same flight over a link without limits, at the same time; while both stand
 * still, at settle_s. NAN: never, not audited, or no reference (NULL, or a shorter flight). */
double report_stable_s(const report_flight *flight, const report_flight *reference,
                       double settle_s);

/* Share of the rows in flight as good as the reference's. NAN without a reference. */
double report_stable_percent(const report_flight *flight, const report_flight *reference,
                             double settle_s);
/* A flight by its name, and the one of this name over a link without limits (only what comes before
 * the first dash differs); or NULL. */
const report_flight *report_find(const report_content *content, const char *name);
const report_flight *report_find_reference(const report_content *content, const char *name);

/* content->paper is not NULL. Flights are found by name: those of the paper's rows, the same over
 * link lan as their references, and sweep-SERIES-VALUE. */
int report_matrix_html(FILE *out, const report_content *content, char *why, size_t why_bytes);
void report_matrix_markdown(FILE *out, const report_content *content);

/* Writes the error against instructions, as a plot and a table; content->work is not NULL. */
int report_work_html(FILE *out, const report_content *content, char *why, size_t why_bytes);

#endif
