/* What to ask for next, most urgent first:
 *   FIRST        roots in view, panorama faces in view, and all of a view's ground at once where
 *                several levels of it are missing (client_view.c)
 *   IN_VIEW      refinements and images in view: pixels of error removed for each byte expected
 *   PREFETCH     ground and panorama faces that a viewer who goes on as it flies and turns will
 *                see; leaves only while the link has room and nothing else waits
 *   RESERVE      coarse ground in every direction, for a viewer who turns at once or while the link
 *                is silent (ff_tree_reserve), the other sectors of the far set that is drawn, and
 *                the panorama's other faces for one who stays: leaves only while the link is idle
 * Nothing else is ever asked for: most of it would never be drawn. The queue's contents are
 * replaced each time; what is no longer wanted is dropped. */
#include "ff_client_local.h"
#include "panorama/ff_panorama_rules.h"
#include "../protocol/ff_assert.h"

#include <string.h>

/* How far ahead the client asks: a fixed time, and a number of round trips on top. On a straight
 * way the ground that comes into view lies next to what is held, and one answer brings it. A turn
 * shows ground of which nothing is held: each of its levels takes a round trip, so a turn is
 * foreseen longer. */
#define AHEAD_US          3000000
#define AHEAD_ROUND_TRIPS 2
#define TURN_US           5000000
#define TURN_ROUND_TRIPS  6

/* The roots of the reserve go before all its refinements: empty ground is worse than coarse. */
#define RESERVE_ROOT 0x8000000u

/* what is in view finds room in the queue: ground, images, and the faces of the set that comes */
FF_STATIC_ASSERT(FF_TREE_WISHES + FF_TEXTURE_WISHES + 1 <= FF_REQUESTS_QUEUED_MAX);

/* Of whoever is to be asked, if anybody is. */
static void want(ff_client *client, const ff_wish *wish, enum ff_request_class rank,
                 uint32_t priority)
{
    enum ff_kind kind = (enum ff_kind)wish->kind;
    ff_source *source = ff_client_route(client, kind, wish->key, wish->lacks);
    unsigned sides = kind == FF_KIND_REFINEMENT && source && source->io
                         ? ff_tree_sides(client->tree, wish->key)
                         : 0;
    if (source)
        ff_requests_want(&source->requests, kind, ff_source_own_key(source, wish->key), rank,
                         priority, sides, NULL);
}

static void want_tree(ff_client *client)
{
    const ff_wish *list;
    uint32_t count = ff_tree_wishes(client->tree, &list);
    FF_ASSERT(count <= FF_TREE_WISHES);
    for (uint32_t i = 0; i < count; i++) {
        const ff_wish *wish = &list[i];
        int root = wish->kind == FF_KIND_ROOT;
        /* a root is wished for at level 0, children below a node that is not of the last level */
        FF_ASSERT(root ? ff_key_level(wish->key) == 0
                       : ff_key_level(wish->key) + 1 <
                             ff_terrain_levels(ff_tree_ground(client->tree, wish->key)));
        if (wish->in_view)
            want(client, wish, root ? FF_CLASS_FIRST : FF_CLASS_IN_VIEW, wish->priority);
    }
}

static void want_textures(ff_client *client, const ff_view *view, const ff_quality *quality,
                          int *changed)
{
    ff_texture_wish *wish = client->texture_wish;
    const ff_drawn *drawn;
    uint32_t drawn_count = ff_tree_drawn(client->tree, &drawn);
    uint32_t count = ff_textures_wishes(&client->textures, client->tree, drawn, drawn_count, view,
                                        quality, wish, FF_TEXTURE_WISHES, changed);
    FF_ASSERT(count <= FF_TEXTURE_WISHES);
    for (uint32_t i = 0; i < count; i++) {
        const ff_wish image = { .key = wish[i].key, .kind = FF_KIND_TEXTURE };
        want(client, &image, FF_CLASS_IN_VIEW, wish[i].priority);
    }
}

/* Where the viewer will be and look while an answer is on its way, and some seconds more: several
 * views when the viewer turns far. */
typedef struct ahead {
    unsigned views;
    int turns; /* 1: the viewer turns */
    int32_t pos_wu[FF_TURN_VIEWS_MAX][3], yaw[FF_TURN_VIEWS_MAX], pitch[FF_TURN_VIEWS_MAX];
} ahead;

static void look_ahead(const ff_client *client, const ff_view *view, int64_t rtt_us, ahead *a)
{
    int32_t yaw, pitch;
    unsigned turns = ff_turn_predict(&client->turn, TURN_US + TURN_ROUND_TRIPS * rtt_us, &yaw,
                                     &pitch),
             views = turns ? turns : 1, i;
    FF_ASSERT(rtt_us >= 0 && rtt_us <= INT32_MAX && views <= FF_TURN_VIEWS_MAX);
    FF_ASSERT(yaw >= -(1 << 15) && yaw <= 1 << 15 && pitch >= -(1 << 14) && pitch <= 1 << 14);
    int64_t ahead_us = turns ? TURN_US + TURN_ROUND_TRIPS * rtt_us
                             : AHEAD_US + AHEAD_ROUND_TRIPS * rtt_us;
    a->views = 0;
    a->turns = turns > 0;
    for (i = 0; i < views; i++) {
        int64_t at_us = ahead_us * (i + 1) / views;
        memcpy(a->pos_wu[i], view->camera.pos_wu, sizeof a->pos_wu[i]);
        if (!ff_motion_predict(&client->motion, at_us, a->pos_wu[i]) && !turns) return;
        a->yaw[i] = yaw * (int32_t)(i + 1) / (int32_t)views;
        a->pitch[i] = pitch * (int32_t)(i + 1) / (int32_t)views;
    }
    a->views = views;
}

static void want_ahead(ff_client *client, const ahead *a)
{
    ff_wish wish[FF_PREFETCH_WISHES];
    for (unsigned v = 0; v < a->views; v++) {
        uint32_t count = ff_tree_foresee(client->tree, a->pos_wu[v], a->yaw[v], a->pitch[v], wish,
                                         FF_PREFETCH_WISHES);
        FF_ASSERT(count <= FF_PREFETCH_WISHES);
        for (uint32_t i = 0; i < count; i++)
            want(client, &wish[i], FF_CLASS_PREFETCH, wish[i].priority);
    }
}

/* After all else: while something of another class waits, the reserve would not leave. */
static void want_reserve(ff_client *client, const ff_view *view, int64_t now_us)
{
    ff_wish wish[FF_RESERVE_WISHES];
    if (client->desc.no_reserve || ff_client_low_power(client) ||
        ff_client_waiting(client, FF_CLASS_PREFETCH))
        return;
    uint32_t count = ff_tree_reserve(client->tree, wish, FF_RESERVE_WISHES);
    FF_ASSERT(count <= FF_RESERVE_WISHES);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t priority = wish[i].priority < RESERVE_ROOT ? wish[i].priority : RESERVE_ROOT - 1;
        if (wish[i].kind == FF_KIND_ROOT) priority += RESERVE_ROOT;
        want(client, &wish[i], FF_CLASS_RESERVE, priority);
    }
    if (client->resting && !ff_client_own_ground(client))
        ff_panorama_want_reserve(&client->panorama, &client->first.requests, view, now_us);
    if (client->sets)
        ff_sets_want_reserve(client->sets, &client->first.requests, view, &client->motion, now_us);
}

/* Bits of the faces that the views ahead show. */
static unsigned faces_ahead(const ff_view *view, const ahead *a)
{
    unsigned faces = 0;
    for (unsigned v = 0; v < a->views; v++) {
        c3d_camera camera = view->camera;
        camera.yaw = (camera.yaw + a->yaw[v]) & 0xFFFF;
        camera.pitch = (camera.pitch + a->pitch[v]) & 0xFFFF;
        faces |= ff_panorama_faces_in_view(&camera);
    }
    FF_ASSERT(faces < 1u << FF_FACE_COUNT);
    return faces;
}

/* Bits of the sectors that the views ahead show. */
static unsigned sectors_ahead(const ff_view *view, const ahead *a)
{
    unsigned sectors = 0;
    for (unsigned v = 0; v < a->views; v++) {
        c3d_camera camera = view->camera;
        camera.yaw = (camera.yaw + a->yaw[v]) & 0xFFFF;
        camera.pitch = (int16_t)((camera.pitch + a->pitch[v]) & 0xFFFF);
        sectors |= ff_sets_in_view(&camera);
    }
    return sectors;
}

int ff_client_rank(ff_client *client, const ff_view *view, const ff_quality *quality,
                   int64_t now_us)
{
    int changed = 0;
    ff_stream_shared shared;
    ahead a = { .views = 0, .turns = 0 };
    ff_client_link(client, &shared);
    if (!client->desc.no_prefetch && !ff_client_low_power(client))
        look_ahead(client, view, shared.rtt_us, &a);
    for (unsigned i = 0; i < client->source_count; i++) {
        ff_source *source = ff_client_source(client, i);
        if (source->io) ff_stream_hurry(&source->stream, a.turns);
        ff_requests_rank_begin(&source->requests);
    }
    if (!ff_client_own_ground(client))
        ff_panorama_want(&client->panorama, &client->first.requests, view, faces_ahead(view, &a),
                         now_us);
    if (client->sets)
        ff_sets_want(client->sets, &client->first.requests, view, sectors_ahead(view, &a), now_us);
    for (unsigned i = 0; i < client->source_count; i++)
        ff_client_want_view(client, ff_client_source(client, i), view, quality);
    want_tree(client);
    if (client->has_textures) want_textures(client, view, quality, &changed);
    want_ahead(client, &a);
    want_reserve(client, view, now_us);
    for (unsigned i = 0; i < client->source_count; i++)
        ff_requests_rank_end(&ff_client_source(client, i)->requests);
    return changed;
}
