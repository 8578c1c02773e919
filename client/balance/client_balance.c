/* The balance (ff_balance.h) in a client: what it measures, and where its knobs go. */
#include "../ff_client_local.h"
#include "../../protocol/ff_assert.h"

static int can_panorama(const ff_client *client)
{
    return client->panorama.desc.enabled && client->panorama.face_size;
}

static void apply(ff_client *client)
{
    ff_balance_knobs knobs;
    client->dirty = 1;
    if (!can_panorama(client)) return;
    ff_balance_get(&client->balance, &knobs);
    client->panorama.desc.error_px_q8 = knobs.panorama_error_q8;
    client->all_client = !knobs.back_plane_wu;
    if (knobs.back_plane_wu) client->panorama.desc.back_plane_wu = knobs.back_plane_wu;
    if (client->all_client) ff_requests_cancel_all(&client->first.requests, FF_KIND_FACE);
}

void ff_client_balance_begin(ff_client *client, int fresh)
{
    client->all_client = 0;
    if (!client->have_terrain || client->desc.balance.mode == FF_BALANCE_OFF) return;
    ff_balance_set(&client->balance, &client->desc.balance, &client->desc.quality,
                   can_panorama(client) ? &client->desc.panorama : NULL, client->frame_cost != 0,
                   fresh);
    apply(client);
}

void ff_client_balance_step(ff_client *client, const c3d_camera *camera, int64_t now_us)
{
    if (client->desc.balance.mode == FF_BALANCE_OFF) return;
    ff_tree_stats tree;
    ff_tree_get_stats(client->tree, &tree);
    const ff_quality *in_force = ff_tree_quality(client->tree);
    ff_balance_sample sample = { .now_us = now_us,
                                 .frame_cost = client->frame_cost,
                                 .triangles = tree.triangles,
                                 .c_q8 = in_force->c_q8,
                                 .error_px_q8 = in_force->error_px_q8 };
    if (ff_budget_links(&client->desc)) {
        ff_stream_shared shared;
        ff_client_link(client, &shared);
        sample.bytes_down = shared.bytes_down;
        sample.rate_bytes_s = shared.bytes_s;
        sample.rtt_us = shared.rtt_us;
        sample.waiting = ff_client_waiting(client, FF_CLASS_IN_VIEW) ||
                         ff_panorama_late(&client->panorama, camera);
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
    quality->c_q8 = knobs.c_q8;
    quality->error_px_q8 = knobs.error_px_q8;
    quality->triangles_max = knobs.triangles_max;
}

/* Where the limit of triangles stands between the least and the one set, in log2 units. */
static unsigned share_percent(const ff_client *client)
{
    ff_balance_knobs knobs;
    ff_balance_get(&client->balance, &knobs);
    int32_t least_q8 = ff_balance_log2_q8(FF_TRIANGLES_MIN),
            set_q8 = ff_balance_log2_q8(client->desc.quality.triangles_max) - least_q8,
            now_q8 = ff_balance_log2_q8(knobs.triangles_max) - least_q8;
    FF_ASSERT(now_q8 >= 0);
    return now_q8 >= set_q8 ? 100 : (unsigned)(now_q8 * 100 / set_q8);
}

void ff_client_balance_stats(const ff_client *client, ff_balance_stats *stats)
{
    const ff_balance *balance = &client->balance;
    if (client->desc.balance.mode == FF_BALANCE_OFF || !client->have_terrain) return;
    for (int i = 0; i < FF_BALANCE_LEVELS; i++) FF_ASSERT(balance->level[i] <= balance->top[i]);
    unsigned level = balance->level[FF_BALANCE_FIDELITY], top = balance->top[FF_BALANCE_FIDELITY];
    stats->share_percent = (uint8_t)share_percent(client);
    stats->fidelity_percent = (uint8_t)(top ? level * 100 / top : 100);
    stats->frame_load_q8 = balance->load_q8[FF_BALANCE_SHARE];
    stats->link_load_q8 = balance->load_q8[FF_BALANCE_FIDELITY];
    stats->moves = balance->moves;
    stats->turns = balance->turns;
}

void ff_client_set_balance(ff_client *client, const ff_balance_desc *desc)
{
    int fresh = client->desc.balance.mode == FF_BALANCE_OFF;
    client->desc.balance = *desc;
    for (unsigned i = 0; i < client->source_count; i++)
        ff_client_allow(client, ff_client_source(client, i));
    if (client->have_terrain && desc->mode == FF_BALANCE_OFF) {
        client->panorama.desc.back_plane_wu = client->desc.panorama.back_plane_wu;
        client->panorama.desc.error_px_q8 = client->desc.panorama.error_px_q8;
        client->dirty = 1;
    }
    ff_client_balance_begin(client, fresh);
}

void ff_client_frame_cost(ff_client *client, uint32_t cost)
{
    int another_unit = !cost != !client->frame_cost;
    client->frame_cost = cost;
    if (another_unit) ff_client_balance_begin(client, 0);
}
