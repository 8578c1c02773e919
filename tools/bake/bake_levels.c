#include "bake_levels.h"

#include "../../protocol/shape/ff_shape.h"
#include "bake_say.h"
#include "bake_square.h"

#include <stdlib.h>

int bake_levels_open(bake_levels *levels, const ff_terrain_info *info, uint32_t bottom, size_t side)
{
    *levels = (bake_levels){ .info = info, .bottom = bottom, .pitch = side };
    levels->source = malloc(side * side * sizeof *levels->source);
    levels->decoded = malloc(side * side * sizeof *levels->decoded);
    return levels->source && levels->decoded ? 0 : bake_fail("out of memory");
}

void bake_levels_close(bake_levels *levels)
{
    free(levels->source);
    free(levels->decoded);
    free(levels->marks);
    for (int i = 0; i < BAKE_LEVELS_MAX; i++) bake_blob_free(&levels->level[i]);
    *levels = (bake_levels){ 0 };
}

int bake_levels_mark(bake_levels *levels, size_t side)
{
    if (!levels->marks) levels->marks = malloc(side * side);
    return levels->marks ? 0 : bake_fail("out of memory");
}

/* ---- heights ---- */

/* A root or a refinement under way: decoded heights that it starts from and leads to. */
typedef struct heights {
    uint8_t between[FF_REFINED_HEIGHTS_MAX];
    uint16_t parent[FF_NODE_HEIGHTS_MAX], decoded[FF_REFINED_HEIGHTS_MAX];
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    uint8_t body[FF_PAYLOAD_BYTES_MAX];
    ff_residuals residuals;
} heights;

/* Which points of a square have no sample; NULL: all have one. */
static const uint8_t *gather_between(const bake_levels *levels, size_t at, uint32_t side,
                                     size_t stride, uint8_t *between)
{
    const uint8_t *from = levels->marks + at;
    if (!levels->marks) return NULL;
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++)
            between[j * side + i] = from[j * stride * levels->pitch + i * stride] & BAKE_BETWEEN;
    return between;
}

static uint32_t root_cell(const bake_levels *levels) { return 1u << levels->bottom; }

static void decode_root(bake_levels *levels, uint32_t tile, heights *h)
{
    const ff_terrain_info *info = levels->info;
    uint16_t source[FF_NODE_HEIGHTS_MAX];
    uint32_t side = ff_node_side(info), cell = root_cell(levels);
    bake_gather(levels->source, levels->pitch, side, cell, source);
    h->residuals = (ff_residuals){ .value = h->value,
                                   .body = h->body,
                                   .cells = ff_shape_cells(info, ff_key_make(tile, 0, 0), 0) };
    ff_encode_heights(info, NULL, source, gather_between(levels, 0, side, cell, h->between),
                      &h->residuals, h->decoded);
    bake_scatter(h->decoded, levels->pitch, side, cell, levels->decoded);
}

/* The children of the node whose south-west point is `at`, its cells `cell` points wide. */
static void decode_children(bake_levels *levels, ff_key key, size_t at, uint32_t cell, heights *h)
{
    const ff_terrain_info *info = levels->info;
    uint16_t source[FF_REFINED_HEIGHTS_MAX];
    size_t pitch = levels->pitch;
    bake_gather(levels->decoded + at, pitch, ff_node_side(info), cell, h->parent);
    bake_gather(levels->source + at, pitch, ff_refined_side(info), cell / 2, source);
    h->residuals =
        (ff_residuals){ .value = h->value, .body = h->body, .cells = ff_shape_cells(info, key, 1) };
    ff_encode_heights(info, h->parent, source,
                      gather_between(levels, at, ff_refined_side(info), cell / 2, h->between),
                      &h->residuals, h->decoded);
    bake_scatter(h->decoded, pitch, ff_refined_side(info), cell / 2, levels->decoded + at);
}

/* The south-west point of child q. */
static size_t child_at(const bake_levels *levels, size_t at, uint32_t cell, uint32_t q)
{
    size_t edge = (size_t)(cell / 2) << levels->info->node_log2;
    return at + (q & 1) * edge + (q >> 1) * edge * levels->pitch;
}

static void decode_below(bake_levels *levels, ff_key key, size_t at, uint32_t cell)
{
    heights h;
    if (cell == 1 || !ff_shape_has_ground(levels->info, key)) return;
    decode_children(levels, key, at, cell, &h);
    for (uint32_t q = 0; q < 4; q++)
        decode_below(levels, ff_key_child(key, q), child_at(levels, at, cell, q), cell / 2);
}

void bake_levels_decode(bake_levels *levels, uint32_t tile)
{
    heights h;
    decode_root(levels, tile, &h);
    decode_below(levels, ff_key_make(tile, 0, 0), 0, root_cell(levels));
}

/* ---- records ---- */

/* Appends the payload of a root or refinement, error codes filled in, to a level's records. */
static int add_payload(bake_levels *levels, uint32_t level, const uint16_t *parent,
                       const heights *h)
{
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    int bytes = ff_encode_payload(levels->info, parent, h->decoded, &h->residuals, payload);
    if (bytes < 0)
        return bake_fail("cannot encode a %s: %s", parent ? "node" : "root", ff_error_text(bytes));
    return bake_blob_add(&levels->level[level], payload, (size_t)bytes);
}

/* Appends no record for a node, and none for all below it. */
static int leave_out(bake_levels *levels, uint32_t level)
{
    uint64_t count = 1;
    for (uint32_t l = level + 1; l <= levels->bottom; l++, count *= 4)
        for (uint64_t i = 0; i < count; i++)
            if (bake_blob_add(&levels->level[l], NULL, 0)) return -1;
    return 0;
}

/* Is a node all prediction: its own refinement, which leads to `child`, and all below? */
static uint8_t is_leaf(const bake_levels *levels, ff_key key, const bake_known *node,
                       const ff_residuals *residuals, const bake_known child[4])
{
    if (!ff_is_as_predicted(residuals)) return 0;
    for (uint32_t q = 0; q < 4; q++)
        if (ff_shape_has_ground(levels->info, ff_key_child(key, q)) &&
            (!child[q].leaf || child[q].filled != node->filled ||
             child[q].code > ff_geometric_error_below(levels->info, node->code)))
            return 0;
    return 1;
}

/* Marks the children that are leaves. Those of the finest level are not marked. Those without
 * ground are when it makes all alike. */
static void mark_leaves(const bake_levels *levels, ff_key key, const bake_known child[4],
                        ff_residuals *residuals)
{
    const ff_terrain_info *info = levels->info;
    unsigned ground = 0;
    if (ff_key_level(key) + 2 >= ff_terrain_levels(info)) return;
    for (uint32_t q = 0; q < 4; q++)
        ground |= (unsigned)(ff_shape_has_ground(info, ff_key_child(key, q)) != 0) << q;
    for (uint32_t q = 0; q < 4; q++) residuals->leaf |= (uint8_t)(child[q].leaf << q);
    residuals->leaf &= (uint8_t)ground;
    if (residuals->leaf == ground) residuals->leaf = 15;
}

/* Encodes the refinement of the node whose south-west point is `at`, its cells `cell` points wide,
 * and all below it. Records lie in Morton order in each level, whichever level is first. */
static int encode_below(bake_levels *levels, ff_key key, size_t at, uint32_t cell, bake_known *node)
{
    uint32_t level = ff_key_level(key);
    heights h;
    bake_known child[4];
    if (cell == 1) return 0;
    node->leaf = 1;
    if (!ff_shape_has_ground(levels->info, key)) return leave_out(levels, level);
    decode_children(levels, key, at, cell, &h);
    for (uint32_t q = 0; q < 4; q++) {
        size_t below = child_at(levels, at, cell, q);
        ff_key child_key = ff_key_child(key, q);
        child[q] = levels->know(levels, child_key, below, cell / 2);
        h.residuals.child_error[q] = child[q].code;
        h.residuals.filled |= (uint8_t)(child[q].filled << q);
        if (encode_below(levels, child_key, below, cell / 2, &child[q])) return -1;
    }
    node->leaf = is_leaf(levels, key, node, &h.residuals, child);
    if (node->leaf) return bake_blob_add(&levels->level[level + 1], NULL, 0);
    mark_leaves(levels, key, child, &h.residuals);
    return add_payload(levels, level + 1, h.parent, &h);
}

static void clear(bake_levels *levels)
{
    for (uint32_t l = 0; l < BAKE_LEVELS_MAX; l++) bake_blob_clear(&levels->level[l]);
}

int bake_levels_encode_below(bake_levels *levels, ff_key key, bake_known *node)
{
    clear(levels);
    return encode_below(levels, key, 0, 1u << (levels->bottom - ff_key_level(key)), node);
}

int bake_levels_encode(bake_levels *levels, uint32_t tile)
{
    ff_key key = ff_key_make(tile, 0, 0);
    heights h;
    clear(levels);
    decode_root(levels, tile, &h);
    bake_known root = levels->know(levels, key, 0, root_cell(levels));
    h.residuals.child_error[0] = root.code;
    h.residuals.filled = root.filled;
    if (encode_below(levels, key, 0, root_cell(levels), &root)) return -1;
    h.residuals.leaf = root.leaf && ff_terrain_levels(levels->info) > 1;
    return add_payload(levels, 0, NULL, &h);
}
