#include "bake_info_cover.h"

#include "../../protocol/ff_image.h"
#include "../../protocol/shape/ff_shape.h"

/* Cells between samples along one axis of a node of a level, which is the place-th of all. */
static uint64_t cells_along(const ff_terrain_info *info, uint32_t level, uint32_t place,
                            uint32_t samples)
{
    uint64_t edge = (uint64_t)1 << (info->tile_log2 - level), first = place * edge;
    uint64_t last = first + edge < samples ? first + edge : samples - 1u;
    return last > first ? last - first : 0;
}

static uint64_t cells_of(const ff_terrain_info *info, ff_key key)
{
    uint32_t level = ff_key_level(key), code = ff_key_code(key);
    ff_sheet tile = ff_shape_sheet(info, ff_key_tile(key)), all = ff_shape_sheet_samples(info);
    return cells_along(info, level, (tile.x << level) + ff_morton_x(code), all.x) *
           cells_along(info, level, (tile.y << level) + ff_morton_y(code), all.y);
}

/* Cells of a node's ground that are open, and of what lies below it. */
static uint64_t open_below(const ff_pack *pack, unsigned layer, ff_key key)
{
    const ff_terrain_info *info = &pack->header.info;
    const uint8_t *payload;
    ff_image image;
    uint64_t open = 0;
    int bytes = ff_pack_layer_record(pack, layer, key, &payload);
    if (bytes < 0 || ff_image_read(payload, (size_t)bytes, &image) != FF_OK) return 0;
    if (image.marks.open == 15) return cells_of(info, key);
    if (ff_key_level(key) + 1 >= ff_pack_image_levels(pack, layer)) return 0;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(key, q);
        if (image.marks.open >> q & 1)
            open += cells_of(info, child);
        else if (!ff_image_ends(image.marks, q))
            open += open_below(pack, layer, child);
    }
    return open;
}

double bake_info_covered(const ff_pack *pack, unsigned layer)
{
    const ff_terrain_info *info = &pack->header.info;
    ff_sheet samples = ff_shape_sheet_samples(info);
    uint64_t open = 0, all = (uint64_t)(samples.x - 1) * (samples.y - 1);
    for (uint32_t tile = 0; tile < ff_shape_tiles(info); tile++)
        open += open_below(pack, layer, ff_key_make(tile, 0, 0));
    return 1 - (double)open / (double)all;
}
