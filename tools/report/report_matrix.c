#include "report_matrix.h"

#include "report_plot.h"
#include "report_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CONVERGENCE_S          120
#define STABLE_FACTOR          1.1
#define STABLE_PX              0.1
#define STABLE_UNDRAWN_PERCENT 1
#define STABLE_ROWS            3
#define REFERENCE_LINK         "lan"
#define SWEEP                  "sweep-"
#define SERIES_MAX             8
#define SERIES_NAME_BYTES      32

/* ---- figures ---- */

/* Is row i of the flight as good as the reference's row of its time? */
static int is_stable(const report_flight *flight, const report_flight *reference, double settle_s,
                     size_t i)
{
    const double *value = flight->row[i].value;
    double t_s = fmax(value[REPORT_t_s], settle_s);
    size_t at = 0;
    while (at < reference->row_count && reference->row[at].value[REPORT_t_s] < t_s) at++;
    if (at == reference->row_count || !(value[REPORT_nodes_drawn] > 0)) return 0;
    const double *best = reference->row[at].value;
    return value[REPORT_err_px_p95] <= STABLE_FACTOR * best[REPORT_err_px_p95] + STABLE_PX &&
           !(value[REPORT_undrawn_px_percent] >
             best[REPORT_undrawn_px_percent] + STABLE_UNDRAWN_PERCENT);
}

double report_stable_s(const report_flight *flight, const report_flight *reference, double settle_s)
{
    size_t together = 0;
    for (size_t i = 0; reference && i < flight->row_count; i++) {
        together = is_stable(flight, reference, settle_s, i) ? together + 1 : 0;
        if (together == STABLE_ROWS) return flight->row[i + 1 - STABLE_ROWS].value[REPORT_t_s];
    }
    return NAN;
}

double report_stable_percent(const report_flight *flight, const report_flight *reference,
                             double settle_s)
{
    size_t rows = 0, stable = 0;
    for (size_t i = 0; reference && i < flight->row_count; i++) {
        if (flight->row[i].value[REPORT_t_s] < settle_s) continue;
        rows++;
        stable += (size_t)is_stable(flight, reference, settle_s, i);
    }
    return rows ? 100.0 * (double)stable / (double)rows : NAN;
}

void report_figures_of(const report_flight *flight, const report_flight *reference, double settle_s,
                       report_figures *figures)
{
    *figures = (report_figures){
        .triangles = report_flight_mean(flight, REPORT_triangles, settle_s),
        .kilobytes = flight->row[flight->row_count - 1].value[REPORT_bytes_down] / 1000,
        .stable_s = report_stable_s(flight, reference, settle_s),
        .err_p95 = report_flight_mean(flight, REPORT_err_px_p95, settle_s),
        .undrawn = report_flight_mean(flight, REPORT_undrawn_px_percent, settle_s),
    };
}

const report_flight *report_find(const report_content *content, const char *name)
{
    for (size_t i = 0; i < content->flight_count; i++)
        if (!strcmp(content->flight[i].name, name)) return &content->flight[i];
    return NULL;
}

const report_flight *report_find_reference(const report_content *content, const char *name)
{
    char reference[sizeof REFERENCE_LINK + sizeof content->paper->row[0].name];
    const char *rest = strchr(name, '-');
    snprintf(reference, sizeof reference, "%s%s", REFERENCE_LINK, rest ? rest : "");
    return report_find(content, reference);
}

/* ---- tables ---- */

static void put_range(FILE *out, const report_style *s, double from, double to)
{
    if (isnan(from))
        report_table_word(out, s, "–");
    else if (from < to)
        fprintf(out, "%s%.0f–%.0f%s", s->cell_open, from, to, s->cell_close);
    else
        report_table_number(out, s, 0, from);
}

/* Writes a row for each flight of the paper that is among ours. */
static void put_paper(FILE *out, const report_style *s, const report_content *content)
{
    static const char *const head[] = { "link",
                                        "km/h",
                                        "quality",
                                        "panorama",
                                        "triangles, paper",
                                        "triangles",
                                        "ratio",
                                        "kB, paper",
                                        "kB",
                                        "ratio",
                                        "stable after s, paper",
                                        "stable after s",
                                        "error px, 95 %",
                                        "undrawn %" };
    report_table_head(out, s, head, sizeof head / sizeof *head);
    for (size_t i = 0; i < content->paper->row_count; i++) {
        const report_paper_row *paper = &content->paper->row[i];
        const report_flight *flight = report_find(content, paper->name);
        report_figures ours;
        if (!flight) continue;
        report_figures_of(flight, report_find_reference(content, paper->name), content->settle_s,
                          &ours);
        report_table_row(out, s);
        report_table_word(out, s, paper->link);
        report_table_word(out, s, paper->speed_kmh);
        report_table_word(out, s, paper->quality);
        report_table_word(out, s, paper->panorama);
        report_table_number(out, s, 0, paper->triangles);
        report_table_number(out, s, 0, ours.triangles);
        report_table_number(out, s, 2, ours.triangles / paper->triangles);
        report_table_number(out, s, 0, paper->kilobytes);
        report_table_number(out, s, 1, ours.kilobytes);
        report_table_number(out, s, 2, ours.kilobytes / paper->kilobytes);
        put_range(out, s, paper->stable_from_s, paper->stable_to_s);
        report_table_number(out, s, 0, ours.stable_s);
        report_table_number(out, s, 2, ours.err_p95);
        report_table_number(out, s, 1, ours.undrawn);
        report_table_row_end(out, s);
    }
    report_table_end(out, s);
}

static int is_sweep(const report_flight *flight)
{
    return !strncmp(flight->name, SWEEP, strlen(SWEEP));
}

static size_t count_sweep(const report_content *content)
{
    size_t count = 0;
    for (size_t i = 0; i < content->flight_count; i++)
        count += (size_t)is_sweep(&content->flight[i]);
    return count;
}

static void put_sweep(FILE *out, const report_style *s, const report_content *content)
{
    static const char *const head[] = { "quality", "triangles", "kB", "error px, 95 %",
                                        "undrawn %" };
    report_table_head(out, s, head, sizeof head / sizeof *head);
    for (size_t i = 0; i < content->flight_count; i++) {
        const report_flight *flight = &content->flight[i];
        report_figures ours;
        if (!is_sweep(flight)) continue;
        report_figures_of(flight, NULL, content->settle_s, &ours);
        report_table_row(out, s);
        report_table_word(out, s, flight->name + strlen(SWEEP));
        report_table_number(out, s, 0, ours.triangles);
        report_table_number(out, s, 1, ours.kilobytes);
        report_table_number(out, s, 2, ours.err_p95);
        report_table_number(out, s, 1, ours.undrawn);
        report_table_row_end(out, s);
    }
    report_table_end(out, s);
}

/* ---- plots ---- */

/* Plots the flights of one link and quality with panoramas, from the first second on. */
static int put_convergence(FILE *out, const report_content *content, const report_paper_row *group,
                           char *why, size_t why_bytes)
{
    char title[128];
    snprintf(title, sizeof title, "%s, %s quality, with panoramas", group->link, group->quality);
    report_plot plot = { .title = title,
                         .x_label = "seconds since the start",
                         .y_label = "error px, 95 %",
                         .logarithmic_y = 1,
                         .x_most = CONVERGENCE_S };
    for (size_t i = 0; i < content->paper->row_count && plot.curve_count < REPORT_CURVES_MAX; i++) {
        const report_paper_row *row = &content->paper->row[i];
        const report_flight *flight = report_find(content, row->name);
        if (!flight || strcmp(row->link, group->link) || strcmp(row->quality, group->quality) ||
            strcmp(row->panorama, "on") || !report_flight_has(flight, REPORT_err_px_p95))
            continue;
        plot.curve[plot.curve_count++] = (report_curve){ .flight = flight,
                                                         .x = REPORT_t_s,
                                                         .y = REPORT_err_px_p95,
                                                         .x_scale = 1,
                                                         .y_scale = 1,
                                                         .title = flight->name };
    }
    return report_plot_put(out, content->folder, &plot, why, why_bytes);
}

static int is_first_of_group(const report_paper *paper, size_t at)
{
    for (size_t i = 0; i < at; i++)
        if (!strcmp(paper->row[i].link, paper->row[at].link) &&
            !strcmp(paper->row[i].quality, paper->row[at].quality))
            return 0;
    return 1;
}

/* A series of the sweep as one curve: a row for each of its flights, by triangles. */
typedef struct series {
    char name[SERIES_NAME_BYTES];
    report_flight points;
} series;

static int by_triangles(const void *a, const void *b)
{
    double x = ((const report_row *)a)->value[REPORT_triangles],
           y = ((const report_row *)b)->value[REPORT_triangles];
    return (x > y) - (x < y);
}

static series *series_of(series *list, size_t *count, const char *name, size_t flights)
{
    const char *from = name + strlen(SWEEP), *end = strrchr(from, '-');
    size_t length = end ? (size_t)(end - from) : strlen(from);
    if (length >= SERIES_NAME_BYTES) length = SERIES_NAME_BYTES - 1;
    for (size_t i = 0; i < *count; i++)
        if (strlen(list[i].name) == length && !strncmp(list[i].name, from, length)) return &list[i];
    if (*count == SERIES_MAX) return NULL;
    series *added = &list[*count];
    added->points.row = calloc(flights, sizeof *added->points.row);
    if (!added->points.row) return NULL;
    memcpy(added->name, from, length);
    ++*count;
    return added;
}

static size_t collect_series(series *list, const report_content *content)
{
    size_t count = 0;
    for (size_t i = 0; i < content->flight_count; i++) {
        const report_flight *flight = &content->flight[i];
        report_figures ours;
        series *s = is_sweep(flight) ? series_of(list, &count, flight->name, content->flight_count)
                                     : NULL;
        if (!s) continue;
        report_figures_of(flight, NULL, content->settle_s, &ours);
        if (isnan(ours.err_p95)) continue;
        double *value = s->points.row[s->points.row_count++].value;
        value[REPORT_triangles] = ours.triangles;
        value[REPORT_bytes_down] = ours.kilobytes;
        value[REPORT_err_px_p95] = ours.err_p95;
    }
    for (size_t i = 0; i < count; i++)
        qsort(list[i].points.row, list[i].points.row_count, sizeof *list[i].points.row,
              by_triangles);
    return count;
}

static int put_work(FILE *out, const report_content *content, char *why, size_t why_bytes)
{
    series list[SERIES_MAX] = { { { 0 }, { 0 } } };
    size_t count = collect_series(list, content);
    report_plot plots[2] = { { .title = "Error against triangles",
                               .x_label = "triangles",
                               .y_label = "error px, 95 %",
                               .logarithmic_y = 1,
                               .points = 1 },
                             { .title = "Error against bytes",
                               .x_label = "kB down",
                               .y_label = "error px, 95 %",
                               .logarithmic_y = 1,
                               .points = 1 } };
    static const enum report_column work[2] = { REPORT_triangles, REPORT_bytes_down };
    int rc = 0;
    for (int p = 0; p < 2 && !rc; p++) {
        for (size_t i = 0; i < count; i++)
            if (list[i].points.row_count)
                plots[p].curve[plots[p].curve_count++] = (report_curve){ .flight = &list[i].points,
                                                                         .x = work[p],
                                                                         .y = REPORT_err_px_p95,
                                                                         .x_scale = 1,
                                                                         .y_scale = 1,
                                                                         .title = list[i].name };
        rc = report_plot_put(out, content->folder, &plots[p], why, why_bytes);
    }
    for (size_t i = 0; i < count; i++) free(list[i].points.row);
    return rc;
}

/* ---- instructions ---- */

/* Names a series: "px" for qualities px:E, "C" for C:DEPTH, low and high; and whether panoramas are
 * on. */
static void work_series_name(const report_work_row *row, char name[SERIES_NAME_BYTES])
{
    snprintf(name, SERIES_NAME_BYTES, "%s, panorama %s",
             strncmp(row->quality, "px", 2) ? "C" : "px", row->panorama);
}

/* Collects the rows of series, with instructions in the place of triangles. */
static size_t collect_work(series *list, const report_work *work)
{
    size_t count = 0;
    for (size_t i = 0; i < work->row_count; i++) {
        char name[SERIES_NAME_BYTES];
        size_t at = 0;
        work_series_name(&work->row[i], name);
        while (at < count && strcmp(list[at].name, name)) at++;
        if (at == SERIES_MAX) continue;
        if (at == count) {
            list[at].points.row = calloc(work->row_count, sizeof *list[at].points.row);
            if (!list[at].points.row) continue;
            strcpy(list[count++].name, name);
        }
        double *value = list[at].points.row[list[at].points.row_count++].value;
        value[REPORT_triangles] = work->row[i].instructions / 1e6;
        value[REPORT_err_px_p95] = work->row[i].err_px_p95;
    }
    for (size_t i = 0; i < count; i++)
        qsort(list[i].points.row, list[i].points.row_count, sizeof *list[i].points.row,
              by_triangles);
    return count;
}

int report_work_html(FILE *out, const report_content *content, char *why, size_t why_bytes)
{
    static const char *const head[] = { "quality", "panorama", "million instructions a frame",
                                        "error px, 95 %" };
    series list[SERIES_MAX] = { { { 0 }, { 0 } } };
    size_t count = collect_work(list, content->work);
    report_plot plot = { .title = "Error against instructions",
                         .x_label = "million instructions a frame",
                         .y_label = "error px, 95 %",
                         .logarithmic_y = 1,
                         .points = 1 };
    for (size_t i = 0; i < count; i++)
        plot.curve[plot.curve_count++] = (report_curve){ .flight = &list[i].points,
                                                         .x = REPORT_triangles,
                                                         .y = REPORT_err_px_p95,
                                                         .x_scale = 1,
                                                         .y_scale = 1,
                                                         .title = list[i].name };
    fputs(
        "<h2>Error against instructions</h2>\n<p>Counted on an armv6 (make bench-handheld).</p>\n<div class=\"plots\">\n",
        out);
    int rc = report_plot_put(out, content->folder, &plot, why, why_bytes);
    fputs("</div>\n", out);
    report_table_head(out, &report_style_html, head, sizeof head / sizeof *head);
    for (size_t i = 0; i < content->work->row_count; i++) {
        const report_work_row *row = &content->work->row[i];
        report_table_row(out, &report_style_html);
        report_table_name(out, &report_style_html, row->quality);
        report_table_name(out, &report_style_html, row->panorama);
        report_table_number(out, &report_style_html, 2, row->instructions / 1e6);
        report_table_number(out, &report_style_html, 2, row->err_px_p95);
        report_table_row_end(out, &report_style_html);
    }
    report_table_end(out, &report_style_html);
    for (size_t i = 0; i < count; i++) free(list[i].points.row);
    return rc;
}

/* ---- pages ---- */

static const char about_paper[] =
    "Triangles and errors are means in flight; kilobytes are all that came down, from the first second on. Stable: the error's 95th "
    "percentile is at most 10 % and 0.1 px above that of the same flight over a LAN, with as much ground drawn, for three rows; the paper "
    "watched its triangles.";

int report_matrix_html(FILE *out, const report_content *content, char *why, size_t why_bytes)
{
    int rc = 0;
    fprintf(out, "<h2>Beside the paper</h2>\n<p>%s</p>\n", about_paper);
    put_paper(out, &report_style_html, content);
    fputs("<h2>Error since the start</h2>\n<div class=\"plots\">\n", out);
    for (size_t i = 0; i < content->paper->row_count && !rc; i++)
        if (is_first_of_group(content->paper, i))
            rc = put_convergence(out, content, &content->paper->row[i], why, why_bytes);
    fputs("</div>\n", out);
    if (rc || !count_sweep(content)) return rc;
    fputs(
        "<h2>Error against work</h2>\n<p>One flight in several qualities: px is the error allowed in pixels, C the paper's.</p>\n",
        out);
    put_sweep(out, &report_style_html, content);
    fputs("<div class=\"plots\">\n", out);
    rc = put_work(out, content, why, why_bytes);
    fputs("</div>\n", out);
    return rc;
}

void report_matrix_markdown(FILE *out, const report_content *content)
{
    fprintf(out, "\n## Beside the paper\n\n%s\n\n", about_paper);
    put_paper(out, &report_style_markdown, content);
    if (count_sweep(content)) {
        fputs("\n## Error against work\n\n", out);
        put_sweep(out, &report_style_markdown, content);
    }
}
