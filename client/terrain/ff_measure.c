/* Distances and the two node measures, all in integers. Boxes are relative to the camera. */
#include "ff_tree_local.h"
#include "../../protocol/ff_entry.h"

#define WALK_ACROSS 256u /* tiles along an axis of a view */
FF_STATIC_ASSERT(WALK_ACROSS *WALK_ACROSS == FF_ENTRY_TILES_MAX);

/* As far as that, or as tiles reach that may be walked over at every picture: whoever tells of a
 * terrain says how small they are. */
static int32_t within_walk(const ff_terrain_info *info, int32_t view_wu)
{
    int64_t most_wu = (int64_t)ff_node_edge_wu(info, 0) * (WALK_ACROSS / 2 - 1);
    if (ff_shape_tiles(info) <= FF_ENTRY_TILES_MAX || view_wu <= most_wu) return view_wu;
    return (int32_t)most_wu;
}

static ff_reach reach_of(const ff_tree *tree, uint32_t g, int32_t view_wu)
{
    int64_t height_wu[2];
    ff_terrain_range_wu(&tree->ground[g], height_wu);
    FF_ASSERT(height_wu[0] <= height_wu[1] && view_wu >= 0);
    return ff_shape_reach(&tree->ground[g], &tree->view.frame, tree->view.centre_wu,
                          within_walk(&tree->ground[g], view_wu), height_wu);
}

static int has_tiles(const ff_tree *tree, uint32_t g)
{
    ff_walk walk = ff_shape_walk(&tree->ground[g], &tree->window[g]);
    uint32_t tile;
    return ff_shape_next(&tree->ground[g], &walk, &tile);
}

/* Of several grounds those that show as too little have no window. */
void ff_window_make(ff_tree *tree)
{
    uint32_t in_reach = 0;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        tree->window[g] = reach_of(tree, g, tree->quality.view_wu);
        if (!tree->cover || !has_tiles(tree, g)) continue;
        if (ff_cover_is_small(tree, g)) tree->window[g] = reach_of(tree, g, 0);
        in_reach += (uint32_t)has_tiles(tree, g);
    }
    if (tree->cover) tree->cover->alone = in_reach <= 1;
}

int ff_tile_active(const ff_tree *tree, uint32_t tile)
{
    uint32_t g = ff_ground_number(tree, tile);
    return ff_shape_reaches(&tree->ground[g], &tree->window[g], tile);
}

/* The first tile of a ground in view, from the window's middle outwards, whose root is not held,
 * nor ground of another drawn there. 0: there is none. */
static int first_missing(ff_tree *tree, uint32_t g, uint32_t *tile)
{
    const ff_terrain_info *info = &tree->ground[g];
    ff_walk walk = ff_shape_walk_out(info, &tree->view.frame, &tree->window[g],
                                     tree->view.centre_wu);
    while (ff_shape_next(info, &walk, tile)) {
        if (ff_tree_find(tree, ff_key_make(*tile, 0, 0)) != FF_SLOT_NONE) continue;
        tree->roots_missing = 1;
        if (tree->cover && ff_cover_fills(tree, *tile)) continue;
        ff_box box;
        ff_tile_box(tree, *tile, &box);
        if (ff_box_in_view(tree, &box)) return 1;
    }
    return 0;
}

/* The walk goes outwards in squares of tiles: what comes after the first tile that is not held lies
 * no more than a tile nearer. */
void ff_whole_make(ff_tree *tree)
{
    uint32_t tile;
    tree->whole_wu = tree->quality.view_wu;
    tree->roots_missing = 0;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        if (!first_missing(tree, g, &tile)) continue;
        int64_t near_wu = ff_tile_distance(tree, tile) - ff_node_edge_wu(&tree->ground[g], 0);
        near_wu = near_wu > 0 ? near_wu : 0;
        if (near_wu < tree->whole_wu) tree->whole_wu = (int32_t)near_wu;
    }
}

int64_t ff_tile_distance(const ff_tree *tree, uint32_t tile)
{
    int64_t distance = ff_shape_tile_distance(ff_ground_of_tile(tree, tile), &tree->view.frame,
                                              tree->view.centre_wu, tile);
    FF_ASSERT(distance >= 0 && distance < INT64_C(1) << 33);
    return distance;
}

void ff_tree_heights_wu(const ff_terrain_info *info, const ff_node *node, int64_t height_wu[2])
{
    int64_t error = ff_steps_wu(info, ff_geometric_error_decode(node->error_code));
    FF_ASSERT(error >= 0 && node->height_min <= node->height_max);
    height_wu[0] = ff_height_wu(info, node->height_min) - error;
    height_wu[1] = ff_height_wu(info, node->height_max) + error;
}

void ff_node_box(const ff_tree *tree, const ff_node *node, ff_box *box)
{
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    int64_t height_wu[2];
    ff_tree_heights_wu(info, node, height_wu);
    *box = ff_shape_box(info, node->key, &node->placed, height_wu, tree->view.camera.pos_wu);
}

void ff_tile_box(const ff_tree *tree, uint32_t tile, ff_box *box)
{
    const ff_terrain_info *info = ff_ground_of_tile(tree, tile);
    ff_key key = ff_key_make(tile, 0, 0);
    ff_placed placed = ff_shape_put(info, &tree->view.frame, key);
    int64_t height_wu[2];
    ff_terrain_range_wu(info, height_wu);
    *box = ff_shape_box(info, key, &placed, height_wu, tree->view.camera.pos_wu);
    FF_ASSERT(box->lo[2] <= box->hi[2] && box->hi[2] - box->lo[2] < INT64_C(1) << 33);
}

static int64_t outside(int64_t value, int64_t lo, int64_t hi)
{
    FF_ASSERT(lo <= hi);
    if (value < lo) return lo - value;
    return value > hi ? value - hi : 0;
}

int ff_box_beyond_view(const ff_tree *tree, const ff_box *box)
{
    for (unsigned axis = 0; axis < 3; axis++) {
        int64_t middle = (int64_t)tree->view.centre_wu[axis] - tree->view.camera.pos_wu[axis];
        if (outside(middle, box->lo[axis], box->hi[axis]) > tree->quality.view_wu) return 1;
    }
    return 0;
}

int ff_box_in_hole(const ff_tree *tree, const ff_box *box)
{
    for (unsigned axis = 0; axis < 3; axis++) {
        int64_t middle = (int64_t)tree->view.centre_wu[axis] - tree->view.camera.pos_wu[axis];
        FF_ASSERT(box->lo[axis] <= box->hi[axis]);
        if (middle - box->lo[axis] >= tree->quality.hole_wu ||
            box->hi[axis] - middle >= tree->quality.hole_wu)
            return 0;
    }
    return 1;
}

int64_t ff_box_distance(const ff_box *box)
{
    int64_t distance = c3d_length64(outside(0, box->lo[0], box->hi[0]),
                                    outside(0, box->lo[1], box->hi[1]),
                                    outside(0, box->lo[2], box->hi[2]));
    FF_ASSERT(distance >= 0 && distance < INT64_C(1) << 40); /* beside a slot in a sort key */
    return distance;
}

uint32_t ff_projected_error_q8(const ff_tree *tree, const ff_node *node, uint64_t distance)
{
    uint64_t error = (uint64_t)ff_steps_wu(ff_ground_of(tree, node->key),
                                           ff_geometric_error_decode(node->error_code));
    FF_ASSERT(error <= INT32_MAX && tree->view.camera.focal_q8 > 0);
    return c3d_divide_saturated(error * (uint64_t)tree->view.camera.focal_q8,
                                distance ? distance : 1);
}

/* How many times as wrong as others a node may be. */
static uint32_t coarse_times(const ff_tree *tree, const ff_box *box)
{
    int32_t fine_wu = tree->quality.fine_wu;
    if (tree->quality.coarse <= 1) return 1;
    return box->lo[0] > fine_wu || box->hi[0] < -fine_wu || box->lo[1] > fine_wu ||
                   box->hi[1] < -fine_wu
               ? tree->quality.coarse
               : 1;
}

/* Hybrid, eq. 3: f = d / (e * C), from the viewer to the middle of the node at its mean height. */
static uint32_t value_by_distance(const ff_tree *tree, const ff_node *node)
{
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    int64_t edge = ff_node_edge_wu(info, ff_key_level(node->key)), way[3];
    ff_shape_to_middle(info, node->key, &node->placed, ff_height_wu(info, node->height_mean),
                       tree->view.camera.pos_wu, way);
    uint64_t d = (uint64_t)c3d_length64(way[0], way[1], way[2]);
    uint64_t reach = (uint64_t)edge * (uint64_t)tree->quality.c_q8;
    FF_ASSERT(reach <= UINT64_C(1) << (31 + 24));
    return c3d_divide_saturated(reach << 8, d ? d : 1);
}

uint32_t ff_value_of_split(const ff_tree *tree, const ff_node *node)
{
    FF_ASSERT(ff_key_level(node->key) < ff_terrain_levels(ff_ground_of(tree, node->key)));
    ff_box box;
    int by_distance = tree->quality.measure == FF_MEASURE_DISTANCE;
    if (by_distance && tree->quality.coarse <= 1) return value_by_distance(tree, node);
    ff_node_box(tree, node, &box);
    uint32_t times = coarse_times(tree, &box);
    if (by_distance) return value_by_distance(tree, node) / times;
    uint64_t error_q8 = ff_projected_error_q8(tree, node, (uint64_t)ff_box_distance(&box));
    FF_ASSERT(tree->quality.error_px_q8 > 0);
    return c3d_divide_saturated(error_q8 << 16, (uint64_t)tree->quality.error_px_q8 * times);
}
