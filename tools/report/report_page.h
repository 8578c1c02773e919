/* The report itself: index.html (readable without a network) and REPORT.md in one folder. */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "report_csv.h"
#include "report_paper.h"
#include "report_sheet.h"
#include "report_slider.h"
#include "report_work.h"

typedef struct report_content {
    const char *title, *folder;
    const char *owner;           /* whose ground is shown, or NULL */
    const report_slider *slider; /* what the page opens with, or NULL */
    const report_flight *flight;
    size_t flight_count;
    const char *const *picture; /* file names inside `folder` */
    size_t picture_count;
    const report_sheet *sheet; /* their files lie in `folder` */
    size_t sheet_count;
    const report_work *work;   /* NULL: instructions are not known */
    const report_paper *paper; /* NULL: flights stand for themselves */
    double settle_s;           /* seconds before the flights begin */
} report_content;

/* Each 0, or -1 with the reason in `why`. */
int report_page_html(const report_content *content, char *why, size_t why_bytes);
int report_page_markdown(const report_content *content, char *why, size_t why_bytes);
/* An array of summaries on stdout. */
void report_page_json(const report_content *content);

#endif
