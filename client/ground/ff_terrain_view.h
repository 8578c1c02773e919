/* Near ground as meshes: what of the tree is drawn becomes vertices once, and draw calls each
 * frame. Every drawn node has an entry here (found through ff_tree_user) with its mesh and a hash
 * of its heights. A full pool takes the entry of a node not drawn lately; when all are drawn, the
 * node's mesh lives for one frame only: slower, never a hole. */
#ifndef FF_TERRAIN_VIEW_H
#define FF_TERRAIN_VIEW_H

#include "ff_ground_frame.h"
#include "../terrain/ff_strips.h"
#include "../terrain/ff_tree.h"

#define FF_STRIP_COUNT_MAX         32
#define FF_TERRAIN_VIEW_HASH_START UINT64_C(0xcbf29ce484222325)

typedef struct ff_view_node {
    uint32_t *user; /* the node's word that names this entry; NULL: free */
    uint64_t heights_hash;
    c3d_mesh mesh;
    uint32_t used; /* stamp of the last frame it was drawn in */
} ff_view_node;

typedef struct ff_terrain_view {
    c3d_device *device; /* NULL: geometry only */
    ff_view_node *entry;
    uint32_t entry_count, hand, stamp;
    uint32_t held, held_high, heights_per_node, strip_indices;
    ff_ground_frame frame; /* of all meshes */
    c3d_vertex *vertices;  /* scratch for one node */
    c3d_strip strip[FF_STRIP_COUNT_MAX];
} ff_terrain_view;

struct ff_textures;

/* Makes the strips on the device. `strips` is scratch, free afterwards. FF_OK or FF_ERR_MEMORY. */
int ff_terrain_view_strips(ff_terrain_view *view, unsigned node_log2, ff_strips *strips);
/* Lets the tree tell when nodes go. */
void ff_terrain_view_attach(ff_terrain_view *view, ff_tree *tree);
/* FNV-1a (by 64-bit words) over the drawn nodes: keys, border masks, origins, heights. */
uint64_t ff_terrain_view_hash(ff_terrain_view *view, ff_tree *tree);
/* Draws the nodes; `textures` may be NULL. `show` is enum ff_show. */
void ff_terrain_view_draw(ff_terrain_view *view, ff_tree *tree, const ff_terrain_info *info,
                          const c3d_camera *camera, struct ff_textures *textures, unsigned show);

#endif
