/* The terrain quadtree: what is held, what is drawn, what is wanted (Hybrid, sections 6.1.2, 7.1
 * and 7.3).
 *
 * One tree serves the client (nodes arrive from a link), the server's renderer and the tests (nodes
 * are read from a pack): behind it stands a `source` that is asked for roots and refinements and
 * answers at once or later by ff_tree_deliver_*. Below leaves, where nothing is stored, it is not
 * asked: the tree predicts. Nor is it below stubs, where nothing is stored though there is finer
 * ground: they are the finest that is drawn. Geometry and requests only: nothing here knows a
 * graphics API, a socket, a clock or a floating-point number.
 *
 * A frame: ff_tree_select() walks the active tiles and chooses the cut; ff_tree_drawn() lists the
 * nodes of the cut that the view can see, with a border mask each. The cut is *restricted*: edge
 * neighbours differ by at most one level. Where a neighbour is coarser, the node's border strip on
 * that side leaves out every second vertex (the finer side is lowered), so both sides run through
 * the same vertices: no crack and no T-junction, whatever has or has not arrived.
 *
 * A tree holds one ground or several at once, of different extent, depth, spacing and steps of
 * height, in one reference system: their tiles have numbers of their own in keys, and their nodes
 * share the pool, the view and the wishes. Where they lie over each other the one of finer spacing
 * is drawn, once its roots are here, or of equals the first; along its rim the other dives under it
 * (ff_tree_drop), so that no gap is seen.
 *
 * Memory: one block at ff_tree_create; `node_count` slots. Full pools make the ground coarser and
 * are counted.
 */
#ifndef FF_TREE_H
#define FF_TREE_H

#include "../../common3d/c3d.h"
#include "../../protocol/codec/ff_codec.h"
#include "../../protocol/ff_kind.h"
#include "../../protocol/shape/ff_shape.h"

typedef struct ff_tree ff_tree;
typedef struct ff_node ff_node; /* defined in ff_tree_local.h for client/terrain only */

enum ff_measure {
    /* Hybrid eq. 3: split when f = d/(e*C) < 1; d viewer to node centre, e node edge */
    FF_MEASURE_DISTANCE,
    /* split when the node's geometric error projects to more than error_px_q8 pixels */
    FF_MEASURE_PIXELS
};

typedef struct ff_quality {
    enum ff_measure measure;
    int32_t c_q8;        /* C of eq. 3 */
    int32_t error_px_q8; /* for FF_MEASURE_PIXELS */
    /* levels used, 1: roots only; 0: all the terrain has. Of an entered terrain (ff_entry.h) those
     * that are left out count, and its roots are used always */
    uint8_t depth_max;
    /* children of a node are kept until f exceeds sigma (> 1.0); Listing 1's caching threshold */
    int32_t sigma_q8;
    /* ground further than this (largest of |dx|,|dy|,|dz| to `centre_wu`) is neither drawn nor
     * asked for; nor is what lies beyond the horizon (ff_shape_horizon_wu). INT32_MAX: all that can
     * be seen, the client's default. Of a terrain of more than FF_ENTRY_TILES_MAX tiles no more
     * than those 127 tiles' edges away are looked at */
    int32_t view_wu;
    /* ground nearer than this (measured alike) is not split for its own sake: a panorama leaves it
     * out; 0: none */
    int32_t hole_wu;
    /* the most triangles in view; where the measure asks for more, it is made as much coarser as it
     * takes, and then the reach shorter. 0: no limit; less than FF_TRIANGLES_MIN is that many */
    uint32_t triangles_max;
    /* ground farther than this from the camera, along x or y, may be `coarse` times as wrong:
     * something else mends it (client/far). coarse 0 or 1: none */
    int32_t fine_wu;
    uint8_t coarse;
} ff_quality;
#define FF_TRIANGLES_MIN 1024u /* room for the roots round the viewer */

/* Positions are points of `frame`, whose z is up; {0}: world axes of a planar terrain. */
typedef struct ff_view {
    c3d_camera camera;
    /* middle of the square of ground to draw: the camera, or where the panorama in use was taken */
    int32_t centre_wu[3];
    ff_frame frame;
} ff_view;

/* What becomes of ground in view that nearer ground hides (ff_horizon.h). */
enum ff_hidden {
    FF_HIDDEN_LEFT_OUT, /* neither drawn nor wished for in view */
    FF_HIDDEN_DRAWN,    /* not wished for, but drawn: for checks, the picture is the same */
    FF_HIDDEN_FETCHED   /* nothing is known of it: it is drawn and wished for like any other */
};

/* One wish: a root (level 0) or the children of a node. priority: higher is more urgent. */
typedef struct ff_wish {
    ff_key key;
    uint8_t kind;      /* FF_KIND_ROOT or FF_KIND_REFINEMENT */
    uint8_t in_view;   /* or a neighbour without which something in view may not split */
    uint8_t lacks;     /* bits of the sources known not to have a refinement */
    uint32_t priority; /* of the same class: pixels of error removed, Q8 (DISTANCE: Q8 of 1/f) */
} ff_wish;

typedef struct ff_drawn {
    ff_key key;
    const ff_node *node;
    const uint16_t *heights; /* ff_node_side()^2, decoded; see ff_tree_drop */
    uint8_t coarser;         /* bit FF_SIDE_x: the neighbour there is one level coarser */
    uint8_t filled;          /* 1: some of its ground was void in the source, and filled */
    uint8_t stub;            /* 1: there is finer ground, but none is stored */
    int32_t origin_wu[3];    /* place of vertex (0,0,z=0) in the frame; see ff_tree_vertices */
    int32_t cell_wu;
} ff_drawn;

typedef struct ff_tree_stats {
    uint32_t nodes_held, nodes_high, nodes_capacity;
    uint32_t nodes_cut, nodes_drawn; /* of the last selection */
    uint32_t triangles;              /* drawn, degenerate ones not counted */
    uint32_t stitched;               /* drawn nodes with at least one coarser neighbour */
    uint32_t pool_full;              /* refinements that found no room */
    uint32_t orphans;                /* refinements that arrived for a node no longer held */
    uint32_t sides_gone;             /* that came without a side which is no longer held */
    uint32_t selects, selects_skipped;
    /* nodes of the last selection near enough to split but exact already: not asked for */
    uint32_t flat;
    uint32_t stubs;                          /* near enough to split, but nothing finer is stored */
    uint32_t nodes_hidden, triangles_hidden; /* of the cut, in view, by nearer ground */
    uint32_t seams;       /* nodes in view with vertices lowered for a seam between grounds */
    uint32_t seams_short; /* that found no room, or could not be lowered far enough */
} ff_tree_stats;

#define FF_GROUNDS_MAX 16
#define FF_SOURCES_MAX 8
/* 0: this build has one ground and one source alone (features.mk). */
extern const uint8_t ff_grounds_built;

typedef struct ff_tree_desc {
    ff_terrain_info info; /* of the first ground */
    uint32_t node_count;  /* slots, shared by all grounds; at least 8 */
    uint32_t wish_count;  /* most wishes one selection lists */
    enum ff_hidden hidden;
    uint32_t ground_max; /* grounds at most; 0: 1 */
    uint32_t source_max; /* who may serve a ground, at most; 0: 1 */
    uint32_t seam_max;   /* of several grounds: nodes in seams; 0: an eighth of node_count */
} ff_tree_desc;

size_t ff_tree_bytes(const ff_tree_desc *desc);
/* NULL when desc is out of range or the block too small. */
ff_tree *ff_tree_create(const ff_tree_desc *desc, void *memory, size_t bytes);

/* Adds a ground, which the caller has given its place among the others: first_tile is no less than
 * the tiles of those before, west_wu and south_wu are in the axes of the first. Its number (the
 * first one's is 0); FF_ERR_UNSUPPORTED: its nodes are of another size; FF_ERR_FULL;
 * FF_ERR_RANGE. The tree takes it to fall away as the first one does (curve_q60). */
int ff_tree_add_ground(ff_tree *tree, const ff_terrain_info *info);
/* That a key belongs to. */
const ff_terrain_info *ff_tree_ground(const ff_tree *tree, ff_key key);
/* All of them, by number. */
const ff_terrain_info *ff_tree_grounds(const ff_tree *tree, uint32_t *count);

/* Several servers and packs may hold the same ground, each some of it: sources, 0 to source_max - 1
 * of the tree. The tree keeps for each node which of them are known not to have its refinement;
 * when that is all that serve the ground, the node is a stub. One that comes later is asked again.
 * mask: a bit for each that serves a ground now; as a tree is made, source 0 serves all. */
void ff_tree_set_sources(ff_tree *tree, uint32_t ground, uint8_t mask);
/* A ground is known to be another pack's, of which it was taken for a part: its checksum. */
void ff_tree_set_checksum(ff_tree *tree, uint32_t ground, uint32_t checksum);
/* Another layer of images is shown over a ground: ff_terrain_show_images. */
void ff_tree_show_images(ff_tree *tree, uint32_t ground, const ff_terrain_info *told,
                         uint32_t levels);
/* A source has answered that it has no refinement of a node. Told only where there may be several.
 */
void ff_tree_lacks(ff_tree *tree, ff_key key, unsigned source);

/* Results of a request, from a source. Residuals from ff_decode_*. FF_OK; FF_ERR_FULL (counted,
 * coarser), FF_ERR_NOT_FOUND (node gone: counted; or a stub); an error of ff_reconstruct_*: nothing
 * is held of it. */
int ff_tree_deliver_root(ff_tree *tree, uint32_t tile, unsigned source,
                         const ff_residuals *residuals);
int ff_tree_deliver_children(ff_tree *tree, ff_key key, unsigned source,
                             const ff_residuals *residuals);

/* Chooses the cut for a view. Returns 1 when anything changed (view, quality, nodes) and the cut
 * was made anew, 0 when skipped. */
int ff_tree_select(ff_tree *tree, const ff_view *view, const ff_quality *quality);
/* Nodes of the cut inside the view pyramid that are not left out as hidden, nearest first; valid
 * until the next call that changes the tree. */
uint32_t ff_tree_drawn(const ff_tree *tree, const ff_drawn **list);
/* The same nodes, and then those left out: all that the picture is true of. */
uint32_t ff_tree_in_view(const ff_tree *tree, const ff_drawn **list);
/* All nodes of the cut, seen or not, for checks: same rules. */
uint32_t ff_tree_cut(const ff_tree *tree, const ff_drawn **list);
/* The frame that their origins are places of: the last selection's. */
const ff_frame *ff_tree_frame(const ff_tree *tree);
/* The last selection's quality, as coarse as the limit of triangles made it. */
const ff_quality *ff_tree_quality(const ff_tree *tree);
/* A node's place there, for ff_shape.h. */
const ff_placed *ff_tree_placed(const ff_node *node);
/* Between which heights its ground lies. */
void ff_tree_heights_wu(const ff_terrain_info *info, const ff_node *node, int64_t height_wu[2]);
/* The largest distance between a node's triangles and the ground. */
int64_t ff_tree_error_wu(const ff_terrain_info *info, const ff_node *node);
/* Bits of ff_side: sides of a node's children that are held, of the nodes across. A refinement that
 * leaves them out can be delivered. */
unsigned ff_tree_sides(const ff_tree *tree, ff_key key);
/* What would make the picture better, most urgent first. The tree does not remember asking: the
 * caller does. */
uint32_t ff_tree_wishes(const ff_tree *tree, const ff_wish **list);
/* Of how many nodes the next selection makes the children itself, because nothing finer is stored:
 * until it is 0, the same view selected again gives another cut. */
uint32_t ff_tree_to_make(const ff_tree *tree);

/* What the viewer would wish for in view if it were at pos_wu and looked yaw, pitch further
 * (brad16), and does not wish for in view now: for prefetch, most urgent first, at most `capacity`.
 * Only what the pool would find room for. */
uint32_t ff_tree_foresee(const ff_tree *tree, const int32_t pos_wu[3], int32_t yaw, int32_t pitch,
                         ff_wish *list, uint32_t capacity);

/* Nodes of the cut of which nothing finer is held, though there is: what is wished for elsewhere
 * may need them split, too, as neighbours. The largest for their distance first, at most
 * `capacity`. */
uint32_t ff_tree_edge(const ff_tree *tree, ff_wish *list, uint32_t capacity);

/* The reserve: what the viewer would miss most if it turned at once. Missing roots out of view, and
 * refinements out of view of wanted nodes whose error, looked at, would pass a twentieth of the
 * picture's longer side; most urgent first, roots before refinements, at most `capacity`. Only what
 * finds room without driving out anything that is wanted; roots while they fill no more than a
 * quarter of the pool. priority of refinements: pixels Q8, in either measure. */
uint32_t ff_tree_reserve(const ff_tree *tree, ff_wish *list, uint32_t capacity);

/* Vertices of a node for c3d: x, y = column, row (0..2^k), z = height - 32768 less ff_tree_drop,
 * colour from height and slope (ff_shade.h) or white when `shaded` is 0. `out` has ff_node_side()^2
 * entries. Draw with origin ff_drawn.origin_wu - camera, xy_scale cell_wu, z_scale_q16 = hscale_q24
 * of its ground. */
void ff_tree_vertices(const ff_tree *tree, const ff_drawn *drawn, int shaded, c3d_vertex *out);

/* Takes the alpha (0) of those vertices over which another ground is drawn. */
void ff_tree_clear_hidden(const ff_tree *tree, const ff_drawn *drawn, c3d_vertex *vertices);

/* How many steps lower each of the node's vertices is drawn than its height says, for the seam with
 * another ground; NULL: none is, or nobody knows, for the node is out of view. */
const uint16_t *ff_tree_drop(const ff_tree *tree, const ff_drawn *drawn);

/* A caller's word per node slot (mesh handle, say), zeroed when the slot is given to another node,
 * or when the node's shaded vertices have changed because a neighbour arrived. `on_evict` is called
 * first, for words that are not 0. */
uint32_t *ff_tree_user(ff_tree *tree, const ff_node *node);
void ff_tree_on_evict(ff_tree *tree, void (*on_evict)(void *context, uint32_t user), void *context);

/* Height of the drawn surface at (x, y) of the frame, wu: 1 and *z_wu, or 0 where no node of the
 * cut lies. */
int ff_tree_drawn_height(const ff_tree *tree, int32_t x_wu, int32_t y_wu, int32_t *z_wu);
/* 1 when that surface is of a node with filled ground (ff_drawn.filled). */
int ff_tree_drawn_filled(const ff_tree *tree, int32_t x_wu, int32_t y_wu);
void ff_tree_get_stats(const ff_tree *tree, ff_tree_stats *stats);

#endif
