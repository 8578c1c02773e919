/* Packs entered below their top. */
#include "ff_entry.h"
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

uint32_t ff_pack_entry_level(const ff_pack *pack, int32_t reach_wu)
{
    const ff_terrain_info *info = &pack->header.info;
    uint32_t level = ff_entry_level(info, reach_wu);

    while (level && info->texture_log2 && !has_images(pack, level)) level--;
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
