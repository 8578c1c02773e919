/* Images of the ground, decoded. Left out with textures. */
#include "../ask/ff_intake_local.h"
#include "ff_texture_map.h"

#include <stddef.h>

int ff_intake_texture(ff_intake *intake, const ff_request *request, const uint8_t *jpeg,
                      uint32_t bytes)
{
    ff_new_item *item = ff_intake_begin(intake, request, 1, bytes);
    if (!item) return FF_ERR_AGAIN;
    unsigned side = 1u << intake->info.texture_log2;
    item->width = item->height = (uint16_t)side;
    if ((size_t)side * side * 3 > intake->rgb_bytes)
        item->error = FF_ERR_FULL;
    else
        item->error = sys_jpeg_decode(jpeg, bytes, side, side, intake->rgb);
    if (item->error == FF_OK)
        ff_texture_texels(&intake->info, intake->rgb, item->pixels);
    else
        item->pixels = NULL;
    return ff_intake_put(intake, item);
}
