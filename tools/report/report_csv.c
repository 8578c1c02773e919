#include "report_csv.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIELDS_MAX 128

enum { MAY_LACK, NEEDED };
static const char *const column_names[REPORT_COLUMN_COUNT] = {
#define X(name, need) #name,
    REPORT_COLUMN_LIST(X)
#undef X
};
static const int column_required[REPORT_COLUMN_COUNT] = {
#define X(name, need) need,
    REPORT_COLUMN_LIST(X)
#undef X
};

typedef struct reader {
    const char *path;
    FILE *file;
    char *line;
    size_t line_capacity, line_number, field_count;
    int field_of[REPORT_COLUMN_COUNT]; /* place of the column in a line, -1: missing */
    char *why;
    size_t why_bytes;
} reader;

static int refuse(reader *in, const char *format, ...) __attribute__((format(printf, 2, 3)));
static int refuse(reader *in, const char *format, ...)
{
    va_list args;
    int used = in->line_number
                   ? snprintf(in->why, in->why_bytes, "%s:%zu: ", in->path, in->line_number)
                   : snprintf(in->why, in->why_bytes, "%s: ", in->path);
    va_start(args, format);
    if (used >= 0 && (size_t)used < in->why_bytes)
        vsnprintf(in->why + used, in->why_bytes - (size_t)used, format, args);
    va_end(args);
    return -1;
}

size_t report_csv_split(char *line, char **field, size_t most)
{
    size_t count = 0;
    char *end;
    line[strcspn(line, "\r\n")] = 0;
    for (char *at = line; at; at = end) {
        end = strchr(at, ',');
        if (end) *end++ = 0;
        at += strspn(at, " \t");
        for (size_t n = strlen(at); n && (at[n - 1] == ' ' || at[n - 1] == '\t'); n--)
            at[n - 1] = 0;
        if (count == most) return most + 1;
        field[count++] = at;
    }
    return count;
}

/* Reads the next line. 1: there is one, 0: the file has ended, -1: the line was refused. */
static int next_line(reader *in)
{
    errno = 0;
    ssize_t length = getline(&in->line, &in->line_capacity, in->file);
    if (length < 0) return errno ? refuse(in, "%s", strerror(errno)) : 0;
    in->line_number++;
    if (strlen(in->line) != (size_t)length) return refuse(in, "not text");
    return 1;
}

static int read_header(reader *in)
{
    char *field[FIELDS_MAX];
    int got = next_line(in);
    if (got < 0) return -1;
    if (!got) return refuse(in, "empty file");
    in->field_count = report_csv_split(in->line, field, FIELDS_MAX);
    if (in->field_count > FIELDS_MAX) return refuse(in, "more than %d columns", FIELDS_MAX);
    for (int c = 0; c < REPORT_COLUMN_COUNT; c++) {
        in->field_of[c] = -1;
        for (size_t f = 0; f < in->field_count; f++)
            if (!strcmp(field[f], column_names[c])) in->field_of[c] = (int)f;
        if (in->field_of[c] < 0 && column_required[c])
            return refuse(in, "no column %s: not the CSV of a flight", column_names[c]);
    }
    return 0;
}

static int read_value(reader *in, char *const *field, int column, double *value)
{
    char *end;
    const char *text = in->field_of[column] < 0 ? "" : field[in->field_of[column]];
    *value = *text ? strtod(text, &end) : NAN;
    if (*text && *end) return refuse(in, "%s is not a number: %.40s", column_names[column], text);
    if (!column_required[column] && (isnan(*value) || *value < 0)) {
        *value = NAN; /* not audited */
        return 0;
    }
    if (!(*value >= 0 && *value < 1e15))
        return refuse(in, "%s is out of range: %.40s", column_names[column], text);
    return 0;
}

static int read_row(reader *in, report_row *row)
{
    char *field[FIELDS_MAX];
    size_t count = report_csv_split(in->line, field, FIELDS_MAX);
    if (count != in->field_count)
        return refuse(in, "%zu fields where the header has %zu", count, in->field_count);
    for (int c = 0; c < REPORT_COLUMN_COUNT; c++)
        if (read_value(in, field, c, &row->value[c])) return -1;
    return 0;
}

static int read_rows(reader *in, report_flight *flight)
{
    size_t capacity = 0;
    int got;
    while ((got = next_line(in)) > 0) {
        if (flight->row_count == capacity) {
            capacity = capacity ? 2 * capacity : 256;
            report_row *grown = realloc(flight->row, capacity * sizeof *grown);
            if (!grown) return refuse(in, "out of memory");
            flight->row = grown;
        }
        report_row *row = &flight->row[flight->row_count];
        if (read_row(in, row)) return -1;
        if (flight->row_count && row->value[REPORT_t_s] < row[-1].value[REPORT_t_s])
            return refuse(in, "t_s goes back");
        flight->row_count++;
    }
    if (got == 0 && !flight->row_count) return refuse(in, "no rows");
    return got;
}

static char *flight_name(const char *path)
{
    const char *base = strrchr(path, '/');
    base = base ? base + 1 : path;
    size_t length = strlen(base);
    if (length > 4 && !strcmp(base + length - 4, ".csv")) length -= 4;
    return strndup(base, length);
}

int report_flight_load(report_flight *flight, const char *path, char *why, size_t why_bytes)
{
    reader in = { .path = path, .why = why, .why_bytes = why_bytes };
    int rc;
    memset(flight, 0, sizeof *flight);
    flight->name = flight_name(path);
    in.file = fopen(path, "r");
    if (!in.file)
        rc = refuse(&in, "%s", strerror(errno));
    else
        rc = read_header(&in) || read_rows(&in, flight) ? -1 : 0;
    if (in.file) fclose(in.file);
    free(in.line);
    if (rc) report_flight_free(flight);
    return rc;
}

void report_flight_free(report_flight *flight)
{
    free(flight->name);
    free(flight->row);
    memset(flight, 0, sizeof *flight);
}

double report_flight_mean(const report_flight *flight, enum report_column column, double from_s)
{
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < flight->row_count; i++) {
        double value = flight->row[i].value[column];
        if (isnan(value) || flight->row[i].value[REPORT_t_s] < from_s) continue;
        sum += value;
        count++;
    }
    return count ? sum / (double)count : NAN;
}

static double largest(const report_flight *flight, enum report_column column, double from_s)
{
    double most = NAN;
    for (size_t i = 0; i < flight->row_count; i++)
        if (flight->row[i].value[REPORT_t_s] >= from_s)
            most = fmax(most, flight->row[i].value[column]);
    return most;
}

int report_flight_has(const report_flight *flight, enum report_column column)
{
    return !isnan(largest(flight, column, 0));
}

/* NAN for 0, too: what a flight did not use is not told. */
static double some(double value) { return value > 0 ? value : NAN; }

void report_summarise(const report_flight *flight, double settle_s, report_summary *summary)
{
    const double *last = flight->row[flight->row_count - 1].value;
    *summary = (report_summary){
        .seconds = last[REPORT_t_s],
        .triangles_mean = report_flight_mean(flight, REPORT_triangles, 0),
        .triangles_max = largest(flight, REPORT_triangles, 0),
        .nodes_drawn_mean = report_flight_mean(flight, REPORT_nodes_drawn, 0),
        .nodes_held_max = largest(flight, REPORT_nodes_held, 0),
        .kb_down_60s = NAN,
        .kb_down = last[REPORT_bytes_down] / 1000,
        .kb_up = last[REPORT_bytes_up] / 1000,
        .requests = last[REPORT_requests],
        .panoramas = last[REPORT_panoramas],
        .far_sets = some(last[REPORT_far_sets]),
        .far_sectors = some(last[REPORT_far_sectors]),
        .kb_heights = some(last[REPORT_bytes_heights]) / 1000,
        .kb_images = some(last[REPORT_bytes_images]) / 1000,
        .kb_faces = some(last[REPORT_bytes_faces]) / 1000,
        .kb_far = some(last[REPORT_far_bytes]) / 1000,
        .err_rms_mean = report_flight_mean(flight, REPORT_err_px_rms, settle_s),
        .err_p95_mean = report_flight_mean(flight, REPORT_err_px_p95, settle_s),
        .err_max = largest(flight, REPORT_err_px_max, settle_s),
        .diff_mean = report_flight_mean(flight, REPORT_diff_mean, settle_s),
        .diff_p95_mean = report_flight_mean(flight, REPORT_diff_p95, settle_s),
        .ssim_mean = report_flight_mean(flight, REPORT_ssim, settle_s),
        .skyline_rms_mean = report_flight_mean(flight, REPORT_skyline_px_rms, settle_s),
        .truth_error_m = largest(flight, REPORT_truth_error_m, 0),
    };
    for (size_t i = 0; i < flight->row_count && summary->seconds >= 60; i++)
        if (flight->row[i].value[REPORT_t_s] <= 60)
            summary->kb_down_60s = flight->row[i].value[REPORT_bytes_down] / 1000;
}
