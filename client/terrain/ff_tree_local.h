/* Inside of the terrain tree: structures shared by the files of client/terrain only. */
#ifndef FF_TREE_LOCAL_H
#define FF_TREE_LOCAL_H

#include "ff_tree.h"
#include "../../protocol/ff_assert.h"

#define FF_SLOT_NONE  UINT32_MAX
#define FF_NODES_MAX  (1u << 20) /* slot numbers share a 64-bit sort key with a 40-bit distance */
#define FF_SLOT_BITS  20
#define FF_LEVELS_MAX (FF_KEY_LEVEL_MAX + 1u)
FF_STATIC_ASSERT(FF_NODES_MAX == 1u << FF_SLOT_BITS && FF_SLOT_NONE >= FF_NODES_MAX);
#define FF_SLOT_NEVER (UINT32_MAX - 1)
FF_STATIC_ASSERT(FF_SLOT_NEVER >= FF_NODES_MAX);
FF_STATIC_ASSERT(FF_SLOT_NONE == UINT32_MAX); /* so only four of them have all bits in common */

/* Value of splitting a node, Q16: 1/f, above 1.0 the measure asks for it. Saturates. */
#define FF_VALUE_ONE 65536u
#define FF_VALUE_MAX UINT32_MAX

enum ff_node_flags {
    FF_NODE_LEAF = 1,   /* nothing finer is stored: children are made by prediction */
    FF_NODE_ACTIVE = 2, /* a root that takes part in the last selection: inside the window */
    /* not a root, and another ground is drawn there. Found when its parent splits, stale when not
     */
    FF_NODE_LEFT_OUT = 2,
    /* its children are desired, by itself or by a neighbour that may not be two levels finer */
    FF_NODE_WANTED = 4,
    FF_NODE_SPLIT = 8, /* the cut runs below it */
    /* something seen cannot split, or is drawn coarser, before this node has split */
    FF_NODE_NEEDED = 16,
    FF_NODE_FILLED = 32, /* some of its ground was void in the source */
    FF_NODE_JOINED = 64, /* a root that has been in the cut since it came into the window */
    /* of the cut, in view, and by nearer ground, whatever comes of it; stale when out of view */
    FF_NODE_HIDDEN = 128,
    FF_NODE_KEPT = FF_NODE_LEAF | FF_NODE_FILLED | FF_NODE_JOINED /* by selections */
};

struct ff_node {
    ff_key key;         /* FF_KEY_NONE: the slot is free */
    uint32_t hash_next; /* next in the hash chain, or in the list of free slots */
    uint32_t list_next; /* roots: next root */
    /* next wanted node of the same level; FF_SLOT_NEVER: a stub, which is wanted never: it is drawn
     * as if it were of the finest level */
    uint32_t want_next;
    uint32_t parent;
    /* all that have ground, or none; FF_SLOT_NONE in the other quadrants */
    uint32_t child[4];
    ff_placed placed; /* in the last selection's frame */
    uint32_t value;   /* valid while FF_NODE_WANTED */
    uint32_t user;
    uint16_t height_min, height_max, height_mean;
    uint8_t error_code;
    uint8_t flags;
};

#define FF_PLANES   5
#define FF_MADE_MAX 32u /* families a selection makes */

typedef struct ff_horizon ff_horizon; /* ff_horizon.h */

struct ff_tree {
    /* in the order of their tiles; places are in the axes of the first */
    ff_terrain_info *ground;
    ff_reach *window; /* of each: its tiles whose ground is drawn and asked for */
    ff_reach *window_ahead;
    uint8_t *sources; /* of each: the bits of who serves it; NULL: one source serves all */
    uint8_t *lacks;   /* of each slot: the bits of who has no refinement of the node; NULL alike */
    /* who is drawn where several lie (ff_cover.c): NULL for trees of one ground */
    struct ff_cover *cover;
    struct ff_seams *seams; /* ff_seam.h; NULL alike */
    uint32_t ground_count, ground_max, source_max;
    uint32_t node_count, wish_capacity, hash_mask;
    ff_node *node;
    uint16_t *heights; /* node_count grids */
    uint32_t *hash;
    /* node_count slots: queue of a selection; between selections what ff_tree_foresee knows of each
     * slot */
    uint32_t *order;
    uint64_t *sort; /* 2 * node_count */
    /* node_count: the cut, what is drawn first, then what is hidden; the rest gets `coarser` only
     * in ff_tree_cut */
    ff_drawn *drawn;
    ff_wish *wish;
    uint16_t *refined; /* grid of four children */
    void *room; /* for who makes it (ff_codec_room): that of `sort`, nothing is made while it is
                   used */
    uint32_t free_head, root_head, free_count;
    uint32_t cut_count, view_count, drawn_count, wish_count;

    ff_view asked_view, view; /* of the last selection: as given, and brought into range */
    /* as given, brought into range, and in force: coarser where the limit of triangles wants it */
    ff_quality asked_quality, finest, quality;
    uint16_t limit_step; /* how much coarser, see ff_limit.c */
    uint8_t limit_rests; /* selections before a finer step is tried again */
    /* leaves whose children the next selection makes first: what would be wished for of others */
    uint32_t made_count;
    ff_key made[FF_MADE_MAX];
    uint32_t wish_value; /* what is in view and worth less is not wished for */
    uint8_t has_view, dirty;
    /* 1: nodes have gone since the last selection, so the lists of wanted nodes are broken */
    uint8_t dropped;
    /* inward normals of the view pyramid, largest component below 2^28 */
    int32_t plane[FF_PLANES][3];
    uint32_t want_head[FF_LEVELS_MAX];
    enum ff_hidden hidden;
    /* of the view, and, for ff_tree_foresee, of a view ahead; NULL where hidden is FETCHED */
    ff_horizon *horizon, *horizon_ahead;
    /* ground in view is held and in the window up to here from its middle, along both axes */
    int32_t whole_wu;
    uint8_t roots_missing; /* 0: all roots in the window are held */
    uint8_t tiles_wait;    /* 1: some tile in the window has not joined the cut */

    void (*on_evict)(void *context, uint32_t user);
    void *evict_context;
    ff_tree_stats stats;
};

static inline uint32_t ff_slot_of(const ff_tree *tree, const ff_node *node)
{
    FF_ASSERT(node >= tree->node && node < tree->node + tree->node_count);
    return (uint32_t)(node - tree->node);
}
/* ---- cover (ff_cover.c) ---- */

/* A rectangle of ground in the frame, wu; lo > hi: none. */
typedef struct ff_area {
    int32_t lo[2], hi[2];
} ff_area;

typedef struct ff_cover {
    uint8_t ranked[FF_GROUNDS_MAX],
        rank[FF_GROUNDS_MAX]; /* numbers in order, and the place there */
    /* 1: no more than one ground has tiles in the window, so nothing is left out, and there are no
     * seams */
    uint8_t alone;
    /* the ground that ff_ground_search found last, the tiles it was found for */
    uint32_t found, first_tile, end_tile;
    ff_area stands[FF_GROUNDS_MAX]; /* where each ground is drawn, unless one before it is */
    /* of each, the largest cell along its west, south, east and north rim */
    int32_t rim_cell_wu[FF_GROUNDS_MAX][4];
} ff_cover;

/* Puts the grounds in order. */
void ff_cover_rank(ff_tree *tree);
/* 1 when a ground is too small in the picture to take part. */
int ff_cover_is_small(const ff_tree *tree, uint32_t ground);
/* Finds where each ground stands, once the roots in the window are marked; roots elsewhere stop
 * being active where a ground after theirs stands. */
void ff_cover_stand(ff_tree *tree);
/* 1 when a node is left out because a ground before its own is drawn there: once the cut of those
 * is made. */
int ff_cover_hides(const ff_tree *tree, ff_key key);
/* Looks at the rims of a ground's cut, once it is made. */
void ff_cover_rims(ff_tree *tree, uint32_t ground);
/* Roots of a ground that are left out stop being active. */
void ff_cover_roots(ff_tree *tree, uint32_t ground);
/* 1 when another ground stands all over a tile. */
int ff_cover_fills(const ff_tree *tree, uint32_t tile);

static inline int ff_left_out(const ff_tree *tree, ff_key key)
{
    return tree->cover && !tree->cover->alone && ff_cover_hides(tree, key);
}
/* The same of nodes that are not in the window, as another ground may come into it. */
static inline int ff_left_out_ahead(const ff_tree *tree, ff_key key)
{
    return tree->cover && ff_cover_hides(tree, key);
}
/* 1 where a ground has a level, and the quality uses it: it counts those that are left out. */
static inline int ff_has_level(const ff_tree *tree, const ff_terrain_info *info, uint32_t level)
{
    FF_ASSERT(level <= ff_terrain_levels(info));
    return level < ff_terrain_levels(info) &&
           (!tree->quality.depth_max || level + info->entered < tree->quality.depth_max);
}
static inline uint32_t ff_ground_ranked(const ff_tree *tree, uint32_t rank)
{
    return tree->cover ? tree->cover->ranked[rank] : rank;
}

/* ---- seams (ff_seam.c) ---- */

/* 1 when vertices of a node may be lowered for a seam. */
int ff_seam_touches(const ff_tree *tree, const ff_node *node);
/* Nothing of all ground lies lower, wherever it is drawn for a seam. */
int64_t ff_seam_lowest_wu(const ff_tree *tree);
/* Lowers what is in view, once the cut is listed. */
void ff_seam_make(ff_tree *tree);

/* How a node's vertices are taken: as they are held; lowered under the grounds before its own; or
 * its rim under those after it, too, as they are drawn. */
enum ff_lowered { FF_LOWERED_NOT, FF_LOWERED_DIVED, FF_LOWERED_DRAWN };
/* How many steps each vertex is lower; NULL: none is. */
const uint16_t *ff_seam_drop(const ff_tree *tree, uint32_t slot, enum ff_lowered how);

/* ---- grounds (ff_grounds.c) ---- */

/* Of several: the last one whose tiles begin at `tile` or before. */
uint32_t ff_ground_search(const ff_tree *tree, uint32_t tile);
/* `source` has no refinement of the node. Once that is so of all that serve its ground it is a
 * stub. */
void ff_node_lacks(ff_tree *tree, uint32_t slot, unsigned source);
/* Makes a node a stub, or none, by what its sources lack now. */
void ff_node_settle(ff_tree *tree, uint32_t slot);
/* The lowest and highest height of all grounds, in a ground's steps: what colours span. */
void ff_grounds_ramp(const ff_tree *tree, const ff_terrain_info *info, int32_t ramp[2]);

static inline uint32_t ff_ground_number(const ff_tree *tree, uint32_t tile)
{
    if (tree->ground_count <= 1) return 0;
    return tile >= tree->cover->first_tile && tile < tree->cover->end_tile
               ? tree->cover->found
               : ff_ground_search(tree, tile);
}
/* The ground that a tile or a node belongs to, or would, were it one. */
static inline const ff_terrain_info *ff_ground_of_tile(const ff_tree *tree, uint32_t tile)
{
    return &tree->ground[ff_ground_number(tree, tile)];
}
static inline const ff_terrain_info *ff_ground_of(const ff_tree *tree, ff_key key)
{
    return ff_ground_of_tile(tree, ff_key_tile(key));
}

static inline ff_area ff_area_in(const ff_terrain_info *info, ff_key key, const ff_placed *placed)
{
    static const int64_t height_wu[2] = { 0, 0 };
    static const int32_t from_wu[3] = { 0, 0, 0 };
    ff_box box = ff_shape_box(info, key, placed, height_wu, from_wu);
    return (ff_area){ { (int32_t)box.lo[0], (int32_t)box.lo[1] },
                      { (int32_t)box.hi[0], (int32_t)box.hi[1] } };
}
static inline ff_area ff_area_of(const ff_tree *tree, ff_key key, const ff_placed *placed)
{
    return ff_area_in(ff_ground_of(tree, key), key, placed);
}

/* All grounds have nodes of one size. */
static inline size_t ff_heights_per_node(const ff_tree *tree)
{
    return (size_t)ff_node_side(tree->ground) * ff_node_side(tree->ground);
}
static inline int ff_node_held(const ff_node *node) { return node->key != FF_KEY_NONE; }
static inline uint16_t *ff_heights_of(const ff_tree *tree, uint32_t slot)
{
    FF_ASSERT(slot < tree->node_count);
    return tree->heights + slot * ff_heights_per_node(tree);
}

static inline int ff_node_has_children(const ff_node *node)
{
    return (node->child[0] & node->child[1] & node->child[2] & node->child[3]) != FF_SLOT_NONE;
}
static inline uint32_t ff_node_children(const ff_node *node)
{
    uint32_t count = 0;
    for (unsigned q = 0; q < 4; q++) count += node->child[q] != FF_SLOT_NONE;
    return count;
}
/* 1 when there is finer ground, and none is stored. */
static inline int ff_node_is_stub(const ff_node *node) { return node->want_next == FF_SLOT_NEVER; }
/* The bits of the sources that are known not to have the node's refinement. */
static inline uint8_t ff_node_lacked(const ff_tree *tree, const ff_node *node)
{
    return tree->lacks ? tree->lacks[ff_slot_of(tree, node)] : 0;
}
/* 1 when the source is known no better than the node shows it. */
static inline int ff_node_is_exact(const ff_tree *tree, const ff_node *node)
{
    return node->error_code == 0 ||
           (node->flags & FF_NODE_LEAF && ff_geometric_error_decode(node->error_code) <=
                                              ff_ground_of(tree, node->key)->max_error);
}
/* Slots that the children of a node take: those that are not padding. */
uint32_t ff_family_size(const ff_tree *tree, ff_key parent);

/* A node's columns and rows of cells that have ground: the last ones may end inside the cell. */
static inline ff_extent ff_drawn_cells(const ff_tree *tree, ff_key key)
{
    const ff_terrain_info *info = ff_ground_of(tree, key);
    unsigned cell_log2 = info->tile_log2 - info->node_log2 - ff_key_level(key);
    ff_extent extent = ff_shape_extent(info, key);
    FF_ASSERT(extent.columns > 0 && extent.rows > 0);
    extent.columns = ((extent.columns - 1) >> cell_log2) + 1;
    extent.rows = ((extent.rows - 1) >> cell_log2) + 1;
    return extent;
}

#define FF_COARSER_UNKNOWN 0xFFu /* ff_drawn.coarser of a node that is not seen */

/* ff_tree.c: makes the children of tree->made. */
void ff_tree_make_children(ff_tree *tree);

/* ff_pool.c */
uint32_t ff_tree_find(const ff_tree *tree, ff_key key);
/* ff_sides.c: puts the sides of a node's children into tree->refined, from those of the nodes
 * across. 0: one of these is not held. */
int ff_tree_take_sides(ff_tree *tree, ff_key key, unsigned sides);
/* The node itself or its nearest held ancestor, or FF_SLOT_NONE. */
uint32_t ff_tree_find_nearest(const ff_tree *tree, ff_key key);
uint32_t ff_tree_take_slot(ff_tree *tree, ff_key key, uint32_t parent);
/* The colours of nodes beside a new node change: forgets what their users made of them. */
void ff_tree_reshade_beside(ff_tree *tree, ff_key key);
/* The same of a node whose vertices are drawn elsewhere, and of all nodes. */
void ff_tree_reshape(ff_tree *tree, uint32_t slot);
void ff_tree_reshade(ff_tree *tree);
void ff_tree_drop_children(ff_tree *tree, ff_node *parent);
void ff_tree_drop_root(ff_tree *tree, ff_node *root);

/* ff_evict.c */
/* Make room for the children of `keep`, or for a root, by dropping what is worth less. 1 when
 * there is room. */
int ff_evict_for_children(ff_tree *tree, uint32_t keep);
int ff_evict_for_root(ff_tree *tree, uint32_t tile);
/* Sort keys (value << FF_SLOT_BITS | slot) of all that may be dropped, unsorted: parents of leaf
 * families, idle roots. */
uint32_t ff_evict_candidates(const ff_tree *tree, uint64_t *keys);
/* The room that a full pool would make: its free slots, then victims, the least valuable first. */
typedef struct ff_room {
    const uint64_t *victim; /* sorted candidates */
    uint32_t victims, next, free;
} ff_room;
/* The free slots but `taken`, and victims in `victim` where they are fewer than `needed`. */
ff_room ff_room_make(const ff_tree *tree, uint64_t *victim, uint32_t taken, uint64_t needed);
/* Takes room for the children of `node` out of it. 1 when there was enough. */
int ff_room_take(const ff_tree *tree, ff_room *room, const ff_node *node);
/* The same for `needed` slots, from victims worth less than `limit`. */
int ff_room_take_slots(const ff_tree *tree, ff_room *room, uint32_t needed, uint32_t limit);
/* The children of `node` may drive out all that is worth less than this. Children that are not
 * seen drive out only what nobody wants, worth less than 1; children that nobody wants only what is
 * worth less than 1/sigma: so much is cached. */
uint32_t ff_evict_limit(const ff_tree *tree, const ff_node *node);

/* ff_measure.c */
void ff_window_make(ff_tree *tree);
int ff_tile_active(const ff_tree *tree, uint32_t tile);
/* Finds how far ground is whole. */
void ff_whole_make(ff_tree *tree);
/* Largest of |dx|, |dy| from the window's middle to a tile's square. */
int64_t ff_tile_distance(const ff_tree *tree, uint32_t tile);
/* Boxes are relative to the camera. */
void ff_node_box(const ff_tree *tree, const ff_node *node, ff_box *box);
/* Of a tile whose root has not arrived: between the terrain's lowest and highest ground. */
void ff_tile_box(const ff_tree *tree, uint32_t tile, ff_box *box);
/* 1 when no point of the box is within view_wu of the window's middle. */
int ff_box_beyond_view(const ff_tree *tree, const ff_box *box);
/* 1 when all of the box is nearer than hole_wu. */
int ff_box_in_hole(const ff_tree *tree, const ff_box *box);
int64_t ff_box_distance(const ff_box *box);
/* Geometric error of a node as seen from a distance (its box's, usually), pixels Q8, saturated. */
uint32_t ff_projected_error_q8(const ff_tree *tree, const ff_node *node, uint64_t distance);
uint32_t ff_value_of_split(const ff_tree *tree, const ff_node *node);

/* ff_view_cull.c */
void ff_pyramid_make(ff_tree *tree);
int ff_box_in_view(const ff_tree *tree, const ff_box *box);

/* ff_horizon.c */
/* 1 when a box can be seen from the view, as far as held ground tells. */
int ff_box_seen(const ff_tree *tree, const ff_box *box);
/* The same of a node, once the cut is listed. */
int ff_node_seen(const ff_tree *tree, const ff_node *node, const ff_box *box);

/* ff_surface.c */
/* A ground's node of the cut over or under a place, within the view or beyond it: what is kept of a
 * seam must not depend on where the viewer is. NULL where there is none. */
const ff_node *ff_surface_node(const ff_tree *tree, const ff_terrain_info *info,
                               const int32_t place_wu[2]);
/* A drawn node that is asked for heights: found once, for its border is dear to know. */
typedef struct ff_patch {
    const ff_tree *tree;
    const ff_node *node; /* NULL: none */
    ff_area area;
    unsigned coarser;
    enum ff_lowered how;
} ff_patch;
void ff_patch_make(ff_patch *patch, const ff_tree *tree, const ff_node *node, enum ff_lowered how);
/* Height of its surface at a place on it. */
int32_t ff_patch_z_wu(const ff_patch *patch, const int32_t place_wu[2]);

/* ff_restrict.c */
unsigned ff_coarser_mask(const ff_tree *tree, const ff_node *node);
void ff_want(ff_tree *tree, uint32_t slot, uint32_t value);
/* Makes everything wanted that nodes of ground `g` need beside them: those that became wanted since
 * the lists began with `before`. Then its tiles out of view that are new and lack what nodes in
 * view need there stop being active: they do not join the cut yet. */
void ff_want_close(ff_tree *tree, uint32_t g, const uint32_t before[FF_LEVELS_MAX]);
/* Marks what a node that is seen needs beside it: to split, or to be drawn without leaving out
 * vertices at a side. */
void ff_need_beside(ff_tree *tree, const ff_node *node);
/* 1 when a wanted node is seen, or needed by one that is: its children are wished for in view. Once
 * the cut is listed. */
int ff_node_needed(const ff_tree *tree, const ff_node *node);
/* 1 for a wanted node of such a tile. */
int ff_tile_waits(const ff_tree *tree, const ff_node *node);

/* ff_limit.c. begin: puts the last selection's quality into force, for a cut to be made with.
 * again: 1 when the cut made is to be made anew, with the quality that is then in force. */
typedef struct ff_limit_search {
    int over, under; /* coarsest step found to pass the limit, finest found to keep it */
    unsigned tries;
} ff_limit_search;
void ff_limit_begin(ff_tree *tree, ff_limit_search *search);
int ff_limit_again(ff_tree *tree, ff_limit_search *search);
/* Sets wish_value for the cut made. */
void ff_limit_wishes(ff_tree *tree);

/* ff_wish.c */
void ff_wish_make(ff_tree *tree);

/* ff_sort.c */
void ff_sort_keys(uint64_t *keys, uint32_t count);

/* ff_strips.c: triangles of one side from its one end to the other, counter-clockwise, with vertex
 * = row * (n+1) + column; the first vertex of a triangle is the one that the next triangle lacks.
 * Returns how many there are (at most 2n). */
unsigned ff_side_triangles(unsigned node_log2, enum ff_side side, unsigned difference,
                           uint16_t triangle[][3]);

#endif
