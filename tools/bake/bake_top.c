#include "bake_top.h"

#include "../../protocol/shape/ff_shape.h"

#include <string.h>

/* The levels are the first part of a top. */
static bake_known know(const bake_levels *levels, ff_key key, size_t at, uint32_t cell)
{
    (void)at, (void)cell;
    return ((const bake_top *)levels)->known[bake_top_number(key)];
}

int bake_top_open(bake_top *top, const ff_terrain_info *info, uint32_t block_log2)
{
    uint32_t n = info->tile_log2, k = info->node_log2;
    if (block_log2 > n) block_log2 = n;
    if (block_log2 < k) block_log2 = k;
    *top = (bake_top){ .stride_log2 = block_log2 - k, .tile = UINT32_MAX };
    int rc = bake_levels_open(&top->levels, info, n - block_log2,
                              ((size_t)1 << (n - top->stride_log2)) + 1);
    top->levels.know = know;
    return rc;
}

void bake_top_close(bake_top *top) { bake_levels_close(&top->levels); }

static int read_lattice(bake_top *top, const bake_samples *samples, ff_sheet first)
{
    bake_levels *levels = &top->levels;
    size_t pitch = levels->pitch;
    for (size_t j = 0; j < pitch; j++) {
        uint16_t *to = levels->source + j * pitch;
        uint8_t *marks = levels->marks ? levels->marks + j * pitch : NULL;
        uint64_t at = first.y + ((uint64_t)j << top->stride_log2);
        uint64_t before = at - (1u << top->stride_log2);
        if (j && before >= samples->height - 1) { /* the row before is the last one */
            memcpy(to, to - pitch, pitch * sizeof *to);
            if (marks) memcpy(marks, marks - pitch, pitch);
            continue;
        }
        uint32_t from = at < samples->height ? (uint32_t)at : samples->height - 1;
        if (bake_samples_pick(samples, from, first.x, top->stride_log2, pitch, to, marks))
            return -1;
    }
    return 0;
}

int bake_top_load(bake_top *top, const bake_samples *samples, uint32_t tile)
{
    const ff_terrain_info *info = top->levels.info;
    if (top->tile == tile) return 0;
    top->tile = UINT32_MAX;
    ff_sheet first = ff_shape_sheet(info, tile);
    first.x <<= info->tile_log2;
    first.y <<= info->tile_log2;
    if (samples->has_marks && bake_levels_mark(&top->levels, top->levels.pitch)) return -1;
    if (read_lattice(top, samples, first)) return -1;
    bake_levels_decode(&top->levels, tile);
    top->tile = tile;
    return 0;
}

int bake_top_encode(bake_top *top, const bake_known *known)
{
    top->known = known;
    return bake_levels_encode(&top->levels, top->tile);
}

const uint16_t *bake_top_decoded(const bake_top *top, ff_key key)
{
    uint32_t edge_log2 = top->levels.info->node_log2 + top->levels.bottom - ff_key_level(key),
             code = ff_key_code(key);
    size_t column = (size_t)ff_morton_x(code) << edge_log2, row = (size_t)ff_morton_y(code)
                                                                  << edge_log2;
    return top->levels.decoded + row * top->levels.pitch + column;
}
