/* Packs entered below their top. */
#include "ff_entry.h"
#include "ff_image.h"
#include "ff_pack.h"
#include "shape/ff_shape.h"

/* 1 when every node of a level that has ground has an image of its own, of each layer. */
static int has_images(const ff_pack *pack, uint32_t level)
{
    uint32_t whole = 0;

    for (uint32_t i = 0; i < pack->header.section_count; i++) {
        const ff_pack_section *section = &pack->header.section[i];
        if (section->kind == FF_SECTION_TEXTURE && section->level == level)
            whole += section->index.records == ff_entry_nodes(&pack->header.info, level);
    }
    return whole == pack->header.layers;
}

/* 1 when each node with ground so many levels below one that has an image has its own, or the
 * layer's image ends before it. Goes over what the layer covers alone. */
static int all_told(const ff_pack *pack, unsigned layer, ff_key key, uint32_t below)
{
    const uint8_t *payload;
    ff_image image;
    int all = 1, bytes = ff_pack_layer_record(pack, layer, key, &payload);

    if (bytes < 0 || ff_image_read(payload, (size_t)bytes, &image) != FF_OK) return 0;
    if (!below || image.marks.open == 15) return 1;
    for (unsigned q = 0; all && q < 4; q++) {
        ff_key child = ff_key_child(key, q);
        if (ff_shape_has_ground(&pack->header.info, child) && !(image.marks.open >> q & 1))
            all = !ff_image_ends(image.marks, q) && all_told(pack, layer, child, below - 1);
    }
    return all;
}

/* 1 when an image is told for every node of a level that has ground, of each layer: its own, or
 * that there is none. */
static int tells_images(const ff_pack *pack, uint32_t level)
{
    uint32_t tiles = ff_shape_tiles(&pack->header.info);

    if (has_images(pack, level)) return 1;
    for (unsigned layer = 0; layer < pack->header.layers; layer++)
        for (uint32_t tile = 0; tile < tiles; tile++)
            if (!all_told(pack, layer, ff_key_make(tile, 0, 0), level)) return 0;
    return 1;
}

uint32_t ff_pack_entry_level(const ff_pack *pack, int32_t reach_wu)
{
    const ff_terrain_info *info = &pack->header.info;
    uint32_t level = ff_entry_level(info, reach_wu);

    while (level && info->texture_log2 && !tells_images(pack, level)) level--;
    return level;
}

uint32_t ff_pack_images_whole(const ff_pack *pack)
{
    const ff_pack *stored = pack->stored ? pack->stored : pack;
    const ff_terrain_info *info = &stored->header.info;
    uint32_t levels = 0, entered = pack->header.info.entered;

    while (info->texture_log2 && levels < info->texture_levels && levels < ff_image_levels(info) &&
           has_images(stored, levels))
        levels++;
    FF_ASSERT(levels <= info->texture_levels);
    return levels > entered ? levels - entered : 0;
}

void ff_pack_enter(const ff_pack *whole, uint32_t level, ff_pack_root_fn *make_root, void *context,
                   ff_pack *entered)
{
    *entered = *whole;
    entered->next = NULL;
    if (level == 0) return;
    entered->header.info = ff_entry_terrain(&whole->header.info, level);
    entered->tiles = ff_shape_tiles(&entered->header.info);
    entered->stored = whole;
    entered->make_root = make_root;
    entered->root_context = context;
}
