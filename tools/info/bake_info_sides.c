#include "bake_info_sides.h"

#include "../../protocol/shape/ff_shape.h"

static int has_refinement(const ff_pack *pack, ff_key key)
{
    const uint8_t *payload;
    return key != FF_KEY_NONE && ff_pack_record(pack, FF_SECTION_REFINEMENT, key, &payload) > 0;
}

static unsigned sides_beside(const ff_pack *pack, ff_key key)
{
    static const enum ff_side told[] = { FF_SIDE_SOUTH, FF_SIDE_WEST };
    unsigned sides = 0;
    for (unsigned i = 0; i < 2; i++)
        if (has_refinement(pack, ff_shape_neighbour(&pack->header.info, key, told[i]).key))
            sides |= 1u << told[i];
    return sides;
}

static uint64_t count_below(const ff_pack *pack, ff_key key)
{
    const ff_terrain_info *info = &pack->header.info;
    uint8_t less[FF_PAYLOAD_BYTES_MAX];
    const uint8_t *payload;
    if (ff_key_level(key) + 1 >= ff_terrain_levels(info)) return 0;
    int bytes = ff_pack_record(pack, FF_SECTION_REFINEMENT, key, &payload);
    if (bytes <= 0) return 0;
    int fewer = ff_without_sides(info, payload, (size_t)bytes, sides_beside(pack, key), less);
    uint64_t sum = (uint64_t)(fewer > 0 ? fewer : bytes);
    for (uint32_t q = 0; q < 4; q++) sum += count_below(pack, ff_key_child(key, q));
    return sum;
}

uint64_t bake_info_sides_once(const ff_pack *pack)
{
    const uint8_t *payload;
    uint64_t sum = 0;
    for (uint32_t tile = 0; tile < ff_shape_tiles(&pack->header.info); tile++) {
        ff_key root = ff_key_make(tile, 0, 0);
        int bytes = ff_pack_record(pack, FF_SECTION_ROOT, root, &payload);
        if (bytes > 0) sum += (uint64_t)bytes + count_below(pack, root);
    }
    return sum;
}
