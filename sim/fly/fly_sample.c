#include "fly_sample.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

enum column_kind { PLACE, MEAN, SOME, TOTAL, MOST, LAST };
typedef struct column {
    const char *name, *format;
    enum column_kind kind;
    size_t offset;
} column;

#define X(name, format, kind, from) { #name, format, kind, offsetof(fly_sample, name) },
static const column first_column[] = { FLY_COLUMNS_FIRST(X) };
static const column last_column[] = { FLY_COLUMNS_LAST(X) };
#undef X
enum {
    FIRST_COUNT = sizeof first_column / sizeof first_column[0],
    LAST_COUNT = sizeof last_column / sizeof last_column[0]
};

static double value(const fly_sample *sample, const column *c)
{
    return *(const double *)((const char *)sample + c->offset);
}

static void print_value(FILE *file, const column *c, double number)
{
    if (isnan(number))
        fputs("nan", file);
    else
        fprintf(file, c->format, number);
}

double fly_delay_s(const sim_link_load *load)
{
    return load->packets ? (double)load->delay_us / (double)load->packets / 1e6 : 0;
}

void fly_sample_take(fly_sample *sample, const fly_sources *from)
{
#define X(name, format, kind, where_from) sample->name = (double)(where_from);
    FLY_COLUMNS_FIRST(X)
    FLY_COLUMNS_LAST(X)
#undef X
    memcpy(sample->ground_px_percent, from->ground_px_percent, sizeof sample->ground_px_percent);
    sample->geometry_hash = from->geometry_hash;
    sample->request_hash = from->request_hash;
}

void fly_csv_header(FILE *file)
{
    for (int i = 0; i < FIRST_COUNT; i++) fprintf(file, "%s,", first_column[i].name);
    fputs("frame_hash,geometry_hash,request_hash", file);
    for (int i = 0; i < LAST_COUNT; i++) fprintf(file, ",%s", last_column[i].name);
    fputc('\n', file);
}

void fly_csv_row(FILE *file, const fly_sample *sample)
{
    for (int i = 0; i < FIRST_COUNT; i++) {
        print_value(file, &first_column[i], value(sample, &first_column[i]));
        fputc(',', file);
    }
    fprintf(file, "%016" PRIx64 ",%016" PRIx64 ",%016" PRIx64, sample->frame_hash,
            sample->geometry_hash, sample->request_hash);
    for (int i = 0; i < LAST_COUNT; i++) {
        fputc(',', file);
        print_value(file, &last_column[i], value(sample, &last_column[i]));
    }
    fputc('\n', file);
}

/* Seconds until err_px_p95 first comes within 10 % of (or below) its mean over the last half of the
 * rows; -1 without an audit. */
static double settle_s(const fly_sample *sample, size_t count)
{
    double sum = 0;
    size_t half = count / 2;
    if (!count || isnan(sample[count - 1].err_px_p95)) return -1;
    for (size_t i = half; i < count; i++) sum += sample[i].err_px_p95;
    double final = sum / (double)(count - half);
    for (size_t i = 0; i < count; i++)
        if (sample[i].nodes_drawn > 0 && sample[i].err_px_p95 <= final * 1.1) return sample[i].t_s;
    return -1;
}

/* Summary of one column over the rows from `from`; TOTAL against the row before. */
static double summarise(const column *c, const fly_sample *sample, size_t from, size_t count)
{
    double sum = 0, most = -INFINITY;
    size_t counted = 0;
    if (from >= count) return NAN;
    if (c->kind == TOTAL)
        return value(&sample[count - 1], c) - (from ? value(&sample[from - 1], c) : 0);
    if (c->kind == LAST) return value(&sample[count - 1], c);
    for (size_t i = from; i < count; i++) {
        double one = value(&sample[i], c);
        most = fmax(most, one);
        if (c->kind == SOME && isnan(one)) continue;
        sum += one;
        counted++;
    }
    return c->kind == MOST ? most : sum / (double)counted;
}

static void json_columns(FILE *file, const column *c, int columns, const fly_sample *sample,
                         size_t from, size_t count)
{
    for (int i = 0; i < columns; i++) {
        double number = summarise(&c[i], sample, from, count);
        if (c[i].kind == PLACE) continue;
        if (isfinite(number))
            fprintf(file, ",\n  \"%s\": %.*f", c[i].name, c[i].kind == TOTAL ? 0 : 3, number);
        else
            fprintf(file, ",\n  \"%s\": null", c[i].name);
    }
}

static void json_string(FILE *file, const char *text)
{
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            fprintf(file, "\\%c", *text);
        else if ((unsigned char)*text < 0x20)
            fprintf(file, "\\u%04x", (unsigned)(unsigned char)*text);
        else
            fputc(*text, file);
    }
    fputc('"', file);
}

static void json_text(FILE *file, const char *name, const char *text)
{
    fprintf(file, ",\n  \"%s\": ", name);
    json_string(file, text);
}

static void json_texts(FILE *file, const char *name, const sys_texts *texts)
{
    fprintf(file, ",\n  \"%s\": [", name);
    for (size_t i = 0; i < texts->count; i++) {
        if (i) fputs(", ", file);
        json_string(file, texts->text[i]);
    }
    fputc(']', file);
}

/* Mean shares over the rows from `from`: a number for each ground. */
static void json_grounds(FILE *file, const fly_sample *sample, size_t from, size_t count,
                         uint32_t grounds)
{
    fputs(",\n  \"ground_px_percent\": ", file);
    if (from >= count || isnan(sample[from].ground_px_percent[0])) {
        fputs("null", file);
        return;
    }
    for (uint32_t ground = 0; ground < grounds; ground++) {
        double sum = 0;
        for (size_t i = from; i < count; i++) sum += sample[i].ground_px_percent[ground];
        fprintf(file, "%s%.3f", ground ? ", " : "[", sum / (double)(count - from));
    }
    fputc(']', file);
}

static void json_place(FILE *file, const char *name, const fly_sample *row)
{
    if (!row || isnan(row->lat_deg))
        fprintf(file, ",\n  \"%s\": null", name);
    else
        fprintf(file,
                ",\n  \"%s\": {\"lat_deg\": %.7f, \"lon_deg\": %.7f, \"heading_true_deg\": %.3f}",
                name, row->lat_deg, row->lon_deg, row->heading_true_deg);
}

void fly_json(FILE *file, const fly_options *options, const fly_sample *sample, size_t count,
              const fly_totals *totals)
{
    size_t from = 0;
    while (from < count && sample[from].t_s < options->settle_s) from++;
    /* the row at the end of settling is where totals start */
    if (from + 1 < count && sample[from].t_s <= options->settle_s) from++;
    fprintf(file, "{\n  \"seed\": %" PRIu64 ",\n  \"frames\": %" PRIu32 ",\n  \"settle_s\": %.3f",
            options->seed, totals->frames, settle_s(sample, count));
    json_text(file, "pack", options->pack_path);
    json_texts(file, "packs", &options->packs);
    json_texts(file, "local", &options->locals);
    if (options->truth_path)
        json_text(file, "truth", options->truth_path);
    else
        fputs(",\n  \"truth\": null", file);
    json_text(file, "link", options->server ? options->server : options->link_text);
    json_text(file, "quality", options->quality_text);
    json_text(file, "backend", fly_backend_name(options->backend));
    json_text(file, "far", sim_far_words[options->use_far]);
    fprintf(file, ",\n  \"speed_kmh\": %g,\n  \"seconds\": %g,\n  \"panorama\": %s",
            options->speed_kmh, options->seconds, options->panorama.enabled ? "true" : "false");
    json_place(file, "first_place", count ? &sample[0] : NULL);
    json_place(file, "last_place", count ? &sample[count - 1] : NULL);
    json_columns(file, first_column, FIRST_COUNT, sample, from, count);
    json_columns(file, last_column, LAST_COUNT, sample, from, count);
    json_grounds(file, sample, from, count, totals->grounds);
    fprintf(file,
            ",\n  \"stitched_frames\": %" PRIu32 ",\n  \"crack_frames\": %" PRIu32
            ",\n  \"empty_frames\": %" PRIu32 ",\n  \"panoramas_in_flight_high\": %" PRIu32,
            totals->stitched_frames, totals->crack_frames, totals->empty_frames,
            totals->panoramas_in_flight_high);
    fprintf(
        file,
        ",\n  \"bytes_down_all\": %.0f,\n  \"bytes_up_all\": %.0f,\n  \"memory_used\": %" PRIu64,
        totals->bytes_down_all, totals->bytes_up_all, totals->memory_used);
    fprintf(file,
            ",\n  \"frame_hash\": \"%016" PRIx64 "\",\n  \"geometry_hash\": \"%016" PRIx64
            "\",\n  \"request_hash\": \"%016" PRIx64 "\"\n}\n",
            totals->frame_hash, count ? sample[count - 1].geometry_hash : 0,
            count ? sample[count - 1].request_hash : 0);
}
