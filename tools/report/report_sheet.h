/* A sheet, one PNG, shows the same flight drawn twice: pictures of the same moments one above the
 * other, and below them how they differ. */
#ifndef REPORT_SHEET_H
#define REPORT_SHEET_H

#include "report_moments.h"

#define REPORT_SHEET_MOMENTS 5 /* columns at most: the first, the last, and evenly between */
#define REPORT_SHEET_VISIBLE 8 /* of 255 in a channel: pixels further apart are counted */

#define REPORT_SHEET_FILE_BYTES 40

typedef struct report_sheet {
    const char *heading; /* plain words */
    char file[REPORT_SHEET_FILE_BYTES];
    int amplified; /* differences are shown this many times as large */
    const char *name[2];
    size_t moments;
    /* share of the pixels that differ by more than REPORT_SHEET_VISIBLE */
    double differ_percent[REPORT_SHEET_MOMENTS];
} report_sheet;

/* Makes folder/sheet->file of the pictures that both series have by the same name, all of one size.
 * The caller sets the sheet's heading, file and amplified, the rest is filled in. 0, or -1 with the
 * reason in `why`. */
int report_sheet_write(const report_series series[2], const char *folder, report_sheet *sheet,
                       char *why, size_t why_bytes);

#endif
