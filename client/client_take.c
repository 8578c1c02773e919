/* New data into what the client holds, kind by kind, and how the requests for it end. */
#include "several/ff_several.h"
#include "../protocol/ff_assert.h"

/* Heights. A codec may find only here, with the parent's heights, that a payload is bad: the item
 * then has that error, as if the worker had found it. The tree tells itself whether the picture
 * changed. */
static int heights_taken(ff_new_item *item, int rc)
{
    FF_ASSERT(rc <= FF_OK && rc >= FF_ERR_LAST);
    if (rc != FF_OK && rc != FF_ERR_FULL && rc != FF_ERR_NOT_FOUND) item->error = rc;
    return 0;
}

int ff_client_take_root(ff_client *client, ff_new_item *item, int64_t now_us)
{
    (void)now_us;
    FF_ASSERT(ff_key_level(item->key) == 0);
    uint32_t tile = ff_key_tile(item->key);
    return heights_taken(
        item, ff_tree_deliver_root(client->tree, tile, item->source, &item->u.residuals));
}

int ff_client_take_refinement(ff_client *client, ff_new_item *item, int64_t now_us)
{
    (void)now_us;
    FF_ASSERT(ff_key_level(item->key) + 1 <
              ff_terrain_levels(ff_tree_ground(client->tree, item->key)));
    return heights_taken(
        item, ff_tree_deliver_children(client->tree, item->key, item->source, &item->u.residuals));
}

int ff_client_take_texture(ff_client *client, ff_new_item *item, int64_t now_us)
{
    (void)now_us;
    FF_ASSERT(ff_key_level(item->key) < ff_tree_ground(client->tree, item->key)->texture_levels);
    if (ff_several_shares(client, item->key))
        item->u.texture.marks.bare = 0; /* others may have them */
    FF_ASSERT(item->width == 1u << client->info.texture_log2 && item->height == item->width);
    return ff_textures_take(&client->textures, ff_tree_ground(client->tree, item->key), item);
}

int ff_client_take_face(ff_client *client, ff_new_item *item, int64_t now_us)
{
    FF_ASSERT(item->u.face.face < FF_FACE_COUNT);
    FF_ASSERT(item->u.face.row_count <= item->height);
    return ff_panorama_take(&client->panorama, item, now_us);
}

int ff_client_take_far(ff_client *client, ff_new_item *item, int64_t now_us)
{
    FF_ASSERT(item->u.far.sector < FF_FAR_SECTORS);
    return client->sets ? ff_sets_take(client->sets, item, now_us) : 0;
}

static int take(ff_client *client, ff_new_item *item, int64_t now_us)
{
    switch ((enum ff_kind)item->kind) {
#define X(kind, name, ...) \
    case FF_KIND_##kind: return ff_client_take_##name(client, item, now_us);
        FF_KIND_LIST(X)
#undef X
        case FF_KIND_COUNT: break;
    }
    return 0;
}

/* A node's key comes up again: its refusals are remembered here. A key of the client's own does
 * not: whoever made it is told of refusals like of answers. */
static int take_item(ff_client *client, ff_new_item *item, int64_t now_us)
{
    FF_ASSERT(item->kind < FF_KIND_COUNT && item->error <= FF_OK);
    ff_source *source = ff_client_source(client, item->source);
    int changed = 0, of_node = ff_kind[item->kind].asks == FF_ASKS_NODE;
    const ff_key own = item->key;
    if (item->kind == FF_KIND_TEXTURE && item->layer != source->layer) {
        item->error = FF_ERR_CLOSED; /* of a layer that is shown no more */
        return 0;
    }
    if (of_node) item->key = ff_source_key(source, own);
    if (item->error == FF_OK || !of_node) changed = take(client, item, now_us);
    int lacks = item->error == FF_ERR_NOT_FOUND && client->source_count > 1;
    if (item->error != FF_OK && of_node)
        ff_refusals_note(&source->refusals, item->kind, own, lacks);
    if (lacks && item->kind == FF_KIND_REFINEMENT)
        ff_tree_lacks(client->tree, item->key, item->source);
    return changed;
}

/* How the request of this last item ends. A face that came and cannot be decoded ends it like any
 * other: it is one of several, and its set counts it as missing. */
static enum ff_request_state final_state(const ff_new_item *item)
{
    FF_ASSERT(item->last && item->error <= FF_OK);
    if (item->error == FF_OK) return FF_REQUEST_DONE;
    if (item->error == FF_ERR_CLOSED) return FF_REQUEST_CANCELLED;
    int brings = ff_kind[item->kind].brings,
        face_came = (brings == FF_BRINGS_FACE || brings == FF_BRINGS_FAR) && !item->refused;
    return face_came ? FF_REQUEST_DONE : FF_REQUEST_FAILED;
}

unsigned ff_client_take_new_data(ff_client *client, int64_t now_us, int *changed)
{
    unsigned taken = 0;
    ff_new_item *item;
    while (taken < client->news.item_slots && (item = ff_new_data_first(&client->news)) != NULL) {
        *changed |= take_item(client, item, now_us);
        if (item->last)
            ff_requests_finish(&ff_client_source(client, item->source)->requests, item->id,
                               final_state(item));
        ff_new_data_release(&client->news);
        taken++;
    }
    return taken;
}
