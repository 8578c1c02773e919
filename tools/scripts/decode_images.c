/* decode_images PACK: decodes all images of a pack as a client does, for bench_pictures.py:
 * cross-built for the handheld, counted by tcg_count.c. What is decoding lies in the phase "work".
 * Prints how many texels were made and their sum: the same on every machine. */
#include "../../platform/sys.h"
#include "../../protocol/ff_image.h"
#include "../../protocol/picture/ff_picture.h"
#include "counted_pack.h"

static ff_picture_room room;
static unsigned long long texels, sum, bytes_read;

static void decode(const ff_image *image, ff_key key, const uint8_t *parent, uint8_t *rgb)
{
    const ff_terrain_info *info = &pack.header.info;
    uint32_t side = 1u << info->texture_log2;
    ff_picture_above above = { parent, parent ? ff_key_quadrant(key) : 0 };
    handheld_mark_work();
    int rc = info->flags & FF_TERRAIN_PICTURES
                 ? ff_picture_decode(image->coded, image->coded_bytes, info->texture_log2, above,
                                     &room, rgb)
                 : sys_jpeg_decode(image->coded, image->coded_bytes, side, side, rgb);
    handheld_mark_outside();
    if (rc < 0) fail("an image is broken");
    for (uint32_t i = 0; i < side * side * 3; i++) sum += rgb[i];
    texels += side * side;
}

static void below(ff_key key, const uint8_t *parent)
{
    const uint8_t *payload;
    ff_image image;
    int bytes = ff_pack_record(&pack, FF_SECTION_TEXTURE, key, &payload);
    if (bytes == FF_ERR_NOT_FOUND) return;
    if (bytes < 0 || ff_image_read(payload, (size_t)bytes, &image) < 0) fail("a record is broken");
    if (!image.coded_bytes) return; /* open all over */
    uint8_t *own = malloc((size_t)3 << 2 * pack.header.info.texture_log2);
    if (!own) fail("out of memory");
    bytes_read += image.coded_bytes;
    decode(&image, key, parent, own);
    for (uint32_t q = 0; ff_key_level(key) + 1 < pack.header.info.texture_levels && q < 4; q++)
        below(ff_key_child(key, q), own);
    free(own);
}

int main(int argc, char **argv)
{
    open_pack(argc, argv);
    handheld_mark_start();
    for (uint32_t i = 0; i < pack.tiles; i++) below(ff_key_make(i, 0, 0), NULL);
    printf("texels %llu\nbytes %llu\nsum %llu\n", texels, bytes_read, sum);
    return 0;
}
