#include "export_mesh_tile.h"

#include <math.h>
#include <string.h>

#define RADIANS 0.017453292519943295
#define EARTH_M 6371000.0
#define UNUSED  UINT32_MAX

/* Reads a tile and measures what its points may be left out with. */
static int measure(const mesh_ground *ground, uint32_t zoom, uint32_t x, uint32_t y,
                   mesh_tile *tile)
{
    double cell = mesh_ground_cell(zoom), cell_m[MESH_SIDE];
    if (mesh_ground_read(ground, zoom, x, y, tile->block)) return -1;
    for (int j = 0; j < MESH_SIDE; j++) {
        double latitude = -90 + cell * ((double)y * MESH_CELLS + j);
        cell_m[j] = cell * RADIANS * EARTH_M * fmax(cos(latitude * RADIANS), 0);
        for (int i = 0; i < MESH_SIDE; i++) {
            float height = tile->block[(j + 1) * MESH_BLOCK_SIDE + i + 1];
            tile->height[j * MESH_SIDE + i] = isnan(height) ? 0 : height;
        }
    }
    mesh_rtin_measure(tile->height, cell_m, cell * RADIANS * EARTH_M, &tile->rtin);
    return 0;
}

/* The points that the tiles next to this one use on their common sides. `tile` is overwritten. */
static int ask_neighbours(const mesh_ground *ground, const mesh_range *range, uint32_t zoom,
                          uint32_t x, uint32_t y, float error_m, mesh_tile *tile, mesh_sides *sides)
{
    static const int step_x[] = { -1, 1, 0, 0 }, step_y[] = { 0, 0, -1, 1 };
    memset(sides, 0, sizeof *sides);
    for (int side = 0; side < MESH_SIDES; side++) {
        int64_t to_x = (int64_t)x + step_x[side], to_y = (int64_t)y + step_y[side];
        mesh_sides theirs;
        if (to_x < range->west || to_x > range->east || to_y < range->south || to_y > range->north)
            continue;
        if (measure(ground, zoom, (uint32_t)to_x, (uint32_t)to_y, tile)) return -1;
        mesh_rtin_sides(&tile->rtin, error_m, &theirs);
        memcpy(sides->used[side], theirs.used[side ^ 1], sizeof sides->used[side]);
    }
    return 0;
}

/* The ground's normal at a point, from the points around it, in Earth-centred axes. */
static void find_normal(const mesh_tile *tile, uint32_t zoom, uint32_t x, uint32_t y, int i, int j,
                        float normal[3])
{
    const float *at = tile->block + (j + 1) * MESH_BLOCK_SIDE + i + 1;
    double cell = mesh_ground_cell(zoom), longitude = -180 + cell * ((double)x * MESH_CELLS + i),
           latitude = -90 + cell * ((double)y * MESH_CELLS + j), cell_m = cell * RADIANS * EARTH_M;
    double sl = sin(longitude * RADIANS), cl = cos(longitude * RADIANS),
           sp = sin(latitude * RADIANS), cp = cos(latitude * RADIANS);
    double four[4] = { at[-1], at[1], at[-MESH_BLOCK_SIDE], at[MESH_BLOCK_SIDE] };
    for (int n = 0; n < 4; n++)
        if (isnan(four[n])) four[n] = isnan(*at) ? 0 : *at;
    double east = -(four[1] - four[0]) / (2 * cell_m * fmax(cp, 1e-6)),
           north = -(four[3] - four[2]) / (2 * cell_m);
    double size = sqrt(east * east + north * north + 1);
    normal[0] = (float)((-east * sl - north * sp * cl + cp * cl) / size);
    normal[1] = (float)((east * cl - north * sp * sl + cp * sl) / size);
    normal[2] = (float)((north * cp + sp) / size);
}

/* Numbers the points in the order in which triangles use them. */
static uint32_t number_points(mesh_tile *tile)
{
    uint32_t count = 0;
    memset(tile->number, 0xff, sizeof tile->number);
    for (uint32_t i = 0; i < 3 * tile->rtin.triangle_count; i++) {
        uint32_t point = tile->rtin.index[i];
        if (tile->number[point] == UNUSED) tile->number[point] = count++;
        tile->index[i] = tile->number[point];
    }
    return count;
}

static uint16_t quantise(double part) { return (uint16_t)lrint(part * QUANTIZED_MESH_MAX); }

/* Makes vertices of the points that are used. */
static void place_points(mesh_tile *tile, uint32_t zoom, uint32_t x, uint32_t y)
{
    quantized_bounds *b = &tile->mesh.bounds;
    float low = INFINITY, high = -INFINITY;
    for (int p = 0; p < MESH_POINTS; p++) {
        if (tile->number[p] == UNUSED) continue;
        low = fminf(low, tile->height[p]);
        high = fmaxf(high, tile->height[p]);
    }
    b->low_m = low;
    b->high_m = high;
    for (int p = 0; p < MESH_POINTS; p++) {
        if (tile->number[p] == UNUSED) continue;
        quantized_vertex *vertex = &tile->vertex[tile->number[p]];
        double part = high > low ? ((double)tile->height[p] - low) / ((double)high - low) : 0;
        vertex->u = quantise(p % MESH_SIDE / (double)MESH_CELLS);
        vertex->v = quantise(p / MESH_SIDE / (double)MESH_CELLS);
        vertex->h = quantise(part);
        tile->decoded[p] = (float)(low + ((double)high - low) * vertex->h / QUANTIZED_MESH_MAX);
        if (tile->mesh.has_normals)
            find_normal(tile, zoom, x, y, p % MESH_SIDE, p / MESH_SIDE, vertex->normal);
    }
}

int mesh_tile_make(const mesh_ground *ground, const mesh_range *range, uint32_t zoom, uint32_t x,
                   uint32_t y, float error_m, int has_normals, mesh_tile *tile)
{
    mesh_sides theirs;
    if (ask_neighbours(ground, range, zoom, x, y, error_m, tile, &theirs)) return -1;
    if (measure(ground, zoom, x, y, tile)) return -1;
    mesh_rtin_sides(&tile->rtin, error_m, &tile->sides);
    for (int s = 0; s < MESH_SIDES; s++)
        for (int i = 0; i < MESH_SIDE; i++) tile->sides.used[s][i] |= theirs.used[s][i];
    mesh_rtin_triangulate(&tile->rtin, error_m, &tile->sides);
    double edge = mesh_ground_cell(zoom) * MESH_CELLS, west = -180 + edge * x,
           south = -90 + edge * y;
    tile->mesh = (quantized_mesh){ .bounds = { west, south, west + edge, south + edge, 0, 0 },
                                   .vertex = tile->vertex,
                                   .vertex_count = number_points(tile),
                                   .index = tile->index,
                                   .triangle_count = tile->rtin.triangle_count,
                                   .has_normals = has_normals };
    place_points(tile, zoom, x, y);
    return 0;
}
