/* The triangles of a drawn node, made anew from its heights and border mask: the judge's own, as
 * the strips draw them. */
#ifndef SIM_MESH_H
#define SIM_MESH_H

#include "../../client/terrain/ff_tree.h"

typedef struct sim_triangles {
    uint32_t count;
    uint16_t (*vertex)[3]; /* places in a node's grid, row by row */
} sim_triangles;

typedef struct sim_mesh {
    ff_terrain_info info[FF_GROUNDS_MAX]; /* of the grounds whose nodes are drawn */
    uint32_t grounds;
    const ff_tree *tree;
    double curve_per_m;      /* at a distance of d m ground is drawn d * d * curve_per_m lower */
    sim_triangles strip[32]; /* by strip id, degenerate ones left out */
} sim_mesh;

/* The grounds whose nodes are drawn, as ff_tree_grounds gives them. No `info`: one alone, which the
 * judge was made with. */
typedef struct sim_drawn_grounds {
    const ff_terrain_info *info;
    uint32_t count;
    const ff_tree *tree; /* whose seams between them lower vertices, or NULL */
} sim_drawn_grounds;
static inline sim_drawn_grounds sim_drawn_grounds_of(const ff_tree *tree)
{
    sim_drawn_grounds grounds = { .tree = tree };
    grounds.info = ff_tree_grounds(tree, &grounds.count);
    return grounds;
}

/* Of one ground. FF_OK, or FF_ERR_MEMORY. Call free in both cases. */
int sim_mesh_make(sim_mesh *mesh, const ff_terrain_info *info);
/* From now on nodes of these grounds are drawn, until the tree changes; the first one is as
 * before. */
void sim_mesh_use(sim_mesh *mesh, const sim_drawn_grounds *grounds);
/* The number of the ground that a drawn node is of. */
uint32_t sim_mesh_ground(const sim_mesh *mesh, const ff_drawn *drawn);
static inline const ff_terrain_info *sim_mesh_info(const sim_mesh *mesh, const ff_drawn *drawn)
{
    return &mesh->info[sim_mesh_ground(mesh, drawn)];
}
void sim_mesh_free(sim_mesh *mesh);

/* Where a vertex of a drawn node lies, in cells, when the node's ground ends at `last`
 * (sim_place_last): what is beyond is drawn there. */
void sim_mesh_vertex_cell(const ff_terrain_info *info, const double last[2], uint32_t vertex,
                          double cell[2]);
/* Height of a vertex of a node of the ground as it is drawn, metres. */
double sim_mesh_vertex_m(const sim_mesh *mesh, const ff_terrain_info *info, const ff_drawn *drawn,
                         uint32_t vertex);
/* Height of a node's triangles at (x, y), counted in the node's cells: 1 and *z_m, or 0 outside. */
int sim_mesh_height(const sim_mesh *mesh, const ff_drawn *drawn, const double cell[2], double *z_m);

#endif
