#include "bake_unpack.h"

#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_fault.h"
#include "../bake/bake_say.h"
#include "../bake/bake_square.h"

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

static int fail_at(const bake_unpack *unpack, const char *what, ff_key key, int rc)
{
    return bake_fail("%s: %s of tile %u, level %u, code %u: %s", unpack->path, what,
                     ff_key_tile(key), ff_key_level(key), ff_key_code(key), ff_error_text(rc));
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

static int decode_root(const bake_unpack *unpack, ff_key key, uint16_t *node, ends *end)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .cells = ff_shape_cells(info, key, 0), .value = value };
    int rc = decode_residuals(unpack, FF_SECTION_ROOT, key, &residuals);
    if (rc >= 0) rc = ff_reconstruct_root(info, &residuals, node, room);
    if (rc < 0) return fail_at(unpack, "the root", key, rc);
    *end = (ends){ residuals.leaf, residuals.stub };
    return 0;
}

/* *end: on entry bit 0 tells of the node, after it a bit of each child. */
static int decode_refinement(const bake_unpack *unpack, ff_key key, size_t pitch, size_t stride,
                             uint16_t *at, ends *end)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint16_t parent[FF_NODE_HEIGHTS_MAX], refined[FF_REFINED_HEIGHTS_MAX];
    int is_ground = ff_shape_has_ground(info, key);
    ff_residuals residuals = { .leaf = 15, .value = value };
    int rc = 0;
    if (is_ground) residuals.cells = ff_shape_cells(info, key, 1);
    bake_gather(at, pitch, ff_node_side(info), stride, parent);
    if (end->leaf & 1u || !is_ground) {
        ff_predict_children(info, residuals.cells, parent, refined, room);
    } else if (end->stub & 1u) {
        ff_interpolate_children(info, residuals.cells, parent, refined);
        residuals.leaf = 0;
        residuals.stub = 15;
    } else {
        rc = decode_residuals(unpack, FF_SECTION_REFINEMENT, key, &residuals);
        if (rc >= 0) rc = ff_reconstruct_refinement(info, parent, &residuals, refined, room);
    }
    if (rc < 0) return fail_at(unpack, "the refinement", key, rc);
    bake_scatter(refined, pitch, ff_refined_side(info), stride / 2, at);
    *end = (ends){ residuals.leaf, residuals.stub };
    return 0;
}

/* ---- blocks ---- */

#define BLOCK_LEVELS 7 /* below a block's node */

uint32_t bake_unpack_block_level(uint32_t level)
{
    return level > BLOCK_LEVELS ? level - BLOCK_LEVELS : 0;
}

typedef struct walker {
    const bake_unpack *unpack;
    const bake_unpack_walk *walk;
    uint32_t level; /* of the blocks' nodes */
    uint32_t stride, side;
    uint16_t *heights; /* of a block */
    uint8_t *known;    /* the same, a byte each: 1 where one does not lie on a stub's triangles */
    int with_stubs;    /* 1: what is below stubs is made; 0: it stays as it is, the rest is known */
    int has_stubs;     /* some were met */
} walker;

static void mark_known(const walker *w, size_t at)
{
    uint32_t side = ff_node_side(&w->unpack->pack.header.info);
    for (uint32_t j = 0; j < side && !w->with_stubs; j++)
        memset(w->known + at + j * w->side, 1, side);
}

/* All below a node, whose heights stand at `at`, `stride` apart, down to where they stand side by
 * side. The child in the south-west comes last: a node without ground, which is made of predictions
 * alone, shares its western or southern rim, the last samples, with one that has ground. */
static int decode_below(walker *w, ff_key key, ends end, size_t stride, size_t at)
{
    if (stride == 1) {
        mark_known(w, at);
        return 0;
    }
    w->has_stubs |= end.stub & 1u;
    if (end.stub & 1u && !w->with_stubs) return 0;
    if (decode_refinement(w->unpack, key, w->side, stride, w->heights + at, &end)) return -1;
    size_t edge = stride / 2 << w->unpack->pack.header.info.node_log2;
    for (uint32_t q = 4; q-- > 0;)
        if (decode_below(w, ff_key_child(key, q), (ends){ end.leaf >> q, end.stub >> q },
                         stride / 2, at + (q & 1) * edge + (q >> 1) * edge * w->side))
            return -1;
    return 0;
}

/* Where a stub meets finer ground its triangles give way: all else is written over them. */
static int take_block(walker *w, ff_key key, ends end, const uint16_t *node)
{
    w->with_stubs = 1;
    w->has_stubs = 0;
    bake_scatter(node, w->side, ff_node_side(&w->unpack->pack.header.info), w->stride, w->heights);
    if (decode_below(w, key, end, w->stride, 0)) return -1;
    w->with_stubs = 0;
    memset(w->known, 0, (size_t)w->side * w->side);
    if (w->has_stubs && decode_below(w, key, end, w->stride, 0)) return -1;
    return w->walk->take(w->walk->context, key, w->side, w->heights,
                         w->has_stubs ? w->known : NULL);
}

static int walk_below(walker *w, ff_key key, ends end, const uint16_t *node)
{
    const ff_terrain_info *info = &w->unpack->pack.header.info;
    uint16_t refined[FF_REFINED_HEIGHTS_MAX], child[FF_NODE_HEIGHTS_MAX];
    uint32_t side = ff_refined_side(info);
    if (!ff_shape_has_ground(info, key) || !w->walk->wants(w->walk->context, key)) return 0;
    if (ff_key_level(key) == w->level) return take_block(w, key, end, node);
    bake_scatter(node, side, ff_node_side(info), 2, refined);
    if (decode_refinement(w->unpack, key, side, 2, refined, &end)) return -1;
    for (uint32_t q = 0; q < 4; q++) {
        ff_refined_child(info, refined, q, child);
        if (walk_below(w, ff_key_child(key, q), (ends){ end.leaf >> q, end.stub >> q }, child))
            return -1;
    }
    return 0;
}

int bake_unpack_heights(const bake_unpack *unpack, uint32_t level, const bake_unpack_walk *walk)
{
    const ff_terrain_info *info = &unpack->pack.header.info;
    uint32_t top = bake_unpack_block_level(level), stride = 1u << (level - top),
             side = (stride << info->node_log2) + 1;
    size_t samples = (size_t)side * side;
    walker w = { unpack,          walk, top, stride, side, malloc(samples * sizeof(uint16_t)),
                 malloc(samples), 0,    0 };
    int rc = w.heights && w.known ? 0 : bake_fail("out of memory");
    for (uint32_t tile = 0; !rc && tile < ff_shape_tiles(info); tile++) {
        ff_key key = ff_key_make(tile, 0, 0);
        uint16_t root[FF_NODE_HEIGHTS_MAX];
        ends end = { 0, 0 };
        if (!walk->wants(walk->context, key)) continue;
        rc = decode_root(unpack, key, root, &end) ? -1 : walk_below(&w, key, end, root);
    }
    free(w.heights);
    free(w.known);
    return rc;
}

/* ---- what is told ---- */

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
