#include "bake_unpack.h"

#include "../bake/bake_fault.h"
#include "../bake/bake_say.h"

#include <stdlib.h>
#include <string.h>

int bake_unpack_open(bake_unpack *unpack, const char *path)
{
    *unpack = (bake_unpack){ .path = path };
    int rc = sys_map_file(path, &unpack->mapping);
    if (rc) return bake_fail("%s: %s", path, ff_error_text(rc));
    rc = ff_pack_open(&unpack->pack, unpack->mapping.bytes, unpack->mapping.size);
    int codec = unpack->pack.header.info.codec;
    if (!rc && !ff_codec_supported(codec)) rc = FF_ERR_UNSUPPORTED;
    if (!rc) {
        size_t bytes = ff_decoder_bytes(&unpack->pack.header.info);
        unpack->decoder_memory = malloc(bytes);
        if (unpack->decoder_memory)
            unpack->decoder = ff_decoder_create(&unpack->pack.header.info, unpack->decoder_memory,
                                                bytes);
        if (!unpack->decoder) rc = FF_ERR_MEMORY;
    }
    if (!rc) return 0;
    char fault[200];
    int field = rc == FF_ERR_RANGE && bake_fault(&unpack->pack.header.info, fault, sizeof fault);
    bake_unpack_close(unpack);
    if (rc == FF_ERR_UNSUPPORTED)
        return bake_fail("%s: codec %d is %s", path, codec, ff_error_text(rc));
    return bake_fail("%s: %s", path, field ? fault : ff_error_text(rc));
}

void bake_unpack_close(bake_unpack *unpack)
{
    free(unpack->decoder_memory);
    sys_unmap_file(&unpack->mapping);
    unpack->decoder_memory = unpack->decoder = NULL;
}

uint32_t bake_unpack_side(const ff_terrain_info *info, uint32_t level)
{
    return (1u << (info->node_log2 + level)) + 1;
}

static int fail_at(const bake_unpack *unpack, const char *what, ff_key key, int rc)
{
    return bake_fail("%s: %s of tile %u, level %u, code %u: %s", unpack->path, what,
                     ff_key_tile(key), ff_key_level(key), ff_key_code(key), ff_error_text(rc));
}

/* Spreads a node or refined grid of `side` samples over a tile's grid; gather takes a node from
 * it. */
static void scatter(const uint16_t *in, uint32_t side, size_t pitch, size_t stride, uint16_t *out)
{
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) out[(j * pitch + i) * stride] = *in++;
}

static void gather(const uint16_t *in, uint32_t side, size_t pitch, size_t stride, uint16_t *out)
{
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) *out++ = in[(j * pitch + i) * stride];
}

/* The first stage of decoding. FF_OK or a negative ff_error. */
static int decode_residuals(const bake_unpack *unpack, enum ff_section_kind kind, ff_key key,
                            ff_residuals *residuals)
{
    const uint8_t *payload;
    int bytes = ff_pack_record(&unpack->pack, kind, key, &payload);
    if (bytes < 0) return bytes;
    return kind == FF_SECTION_ROOT
               ? ff_decode_root(unpack->decoder, payload, (size_t)bytes, residuals)
               : ff_decode_refinement(unpack->decoder, payload, (size_t)bytes, residuals);
}

static int decode_root(const bake_unpack *unpack, uint32_t tile, size_t pitch, size_t stride,
                       uint16_t *heights)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t node[FF_NODE_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    ff_key key = ff_key_make(tile, 0, 0);
    int rc = decode_residuals(unpack, FF_SECTION_ROOT, key, &residuals);
    if (rc >= 0) rc = ff_reconstruct_root(info, &residuals, node);
    if (rc < 0) return fail_at(unpack, "the root", key, rc);
    scatter(node, ff_node_side(info), pitch, stride, heights);
    return 0;
}

static int decode_refinement(const bake_unpack *unpack, ff_key key, size_t pitch, size_t stride,
                             uint16_t *at)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t parent[FF_NODE_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    int rc = decode_residuals(unpack, FF_SECTION_REFINEMENT, key, &residuals);
    gather(at, ff_node_side(info), pitch, stride, parent);
    if (rc >= 0) rc = ff_reconstruct_refinement(info, parent, &residuals, refined);
    if (rc < 0) return fail_at(unpack, "the refinement", key, rc);
    scatter(refined, ff_refined_side(info), pitch, stride / 2, at);
    return 0;
}

int bake_unpack_tile(const bake_unpack *unpack, uint32_t tile, uint32_t level, uint16_t *heights)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    size_t pitch = bake_unpack_side(info, level);
    if (decode_root(unpack, tile, pitch, (size_t)1 << level, heights)) return -1;
    for (uint32_t l = 0; l < level; l++) {
        size_t stride = (size_t)1 << (level - l), edge = stride << info->node_log2;
        for (uint32_t code = 0; code >> (2 * l) == 0; code++) {
            uint16_t *at = heights + ff_morton_y(code) * edge * pitch + ff_morton_x(code) * edge;
            if (decode_refinement(unpack, ff_key_make(tile, l, code), pitch, stride, at)) return -1;
        }
    }
    return 0;
}

int bake_unpack_told(const bake_unpack *unpack, enum ff_section_kind kind, ff_key key,
                     bake_told told[4])
{
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    int rc = decode_residuals(unpack, kind, key, &residuals);
    if (rc < 0)
        return fail_at(unpack, kind == FF_SECTION_ROOT ? "the root" : "the refinement", key, rc);
    for (int q = 0; q < (kind == FF_SECTION_ROOT ? 1 : 4); q++) {
        told[q].error_steps = ff_geometric_error_decode(residuals.child_error[q]);
        told[q].has_filled = residuals.filled >> q & 1;
    }
    return 0;
}
