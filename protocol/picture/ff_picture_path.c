#include "ff_picture_path.h"

#include "../ff_image.h"

size_t ff_picture_path_bytes(const ff_pack *pack)
{
    uint32_t most = 0;
    for (unsigned layer = 0; layer < pack->header.layers; layer++) {
        uint32_t levels = ff_pack_image_levels(pack, layer);
        most = levels > most ? levels : most;
    }
    return most ? ((size_t)most * 3) << 2 * pack->header.info.texture_log2 : 0;
}

void ff_picture_path_layer(ff_picture_path *path, unsigned layer)
{
    if (path->layer != layer) path->held = 0;
    path->layer = (uint8_t)layer;
}

static uint8_t *picture_at(const ff_picture_path *path, const ff_terrain_info *info, uint32_t level)
{
    return path->rgb + (((size_t)level * 3) << 2 * info->texture_log2);
}

static int decode(ff_picture_path *path, const ff_pack *pack, ff_key key)
{
    const ff_terrain_info *info = &ff_pack_of(pack, key)->header.info;
    uint32_t level = ff_key_level(key);
    ff_picture_above above = { level ? picture_at(path, info, level - 1) : NULL,
                               level ? ff_key_quadrant(key) : 0 };
    const uint8_t *payload;
    ff_image image;
    int rc = ff_pack_layer_record(pack, path->layer, key, &payload);
    if (rc >= 0) rc = ff_image_read(payload, (size_t)rc, &image);
    if (rc >= 0 && !image.coded_bytes) rc = FF_ERR_NOT_FOUND; /* open all over */
    if (rc >= 0)
        rc = ff_picture_decode(image.coded, image.coded_bytes, info->texture_log2, above,
                               &path->room, picture_at(path, info, level));
    return rc;
}

static ff_key above_by(ff_key key, uint32_t levels)
{
    while (levels-- > 0) key = ff_key_parent(key);
    return key;
}

int ff_picture_path_get(ff_picture_path *path, const ff_pack *pack, ff_key key, const uint8_t **rgb)
{
    uint32_t level = ff_key_level(key), at = 0;
    if (!ff_pack_of(pack, key)) return FF_ERR_NOT_FOUND;
    const ff_terrain_info *info = &ff_pack_of(pack, key)->header.info;
    if (level >= ff_pack_image_levels(ff_pack_of(pack, key), path->layer)) return FF_ERR_NOT_FOUND;
    while (at <= level && at < path->held && path->key[at] == above_by(key, level - at)) at++;
    path->held = at;
    for (; at <= level; at++) {
        path->key[at] = above_by(key, level - at);
        int rc = decode(path, pack, path->key[at]);
        if (rc != FF_OK) return rc;
        path->held = at + 1;
    }
    *rgb = picture_at(path, info, level);
    return FF_OK;
}
