#include "report_table.h"

#include <math.h>
#include <string.h>

const report_style report_style_html = { "<tr>", "</tr>\n", "<td>", "</td>", "<th>", "</th>", 1 };
const report_style report_style_markdown = { "|", "\n", " ", " |", " ", " |", 0 };

void report_table_head(FILE *out, const report_style *style, const char *const *head, size_t count)
{
    if (style->html) fputs("<div class=\"wide\"><table>\n", out);
    fputs(style->row_open, out);
    for (size_t i = 0; i < count; i++)
        fprintf(out, "%s%s%s", style->head_open, head[i], style->head_close);
    fputs(style->row_close, out);
    if (style->html) return;
    fputs("|", out);
    for (size_t i = 0; i < count; i++) fputs(" --: |", out);
    fputs("\n", out);
}

void report_table_end(FILE *out, const report_style *style)
{
    fputs(style->html ? "</table></div>\n" : "", out);
}
void report_table_row(FILE *out, const report_style *style) { fputs(style->row_open, out); }
void report_table_row_end(FILE *out, const report_style *style) { fputs(style->row_close, out); }

void report_table_word(FILE *out, const report_style *style, const char *word)
{
    fprintf(out, "%s%s%s", style->cell_open, word, style->cell_close);
}

void report_table_number(FILE *out, const report_style *style, int decimals, double value)
{
    if (isfinite(value))
        fprintf(out, "%s%.*f%s", style->cell_open, decimals, value, style->cell_close);
    else
        report_table_word(out, style, "–");
}

void report_table_heading(FILE *out, const report_style *style, const char *heading)
{
    fprintf(out, style->html ? "<h2>%s</h2>\n" : "\n## %s\n\n", heading);
}

void report_table_text(FILE *out, const report_style *style, const char *text)
{
    fprintf(out, style->html ? "<p>%s</p>\n" : "%s\n\n", text);
}

void report_put_html(FILE *out, const char *text)
{
    for (; *text; text++) {
        if (*text == '&')
            fputs("&amp;", out);
        else if (*text == '<')
            fputs("&lt;", out);
        else if (*text == '>')
            fputs("&gt;", out);
        else if (*text == '"')
            fputs("&quot;", out);
        else
            fputc(*text, out);
    }
}

void report_put_markdown(FILE *out, const char *text)
{
    for (; *text; text++) {
        if (strchr("|\\`*_<>[]#", *text)) fputc('\\', out);
        fputc(*text, out);
    }
}

void report_table_name(FILE *out, const report_style *style, const char *name)
{
    fputs(style->cell_open, out);
    if (style->html)
        report_put_html(out, name);
    else
        report_put_markdown(out, name);
    fputs(style->cell_close, out);
}
