#include "bake_unpack.h"

#include "../../protocol/shape/ff_shape.h"
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
    if (rc == FF_ERR_UNSUPPORTED && !*unpack->pack.refusal)
        return bake_fail("%s: codec %d is %s", path, codec, ff_error_text(rc));
    return bake_fail("%s: %s", path, field ? fault : ff_pack_error_text(&unpack->pack, rc));
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

/* What is told of nodes of which nothing finer is stored: a bit each. */
typedef struct ends {
    unsigned leaf, stub;
} ends;

static int decode_root(const bake_unpack *unpack, uint32_t tile, size_t pitch, size_t stride,
                       uint16_t *heights, ends *root)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t node[FF_NODE_HEIGHTS_MAX];
    ff_key key = ff_key_make(tile, 0, 0);
    ff_residuals residuals = { .cells = ff_shape_cells(info, key, 0), .value = value };
    int rc = decode_residuals(unpack, FF_SECTION_ROOT, key, &residuals);
    if (rc >= 0) rc = ff_reconstruct_root(info, &residuals, node);
    if (rc < 0) return fail_at(unpack, "the root", key, rc);
    scatter(node, ff_node_side(info), pitch, stride, heights);
    *root = (ends){ residuals.leaf, residuals.stub };
    return 0;
}

/* *end: on entry bit 0 tells of the node, after it a bit of each child. */
static int decode_refinement(const bake_unpack *unpack, ff_key key, size_t pitch, size_t stride,
                             uint16_t *at, ends *end)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t parent[FF_NODE_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX];
    int is_ground = ff_shape_has_ground(info, key);
    ff_residuals residuals = { .leaf = 15, .value = value };
    int rc = 0;
    if (is_ground) residuals.cells = ff_shape_cells(info, key, 1);
    gather(at, ff_node_side(info), pitch, stride, parent);
    if (end->leaf & 1u || !is_ground) {
        ff_predict_children(info, residuals.cells, parent, refined);
    } else if (end->stub & 1u) {
        ff_interpolate_children(info, residuals.cells, parent, refined);
        residuals.leaf = 0;
        residuals.stub = 15;
    } else {
        rc = decode_residuals(unpack, FF_SECTION_REFINEMENT, key, &residuals);
        if (rc >= 0) rc = ff_reconstruct_refinement(info, parent, &residuals, refined);
    }
    if (rc < 0) return fail_at(unpack, "the refinement", key, rc);
    scatter(refined, ff_refined_side(info), pitch, stride / 2, at);
    *end = (ends){ residuals.leaf, residuals.stub };
    return 0;
}

/* A tile on its way into a grid. */
typedef struct tile_writer {
    const bake_unpack *unpack;
    bake_rims *known; /* NULL: not asked for */
    size_t pitch;
    int with_stubs; /* 1: what is below stubs is made, 0: it stays as it is */
    int has_stubs;  /* some were met */
} tile_writer;

/* Of a node of the finest level wanted. */
static void mark_known(const tile_writer *to, ff_key key)
{
    uint32_t cells = 1u << to->unpack->pack.header.info.node_log2,
             x = ff_morton_x(ff_key_code(key)), y = ff_morton_y(ff_key_code(key));
    if (to->known && x == 0) memset(to->known->west + (size_t)y * cells, 1, cells + 1);
    if (to->known && y == 0) memset(to->known->south + (size_t)x * cells, 1, cells + 1);
}

/* All below a node, whose heights stand at `at`, `stride` apart, down to where they stand side by
 * side. The child in the south-west comes last: a node without ground, which is made of predictions
 * alone, shares its western or southern rim, the last samples, with one that has ground. */
static int decode_below(tile_writer *to, ff_key key, ends end, size_t stride, uint16_t *at)
{
    if (stride == 1) {
        mark_known(to, key);
        return 0;
    }
    to->has_stubs |= end.stub & 1u;
    if (end.stub & 1u && !to->with_stubs) return 0;
    if (decode_refinement(to->unpack, key, to->pitch, stride, at, &end)) return -1;
    size_t edge = stride / 2 << to->unpack->pack.header.info.node_log2;
    for (uint32_t q = 4; q-- > 0;)
        if (decode_below(to, ff_key_child(key, q), (ends){ end.leaf >> q, end.stub >> q },
                         stride / 2, at + (q & 1) * edge + (q >> 1) * edge * to->pitch))
            return -1;
    return 0;
}

static int decode_tile(tile_writer *to, uint32_t tile, uint32_t level, uint16_t *heights)
{
    size_t stride = (size_t)1 << level;
    ends root;
    if (to->known) memset(to->known->west, 0, to->pitch);
    if (to->known) memset(to->known->south, 0, to->pitch);
    if (decode_root(to->unpack, tile, to->pitch, stride, heights, &root)) return -1;
    return decode_below(to, ff_key_make(tile, 0, 0), root, stride, heights);
}

/* Where a stub meets finer ground its triangles give way: all else is written over them. */
int bake_unpack_tile(const bake_unpack *unpack, uint32_t tile, uint32_t level, uint16_t *heights,
                     bake_rims *known)
{
    tile_writer to = { unpack, known, bake_unpack_side(&unpack->pack.header.info, level), 1, 0 };
    int rc = decode_tile(&to, tile, level, heights);
    to.with_stubs = 0;
    return rc || !to.has_stubs ? rc : decode_tile(&to, tile, level, heights);
}

static bake_told told_of(const ff_residuals *residuals, unsigned q)
{
    return (bake_told){ residuals->child_error[q], residuals->filled >> q & 1u,
                        residuals->leaf >> q & 1u, residuals->stub >> q & 1u };
}

/* Of a root, or of a node's children. FF_OK or a negative ff_error. */
static int read_told(const bake_unpack *unpack, enum ff_section_kind kind, ff_key key,
                     ff_residuals *told)
{
    const uint8_t *payload;
    int bytes = ff_pack_record(&unpack->pack, kind, key, &payload);
    if (bytes < 0) return bytes;
    return ff_read_marks(&unpack->pack.header.info, kind == FF_SECTION_ROOT, payload, (size_t)bytes,
                         told);
}

int bake_unpack_told_root(const bake_unpack *unpack, uint32_t tile, bake_told *told)
{
    ff_key key = ff_key_make(tile, 0, 0);
    ff_residuals residuals = { 0 };
    int rc = read_told(unpack, FF_SECTION_ROOT, key, &residuals);
    if (rc < 0) return fail_at(unpack, "the root", key, rc);
    *told = told_of(&residuals, 0);
    return 0;
}

int bake_unpack_told_below(const bake_unpack *unpack, ff_key key, const bake_told *node,
                           bake_told told[4])
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    ff_residuals residuals = { 0 };
    int rc = 0;
    if (node->is_leaf || !ff_shape_has_ground(info, key))
        residuals = ff_leaf_residuals(info, node->error_code, node->has_filled);
    else if (!node->is_stub)
        rc = read_told(unpack, FF_SECTION_REFINEMENT, key, &residuals);
    if (rc < 0) return fail_at(unpack, "the refinement", key, rc);
    for (unsigned q = 0; q < 4; q++) told[q] = node->is_stub ? *node : told_of(&residuals, q);
    return 0;
}
