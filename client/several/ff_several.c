#include "ff_several.h"
#include "../../protocol/ff_assert.h"

/* ---- which grounds there are ---- */

/* A ground that another source serves already, whole or in part, is the same one. */
static int find_ground(ff_client *client, const ff_source *source, unsigned own,
                       ff_source_ground *found)
{
    const uint32_t whole = source->ground[own].whole;
    for (unsigned s = 0; s < client->source_count; s++) {
        const ff_source *other = ff_client_source(client, s);
        for (unsigned i = 0; other->serves && i < other->intake.ground_count; i++) {
            if (!ff_terrain_same_ground(&other->intake.info[i], other->ground[i].whole,
                                        &source->intake.info[own], whole))
                continue;
            *found = other->ground[i];
            return 1;
        }
    }
    return 0;
}

static int add_ground(ff_client *client, ff_source *source, unsigned own)
{
    ff_source_ground *ground = &source->ground[own];
    ff_terrain_info info = source->intake.info[own];
    FF_ASSERT(own < source->intake.ground_count);
    ff_terrain_show_images(&info, &source->intake.info[own],
                           ff_client_layer_levels(client, &source->layers, own));
    uint32_t count;
    const ff_terrain_info *all = ff_tree_grounds(client->tree, &count);
    int rc = ff_codec_supported(info.codec) ? ff_terrain_join(&info, all, all + count - 1)
                                            : FF_ERR_UNSUPPORTED;
    if (rc == FF_OK) rc = ff_tree_add_ground(client->tree, &info);
    if (rc < 0) return rc;
    ground->number = (uint8_t)rc;
    ground->first_tile = info.first_tile;
    ground->south_west_wu[0] = info.west_wu;
    ground->south_west_wu[1] = info.south_wu;
    return FF_OK;
}

/* Those that serve a ground, a bit each. */
static uint8_t sources_of(ff_client *client, unsigned number)
{
    unsigned mask = 0;
    for (unsigned s = 0; s < client->source_count; s++) {
        const ff_source *source = ff_client_source(client, s);
        for (unsigned i = 0; source->serves && i < source->intake.ground_count; i++)
            if (source->ground[i].number == number) mask |= 1u << s;
    }
    return (uint8_t)mask;
}

static void tell_sources(ff_client *client)
{
    uint32_t count;
    (void)ff_tree_grounds(client->tree, &count);
    for (unsigned i = 0; i < count; i++)
        ff_tree_set_sources(client->tree, i, sources_of(client, i));
}

/* Has the grounds of a source, from `own` on, join the tree's. FF_OK, or why the first of them does
 * not fit: the source serves those before it, if any. */
static int join(ff_client *client, ff_source *source, unsigned own)
{
    int rc = FF_OK;
    ff_client_decode(client, source);
    source->intake.ground_count = source->intake.told_count;
    for (unsigned i = own; rc == FF_OK && i < source->intake.ground_count; i++) {
        if (!find_ground(client, source, i, &source->ground[i])) rc = add_ground(client, source, i);
        if (rc != FF_OK) source->intake.ground_count = (uint8_t)i;
    }
    if (source->intake.ground_count) ff_client_serve(client, source);
    source->error = (int8_t)rc;
    return source->intake.ground_count ? FF_OK : rc;
}

/* The number of a pack that is a part of another one, 0: there is none. Its whole is most likely
 * what the first source has, and what it tells of the terrain is the same. */
static unsigned stand_in(const ff_client *client)
{
    for (unsigned i = 0; client->desc.stream && i < client->desc.more_count; i++) {
        const ff_pack *pack = client->desc.more[i].pack;
        if (pack && ff_pack_whole(pack) != pack->header.info.checksum) return 1 + i;
    }
    return 0;
}

const ff_pack *ff_several_stand_in(const ff_client *client)
{
    unsigned number = stand_in(client);
    return number ? client->desc.more[number - 1].pack : NULL;
}

/* Whose first ground the tree was made for. */
static unsigned framing(const ff_client *client)
{
    return client->first.intake.told_count ? 0 : stand_in(client);
}

void ff_several_join(ff_client *client)
{
    uint32_t count;
    const unsigned frame = framing(client);
    ff_source *first = ff_client_source(client, frame);
    (void)ff_tree_grounds(client->tree, &count);
    FF_ASSERT(count == 1);
    if (first->pack) ff_client_take_pack(client, first);
    first->ground[0] = (ff_source_ground){ .whole = first->ground[0].whole };
    (void)join(client, first, 1);
    for (unsigned s = 1; s < client->source_count; s++) {
        ff_source *source = ff_client_source(client, s);
        if (s == frame) continue;
        if (source->pack) ff_client_take_pack(client, source);
        if (source->pack || source->stream.has_terrain) (void)join(client, source, 0);
    }
    ff_client_tag_layer(client);
    tell_sources(client);
}

static void joined(ff_client *client)
{
    tell_sources(client);
    ff_client_tag_layer(client);
    ff_textures_doubt(&client->textures);
    client->dirty = 1;
}

int ff_several_keep(ff_client *client)
{
    ff_source *first = &client->first;
    unsigned drawn = stand_in(client);
    if (!client->have_terrain || !drawn || first->serves || first->intake.told_count != 1 ||
        !find_ground(client, first, 0, &first->ground[0]) || first->ground[0].number != 0)
        return 0;
    (void)join(client, first, 0); /* it finds the ground again */
    ff_tree_set_checksum(client->tree, 0, first->intake.info[0].checksum);
    joined(client);
    return 1;
}

/* Under the gate: a server has told its grounds, and waits for what is said to it. */
static void settle(ff_client *client, ff_source *source)
{
    int again = source->serves;
    ff_client_take_welcome(client, source);
    if (again) { /* it has other packs now: all grounds are put together anew */
        source->stream.has_terrain = 0;
        ff_client_uncarve(client);
        client->terrain_error = ff_client_carve(client);
        if (client->terrain_error != FF_OK) ff_client_carve_sky(client);
    }
    int rc = client->have_terrain ? join(client, source, 0) : FF_ERR_MEMORY;
    if (rc == FF_OK) joined(client);
    client->dirty = 1;
    ff_stream_accept(&source->stream, rc == FF_OK);
}

void ff_several_look(ff_client *client)
{
    for (unsigned s = 1; s < client->source_count; s++) {
        ff_source *source = ff_client_source(client, s);
        ff_stream_shared shared;
        if (!source->io) continue;
        ff_stream_get_shared(&source->stream, &shared);
        if (shared.state == FF_STREAM_WELCOMED && client->have_terrain) {
            sys_mutex_lock(&client->gate);
            settle(client, source);
            sys_mutex_unlock(&client->gate);
        }
        ff_client_note_link(client, source, &shared);
    }
}

/* ---- who is asked ---- */

/* Levels of images that a source has over a ground, of the layer that is shown. */
static uint32_t image_levels(const ff_source *source, int own)
{
    FF_ASSERT(own >= 0 && own < FF_LAYER_GROUNDS);
    return source->layer == FF_LAYER_NONE ? 0 : source->layers.levels[source->layer][own];
}

static int may_have(const ff_client *client, const ff_source *source, enum ff_kind kind, ff_key key,
                    unsigned lacks)
{
    int own = ff_source_ground_of(source, key);
    if (own < 0 || lacks >> source->number & 1u) return 0;
    const ff_terrain_info *info = &source->intake.info[own];
    if (kind == FF_KIND_TEXTURE && (info->texture_log2 != client->info.texture_log2 ||
                                    (info->flags ^ client->info.flags) & FF_TERRAIN_PICTURES ||
                                    ff_key_level(key) >= image_levels(source, own)))
        return 0;
    return !ff_refusals_final(&source->refusals, kind, ff_source_own_key(source, key));
}

/* Packs on this device cost nothing, a lost link brings nothing; else the one named first. */
static int goes_before(const ff_source *a, const ff_source *b)
{
    if ((a->pack != NULL) != (b->pack != NULL)) return a->pack != NULL;
    return b->down && !a->down;
}

ff_source *ff_client_route(ff_client *client, enum ff_kind kind, ff_key key, unsigned lacks)
{
    ff_source *best = NULL;
    for (unsigned s = 0; s < client->source_count; s++) {
        ff_source *source = ff_client_source(client, s);
        if (!may_have(client, source, kind, key, lacks)) continue;
        if (client->source_count > 1 &&
            ff_requests_out(&source->requests, kind, ff_source_own_key(source, key)))
            return source; /* it is on its way */
        if (!best || goes_before(source, best)) best = source;
    }
    return best;
}

int ff_several_shares(ff_client *client, ff_key key)
{
    unsigned serve = 0;
    FF_ASSERT(client->source_count >= 1);
    for (unsigned s = 0; s < client->source_count; s++)
        serve += ff_source_ground_of(ff_client_source(client, s), key) >= 0;
    return serve > 1;
}
