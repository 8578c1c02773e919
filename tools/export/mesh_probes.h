/* Samples of a pack at which meshes are measured. */
#ifndef MESH_PROBES_H
#define MESH_PROBES_H

#include "export_fit.h"
#include "mesh_ground.h"

typedef struct mesh_probe {
    double x, y; /* in points of the finest zoom, from the south-west one */
    float height_m;
} mesh_probe;

typedef struct mesh_probes {
    mesh_probe *probe; /* by tiles of the finest zoom, row by row */
    uint32_t *first;   /* of each tile, and one more */
    uint32_t columns, rows;
} mesh_probes;

/* A mesh in points of its tile, as a reader decodes it. */
typedef struct mesh_surface {
    const uint32_t *index; /* of points, mesh_rtin.h */
    uint32_t triangle_count;
    const float *height; /* of the points that are used */
    const float *block;  /* mesh_ground_read */
} mesh_surface;

/* Every so many samples of the ground. 0 or -1 (said). */
int mesh_probes_open(const mesh_ground *ground, mesh_probes *probes);
void mesh_probes_close(mesh_probes *probes);
/* Adds how far the mesh of a tile is from the probes in it that have ground on all sides. 0 or -1
 * (said). */
int mesh_probes_measure(const mesh_probes *probes, const mesh_ground *ground, uint32_t zoom,
                        uint32_t x, uint32_t y, const mesh_surface *surface, export_fit *fit);

#endif
