/* Any bytes as a payload. Byte 0: node_log2 - 1 (bits 0-2, modulo 5), refinement (bit 3), codec
 * (bits 4-7, modulo the number of codecs); bytes 1-2: max_error. When the payload decodes, its
 * heights must be the slow decoder's. */
#include "../../protocol/codec/ff_codec.h"
#include "../rig/slow_decoder.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    static int32_t value[FF_REFINED_HEIGHTS_MAX];
    static uint16_t parent[FF_NODE_HEIGHTS_MAX], heights[FF_REFINED_HEIGHTS_MAX],
        slow[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    ff_terrain_info info = { .tile_log2 = 15 };
    int rc, slow_rc, refinement;

    if (count < 3) return 0;
    refinement = bytes[0] >> 3 & 1;
    info.node_log2 = (uint8_t)((bytes[0] & 7) % FF_NODE_LOG2_MAX + 1);
    info.codec = (uint8_t)((bytes[0] >> 4) % FF_CODEC_COUNT);
    info.max_error = (uint16_t)((bytes[1] | bytes[2] << 8) & INT16_MAX);
    for (uint32_t i = 0; i < FF_NODE_HEIGHTS_MAX; i++) parent[i] = (uint16_t)(i * i * 40503u >> 3);

    size_t memory_bytes = ff_decoder_bytes(&info);
    void *memory = malloc(memory_bytes);
    ff_decoder *dec = ff_decoder_create(&info, memory, memory_bytes);
    assert(dec != NULL);
    bytes += 3;
    count -= 3;
    rc = refinement ? ff_decode_refinement(dec, bytes, count, &residuals)
                    : ff_decode_root(dec, bytes, count, &residuals);
    if (rc == FF_OK)
        rc = refinement ? ff_reconstruct_refinement(&info, parent, &residuals, heights)
                        : ff_reconstruct_root(&info, &residuals, heights);
    slow_rc = slow_decode(&info, refinement ? parent : NULL, bytes, count, slow);
    assert((rc == FF_OK) == (slow_rc >= 0));
    if (rc == FF_OK) {
        assert(residuals.filled == slow_rc);
        uint32_t side = refinement ? ff_refined_side(&info) : ff_node_side(&info);
        assert(memcmp(heights, slow, 2u * side * side) == 0);
    }
    free(memory);
    return 0;
}
