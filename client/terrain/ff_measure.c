/* Distances and the two node measures, all in integers. Boxes are relative to the camera. */
#include "ff_tree_local.h"

static int64_t floor_div(int64_t a, int64_t b)
{
    int64_t quotient = a / b;
    return a % b < 0 ? quotient - 1 : quotient;
}

/* Lowest and highest ground of the terrain: all that is known of roots that have not arrived. */
static void terrain_z(const ff_terrain_info *info, int64_t *lo, int64_t *hi)
{
    int64_t slack = ff_steps_wu(info, info->max_error);
    *lo = ff_height_wu(info, info->height_min) - slack;
    *hi = ff_height_wu(info, info->height_max) + slack;
}

static void window_along(int64_t centre, int64_t view, int64_t tile_wu, int64_t tiles,
                         int64_t *first, int64_t *last)
{
    *first = floor_div(centre - view - 1, tile_wu); /* touching counts */
    *last = floor_div(centre + view, tile_wu);
    if (*first < 0) *first = 0;
    if (*last > tiles - 1) *last = tiles - 1;
}

void ff_window_make(ff_tree *tree)
{
    const ff_terrain_info *info = &tree->info;
    const int32_t *centre = tree->view.centre_wu;
    int64_t view = tree->quality.view_wu < 0 ? 0 : tree->quality.view_wu,
            tile_wu = ff_node_edge_wu(info, 0), lo, hi;
    ff_window *window = &tree->window;
    window_along(centre[0], view, tile_wu, info->tiles_x, &window->x0, &window->x1);
    window_along(centre[1], view, tile_wu, info->tiles_y, &window->y0, &window->y1);
    terrain_z(info, &lo, &hi);
    if (window->y1 < window->y0 || lo - centre[2] > view || centre[2] - hi > view)
        window->x1 = window->x0 - 1;
}

int ff_tile_active(const ff_tree *tree, uint32_t tile)
{
    int64_t x = tile % tree->info.tiles_x, y = tile / tree->info.tiles_x;
    const ff_window *window = &tree->window;
    return x >= window->x0 && x <= window->x1 && y >= window->y0 && y <= window->y1;
}

static int64_t outside(int64_t value, int64_t lo, int64_t hi)
{
    if (value < lo) return lo - value;
    return value > hi ? value - hi : 0;
}

static int64_t larger(int64_t a, int64_t b) { return a > b ? a : b; }

int64_t ff_tile_distance(const ff_tree *tree, uint32_t tile)
{
    int64_t edge = ff_node_edge_wu(&tree->info, 0);
    int64_t x = tile % tree->info.tiles_x * edge, y = tile / tree->info.tiles_x * edge;
    return larger(outside(tree->view.centre_wu[0], x, x + edge),
                  outside(tree->view.centre_wu[1], y, y + edge));
}

static void make_box(const ff_tree *tree, int64_t x, int64_t y, int64_t edge, int64_t z_lo,
                     int64_t z_hi, ff_box *box)
{
    const int32_t *eye = tree->view.camera.pos_wu;
    box->lo[0] = x - eye[0];
    box->hi[0] = box->lo[0] + edge;
    box->lo[1] = y - eye[1];
    box->hi[1] = box->lo[1] + edge;
    box->lo[2] = z_lo - eye[2];
    box->hi[2] = z_hi - eye[2];
}

void ff_node_box(const ff_tree *tree, const ff_node *node, ff_box *box)
{
    const ff_terrain_info *info = &tree->info;
    int64_t error = ff_steps_wu(info, ff_geometric_error_decode(node->error_code));
    make_box(tree, node->x_wu, node->y_wu, ff_node_edge_wu(info, ff_key_level(node->key)),
             ff_height_wu(info, node->height_min) - error,
             ff_height_wu(info, node->height_max) + error, box);
}

void ff_tile_box(const ff_tree *tree, uint32_t tile, ff_box *box)
{
    int64_t edge = ff_node_edge_wu(&tree->info, 0), lo, hi;
    terrain_z(&tree->info, &lo, &hi);
    make_box(tree, tile % tree->info.tiles_x * edge, tile / tree->info.tiles_x * edge, edge, lo, hi,
             box);
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
        if (middle - box->lo[axis] >= tree->quality.hole_wu ||
            box->hi[axis] - middle >= tree->quality.hole_wu)
            return 0;
    }
    return 1;
}

int64_t ff_box_distance(const ff_box *box)
{
    return c3d_length64(outside(0, box->lo[0], box->hi[0]), outside(0, box->lo[1], box->hi[1]),
                        outside(0, box->lo[2], box->hi[2]));
}

uint32_t ff_projected_error_q8(const ff_tree *tree, const ff_node *node, uint64_t distance)
{
    uint64_t error = (uint64_t)ff_steps_wu(&tree->info,
                                           ff_geometric_error_decode(node->error_code));
    return c3d_divide_saturated(error * (uint64_t)tree->view.camera.focal_q8,
                                distance ? distance : 1);
}

/* Hybrid, eq. 3: f = d / (e * C), from the viewer to the middle of the node at its mean height. */
static uint32_t value_by_distance(const ff_tree *tree, const ff_node *node)
{
    const int32_t *eye = tree->view.camera.pos_wu;
    int64_t edge = ff_node_edge_wu(&tree->info, ff_key_level(node->key));
    uint64_t d = (uint64_t)c3d_length64(
        (int64_t)node->x_wu + edge / 2 - eye[0], (int64_t)node->y_wu + edge / 2 - eye[1],
        (int64_t)ff_height_wu(&tree->info, node->height_mean) - eye[2]);
    uint64_t reach = (uint64_t)edge * (uint64_t)tree->quality.c_q8; /* below 2^31 * 2^24 */
    return c3d_divide_saturated(reach << 8, d ? d : 1);
}

uint32_t ff_value_of_split(const ff_tree *tree, const ff_node *node)
{
    if (tree->quality.measure == FF_MEASURE_DISTANCE) return value_by_distance(tree, node);
    ff_box box;
    ff_node_box(tree, node, &box);
    uint64_t error_q8 = ff_projected_error_q8(tree, node, (uint64_t)ff_box_distance(&box));
    return c3d_divide_saturated(error_q8 << 16, (uint64_t)tree->quality.error_px_q8);
}
