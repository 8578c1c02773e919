/* One flight's CSV (farfield-fly --csv): columns found by the names in its header line, read whole
 * into memory. */
#ifndef REPORT_CSV_H
#define REPORT_CSV_H

#include <stddef.h>

/* X(name, need): the columns that the report uses, as the header line has them
 * (sim/fly/fly_sample.h); a file may have more, in any order. Errors may lack (flight without
 * auditor), kinds of bytes too (over real sockets): NAN. */
/* clang-format off */
#define REPORT_COLUMN_LIST(X) \
    X(t_s, NEEDED) \
    X(triangles, NEEDED) \
    X(nodes_drawn, NEEDED) \
    X(nodes_held, NEEDED) \
    X(bytes_down, NEEDED) \
    X(bytes_up, NEEDED) \
    X(requests, NEEDED) \
    X(panoramas, NEEDED) \
    X(err_px_rms, MAY_LACK) \
    X(err_px_p95, MAY_LACK) \
    X(err_px_max, MAY_LACK) \
    X(undrawn_px_percent, MAY_LACK) \
    X(diff_mean, MAY_LACK) \
    X(diff_p95, MAY_LACK) \
    X(ssim, MAY_LACK) \
    X(skyline_px_rms, MAY_LACK) \
    X(truth_error_m, MAY_LACK) \
    X(square_px_waiting, MAY_LACK) \
    X(square_px_depth, MAY_LACK) \
    X(square_px_stub, MAY_LACK) \
    X(square_px_quality, MAY_LACK) \
    X(square_px_panorama, MAY_LACK) \
    X(square_px_undrawn, MAY_LACK) \
    X(bytes_heights, MAY_LACK) \
    X(bytes_images, MAY_LACK) \
    X(bytes_faces, MAY_LACK) \
    X(bytes_overhead, MAY_LACK) \
    X(bytes_judged, MAY_LACK) \
    X(unused_heights, MAY_LACK) \
    X(unused_images, MAY_LACK) \
    X(unused_faces, MAY_LACK) \
    X(unused_supporting, MAY_LACK) \
    X(relevance_percent, MAY_LACK) \
    X(bytes_reserve, MAY_LACK) \
    X(unused_reserve, MAY_LACK) \
    X(relevance_no_reserve_percent, MAY_LACK) \
    X(unused_hidden, MAY_LACK) \
    X(far_sets, MAY_LACK) \
    X(far_sectors, MAY_LACK) \
    X(far_bytes, MAY_LACK) \
    X(bytes_far, MAY_LACK) \
    X(unused_far, MAY_LACK) \
    X(square_px_far, MAY_LACK)
/* clang-format on */
enum report_column {
#define X(name, need) REPORT_##name,
    REPORT_COLUMN_LIST(X)
#undef X
        REPORT_COLUMN_COUNT
};

typedef struct report_row {
    double value[REPORT_COLUMN_COUNT];
} report_row;

typedef struct report_flight {
    char *name; /* the file's name without folder and ".csv" */
    report_row *row;
    size_t row_count; /* at least 1 */
} report_flight;

/* Means over all rows; means of errors and differences over the rows from settle_s on, because
 * before that nothing may be drawn yet. NAN where a flight has none. */
typedef struct report_summary {
    double seconds, triangles_mean, triangles_max, nodes_drawn_mean, nodes_held_max;
    /* 60 s: NAN when the flight is shorter */
    double kb_down_60s, kb_down, kb_up, requests, panoramas;
    /* NAN where none came */
    double far_sets, far_sectors, kb_heights, kb_images, kb_faces, kb_far;
    double err_rms_mean, err_p95_mean, err_max, skyline_rms_mean;
    double diff_mean, diff_p95_mean, ssim_mean;
    double truth_error_m; /* how far the ground judged by may be from its source */
} report_summary;

/* 0, or -1 with the reason in `why` ("FILE: ..." or "FILE:LINE: ..."). */
int report_flight_load(report_flight *flight, const char *path, char *why, size_t why_bytes);
void report_flight_free(report_flight *flight);
/* Splits a line at its commas, in place, and drops blanks around fields. Returns the number of
 * fields, more than `most` when there are too many. */
size_t report_csv_split(char *line, char **field, size_t most);
/* Mean over the rows from from_s on, NAN where none has the column. */
double report_flight_mean(const report_flight *flight, enum report_column column, double from_s);
void report_summarise(const report_flight *flight, double settle_s, report_summary *summary);
/* 1 when any row has the column. */
int report_flight_has(const report_flight *flight, enum report_column column);

#endif
