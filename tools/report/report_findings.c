#include "report_findings.h"

#include "report_matrix.h"
#include "report_table.h"

#include <math.h>
#include <string.h>

#define WHY_BYTES      256
#define PAPER_FLIGHT_S 300

/* A kind of bytes or a cause of error: its column, its words. */
typedef struct kind {
    enum report_column column;
    const char *name;
} kind;

static const kind bytes_kinds[] = { { REPORT_bytes_heights, "heights" },
                                    { REPORT_bytes_images, "images" },
                                    { REPORT_bytes_faces, "panorama faces" },
                                    { REPORT_bytes_far, "sets of far ground" },
                                    { REPORT_bytes_overhead, "greetings, pongs, refusals" },
                                    { REPORT_bytes_up, "requests (up)" } };
static const kind error_kinds[] = { { REPORT_square_px_depth, "depth limit of the quality" },
                                    { REPORT_square_px_stub, "finer ground not in the pack" },
                                    { REPORT_square_px_quality, "as coarse as the quality allows" },
                                    { REPORT_square_px_panorama,
                                      "parallax and texels of the panorama" },
                                    { REPORT_square_px_far, "outlines of far ground" },
                                    { REPORT_square_px_waiting, "ground not come yet" },
                                    { REPORT_square_px_undrawn, "ground not drawn" } };
enum {
    BYTES_KINDS = sizeof bytes_kinds / sizeof *bytes_kinds,
    ERROR_KINDS = sizeof error_kinds / sizeof *error_kinds,
    KINDS_MAX = 7
};

static double last(const report_flight *flight, enum report_column column)
{
    return flight->row[flight->row_count - 1].value[column];
}

static double zero_if_nan(double value) { return isnan(value) ? 0 : value; }

static int is_over_lan(const report_flight *flight) { return !strncmp(flight->name, "lan-", 4); }

/* ---- sources of bytes and of error ---- */

static void sum_kinds(const report_content *content, const kind *list, int count, int error,
                      double sum[KINDS_MAX])
{
    for (int k = 0; k < count; k++) sum[k] = 0;
    for (size_t i = 0; i < content->flight_count; i++) {
        const report_flight *flight = &content->flight[i];
        if (is_over_lan(flight) ||
            !report_flight_has(flight, error ? REPORT_err_px_rms : REPORT_bytes_heights))
            continue;
        for (int k = 0; k < count; k++)
            sum[k] += zero_if_nan(
                error ? report_flight_mean(flight, list[k].column, content->settle_s)
                      : last(flight, list[k].column));
    }
}

/* Lists the kinds from the largest on, each with its share. */
static void put_sources(FILE *out, const report_style *style, const report_content *content,
                        const kind *list, int count, int error)
{
    static const char *const head[2][2] = { { "source of bytes", "% of all" },
                                            { "source of error", "% of the squares" } };
    double sum[KINDS_MAX], all = 0;
    int order[KINDS_MAX];
    sum_kinds(content, list, count, error, sum);
    for (int k = 0; k < count; k++) {
        int at = k;
        for (; at > 0 && sum[order[at - 1]] < sum[k]; at--) order[at] = order[at - 1];
        order[at] = k;
        all += sum[k];
    }
    if (!(all > 0)) return;
    report_table_head(out, style, head[error], 2);
    for (int k = 0; k < count; k++) {
        report_table_row(out, style);
        report_table_word(out, style, list[order[k]].name);
        report_table_number(out, style, 1, 100 * sum[order[k]] / all);
        report_table_row_end(out, style);
    }
    report_table_end(out, style);
    if (!style->html) fputs("\n", out);
}

/* ---- relevance ---- */

static void put_relevance(FILE *out, const report_style *style, const report_content *content)
{
    static const char *const head[] = { "flight",
                                        "relevance %",
                                        "without the reserve %",
                                        "kB heights",
                                        "kB images",
                                        "kB faces",
                                        "kB sets",
                                        "kB other",
                                        "never drawn: kB heights",
                                        "of these beside drawn ones",
                                        "of these hidden by near ground",
                                        "kB images",
                                        "kB faces",
                                        "kB sets",
                                        "of all these the reserve" };
    static const enum report_column column[] = { REPORT_bytes_heights,     REPORT_bytes_images,
                                                 REPORT_bytes_faces,       REPORT_bytes_far,
                                                 REPORT_bytes_overhead,    REPORT_unused_heights,
                                                 REPORT_unused_supporting, REPORT_unused_hidden,
                                                 REPORT_unused_images,     REPORT_unused_faces,
                                                 REPORT_unused_far,        REPORT_unused_reserve };
    report_table_head(out, style, head, sizeof head / sizeof *head);
    for (size_t i = 0; i < content->flight_count; i++) {
        const report_flight *flight = &content->flight[i];
        if (is_over_lan(flight) || !report_flight_has(flight, REPORT_bytes_heights)) continue;
        report_table_row(out, style);
        report_table_name(out, style, flight->name);
        report_table_number(out, style, 2, last(flight, REPORT_relevance_percent));
        report_table_number(out, style, 2, last(flight, REPORT_relevance_no_reserve_percent));
        for (size_t c = 0; c < sizeof column / sizeof *column; c++)
            report_table_number(out, style, 1, last(flight, column[c]) / 1000);
        report_table_row_end(out, style);
    }
    report_table_end(out, style);
    if (!style->html) fputs("\n", out);
}

/* ---- targets ---- */

/* The largest of some kinds in one flight, in words. */
static void tell_largest(const report_flight *flight, const kind *list, int count, double from_s,
                         int error, char why[WHY_BYTES])
{
    double most = -1, all = 0;
    const char *name = "";
    for (int k = 0; k < count; k++) {
        double value = zero_if_nan(error ? report_flight_mean(flight, list[k].column, from_s)
                                         : last(flight, list[k].column));
        all += value;
        if (value > most) {
            most = value;
            name = list[k].name;
        }
    }
    *why = '\0';
    if (all > 0) snprintf(why, WHY_BYTES, "most of it: %s, %.0f %%", name, 100 * most / all);
}

/* Writes a target's line. With `most` 1 the measured value may be at most the target, with 0 it
 * must be at least the target. */
static void put_target(FILE *out, const report_style *style, const char *what, int most,
                       double target, double measured, const char *why)
{
    char missed[64] = "hit";
    double by = most ? measured - target : target - measured;
    if (isnan(measured))
        snprintf(missed, sizeof missed, "missed: never");
    else if (by > 0)
        snprintf(missed, sizeof missed, "missed by %.3g", by);
    report_table_row(out, style);
    report_table_word(out, style, what);
    report_table_number(out, style, 2, target);
    report_table_number(out, style, 2, measured);
    report_table_word(out, style, missed);
    report_table_word(out, style, by > 0 || isnan(measured) ? why : "");
    report_table_row_end(out, style);
}

static void put_paper_targets(FILE *out, const report_style *style, const report_content *content)
{
    for (size_t i = 0; i < content->paper->row_count; i++) {
        const report_paper_row *paper = &content->paper->row[i];
        const report_flight *flight = report_find(content, paper->name);
        report_figures ours;
        char what[128], why[WHY_BYTES];
        if (!flight || last(flight, REPORT_t_s) < PAPER_FLIGHT_S || strcmp(paper->link, "umts") ||
            strcmp(paper->quality, "low") || strcmp(paper->panorama, "on"))
            continue;
        report_figures_of(flight, NULL, content->settle_s, &ours);
        tell_largest(flight, bytes_kinds, BYTES_KINDS, 0, 0, why);
        snprintf(what, sizeof what, "%s: kB of the paper's", paper->name);
        put_target(out, style, what, 1, 0.5, ours.kilobytes / paper->kilobytes, why);
        snprintf(what, sizeof what, "%s: triangles of the paper's", paper->name);
        put_target(out, style, what, 1, 1, ours.triangles / paper->triangles, "");
    }
}

static void put_stable_targets(FILE *out, const report_style *style, const report_content *content)
{
    static const struct {
        const char *name;
        double seconds;
    } row[] = { { "gprs-150-low-on", 15 },
                { "gprs-150-low-off", 15 },
                { "gprs-150-high-on", 40 },
                { "gprs-150-high-off", 40 } };
    const report_flight *fast = report_find(content, "gprs-1000-low-on");
    char what[128], why[WHY_BYTES];
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        const report_flight *flight = report_find(content, row[i].name),
                            *reference = report_find_reference(content, row[i].name);
        if (!flight || !reference) continue;
        tell_largest(flight, error_kinds, ERROR_KINDS, 0, 1, why);
        snprintf(what, sizeof what, "%s: seconds to a stable picture", row[i].name);
        put_target(out, style, what, 1, row[i].seconds,
                   report_stable_s(flight, reference, content->settle_s), why);
    }
    if (!fast || !report_find_reference(content, fast->name)) return;
    tell_largest(fast, error_kinds, ERROR_KINDS, content->settle_s, 1, why);
    put_target(
        out, style, "gprs-1000-low-on: % of rows as good as over a LAN (steady)", 0, 95,
        report_stable_percent(fast, report_find_reference(content, fast->name), content->settle_s),
        why);
}

/* The targets are the papers', whose clients ask for what is drawn only: the reserve is left out.
 * Of flights without a reserve, or from before there was one, both shares are the same. */
static void put_relevance_target(FILE *out, const report_style *style, const report_flight *flight,
                                 double percent)
{
    char what[128], why[WHY_BYTES];
    double reserve = zero_if_nan(last(flight, REPORT_unused_reserve)),
           supporting = last(flight, REPORT_unused_supporting),
           hidden = zero_if_nan(last(flight, REPORT_unused_hidden)),
           all = last(flight, REPORT_unused_heights) + last(flight, REPORT_unused_images) +
                 last(flight, REPORT_unused_faces) + zero_if_nan(last(flight, REPORT_unused_far)),
           with = last(flight, REPORT_relevance_percent),
           without = last(flight, REPORT_relevance_no_reserve_percent);
    if (isnan(without)) without = with;
    snprintf(what, sizeof what, "%s: relevance without the reserve %% (with it %.2f)", flight->name,
             with);
    snprintf(
        why, sizeof why,
        "never drawn: %.1f kB of neighbours without which nodes in view could not split, %.1f kB hidden by "
        "near ground, %.1f kB others, %.2f kB greetings and pongs",
        supporting / 1000, hidden / 1000, (all - supporting - hidden - reserve) / 1000,
        last(flight, REPORT_bytes_overhead) / 1000);
    put_target(out, style, what, 0, percent, without, why);
}

static void put_relevance_targets(FILE *out, const report_style *style,
                                  const report_content *content)
{
    static const char *const link[] = { "umts", "gprs" }, *const panorama[] = { "on", "off" };
    static const struct {
        const char *speed;
        double percent;
    } row[] = { { "0", 99.5 }, { "150", 95 } };
    for (int r = 0; r < 2; r++)
        for (int l = 0; l < 2; l++)
            for (int p = 0; p < 2; p++) {
                char name[64];
                snprintf(name, sizeof name, "%s-%s-low-%s", link[l], row[r].speed, panorama[p]);
                const report_flight *flight = report_find(content, name);
                if (flight && report_flight_has(flight, REPORT_relevance_percent))
                    put_relevance_target(out, style, flight, row[r].percent);
            }
}

/* ---- all ---- */

static int any_has(const report_content *content, enum report_column column)
{
    for (size_t i = 0; i < content->flight_count; i++)
        if (!is_over_lan(&content->flight[i]) && report_flight_has(&content->flight[i], column))
            return 1;
    return 0;
}

void report_findings(FILE *out, const report_content *content, int html)
{
    static const char *const head[] = { "target", "asked", "measured", "", "why" };
    const report_style *style = html ? &report_style_html : &report_style_markdown;
    if (content->paper) {
        report_table_heading(out, style, "Targets");
        report_table_head(out, style, head, sizeof head / sizeof *head);
        put_paper_targets(out, style, content);
        put_stable_targets(out, style, content);
        put_relevance_targets(out, style, content);
        report_table_end(out, style);
    }
    if (any_has(content, REPORT_bytes_heights) || any_has(content, REPORT_square_px_waiting)) {
        report_table_heading(out, style, "Where bytes go and error comes from");
        report_table_text(
            out, style,
            "Over all flights but those over a LAN. Bytes from the first second on; of the error the squares, in flight.");
        put_sources(out, style, content, bytes_kinds, BYTES_KINDS, 0);
        put_sources(out, style, content, error_kinds, ERROR_KINDS, 1);
    }
    if (!any_has(content, REPORT_bytes_heights)) return;
    report_table_heading(out, style, "Relevance");
    report_table_text(
        out, style,
        "The share of received bytes that a frame draws within 5 s of their arrival, since the start. A drawn node draws all "
        "it is built on; nodes out of view that only let a drawn one beside them be so fine are not drawn, but told apart. "
        "A panorama's face is drawn by the share of its pixels in the window that near ground does not hide.");
    put_relevance(out, style, content);
}
