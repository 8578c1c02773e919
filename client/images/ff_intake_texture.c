/* Images of the ground: JPEGs are decoded, pictures passed on. Left out with textures. */
#include "../ask/ff_intake_local.h"
#include "ff_texture_map.h"
#include "../../protocol/ff_assert.h"
#include "../../protocol/ff_image.h"

#include <stddef.h>
#include <string.h>

static int decode_jpeg(const ff_intake *intake, const ff_terrain_info *info, const ff_image *image,
                       ff_new_item *item)
{
    int rc = sys_jpeg_decode(image->coded, image->coded_bytes, item->width, item->height,
                             intake->rgb);
    if (rc == FF_OK) ff_texture_texels(info, intake->rgb, item->pixels);
    return rc;
}

static int pass_on(const ff_intake *intake, const ff_image *image, ff_new_item *item)
{
    if (image->coded_bytes > intake->news->image_bytes) return FF_ERR_FULL;
    memcpy(item->pixels, image->coded, image->coded_bytes);
    item->u.texture.coded_bytes = (uint32_t)image->coded_bytes;
    return FF_OK;
}

int ff_intake_texture(ff_intake *intake, const ff_message *answer, ff_new_item *item)
{
    if (!ff_new_data_image(intake->news, item)) return FF_ERR_AGAIN;
    const ff_terrain_info *info = &intake->info[ff_intake_ground(intake, item->key)];
    unsigned side = 1u << info->texture_log2;
    FF_ASSERT(side <= 1u << 8);
    item->width = item->height = (uint16_t)side;
    if ((size_t)side * side * 3 > intake->rgb_bytes) return FF_ERR_FULL;
    FF_ASSERT((size_t)side * side * sizeof *item->pixels <= intake->news->image_bytes);
    ff_image image;
    int rc = ff_image_read(answer->u.data.bytes, answer->u.data.byte_count, &image);
    if (rc != FF_OK) return rc;
    item->u.texture.marks = image.marks;
    if (image.marks.open == 15) return FF_OK;
    return info->flags & FF_TERRAIN_PICTURES ? pass_on(intake, &image, item)
                                             : decode_jpeg(intake, info, &image, item);
}
