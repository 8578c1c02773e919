/* Ground of which several levels are missing, after the start, a turn or a leap: the server is
 * asked for all that the view needs, instead of level by level, a round trip each (FF_KIND_VIEW).
 */
#include "ff_client_local.h"
#include "../protocol/ff_assert.h"

#include <string.h>

/* A node is off by so many times what is allowed: more than its children will be needed, since each
 * level halves the error as a rule. */
#define DEEP 4

/* What the answers may take of the link, in seconds, and in round trips: what comes is in the
 * server's order, and the viewer moves meanwhile; but what is left out costs another round trip. */
#define VIEW_SECONDS       3u
#define VIEW_ROUND_TRIPS   1u
#define VIEW_BYTES_MIN     4096u
#define VIEW_BYTES_MAX     32768u
#define VIEW_BYTES_UNTIMED 16384u /* while nothing is known of the link */

/* A root that comes into view while others are here is far away, and needs little below. */
static int is_deep(const ff_client *client, const ff_wish *wish)
{
    const ff_quality *quality = ff_tree_quality(client->tree);
    const ff_drawn *drawn;
    uint32_t allowed = quality->measure == FF_MEASURE_PIXELS ? (uint32_t)quality->error_px_q8 : 256;
    return wish->kind == FF_KIND_ROOT ? !ff_tree_in_view(client->tree, &drawn)
                                      : wish->priority / DEEP >= allowed;
}

static uint32_t bytes_for(ff_client *client, ff_source *source)
{
    ff_stream_shared shared;
    uint32_t budget = client->desc.balance.mode == FF_BALANCE_ON ? client->desc.balance.link_bytes_s
                                                                 : 0;
    ff_stream_get_shared(&source->stream, &shared);
    uint64_t view_ms = VIEW_SECONDS * 1000u + VIEW_ROUND_TRIPS * (shared.rtt_us / 1000u),
             bytes = shared.bytes_s ? shared.bytes_s * view_ms / 1000u : VIEW_BYTES_UNTIMED;
    if (bytes < VIEW_BYTES_MIN) bytes = VIEW_BYTES_MIN;
    if (budget && bytes > budget * view_ms / 1000u) bytes = budget * view_ms / 1000u;
    return bytes < VIEW_BYTES_MAX ? (uint32_t)bytes : VIEW_BYTES_MAX;
}

/* Names what is wished for of a source in view and not on its way. 1 when some of it is deep. */
static int name_wishes(ff_client *client, ff_source *source, ff_get_view *asked)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(client->tree, &list);
    int deep = 0;
    for (uint32_t i = 0; i < count && asked->count < FF_VIEW_KEYS_MAX; i++) {
        enum ff_kind kind = (enum ff_kind)list[i].kind;
        if (!list[i].in_view || ff_client_route(client, kind, list[i].key, list[i].lacks) != source)
            continue;
        ff_key key = ff_source_own_key(source, list[i].key);
        if (ff_requests_out(&source->requests, kind, key)) continue;
        deep |= is_deep(client, &list[i]);
        if (kind == FF_KIND_ROOT) asked->roots |= (uint16_t)(1u << asked->count);
        asked->below[asked->count++] = key;
    }
    return deep;
}

/* What of the rest may be needed beside that. */
static void name_edge(ff_client *client, ff_source *source, ff_get_view *asked)
{
    ff_wish edge[FF_VIEW_EDGE_MAX];
    uint32_t count = ff_tree_edge(client->tree, edge, FF_VIEW_EDGE_MAX);
    for (uint32_t i = 0; i < count; i++) {
        if (ff_client_route(client, FF_KIND_REFINEMENT, edge[i].key, edge[i].lacks) != source)
            continue;
        ff_key key = ff_source_own_key(source, edge[i].key);
        if (!ff_view_covers(asked, FF_KIND_REFINEMENT, key) &&
            !ff_requests_out(&source->requests, FF_KIND_REFINEMENT, key))
            asked->edge[asked->edge_count++] = key;
    }
}

/* All but where the camera is. */
static void describe(ff_client *client, ff_source *source, const c3d_camera *camera,
                     const ff_quality *quality, ff_get_view *asked)
{
    int by_pixels = quality->measure == FF_MEASURE_PIXELS;
    asked->yaw = (uint16_t)camera->yaw;
    asked->pitch = (uint16_t)camera->pitch;
    asked->roll = (uint16_t)camera->roll;
    asked->focal_q8 = camera->focal_q8;
    asked->width = camera->width ? camera->width : client->desc.width;
    asked->height = camera->height ? camera->height : client->desc.height;
    asked->measure = by_pixels ? FF_VIEW_BY_PIXELS : FF_VIEW_BY_DISTANCE;
    asked->allowed_q8 = by_pixels ? quality->error_px_q8 : quality->c_q8;
    asked->depth_max = quality->depth_max;
    asked->reach_wu = quality->view_wu;
    asked->fine_wu = quality->fine_wu > 0 ? quality->fine_wu : INT32_MAX;
    asked->coarse = quality->coarse > 1 ? quality->coarse : 1;
    asked->triangles_max = quality->triangles_max;
    asked->bytes_max = bytes_for(client, source);
}

/* The view that is out brings nothing that is wished for now: the viewer is somewhere else. */
static int is_stale(ff_client *client, ff_source *source)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(client->tree, &list);
    int elsewhere = 0;
    for (uint32_t i = 0; i < count; i++) {
        enum ff_kind kind = (enum ff_kind)list[i].kind;
        if (!list[i].in_view || ff_client_route(client, kind, list[i].key, list[i].lacks) != source)
            continue;
        if (ff_requests_view_brings(&source->requests, kind,
                                    ff_source_own_key(source, list[i].key)))
            return 0;
        elsewhere |= is_deep(client, &list[i]);
    }
    return elsewhere;
}

static int32_t place_wu(int64_t along_wu)
{
    return along_wu < -INT32_MAX  ? -INT32_MAX
           : along_wu > INT32_MAX ? INT32_MAX
                                  : (int32_t)along_wu;
}

/* Where the viewer is likely to be when the source's answer comes, in the client's frame. */
static void place_then(const ff_client *client, ff_source *source, const c3d_camera *camera,
                       int32_t then_wu[3])
{
    ff_stream_shared shared;
    ff_stream_get_shared(&source->stream, &shared);
    memcpy(then_wu, camera->pos_wu, sizeof camera->pos_wu);
    (void)ff_motion_level(&client->motion, shared.rtt_us, then_wu);
}

void ff_client_want_view(ff_client *client, ff_source *source, const ff_view *view,
                         const ff_quality *quality)
{
    ff_get_view asked = { 0 };
    int32_t then_wu[3];
    if (!source->io || !source->serves || client->desc.no_views || source->no_views) return;
    if (ff_requests_out(&source->requests, FF_KIND_VIEW, 0)) {
        if (is_stale(client, source)) ff_requests_cancel(&source->requests, FF_KIND_VIEW, 0);
        return;
    }
    if (!name_wishes(client, source, &asked)) return;
    name_edge(client, source, &asked);
    describe(client, source, &view->camera, quality, &asked);
    place_then(client, source, &view->camera, then_wu);
    ff_shape_leave(&client->info, &view->frame, then_wu, asked.position_wu);
    /* the server's world begins at its own ground */
    for (int i = 0; i < 2; i++)
        asked.position_wu[i] = place_wu((int64_t)asked.position_wu[i] -
                                        source->ground[0].south_west_wu[i]);
    ff_requests_want_view(&source->requests, &asked);
}

/* As far as the client will draw: whether a panorama comes behind its ground is known beforehand
 * only where it is told to. */
static ff_quality quality_to_be(const ff_client *client)
{
    ff_quality quality = ff_client_quality(client);
    int32_t back_wu = client->desc.panorama.back_plane_wu;
    int painted = client->desc.panorama.enabled == FF_PANORAMA_ON &&
                  client->desc.balance.mode != FF_BALANCE_ALL_CLIENT;
    if (painted && back_wu < quality.view_wu) quality.view_wu = back_wu;
    if (client->desc.far.enabled && client->desc.far.enabled != FF_FAR_AUTO) {
        quality.fine_wu = client->desc.far.front_wu;
        quality.coarse = client->desc.far.coarse;
    }
    return quality;
}

void ff_client_greet_view(ff_client *client, const c3d_camera *camera)
{
    const ff_quality quality = quality_to_be(client);
    ff_get_view asked = { 0 };
    if (!client->desc.stream || client->desc.no_views || !client->desc.place_known) return;
    if (client->source_count > ff_budget_links(&client->desc)) return; /* a pack here may have it */
    ff_requests_rank_begin(&client->first.requests);
    if (!ff_requests_out(&client->first.requests, FF_KIND_VIEW, 0)) {
        describe(client, &client->first, camera, &quality, &asked);
        memcpy(asked.position_wu, camera->pos_wu, sizeof asked.position_wu);
        for (int i = 0; i < 2; i++)
            asked.position_wu[i] = place_wu(camera->pos_wu[i] +
                                            (int64_t)client->desc.velocity_wu_s[i] *
                                                client->desc.first_answer_ms / 1000);
        ff_requests_want_view(&client->first.requests, &asked);
    }
    ff_requests_rank_end(&client->first.requests);
}

/* Its ground has come, each part as if it had been asked for alone; what was named and is missing
 * was refused. */
int ff_client_take_view(ff_client *client, ff_new_item *item, int64_t now_us)
{
    ff_source *source = ff_client_source(client, item->source);
    const ff_get_view *asked = &source->requests.view;
    (void)now_us;
    if (item->refused) {
        source->no_views |= item->error != FF_ERR_CLOSED;
        return 0;
    }
    FF_ASSERT(item->error == FF_OK && asked->count <= FF_VIEW_KEYS_MAX);
    for (unsigned i = 0; i < asked->count; i++)
        if (item->u.missing >> i & 1u)
            ff_refusals_note(&source->refusals,
                             asked->roots >> i & 1u ? FF_KIND_ROOT : FF_KIND_REFINEMENT,
                             asked->below[i], 0);
    return 0;
}
