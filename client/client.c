/* Life of a client: the block, the worker, settings and what is known of the terrain. Frames are in
 * client_update.c, figures in client_figures.c. */
#include "several/ff_several.h"
#include "terrain/ff_pack_source.h"
#include "../protocol/ff_assert.h"

#include <string.h>

#define CLIENT_BYTES_MIN ((size_t)544 << 10)
#define WORKER_SLEEP_US  2000
#define METRES           FF_WU_PER_METRE
#define IN_FLIGHT_LIMIT  1024
#define LEAST_PIXELS     2 /* for each triangle: more could not be told apart */

/* what outlives a terrain fits into the smallest block */
FF_STATIC_ASSERT(sizeof(ff_client) + CLIENT_BYTES_MIN / 32 + FF_RECEIVED_MIN +
                     (IN_FLIGHT_LIMIT + FF_REQUESTS_QUEUED_MAX) * sizeof(ff_request) <
                 CLIENT_BYTES_MIN);
FF_STATIC_ASSERT(IN_FLIGHT_LIMIT + FF_REQUESTS_QUEUED_MAX <= UINT16_MAX); /* a request's id */
FF_STATIC_ASSERT(FF_QUALITY_DEPTH_MAX == FF_KEY_LEVEL_MAX + 1);
FF_STATIC_ASSERT(FF_QUALITY_C_MAX <= INT32_MAX >> 8 && FF_QUALITY_ERROR_PX_MAX <= INT32_MAX >> 8);
FF_STATIC_ASSERT(FF_PICTURE_SIDE_MAX <= UINT16_MAX && FF_FACE_SIZE_MAX <= UINT16_MAX);

size_t ff_client_bytes_min(void) { return CLIENT_BYTES_MIN; }

static void default_quality(ff_client_desc *desc)
{
    ff_quality *quality = &desc->quality;
    uint32_t pixels = (uint32_t)desc->width * desc->height;
    int untouched = quality->measure == FF_MEASURE_DISTANCE && !quality->c_q8 &&
                    !quality->error_px_q8 && !quality->depth_max && !quality->sigma_q8 &&
                    !quality->view_wu && !quality->triangles_max;
    if (untouched) {
        int budget = desc->balance.mode == FF_BALANCE_ON && desc->balance.frame_budget;
        quality->measure = FF_MEASURE_PIXELS;
        quality->error_px_q8 = (budget ? FF_QUALITY_BUDGET_PX : FF_QUALITY_DEFAULT_PX) * 256;
        quality->triangles_max = pixels / (budget ? LEAST_PIXELS : FF_QUALITY_DEFAULT_PIXELS);
    }
    if (quality->c_q8 <= 0) quality->c_q8 = 3 * 256;
    if (quality->error_px_q8 <= 0) quality->error_px_q8 = FF_QUALITY_DEFAULT_PX * 256;
    if (quality->sigma_q8 <= 256) quality->sigma_q8 = 320;
    if (quality->view_wu <= 0) quality->view_wu = INT32_MAX;
    if (!quality->triangles_max) quality->triangles_max = pixels / LEAST_PIXELS;
}

static void bound_quality(ff_quality *quality)
{
    if (quality->c_q8 > FF_QUALITY_C_MAX << 8) quality->c_q8 = FF_QUALITY_C_MAX << 8;
    if (quality->error_px_q8 > FF_QUALITY_ERROR_PX_MAX << 8)
        quality->error_px_q8 = FF_QUALITY_ERROR_PX_MAX << 8;
    if (quality->depth_max > FF_QUALITY_DEPTH_MAX) quality->depth_max = FF_QUALITY_DEPTH_MAX;
}

static void default_panorama(ff_panorama_desc *panorama, unsigned width)
{
    if (panorama->back_plane_wu <= 0) panorama->back_plane_wu = 7500 * METRES;
    if (panorama->back_plane_wu > FF_PANORAMA_BACK_WU_MAX)
        panorama->back_plane_wu = FF_PANORAMA_BACK_WU_MAX;
    if (panorama->server_back_wu <= panorama->back_plane_wu) panorama->server_back_wu = INT32_MAX;
    if (panorama->error_px_q8 <= 0) panorama->error_px_q8 = (int32_t)width * 128 / 20;
    if (!panorama->face_size) panorama->face_size = 256;
    if (!panorama->quality || panorama->quality > 100) panorama->quality = 80;
    if (!ff_panorama_built || !ff_picture_built) panorama->enabled = FF_PANORAMA_OFF;
    FF_ASSERT(panorama->error_px_q8 > 0 && panorama->server_back_wu >= panorama->back_plane_wu);
}

static void default_far(ff_client_desc *desc)
{
    ff_far_desc *far = &desc->far;
    if (!ff_sets_built || !desc->stream) far->enabled = FF_FAR_OFF;
    if (!ff_picture_built) far->no_paint = 1;
    if (far->no_paint && far->enabled == FF_FAR_PAINT) far->enabled = FF_FAR_FINS;
    if (far->enabled) desc->panorama.enabled = FF_PANORAMA_OFF;
    if (far->front_wu <= 0) far->front_wu = 7500 * METRES;
    if (far->front_wu > FF_PANORAMA_BACK_WU_MAX) far->front_wu = FF_PANORAMA_BACK_WU_MAX;
    if (!far->coarse) far->coarse = 4;
    if (!far->quality) far->quality = desc->width > 320 ? 84 : 80;
    if (!far->tolerance_q2) far->tolerance_q2 = 2;
}

void ff_client_default_desc(ff_client_desc *desc)
{
    if (!desc->width) desc->width = 240;
    if (!desc->height) desc->height = 320;
    if (!desc->in_flight_max) desc->in_flight_max = desc->memory_bytes < 1u << 20 ? 32 : 48;
    if (!desc->answer_timeout_ms) desc->answer_timeout_ms = 60000;
    default_quality(desc);
    default_panorama(&desc->panorama, desc->width);
    default_far(desc);
    desc->no_textures |= !ff_textures_built;
    desc->use_map &= ff_contours_built && desc->backend;
    desc->about &= FF_ABOUT_KNOWN;
}

static int check_sources(const ff_client_desc *desc)
{
    int links = desc->stream != NULL,
        good = (desc->stream != NULL) != (desc->pack != NULL) && desc->more_count < FF_SOURCES_MAX;
    good &= !desc->pack || ff_pack_source_grounds(desc->pack) <= FF_WELCOME_GROUNDS;
    for (unsigned i = 0; good && i < desc->more_count; i++) {
        const ff_source_desc *more = &desc->more[i];
        good = (more->stream != NULL) != (more->pack != NULL) &&
               (!more->pack || ff_pack_source_grounds(more->pack) <= FF_WELCOME_GROUNDS);
        links |= more->stream != NULL;
    }
    if (!good) return FF_ERR_ARGUMENT;
    return (links && !ff_link_built) || (desc->more_count && !ff_grounds_built) ? FF_ERR_UNSUPPORTED
                                                                                : FF_OK;
}

static int check_desc(const ff_client_desc *desc)
{
    if (!desc->memory || desc->width > FF_PICTURE_SIDE_MAX || desc->height > FF_PICTURE_SIDE_MAX ||
        desc->in_flight_max > IN_FLIGHT_LIMIT || desc->panorama.quality > 100 ||
        (desc->panorama.face_size && desc->panorama.face_size < FF_PANORAMA_FACE_MIN) ||
        desc->panorama.face_size > FF_FACE_SIZE_MAX)
        return FF_ERR_ARGUMENT;
    if (desc->quality.c_q8 > FF_QUALITY_C_MAX << 8 ||
        desc->quality.error_px_q8 > FF_QUALITY_ERROR_PX_MAX << 8 ||
        desc->quality.depth_max > FF_QUALITY_DEPTH_MAX)
        return FF_ERR_ARGUMENT;
    if (desc->far.enabled > FF_FAR_AUTO || desc->far.coarse > FF_FAR_COARSE_MAX ||
        desc->far.paint_shift > FF_FAR_SHIFT_MAX || desc->far.quality > 100)
        return FF_ERR_ARGUMENT;
    if ((unsigned)desc->balance.mode > FF_BALANCE_ALL_CLIENT ||
        desc->panorama.enabled > FF_PANORAMA_AUTO)
        return FF_ERR_ARGUMENT;
    if (desc->backend && !desc->surface_api) return FF_ERR_ARGUMENT;
    if (desc->first_answer_ms > FF_FIRST_ANSWER_MS_MAX) return FF_ERR_ARGUMENT;
    if (desc->layer && !ff_layer_name_ok(desc->layer)) return FF_ERR_ARGUMENT;
    int rc = check_sources(desc);
    if (rc != FF_OK) return rc;
    return desc->memory_bytes < CLIENT_BYTES_MIN ? FF_ERR_MEMORY : FF_OK;
}

static void worker_main(void *context)
{
    ff_client *client = context;
    for (;;) {
        int moved = ff_client_work(client, sys_time_us());
        sys_mutex_lock(&client->gate);
        int stop = client->stop;
        sys_mutex_unlock(&client->gate);
        if (stop) return;
        if (!moved) sys_sleep_us(WORKER_SLEEP_US);
    }
}

/* The part of the block that does not depend on the terrain. */
static int make_fixed_part(ff_client *client)
{
    ff_budget budget;
    ff_budget_fixed(&budget, &client->desc, client->arena.bytes);
    client->more = ff_client_take(&client->arena, &budget, FF_POOL_sources);
    uint8_t *recv = ff_client_take(&client->arena, &budget, FF_POOL_received);
    uint8_t *slots = ff_client_take(&client->arena, &budget, FF_POOL_requests);
    uint8_t *about = ff_client_take(&client->arena, &budget, FF_POOL_about);
    unsigned links = ff_budget_links(&client->desc);
    if (!slots || (client->desc.more_count && !client->more) || (links && !recv) ||
        (budget.pool[FF_POOL_about].count && !about))
        return FF_ERR_MEMORY;
    client->fixed_bytes = client->arena.used;
    client->source_count = (uint8_t)(1 + client->desc.more_count);
    sys_mutex_init(&client->news.mutex);
    sys_mutex_init(&client->gate);
    for (unsigned i = 0; i < client->source_count; i++) {
        ff_source_room room = { .slots = slots };
        slots += ff_requests_bytes(client->desc.in_flight_max);
        if (ff_client_source_desc(client, i).stream) {
            room.recv = recv;
            room.recv_bytes = budget.pool[FF_POOL_received].count / links;
            room.about = about;
            if (recv) recv += room.recv_bytes;
            if (about) about += ff_about_bytes_max(client->desc.about);
        }
        ff_source_make(client, i, &room);
    }
    return FF_OK;
}

static void destroy_locks(ff_client *client)
{
    sys_mutex_destroy(&client->gate);
    sys_mutex_destroy(&client->news.mutex);
    for (unsigned i = 0; i < client->source_count; i++)
        sys_mutex_destroy(&ff_client_source(client, i)->requests.mutex);
}

/* Ground of this device, or none while the server has not told of its own: the sky. */
static int begin_terrain(ff_client *client)
{
    const ff_pack *pack = client->desc.pack ? client->desc.pack : ff_several_stand_in(client);
    int rc = FF_ERR_NOT_FOUND;
    if (client->desc.pack) ff_client_take_pack(client, &client->first);
    if (pack) {
        ff_layers layers;
        ff_pack_layers(pack, &layers);
        client->info = pack->header.info;
        ff_terrain_show_images(&client->info, &pack->header.info,
                               ff_client_layer_levels(client, &layers, 0));
        rc = ff_client_carve(client);
    }
    if (rc == FF_OK || client->desc.pack) return rc;
    ff_client_carve_sky(client);
    return FF_OK;
}

int ff_client_create(const ff_client_desc *desc, ff_client **result)
{
    *result = NULL;
    int rc = check_desc(desc);
    if (rc != FF_OK) return rc;
    ff_arena arena;
    ff_arena_init(&arena, desc->memory, desc->memory_bytes);
    ff_client *client = ff_arena_take(&arena, sizeof *client);
    if (!client) return FF_ERR_MEMORY;
    client->desc = *desc;
    ff_client_default_desc(&client->desc);
    client->arena = arena;
    client->geometry_hash = FF_TERRAIN_VIEW_HASH_START;
    if (desc->layer) memcpy(client->layer, desc->layer, strlen(desc->layer) + 1);
    rc = make_fixed_part(client);
    if (rc != FF_OK) return rc;
    rc = begin_terrain(client);
    if (rc == FF_OK && desc->use_thread) {
        rc = sys_thread_start(&client->thread, worker_main, client);
        client->threaded = rc == FF_OK;
    }
    if (rc != FF_OK) {
        ff_client_uncarve(client);
        destroy_locks(client);
        return rc;
    }
    *result = client;
    return FF_OK;
}

void ff_client_destroy(ff_client *client)
{
    if (!client) return;
    if (client->threaded) {
        sys_mutex_lock(&client->gate);
        client->stop = 1;
        sys_mutex_unlock(&client->gate);
        sys_thread_join(&client->thread);
    }
    for (unsigned i = 0; i < client->source_count; i++)
        if (ff_client_source(client, i)->io) ff_stream_close(&ff_client_source(client, i)->stream);
    ff_client_uncarve(client);
    destroy_locks(client);
}

int ff_client_work(ff_client *client, int64_t now_us)
{
    sys_mutex_lock(&client->gate);
    int moved = 0;
    for (unsigned i = 0; i < client->source_count; i++)
        moved |= ff_client_step_source(client, ff_client_source(client, i), now_us);
    sys_mutex_unlock(&client->gate);
    return moved;
}

/* ---- settings ---- */

void ff_client_event(ff_client *client, const sys_event *event)
{
    if (event->type != SYS_EVENT_BATTERY && event->type != SYS_EVENT_INTERRUPTION) return;
    sys_mutex_lock(&client->gate);
    if (event->type == SYS_EVENT_BATTERY)
        client->battery_low = event->u.battery.low != 0;
    else
        client->interrupted = event->u.interruption.begins != 0;
    client->dirty = 1;
    sys_mutex_unlock(&client->gate);
    for (unsigned i = 0; i < client->source_count; i++)
        if (ff_client_source(client, i)->io)
            ff_stream_say(&ff_client_source(client, i)->stream, client->interrupted,
                          ff_client_low_power(client));
}

void ff_client_start_over(ff_client *client)
{
    sys_mutex_lock(&client->gate);
    if (client->have_terrain) {
        ff_client_uncarve(client);
        client->first.intake.told_count = 0;
        (void)begin_terrain(client);
    }
    if (client->first.io) {
        client->first.stream.reach_wu = ff_client_reach_wu(client);
        ff_stream_restart(&client->first.stream);
    }
    sys_mutex_unlock(&client->gate);
}

void ff_client_set_quality(ff_client *client, const ff_quality *quality)
{
    client->desc.quality = *quality;
    default_quality(&client->desc);
    bound_quality(&client->desc.quality);
    /* the server has left out levels that a farther view needs */
    if (client->first.io && client->first.io->reconnect &&
        client->first.stream.reach_wu < ff_client_reach_wu(client))
        ff_client_start_over(client);
    client->dirty = 1;
    ff_client_balance_begin(client, 0);
}

void ff_client_set_panorama(ff_client *client, const ff_panorama_desc *panorama)
{
    unsigned face_size = client->panorama.face_size;
    client->desc.panorama = *panorama;
    if (client->desc.far.enabled) client->desc.panorama.enabled = FF_PANORAMA_OFF;
    uint16_t *size = &client->desc.panorama.face_size;
    if (*size > FF_FACE_SIZE_MAX) *size = FF_FACE_SIZE_MAX;
    if (*size && *size < FF_PANORAMA_FACE_MIN) *size = FF_PANORAMA_FACE_MIN;
    default_panorama(&client->desc.panorama, client->desc.width);
    client->dirty = 1;
    if (!client->have_terrain) return;
    if (client->desc.panorama.enabled && !face_size && !client->economy && client->desc.stream) {
        ff_client_start_over(client); /* the block was shared out without panoramas */
        return;
    }
    ff_requests_cancel_all(&client->first.requests, FF_KIND_FACE);
    ff_panorama_drop(&client->panorama);
    client->panorama.desc = client->desc.panorama;
    ff_client_auto_begin(client);
    ff_client_balance_begin(client, 0);
}

void ff_client_set_far(ff_client *client, const ff_far_desc *far)
{
    client->desc.far = *far;
    if (far->enabled > FF_FAR_AUTO) client->desc.far.enabled = FF_FAR_AUTO;
    if (far->coarse > FF_FAR_COARSE_MAX) client->desc.far.coarse = FF_FAR_COARSE_MAX;
    if (far->paint_shift > FF_FAR_SHIFT_MAX) client->desc.far.paint_shift = FF_FAR_SHIFT_MAX;
    if (far->quality > 100) client->desc.far.quality = 100;
    default_far(&client->desc);
    client->dirty = 1;
    if (!client->have_terrain) return;
    if (client->sets) {
        ff_sets_set(client->sets, &client->first.requests, &client->desc.far);
        client->far_asked = 0;
    } else if (client->desc.far.enabled && !client->economy) {
        ff_client_start_over(client); /* the block was shared out without sets, or with panoramas */
    }
}

int ff_client_set_map(ff_client *client, const ff_map_show *map)
{
    if (!client->desc.use_map || !client->desc.backend) return FF_ERR_UNSUPPORTED;
    if (map->contour_wu && map->contour_wu < FF_CONTOUR_WU_MIN) return FF_ERR_ARGUMENT;
    client->dirty |= client->map.contour_wu != map->contour_wu ||
                     client->map.has_place != map->has_place ||
                     memcmp(client->map.place_wu, map->place_wu, sizeof map->place_wu) != 0;
    client->map = *map;
    return FF_OK;
}

void ff_client_set_show(ff_client *client, unsigned show)
{
    client->dirty |= client->show != show;
    client->show = show;
}

/* ---- what can be read ---- */

const ff_terrain_info *ff_client_terrain(const ff_client *client)
{
    return client->have_terrain ? &client->info : NULL;
}

/* Under the gate: a pack that is read has one room, which the worker reads into, too. */
static int about_of_pack(ff_client *client, const ff_pack *pack, unsigned entry, void *value,
                         size_t room)
{
    const uint8_t *found;
    ff_list about;
    sys_mutex_lock(&client->gate);
    int bytes = ff_pack_about(pack, &about);
    if (bytes == FF_OK) bytes = ff_list_find(about, entry, &found);
    if (bytes > 0 && (size_t)bytes > room) bytes = FF_ERR_FULL;
    if (bytes > 0) memcpy(value, found, (size_t)bytes);
    sys_mutex_unlock(&client->gate);
    return bytes;
}

int ff_client_source_about(ff_client *client, unsigned number, enum ff_about_entry entry,
                           void *value, size_t room)
{
    if (number >= client->source_count) return FF_ERR_ARGUMENT;
    if (!ff_about_in(client->desc.about, entry)) return FF_ERR_NOT_FOUND;
    ff_source *source = ff_client_source(client, number);
    if (source->pack) return about_of_pack(client, source->pack, entry, value, room);
    return ff_stream_about_entry(&source->stream, entry, value, room);
}

int ff_client_about(ff_client *client, enum ff_about_entry entry, void *value, size_t room)
{
    return ff_client_source_about(client, 0, entry, value, room);
}

int ff_client_source_state(const ff_client *client, unsigned number)
{
    if (number >= client->source_count) return FF_ERR_ARGUMENT;
    return ff_client_source((ff_client *)client, number)->error;
}

const ff_tree *ff_client_tree(const ff_client *client) { return client->tree; }

c3d_device *ff_client_device(ff_client *client) { return client->device; }

int ff_client_ground(const ff_client *client, int32_t x_wu, int32_t y_wu, int32_t *z_wu)
{
    return client->tree ? ff_tree_drawn_height(client->tree, x_wu, y_wu, z_wu) : 0;
}

int ff_client_filled(const ff_client *client, int32_t x_wu, int32_t y_wu)
{
    return client->tree ? ff_tree_drawn_filled(client->tree, x_wu, y_wu) : 0;
}

int ff_client_wears(const ff_client *client, ff_key image)
{
    return client->has_textures && ff_textures_is_worn(&client->textures, image);
}

int ff_client_panorama(const ff_client *client, int32_t position_wu[3], unsigned *faces)
{
    if (!client->have_terrain || client->panorama.shown < 0) return 0;
    FF_ASSERT(client->panorama.shown == client->panorama.active && client->panorama.shown < 2);
    const ff_panorama_set *set = &client->panorama.set[client->panorama.shown];
    FF_ASSERT((set->held & set->empty) == 0);
    ff_shape_leave(&client->info, &client->last_view.frame, set->position_wu, position_wu);
    *faces = (unsigned)set->held | set->empty;
    return 1;
}

int ff_client_far(const ff_client *client, ff_far_in_use *use)
{
    const ff_sets *sets = client->sets;
    if (!sets || sets->active < 0) return 0;
    FF_ASSERT(sets->active < 2);
    const ff_set *set = &sets->set[sets->active];
    use->set = set->key;
    use->sectors = ff_sets_in_view(&client->last_view.camera) & ((unsigned)set->held | set->empty);
    memcpy(use->position_wu, set->position_wu, sizeof use->position_wu);
    ff_shape_leave(&client->info, &client->last_view.frame, set->position_wu, use->world_wu);
    return 1;
}

void ff_client_watch_fins(ff_client *client, ff_fins_made made, void *context)
{
    client->fins_made = made;
    client->fins_context = context;
    if (!client->sets) return;
    client->sets->watch = made;
    client->sets->watch_context = context;
}

uint64_t ff_client_geometry_hash(const ff_client *client) { return client->geometry_hash; }

uint64_t ff_client_request_hash(const ff_client *client)
{
    ff_request_counts counts;
    uint64_t hash = 0;
    /* only their locks are written; the first one's is the last: alone it is the hash */
    for (unsigned i = client->source_count; i-- > 0;) {
        uint64_t of_source;
        ff_requests_get_counts(&ff_client_source((ff_client *)client, i)->requests, &counts,
                               &of_source);
        hash = hash * UINT64_C(0x100000001b3) ^ of_source;
    }
    return hash;
}
