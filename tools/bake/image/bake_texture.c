#include "bake_texture.h"

#include "../../../platform/sys.h"
#include "../../../protocol/ff_image.h"
#include "../../../protocol/picture/ff_picture.h"
#include "../bake_say.h"

#include <stdlib.h>

/* Of what is coded: JPEGs have a few hundred bytes more than their coefficients. */
#define CODED_BYTES(info) (((size_t)16 << 2 * (info)->texture_log2) + 8192)

int bake_texture_room_make(bake_texture_room *room, const ff_terrain_info *info)
{
    *room = (bake_texture_room){ malloc(sizeof(ff_picture_room)),
                                 malloc(FF_IMAGE_MARKS_BYTES + CODED_BYTES(info)) };
    return room->picture && room->coded ? 0 : bake_fail("out of memory");
}

void bake_texture_room_free(bake_texture_room *room)
{
    free(room->picture);
    free(room->coded);
}

static int code_jpeg(const bake_texture_room *room, const ff_terrain_info *info, int quality,
                     const uint8_t *rgb, uint8_t *decoded)
{
    uint32_t side = 1u << info->texture_log2;
    int bytes = sys_jpeg_encode(rgb, side, side, quality, room->coded, CODED_BYTES(info));
    int rc = bytes > 0 ? sys_jpeg_decode(room->coded, (size_t)bytes, side, side, decoded) : FF_OK;
    return rc < 0 ? rc : bytes;
}

int bake_texture_code(const bake_texture_room *room, const ff_terrain_info *info, int quality,
                      bake_texture_above above, const uint8_t *rgb, uint8_t *decoded)
{
    int bytes;
    if (info->flags & FF_TERRAIN_PICTURES)
        bytes = ff_picture_encode(
            rgb, info->texture_log2, (ff_picture_above){ above.rgb, above.quadrant },
            (unsigned)quality, room->picture, decoded, room->coded, CODED_BYTES(info));
    else
        bytes = code_jpeg(room, info, quality, rgb, decoded);
    return bytes > 0 ? bytes : bake_fail("cannot encode a texture: %s", ff_error_text(bytes));
}
