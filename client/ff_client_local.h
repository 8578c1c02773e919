/* Inside of a client: for client*.c, client/balance and tests only.
 *
 * The block is shared out by ff_budget.h: some pools from ff_client_create on, the others once the
 * terrain is known (WELCOME, or the pack), given back and carved anew for another terrain. Then the
 * block is sealed. */
#ifndef FF_CLIENT_LOCAL_H
#define FF_CLIENT_LOCAL_H

#include "farfield.h"
#include "ff_arena.h"
#include "ff_budget.h"
#include "balance/ff_balance.h"
#include "ahead/ff_motion.h"
#include "ahead/ff_turn.h"
#include "panorama/ff_panorama.h"
#include "panorama/ff_panorama_auto.h"
#include "far/ff_sets.h"
#include "ff_sky.h"
#include "ff_source.h"
#include "ground/ff_terrain_view.h"
#include "images/ff_textures.h"

#define FF_TREE_WISHES     96u
#define FF_TEXTURE_WISHES  40u
#define FF_PREFETCH_WISHES 8u
#define FF_RESERVE_WISHES  16u

struct ff_client {
    ff_client_desc desc; /* defaults filled in */
    ff_arena arena;
    size_t fixed_bytes; /* of the arena: what outlives a terrain */
    sys_mutex gate;     /* held while the worker steps, and while the pools are carved */
    sys_thread thread;
    uint8_t threaded, stop; /* stop: under the gate */

    ff_source first; /* its ground's frame is the client's */
    ff_source *more; /* source_count - 1 of them */
    uint8_t source_count;
    uint8_t no_layer; /* no images are shown; else those of the layer of this name: */
    char layer[FF_LAYER_NAME_MAX + 1];
    ff_new_data news;

    uint8_t have_terrain;
    uint8_t economy;   /* what is left out for want of memory: ff_budget.economy */
    int terrain_error; /* of the terrain met last */
    ff_terrain_info info;
    ff_tree *tree;
    c3d_device *device;
    ff_terrain_view view;
    ff_textures textures;
    ff_texture_wish texture_wish[FF_TEXTURE_WISHES]; /* scratch of the ranking */
    ff_panorama panorama;
    ff_balance balance;
    uint32_t frame_cost; /* as the embedder reports it; 0: triangles are counted */
    /* by the balance: no panoramas are wanted; one still shown is a backdrop until the ground is
     * here */
    uint8_t all_client;
    /* FF_PANORAMA_AUTO: the same by its rule; what the rule was last asked, and when */
    uint8_t auto_ground;
    ff_panorama_case far_ground;
    uint8_t far_painted; /* the client's ground ends at the back plane */
    int64_t auto_us;
    ff_fins_made fins_made; /* ff_client_watch_fins */
    void *fins_context;
    ff_sets *sets;   /* in a pool of the terrain; NULL: none are used */
    int32_t fine_wu; /* ff_quality's, while sets are in use */
    uint8_t coarse;
    /* FF_FAR_AUTO: when its rule was asked last, sets paid, and they were begun or left */
    uint8_t far_asked;
    uint32_t far_turns;
    int64_t far_us, far_waiting_us, far_paid_us, far_turned_us;
    ff_sky sky;
    ff_motion motion;
    ff_turn turn;

    uint8_t has_camera, battery_low, interrupted, has_textures;
    uint8_t dirty; /* 1: the picture has to be made anew */
    /* 1: requests have to be ranked anew, because the connection was lost, or the viewer stopped */
    uint8_t unranked;
    uint8_t resting; /* the viewer stays where it is */
    unsigned show;
    ff_map_show map;
    c3d_camera camera; /* of the last update, as given but in last_view's frame */
    ff_view last_view;
    uint64_t frame_hash, geometry_hash;
    uint32_t frames_updated, frames_skipped;
};

static inline ff_source *ff_client_source(ff_client *client, unsigned number)
{
    FF_ASSERT(number < client->source_count);
    return number ? &client->more[number - 1] : &client->first;
}
/* client_source.c: the source of a number, in rooms of the block that outlive a terrain: `slots`
 * for ff_requests_bytes, and for one with a link `recv`, and `about` where that is wanted. */
typedef struct ff_source_room {
    uint8_t *slots, *recv, *about;
    uint32_t recv_bytes;
} ff_source_room;
/* How far the server is told that its ground is looked at; INT32_MAX: not told. Several sources may
 * have the same ground, and then each hands out all levels of it, so that keys mean the same. */
int32_t ff_client_reach_wu(const ff_client *client);
void ff_source_make(ff_client *client, unsigned number, const ff_source_room *room);
/* Tells a source's worker its share of the balance's budget of bytes: as much as any other link. */
void ff_client_allow(const ff_client *client, ff_source *source);
int ff_client_step_source(ff_client *client, ff_source *source, int64_t now_us);
/* Who it is, as the embedder says. */
static inline ff_source_desc ff_client_source_desc(const ff_client *client, unsigned number)
{
    return number ? client->desc.more[number - 1]
                  : (ff_source_desc){ client->desc.pack, client->desc.stream };
}
/* What is counted of all requests, together. */
void ff_client_counts(ff_client *client, ff_request_counts *counts);
/* What all links are doing together, zero without any: bytes and rates are sums, the round trip is
 * the longest, one that is up stands for all; else state and refusal are the first one's. */
void ff_client_link(ff_client *client, ff_stream_shared *shared);
/* 1 when something of class `last` or one before it waits at any source. */
int ff_client_waiting(ff_client *client, enum ff_request_class last);
/* The grounds of a source, as its pack or its server's WELCOME says: it does not serve them yet. */
void ff_client_take_pack(const ff_client *client, ff_source *source);
void ff_client_take_welcome(const ff_client *client, ff_source *source);
/* client_layers.c: levels of the layer that is shown, over a ground of those whose layers these
 * are; 0: it has none. */
uint8_t ff_client_layer_levels(const ff_client *client, const ff_layers *layers, unsigned ground);
/* The layer that is shown of a source whose grounds have just been told. */
void ff_client_choose_layer(const ff_client *client, ff_source *source);
/* Has the images held go by the layers chosen; once pools are carved, and whenever they change. */
void ff_client_tag_layer(ff_client *client);
/* client.c: gives up the terrain, shares the block out anew and has the server tell of its ground
 * again. */
void ff_client_start_over(ff_client *client);
/* client_update.c: what a link has met since the last update. */
void ff_client_note_link(ff_client *client, ff_source *source, const ff_stream_shared *shared);
/* several/: of the sources that serve a key's ground and may have it the one to be asked, or NULL.
 * `lacks`: ff_wish.lacks. */
ff_source *ff_client_route(ff_client *client, enum ff_kind kind, ff_key key, unsigned lacks);

/* client.c: the defaults of all that is zero. */
void ff_client_default_desc(ff_client_desc *desc);
/* client_carve.c: a pool of the block, NULL when the budget has none. */
void *ff_client_take(ff_arena *arena, const ff_budget *budget, enum ff_pool_id pool);
/* Pools for client->info; under the gate (or before the worker runs). FF_OK,
 * FF_ERR_MEMORY, FF_ERR_UNSUPPORTED. */
int ff_client_carve(ff_client *client);
void ff_client_uncarve(ff_client *client);
/* Gives a source the worker's decoder and scratch. */
void ff_client_decode(ff_client *client, ff_source *source);
/* From now on the source is asked. */
void ff_client_serve(ff_client *client, ff_source *source);
/* What draws the sky until a terrain is known, where the block has room for it; under the gate (or
 * before the worker runs), nothing being carved. ff_client_uncarve gives it back. */
void ff_client_carve_sky(ff_client *client);
/* client_take.c: takes in all new data and returns the number of items. *changed is set when the
 * picture changed and the tree does not tell of it. */
unsigned ff_client_take_new_data(ff_client *client, int64_t now_us, int *changed);
/* Takes one kind's new data into what the client holds, and refusals too when the key is the
 * client's own. 1 when the picture may have changed and the tree does not tell of it. */
#define X(kind, name, ...) \
    int ff_client_take_##name(ff_client *client, ff_new_item *item, int64_t now_us);
FF_KIND_LIST(X)
#undef X
/* client_view.c: where several levels are missing in view, one request for all that a source is to
 * be asked of them. */
void ff_client_want_view(ff_client *client, ff_source *source, const ff_view *view,
                         const ff_quality *quality);
/* The same while no terrain is known, for who knows where it is. */
void ff_client_greet_view(ff_client *client, const c3d_camera *camera);
/* client_rank.c: fills the request queue anew with what tree, images, panorama and prediction want.
 * 1 when the picture has changed: an image that was held is drawn now. */
int ff_client_rank(ff_client *client, const ff_view *view, const ff_quality *quality,
                   int64_t now_us);
/* client_balance.c. begin: for a terrain just met, or after settings changed; `fresh` forgets the
 * levels. step: once an update, while there is a terrain. quality: puts the balance's detail into a
 * quality. */
void ff_client_balance_begin(ff_client *client, int fresh);
void ff_client_balance_step(ff_client *client, const c3d_camera *camera, int64_t now_us);
void ff_client_balance_quality(const ff_client *client, ff_quality *quality);
void ff_client_balance_stats(const ff_client *client, ff_balance_stats *stats);
/* client_update.c: what is in force, as set, by the balance, or coarser while power is low. */
ff_quality ff_client_quality(const ff_client *client);
/* panorama/client_auto.c. begin: panoramas were set, or pools carved for them. step: once an
 * update, while there is a terrain. */
void ff_client_auto_begin(ff_client *client);
void ff_client_auto_step(ff_client *client, const c3d_camera *camera, int64_t now_us);
/* far/client_far.c: asks the rule of FF_FAR_AUTO now and then; once an update, while there are
 * sets. */
void ff_client_far_step(ff_client *client, const c3d_camera *camera, int32_t clearance_wu,
                        int64_t now_us);
/* 1 while no panoramas are wanted and the client draws far ground itself. */
static inline int ff_client_own_ground(const ff_client *client)
{
    return !client->panorama.desc.enabled || !client->panorama.face_size || client->all_client ||
           client->auto_ground;
}
static inline int ff_client_low_power(const ff_client *client)
{
    return client->battery_low || client->interrupted;
}

#endif
