/* The textures of a level, put together. */
#include "../../platform/sys.h"
#include "../../protocol/ff_image.h"
#include "../../protocol/picture/ff_picture_path.h"
#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_enlarge.h"
#include "../bake/bake_say.h"
#include "../info/bake_info_cover.h"
#include "export_ground_local.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RGB  3
#define RGBA 4

typedef struct image_reader {
    export_ground *ground;
    uint8_t *jpeg, *enlarged; /* of a texture, top row first */
    const uint8_t *rgb;
    uint64_t missing;
    int open; /* 1: what the layer's image does not cover is read, 0: the rest, over its rims */
    uint8_t *rgba, *measured; /* a row */
    ff_picture_path path;
} image_reader;

/* reader->rgb, of the image of a node that has one. FF_OK or an error. */
static int decode_texture(image_reader *reader, ff_key key, const ff_image *image)
{
    const ff_pack *pack = &reader->ground->unpack->pack;
    uint32_t side = 1u << pack->header.info.texture_log2;
    if (pack->header.info.flags & FF_TERRAIN_PICTURES)
        return ff_picture_path_get(&reader->path, pack, key, &reader->rgb);
    reader->rgb = reader->jpeg;
    return sys_jpeg_decode(image->coded, image->coded_bytes, side, side, reader->jpeg);
}

/* Lays a node's texels over the ground. What is open is clear, its colours those that the image
 * above goes on with. */
static int put_texels(const image_reader *reader, const uint8_t *rgb, uint32_t column, uint32_t row)
{
    uint32_t side = 1u << reader->ground->unpack->pack.header.info.texture_log2;
    for (uint32_t j = 0; j < side; j++) {
        const uint8_t *from = rgb + (size_t)(side - 1 - j) * side * RGB;
        for (uint32_t i = 0; i < side; i++) {
            memcpy(reader->rgba + (size_t)i * RGBA, from + (size_t)i * RGB, RGB);
            reader->rgba[(size_t)i * RGBA + RGB] = reader->open ? 0 : UINT8_MAX;
        }
        if (export_put_row(reader->ground, column, row + j, side, reader->rgba)) return -1;
        if (reader->ground->has_open && !reader->open &&
            export_put_mask(reader->ground, column, row + j, side, reader->measured))
            return -1;
    }
    return 0;
}

/* The layer's image ends before a node: `held` is the nearest above it that has an image, or a mark
 * of an open root. */
static int is_open(ff_key key, ff_key held, ff_image_marks marks)
{
    if (marks.open == 15) return 1;
    while (ff_key_level(key) > ff_key_level(held) + 1) key = ff_key_parent(key);
    return held != key && marks.open >> ff_key_quadrant(key) & 1;
}

/* The image of the nearest ancestor stands for one that is not stored. */
static int read_texture(image_reader *reader, ff_key key, uint32_t column, uint32_t row)
{
    const bake_unpack *unpack = reader->ground->unpack;
    const uint8_t *payload;
    ff_image image;
    ff_key held = key;
    int rc = ff_pack_image(&unpack->pack, reader->path.layer, &held, &payload);
    if (rc == FF_ERR_NOT_FOUND) reader->missing++;
    if (rc == FF_ERR_NOT_FOUND) return 0;
    if (rc >= 0) rc = ff_image_read(payload, (size_t)rc, &image);
    if (rc >= 0 && is_open(key, held, image.marks) != reader->open) return 0;
    if (rc >= 0 && !image.coded_bytes) return 0; /* clear from the start */
    if (rc >= 0) rc = decode_texture(reader, held, &image);
    if (rc < 0)
        return bake_fail("%s: the texture of tile %u, level %u, code %u: %s", unpack->path,
                         ff_key_tile(held), ff_key_level(held), ff_key_code(held),
                         ff_error_text(rc));
    if (held != key)
        bake_enlarge(&unpack->pack.header.info, reader->rgb, held, key, reader->enlarged);
    return put_texels(reader, held == key ? reader->rgb : reader->enlarged, column, row);
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

static int read_tiles(image_reader *reader, int open)
{
    const ff_terrain_info *info = &reader->ground->unpack->pack.header.info;
    reader->open = open;
    for (uint32_t tile = 0; tile < ff_shape_tiles(info); tile++)
        if (read_below(reader, ff_key_make(tile, 0, 0))) return -1;
    return 0;
}

static int clear(const bake_grid *grid)
{
    if (!ftruncate(grid->fd, (off_t)grid->width * grid->height * grid->cell_bytes)) return 0;
    return bake_fail("cannot make a temporary file: %s", strerror(errno));
}

/* The mask of an image that ends somewhere. */
static int open_mask(export_ground *ground)
{
    const bake_grid *cells = &ground->cells;
    if (bake_grid_open(&ground->mask, cells->width, cells->height, 1)) return -1;
    return clear(&ground->mask); /* EXPORT_BEYOND */
}

/* What has no texture, nor any ancestor of it, is black. */
static int read_textures(export_ground *ground, unsigned layer)
{
    const bake_unpack *unpack = ground->unpack;
    size_t side = (size_t)1 << unpack->pack.header.info.texture_log2;
    if (clear(&ground->cells) || (ground->has_open && open_mask(ground))) return -1;
    image_reader reader = { .ground = ground,
                            .jpeg = malloc(RGB * side * side),
                            .enlarged = malloc(RGB * side * side),
                            .rgba = malloc(RGBA * side),
                            .measured = malloc(side),
                            .path.rgb = malloc(ff_picture_path_bytes(&unpack->pack)) };
    int rc = reader.jpeg && reader.enlarged && reader.rgba && reader.measured && reader.path.rgb
                 ? 0
                 : bake_fail("out of memory");
    if (!rc) memset(reader.measured, EXPORT_MEASURED, side);
    ff_picture_path_layer(&reader.path, layer);
    if (!rc && ground->has_open) rc = read_tiles(&reader, 1);
    if (!rc) rc = read_tiles(&reader, 0);
    if (reader.missing)
        bake_note("%" PRIu64 " textures are not in the pack: black", reader.missing);
    free(reader.jpeg);
    free(reader.enlarged);
    free(reader.rgba);
    free(reader.measured);
    free(reader.path.rgb);
    return rc;
}

int export_ground_open_images(const bake_unpack *unpack, unsigned layer, uint32_t level,
                              const bake_box *region, export_ground *ground)
{
    *ground = (export_ground){
        .unpack = unpack, .level = level, .bands = RGB, .scale = 1, .high = UINT8_MAX
    };
    ground->has_open = bake_info_covered(&unpack->pack, layer) < 1;
    ground->lattice = export_lattice_texels(&unpack->pack.header.info, level);
    int rc = export_ground_begin(ground, region, RGBA);
    if (!rc) rc = read_textures(ground, layer);
    return export_ground_finish(ground, rc);
}
