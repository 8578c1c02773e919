/* Which layer of images is shown, of each source's: chosen by name, asked for by number. */
#include "ff_client_local.h"
#include "../protocol/ff_assert.h"

#include <string.h>

static uint8_t number_of(const ff_client *client, const ff_layers *layers)
{
    int number = client->no_layer ? FF_ERR_NOT_FOUND : ff_layers_find(layers, client->layer);
    return number < 0 ? FF_LAYER_NONE : (uint8_t)number;
}

uint8_t ff_client_layer_levels(const ff_client *client, const ff_layers *layers, unsigned ground)
{
    uint8_t number = number_of(client, layers);
    FF_ASSERT(ground < FF_LAYER_GROUNDS);
    return number == FF_LAYER_NONE ? 0 : layers->levels[number][ground];
}

void ff_client_choose_layer(const ff_client *client, ff_source *source)
{
    source->layer = number_of(client, &source->layers);
    ff_requests_set_layer(&source->requests, source->layer);
}

/* What images are held by: the same for the same name, whatever was shown in between. */
void ff_client_tag_layer(ff_client *client)
{
    uint8_t tag = FF_LAYER_TAG_NONE;
    for (unsigned s = client->source_count; s-- > 0;) {
        const ff_source *source = ff_client_source(client, s);
        if (source->layer != FF_LAYER_NONE) tag = (uint8_t)(s * FF_LAYERS_MAX + source->layer);
    }
    ff_textures_set_layer(&client->textures, tag);
}
FF_STATIC_ASSERT(FF_SOURCES_MAX *FF_LAYERS_MAX <= FF_LAYER_TAG_NONE);

static int some_has(ff_client *client, const char *name)
{
    for (unsigned s = 0; s < client->source_count; s++)
        if (ff_layers_find(&ff_client_source(client, s)->layers, name) >= 0) return 1;
    return 0;
}

/* Far pictures are drawn in the layer's colours, too. */
static void redraw_far(ff_client *client)
{
    ff_requests *requests = &client->first.requests;
    ff_requests_cancel_all(requests, FF_KIND_FACE);
    ff_panorama_drop(&client->panorama);
    if (client->sets) ff_sets_set(client->sets, requests, &client->desc.far);
    client->far_asked = 0;
}

static void show(ff_client *client)
{
    const uint8_t far = client->first.layer;
    for (unsigned s = 0; s < client->source_count; s++) {
        ff_source *source = ff_client_source(client, s);
        ff_client_choose_layer(client, source);
        memset(&source->refusals, 0, sizeof source->refusals);
        for (unsigned i = 0; source->serves && i < source->intake.ground_count; i++)
            ff_tree_show_images(client->tree, source->ground[i].number, &source->intake.info[i],
                                ff_client_layer_levels(client, &source->layers, i));
    }
    uint32_t count;
    const ff_terrain_info *shown = ff_tree_grounds(client->tree, &count);
    ff_terrain_show_images(&client->info, shown, shown->texture_levels);
    ff_client_tag_layer(client);
    if (client->first.layer != far) redraw_far(client);
}

int ff_client_set_layer(ff_client *client, const char *name)
{
    if (name && !ff_layer_name_ok(name)) return FF_ERR_ARGUMENT;
    if (name && client->have_terrain && !some_has(client, name)) return FF_ERR_NOT_FOUND;
    client->no_layer = !name;
    if (name) memcpy(client->layer, name, strlen(name) + 1);
    client->dirty = client->unranked = 1;
    if (!client->have_terrain) return FF_OK;
    show(client);
    if (client->info.texture_levels && !client->has_textures && !client->desc.no_textures &&
        !client->economy)
        ff_client_start_over(client); /* the block was shared out without images */
    return FF_OK;
}

int ff_client_layer(const ff_client *client)
{
    if (!client->have_terrain) return FF_ERR_AGAIN;
    return client->first.layer == FF_LAYER_NONE ? FF_ERR_NOT_FOUND : client->first.layer;
}

const char *ff_client_layer_name(const ff_client *client, unsigned number)
{
    return number < client->first.layers.count ? client->first.layers.name[number] : NULL;
}
