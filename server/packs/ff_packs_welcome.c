/* What a WELCOME tells of packs, behind the first one's terrain, and of what is not drawn. */
#include "ff_packs.h"
#include "../../protocol/ff_assert.h"

/* A row of values in the making, of one entry. */
typedef struct row {
    ff_writer out;
    int needed;
    uint8_t bytes[FF_TERRAIN_BYTES * FF_WELCOME_GROUNDS];
} row;

static void begin(row *r) { r->out = (ff_writer){ r->bytes, r->bytes + sizeof r->bytes, FF_OK }; }

static void end(const row *r, enum ff_welcome_entry type, ff_writer *list)
{
    FF_ASSERT(r->out.error == FF_OK);
    if (r->needed) ff_list_write(list, type, r->bytes, (uint32_t)(r->out.at - r->bytes));
}

/* One layer without a name is not told: clients know its levels from the terrain. */
static void put_layers(const ff_pack *first, ff_writer *list)
{
    uint8_t bytes[FF_LAYERS_BYTES_MAX];
    ff_writer rows = { bytes, bytes + sizeof bytes, FF_OK };
    ff_layers layers;
    unsigned grounds = 0;
    for (const ff_pack *pack = first; pack; pack = pack->next) grounds++;
    ff_pack_layers(first, &layers);
    if (!layers.count || (layers.count == 1 && !*layers.name[0])) return;
    ff_layers_write(&rows, &layers, grounds);
    FF_ASSERT(rows.error == FF_OK);
    ff_list_write(list, FF_WELCOME_LAYERS, bytes, (uint32_t)(rows.at - bytes));
}

ff_list ff_packs_welcome(const ff_pack *first, uint32_t lacks, uint8_t bytes[FF_WELCOME_BYTES_MAX])
{
    row wholes = { .needed = 0 }, rest = { .needed = 0 }, entries = { .needed = 0 },
        images = { .needed = 0 }, not_drawn = { .needed = lacks != 0 };
    ff_writer list = { bytes, bytes + FF_WELCOME_BYTES_MAX, FF_OK };
    begin(&wholes);
    begin(&rest);
    begin(&entries);
    begin(&images);
    begin(&not_drawn);
    ff_write_bytes(&not_drawn.out, lacks, 4);
    for (const ff_pack *pack = first; pack; pack = pack->next) {
        const ff_terrain_info *info = &pack->header.info;
        uint32_t of = ff_pack_whole(pack);
        ff_write_bytes(&wholes.out, of, 4);
        wholes.needed |= of != info->checksum;
        if (pack != first) ff_write_terrain(&rest.out, info);
        rest.needed |= pack != first;
        ff_write_bytes(&entries.out, info->entered, 1);
        entries.needed |= info->entered > 0;
        uint32_t levels = ff_pack_images_whole(pack);
        ff_write_bytes(&images.out, levels, 1);
        images.needed |= levels > 0;
    }
    end(&wholes, FF_WELCOME_WHOLE, &list);
    end(&rest, FF_WELCOME_TERRAINS, &list);
    end(&entries, FF_WELCOME_ENTRY, &list);
    end(&not_drawn, FF_WELCOME_LACKS, &list);
    end(&images, FF_WELCOME_IMAGES, &list);
    put_layers(first, &list);
    FF_ASSERT(list.error == FF_OK);
    return (ff_list){ bytes, (uint32_t)(list.at - bytes) };
}
