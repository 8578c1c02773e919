#include "ff_pack_images.h"

#include "../../protocol/ff_image.h"
#include "../ask/ff_new_data.h"
#include "ff_texture_map.h"

#include <string.h>

#define RGB 3

/* Of the largest image. */
static size_t rgb_bytes(const ff_pack *pack)
{
    size_t most = 0;
    for (; pack; pack = pack->next) {
        const ff_terrain_info *info = &pack->header.info;
        size_t bytes = info->texture_log2 ? (size_t)RGB << 2 * info->texture_log2 : 0;
        most = bytes > most ? bytes : most;
    }
    return most;
}

size_t ff_pack_images_bytes(const ff_pack *pack)
{
    size_t path = 0;
    for (const ff_pack *at = pack; at; at = at->next) {
        size_t bytes = ff_picture_path_bytes(at);
        path = bytes > path ? bytes : path;
    }
    return path + rgb_bytes(pack);
}

void ff_pack_images_init(ff_pack_images *images, const ff_pack *pack, void *memory)
{
    memset(images, 0, sizeof *images);
    images->rgb = memory;
    images->path.rgb = images->rgb + rgb_bytes(pack);
}

static int get_jpeg(const ff_pack_images *images, const ff_pack *pack, ff_key key, uint16_t *texels)
{
    const ff_terrain_info *info = &ff_pack_of(pack, key)->header.info;
    uint32_t side = 1u << info->texture_log2;
    const uint8_t *payload;
    ff_image image;
    int rc = ff_pack_layer_record(pack, images->path.layer, key, &payload);
    if (rc >= 0) rc = ff_image_read(payload, (size_t)rc, &image);
    if (rc >= 0) rc = sys_jpeg_decode(image.coded, image.coded_bytes, side, side, images->rgb);
    if (rc >= 0) ff_texture_texels(info, images->rgb, texels);
    return rc < 0 ? rc : FF_OK;
}

int ff_pack_images_get(ff_pack_images *images, const ff_pack *pack, ff_key key, uint16_t *texels)
{
    const ff_pack *own = ff_pack_of(pack, key);
    const uint8_t *rgb;
    if (!own) return FF_ERR_NOT_FOUND;
    if (!(own->header.info.flags & FF_TERRAIN_PICTURES)) return get_jpeg(images, pack, key, texels);
    int rc = ff_picture_path_get(&images->path, pack, key, &rgb);
    if (rc == FF_OK) ff_texture_texels(&own->header.info, rgb, texels);
    return rc;
}
