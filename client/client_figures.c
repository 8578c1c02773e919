/* What can be read of a client: its figures (ff_figures.h) and what its pools hold (ff_budget.h).
 */
#include "ff_client_local.h"
#include "terrain/ff_estimate.h"
#include "../protocol/ff_assert.h"

#include <string.h>

/* What the parts of a client say of themselves, each asked once and under its own lock. */
typedef struct ff_readings {
    const ff_client *client;
    ff_tree_stats tree;
    c3d_stats c3d;
    ff_stream_shared link; /* zero without a link */
    ff_request_counts requests;
    uint32_t requests_held; /* slots in use */
    ff_new_data_counts news;
    ff_balance_stats balance;
} ff_readings;

static void read_parts(const ff_client *client, ff_readings *readings)
{
    /* only the locks of what is asked are written */
    ff_client *asked = (ff_client *)client;
    ff_request_counts *requests = &readings->requests;
    memset(readings, 0, sizeof *readings);
    readings->client = client;
    if (client->tree) ff_tree_get_stats(client->tree, &readings->tree);
    if (client->device) c3d_get_stats(client->device, &readings->c3d);
    ff_client_link(asked, &readings->link);
    ff_client_counts(asked, requests);
    readings->requests_held = requests->queued + requests->in_flight + requests->arriving;
    FF_ASSERT(readings->requests_held <= requests->held_high);
    FF_ASSERT(readings->tree.nodes_held <= readings->tree.nodes_high);
    ff_new_data_get_counts(&asked->news, &readings->news);
    ff_client_balance_stats(client, &readings->balance);
}

/* ---- figures ---- */

static enum ff_link_state link_state(const ff_readings *from)
{
    static const enum ff_link_state link[] = { [FF_STREAM_CONNECTING] = FF_LINK_CONNECTING,
                                               [FF_STREAM_GREETING] = FF_LINK_CONNECTING,
                                               [FF_STREAM_WELCOMED] = FF_LINK_UP,
                                               [FF_STREAM_UP] = FF_LINK_UP,
                                               [FF_STREAM_DOWN] = FF_LINK_DOWN,
                                               [FF_STREAM_DEAD] = FF_LINK_DOWN };
    FF_ASSERT(from->link.state < sizeof link / sizeof link[0]);
    return ff_budget_links(&from->client->desc) ? link[from->link.state] : FF_LINK_NONE;
}

static int32_t back_plane_wu(const ff_client *client)
{
    return client->far_painted ? ff_client_quality(client).view_wu : 0;
}

static ff_quality quality_in_force(const ff_client *client)
{
    return client->have_terrain && client->has_camera ? *ff_tree_quality(client->tree)
                                                      : ff_client_quality(client);
}

void ff_client_get_stats(const ff_client *client, ff_client_stats *stats)
{
    ff_readings readings, *from = &readings;
    read_parts(client, from);
#define FIELD(type, name, where_from, what) stats->name = (where_from);
#define PART(name, member)
    FF_CLIENT_FIGURES(FIELD, FIELD, PART)
#undef FIELD
#undef PART
}

int ff_client_asked_for_reserve(ff_client *client, enum ff_kind kind, uint16_t id, ff_key key)
{
    ff_request request;
    if (!id) return ff_requests_is_reserve(&client->first.requests, kind, key);
    return ff_requests_answered(&client->first.requests, id, &request) &&
           request.rank == FF_CLASS_RESERVE;
}

uint32_t ff_client_error_px_q8(const ff_client *client)
{
    const ff_panorama *panorama = &client->panorama;
    ff_beyond beyond = { 0 };
    if (!client->tree) /* anything may be there */
        return (uint32_t)c3d_length64(client->desc.width, client->desc.height, 0) << 8;
    if (panorama->shown >= 0 && client->far_painted) {
        beyond.face_size = panorama->face_size;
        beyond.back_wu = panorama->desc.server_back_wu;
        memcpy(beyond.position_wu, panorama->set[panorama->shown].position_wu,
               sizeof beyond.position_wu);
    }
    return ff_estimate_p95_q8(client->tree, &beyond);
}

/* ---- pools ---- */

/* farfield.h has room for all of them */
FF_STATIC_ASSERT(FF_POOL_COUNT <= FF_POOLS_MAX);

static void list_pools(const ff_budget *budget, ff_pool_use *list)
{
    static const struct {
        const char *name;
        uint8_t inside;
    } row[FF_POOL_COUNT] = {
#define X(name, when, wanted, least, most, bytes, held, high, why) { #name, 0 },
#define PART(name, n, bytes, held, high, why)                      { #name, 1 },
        FF_POOL_LIST(X, PART)
#undef X
#undef PART
    };
    for (unsigned i = 0; i < FF_POOL_COUNT; i++)
        list[i] = (ff_pool_use){ .name = row[i].name,
                                 .count = budget->pool[i].count,
                                 .bytes = budget->pool[i].bytes,
                                 .inside = row[i].inside };
}

unsigned ff_client_pools(const ff_client *client, ff_pool_use list[FF_POOLS_MAX])
{
    ff_readings readings, *from = &readings;
    ff_budget budget, *b = &budget;
    read_parts(client, from);
    ff_budget_fixed(b, &client->desc, client->arena.bytes);
    if (client->have_terrain) {
        b->info = &client->info;
        b->grounds_max = ff_budget_grounds(&client->desc, client->first.intake.ground_count);
        b->face_size = client->first.intake.face_size_max;
        b->far_side = client->sets ? client->sets->side : 0;
        b->has_textures = client->has_textures;
        b->economy = client->economy;
        (void)ff_budget_terrain(b, from->c3d.vertex_buffers_used);
    }
    list_pools(b, list);
    const struct {
        uint32_t held, high;
    } use[FF_POOL_COUNT] = {
#define X(name, when, wanted, least, most, bytes, held, high, why) { (held), (high) },
#define PART(name, n, bytes, held, high, why)                      { (held), (high) },
        FF_POOL_LIST(X, PART)
#undef X
#undef PART
    };
    for (unsigned i = 0; i < FF_POOL_COUNT; i++) {
        list[i].held = list[i].count ? use[i].held : 0;
        list[i].high = list[i].count ? use[i].high : 0;
        FF_ASSERT(list[i].held <= list[i].high && list[i].high <= list[i].count);
    }
    return FF_POOL_COUNT;
}

int ff_client_plan(const ff_client_desc *desc, const ff_terrain_info *info,
                   ff_pool_use list[FF_POOLS_MAX])
{
    ff_client_desc filled = *desc;
    ff_budget budget;
    int rc = FF_ERR_MEMORY;
    ff_client_default_desc(&filled);
    ff_budget_fixed(&budget, &filled, filled.memory_bytes);
    for (unsigned economy = 0; rc == FF_ERR_MEMORY && economy < FF_ECONOMY_STEPS; economy++) {
        ff_budget_economise(&budget, info, economy);
        rc = ff_budget_terrain(&budget, !filled.use_plain_arrays);
    }
    if (rc != FF_OK) return rc;
    list_pools(&budget, list);
    return FF_POOL_COUNT;
}
