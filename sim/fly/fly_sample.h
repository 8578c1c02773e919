/* One row of a flight: its CSV, and the summary of all rows as JSON. */
#ifndef FLY_SAMPLE_H
#define FLY_SAMPLE_H

#include "fly_options.h"
#include "../judge/sim_audit.h"
#include "../judge/sim_picture.h"
#include "../judge/sim_relevance.h"
#include "../link/sim_link.h"

#include <stdio.h>

/* X(name, printf format, kind, where from): the CSV's columns before and after the three hashes.
 * `from` is a fly_sources; figures of the client have their names from client/ff_figures.h. The
 * kind says how the summary treats a column: PLACE leaves it out, MEAN takes the mean over the rows
 * after settling, SOME that over those that have a value, TOTAL what was gained after settling,
 * MOST the largest value, LAST the last one. Columns without a value are nan. diff_*, ssim:
 * sim_picture.h. square_px_*: mean squared error by cause (sim_audit.h); bytes_*, unused_*: by
 * class of data (sim_relevance.h), bytes_judged with the overhead, bytes_reserve and unused_reserve
 * a part of them, unused_supporting and unused_hidden parts of unused_heights; bytes_framing,
 * node_*, round_trips: sim_talk.h; packets_*, delay_*_s: the link's packets, and how long each was
 * under way as a mean (sim_link.h), 0 with a real server; relevance_percent and the same without
 * the reserve's bytes, relevance_no_reserve_percent: since the start. */
/* clang-format off */
#define FLY_COLUMNS_FIRST(X) \
    X(t_s, "%.3f", PLACE, from->t_s) \
    X(x_m, "%.2f", PLACE, (double)from->camera.pos_wu[0] / FF_WU_PER_METRE) \
    X(y_m, "%.2f", PLACE, (double)from->camera.pos_wu[1] / FF_WU_PER_METRE) \
    X(z_m, "%.2f", PLACE, (double)from->camera.pos_wu[2] / FF_WU_PER_METRE) \
    X(triangles, "%.0f", MEAN, from->client.tree.triangles) \
    X(nodes_drawn, "%.0f", MEAN, from->client.tree.nodes_drawn) \
    X(nodes_held, "%.0f", MEAN, from->client.tree.nodes_held) \
    X(bytes_down, "%.0f", TOTAL, from->client.bytes_down) \
    X(bytes_up, "%.0f", TOTAL, from->client.bytes_up) \
    X(requests, "%.0f", TOTAL, from->client.requests_sent) \
    X(in_flight, "%.0f", MEAN, from->client.in_flight) \
    X(panoramas, "%.0f", TOTAL, from->client.panorama_requests) \
    X(err_px_rms, "%.3f", MEAN, from->audit.err_px_rms) \
    X(err_px_p95, "%.3f", MEAN, from->audit.err_px_p95) \
    X(err_px_max, "%.3f", MOST, from->audit.err_px_max)

#define FLY_COLUMNS_LAST(X) \
    X(undrawn_px_percent, "%.3f", MEAN, from->audit.undrawn_percent) \
    X(panorama_px_percent, "%.3f", MEAN, from->panorama_px_percent) \
    X(diff_mean, "%.4f", MEAN, from->picture.diff_mean) \
    X(diff_p95, "%.3f", MEAN, from->picture.diff_p95) \
    X(ssim, "%.5f", MEAN, from->picture.ssim) \
    X(skyline_px_rms, "%.3f", MEAN, from->audit.skyline_px_rms) \
    X(skyline_px_p95, "%.3f", MEAN, from->audit.skyline_px_p95) \
    X(skyline_px_max, "%.3f", MOST, from->audit.skyline_px_max) \
    X(truth_error_m, "%.3f", MEAN, from->truth_error_m) \
    X(tree_err_px, "%.3f", MEAN, from->estimate_px) \
    X(stitched, "%.0f", MEAN, from->client.tree.stitched) \
    X(queued, "%.0f", MEAN, from->client.queued) \
    X(panorama_faces, "%.0f", TOTAL, from->client.panorama_faces) \
    X(panorama_faces_empty, "%.0f", TOTAL, from->client.panorama_faces_empty) \
    X(panorama_bytes, "%.0f", TOTAL, from->client.panorama_bytes) \
    X(requests_failed, "%.0f", TOTAL, from->client.requests_failed) \
    X(requests_dropped, "%.0f", TOTAL, from->client.requests_dropped) \
    X(requests_cancelled, "%.0f", TOTAL, from->client.requests_cancelled) \
    X(textures_held, "%.0f", MEAN, from->client.textures_held) \
    X(pool_full, "%.0f", TOTAL, from->client.tree.pool_full) \
    X(reconnects, "%.0f", TOTAL, from->client.reconnects) \
    X(link_up, "%.0f", MEAN, from->client.link == FF_LINK_UP) \
    X(low_power, "%.0f", MEAN, from->client.low_power) \
    X(frames_drawn, "%.0f", TOTAL, from->client.frames_updated) \
    X(square_px_waiting, "%.4f", MEAN, from->audit.square_px[SIM_CAUSE_WAITING]) \
    X(square_px_depth, "%.4f", MEAN, from->audit.square_px[SIM_CAUSE_DEPTH]) \
    X(square_px_stub, "%.4f", MEAN, from->audit.square_px[SIM_CAUSE_STUB]) \
    X(square_px_quality, "%.4f", MEAN, from->audit.square_px[SIM_CAUSE_QUALITY]) \
    X(square_px_panorama, "%.4f", MEAN, from->audit.square_px[SIM_CAUSE_PANORAMA]) \
    X(square_px_undrawn, "%.4f", MEAN, from->audit.square_px[SIM_CAUSE_UNDRAWN]) \
    X(bytes_heights, "%.0f", TOTAL, from->relevance.came[FF_DATA_HEIGHTS]) \
    X(bytes_images, "%.0f", TOTAL, from->relevance.came[FF_DATA_IMAGES]) \
    X(bytes_faces, "%.0f", TOTAL, from->relevance.came[FF_DATA_FACES]) \
    X(bytes_overhead, "%.0f", TOTAL, from->relevance.came[FF_DATA_OVERHEAD]) \
    X(bytes_judged, "%.0f", TOTAL, from->relevance.judged_all) \
    X(unused_heights, "%.0f", TOTAL, from->relevance.unused[FF_DATA_HEIGHTS]) \
    X(unused_images, "%.0f", TOTAL, from->relevance.unused[FF_DATA_IMAGES]) \
    X(unused_faces, "%.0f", TOTAL, from->relevance.unused[FF_DATA_FACES]) \
    X(unused_supporting, "%.0f", TOTAL, from->relevance.supporting) \
    X(relevance_percent, "%.2f", LAST, from->relevance.percent) \
    X(bytes_reserve, "%.0f", TOTAL, from->relevance.reserve_came) \
    X(unused_reserve, "%.0f", TOTAL, from->relevance.reserve_unused) \
    X(relevance_no_reserve_percent, "%.2f", LAST, from->relevance.no_reserve_percent) \
    X(share_percent, "%.0f", MEAN, from->client.balance.share_percent) \
    X(fidelity_percent, "%.0f", MEAN, from->client.balance.fidelity_percent) \
    X(frame_load, "%.3f", MEAN, from->client.balance.frame_load_q8 / 256.0) \
    X(link_load, "%.3f", MEAN, from->client.balance.link_load_q8 / 256.0) \
    X(balance_moves, "%.0f", TOTAL, from->client.balance.moves) \
    X(balance_turns, "%.0f", TOTAL, from->client.balance.turns) \
    X(c, "%.3f", MEAN, from->client.quality.c_q8 / 256.0) \
    X(error_px, "%.3f", MEAN, from->client.quality.error_px_q8 / 256.0) \
    X(depth, "%.0f", MEAN, from->client.quality.depth_max) \
    X(back_plane_m, "%.0f", MEAN, from->client.back_plane_wu / (double)FF_WU_PER_METRE) \
    X(panorama_error_px, "%.3f", MEAN, from->client.panorama_error_q8 / 256.0) \
    X(filled_px_percent, "%.3f", MEAN, from->audit.filled_percent) \
    X(nodes_hidden, "%.0f", MEAN, from->client.tree.nodes_hidden) \
    X(triangles_hidden, "%.0f", MEAN, from->client.tree.triangles_hidden) \
    X(unused_hidden, "%.0f", TOTAL, from->relevance.hidden) \
    X(seam_px_p95, "%.3f", SOME, from->audit.seam_px_p95) \
    X(seam_px_max, "%.3f", MOST, from->audit.seam_px_max) \
    X(far_sets, "%.0f", TOTAL, from->client.far_sets) \
    X(far_requests, "%.0f", TOTAL, from->client.far_requests) \
    X(far_sectors, "%.0f", TOTAL, from->client.far_sectors) \
    X(far_sectors_empty, "%.0f", TOTAL, from->client.far_sectors_empty) \
    X(far_sectors_failed, "%.0f", TOTAL, from->client.far_sectors_failed) \
    X(far_bytes, "%.0f", TOTAL, from->client.far_bytes) \
    X(far_use, "%.0f", MEAN, from->client.far_use) \
    X(far_turns, "%.0f", TOTAL, from->client.far_turns) \
    X(far_fins_bytes, "%.0f", TOTAL, from->relevance.fins_came) \
    X(bytes_far, "%.0f", TOTAL, from->relevance.came[FF_DATA_FAR]) \
    X(unused_far, "%.0f", TOTAL, from->relevance.unused[FF_DATA_FAR]) \
    X(square_px_far, "%.4f", MEAN, from->audit.square_px[SIM_CAUSE_FAR]) \
    X(bytes_framing, "%.0f", TOTAL, from->relevance.talk.framing) \
    X(node_requests, "%.0f", TOTAL, from->relevance.talk.node_requests) \
    X(node_request_bytes, "%.0f", TOTAL, from->relevance.talk.node_request_bytes) \
    X(node_answers, "%.0f", TOTAL, from->relevance.talk.node_answers) \
    X(node_header_bytes, "%.0f", TOTAL, from->relevance.talk.node_header_bytes) \
    X(bytes_views, "%.0f", TOTAL, from->relevance.views_came) \
    X(wasted_views, "%.0f", LAST, from->relevance.views_wasted) \
    X(wasted_heights, "%.0f", LAST, from->relevance.wasted) \
    X(round_trips, "%.0f", LAST, from->relevance.talk.round_trips) \
    X(packets_down, "%.0f", TOTAL, from->load[SIM_DOWN].packets) \
    X(packets_up, "%.0f", TOTAL, from->load[SIM_UP].packets) \
    X(delay_down_s, "%.3f", LAST, fly_delay_s(&from->load[SIM_DOWN])) \
    X(delay_up_s, "%.3f", LAST, fly_delay_s(&from->load[SIM_UP])) \
    X(images_lacking, "%.0f", MEAN, from->client.textures_lacking) \
    X(wasted_images, "%.0f", LAST, from->relevance.wasted_images) \
    X(lat_deg, "%.7f", PLACE, from->lat_deg) \
    X(lon_deg, "%.7f", PLACE, from->lon_deg) \
    X(heading_true_deg, "%.3f", PLACE, from->heading_true_deg)
/* clang-format on */

/* What a row is made from. NAN in all that nobody judges. */
typedef struct fly_sources {
    double t_s;
    c3d_camera camera;
    double lat_deg, lon_deg, heading_true_deg; /* of it, where the pack says where it lies */
    ff_client_stats client;
    double estimate_px; /* the client's own of its err_px_p95 */
    sim_audit_result audit;
    double panorama_px_percent; /* of the pixels that truly show ground */
    /* of them, by the ground that a node drawn there is of */
    double ground_px_percent[FF_GROUNDS_MAX];
    sim_picture_figures picture;
    double truth_error_m; /* no height judged by is further than this from its source */
    sim_relevance_figures relevance;
    sim_link_load load[2];
    uint64_t geometry_hash, request_hash;
} fly_sources;

typedef struct fly_sample {
#define X(name, format, kind, from) double name;
    FLY_COLUMNS_FIRST(X)
    FLY_COLUMNS_LAST(X)
#undef X
    double ground_px_percent[FF_GROUNDS_MAX];
    uint64_t frame_hash; /* FNV-1a over the picture's RGB bytes; 0 without pictures */
    uint64_t geometry_hash, request_hash; /* since the start, the same on every back end */
} fly_sample;

/* Of the whole flight. */
typedef struct fly_totals {
    uint32_t frames, stitched_frames, crack_frames;
    uint32_t empty_frames; /* without a node drawn, after one with */
    uint32_t panoramas_in_flight_high;
    uint32_t grounds;
    uint64_t frame_hash; /* over the rows' hashes */
    double bytes_down_all, bytes_up_all;
    uint64_t memory_used;
} fly_totals;

/* How long a packet was under way, as a mean. */
double fly_delay_s(const sim_link_load *load);
/* All of a row but the picture's hash. */
void fly_sample_take(fly_sample *sample, const fly_sources *from);
void fly_csv_header(FILE *file);
void fly_csv_row(FILE *file, const fly_sample *sample);
void fly_json(FILE *file, const fly_options *options, const fly_sample *sample, size_t count,
              const fly_totals *totals);

#endif
