/* The ground as points in degrees, on the lattice of Cesium's geographic tiles: what meshes of all
 * zooms are made of. A point of a coarser zoom is one of the finest. */
#ifndef MESH_GROUND_H
#define MESH_GROUND_H

#include "export_view.h"
#include "mesh_rtin.h"

#define MESH_BLOCK_SIDE (MESH_SIDE + 2) /* a tile's points, and one more all round */

/* Tiles of a zoom: 2^(zoom+1) round the Earth from 180 W, 2^zoom from the south pole; both ends
 * belong to it. Columns go on beyond 180 E. */
typedef struct mesh_range {
    uint32_t west, south, east, north;
} mesh_range;

typedef struct mesh_ground {
    export_view view;
    uint32_t zoom;    /* the finest */
    mesh_range range; /* of the finest */
    export_bounds bounds;
    bake_grid points; /* float metres, row 0 south; NAN: no ground */
} mesh_ground;

/* The zoom whose points are no further apart than the ground's samples, about. */
uint32_t mesh_ground_zoom(const export_ground *ground);
/* Projects the ground. 0 or -1 (said). */
int mesh_ground_open(const export_ground *ground, uint32_t zoom, mesh_ground *mesh);
void mesh_ground_close(mesh_ground *mesh);

/* Tiles of a zoom that have ground, or may have; of zoom 0 both tiles. */
mesh_range mesh_ground_range(const mesh_ground *mesh, uint32_t zoom);
/* The points of a tile and those next to it, row 0 south; NAN: no ground. 0 or -1 (said). */
int mesh_ground_read(const mesh_ground *mesh, uint32_t zoom, uint32_t x, uint32_t y,
                     float block[MESH_BLOCK_SIDE * MESH_BLOCK_SIDE]);
/* Degrees between points of a zoom. */
double mesh_ground_cell(uint32_t zoom);

#endif
