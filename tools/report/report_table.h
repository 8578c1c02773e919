/* Tables that are the same rows as HTML and as Markdown. */
#ifndef REPORT_TABLE_H
#define REPORT_TABLE_H

#include <stddef.h>
#include <stdio.h>

typedef struct report_style {
    const char *row_open, *row_close, *cell_open, *cell_close, *head_open, *head_close;
    int html;
} report_style;
extern const report_style report_style_html, report_style_markdown;

/* Between _head and _end lie rows: _row, cells, _row_end. Words are plain: no markup, no '|'. */
void report_table_head(FILE *out, const report_style *style, const char *const *head, size_t count);
void report_table_end(FILE *out, const report_style *style);
void report_table_row(FILE *out, const report_style *style);
void report_table_row_end(FILE *out, const report_style *style);
void report_table_word(FILE *out, const report_style *style, const char *word);
/* Any text, marked up as needed. */
void report_table_name(FILE *out, const report_style *style, const char *name);
/* A number, or a dash when it is not finite. */
void report_table_number(FILE *out, const report_style *style, int decimals, double value);
void report_table_heading(FILE *out, const report_style *style, const char *heading);
void report_table_text(FILE *out, const report_style *style, const char *text);

/* Writes text from outside, so that it shows as it is. */
void report_put_html(FILE *out, const char *text);
void report_put_markdown(FILE *out, const char *text);

#endif
