/* decode_pack PACK: decodes and reconstructs all heights of a pack with the core alone, from the
 * roots down, for bench_codec.py: cross-built for the handheld, counted by tcg_count.c. What is
 * decoding lies in the phase "work". Prints how many heights were made, those of rims with every
 * node that has them, and their sum: the same on every machine. */
#include "../../protocol/shape/ff_shape.h"
#include "counted_pack.h"

static ff_decoder *decoder;
static int32_t value[FF_REFINED_HEIGHTS_MAX];
static uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
static unsigned long long heights, sum;

static int record(enum ff_section_kind kind, ff_key key, const uint8_t **payload)
{
    int bytes = ff_pack_record(&pack, kind, key, payload);
    return bytes < 0 ? fail("a record is broken") : bytes;
}

static void add(const uint16_t *grid, uint32_t side, uint32_t known)
{
    heights += side * side - known;
    for (uint32_t i = 0; i < side * side; i++) sum += grid[i];
}

static void below(ff_key key, const uint16_t *parent)
{
    const ff_terrain_info *info = &pack.header.info;
    uint16_t refined[FF_REFINED_HEIGHTS_MAX], child[FF_NODE_HEIGHTS_MAX];
    ff_residuals residuals = { .cells = ff_shape_cells(info, key, 1), .value = value };
    uint32_t side = ff_node_side(info);
    const uint8_t *payload;
    if (ff_key_level(key) + 1 >= ff_terrain_levels(info) || !ff_shape_has_ground(info, key)) return;
    int bytes = record(FF_SECTION_REFINEMENT, key, &payload);
    handheld_mark_work();
    if (ff_decode_refinement(decoder, payload, (uint32_t)bytes, &residuals) ||
        ff_reconstruct_refinement(info, parent, &residuals, refined, room))
        fail("a refinement is broken");
    handheld_mark_outside();
    add(refined, ff_refined_side(info), side * side);
    unsigned leaf = residuals.leaf; /* `residuals` is used again */
    for (uint32_t q = 0; q < 4; q++) {
        if (leaf >> q & 1) continue;
        ff_refined_child(info, refined, q, child);
        below(ff_key_child(key, q), child);
    }
}

static void tile(uint32_t number)
{
    const ff_terrain_info *info = &pack.header.info;
    uint16_t root[FF_NODE_HEIGHTS_MAX];
    ff_key key = ff_key_make(number, 0, 0);
    ff_residuals residuals = { .cells = ff_shape_cells(info, key, 0), .value = value };
    const uint8_t *payload;
    int bytes = record(FF_SECTION_ROOT, key, &payload);
    handheld_mark_work();
    if (ff_decode_root(decoder, payload, (uint32_t)bytes, &residuals) ||
        ff_reconstruct_root(info, &residuals, root, room))
        fail("a root is broken");
    handheld_mark_outside();
    add(root, ff_node_side(info), 0);
    if (!(residuals.leaf & 1)) below(key, root);
}

int main(int argc, char **argv)
{
    open_pack(argc, argv);
    size_t decoder_bytes = ff_decoder_bytes(&pack.header.info);
    decoder = ff_decoder_create(&pack.header.info, malloc(decoder_bytes), decoder_bytes);
    handheld_mark_start();
    for (uint32_t i = 0; i < ff_shape_tiles(&pack.header.info); i++) tile(i);
    printf("heights %llu\nsum %llu\n", heights, sum);
    return 0;
}
