/* One flight's CSV (farfield-fly --csv): columns found by the names in its header line, read whole
 * into memory. */
#ifndef REPORT_CSV_H
#define REPORT_CSV_H

#include <stddef.h>

/* Columns the report uses; a file may have more, in any order. Errors may be missing (flight
 * without auditor), kinds of bytes too (over real sockets): NAN. */
/* clang-format off */
#define REPORT_COLUMN_LIST(X) \
    X(T_S, "t_s", 1) \
    X(TRIANGLES, "triangles", 1) \
    X(NODES_DRAWN, "nodes_drawn", 1) \
    X(NODES_HELD, "nodes_held", 1) \
    X(BYTES_DOWN, "bytes_down", 1) \
    X(BYTES_UP, "bytes_up", 1) \
    X(REQUESTS, "requests", 1) \
    X(PANORAMAS, "panoramas", 1) \
    X(ERR_RMS, "err_px_rms", 0) \
    X(ERR_P95, "err_px_p95", 0) \
    X(ERR_MAX, "err_px_max", 0) \
    X(UNDRAWN, "undrawn_px_percent", 0) \
    X(WAITING, "square_px_waiting", 0) \
    X(DEPTH, "square_px_depth", 0) \
    X(QUALITY, "square_px_quality", 0) \
    X(PARALLAX, "square_px_panorama", 0) \
    X(MISSING, "square_px_undrawn", 0) \
    X(HEIGHTS, "bytes_heights", 0) \
    X(IMAGES, "bytes_images", 0) \
    X(FACES, "bytes_faces", 0) \
    X(OVERHEAD, "bytes_overhead", 0) \
    X(JUDGED, "bytes_judged", 0) \
    X(UNUSED_HEIGHTS, "unused_heights", 0) \
    X(UNUSED_IMAGES, "unused_images", 0) \
    X(UNUSED_FACES, "unused_faces", 0) \
    X(SUPPORTING, "unused_supporting", 0) \
    X(RELEVANCE, "relevance_percent", 0)
/* clang-format on */
enum report_column {
#define X(id, name, required) REPORT_##id,
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

/* Means over all rows, of errors over those from settle_s on (before, nothing may be drawn yet);
 * NAN where a flight has none. */
typedef struct report_summary {
    double seconds, triangles_mean, triangles_max, nodes_drawn_mean, nodes_held_max;
    /* 60 s: NAN when the flight is shorter */
    double kb_down_60s, kb_down, kb_up, requests, panoramas;
    double err_rms_mean, err_p95_mean, err_max;
} report_summary;

/* 0, or -1 with the reason in `why` ("FILE: ..." or "FILE:LINE: ..."). */
int report_flight_load(report_flight *flight, const char *path, char *why, size_t why_bytes);
void report_flight_free(report_flight *flight);
/* Splits a line of commas in place, blanks around fields dropped. Number of fields, more than
 * `most` when there are too many. */
size_t report_csv_split(char *line, char **field, size_t most);
/* Mean over the rows from from_s on, NAN where none has the column. */
double report_flight_mean(const report_flight *flight, enum report_column column, double from_s);
void report_summarise(const report_flight *flight, double settle_s, report_summary *summary);
/* 1 when any row has the column. */
int report_flight_has(const report_flight *flight, enum report_column column);

#endif
