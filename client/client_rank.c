/* What to ask for next, most urgent first:
 *   FIRST        roots in view, panorama faces in view
 *   IN_VIEW      refinements and images in view: pixels of error removed for each byte expected
 *   OUT_OF_VIEW  the same outside the view, panorama faces outside it
 *   PREFETCH     ground ahead on the predicted path; leaves only while the link has room and nothing else waits
 * The queue's contents are replaced each time; what is no longer wanted is dropped. */
#include "ff_client_local.h"

#define AHEAD_US 5000000

static void want_tree(ff_client *client)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(client->tree, &list);
    for (uint32_t i = 0; i < count; i++) {
        const ff_wish *wish = &list[i];
        enum ff_request_kind kind = wish->refinement ? FF_WANT_REFINEMENT : FF_WANT_ROOT;
        enum ff_request_class rank = !wish->in_view ? FF_CLASS_OUT_OF_VIEW : wish->refinement ? FF_CLASS_IN_VIEW : FF_CLASS_FIRST;
        if (!ff_refusals_final(&client->refusals, kind, wish->key))
            ff_requests_want(&client->requests, kind, wish->key, rank, wish->priority, NULL);
    }
}

static void want_textures(ff_client *client, const ff_view *view, const ff_quality *quality)
{
    ff_texture_wish wish[FF_TEXTURE_WISHES];
    const ff_drawn *drawn;
    uint32_t drawn_count = ff_tree_drawn(client->tree, &drawn);
    uint32_t count = ff_textures_wishes(&client->textures, drawn, drawn_count, view, quality, wish, FF_TEXTURE_WISHES);
    for (uint32_t i = 0; i < count; i++)
        if (!ff_refusals_final(&client->refusals, FF_WANT_TEXTURE, wish[i].key))
            ff_requests_want(&client->requests, FF_WANT_TEXTURE, wish[i].key, FF_CLASS_IN_VIEW, wish[i].priority, NULL);
}

/* Ground ahead: as far as the viewer gets while an answer is on its way, and some seconds more. */
static void want_ahead(ff_client *client)
{
    ff_stream_shared shared = {.rtt_us = 0};
    if (client->desc.stream)
        ff_stream_get_shared(&client->stream, &shared);
    int32_t pos_wu[3];
    if (!ff_motion_predict(&client->motion, AHEAD_US + 2 * (int64_t)shared.rtt_us, pos_wu))
        return;
    ff_wish wish[FF_PREFETCH_WISHES];
    uint32_t count = ff_tree_foresee(client->tree, pos_wu, wish, FF_PREFETCH_WISHES);
    for (uint32_t i = 0; i < count; i++) {
        enum ff_request_kind kind = wish[i].refinement ? FF_WANT_REFINEMENT : FF_WANT_ROOT;
        if (!ff_refusals_final(&client->refusals, kind, wish[i].key))
            ff_requests_want(&client->requests, kind, wish[i].key, FF_CLASS_PREFETCH, wish[i].priority, NULL);
    }
}

void ff_client_rank(ff_client *client, const ff_view *view, const ff_quality *quality, int64_t now_us)
{
    ff_requests_rank_begin(&client->requests);
    if (!client->all_client)
        ff_panorama_want(&client->panorama, &client->requests, &view->camera, now_us);
    want_tree(client);
    if (client->has_textures)
        want_textures(client, view, quality);
    if (!client->desc.no_prefetch && !ff_client_low_power(client))
        want_ahead(client);
    ff_requests_rank_end(&client->requests);
}
