#include "report_page.h"

#include "report_findings.h"
#include "report_matrix.h"
#include "report_plot.h"
#include "report_table.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATH_BYTES 4096

/* The summary table: heading, name in --json, decimals, place in report_summary. */
typedef struct summary_column {
    const char *heading, *json;
    int decimals;
    size_t offset;
} summary_column;

#define AT(field) offsetof(report_summary, field)
static const summary_column summary_columns[] = {
    { "seconds", "seconds", 0, AT(seconds) },
    { "triangles, mean", "triangles_mean", 0, AT(triangles_mean) },
    { "triangles, most", "triangles_max", 0, AT(triangles_max) },
    { "nodes drawn, mean", "nodes_drawn_mean", 0, AT(nodes_drawn_mean) },
    { "nodes held, most", "nodes_held_max", 0, AT(nodes_held_max) },
    { "kB down in 60 s", "kb_down_60s", 1, AT(kb_down_60s) },
    { "kB down", "kb_down", 1, AT(kb_down) },
    { "kB up", "kb_up", 1, AT(kb_up) },
    { "requests", "requests", 0, AT(requests) },
    { "panoramas", "panoramas", 0, AT(panoramas) },
    { "sets of far ground", "far_sets", 0, AT(far_sets) },
    { "their sectors", "far_sectors", 0, AT(far_sectors) },
    { "kB heights", "kb_heights", 1, AT(kb_heights) },
    { "kB images", "kb_images", 1, AT(kb_images) },
    { "kB panoramas", "kb_faces", 1, AT(kb_faces) },
    { "kB sets", "kb_far", 1, AT(kb_far) },
    { "error px, rms", "err_px_rms_mean", 2, AT(err_rms_mean) },
    { "error px, 95 %", "err_px_p95_mean", 2, AT(err_p95_mean) },
    { "error px, most", "err_px_max", 1, AT(err_max) },
    { "difference, mean", "diff_mean", 2, AT(diff_mean) },
    { "difference, 95 %", "diff_p95_mean", 1, AT(diff_p95_mean) },
    { "SSIM", "ssim_mean", 4, AT(ssim_mean) },
    { "skyline px, rms", "skyline_px_rms_mean", 2, AT(skyline_rms_mean) },
    { "judged by ground within m of its source", "truth_error_m", 2, AT(truth_error_m) },
};
enum { SUMMARY_COLUMNS = sizeof summary_columns / sizeof *summary_columns };

static double summary_value(const report_summary *summary, const summary_column *column)
{
    double value;
    memcpy(&value, (const char *)summary + column->offset, sizeof value);
    return value;
}

/* A column that no flight has is left out of the tables. */
static void find_shown(const report_content *content, uint8_t shown[SUMMARY_COLUMNS])
{
    memset(shown, 0, SUMMARY_COLUMNS);
    for (size_t i = 0; i < content->flight_count; i++) {
        report_summary summary;
        report_summarise(&content->flight[i], content->settle_s, &summary);
        for (int c = 0; c < SUMMARY_COLUMNS; c++)
            shown[c] |= !isnan(summary_value(&summary, &summary_columns[c]));
    }
}

/* Writes a relative link; characters that are not plain go as %XX. */
static void put_link(FILE *out, const char *name)
{
    static const char plain[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~";
    for (; *name; name++) {
        if (strchr(plain, *name))
            fputc(*name, out);
        else
            fprintf(out, "%%%02X", (unsigned)(unsigned char)*name);
    }
}

static FILE *open_page(const report_content *content, const char *name, char *why, size_t why_bytes)
{
    char path[PATH_BYTES];
    snprintf(path, sizeof path, "%s/%s", content->folder, name);
    FILE *out = fopen(path, "w");
    if (!out) snprintf(why, why_bytes, "%s: %s", path, strerror(errno));
    return out;
}

static int close_page(FILE *out, const report_content *content, const char *name, char *why,
                      size_t why_bytes)
{
    int bad = ferror(out);
    if (fclose(out) || bad) {
        snprintf(why, why_bytes, "%s/%s: cannot be written", content->folder, name);
        return -1;
    }
    return 0;
}

/* ---- HTML ---- */
static void put_html_table(FILE *out, const report_content *content)
{
    uint8_t shown[SUMMARY_COLUMNS];
    find_shown(content, shown);
    fputs("<div class=\"wide\"><table>\n<tr><th>flight</th>", out);
    for (int c = 0; c < SUMMARY_COLUMNS; c++)
        if (shown[c]) fprintf(out, "<th>%s</th>", summary_columns[c].heading);
    fputs("</tr>\n", out);
    for (size_t i = 0; i < content->flight_count; i++) {
        report_summary summary;
        report_summarise(&content->flight[i], content->settle_s, &summary);
        fputs("<tr><td>", out);
        report_put_html(out, content->flight[i].name);
        fputs("</td>", out);
        for (int c = 0; c < SUMMARY_COLUMNS; c++) {
            double value = summary_value(&summary, &summary_columns[c]);
            if (!shown[c]) continue;
            if (isnan(value))
                fputs("<td>–</td>", out);
            else
                fprintf(out, "<td>%.*f</td>", summary_columns[c].decimals, value);
        }
        fputs("</tr>\n", out);
    }
    fputs("</table></div>\n", out);
}

static void add_curve(report_plot *plot, const report_flight *flight, enum report_column x,
                      enum report_column y, const char *title)
{
    static const double kilo = 1e-3;
    if (plot->curve_count == REPORT_CURVES_MAX || !report_flight_has(flight, y)) return;
    plot->curve[plot->curve_count++] = (report_curve){
        .flight = flight,
        .x = x,
        .y = y,
        .title = title,
        .x_scale = x == REPORT_bytes_down ? kilo : 1,
        .y_scale = y == REPORT_bytes_down || y == REPORT_bytes_up ? kilo : 1,
    };
}

static int put_flight(FILE *out, const report_content *content, const report_flight *flight,
                      char *why, size_t why_bytes)
{
    report_plot triangles = { .title = "Triangles drawn",
                              .x_label = "seconds",
                              .y_label = "triangles" };
    report_plot bytes = { .title = "Bytes since the start", .x_label = "seconds", .y_label = "kB" };
    report_plot nodes = { .title = "Nodes", .x_label = "seconds", .y_label = "nodes" };
    report_plot panoramas = { .title = "Panoramas asked for",
                              .x_label = "seconds",
                              .y_label = "panoramas" };
    report_plot error = { .title = "Error of the picture",
                          .x_label = "seconds",
                          .y_label = "pixels",
                          .logarithmic_y = 1 };
    report_plot picture = { .title = "Difference to the picture as it should be",
                            .x_label = "seconds",
                            .y_label = "of 255",
                            .logarithmic_y = 1 };
    add_curve(&triangles, flight, REPORT_t_s, REPORT_triangles, "triangles");
    add_curve(&bytes, flight, REPORT_t_s, REPORT_bytes_down, "down");
    add_curve(&bytes, flight, REPORT_t_s, REPORT_bytes_up, "up");
    add_curve(&nodes, flight, REPORT_t_s, REPORT_nodes_held, "held");
    add_curve(&nodes, flight, REPORT_t_s, REPORT_nodes_drawn, "drawn");
    if (flight->row[flight->row_count - 1].value[REPORT_panoramas] > 0)
        add_curve(&panoramas, flight, REPORT_t_s, REPORT_panoramas, "panoramas");
    add_curve(&error, flight, REPORT_t_s, REPORT_err_px_rms, "rms");
    add_curve(&error, flight, REPORT_t_s, REPORT_err_px_p95, "95 %");
    add_curve(&picture, flight, REPORT_t_s, REPORT_diff_mean, "mean");
    add_curve(&picture, flight, REPORT_t_s, REPORT_diff_p95, "95 %");
    fputs("<h2>", out);
    report_put_html(out, flight->name);
    fputs("</h2>\n<div class=\"plots\">\n", out);
    if (report_plot_put(out, content->folder, &triangles, why, why_bytes) ||
        report_plot_put(out, content->folder, &bytes, why, why_bytes) ||
        report_plot_put(out, content->folder, &nodes, why, why_bytes) ||
        report_plot_put(out, content->folder, &panoramas, why, why_bytes) ||
        report_plot_put(out, content->folder, &error, why, why_bytes) ||
        report_plot_put(out, content->folder, &picture, why, why_bytes))
        return -1;
    fputs("</div>\n", out);
    return 0;
}

static int put_comparison(FILE *out, const report_content *content, char *why, size_t why_bytes)
{
    report_plot bytes = { .title = "Bytes down", .x_label = "seconds", .y_label = "kB" };
    report_plot error = { .title = "Error over time",
                          .x_label = "seconds",
                          .y_label = "pixels rms",
                          .logarithmic_y = 1 };
    report_plot work = { .title = "Error against bytes",
                         .x_label = "kB down",
                         .y_label = "pixels rms",
                         .logarithmic_y = 1 };
    for (size_t i = 0; i < content->flight_count; i++) {
        const report_flight *flight = &content->flight[i];
        add_curve(&bytes, flight, REPORT_t_s, REPORT_bytes_down, flight->name);
        add_curve(&error, flight, REPORT_t_s, REPORT_err_px_rms, flight->name);
        add_curve(&work, flight, REPORT_bytes_down, REPORT_err_px_rms, flight->name);
    }
    fputs("<div class=\"plots\">\n", out);
    if (report_plot_put(out, content->folder, &bytes, why, why_bytes) ||
        report_plot_put(out, content->folder, &error, why, why_bytes) ||
        report_plot_put(out, content->folder, &work, why, why_bytes))
        return -1;
    fputs("</div>\n", out);
    return 0;
}

static void put_pictures(FILE *out, const report_content *content)
{
    if (!content->picture_count) return;
    fputs("<h2>Pictures</h2>\n<div class=\"plots\">\n", out);
    for (size_t i = 0; i < content->picture_count; i++) {
        fputs("<figure><img src=\"", out);
        put_link(out, content->picture[i]);
        fputs("\" alt=\"\"><figcaption>", out);
        report_put_html(out, content->picture[i]);
        fputs("</figcaption></figure>\n", out);
    }
    fputs("</div>\n", out);
}

static double most_different(const report_sheet *sheet)
{
    double most = 0;
    for (size_t i = 0; i < sheet->moments; i++) most = fmax(most, sheet->differ_percent[i]);
    return most;
}

#define SHEET_CAPTION \
    "below each other, then the difference, %d times as large. At most %.2f %% of a picture's pixels differ by more than %d/255."

static void put_sheet(FILE *out, const report_sheet *sheet)
{
    fprintf(out, "<h2>%s</h2>\n<figure class=\"wide\"><img src=\"%s\" alt=\"\"><figcaption>",
            sheet->heading, sheet->file);
    report_put_html(out, sheet->name[0]);
    fputs(" and ", out);
    report_put_html(out, sheet->name[1]);
    fprintf(out, " " SHEET_CAPTION "</figcaption></figure>\n", sheet->amplified,
            most_different(sheet), REPORT_SHEET_VISIBLE);
}

static void put_heading(FILE *out, const char *title)
{
    fputs("<h1>", out);
    report_put_html(out, title);
    fputs("</h1>\n", out);
}

int report_page_html(const report_content *content, char *why, size_t why_bytes)
{
    FILE *out = open_page(content, "index.html", why, why_bytes);
    int rc = 0;
    if (!out) return -1;
    fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>",
          out);
    report_put_html(out, content->title);
    fputs(
        "</title>\n<style>\n"
        "body{font:15px/1.5 sans-serif;margin:2em auto;max-width:1340px;padding:0 1em;color:#222}\n"
        "table{border-collapse:collapse}td,th{padding:.2em .7em;border-bottom:1px solid #ddd;text-align:right}\n"
        "th{vertical-align:bottom}td:first-child,th:first-child{text-align:left;white-space:nowrap}@media(max-width:500px){table{font-size:13px}}.wide{overflow-x:auto;margin:1em 0}\n"
        ".plots{display:flex;flex-wrap:wrap;gap:1em}figure{margin:0;max-width:100%}\n"
        "figure svg{width:600px;max-width:100%}.plots img{max-width:100%}\n"
        "figcaption{color:#666;font-size:13px}\n",
        out);
    if (content->slider) fputs(report_slider_style, out);
    fputs("</style></head><body>\n", out);
    if (content->slider)
        report_slider_html(out, content->slider, content->title, content->owner);
    else
        put_heading(out, content->title);
    if (content->paper) rc = report_matrix_html(out, content, why, why_bytes);
    if (!rc && content->work) rc = report_work_html(out, content, why, why_bytes);
    report_findings(out, content, 1);
    fputs("<h2>All flights</h2>\n", out);
    put_html_table(out, content);
    if (!content->paper && content->flight_count > 1)
        rc = put_comparison(out, content, why, why_bytes);
    for (size_t i = 0; i < content->sheet_count; i++) put_sheet(out, &content->sheet[i]);
    put_pictures(out, content);
    for (size_t i = 0; i < content->flight_count && !rc; i++)
        rc = put_flight(out, content, &content->flight[i], why, why_bytes);
    fputs("</body></html>\n", out);
    if (rc)
        fclose(out);
    else
        rc = close_page(out, content, "index.html", why, why_bytes);
    return rc;
}

/* ---- Markdown and JSON ---- */
int report_page_markdown(const report_content *content, char *why, size_t why_bytes)
{
    FILE *out = open_page(content, "REPORT.md", why, why_bytes);
    uint8_t shown[SUMMARY_COLUMNS];
    if (!out) return -1;
    find_shown(content, shown);
    fputs("# ", out);
    report_put_markdown(out, content->title);
    fputs("\n", out);
    if (content->slider) report_slider_markdown(out, content->slider, content->owner);
    if (content->paper) report_matrix_markdown(out, content);
    report_findings(out, content, 0);
    fputs("\n## All flights\n\n", out);
    fputs("| flight |", out);
    for (int c = 0; c < SUMMARY_COLUMNS; c++)
        if (shown[c]) fprintf(out, " %s |", summary_columns[c].heading);
    fputs("\n| :-- |", out);
    for (int c = 0; c < SUMMARY_COLUMNS; c++)
        if (shown[c]) fputs(" --: |", out);
    for (size_t i = 0; i < content->flight_count; i++) {
        report_summary summary;
        report_summarise(&content->flight[i], content->settle_s, &summary);
        fputs("\n| ", out);
        report_put_markdown(out, content->flight[i].name);
        fputs(" |", out);
        for (int c = 0; c < SUMMARY_COLUMNS; c++) {
            double value = summary_value(&summary, &summary_columns[c]);
            if (!shown[c]) continue;
            if (isnan(value))
                fputs(" – |", out);
            else
                fprintf(out, " %.*f |", summary_columns[c].decimals, value);
        }
    }
    fputs("\n", out);
    for (size_t i = 0; i < content->sheet_count; i++) {
        const report_sheet *sheet = &content->sheet[i];
        fprintf(out, "\n![%s](%s)\n\n", sheet->heading, sheet->file);
        report_put_markdown(out, sheet->name[0]);
        fputs(" and ", out);
        report_put_markdown(out, sheet->name[1]);
        fprintf(out, " " SHEET_CAPTION "\n", sheet->amplified, most_different(sheet),
                REPORT_SHEET_VISIBLE);
    }
    for (size_t i = 0; i < content->picture_count; i++) {
        fputs("\n![](", out);
        put_link(out, content->picture[i]);
        fputs(")\n", out);
    }
    return close_page(out, content, "REPORT.md", why, why_bytes);
}

static void put_json_text(const char *text)
{
    putchar('"');
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            printf("\\%c", *text);
        else if ((unsigned char)*text < ' ')
            printf("\\u%04x", (unsigned)*text);
        else
            putchar(*text);
    }
    putchar('"');
}

void report_page_json(const report_content *content)
{
    putchar('[');
    for (size_t i = 0; i < content->flight_count; i++) {
        report_summary summary;
        report_summarise(&content->flight[i], content->settle_s, &summary);
        printf("%s{\"flight\": ", i ? ",\n " : "");
        put_json_text(content->flight[i].name);
        for (int c = 0; c < SUMMARY_COLUMNS; c++) {
            double value = summary_value(&summary, &summary_columns[c]);
            printf(", \"%s\": ", summary_columns[c].json);
            if (isnan(value))
                fputs("null", stdout);
            else
                printf("%.9g", value);
        }
        putchar('}');
    }
    puts("]");
}
