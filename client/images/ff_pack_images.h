/* Images of packs as texels, pictures and JPEGs alike: for who draws from a pack. */
#ifndef FF_PACK_IMAGES_H
#define FF_PACK_IMAGES_H

#include "../../protocol/picture/ff_picture_path.h"

typedef struct ff_pack_images {
    uint8_t *rgb; /* scratch, of JPEGs */
    ff_picture_path path;
} ff_pack_images;

/* Memory of the owner's for images of `pack` and those joined to it; 0: there are none. */
size_t ff_pack_images_bytes(const ff_pack *pack);
void ff_pack_images_init(ff_pack_images *images, const ff_pack *pack, void *memory);
/* The image of a node, RGB565, south row first. FF_OK, or why there are no texels. */
int ff_pack_images_get(ff_pack_images *images, const ff_pack *pack, ff_key key, uint16_t *texels);

#endif
