#include "sim_mesh.h"

#include "../../client/terrain/ff_strips.h"
#include "sim_place.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int unpack_strip(sim_triangles *out, const uint16_t *index, uint32_t length)
{
    out->vertex = malloc((length + 1u) * sizeof *out->vertex);
    if (!out->vertex) return FF_ERR_MEMORY;
    for (uint32_t i = 0; i + 2 < length; i++) {
        uint16_t a = index[i], b = index[i + 1], c = index[i + 2];
        if (a == b || b == c || a == c) continue;
        out->vertex[out->count][0] = a;
        out->vertex[out->count][1] = b;
        out->vertex[out->count++][2] = c;
    }
    return FF_OK;
}

int sim_mesh_make(sim_mesh *mesh, const ff_terrain_info *info)
{
    ff_strips *strips = malloc(sizeof *strips);
    *mesh =
        (sim_mesh){ .info = { *info }, .grounds = 1, .curve_per_m = sim_place_curve_per_m(info) };
    int rc = strips ? ff_strips_make(strips, info->node_log2) : FF_ERR_MEMORY;
    for (uint32_t i = 0; rc == FF_OK && i < strips->count; i++)
        rc = unpack_strip(&mesh->strip[i], strips->index + strips->first[i], strips->length[i]);
    free(strips);
    return rc;
}

void sim_mesh_free(sim_mesh *mesh)
{
    for (size_t i = 0; i < sizeof mesh->strip / sizeof mesh->strip[0]; i++)
        free(mesh->strip[i].vertex);
    memset(mesh, 0, sizeof *mesh);
}

void sim_mesh_use(sim_mesh *mesh, const sim_drawn_grounds *grounds)
{
    if (!grounds->info) return;
    FF_ASSERT(grounds->count >= 1 && grounds->count <= FF_GROUNDS_MAX);
    memcpy(mesh->info, grounds->info, grounds->count * sizeof *mesh->info);
    mesh->grounds = grounds->count;
    mesh->tree = grounds->tree;
}

uint32_t sim_mesh_ground(const sim_mesh *mesh, const ff_drawn *drawn)
{
    uint32_t i = 0;
    while (i + 1 < mesh->grounds && ff_key_tile(drawn->key) >= mesh->info[i + 1].first_tile) i++;
    return i;
}

double sim_mesh_vertex_m(const sim_mesh *mesh, const ff_terrain_info *info, const ff_drawn *drawn,
                         uint32_t vertex)
{
    const uint16_t *drop = mesh->tree ? ff_tree_drop(mesh->tree, drawn) : NULL;
    int32_t steps = drawn->heights[vertex] - (drop ? drop[vertex] : 0);
    return (double)info->hoffset_wu / FF_WU_PER_METRE +
           (double)info->hscale_q24 / (1 << 24) * steps;
}

void sim_mesh_vertex_cell(const ff_terrain_info *info, const double last[2], uint32_t vertex,
                          double cell[2])
{
    uint32_t side = ff_node_side(info);
    cell[0] = fmin(vertex % side, last[0]);
    cell[1] = fmin(vertex / side, last[1]);
}

static int triangle_height(const sim_mesh *mesh, const ff_terrain_info *info, const ff_drawn *drawn,
                           const double last[2], const uint16_t vertex[3], const double cell[2],
                           double *z_m)
{
    double at[3][2], z[3], x = cell[0], y = cell[1];
    for (int i = 0; i < 3; i++) sim_mesh_vertex_cell(info, last, vertex[i], at[i]);
    double area = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                  (at[2][0] - at[0][0]) * (at[1][1] - at[0][1]);
    if (area == 0) return 0; /* of padding */
    double b = ((x - at[0][0]) * (at[2][1] - at[0][1]) - (at[2][0] - at[0][0]) * (y - at[0][1])) /
               area;
    double c = ((at[1][0] - at[0][0]) * (y - at[0][1]) - (x - at[0][0]) * (at[1][1] - at[0][1])) /
               area;
    if (!(b >= -1e-9 && c >= -1e-9 && b + c <= 1 + 1e-9)) return 0;
    for (int i = 0; i < 3; i++) z[i] = sim_mesh_vertex_m(mesh, info, drawn, vertex[i]);
    *z_m = z[0] + b * (z[1] - z[0]) + c * (z[2] - z[0]);
    return 1;
}

int sim_mesh_height(const sim_mesh *mesh, const ff_drawn *drawn, const double cell[2], double *z_m)
{
    const ff_terrain_info *info = sim_mesh_info(mesh, drawn);
    uint8_t strip[5];
    unsigned count = ff_strips_for(drawn->coarser, strip);
    double last[2];
    sim_place_last(info, drawn, last);
    for (unsigned i = 0; i < count; i++) {
        const sim_triangles *list = &mesh->strip[strip[i]];
        for (uint32_t j = 0; j < list->count; j++)
            if (triangle_height(mesh, info, drawn, last, list->vertex[j], cell, z_m)) return 1;
    }
    return 0;
}
