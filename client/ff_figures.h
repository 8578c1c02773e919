/* What a client counts: one row a figure. The struct ff_client_stats (farfield.h), the copying
 * (client_figures.c) and the report of farfield-handheld (sim/handheld/handheld_report.c) are made
 * from the rows, in their order.
 *
 * TOLD(type, name, where from, what)  a field of ff_client_stats, told by farfield-handheld
 * KEPT(type, name, where from, what)  a field, not told there
 * PART(name, member)                  told there: a member of a field above it
 *
 * `from` is an ff_readings (ff_client_local.h). A figure of a flight's CSV has a row in
 * sim/fly/fly_sample.h, which says how it is written and summed up.
 */
#ifndef FF_FIGURES_H
#define FF_FIGURES_H

/* clang-format off */
#define FF_CLIENT_FIGURES(TOLD, KEPT, PART) \
    KEPT(ff_tree_stats, tree, from->tree, "of the terrain tree") \
    PART(nodes_held, tree.nodes_held) \
    PART(nodes_high, tree.nodes_high) \
    PART(nodes_capacity, tree.nodes_capacity) \
    PART(pool_full, tree.pool_full) \
    PART(orphans, tree.orphans) \
    PART(sides_gone, tree.sides_gone) \
    PART(nodes_hidden, tree.nodes_hidden) \
    PART(triangles_hidden, tree.triangles_hidden) \
    KEPT(c3d_stats, c3d, from->c3d, "of the graphics device") \
    PART(meshes_high, c3d.mesh_high) \
    PART(strips_high, c3d.strip_high) \
    PART(device_textures_high, c3d.texture_high) \
    TOLD(uint32_t, textures_held, from->client->textures.held, "images of the ground") \
    TOLD(uint32_t, textures_high, from->client->textures.high, "the most at once") \
    TOLD(uint32_t, textures_capacity, from->client->has_textures ? from->client->textures.texture_count : 0, "that can be drawn at once; 0: there is no room for any") \
    TOLD(uint32_t, textures_full, from->client->textures.full, "images that found no room") \
    KEPT(uint32_t, textures_lacking, from->client->textures.lacking, \
         "nodes drawn with the image of one above them, until theirs has come") \
    TOLD(uint32_t, panorama_requests, from->requests.of[FF_KIND_FACE].sent, "sent") \
    TOLD(uint32_t, panorama_faces, from->client->panorama.faces, "that came") \
    TOLD(uint32_t, panorama_faces_empty, from->client->panorama.faces_empty, \
         "found without far ground by the server") \
    TOLD(uint32_t, panorama_bytes, (uint32_t)from->link.answer_bytes[FF_KIND_FACE], "of their messages") \
    KEPT(uint32_t, panoramas_in_flight_high, from->requests.of[FF_KIND_FACE].in_flight_high, \
         "requests sent and unanswered at once; 1 at most unless hold_back is 1") \
    TOLD(uint32_t, far_requests, from->requests.of[FF_KIND_FAR].sent, "sent, for sectors of far sets") \
    TOLD(uint32_t, far_sets, from->client->sets ? from->client->sets->serial : 0, "planned") \
    TOLD(uint32_t, far_sectors, from->client->sets ? from->client->sets->sectors : 0, "that came, with fins or paint") \
    TOLD(uint32_t, far_sectors_empty, from->client->sets ? from->client->sets->sectors_empty : 0, "that show nothing") \
    TOLD(uint32_t, far_sectors_failed, from->client->sets ? from->client->sets->sectors_failed : 0, \
         "that came and could not be decoded") \
    TOLD(uint32_t, far_bytes, (uint32_t)from->link.answer_bytes[FF_KIND_FAR], "of their messages") \
    TOLD(uint32_t, far_use, from->client->sets ? from->client->sets->choice.use : 0, "asked for now: 0 nothing, 1 fins, 2 paint") \
    TOLD(uint32_t, far_turns, from->client->far_turns, "times that far auto began or left sets") \
    TOLD(uint32_t, view_requests, from->requests.of[FF_KIND_VIEW].sent, \
         "sent, each for all that a view lacks") \
    TOLD(uint32_t, requests_sent, from->requests.sent, "of all kinds") \
    TOLD(uint32_t, requests_done, from->requests.done, "answered, and the answer was of use") \
    TOLD(uint32_t, requests_failed, from->requests.failed, "refused, or answered with nonsense") \
    KEPT(uint32_t, requests_cancelled, from->requests.cancelled, "given up after they were sent") \
    KEPT(uint32_t, requests_dropped, from->requests.dropped, "given up before they were sent") \
    KEPT(uint32_t, in_flight, from->requests.in_flight, "requests sent and unanswered") \
    TOLD(uint32_t, in_flight_high, from->requests.in_flight_high, "the most at once") \
    KEPT(uint32_t, queued, from->requests.queued, "requests wanted and not sent") \
    TOLD(uint32_t, queued_high, from->requests.queued_high, "the most at once") \
    KEPT(uint32_t, reserve_requests, from->requests.reserve_sent, "sent for the reserve") \
    KEPT(uint32_t, reserve_bytes, from->requests.reserve_bytes, "of their answers, without headers") \
    TOLD(uint32_t, protocol_errors, from->link.protocol_errors, "messages that were nonsense") \
    KEPT(enum ff_link_state, link, link_state(from), "to the server") \
    KEPT(int, refusal, from->link.refusal, \
         "why the server would have no part of this client: FF_ERR_VERSION, FF_ERR_FULL; or FF_OK") \
    KEPT(uint32_t, reconnects, from->link.reconnects, "connections made again") \
    KEPT(uint32_t, rtt_ms, from->link.rtt_us / 1000, "round trip, as measured by the worker") \
    KEPT(uint32_t, bandwidth_bytes_s, from->link.bytes_s, "of the link, as measured by the worker") \
    TOLD(uint64_t, bytes_down, from->link.bytes_down, "received, messages and their headers") \
    TOLD(uint64_t, bytes_up, from->link.bytes_up, "sent") \
    KEPT(ff_balance_stats, balance, from->balance, "zero without") \
    PART(share_percent, balance.share_percent) \
    PART(fidelity_percent, balance.fidelity_percent) \
    PART(balance_moves, balance.moves) \
    TOLD(size_t, memory_used, from->client->arena.used, "of the block") \
    TOLD(size_t, memory_bytes, from->client->desc.memory_bytes, "the block's") \
    KEPT(uint8_t, have_terrain, from->client->have_terrain, "WELCOME has come") \
    KEPT(int, terrain_error, from->client->terrain_error, \
         "why the terrain that has come is not shown: FF_ERR_MEMORY, the block is too small; or FF_OK") \
    KEPT(uint8_t, low_power, (uint8_t)ff_client_low_power(from->client), \
         "battery low or interrupted: slower, coarser, no prefetch, no reserve") \
    KEPT(uint32_t, frames_updated, from->client->frames_updated, "that showed something new") \
    KEPT(uint32_t, frames_skipped, from->client->frames_skipped, "nothing changed, nothing to redraw") \
    KEPT(ff_quality, quality, quality_in_force(from->client), \
         "in force: as set, by the balance, halved when power is low, as coarse as the limit of " \
         "triangles takes") \
    KEPT(int32_t, back_plane_wu, back_plane_wu(from->client), "in force; 0: no panoramas") \
    KEPT(int32_t, panorama_error_q8, from->client->panorama.desc.error_px_q8, "in force") \
    KEPT(uint16_t, face_size, from->client->panorama.face_size, \
         "texels of a panorama's face each way, as the block has room for; 0: no panoramas")
/* clang-format on */

#endif
