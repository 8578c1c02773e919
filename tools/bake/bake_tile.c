#include "bake_tile.h"

#include "../../protocol/shape/ff_shape.h"
#include "bake_error.h"
#include "bake_say.h"

#include <stdlib.h>
#include <string.h>

static size_t pitch_of(const ff_terrain_info *info) { return ((size_t)1 << info->tile_log2) + 1; }

int bake_tile_open(bake_tile *tile, const ff_terrain_info *info)
{
    size_t samples = pitch_of(info) * pitch_of(info);
    *tile = (bake_tile){ .info = info };
    tile->source = malloc(samples * sizeof *tile->source);
    tile->decoded = malloc(samples * sizeof *tile->decoded);
    if (tile->source && tile->decoded) return 0;
    bake_tile_close(tile);
    return bake_fail("out of memory");
}

void bake_tile_close(bake_tile *tile)
{
    free(tile->source);
    free(tile->decoded);
    free(tile->filled);
    for (int i = 0; i < BAKE_LEVELS_MAX; i++) bake_blob_free(&tile->level[i]);
    *tile = (bake_tile){ 0 };
}

/* The part of the tile that is ground; 0 beyond it. */
static int load_filled(bake_tile *tile, const bake_grid *filled, uint32_t first_column,
                       uint32_t first_row, uint32_t columns)
{
    size_t pitch = pitch_of(tile->info);
    if (!tile->filled) tile->filled = malloc(pitch * pitch);
    if (!tile->filled) return bake_fail("out of memory");
    memset(tile->filled, 0, pitch * pitch);
    for (size_t row = 0; row < pitch && first_row + row < filled->height; row++)
        if (bake_grid_read(filled, first_row + (uint32_t)row, first_column, columns,
                           tile->filled + row * pitch))
            return -1;
    return 0;
}

int bake_tile_load(bake_tile *tile, const bake_grid *grid, const bake_grid *filled, uint32_t number)
{
    const ff_terrain_info *info = tile->info;
    size_t pitch = pitch_of(info);
    ff_sheet at = ff_shape_sheet(info, number);
    tile->number = number;
    uint32_t first_column = at.x << info->tile_log2, first_row = at.y << info->tile_log2;
    /* There are no tiles beyond the last sample (ff_terrain_info), so this one has at least one
     * column and one row. */
    uint32_t columns = grid->width - first_column < pitch ? grid->width - first_column
                                                          : (uint32_t)pitch;
    for (size_t row = 0; row < pitch; row++) {
        uint16_t *to = tile->source + row * pitch;
        if (first_row + row >= grid->height) {
            memcpy(to, to - pitch, pitch * sizeof *to);
            continue;
        }
        if (bake_grid_read(grid, first_row + (uint32_t)row, first_column, columns, to)) return -1;
        for (size_t i = columns; i < pitch; i++) to[i] = to[columns - 1];
    }
    return filled->fd < 0 ? 0 : load_filled(tile, filled, first_column, first_row, columns);
}

/* Copies a square of `side` samples, `stride` apart, from a tile's grid; scatter copies it back. */
static void gather(const uint16_t *grid, size_t pitch, uint32_t side, size_t stride, uint16_t *out)
{
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) *out++ = grid[j * stride * pitch + i * stride];
}

static void scatter(const uint16_t *in, size_t pitch, uint32_t side, size_t stride, uint16_t *grid)
{
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) grid[j * stride * pitch + i * stride] = *in++;
}

/* Of the node whose south-west sample is `at`, its cells `cell` samples wide; 0 for padding. */
static uint8_t error_code(const bake_tile *tile, ff_key key, size_t at, uint32_t cell)
{
    return ff_geometric_error_encode(bake_node_error(tile->source + at, tile->decoded + at,
                                                     pitch_of(tile->info),
                                                     ff_shape_extent(tile->info, key), cell));
}

/* 1 when a sample of the node's ground was filled. */
static unsigned is_filled(const bake_tile *tile, ff_key key, size_t at)
{
    ff_extent extent = ff_shape_extent(tile->info, key);
    if (!tile->filled || !ff_shape_has_ground(tile->info, key)) return 0;
    for (uint32_t row = 0; row <= extent.rows; row++)
        if (memchr(tile->filled + at + row * pitch_of(tile->info), 1, extent.columns + 1)) return 1;
    return 0;
}

/* Appends the payload of a root or refinement, error codes filled in, to a level's records. */
static int add_payload(bake_tile *tile, uint32_t level, const uint16_t *parent,
                       const uint16_t *decoded, const ff_residuals *residuals)
{
    uint8_t payload[FF_PAYLOAD_BYTES_MAX];
    int bytes = ff_encode_payload(tile->info, parent, decoded, residuals, payload);
    if (bytes < 0)
        return bake_fail("cannot encode a %s: %s", parent ? "node" : "root", ff_error_text(bytes));
    return bake_blob_add(&tile->level[level], payload, (size_t)bytes);
}

/* What is known of a node before its children are looked at, and `leaf`, what is found out below:
 * nothing finer need be stored. */
typedef struct encoded {
    uint8_t code;
    unsigned filled, leaf;
} encoded;

/* Appends no record for a node, and none for all below it. */
static int leave_out(bake_tile *tile, uint32_t level)
{
    uint64_t count = 1;
    for (uint32_t l = level + 1; l < ff_terrain_levels(tile->info); l++, count *= 4)
        for (uint64_t i = 0; i < count; i++)
            if (bake_blob_add(&tile->level[l], NULL, 0)) return -1;
    return 0;
}

/* Is a node all prediction: its own refinement, which leads to `child`, and all below? */
static unsigned is_leaf(const bake_tile *tile, ff_key key, const encoded *node,
                        const ff_residuals *residuals, const encoded child[4])
{
    for (uint32_t i = 0; i < residuals->count; i++)
        if (residuals->value[i] != 0) return 0;
    for (uint32_t q = 0; q < 4; q++)
        if (ff_shape_has_ground(tile->info, ff_key_child(key, q)) &&
            (!child[q].leaf || child[q].filled != node->filled ||
             child[q].code > ff_geometric_error_below(tile->info, node->code)))
            return 0;
    return 1;
}

/* Marks the children that are leaves. Those of the finest level are not marked. Those without
 * ground are when it makes all alike. */
static void mark_leaves(const bake_tile *tile, ff_key key, const encoded child[4],
                        ff_residuals *residuals)
{
    unsigned ground = 0;
    if (ff_key_level(key) + 2 >= ff_terrain_levels(tile->info)) return;
    for (uint32_t q = 0; q < 4; q++)
        ground |= (unsigned)(ff_shape_has_ground(tile->info, ff_key_child(key, q)) != 0) << q;
    for (uint32_t q = 0; q < 4; q++) residuals->leaf |= (uint8_t)(child[q].leaf << q);
    residuals->leaf &= (uint8_t)ground;
    if (residuals->leaf == ground) residuals->leaf = 15;
}

/* Encodes the refinement of the node whose south-west sample is `at`, its cells `cell` samples
 * wide, and all below it. Records lie in Morton order in each level, whichever level is first. */
static int encode_below(bake_tile *tile, ff_key key, size_t at, uint32_t cell, encoded *node)
{
    const ff_terrain_info *info = tile->info;
    uint16_t parent[FF_NODE_HEIGHTS_MAX], source[FF_REFINED_HEIGHTS_MAX],
        decoded[FF_REFINED_HEIGHTS_MAX];
    int32_t value[FF_REFINED_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    encoded child[4];
    size_t pitch = pitch_of(info), edge = (size_t)(cell / 2) << info->node_log2;
    node->leaf = 1;
    if (cell == 1) return 0;
    if (!ff_shape_has_ground(info, key)) return leave_out(tile, ff_key_level(key));
    gather(tile->decoded + at, pitch, ff_node_side(info), cell, parent);
    gather(tile->source + at, pitch, ff_refined_side(info), cell / 2, source);
    residuals.cells = ff_shape_cells(info, key, 1);
    ff_encode_heights(info, parent, source, &residuals, decoded);
    scatter(decoded, pitch, ff_refined_side(info), cell / 2, tile->decoded + at);
    for (uint32_t q = 0; q < 4; q++) {
        size_t below = at + (q & 1) * edge + (q >> 1) * edge * pitch;
        ff_key child_key = ff_key_child(key, q);
        child[q].code = residuals.child_error[q] = error_code(tile, child_key, below, cell / 2);
        child[q].filled = is_filled(tile, child_key, below);
        residuals.filled |= (uint8_t)(child[q].filled << q);
        if (encode_below(tile, child_key, below, cell / 2, &child[q])) return -1;
    }
    node->leaf = is_leaf(tile, key, node, &residuals, child);
    if (node->leaf) return bake_blob_add(&tile->level[ff_key_level(key) + 1], NULL, 0);
    mark_leaves(tile, key, child, &residuals);
    return add_payload(tile, ff_key_level(key) + 1, parent, decoded, &residuals);
}

static int encode_root(bake_tile *tile)
{
    const ff_terrain_info *info = tile->info;
    uint16_t source[FF_NODE_HEIGHTS_MAX], decoded[FF_NODE_HEIGHTS_MAX];
    int32_t value[FF_NODE_HEIGHTS_MAX];
    ff_residuals residuals = { .value = value };
    uint32_t side = ff_node_side(info), cell = 1u << (info->tile_log2 - info->node_log2);
    gather(tile->source, pitch_of(info), side, cell, source);
    residuals.cells = ff_shape_cells(info, ff_key_make(tile->number, 0, 0), 0);
    ff_encode_heights(info, NULL, source, &residuals, decoded);
    scatter(decoded, pitch_of(info), side, cell, tile->decoded);
    ff_key key = ff_key_make(tile->number, 0, 0);
    residuals.child_error[0] = error_code(tile, key, 0, cell);
    residuals.filled = (uint8_t)is_filled(tile, key, 0);
    encoded root = { residuals.child_error[0], residuals.filled, 0 };
    if (encode_below(tile, key, 0, cell, &root)) return -1;
    residuals.leaf = (uint8_t)(root.leaf && ff_terrain_levels(info) > 1);
    return add_payload(tile, 0, NULL, decoded, &residuals);
}

int bake_tile_encode(bake_tile *tile)
{
    for (uint32_t l = 0; l < BAKE_LEVELS_MAX; l++) bake_blob_clear(&tile->level[l]);
    return encode_root(tile);
}
