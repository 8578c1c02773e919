/* The balance (ff_balance.h) in a client: what it measures, and where its knobs go. A new back
 * plane comes into force with the panorama taken for it: until that one is drawn, the ground
 * reaches to where the panorama before it begins. */
#include "../ff_client_local.h"
#include "../../protocol/ff_assert.h"

static int can_panorama(const ff_client *client)
{
    return client->panorama.desc.enabled && client->panorama.face_size;
}

static void apply(ff_client *client)
{
    ff_balance_knobs knobs;
    ff_balance_get(&client->balance, &knobs);
    FF_ASSERT(knobs.back_plane_wu >= 0 && knobs.back_plane_wu <= client->balance.finest.view_wu);
    client->panorama.desc.error_px_q8 = knobs.panorama_error_q8;
    client->all_client = can_panorama(client) && !knobs.back_plane_wu;
    if (knobs.back_plane_wu > FF_PANORAMA_BACK_WU_MAX)
        knobs.back_plane_wu = FF_PANORAMA_BACK_WU_MAX;
    if (knobs.back_plane_wu) client->panorama.desc.back_plane_wu = knobs.back_plane_wu;
    if (client->all_client) ff_requests_cancel_all(&client->requests, FF_KIND_FACE);
    client->dirty = 1;
}

void ff_client_balance_begin(ff_client *client, int fresh)
{
    client->all_client = 0;
    if (!client->have_terrain || client->desc.balance.mode == FF_BALANCE_OFF) return;
    ff_quality finest = client->desc.quality;
    const ff_terrain_info *info = &client->info;
    int64_t size_wu[2];
    ff_shape_size_wu(info, size_wu);
    int64_t extent_wu = (size_wu[0] > size_wu[1] ? size_wu[0] : size_wu[1]) + info->spacing_wu;
    if (finest.depth_max > ff_terrain_levels(info))
        finest.depth_max = (uint8_t)ff_terrain_levels(info);
    FF_ASSERT(finest.depth_max <= FF_QUALITY_DEPTH_MAX && extent_wu > 0);
    if (finest.view_wu > extent_wu) finest.view_wu = (int32_t)extent_wu;
    ff_balance_set(&client->balance, &client->desc.balance, &finest, &client->desc.panorama,
                   can_panorama(client), fresh);
    apply(client);
}

/* 1 when the back plane that the balance chose is the one drawn, or, when it chose none, no
 * panorama is left. */
static int in_force(const ff_client *client)
{
    const ff_panorama *panorama = &client->panorama;
    FF_ASSERT(panorama->shown < 0 || panorama->shown == panorama->active);
    if (!can_panorama(client)) return 1;
    if (client->all_client) return panorama->active < 0;
    return panorama->shown >= 0 &&
           panorama->set[panorama->shown].front_wu == panorama->desc.back_plane_wu;
}

void ff_client_balance_step(ff_client *client, const c3d_camera *camera, int64_t now_us)
{
    if (client->desc.balance.mode == FF_BALANCE_OFF) return;
    ff_balance_sample sample = { .now_us = now_us,
                                 .frame_cost = client->frame_cost,
                                 .in_force = (uint8_t)in_force(client) };
    ff_tree_stats tree;
    ff_tree_get_stats(client->tree, &tree);
    if (!sample.frame_cost) sample.frame_cost = tree.triangles;
    if (client->desc.stream) {
        ff_stream_shared shared;
        ff_stream_get_shared(&client->stream, &shared);
        sample.bytes_down = shared.bytes_down;
        sample.rate_bytes_s = shared.bytes_s;
        sample.rtt_us = shared.rtt_us;
        sample.waiting = ff_requests_waiting(&client->requests, FF_CLASS_IN_VIEW) ||
                         ff_panorama_late(&client->panorama, camera);
    }
    /* all of the client's own ground is here: the panorama goes */
    if (client->all_client && client->panorama.active >= 0 && !sample.waiting) {
        ff_panorama_drop(&client->panorama);
        client->dirty = 1;
    }
    if (ff_client_low_power(client) || !tree.nodes_held)
        ff_balance_pause(&client->balance);
    else if (ff_balance_feed(&client->balance, &sample))
        apply(client);
}

void ff_client_balance_quality(const ff_client *client, ff_quality *quality)
{
    if (client->desc.balance.mode == FF_BALANCE_OFF || !client->have_terrain) return;
    ff_balance_knobs knobs;
    ff_balance_get(&client->balance, &knobs);
    FF_ASSERT(knobs.c_q8 <= quality->c_q8 && knobs.error_px_q8 >= quality->error_px_q8);
    FF_ASSERT(knobs.depth_max <= quality->depth_max);
    quality->c_q8 = knobs.c_q8;
    quality->error_px_q8 = knobs.error_px_q8;
    quality->depth_max = knobs.depth_max;
}

void ff_client_balance_stats(const ff_client *client, ff_balance_stats *stats)
{
    const ff_balance *balance = &client->balance;
    if (client->desc.balance.mode == FF_BALANCE_OFF || !client->have_terrain) return;
    for (int i = 0; i < FF_BALANCE_LEVELS; i++) FF_ASSERT(balance->level[i] <= balance->top[i]);
    unsigned share = FF_BALANCE_SHARE, fidelity = FF_BALANCE_FIDELITY;
    stats->share_percent =
        (uint8_t)(balance->top[share] ? balance->level[share] * 100 / balance->top[share] : 100);
    stats->fidelity_percent = (uint8_t)(balance->top[fidelity] ? balance->level[fidelity] * 100 /
                                                                     balance->top[fidelity]
                                                               : 100);
    stats->frame_load_q8 = balance->load_q8[share];
    stats->link_load_q8 = balance->load_q8[fidelity];
    stats->moves = balance->moves;
    stats->turns = balance->turns;
}

void ff_client_set_balance(ff_client *client, const ff_balance_desc *desc)
{
    int fresh = client->desc.balance.mode == FF_BALANCE_OFF;
    client->desc.balance = *desc;
    if (client->have_terrain && desc->mode == FF_BALANCE_OFF) {
        client->panorama.desc.back_plane_wu = client->desc.panorama.back_plane_wu;
        client->panorama.desc.error_px_q8 = client->desc.panorama.error_px_q8;
        client->dirty = 1;
    }
    ff_client_balance_begin(client, fresh);
}

void ff_client_frame_cost(ff_client *client, uint32_t cost) { client->frame_cost = cost; }
