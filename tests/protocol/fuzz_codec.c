/* Any bytes as a payload. Byte 0: node_log2 - 1 (bits 0-2, modulo 5), refinement (bit 3), codec
 * (bits 4-6, modulo the number of codecs), smooth parent or an entered root (bit 7); bytes 1-2:
 * max_error, and in the highest bit whether the ground ends inside the grid: then bytes 3 and 4 say
 * after how many columns and rows of cells. When the payload decodes, its heights and marks must be
 * the slow decoder's, and those of the payload without some of its sides. */
#include "../../protocol/codec/ff_codec.h"
#include "../rig/slow_decoder.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static uint16_t codec_room[FF_CODEC_ROOM_MAX / 2 + 1];

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

/* The cells of a grid of `side` samples that have ground, from two bytes, or all of them. */
static ff_cells cells_from(const uint8_t *two, uint32_t side)
{
    uint32_t all = side - 1;
    return two ? (ff_cells){ (uint8_t)(1 + two[0] % all), (uint8_t)(1 + two[1] % all) }
               : (ff_cells){ (uint8_t)all, (uint8_t)all };
}

/* A parent of such a refinement: beyond its ground it repeats the last sample, as all decoded
 * grids do. */
static void make_parent(const ff_terrain_info *info, ff_cells cells, int smooth, uint16_t *parent)
{
    uint32_t side = ff_node_side(info), last_x = (cells.columns + 1u) / 2,
             last_y = (cells.rows + 1u) / 2;
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x = i % side < last_x ? i % side : last_x,
                 y = i / side < last_y ? i / side : last_y, at = y * side + x;
        parent[i] = (uint16_t)(smooth ? 9 * x * x + 50 * y + 20000 : at * at * 40503u >> 3);
    }
}

/* What has come beside the node: the sides of both grids, as they are left out. */
static void know_sides(uint16_t *heights, uint16_t *slow, uint32_t side)
{
    for (uint32_t i = 0; i < side * side; i++) heights[i] = slow[i] = (uint16_t)(i * 40503u >> 3);
}

/* `heights`: of the payload, which has decoded. */
static void leave_out_sides(const ff_terrain_info *info, ff_cells cells, const uint16_t *parent,
                            ff_decoder *dec, const uint8_t *bytes, size_t count,
                            const uint16_t *heights)
{
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    static uint16_t again[FF_REFINED_HEIGHTS_MAX];
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value, .cells = cells };
    uint32_t side = ff_refined_side(info);
    int fewer = ff_without_sides(info, bytes, count, count & 15u, less);
    if (fewer <= 0 || cells.columns < side - 1 || cells.rows < side - 1) return;
    memcpy(again, heights, sizeof again);
    for (uint32_t y = 1; y < side - 1; y++) memset(again + y * side + 1, 0, 2 * (side - 2));
    int rc = ff_decode_refinement(dec, less, (size_t)fewer, &residuals);
    assert(rc == FF_OK);
    rc = ff_reconstruct_beside(info, parent, &residuals, again, codec_room);
    assert(rc == FF_OK && memcmp(again, heights, 2u * side * side) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint16_t parent[FF_NODE_HEIGHTS_MAX], heights[FF_REFINED_HEIGHTS_MAX],
        slow[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    ff_terrain_info info = { .tile_log2 = 15 };
    int rc, slow_rc, refinement, other;
    size_t head = 3;

    if (count < head || (bytes[2] & 0x80 && count < (head = 5))) return 0;
    refinement = bytes[0] >> 3 & 1;
    info.node_log2 = (uint8_t)((bytes[0] & 7) % FF_NODE_LOG2_MAX + 1);
    info.codec = (uint8_t)((bytes[0] >> 4 & 7) % FF_CODEC_COUNT);
    other = bytes[0] >> 7;
    info.entered = !refinement && other;
    info.max_error = (uint16_t)((bytes[1] | bytes[2] << 8) & INT16_MAX);
    uint32_t side = refinement ? ff_refined_side(&info) : ff_node_side(&info);
    residuals.cells = cells_from(head == 5 ? bytes + 3 : NULL, side);
    make_parent(&info, residuals.cells, other, parent);

    size_t memory_bytes = ff_decoder_bytes(&info);
    void *memory = malloc(memory_bytes);
    ff_decoder *dec = ff_decoder_create(&info, memory, memory_bytes);
    assert(dec != NULL);
    bytes += head;
    count -= head;
    know_sides(heights, slow, side);
    rc = refinement ? ff_decode_refinement(dec, bytes, count, &residuals)
                    : ff_decode_root(dec, bytes, count, &residuals);
    if (rc == FF_OK)
        rc = refinement ? ff_reconstruct_beside(&info, parent, &residuals, heights, codec_room)
                        : ff_reconstruct_root(&info, &residuals, heights, codec_room);
    if (info.entered) info.max_error = 0; /* SPEC.md, "Entry" */
    slow_rc = slow_decode_part(&info, residuals.cells.columns, residuals.cells.rows,
                               refinement ? parent : NULL, bytes, count, slow);
    assert((rc == FF_OK) == (slow_rc >= 0));
    if (rc == FF_OK) {
        assert(residuals.filled + 16 * residuals.leaf + 256 * residuals.stub == slow_rc);
        assert(memcmp(heights, slow, 2u * side * side) == 0);
        if (refinement) leave_out_sides(&info, residuals.cells, parent, dec, bytes, count, heights);
    } else if (refinement) {
        static uint8_t less[FF_PAYLOAD_BYTES_MAX];
        (void)ff_without_sides(&info, bytes, count, count & 15u, less);
    }
    free(memory);
    return 0;
}
