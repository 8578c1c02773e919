#include "sim_ground_local.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- decoding ---- */

typedef struct loader {
    const sim_ground *ground;
    uint16_t *height; /* of `ground`, being written */
    const ff_pack *pack;
    ff_decoder *decoder;
    int32_t *residual;
} loader;

static void place(loader *load, ff_key key, const uint16_t *heights)
{
    const ff_terrain_info *info = &load->pack->header.info;
    uint32_t cells = 1u << info->node_log2, side = cells + 1, along = 1u << load->ground->level;
    uint32_t tile = ff_key_tile(key), code = ff_key_code(key);
    size_t column = ((size_t)(tile % info->tiles_x) * along + ff_morton_x(code)) * cells;
    size_t row = ((size_t)(tile / info->tiles_x) * along + ff_morton_y(code)) * cells;
    for (uint32_t j = 0; j < side; j++)
        memcpy(load->height + (row + j) * load->ground->columns + column,
               heights + (size_t)j * side, side * sizeof *heights);
}

static int refine(loader *load, ff_key key, const uint16_t *heights)
{
    const ff_terrain_info *info = &load->pack->header.info;
    if (ff_key_level(key) == load->ground->level) {
        place(load, key, heights);
        return FF_OK;
    }
    const uint8_t *payload;
    ff_residuals residuals = { .value = load->residual };
    uint16_t refined[FF_REFINED_HEIGHTS_MAX], child[FF_NODE_HEIGHTS_MAX];
    int bytes = ff_pack_record(load->pack, FF_SECTION_REFINEMENT, key, &payload);
    if (bytes < 0) return bytes;
    int rc = ff_decode_refinement(load->decoder, payload, (size_t)bytes, &residuals);
    if (rc == FF_OK) rc = ff_reconstruct_refinement(info, heights, &residuals, refined);
    if (rc != FF_OK) return rc;
    for (uint32_t quadrant = 0; quadrant < 4 && rc == FF_OK; quadrant++) {
        ff_refined_child(info, refined, quadrant, child);
        rc = refine(load, ff_key_child(key, quadrant), child);
    }
    return rc;
}

static int decode_tile(loader *load, uint32_t tile)
{
    const uint8_t *payload;
    ff_residuals residuals = { .value = load->residual };
    uint16_t heights[FF_NODE_HEIGHTS_MAX];
    int bytes = ff_pack_record(load->pack, FF_SECTION_ROOT, ff_key_make(tile, 0, 0), &payload);
    if (bytes < 0) return bytes;
    int rc = ff_decode_root(load->decoder, payload, (size_t)bytes, &residuals);
    if (rc == FF_OK) rc = ff_reconstruct_root(&load->pack->header.info, &residuals, heights);
    if (rc != FF_OK) return rc;
    return refine(load, ff_key_make(tile, 0, 0), heights);
}

static int decode_all(sim_ground *ground, const ff_pack *pack)
{
    const ff_terrain_info *info = &pack->header.info;
    size_t bytes = ff_decoder_bytes(info);
    void *memory = malloc(bytes);
    ground->block = malloc(sizeof(sim_ground_head) +
                           (size_t)ground->columns * ground->rows * sizeof *ground->height);
    if (!ground->block) {
        free(memory);
        return FF_ERR_MEMORY;
    }
    loader load = { .ground = ground,
                    .pack = pack,
                    .height = (uint16_t *)((uint8_t *)ground->block + sizeof(sim_ground_head)) };
    ground->height = load.height;
    load.residual = malloc(FF_REFINED_HEIGHTS_MAX * sizeof *load.residual);
    load.decoder = memory ? ff_decoder_create(info, memory, bytes) : NULL;
    int rc = load.decoder && load.residual ? FF_OK : FF_ERR_MEMORY;
    for (uint32_t tile = 0; rc == FF_OK && tile < info->tiles_x * info->tiles_y; tile++)
        rc = decode_tile(&load, tile);
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

int sim_ground_load_cached(sim_ground *ground, const ff_pack *pack, uint64_t samples_max,
                           const char *cache_path)
{
    const ff_terrain_info *info = &pack->header.info;
    uint32_t level = 0;
    memset(ground, 0, sizeof *ground);
    for (uint32_t next = 1; next < ff_terrain_levels(info); next++) {
        uint64_t columns = ((uint64_t)info->tiles_x << (info->node_log2 + next)) + 1;
        uint64_t rows = ((uint64_t)info->tiles_y << (info->node_log2 + next)) + 1;
        if (columns > samples_max / rows) break;
        level = next;
    }
    ground->level = level;
    ground->columns = (info->tiles_x << (info->node_log2 + level)) + 1;
    ground->rows = (info->tiles_y << (info->node_log2 + level)) + 1;
    ground->cell_m = (double)ff_node_cell_wu(info, level) / FF_WU_PER_METRE;
    ground->hscale_m = (double)info->hscale_q24 / (1 << 24);
    ground->hoffset_m = (double)info->hoffset_wu / FF_WU_PER_METRE;
    int rc = FF_OK;
    if (!cache_path || !sim_ground_cache_open(ground, info->checksum, cache_path)) {
        rc = decode_all(ground, pack);
        if (rc == FF_OK && cache_path)
            rc = sim_ground_cache_write(ground, info->checksum, cache_path);
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

/* ---- asking ---- */

static double sample_m(const sim_ground *ground, uint32_t column, uint32_t row)
{
    return ground->hoffset_m +
           ground->hscale_m * ground->height[(size_t)row * ground->columns + column];
}

/* Height of one of a cell's two triangles' planes at (u, v) within the cell, 0..1. */
static double plane_m(const sim_ground *ground, uint32_t column, uint32_t row, int south_east,
                      double u, double v)
{
    double sw = sample_m(ground, column, row), ne = sample_m(ground, column + 1, row + 1);
    if (south_east) {
        double se = sample_m(ground, column + 1, row);
        return sw + u * (se - sw) + v * (ne - se);
    }
    double nw = sample_m(ground, column, row + 1);
    return sw + v * (nw - sw) + u * (ne - nw);
}

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

double sim_ground_height_m(const sim_ground *ground, double x_m, double y_m)
{
    double x = clamp(x_m / ground->cell_m, 0, ground->columns - 1),
           y = clamp(y_m / ground->cell_m, 0, ground->rows - 1);
    uint32_t column = (uint32_t)clamp(floor(x), 0, ground->columns - 2),
             row = (uint32_t)clamp(floor(y), 0, ground->rows - 2);
    double u = x - column, v = y - row;
    return plane_m(ground, column, row, u >= v, u, v);
}

/* A ray in cells (x, y) and metres (z). */
typedef struct ray {
    const sim_ground *ground;
    double from[3], along[3];
} ray;

/* First ground on t0..t1 under one triangle's plane: linear in t. */
static int cast_plane(const ray *r, uint32_t column, uint32_t row, int south_east, double t0,
                      double t1, double *t_hit)
{
    double above[2], t[2] = { t0, t1 };
    for (int i = 0; i < 2; i++)
        above[i] = r->from[2] + t[i] * r->along[2] -
                   plane_m(r->ground, column, row, south_east,
                           r->from[0] + t[i] * r->along[0] - column,
                           r->from[1] + t[i] * r->along[1] - row);
    if (above[0] > 0 && above[1] > 0) return 0;
    *t_hit = above[0] <= 0 ? t0 : t0 + (t1 - t0) * above[0] / (above[0] - above[1]);
    return 1;
}

static int cast_cell(const ray *r, uint32_t column, uint32_t row, double t0, double t1,
                     double *t_hit)
{
    if (column >= r->ground->columns - 1 || row >= r->ground->rows - 1) return 0;
    /* u - v along the ray */
    double difference = (r->from[0] - column) - (r->from[1] - row),
           slope = r->along[0] - r->along[1];
    double crossing = slope != 0 ? -difference / slope : INFINITY;
    if (crossing > t0 && crossing < t1) {
        int first = difference + (t0 + crossing) / 2 * slope >= 0;
        return cast_plane(r, column, row, first, t0, crossing, t_hit) ||
               cast_plane(r, column, row, !first, crossing, t1, t_hit);
    }
    return cast_plane(r, column, row, difference + (t0 + t1) / 2 * slope >= 0, t0, t1, t_hit);
}

/* Looks for ground in the block (column, row) of 2^log2 cells a side, which the ray crosses on
 * t0..t1: in its quarters, in the ray's order. */
static int cast_block(const ray *r, unsigned log2, uint32_t column, uint32_t row, double t0,
                      double t1, double *t_hit)
{
    const sim_ground *ground = r->ground;
    if (log2 >= SIM_GROUND_PYRAMID_FIRST) {
        if (column >= ground->pyramid[log2].columns || row >= ground->pyramid[log2].rows) return 0;
        double lowest = r->from[2] + (r->along[2] < 0 ? t1 : t0) * r->along[2];
        uint16_t most =
            ground->pyramid[log2].max[(size_t)row * ground->pyramid[log2].columns + column];
        if (lowest > ground->hoffset_m + ground->hscale_m * most) return 0;
    }
    if (!log2) return cast_cell(r, column, row, t0, t1, t_hit);
    double middle_x = (double)((uint64_t)(column * 2 + 1) << (log2 - 1)),
           middle_y = (double)((uint64_t)(row * 2 + 1) << (log2 - 1));
    double at[4] = { t0, t0, t0, t1 };
    int count = 1;
    double cross_x = r->along[0] != 0 ? (middle_x - r->from[0]) / r->along[0] : -1;
    double cross_y = r->along[1] != 0 ? (middle_y - r->from[1]) / r->along[1] : -1;
    double early = fmin(cross_x, cross_y), late = fmax(cross_x, cross_y);
    if (early > t0 && early < t1) at[count++] = early;
    if (late > t0 && late < t1 && late > early) at[count++] = late;
    at[count] = t1;
    for (int i = 0; i < count; i++) {
        double t = (at[i] + at[i + 1]) / 2;
        uint32_t east = r->from[0] + t * r->along[0] >= middle_x,
                 north = r->from[1] + t * r->along[1] >= middle_y;
        if (cast_block(r, log2 - 1, column * 2 + east, row * 2 + north, at[i], at[i + 1], t_hit))
            return 1;
    }
    return 0;
}

int sim_ground_cast(const sim_ground *ground, const double from_m[3], const double direction[3],
                    double t_max, double *t_hit)
{
    ray r = { .ground = ground };
    double t0 = 0, t1 = t_max;
    const double size[2] = { ground->columns - 1, ground->rows - 1 };
    for (int axis = 0; axis < 3; axis++) {
        double scale = axis < 2 ? ground->cell_m : 1;
        r.from[axis] = from_m[axis] / scale;
        r.along[axis] = direction[axis] / scale;
    }
    for (int axis = 0; axis < 2; axis++) { /* the part of the ray over the ground */
        if (r.along[axis] == 0) {
            if (r.from[axis] < 0 || r.from[axis] > size[axis]) return 0;
            continue;
        }
        double a = -r.from[axis] / r.along[axis], b = (size[axis] - r.from[axis]) / r.along[axis];
        t0 = fmax(t0, fmin(a, b));
        t1 = fmin(t1, fmax(a, b));
    }
    return t0 < t1 && cast_block(&r, ground->top, 0, 0, t0, t1, t_hit);
}
