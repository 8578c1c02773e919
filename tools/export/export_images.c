/* The textures of a level, put together. */
#include "../../platform/sys.h"
#include "../../protocol/ff_image.h"
#include "../../protocol/picture/ff_picture_path.h"
#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_enlarge.h"
#include "../bake/bake_say.h"
#include "export_ground_local.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RGB 3

typedef struct image_reader {
    export_ground *ground;
    uint8_t *jpeg, *enlarged; /* of a texture, top row first */
    const uint8_t *rgb;
    uint64_t missing;
    ff_picture_path path;
} image_reader;

/* reader->rgb, of the image of a node that has one, whose payload is at hand. FF_OK or an error. */
static int decode_texture(image_reader *reader, ff_key key, const uint8_t *payload, size_t bytes)
{
    const ff_pack *pack = &reader->ground->unpack->pack;
    uint32_t side = 1u << pack->header.info.texture_log2;
    ff_image image;
    if (pack->header.info.flags & FF_TERRAIN_PICTURES)
        return ff_picture_path_get(&reader->path, pack, key, &reader->rgb);
    reader->rgb = reader->jpeg;
    int rc = ff_image_read(payload, bytes, &image);
    return rc < 0 ? rc : sys_jpeg_decode(image.coded, image.coded_bytes, side, side, reader->jpeg);
}

/* The image of the nearest ancestor stands for one that is not stored. */
static int read_texture(image_reader *reader, ff_key key, uint32_t column, uint32_t row)
{
    const bake_unpack *unpack = reader->ground->unpack;
    uint32_t side = 1u << unpack->pack.header.info.texture_log2;
    const uint8_t *payload;
    ff_key held = key;
    int rc = ff_pack_image(&unpack->pack, 0, &held, &payload);
    if (rc == FF_ERR_NOT_FOUND) reader->missing++;
    if (rc == FF_ERR_NOT_FOUND) return 0;
    if (rc >= 0) rc = decode_texture(reader, held, payload, (size_t)rc);
    if (rc < 0)
        return bake_fail("%s: the texture of tile %u, level %u, code %u: %s", unpack->path,
                         ff_key_tile(held), ff_key_level(held), ff_key_code(held),
                         ff_error_text(rc));
    if (held != key)
        bake_enlarge(&unpack->pack.header.info, reader->rgb, held, key, reader->enlarged);
    const uint8_t *rgb = held == key ? reader->rgb : reader->enlarged;
    for (uint32_t j = 0; j < side; j++)
        if (export_put_row(reader->ground, column, row + j, side,
                           rgb + (size_t)(side - 1 - j) * side * RGB))
            return -1;
    return 0;
}

/* Reads the textures of the level below a node that meet the window. */
static int read_below(image_reader *reader, ff_key key)
{
    const ff_terrain_info *info = &reader->ground->unpack->pack.header.info;
    uint32_t level = ff_key_level(key), down = reader->ground->level - level,
             cells = (1u << info->texture_log2) - 1;
    if (!export_meets(reader->ground, key, cells << down, 0)) return 0;
    if (!down) {
        ff_sheet at = ff_shape_sheet(info, ff_key_tile(key));
        export_reading(reader->ground, key, level);
        return read_texture(reader, key, ((at.x << level) + ff_morton_x(ff_key_code(key))) * cells,
                            ((at.y << level) + ff_morton_y(ff_key_code(key))) * cells);
    }
    for (uint32_t q = 0; q < 4; q++)
        if (read_below(reader, ff_key_child(key, q))) return -1;
    return 0;
}

/* What has no texture, nor any ancestor of it, is black. */
static int read_textures(export_ground *ground)
{
    const ff_terrain_info *info = &ground->unpack->pack.header.info;
    const bake_grid *cells = &ground->cells;
    if (ftruncate(cells->fd, (off_t)cells->width * cells->height * RGB))
        return bake_fail("cannot make a temporary file: %s", strerror(errno));
    size_t bytes = (size_t)RGB << (2 * info->texture_log2);
    image_reader reader = { .ground = ground,
                            .jpeg = malloc(bytes),
                            .enlarged = malloc(bytes),
                            .path.rgb = malloc(ff_picture_path_bytes(&ground->unpack->pack)) };
    int rc = reader.jpeg && reader.enlarged && reader.path.rgb ? 0 : bake_fail("out of memory");
    for (uint32_t tile = 0; !rc && tile < ff_shape_tiles(info); tile++)
        rc = read_below(&reader, ff_key_make(tile, 0, 0));
    if (reader.missing)
        bake_note("%" PRIu64 " textures are not in the pack: black", reader.missing);
    free(reader.jpeg);
    free(reader.enlarged);
    free(reader.path.rgb);
    return rc;
}

int export_ground_open_images(const bake_unpack *unpack, uint32_t level, const bake_box *region,
                              export_ground *ground)
{
    *ground = (export_ground){
        .unpack = unpack, .level = level, .bands = RGB, .scale = 1, .high = UINT8_MAX
    };
    ground->lattice = export_lattice_texels(&unpack->pack.header.info, level);
    int rc = export_ground_begin(ground, region, RGB);
    if (!rc) rc = read_textures(ground);
    return export_ground_finish(ground, rc);
}
