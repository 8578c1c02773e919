/* Plots of flights: gnuplot draws SVG, which is then part of the page. */
#ifndef REPORT_PLOT_H
#define REPORT_PLOT_H

#include "report_csv.h"

#include <stdio.h>

#define REPORT_CURVES_MAX 16

/* A column over time, or over another column; value = column * scale. */
typedef struct report_curve {
    const report_flight *flight;
    enum report_column x, y;
    double x_scale, y_scale;
    const char *title;
} report_curve;

typedef struct report_plot {
    const char *title, *x_label, *y_label;
    int logarithmic_y, points; /* points: each row marked */
    double x_most;             /* 0: all */
    report_curve curve[REPORT_CURVES_MAX];
    size_t curve_count;
} report_plot;

/* Runs gnuplot and writes the picture into a page, as a figure; a plot without curves writes
 * nothing. `folder` takes temporary files. 0, or -1 with the reason in `why`. Values NAN leave
 * gaps; each curve needs a value that is a number. A logarithmic axis draws values below 0.01 at
 * 0.01. */
int report_plot_put(FILE *out, const char *folder, const report_plot *plot, char *why,
                    size_t why_bytes);

#endif
