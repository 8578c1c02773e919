/* The drawn surface: vertices for the renderer, and its height at a point. */
#include "ff_tree_local.h"
#include "ff_shade.h"

#include <string.h>

#define FRAMED_MAX (((1 << FF_NODE_LOG2_MAX) + 3) * ((1 << FF_NODE_LOG2_MAX) + 3))

/* Index of the sample `along` a side and `depth` samples inside it, in a grid with `stride` samples
 * a row and `last` the last one. */
static size_t side_index(enum ff_side side, uint32_t along, uint32_t depth, uint32_t last,
                         size_t stride)
{
    FF_ASSERT(along <= last && depth <= last);
    switch (side) {
        case FF_SIDE_EAST: return along * stride + last - depth;
        case FF_SIDE_NORTH: return (last - depth) * stride + along;
        case FF_SIDE_WEST: return along * stride + depth;
        default: return depth * stride + along;
    }
}

/* The height beyond a rim that gives it the slope of the two cells inside. */
static uint16_t beyond(int32_t rim, int32_t inside, int32_t further)
{
    int32_t height = rim + inside - further;
    return (uint16_t)(height < 0 ? 0 : height > UINT16_MAX ? UINT16_MAX : height);
}

/* Adds a row beyond a side: the neighbour's first row inside when a neighbour of the same level is
 * held, else heights that go on as the ground inside does. */
static void frame_side(const ff_tree *tree, const ff_drawn *drawn, enum ff_side side,
                       uint16_t *framed)
{
    uint32_t samples = ff_node_side(tree->ground), last = samples - 1;
    FF_ASSERT(last >= 2); /* the slope of two cells */
    ff_beside beside = ff_shape_neighbour(ff_ground_of(tree, drawn->key), drawn->key, side);
    uint32_t slot = beside.key == FF_KEY_NONE ? FF_SLOT_NONE : ff_tree_find(tree, beside.key);
    for (uint32_t along = 0; along < samples; along++) {
        uint16_t *out = &framed[side_index(side, along + 1, 0, last + 2, samples + 2)];
        if (slot != FF_SLOT_NONE) {
            const uint16_t *other = tree->heights + slot * ff_heights_per_node(tree);
            *out = other[side_index(beside.side, ff_beside_along(&beside, along, last), 1, last,
                                    samples)];
            continue;
        }
        *out = beyond(drawn->heights[side_index(side, along, 0, last, samples)],
                      drawn->heights[side_index(side, along, 1, last, samples)],
                      drawn->heights[side_index(side, along, 2, last, samples)]);
    }
}

/* Where the ground ends inside the node, heights beyond its last column and row go on likewise: the
 * padding would make its rim level. */
static void frame_edge(const ff_tree *tree, const ff_drawn *drawn, uint16_t *framed)
{
    uint32_t samples = ff_node_side(tree->ground), stride = samples + 2;
    ff_extent drawn_cells = ff_drawn_cells(tree, drawn->key);
    uint32_t column = drawn_cells.columns + 1, row = drawn_cells.rows + 1;
    for (uint32_t i = 1; column < samples && i <= samples; i++) {
        uint16_t *rim = framed + i * stride + column;
        rim[1] = beyond(rim[0], *(rim - 1), *(rim - 2));
    }
    for (uint32_t i = 1; row < samples && i <= samples; i++) {
        uint16_t *rim = framed + row * stride + i;
        rim[stride] = beyond(rim[0], *(rim - stride), *(rim - 2 * stride));
    }
}

static void frame_heights(const ff_tree *tree, const ff_drawn *drawn, uint16_t *framed)
{
    uint32_t samples = ff_node_side(tree->ground);
    FF_ASSERT((samples + 2) * (samples + 2) <= FRAMED_MAX);
    for (uint32_t row = 0; row < samples; row++)
        memcpy(framed + (row + 1) * (samples + 2) + 1, drawn->heights + row * samples,
               samples * sizeof *framed);
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++)
        frame_side(tree, drawn, (enum ff_side)side, framed);
    frame_edge(tree, drawn, framed);
}

const uint16_t *ff_tree_drop(const ff_tree *tree, const ff_drawn *drawn)
{
    return tree->seams ? ff_seam_drop(tree, ff_slot_of(tree, drawn->node), FF_LOWERED_DRAWN) : NULL;
}

void ff_tree_vertices(const ff_tree *tree, const ff_drawn *drawn, int shaded, c3d_vertex *out)
{
    uint16_t framed[FRAMED_MAX];
    const ff_terrain_info *info = ff_ground_of(tree, drawn->key);
    ff_shade_grid grid = {
        info, drawn->key, drawn->cell_wu, framed, { info->height_min, info->height_max }
    };
    const uint16_t *drop = ff_tree_drop(tree, drawn);
    uint32_t side = ff_node_side(info);
    if (tree->ground_count > 1) ff_grounds_ramp(tree, info, grid.ramp);
    if (shaded) frame_heights(tree, drawn, framed);
    for (uint32_t row = 0; row < side; row++) {
        for (uint32_t column = 0; column < side; column++, out++) {
            out->x = (int32_t)column;
            out->y = (int32_t)row;
            out->z = drawn->heights[row * side + column] - 32768;
            if (drop) out->z -= drop[row * side + column];
            if (shaded)
                ff_shade(&grid, column, row, out->rgba);
            else
                memset(out->rgba, 255, sizeof out->rgba);
        }
    }
}

/* 1 where a ground stands that is drawn over one after it; as wide as a triangle reaches. */
static int is_under(const ff_tree *tree, uint32_t ground, const int32_t place_wu[3])
{
    const ff_cover *cover = tree->cover;
    for (uint32_t rank = 0; rank < cover->rank[ground]; rank++) {
        const ff_area *area = &cover->stands[cover->ranked[rank]];
        if (place_wu[0] >= area->lo[0] && place_wu[0] <= area->hi[0] &&
            place_wu[1] >= area->lo[1] && place_wu[1] <= area->hi[1])
            return 1;
    }
    return 0;
}

void ff_tree_clear_hidden(const ff_tree *tree, const ff_drawn *drawn, c3d_vertex *vertices)
{
    const ff_terrain_info *info = ff_ground_of(tree, drawn->key);
    uint32_t side = ff_node_side(info), ground = (uint32_t)(info - tree->ground);
    int32_t place_wu[3];
    FF_ASSERT(drawn->node != NULL && ground < tree->ground_count);
    if (!tree->cover || !tree->cover->rank[ground]) return;
    for (uint32_t i = 0; i < side * side; i++) {
        ff_shape_place(info, drawn->key, &drawn->node->placed, i % side, i / side,
                       drawn->heights[i], place_wu);
        if (is_under(tree, ground, place_wu)) vertices[i].rgba[3] = 0;
    }
}

/* A point in a node's grid, Q16 cells from its south-west corner. */
typedef struct grid_point {
    int64_t x, y;
} grid_point;

/* A node's heights as they are drawn, less `drop` where it is not NULL: columns and rows beyond
 * `last` lie on it. */
typedef struct drawn_grid {
    const uint16_t *heights, *drop;
    unsigned side;
    grid_point last;
} drawn_grid;

static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

/* Heights of a triangle weighted by the areas opposite its vertices; 0 when the point lies
 * outside. */
static int height_in_triangle(const drawn_grid *grid, const uint16_t triangle[3], grid_point at,
                              int64_t *height_q16)
{
    grid_point corner[3];
    for (unsigned i = 0; i < 3; i++) {
        corner[i].x = least((int64_t)(triangle[i] % grid->side) << 16, grid->last.x);
        corner[i].y = least((int64_t)(triangle[i] / grid->side) << 16, grid->last.y);
    }
    int64_t area = 0, sum = 0;
    for (unsigned i = 0; i < 3; i++) {
        const grid_point *a = &corner[(i + 1) % 3], *b = &corner[(i + 2) % 3];
        int64_t weight = (a->x - at.x) * (b->y - at.y) - (b->x - at.x) * (a->y - at.y);
        if (weight < 0) return 0;
        area += weight;
        sum += weight * grid->heights[triangle[i]];
        if (grid->drop) sum -= weight * grid->drop[triangle[i]];
    }
    if (area == 0) return 0; /* of padding */
    int64_t whole = sum / area, part = sum % area;
    if (part < 0) {
        whole--;
        part += area;
    }
    *height_q16 = whole * 65536 + (int64_t)(((uint64_t)part << 16) / (uint64_t)area);
    FF_ASSERT(*height_q16 <= (int64_t)UINT16_MAX << 16);
    return 1;
}

/* Cells of FULL and INNER: two triangles, diagonal from south-west to north-east. */
static int64_t height_in_cell(const drawn_grid *grid, unsigned column, unsigned row, grid_point at)
{
    unsigned side = grid->side;
    uint16_t south_west = (uint16_t)(row * side + column),
             north_east = (uint16_t)(south_west + side + 1);
    uint16_t below[3] = { south_west, (uint16_t)(south_west + 1), north_east };
    uint16_t above[3] = { south_west, north_east, (uint16_t)(south_west + side) };
    int64_t height_q16 = 0;
    FF_ASSERT(column + 1 < side && row + 1 < side);
    if (!height_in_triangle(grid, below, at, &height_q16))
        (void)height_in_triangle(grid, above, at, &height_q16);
    return height_q16;
}

static int64_t height_in_sides(const ff_tree *tree, const drawn_grid *grid, unsigned coarser,
                               grid_point at)
{
    uint16_t triangle[2 << FF_NODE_LOG2_MAX][3];
    int64_t height_q16 = 0;
    FF_ASSERT(coarser < 1u << FF_SIDE_COUNT);
    for (unsigned side = 0; side < FF_SIDE_COUNT; side++) {
        unsigned count = ff_side_triangles(tree->ground->node_log2, (enum ff_side)side,
                                           coarser >> side & 1u, triangle);
        for (unsigned i = 0; i < count; i++) {
            if (height_in_triangle(grid, triangle[i], at, &height_q16)) return height_q16;
        }
    }
    FF_ASSERT(!"the sides of a node cover its rim");
    return 0;
}

/* `coarser` as of ff_drawn, or FF_COARSER_UNKNOWN. */
static int64_t height_in_node(const ff_tree *tree, const ff_node *node, grid_point at,
                              unsigned coarser, enum ff_lowered how)
{
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    unsigned side = ff_node_side(info), last = side - 2,
             cell_log2 = info->tile_log2 - info->node_log2 - ff_key_level(node->key);
    ff_extent extent = ff_shape_extent(info, node->key);
    uint32_t slot = ff_slot_of(tree, node);
    const drawn_grid grid = { .heights = tree->heights + slot * ff_heights_per_node(tree),
                              .drop = tree->seams ? ff_seam_drop(tree, slot, how) : NULL,
                              .side = side,
                              .last = { ((int64_t)extent.columns << 16) >> cell_log2,
                                        ((int64_t)extent.rows << 16) >> cell_log2 } };
    FF_ASSERT(at.x <= grid.last.x && at.y <= grid.last.y);
    unsigned column = (unsigned)(least(at.x, grid.last.x - 1) >> 16),
             row = (unsigned)(least(at.y, grid.last.y - 1) >> 16);

    int on_rim = column == 0 || row == 0 || column == last || row == last;
    if (!on_rim)
        coarser = 0;
    else if (coarser == FF_COARSER_UNKNOWN)
        coarser = ff_coarser_mask(tree, node);
    if (coarser) return height_in_sides(tree, &grid, coarser, at);
    return height_in_cell(&grid, column, row, at);
}

/* The drawn node below a root over which a spot lies; *at is the spot in its grid. NULL where it is
 * left out. */
static const ff_node *node_at(const ff_tree *tree, const ff_node *node, const ff_spot *spot,
                              grid_point *at)
{
    const ff_terrain_info *info = ff_ground_of_tile(tree, spot->tile);
    /* in samples, Q16, from the node's south-west corner */
    uint64_t column = spot->column_q16, row = spot->row_q16,
             half = UINT64_C(1) << (15 + info->tile_log2);
    for (; node->flags & FF_NODE_SPLIT; half >>= 1) {
        FF_ASSERT(ff_node_has_children(node));
        /* the last sample may lie in the middle: then nothing is held beyond it */
        unsigned east = column >= half && node->child[1] != FF_SLOT_NONE,
                 north = row >= half && node->child[2] != FF_SLOT_NONE;
        column -= east ? half : 0;
        row -= north ? half : 0;
        node = &tree->node[node->child[2 * north + east]];
        if (node->flags & FF_NODE_LEFT_OUT) return NULL;
    }
    unsigned cell_log2 = info->tile_log2 - info->node_log2 - ff_key_level(node->key);
    FF_ASSERT(column <= 2 * half && row <= 2 * half); /* the node's edge by now */
    *at = (grid_point){ (int64_t)(column >> cell_log2), (int64_t)(row >> cell_log2) };
    return node;
}

/* A ground's node of the cut over or under a place, within the view or beyond it; NULL where there
 * is none. *at is the place in its grid. */
static const ff_node *cut_at(const ff_tree *tree, const ff_terrain_info *info,
                             const int32_t place_wu[3], grid_point *at)
{
    ff_spot spot;
    if (!ff_shape_locate(info, &tree->view.frame, place_wu, &spot)) return NULL;
    uint32_t slot = ff_tree_find(tree, ff_key_make(spot.tile, 0, 0));
    if (slot == FF_SLOT_NONE || !ff_tile_active(tree, spot.tile)) return NULL;
    if (tree->cover && !(tree->node[slot].flags & FF_NODE_ACTIVE)) return NULL;
    return node_at(tree, &tree->node[slot], &spot, at);
}

/* The same where it is drawn. */
static const ff_node *drawn_of(const ff_tree *tree, const ff_terrain_info *info,
                               const int32_t place_wu[3], grid_point *at)
{
    const ff_node *node = cut_at(tree, info, place_wu, at);
    ff_box box;
    if (!node) return NULL;
    ff_node_box(tree, node, &box);
    return ff_box_beyond_view(tree, &box) ? NULL : node;
}

const ff_node *ff_surface_node(const ff_tree *tree, const ff_terrain_info *info,
                               const int32_t place_wu[2])
{
    const int32_t place[3] = { place_wu[0], place_wu[1], tree->view.camera.pos_wu[2] };
    grid_point at;
    return cut_at(tree, info, place, &at);
}

void ff_patch_make(ff_patch *patch, const ff_tree *tree, const ff_node *node, enum ff_lowered how)
{
    patch->tree = tree;
    patch->node = node;
    patch->area = ff_area_of(tree, node->key, &node->placed);
    patch->coarser = ff_coarser_mask(tree, node);
    patch->how = how;
}

int32_t ff_patch_z_wu(const ff_patch *patch, const int32_t place_wu[2])
{
    const ff_terrain_info *info = ff_ground_of(patch->tree, patch->node->key);
    const int32_t place[3] = { place_wu[0], place_wu[1], 0 };
    const ff_area *area = &patch->area;
    int32_t cell_wu = ff_node_cell_wu(info, ff_key_level(patch->node->key));
    grid_point at = { (((int64_t)place_wu[0] - area->lo[0]) << 16) / cell_wu,
                      (((int64_t)place_wu[1] - area->lo[1]) << 16) / cell_wu };
    FF_ASSERT(place_wu[0] >= area->lo[0] && place_wu[0] <= area->hi[0]);
    FF_ASSERT(place_wu[1] >= area->lo[1] && place_wu[1] <= area->hi[1]);
    return ff_shape_z_wu(info, &patch->tree->view.frame, place,
                         height_in_node(patch->tree, patch->node, at, patch->coarser, patch->how));
}

/* The node that is seen there from above, and its height: the highest of those drawn. z need not be
 * the ground's: it is looked for under or over the point. */
static const ff_node *seen_at(const ff_tree *tree, int32_t x_wu, int32_t y_wu, int32_t *z_wu)
{
    const int32_t place_wu[3] = { x_wu, y_wu, tree->view.camera.pos_wu[2] };
    const ff_node *seen = NULL;
    for (uint32_t rank = 0; tree->has_view && rank < tree->ground_count; rank++) {
        const ff_terrain_info *info = &tree->ground[ff_ground_ranked(tree, rank)];
        grid_point at;
        const ff_node *node = drawn_of(tree, info, place_wu, &at);
        if (!node) continue;
        int32_t here_wu = ff_shape_z_wu(
            info, &tree->view.frame, place_wu,
            height_in_node(tree, node, at, FF_COARSER_UNKNOWN, FF_LOWERED_DRAWN));
        if (seen && here_wu <= *z_wu) continue;
        *z_wu = here_wu;
        seen = node;
    }
    return seen;
}

int ff_tree_drawn_height(const ff_tree *tree, int32_t x_wu, int32_t y_wu, int32_t *z_wu)
{
    return seen_at(tree, x_wu, y_wu, z_wu) != NULL;
}

int ff_tree_drawn_filled(const ff_tree *tree, int32_t x_wu, int32_t y_wu)
{
    int32_t z_wu;
    const ff_node *node = seen_at(tree, x_wu, y_wu, &z_wu);
    return node && node->flags & FF_NODE_FILLED;
}
