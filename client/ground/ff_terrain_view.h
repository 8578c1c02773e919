/* Ground as meshes, in the client's picture and in the server's faces: what of a tree is drawn
 * becomes vertices once, and draw calls each frame, all in one frame of coordinates. Every drawn
 * node has an entry here (found through ff_tree_user) with its mesh and a hash of its heights. A
 * full pool takes the entry of a node not drawn lately; when all are drawn, the node's mesh lives
 * for one frame only: slower, never a hole.
 *
 * The owner zeroes the view and sets the first part; all memory is the owner's. */
#ifndef FF_TERRAIN_VIEW_H
#define FF_TERRAIN_VIEW_H

#include "ff_ground_frame.h"
#include "../images/ff_textures.h"
#include "../map/ff_contours.h"
#include "../terrain/ff_strips.h"
#include "../terrain/ff_tree.h"

#define FF_STRIP_COUNT_MAX         32
#define FF_TERRAIN_VIEW_HASH_START UINT64_C(0xcbf29ce484222325)

typedef struct ff_view_node {
    uint32_t *user;        /* the node's word that names this entry; NULL: free */
    uint64_t heights_hash; /* 0: not asked for yet */
    c3d_mesh mesh;
    uint32_t used; /* stamp of the last frame it was drawn in */
} ff_view_node;

/* What whoever throws pictures keeps of a node: two things that he found out, and what each is
 * about. All zero at first. */
typedef struct ff_view_kept {
    ff_squares squares[2];
    uint32_t about[2];
} ff_view_kept;

/* Pictures thrown on nodes: what becomes of a node's draw. `draws` has it as it is; the answer is
 * how many there are now, FF_THROWS_MAX at most, drawn one over the other, each `without` some of
 * the node's squares; NULL: whole. */
#define FF_THROWS_MAX 8
typedef struct ff_throws {
    unsigned (*lay)(const void *context, const ff_terrain_info *info, const ff_drawn *drawn,
                    ff_view_kept *kept, c3d_draw draws[FF_THROWS_MAX],
                    const ff_squares *without[FF_THROWS_MAX]);
    const void *context;
} ff_throws;

typedef struct ff_terrain_view {
    /* NULL: geometry only. Holds a mesh for each entry, and one more where nodes may lack one. */
    c3d_device *device;
    ff_view_node *entry;  /* zeroed */
    c3d_vertex *vertices; /* scratch for one node */
    uint32_t entry_count, heights_per_node;

    ff_tree *tree; /* see ff_terrain_view_attach */
    const ff_textures *textures;
    uint32_t hand, stamp;
    uint32_t held, held_high;
    ff_ground_frame frame; /* of all meshes */
    c3d_strip strip[FF_STRIP_COUNT_MAX];
    ff_throws throws; /* lay NULL: none */
    /* for throws, NULL where nothing is thrown: of each entry, and one for nodes that lack one */
    ff_view_kept *kept; /* zeroed */
    /* for throws, textures and contours, NULL where there are none: the indices of all strips, and
     * room for those of a node without some squares */
    uint16_t *index, *part;
    ff_texel_look look; /* of the picture being drawn */
    ff_wear *wear;      /* scratch, FF_WEAR_MAX, for textures: of the node being drawn */
    uint16_t first[FF_STRIP_COUNT_MAX], length[FF_STRIP_COUNT_MAX];
    ff_contours contours; /* interval_wu 0: none; else `index` is needed, too */
} ff_terrain_view;

/* Makes the strips on the device. `strips` is scratch, free afterwards. FF_OK or FF_ERR_MEMORY. */
int ff_terrain_view_strips(ff_terrain_view *view, unsigned node_log2, ff_strips *strips);
/* The tree that will be drawn, which tells when nodes go, and the images that lie on it (NULL:
 * none). Both outlive the view. */
void ff_terrain_view_attach(ff_terrain_view *view, ff_tree *tree, const ff_textures *textures);
/* A picture of these nodes of the tree begins: none of them loses its entry to another. */
void ff_terrain_view_begin(ff_terrain_view *view, const ff_drawn *list, uint32_t count);
/* FNV-1a (by 64-bit words) over nodes of the picture begun: keys, border masks, origins,
 * heights. */
uint64_t ff_terrain_view_hash(ff_terrain_view *view, const ff_drawn *list, uint32_t count);
/* Draws nodes of the picture begun; several calls may share its nodes out. `show`: bits of
 * enum ff_show. */
void ff_terrain_view_draw(ff_terrain_view *view, const ff_drawn *list, uint32_t count,
                          const c3d_camera *camera, unsigned show);
/* The next picture's frame of coordinates is chosen by its camera alone, not by those before. */
void ff_terrain_view_new_frame(ff_terrain_view *view);

#endif
