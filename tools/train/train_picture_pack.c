/* The images of a pack of pictures. */
#include "../../protocol/picture/ff_picture_path.h"
#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_say.h"
#include "../info/bake_unpack.h"
#include "train_picture.h"

#include <stdlib.h>
#include <string.h>

#define RGB 3

/* From the root down: each then has its parent at hand. */
static int take(train_pictures *to, ff_picture_path *path, const ff_pack *pack, ff_key key)
{
    uint32_t level = ff_key_level(key);
    size_t bytes = (size_t)RGB << 2 * to->log2,
           at = ((size_t)ff_key_tile(key) << 2 * level) + ff_key_code(key);
    const uint8_t *rgb;
    int rc = ff_picture_path_get(path, pack, key, &rgb);
    if (rc == FF_ERR_NOT_FOUND) return 0;
    if (rc < 0) return bake_fail("%s: %s", to->path, ff_error_text(rc));
    memcpy(to->rgb[level] + at * bytes, rgb, bytes);
    to->has[level][at] = 1;
    for (uint32_t q = 0; level + 1 < to->levels && q < 4; q++)
        if (take(to, path, pack, ff_key_child(key, q))) return -1;
    return 0;
}

static int make_room(train_pictures *to)
{
    for (unsigned l = 0; l < to->levels; l++) {
        size_t nodes = (size_t)to->tiles << 2 * l;
        to->rgb[l] = malloc(nodes * RGB << 2 * to->log2);
        to->has[l] = calloc(nodes, 1);
        if (!to->rgb[l] || !to->has[l]) return bake_fail("out of memory");
    }
    return 0;
}

int train_pictures_open(train_pictures *pictures, const char *name)
{
    static ff_picture_path path;
    bake_unpack unpack;
    if (bake_unpack_open(&unpack, name)) return -1;
    const ff_terrain_info *info = &unpack.pack.header.info;
    *pictures = (train_pictures){ .path = name,
                                  .tiles = ff_shape_tiles(info),
                                  .log2 = info->texture_log2,
                                  .levels = info->texture_levels };
    path.rgb = malloc(ff_picture_path_bytes(&unpack.pack) + 1);
    path.held = 0;
    int rc = path.rgb ? make_room(pictures) : bake_fail("out of memory");
    if (!rc && !(info->flags & FF_TERRAIN_PICTURES))
        rc = bake_fail("%s has no pictures: bake it with --color", name);
    for (uint32_t tile = 0; !rc && tile < pictures->tiles; tile++)
        rc = take(pictures, &path, &unpack.pack, ff_key_make(tile, 0, 0));
    free(path.rgb);
    bake_unpack_close(&unpack);
    return rc;
}

void train_pictures_close(train_pictures *pictures)
{
    for (unsigned l = 0; l < pictures->levels; l++) {
        free(pictures->rgb[l]);
        free(pictures->has[l]);
    }
}
