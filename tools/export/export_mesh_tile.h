/* One tile's mesh: from the points of the ground to bytes. */
#ifndef EXPORT_MESH_TILE_H
#define EXPORT_MESH_TILE_H

#include "mesh_probes.h"
#include "quantized_mesh.h"

/* The memory in which tiles are made. */
typedef struct mesh_tile {
    float block[MESH_BLOCK_SIDE * MESH_BLOCK_SIDE]; /* mesh_ground_read */
    float height[MESH_POINTS];                      /* as meshed: 0 where there is no ground */
    float decoded[MESH_POINTS]; /* of points that are used, as a reader has them */
    mesh_rtin rtin;
    mesh_sides sides;
    quantized_vertex vertex[MESH_POINTS];
    uint32_t number[MESH_POINTS]; /* of the vertex at a point */
    uint32_t index[6 * MESH_POINTS];
    quantized_mesh mesh;
} mesh_tile;

/* Makes the mesh of a tile, off its points by `error_m` at most; the tiles next to it within
 * `range` use the same points of its sides. 0 or -1 (said). */
int mesh_tile_make(const mesh_ground *ground, const mesh_range *range, uint32_t zoom, uint32_t x,
                   uint32_t y, float error_m, int has_normals, mesh_tile *tile);

#endif
