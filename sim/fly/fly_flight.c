#include "fly_flight.h"

#include "../judge/sim_watertight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A step of the simulated network; a real server is looked after at the same pace. */
#define TICK_US   2000
#define FNV_START 14695981039346656037u
#define FNV_PRIME 1099511628211u

static int fail(const char *what, const char *why)
{
    fprintf(stderr, "farfield-fly: %s: %s\n", what, why);
    return -1;
}

static uint64_t fnv(uint64_t hash, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) hash = (hash ^ bytes[i]) * FNV_PRIME;
    return hash;
}

/* ---- time ---- */

/* Steps server and client until `until_us`, tick by tick. */
static int advance(fly_flight *flight, int64_t until_us)
{
    fly_world *world = flight->world;
    if (flight->options->server) {
        while ((world->now_us = sys_time_us()) < until_us)
            sys_sleep_us(until_us - world->now_us < TICK_US ? until_us - world->now_us : TICK_US);
        return 0;
    }
    while (world->now_us < until_us) {
        world->now_us = until_us - world->now_us < TICK_US ? until_us : world->now_us + TICK_US;
        int rc = sim_server_step(&world->server);
        if (rc != FF_OK) return fail("server", ff_error_text(rc));
        if (world->tape.file) sim_tape_work(&world->tape, world->now_us);
        (void)ff_client_work(world->client, world->now_us);
    }
    if (world->surface && world->server.faces_rendered != flight->faces_seen) {
        flight->faces_seen = world->server.faces_rendered;
        (void)world->surface_api->make_current(world->surface);
    }
    return 0;
}

static int64_t flight_clock(void *context) { return ((const fly_world *)context)->now_us; }

/* ---- events ---- */

static int32_t focal_q8(double fov_degrees, const fly_options *options)
{
    return c3d_focal_q8((int32_t)(fov_degrees * 65536 / 360 + 0.5), options->size.width);
}

static int apply_event(fly_flight *flight, const fly_event *what, double t_s)
{
    fly_world *world = flight->world;
    sys_event event = { .time_us = world->now_us };
    ff_panorama_desc panorama = flight->options->panorama;
    ff_balance_desc balance = flight->options->balance;
    switch (what->kind) {
        case FLY_LOW_BATTERY:
        case FLY_BATTERY_OK:
            event.type = SYS_EVENT_BATTERY;
            event.u.battery.low = what->kind == FLY_LOW_BATTERY;
            event.u.battery.percent = what->kind == FLY_LOW_BATTERY ? 5 : 80;
            (void)sys_event_inject(&event);
            break;
        case FLY_INTERRUPTION:
        case FLY_RESUME:
            event.type = SYS_EVENT_INTERRUPTION;
            event.u.interruption.begins = what->kind == FLY_INTERRUPTION;
            (void)sys_event_inject(&event);
            break;
        case FLY_CUT:
            if (world->link) sim_link_cut(world->link, world->now_us);
            break;
        case FLY_PANORAMA_ON:
        case FLY_PANORAMA_OFF:
            panorama.enabled = what->kind == FLY_PANORAMA_ON;
            ff_client_set_panorama(world->client, &panorama);
            break;
        case FLY_LINK:
            if (world->link && sim_link_change(world->link, &what->link, world->now_us) != FF_OK)
                return fail("link", ff_error_text(FF_ERR_MEMORY));
            break;
        case FLY_BUDGET:
            balance.frame_budget = what->budget;
            ff_client_set_balance(world->client, &balance);
            break;
        case FLY_TELEPORT:
            fly_path_teleport(&world->path, t_s, what->place[0], what->place[1]);
            break;
        case FLY_TURN_BY: world->path.turned_degrees += what->degrees; break;
        case FLY_PITCH: world->path.pitch_degrees = what->degrees; break;
        case FLY_LAYER: return fly_world_layer(world, what->layer);
        case FLY_FOV: flight->camera.focal_q8 = focal_q8(what->degrees, flight->options); break;
    }
    return 0;
}

static int events(fly_flight *flight, double t_s)
{
    sys_event event;
    int rc = 0;
    for (unsigned i = 0; !rc && i < flight->options->events.count; i++)
        if (!(flight->events_done >> i & 1u) && t_s >= flight->options->events.event[i].at_s) {
            flight->events_done |= (uint64_t)1 << i;
            rc = apply_event(flight, &flight->options->events.event[i], t_s);
        }
    while (sys_event_take(&event)) ff_client_event(flight->world->client, &event);
    return rc;
}

/* ---- rows ---- */

static void no_errors(sim_audit_result *audit)
{
    audit->err_px_rms = audit->err_px_p95 = audit->err_px_max = NAN;
    for (unsigned cause = 0; cause < SIM_CAUSES; cause++) audit->square_px[cause] = NAN;
}

static void no_skyline(sim_audit_result *audit)
{
    audit->skyline_px_rms = audit->skyline_px_p95 = audit->skyline_px_max = NAN;
}

/* Errors where something shows ground, percents in every frame that the auditor saw. */
static int read_audit(fly_flight *flight, fly_sources *from)
{
    fly_world *world = flight->world;
    const ff_tree *tree = ff_client_tree(world->client);
    const ff_panorama_desc *panorama = &flight->options->panorama;
    int32_t join_wu = from->client.back_plane_wu;
    sim_audit_view view = {
        .camera = flight->camera,
        .quality = from->client.quality,
        .panorama = { .front_wu = join_wu - join_wu / 8,
                      .back_wu = panorama->server_back_wu ? panorama->server_back_wu : INT32_MAX,
                      .face_size = from->client.face_size }
    };
    uint32_t all;
    sim_audit_result *audit = &from->audit;
    if (tree) {
        view.drawn_count = ff_tree_in_view(tree, &view.drawn);
        view.grounds = sim_drawn_grounds_of(tree);
    }
    (void)ff_client_panorama(world->client, view.panorama.pos_wu, &view.faces);
    if (world->fins.rc != FF_OK) return fail("auditor", ff_error_text(world->fins.rc));
    ff_far_in_use far;
    if (ff_client_far(world->client, &far)) {
        view.fins =
            (sim_drawn_fins){ .fins = &world->fins, .set = far.set, .sectors = far.sectors };
        memcpy(view.fins.position_wu, far.position_wu, sizeof far.position_wu);
        sim_fins_forget(&world->fins, far.set);
    }
    int rc = sim_audit_frame(world->auditor, &view, audit);
    if (rc != FF_OK) return fail("auditor", ff_error_text(rc));
    from->truth_error_m = world->grounds.truth_error_m;
    all = audit->ground_pixels + audit->panorama_pixels + audit->undrawn_pixels;
    from->panorama_px_percent = all ? 100.0 * audit->panorama_pixels / all : 0;
    for (unsigned i = 0; i < FF_GROUNDS_MAX; i++)
        from->ground_px_percent[i] = all ? 100.0 * audit->drawn_pixels[i] / all : 0;
    if (!audit->seam_pixels) audit->seam_px_p95 = audit->seam_px_max = NAN;
    if (!all && !audit->sky_pixels) no_errors(audit);
    if (!audit->skyline_columns) no_skyline(audit);
    return 0;
}

static int read_relevance(const fly_flight *flight, fly_sources *from)
{
    int rc = sim_relevance_get(flight->world->relevance, &from->relevance);
    if (rc != FF_OK) return fail("relevance", ff_error_text(rc));
    return 0;
}

static void judge_nothing(fly_sources *from)
{
    sim_relevance_figures *f = &from->relevance;
    no_errors(&from->audit);
    no_skyline(&from->audit);
    from->audit.seam_px_p95 = from->audit.seam_px_max = NAN;
    for (unsigned i = 0; i < FF_GROUNDS_MAX; i++) from->ground_px_percent[i] = NAN;
    for (unsigned kind = 0; kind < FF_DATA_CLASSES; kind++) f->came[kind] = f->unused[kind] = NAN;
    from->audit.undrawn_percent = from->audit.filled_percent = from->panorama_px_percent =
        from->truth_error_m = NAN;
    f->judged_all = f->supporting = f->hidden = f->percent = f->no_reserve_percent = NAN;
    f->reserve_came = f->reserve_unused = f->fins_came = NAN;
    f->views_came = f->views_wasted = f->wasted = NAN;
    f->talk = (sim_talk){ NAN, NAN, NAN, NAN, NAN, 0 };
    from->picture = (sim_picture_figures){ NAN, NAN, NAN };
}

/* Where on Earth the camera is, and where it looks from true north. */
static void read_place(const fly_world *world, const c3d_camera *camera, fly_sources *from)
{
    ff_geo_place place;
    int32_t north;
    from->lat_deg = from->lon_deg = from->heading_true_deg = NAN;
    if (world->geo_error != FF_OK || ff_geo_of(&world->geo, camera->pos_wu, &place) != FF_OK ||
        ff_geo_north(&world->geo, camera->pos_wu, &north) != FF_OK)
        return;
    from->lat_deg = (double)place.latitude_e9 / 1e9;
    from->lon_deg = (double)place.longitude_e9 / 1e9;
    from->heading_true_deg = ((camera->yaw - north) & 65535) * 360 / 65536.0;
}

static int read_sources(fly_flight *flight, double t_s, fly_sources *from)
{
    const ff_client *client = flight->world->client;
    from->t_s = t_s;
    from->camera = flight->camera;
    read_place(flight->world, &flight->camera, from);
    from->geometry_hash = ff_client_geometry_hash(client);
    from->request_hash = ff_client_request_hash(client);
    ff_client_get_stats(client, &from->client);
    from->estimate_px = ff_client_error_px_q8(client) / 256.0;
    judge_nothing(from);
    for (int way = 0; way < 2; way++)
        from->load[way] = flight->world->link
                              ? sim_link_get_load(flight->world->link, (enum sim_direction)way)
                              : (sim_link_load){ 0 };
    if (flight->world->auditor && read_audit(flight, from)) return -1;
    return flight->world->relevance ? read_relevance(flight, from) : 0;
}

/* The picture as it stands, in flight->rgb; drawn once more, because a frame in which nothing
 * changed was not drawn at all. */
static int read_picture(fly_flight *flight)
{
    if (!flight->world->surface) return 0;
    ff_client_draw(flight->world->client);
    c3d_device *device = ff_client_device(flight->world->client);
    if (!device) { /* the block has no room for one: a black picture */
        memset(flight->rgb, 0,
               (size_t)flight->options->size.width * flight->options->size.height * 3);
        return 0;
    }
    int rc = c3d_read_rgb(device, flight->rgb);
    return rc == FF_OK ? 0 : fail("picture", ff_error_text(rc));
}

/* The picture as it should stand, in flight->reference_rgb. */
static int draw_reference(fly_flight *flight, double t_s)
{
    if (flight->reference_t_s == t_s) return 0;
    int rc = fly_reference_draw(&flight->world->reference, &flight->camera, flight->reference_rgb);
    flight->reference_t_s = t_s;
    return rc == FF_OK ? 0 : fail("reference", ff_error_text(rc));
}

static int compare_picture(fly_flight *flight, double t_s, sim_picture_figures *figures)
{
    if (!flight->options->diff) return 0;
    if (draw_reference(flight, t_s)) return -1;
    int rc = sim_picture_compare(flight->rgb, flight->reference_rgb, flight->options->size.width,
                                 flight->options->size.height, figures);
    return rc == FF_OK ? 0 : fail("picture", ff_error_text(rc));
}

static int take_row(fly_flight *flight, double t_s)
{
    if (flight->sample_count == flight->sample_capacity) {
        size_t more = flight->sample_capacity ? flight->sample_capacity * 2 : 512;
        fly_sample *grown = realloc(flight->sample, more * sizeof *grown);
        if (!grown) return fail("rows", ff_error_text(FF_ERR_MEMORY));
        flight->sample = grown;
        flight->sample_capacity = more;
    }
    fly_sample *sample = &flight->sample[flight->sample_count++];
    fly_sources from;
    memset(sample, 0, sizeof *sample);
    if (read_sources(flight, t_s, &from) || read_picture(flight) ||
        compare_picture(flight, t_s, &from.picture))
        return -1;
    fly_sample_take(sample, &from);
    if (flight->world->surface)
        sample->frame_hash = fnv(FNV_START, flight->rgb,
                                 (size_t)flight->options->size.width *
                                     flight->options->size.height * 3);
    flight->totals.frame_hash = fnv(flight->totals.frame_hash, (const uint8_t *)&sample->frame_hash,
                                    sizeof sample->frame_hash);
    if (!flight->csv) return 0;
    fly_csv_row(flight->csv, sample);
    return ferror(flight->csv) ? -1 : 0; /* told where the file is closed */
}

static int write_picture(const fly_flight *flight, const char *folder, double t_s,
                         const uint8_t *rgb)
{
    char path[4096];
    if (snprintf(path, sizeof path, "%s/frame-%07.2f.png", folder, t_s) >= (int)sizeof path)
        return fail(folder, "path too long");
    int rc = sys_png_write(path, rgb, flight->options->size.width, flight->options->size.height);
    return rc == FF_OK ? 0 : fail(path, ff_error_text(rc));
}

static int take_picture(fly_flight *flight, double t_s)
{
    const fly_options *options = flight->options;
    if (read_picture(flight) || write_picture(flight, options->png_dir, t_s, flight->rgb))
        return -1;
    if (!options->reference_dir) return 0;
    if (draw_reference(flight, t_s)) return -1;
    return write_picture(flight, options->reference_dir, t_s, flight->reference_rgb);
}

/* ---- frames ---- */

/* Searches the whole cut for cracks, and what is in view as seams between grounds lower it; tells
 * the first one. */
static void check_cracks(fly_flight *flight, double t_s)
{
    char why[256];
    const ff_drawn *cut, *view;
    const ff_tree *tree = ff_client_tree(flight->world->client);
    if (!tree) return;
    uint32_t in_cut = ff_tree_cut(tree, &cut), in_view = ff_tree_in_view(tree, &view);
    if (sim_watertight_check_tree(tree, 0, cut, in_cut, why, sizeof why) &&
        (flight->world->grounds.packs.count == 1 ||
         sim_watertight_check_tree(tree, 1, view, in_view, why, sizeof why)))
        return;
    if (!flight->totals.crack_frames++)
        fprintf(stderr, "farfield-fly: crack at %.3f s: %s\n", t_s, why);
}

/* Until then a part on the device may stand in for the server's ground. */
static int is_heard(const fly_flight *flight)
{
    ff_client *client = flight->world->client;
    return ff_client_tree(client) && ff_client_source_state(client, 0) != FF_ERR_AGAIN;
}

/* The path and the auditor look at --pack and --local: a server of other ground makes them
 * meaningless. */
static int check_terrain(const fly_flight *flight)
{
    const ff_tree *tree = ff_client_tree(flight->world->client);
    const ff_packs *packs = &flight->world->grounds.packs;
    const char *server = flight->options->server ? flight->options->server
                                                 : flight->options->pack_path;
    uint32_t count;
    if (!is_heard(flight)) return 0;
    const ff_terrain_info *info = ff_tree_grounds(tree, &count);
    for (uint32_t i = 0; i < count && i < packs->count; i++)
        if (info[i].checksum != packs->pack[i].header.info.checksum)
            return fail(server, "serves another terrain than --pack");
    if (count > packs->count) return fail(server, "serves more packs than --pack");
    return count == packs->count ? 0 : fail(flight->world->grounds.path[count], "is not shown");
}

static int wears(const void *client, ff_key image) { return ff_client_wears(client, image); }

/* Tells the relevance what the frame draws. */
static void tell_relevance(fly_flight *flight)
{
    const ff_tree *tree = ff_client_tree(flight->world->client);
    sim_relevance_view view = { .camera = flight->camera,
                                .wears = wears,
                                .client = flight->world->client };
    unsigned faces;
    if (!flight->world->relevance || !tree) return;
    view.drawn_count = ff_tree_drawn(tree, &view.drawn);
    view.in_view_count = ff_tree_in_view(tree, &view.drawn);
    view.grounds = sim_drawn_grounds_of(tree);
    view.panorama = ff_client_panorama(flight->world->client, view.panorama_pos_wu, &faces);
    ff_far_in_use far;
    if (ff_client_far(flight->world->client, &far)) {
        view.far_sectors = far.sectors;
        memcpy(view.far_pos_wu, far.world_wu, sizeof far.world_wu);
    }
    sim_relevance_frame(flight->world->relevance, &view);
}

static int one_frame(fly_flight *flight, double t_s)
{
    fly_world *world = flight->world;
    ff_client_stats stats;
    if (events(flight, t_s)) return -1;
    fly_path_at(&world->path, t_s, &flight->camera);
    if (world->tape.file)
        sim_tape_frame(&world->tape, world->now_us, &flight->camera,
                       t_s > flight->options->settle_s);
    int changed = ff_client_update(world->client, world->now_us, &flight->camera);
    if (check_terrain(flight)) return -1;
    if (changed) {
        if (flight->options->check) check_cracks(flight, t_s);
        if (world->surface) {
            ff_client_draw(world->client);
            (void)world->surface_api->present(world->surface);
        }
    }
    tell_relevance(flight);
    ff_client_get_stats(world->client, &stats);
    flight->totals.empty_frames += flight->had_ground && !stats.tree.nodes_drawn;
    flight->had_ground |= stats.tree.nodes_drawn > 0;
    flight->totals.frames++;
    flight->totals.stitched_frames += stats.tree.stitched > 0;
    return 0;
}

static int begin(fly_flight *flight, fly_world *world, FILE *csv)
{
    const fly_options *options = world->options;
    *flight = (fly_flight){ .world = world,
                            .options = options,
                            .csv = csv,
                            .reference_t_s = -1,
                            .totals = { .frame_hash = FNV_START,
                                        .grounds = world->grounds.packs.count } };
    flight->camera = (c3d_camera){ .width = options->size.width,
                                   .height = options->size.height,
                                   .focal_q8 = focal_q8(options->fov_degrees, options) };
    flight->rgb = malloc((size_t)options->size.width * options->size.height * 3);
    flight->reference_rgb = malloc((size_t)options->size.width * options->size.height * 3);
    if (!flight->rgb || !flight->reference_rgb)
        return fail("picture", ff_error_text(FF_ERR_MEMORY));
    if (options->png_dir && sys_make_folder(options->png_dir) != FF_OK)
        return fail(options->png_dir, "cannot make this folder");
    if (options->reference_dir && sys_make_folder(options->reference_dir) != FF_OK)
        return fail(options->reference_dir, "cannot make this folder");
    if (csv) fly_csv_header(csv);
    if (options->server)
        world->now_us = sys_time_us();
    else
        sys_clock_replace(flight_clock, world);
    flight->start_us = world->now_us;
    return 0;
}

/* Looks at what went wrong at the server's end. It is an error when the flight then says nothing
 * about the pack; else it is only told. */
static int judge_server(const fly_flight *flight, const ff_client_stats *stats)
{
    const char *name = flight->options->server ? flight->options->server
                                               : flight->options->pack_path;
    if (stats->terrain_error != FF_OK)
        return fail("this terrain does not fit into --memory", ff_error_text(stats->terrain_error));
    if (flight->options->server && !is_heard(flight))
        return fail(name, stats->refusal ? ff_error_text(stats->refusal)
                          : stats->protocol_errors
                              ? "does not speak Farfield's protocol, or another version of it"
                              : "no terrain came from there");
    const ff_terrain_info *info = ff_client_terrain(flight->world->client);
    if (info && info->texture_log2 && !stats->textures_capacity)
        fprintf(stderr, "farfield-fly: warning: no room for images of the ground in --memory\n");
    if (stats->protocol_errors)
        fprintf(stderr, "farfield-fly: %s: warning: sent nonsense %u times\n", name,
                stats->protocol_errors);
    if (stats->requests_failed)
        fprintf(stderr, "farfield-fly: %s: warning: could not answer %u of %u requests\n", name,
                stats->requests_failed, stats->requests_sent);
    return 0;
}

static int finish(fly_flight *flight)
{
    ff_client_stats stats;
    ff_client_get_stats(flight->world->client, &stats);
    int rc = judge_server(flight, &stats);
    flight->totals.bytes_down_all = (double)stats.bytes_down;
    flight->totals.bytes_up_all = (double)stats.bytes_up;
    flight->totals.memory_used = stats.memory_used;
    flight->totals.panoramas_in_flight_high = stats.panoramas_in_flight_high;
    if (rc || !flight->world->tape.file) return rc;
    const ff_client *client = flight->world->client;
    rc = sim_tape_finish(&flight->world->tape, ff_client_geometry_hash(client),
                         ff_client_request_hash(client));
    return rc == FF_OK ? 0 : fail(flight->options->tape_path, ff_error_text(rc));
}

int fly_flight_run(fly_flight *flight, fly_world *world, FILE *csv)
{
    const fly_options *options = world->options;
    double total_s = options->settle_s + options->seconds;
    int64_t next_row_us = 0, next_png_us = 0, shown_s = -1;
    int rc = begin(flight, world, csv), show = sys_stderr_is_terminal();
    for (int64_t frame = 0; !rc && frame <= (int64_t)floor(total_s * options->fps); frame++) {
        int64_t t_us = frame * 1000000 / options->fps;
        double t_s = (double)t_us / 1e6;
        rc = advance(flight, flight->start_us + t_us);
        if (!rc) rc = one_frame(flight, t_s);
        if (!rc && t_us >= next_row_us) {
            rc = take_row(flight, t_s);
            next_row_us += (int64_t)(options->sample_s * 1e6);
        }
        if (!rc && options->png_dir && t_us >= next_png_us) {
            rc = take_picture(flight, t_s);
            next_png_us += (int64_t)(options->every_s * 1e6);
        }
        if (show && t_us / 1000000 != shown_s) {
            shown_s = t_us / 1000000;
            fprintf(stderr, "\r%lld of %.0f s ", (long long)shown_s, total_s);
        }
    }
    if (show) fputc('\n', stderr);
    if (!rc) rc = finish(flight);
    sys_clock_replace(NULL, NULL);
    return rc;
}

void fly_flight_free(fly_flight *flight)
{
    free(flight->rgb);
    free(flight->reference_rgb);
    free(flight->sample);
    memset(flight, 0, sizeof *flight);
}
