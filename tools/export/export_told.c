/* What the nodes of a pack tell: geometric errors, and where ground was filled. */
#include "../../protocol/shape/ff_shape.h"
#include "../bake/bake_say.h"
#include "export_ground_local.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const ff_terrain_info *info_of(const export_ground *ground)
{
    return &ground->unpack->pack.header.info;
}

/* ---- geometric errors ---- */

typedef struct error_search {
    const export_ground *ground;
    uint32_t samples, between; /* the largest in steps, at samples and on the triangles */
} error_search;

static void raise(uint32_t *most, uint32_t steps)
{
    if (steps > *most) *most = steps;
}

/* 1 when the window shows more of a node than its rim: what lies on that is known as well as by the
 * best of the nodes that share it. */
static int in_window(const export_ground *ground, ff_key key)
{
    const export_window *w = &ground->window;
    const ff_terrain_info *info = info_of(ground);
    ff_sheet tile = ff_shape_sheet(info, ff_key_tile(key));
    uint32_t level = ff_key_level(key), log2 = info->tile_log2 - level,
             skip = ff_terrain_levels(info) - 1 - ground->level;
    uint64_t column = (((uint64_t)tile.x << level) + ff_morton_x(ff_key_code(key))) << log2,
             row = (((uint64_t)tile.y << level) + ff_morton_y(ff_key_code(key))) << log2,
             edge = UINT64_C(1) << log2;
    return column < (uint64_t)(w->left + w->width - 1) << skip &&
           column + edge > (uint64_t)w->left << skip &&
           row < (uint64_t)(w->bottom + w->height - 1) << skip &&
           row + edge > (uint64_t)w->bottom << skip;
}

/* Of the nodes of the level, those below `key`. Samples below a stub lie on its triangles, up to a
 * step above them. */
static int search_below(error_search *search, ff_key key, const bake_told *node)
{
    bake_told told[4];
    uint32_t steps = ff_geometric_error_decode(node->error_code);
    if (!export_meets_samples(search->ground, key)) return 0;
    if (ff_key_level(key) == search->ground->level) {
        raise(&search->between, steps);
        return 0;
    }
    if (node->is_stub) {
        if (in_window(search->ground, key)) raise(&search->samples, steps + 1);
        return 0;
    }
    if (bake_unpack_told_below(search->ground->unpack, key, node, told)) return -1;
    for (uint32_t q = 0; q < 4; q++)
        if (search_below(search, ff_key_child(key, q), &told[q])) return -1;
    return 0;
}

static int search_tile(error_search *search, uint32_t tile)
{
    bake_told root;
    if (!export_meets_samples(search->ground, ff_key_make(tile, 0, 0))) return 0;
    if (bake_unpack_told_root(search->ground->unpack, tile, &root)) return -1;
    return search_below(search, ff_key_make(tile, 0, 0), &root);
}

int export_told_error(const export_ground *ground, export_error *error)
{
    error_search search = { ground, info_of(ground)->max_error, 0 };
    int rc = 0;
    for (uint32_t tile = 0; !rc && tile < ff_shape_tiles(info_of(ground)); tile++)
        rc = search_tile(&search, tile);
    /* there is nothing between the finest samples */
    if (ground->level + 1 == ff_terrain_levels(info_of(ground))) search.between = 0;
    raise(&search.between, search.samples);
    *error = (export_error){ search.samples * ground->scale, search.between * ground->scale };
    return rc;
}

/* ---- filled ground ---- */

/* Nodes of the finest level that have ground, a byte each, row 0 south: 1 where some of it was
 * filled. */
typedef struct filled_nodes {
    const export_ground *ground;
    bake_grid nodes;
    int found;
} filled_nodes;

static int mark_node(filled_nodes *filled, ff_key key)
{
    uint32_t level = ff_key_level(key);
    ff_sheet at = ff_shape_sheet(info_of(filled->ground), ff_key_tile(key));
    uint8_t one = 1;
    filled->found = 1;
    return bake_grid_write(&filled->nodes, (at.y << level) + ff_morton_y(ff_key_code(key)),
                           (at.x << level) + ff_morton_x(ff_key_code(key)), 1, &one);
}

/* Goes down where something was filled. */
static int mark_below(filled_nodes *filled, ff_key key, const bake_told *node)
{
    bake_told told[4];
    if (!export_meets_samples(filled->ground, key)) return 0;
    if (ff_key_level(key) + 1 == ff_terrain_levels(info_of(filled->ground)))
        return mark_node(filled, key);
    if (bake_unpack_told_below(filled->ground->unpack, key, node, told)) return -1;
    for (uint32_t q = 0; q < 4; q++)
        if (told[q].has_filled && mark_below(filled, ff_key_child(key, q), &told[q])) return -1;
    return 0;
}

static int mark_tile(filled_nodes *filled, uint32_t tile)
{
    bake_told root;
    if (!export_meets_samples(filled->ground, ff_key_make(tile, 0, 0))) return 0;
    if (bake_unpack_told_root(filled->ground->unpack, tile, &root)) return -1;
    return root.has_filled ? mark_below(filled, ff_key_make(tile, 0, 0), &root) : 0;
}

/* Clears the marks of samples that touch a node of this row that is all measured: had they been
 * filled, that node would tell. */
static void keep_touched(const export_ground *ground, const uint8_t *nodes, uint32_t count,
                         uint8_t *row)
{
    const ff_terrain_info *info = info_of(ground);
    uint32_t skip = ff_terrain_levels(info) - 1 - ground->level, k = info->node_log2;
    for (uint32_t i = 0; i < ground->window.width; i++) {
        uint64_t sample = (uint64_t)(ground->window.left + i) << skip, node = sample >> k;
        int on_rim = (sample & ((1u << k) - 1)) == 0;
        if (node < count && !nodes[node]) row[i] = EXPORT_MEASURED;
        if (on_rim && node > 0 && !nodes[node - 1]) row[i] = EXPORT_MEASURED;
    }
}

static int spread_row(const filled_nodes *filled, uint32_t j, uint8_t *nodes, uint8_t *row)
{
    const ff_terrain_info *info = info_of(filled->ground);
    uint32_t skip = ff_terrain_levels(info) - 1 - filled->ground->level, k = info->node_log2;
    uint64_t sample = (uint64_t)(filled->ground->window.bottom + j) << skip, node = sample >> k;
    int on_rim = (sample & ((1u << k) - 1)) == 0;
    memset(row, EXPORT_FILLED, filled->ground->window.width);
    for (uint64_t n = on_rim && node ? node - 1 : node; n <= node; n++) {
        if (n >= filled->nodes.height) continue;
        if (bake_grid_read(&filled->nodes, (uint32_t)n, 0, filled->nodes.width, nodes)) return -1;
        keep_touched(filled->ground, nodes, filled->nodes.width, row);
    }
    return 0;
}

static int spread(const filled_nodes *filled, bake_grid *mask)
{
    const export_window *w = &filled->ground->window;
    uint8_t *nodes = malloc(filled->nodes.width), *row = malloc(w->width);
    int rc = nodes && row ? bake_grid_open(mask, w->width, w->height, 1)
                          : bake_fail("out of memory");
    for (uint32_t j = 0; !rc && j < w->height; j++) {
        rc = spread_row(filled, j, nodes, row);
        if (!rc) rc = bake_grid_write(mask, w->height - 1 - j, 0, w->width, row);
    }
    free(nodes);
    free(row);
    return rc;
}

int export_told_filled(const export_ground *ground, bake_grid *mask)
{
    const ff_terrain_info *info = info_of(ground);
    ff_sheet samples = ff_shape_sheet_samples(info);
    filled_nodes filled = { .ground = ground };
    if (bake_grid_open(&filled.nodes, ((samples.x - 2) >> info->node_log2) + 1,
                       ((samples.y - 2) >> info->node_log2) + 1, 1))
        return -1;
    int rc = 0;
    if (ftruncate(filled.nodes.fd, (off_t)filled.nodes.width * filled.nodes.height))
        rc = bake_fail("cannot make a temporary file: %s", strerror(errno));
    for (uint32_t tile = 0; !rc && tile < ff_shape_tiles(info); tile++)
        rc = mark_tile(&filled, tile);
    if (!rc && filled.found) rc = spread(&filled, mask);
    bake_grid_close(&filled.nodes);
    return rc;
}
