/* One row of a flight: its CSV, and the summary of all rows as JSON. */
#ifndef FLY_SAMPLE_H
#define FLY_SAMPLE_H

#include "fly_options.h"

#include <stdio.h>

/* X(name, printf format, kind): the CSV's columns before and after the three hashes. How the
 * summary treats a column: PLACE left out, MEAN over the rows after settling, TOTAL gained after
 * settling, MOST of them, LAST of all. Columns without a value are nan. square_px_*: mean squared
 * error by cause (sim_audit.h); bytes_*, unused_*: by kind (sim_relevance.h), bytes_judged with the
 * overhead; relevance_percent: since the start. */
/* clang-format off */
#define FLY_COLUMNS_FIRST(X) \
    X(t_s, "%.3f", PLACE) \
    X(x_m, "%.2f", PLACE) \
    X(y_m, "%.2f", PLACE) \
    X(z_m, "%.2f", PLACE) \
    X(triangles, "%.0f", MEAN) \
    X(nodes_drawn, "%.0f", MEAN) \
    X(nodes_held, "%.0f", MEAN) \
    X(bytes_down, "%.0f", TOTAL) \
    X(bytes_up, "%.0f", TOTAL) \
    X(requests, "%.0f", TOTAL) \
    X(in_flight, "%.0f", MEAN) \
    X(panoramas, "%.0f", TOTAL) \
    X(err_px_rms, "%.3f", MEAN) \
    X(err_px_p95, "%.3f", MEAN) \
    X(err_px_max, "%.3f", MOST)
/* clang-format on */
/* clang-format off */
#define FLY_COLUMNS_LAST(X) \
    X(undrawn_px_percent, "%.3f", MEAN) \
    X(panorama_px_percent, "%.3f", MEAN) \
    X(tree_err_px, "%.3f", MEAN) \
    X(stitched, "%.0f", MEAN) \
    X(queued, "%.0f", MEAN) \
    X(panorama_faces, "%.0f", TOTAL) \
    X(panorama_faces_empty, "%.0f", TOTAL) \
    X(panorama_bytes, "%.0f", TOTAL) \
    X(requests_dropped, "%.0f", TOTAL) \
    X(requests_cancelled, "%.0f", TOTAL) \
    X(textures_held, "%.0f", MEAN) \
    X(pool_full, "%.0f", TOTAL) \
    X(reconnects, "%.0f", TOTAL) \
    X(link_up, "%.0f", MEAN) \
    X(low_power, "%.0f", MEAN) \
    X(frames_drawn, "%.0f", TOTAL) \
    X(square_px_waiting, "%.4f", MEAN) \
    X(square_px_depth, "%.4f", MEAN) \
    X(square_px_quality, "%.4f", MEAN) \
    X(square_px_panorama, "%.4f", MEAN) \
    X(square_px_undrawn, "%.4f", MEAN) \
    X(bytes_heights, "%.0f", TOTAL) \
    X(bytes_images, "%.0f", TOTAL) \
    X(bytes_faces, "%.0f", TOTAL) \
    X(bytes_overhead, "%.0f", TOTAL) \
    X(bytes_judged, "%.0f", TOTAL) \
    X(unused_heights, "%.0f", TOTAL) \
    X(unused_images, "%.0f", TOTAL) \
    X(unused_faces, "%.0f", TOTAL) \
    X(unused_supporting, "%.0f", TOTAL) \
    X(relevance_percent, "%.2f", LAST) \
    X(share_percent, "%.0f", MEAN) \
    X(fidelity_percent, "%.0f", MEAN) \
    X(frame_load, "%.3f", MEAN) \
    X(link_load, "%.3f", MEAN) \
    X(balance_moves, "%.0f", TOTAL) \
    X(balance_turns, "%.0f", TOTAL) \
    X(c, "%.3f", MEAN) \
    X(error_px, "%.3f", MEAN) \
    X(depth, "%.0f", MEAN) \
    X(back_plane_m, "%.0f", MEAN) \
    X(panorama_error_px, "%.3f", MEAN)
/* clang-format on */

typedef struct fly_sample {
#define X(name, format, kind) double name;
    FLY_COLUMNS_FIRST(X)
    FLY_COLUMNS_LAST(X)
#undef X
    uint64_t frame_hash; /* FNV-1a over the picture's RGB bytes; 0 without pictures */
    uint64_t geometry_hash, request_hash; /* since the start, the same on every back end */
} fly_sample;

/* Of the whole flight. */
typedef struct fly_totals {
    uint32_t frames, stitched_frames, crack_frames;
    uint32_t empty_frames; /* without a node drawn, after one with */
    uint32_t panoramas_in_flight_high;
    uint64_t frame_hash; /* over the rows' hashes */
    double bytes_down_all, bytes_up_all;
    uint64_t memory_used;
} fly_totals;

void fly_csv_header(FILE *file);
void fly_csv_row(FILE *file, const fly_sample *sample);
void fly_json(FILE *file, const fly_options *options, const fly_sample *sample, size_t count,
              const fly_totals *totals);

#endif
