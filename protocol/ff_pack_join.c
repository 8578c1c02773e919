/* Packs of several grounds that go together. */
#include "ff_pack.h"

#include <string.h>

uint32_t ff_pack_whole(const ff_pack *pack)
{
    uint32_t checksum = pack->header.info.checksum;
    ff_list about;

    return ff_pack_about(pack, &about) == FF_OK ? ff_about_whole(about, checksum) : checksum;
}

/* One pack's own: names that it does not tell are "". */
static void own_layers(const ff_pack *pack, ff_layers *layers)
{
    const uint8_t *value;
    ff_list about;
    int bytes = ff_pack_about(pack, &about);

    if (bytes == FF_OK) bytes = ff_list_find(about, FF_ABOUT_LAYERS, &value);
    if (bytes <= 0 || ff_layers_read(value, (uint32_t)bytes, 0, layers) != FF_OK)
        memset(layers, 0, sizeof *layers);
    layers->count = pack->header.layers;
}

void ff_pack_layers(const ff_pack *pack, ff_layers *layers)
{
    ff_layers own;

    memset(layers, 0, sizeof *layers);
    for (unsigned g = 0; pack && g < FF_LAYER_GROUNDS; pack = pack->next, g++) {
        own_layers(pack, &own);
        for (unsigned i = 0; i < own.count; i++) {
            if (i >= layers->count) memcpy(layers->name[i], own.name[i], sizeof own.name[i]);
            layers->levels[i][g] = (uint8_t)ff_pack_image_levels(pack, i);
        }
        layers->count = own.count > layers->count ? own.count : layers->count;
    }
}

/* 1 when layers of the same number have the same name. */
static int layers_agree(const ff_pack *pack, const ff_pack *other)
{
    ff_layers a, b;

    ff_pack_layers(pack, &a);
    own_layers(other, &b);
    for (unsigned i = 0; i < a.count && i < b.count; i++)
        if (memcmp(a.name[i], b.name[i], sizeof a.name[i]) != 0) return 0;
    return 1;
}

int ff_pack_join(ff_pack *pack, ff_pack *other)
{
    ff_pack *last = pack;
    uint32_t whole = ff_pack_whole(other), count = 1;
    int rc;

    for (ff_pack *at = pack; at; at = at->next, count++) {
        if (ff_terrain_same_ground(&at->header.info, ff_pack_whole(at), &other->header.info, whole))
            return FF_ERR_ARGUMENT;
        last = at;
    }
    if (count > FF_PACKS_JOINED_MAX) return FF_ERR_FULL;
    if (!layers_agree(pack, other)) return FF_ERR_FORMAT;
    rc = ff_terrain_join(&other->header.info, &pack->header.info, &last->header.info);
    if (rc == FF_OK) last->next = other;
    return rc;
}
