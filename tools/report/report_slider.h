/* What a page opens with: two pictures of the same moment, exactly over each other, with a slider
 * between them, and a sentence of what the flight's CSV tells of that moment. */
#ifndef REPORT_SLIDER_H
#define REPORT_SLIDER_H

#include "report_csv.h"
#include "report_moments.h"

#include <stdint.h>
#include <stdio.h>

typedef struct report_slider {
    const char *name[2]; /* of the left and of the right picture, from outside */
    uint32_t width, height;
    const report_row *row; /* of the moment */
} report_slider;

extern const char report_slider_style[]; /* CSS */

/* Takes the last picture that both series have by the same name, and the row of that moment from
 * the flight that is named as the first series' folder; copies both pictures into `folder`. 0, or
 * -1 with the reason in `why`. */
int report_slider_make(const report_series series[2], const report_flight *flight,
                       size_t flight_count, const char *folder, report_slider *slider, char *why,
                       size_t why_bytes);
/* The page's heading and what lies below it. owner: whose ground is shown, or NULL. */
void report_slider_html(FILE *out, const report_slider *slider, const char *title,
                        const char *owner);
void report_slider_markdown(FILE *out, const report_slider *slider, const char *owner);

#endif
