#include "sim_ground_local.h"
#include "sim_place.h"

#include "../../protocol/shape/ff_shape.h"

#include <stdlib.h>
#include <string.h>

/* ---- decoding ---- */

typedef struct loader {
    const sim_ground *ground;
    uint16_t *height; /* of `ground`, being written */
    uint8_t *filled;
    const ff_pack *pack;
    ff_decoder *decoder;
    int32_t *residual;
    int with_stubs; /* 1: what is below stubs is made, 0: it stays as it is */
    int has_stubs;  /* some were met */
    uint16_t room[FF_CODEC_ROOM_MAX / 2 + 1];
} loader;

static void place(loader *load, ff_key key, const uint16_t *heights, unsigned filled)
{
    const ff_terrain_info *info = &load->pack->header.info;
    uint32_t cells = 1u << info->node_log2, side = cells + 1, along = 1u << load->ground->level;
    uint32_t code = ff_key_code(key);
    ff_sheet at = ff_shape_sheet(info, ff_key_tile(key));
    size_t column = ((size_t)at.x * along + ff_morton_x(code)) * cells;
    size_t row = ((size_t)at.y * along + ff_morton_y(code)) * cells;
    load->filled[row / cells * load->ground->node_columns + column / cells] = (uint8_t)filled;
    size_t columns = load->ground->columns - column < side ? load->ground->columns - column : side;
    for (uint32_t j = 0; j < side && row + j < load->ground->rows; j++)
        memcpy(load->height + (row + j) * load->ground->columns + column,
               heights + (size_t)j * side, columns * sizeof *heights);
}

/* What a payload said of a node: is it filled, is it a leaf, is it a stub? */
typedef struct marks {
    unsigned filled, leaf, stub;
} marks;

static marks marks_of(const ff_residuals *residuals, unsigned quadrant)
{
    return (marks){ residuals->filled >> quadrant & 1u, residuals->leaf >> quadrant & 1u,
                    residuals->stub >> quadrant & 1u };
}

/* The heights of a node's children and their marks: from the pack; below a leaf, predicted; below a
 * stub, on its triangles. */
static int children_of(loader *load, ff_key key, const uint16_t *heights, marks mark,
                       ff_residuals *residuals, uint16_t *refined)
{
    const ff_terrain_info *info = &load->pack->header.info;
    const uint8_t *payload;
    if (mark.leaf) {
        ff_predict_children(info, residuals->cells, heights, refined, load->room);
        *residuals = ff_leaf_residuals(info, 0, (int)mark.filled);
        return FF_OK;
    }
    if (mark.stub) {
        ff_interpolate_children(info, residuals->cells, heights, refined);
        residuals->filled = mark.filled ? 15 : 0;
        residuals->leaf = 0;
        residuals->stub = 15;
        return FF_OK;
    }
    int bytes = ff_pack_record(load->pack, FF_SECTION_REFINEMENT, key, &payload);
    if (bytes < 0) return bytes;
    int rc = ff_decode_refinement(load->decoder, payload, (size_t)bytes, residuals);
    return rc < 0 ? rc : ff_reconstruct_refinement(info, heights, residuals, refined, load->room);
}

static int refine(loader *load, ff_key key, const uint16_t *heights, marks mark)
{
    const ff_terrain_info *info = &load->pack->header.info;
    if (ff_key_level(key) == load->ground->level) {
        place(load, key, heights, mark.filled);
        return FF_OK;
    }
    load->has_stubs |= mark.stub & 1u;
    if (mark.stub && !load->with_stubs) return FF_OK;
    ff_residuals residuals = { .cells = ff_shape_cells(info, key, 1), .value = load->residual };
    uint16_t refined[FF_REFINED_HEIGHTS_MAX], child[FF_NODE_HEIGHTS_MAX];
    int rc = children_of(load, key, heights, mark, &residuals, refined);
    if (rc != FF_OK) return rc;
    for (uint32_t quadrant = 0; quadrant < 4 && rc == FF_OK; quadrant++) {
        if (!ff_shape_has_ground(info, ff_key_child(key, quadrant))) continue;
        ff_refined_child(info, refined, quadrant, child);
        rc = refine(load, ff_key_child(key, quadrant), child, marks_of(&residuals, quadrant));
    }
    return rc;
}

static int decode_tile(loader *load, uint32_t tile)
{
    const uint8_t *payload;
    ff_key key = ff_key_make(tile, 0, 0);
    ff_residuals residuals = { .cells = ff_shape_cells(&load->pack->header.info, key, 0),
                               .value = load->residual };
    uint16_t heights[FF_NODE_HEIGHTS_MAX];
    int bytes = ff_pack_record(load->pack, FF_SECTION_ROOT, key, &payload);
    if (bytes < 0) return bytes;
    int rc = ff_decode_root(load->decoder, payload, (size_t)bytes, &residuals);
    if (rc == FF_OK)
        rc = ff_reconstruct_root(&load->pack->header.info, &residuals, heights, load->room);
    if (rc != FF_OK) return rc;
    return refine(load, ff_key_make(tile, 0, 0), heights, marks_of(&residuals, 0));
}

/* Where a stub meets finer ground its triangles give way: all else is placed over them. */
static int decode_tiles(loader *load)
{
    const ff_terrain_info *info = &load->pack->header.info;
    int rc = FF_OK;
    do {
        load->with_stubs = !load->has_stubs;
        for (uint32_t tile = 0; rc == FF_OK && tile < ff_shape_tiles(info); tile++)
            rc = decode_tile(load, info->first_tile + tile);
    } while (rc == FF_OK && load->with_stubs && load->has_stubs);
    return rc;
}

static int decode_all(sim_ground *ground, const ff_pack *pack)
{
    const ff_terrain_info *info = &pack->header.info;
    size_t bytes = ff_decoder_bytes(info);
    void *memory = malloc(bytes);
    ground->block = malloc((size_t)sim_ground_bytes(ground));
    if (!ground->block) {
        free(memory);
        return FF_ERR_MEMORY;
    }
    sim_ground_lie(ground, ground->block);
    loader load = { .ground = ground,
                    .pack = pack,
                    .height = (uint16_t *)ground->height,
                    .filled = (uint8_t *)ground->filled };
    load.residual = malloc(FF_REFINED_HEIGHTS_MAX * sizeof *load.residual);
    load.decoder = memory ? ff_decoder_create(info, memory, bytes) : NULL;
    int rc = load.decoder && load.residual ? FF_OK : FF_ERR_MEMORY;
    if (rc == FF_OK) rc = decode_tiles(&load);
    free(load.residual);
    free(memory);
    return rc;
}

/* ---- pyramid ---- */

static uint16_t block_of_samples(const sim_ground *ground, uint32_t column, uint32_t row)
{
    uint32_t cells = 1u << SIM_GROUND_PYRAMID_FIRST;
    uint16_t most = 0;
    for (uint32_t j = row * cells; j <= (row + 1) * cells && j < ground->rows; j++)
        for (uint32_t i = column * cells; i <= (column + 1) * cells && i < ground->columns; i++) {
            uint16_t h = ground->height[(size_t)j * ground->columns + i];
            most = h > most ? h : most;
        }
    return most;
}

static uint16_t block_of_blocks(const sim_ground *ground, unsigned below, uint32_t column,
                                uint32_t row)
{
    uint16_t most = 0;
    for (uint32_t j = row * 2; j < row * 2 + 2 && j < ground->pyramid[below].rows; j++)
        for (uint32_t i = column * 2; i < column * 2 + 2 && i < ground->pyramid[below].columns;
             i++) {
            uint16_t h = ground->pyramid[below].max[(size_t)j * ground->pyramid[below].columns + i];
            most = h > most ? h : most;
        }
    return most;
}

static int build_pyramid(sim_ground *ground)
{
    for (unsigned log2 = SIM_GROUND_PYRAMID_FIRST; log2 < SIM_GROUND_PYRAMID_MAX; log2++) {
        uint64_t cells = 1ull << log2;
        uint32_t columns = (uint32_t)((ground->columns - 1 + cells - 1) / cells);
        uint32_t rows = (uint32_t)((ground->rows - 1 + cells - 1) / cells);
        uint16_t *max = malloc((size_t)columns * rows * sizeof *max);
        if (!max) return FF_ERR_MEMORY;
        ground->pyramid[log2].columns = columns;
        ground->pyramid[log2].rows = rows;
        ground->pyramid[log2].max = max;
        ground->top = log2;
        for (uint32_t row = 0; row < rows; row++)
            for (uint32_t column = 0; column < columns; column++)
                max[(size_t)row * columns + column] = log2 == SIM_GROUND_PYRAMID_FIRST
                                                          ? block_of_samples(ground, column, row)
                                                          : block_of_blocks(ground, log2 - 1,
                                                                            column, row);
        if (columns == 1 && rows == 1) break;
    }
    return FF_OK;
}

/* Level, samples and lengths of the finest ground of the pack with at most so many samples. */
static void measure(sim_ground *ground, const ff_terrain_info *info, uint64_t samples_max)
{
    ff_sheet samples = ff_shape_sheet_samples(info);
    for (uint32_t level = 0; level < ff_terrain_levels(info); level++) {
        unsigned cell_log2 = info->tile_log2 - info->node_log2 - level;
        uint32_t columns = ((samples.x - 2) >> cell_log2) + 2,
                 rows = ((samples.y - 2) >> cell_log2) + 2;
        if (level && columns > samples_max / rows) break;
        ground->level = level;
        ground->columns = columns;
        ground->rows = rows;
        ground->size[0] = (double)(samples.x - 1) / (1u << cell_log2);
        ground->size[1] = (double)(samples.y - 1) / (1u << cell_log2);
    }
    ground->node_cells = 1u << info->node_log2;
    ground->node_columns = ((ground->columns - 2) >> info->node_log2) + 1;
    ground->node_rows = ((ground->rows - 2) >> info->node_log2) + 1;
    ground->cell_m = (double)ff_node_cell_wu(info, ground->level) / FF_WU_PER_METRE;
    ground->hscale_m = (double)info->hscale_q24 / (1 << 24);
    ground->west_m = (double)info->west_wu / FF_WU_PER_METRE;
    ground->south_m = (double)info->south_wu / FF_WU_PER_METRE;
    ground->curve_per_m = sim_place_curve_per_m(info);
    ground->hoffset_m = (double)info->hoffset_wu / FF_WU_PER_METRE;
}

int sim_ground_load_cached(sim_ground *ground, const ff_pack *pack, uint64_t samples_max,
                           const char *cache_path)
{
    uint32_t checksum = pack->header.info.checksum;
    int rc = FF_OK;
    memset(ground, 0, sizeof *ground);
    measure(ground, &pack->header.info, samples_max);
    if (!cache_path || !sim_ground_cache_open(ground, checksum, cache_path)) {
        rc = decode_all(ground, pack);
        if (rc == FF_OK && cache_path) rc = sim_ground_cache_write(ground, checksum, cache_path);
    }
    if (rc == FF_OK) rc = build_pyramid(ground);
    if (rc != FF_OK) sim_ground_free(ground);
    return rc;
}

int sim_ground_load(sim_ground *ground, const ff_pack *pack, uint64_t samples_max)
{
    return sim_ground_load_cached(ground, pack, samples_max, NULL);
}

void sim_ground_free(sim_ground *ground)
{
    for (unsigned i = 0; i < SIM_GROUND_PYRAMID_MAX; i++) free(ground->pyramid[i].max);
    free(ground->block);
    if (ground->mapping.bytes) sys_unmap_file(&ground->mapping);
    memset(ground, 0, sizeof *ground);
}

const char *sim_ground_differs(const ff_terrain_info *a, const ff_terrain_info *b)
{
    if (a->samples_x != b->samples_x || a->samples_y != b->samples_y)
        return "it has another number of samples";
    if (a->spacing_wu != b->spacing_wu) return "its samples lie otherwise apart";
    if (a->epsg != b->epsg || a->origin_x_mm != b->origin_x_mm || a->origin_y_mm != b->origin_y_mm)
        return "it lies elsewhere";
    if (a->curve_q60 != b->curve_q60) return "it falls away otherwise";
    return NULL;
}
