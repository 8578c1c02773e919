/* The dive: vertices of a ground inside the rectangle of one before it. */
#include "ff_seam.h"

#define MARGIN_WU 4 /* more than heights and places are rounded by */

static int overlaps(const ff_area *a, const ff_area *b)
{
    return a->lo[0] < b->hi[0] && a->hi[0] > b->lo[0] && a->lo[1] < b->hi[1] && a->hi[1] > b->lo[1];
}

static int holds(const ff_area *area, const int32_t place_wu[2])
{
    return place_wu[0] > area->lo[0] && place_wu[0] < area->hi[0] && place_wu[1] > area->lo[1] &&
           place_wu[1] < area->hi[1];
}

int ff_seam_dives(const ff_tree *tree, const ff_node *node)
{
    const ff_cover *cover = tree->cover;
    uint32_t rank = cover->rank[ff_ground_number(tree, ff_key_tile(node->key))];
    if (rank == 0) return 0;
    ff_area area = ff_area_of(tree, node->key, &node->placed);
    while (rank-- > 0)
        if (overlaps(&area, &cover->stands[cover->ranked[rank]])) return 1;
    return 0;
}

/* Samples and edges reach half a cell beyond the node, and whole ones from its inner border; beside
 * it cells are twice as large. */
uint64_t ff_seam_dive_of(const ff_tree *tree, const ff_node *node)
{
    const ff_cover *cover = tree->cover;
    uint32_t g = ff_ground_number(tree, ff_key_tile(node->key));
    int64_t cell_wu = ff_node_cell_wu(&tree->ground[g], ff_key_level(node->key));
    ff_area area = ff_area_of(tree, node->key, &node->placed),
            wide = ff_area_widened(area, 2 * cell_wu);
    uint64_t hash = ff_seam_hash(tree, g, &wide, FF_LOWERED_NOT, 0);
    /* its own, for its rim */
    for (uint32_t rank = 0; rank <= cover->rank[g]; rank++) {
        const ff_area *stands = &cover->stands[cover->ranked[rank]];
        if (!overlaps(&wide, stands)) continue;
        for (unsigned axis = 0; axis < 2; axis++)
            hash = (hash ^ (uint32_t)stands->lo[axis] ^
                    (uint64_t)(uint32_t)stands->hi[axis] << 32) *
                   UINT64_C(0x9E3779B97F4A7C15);
        if (rank < cover->rank[g])
            hash = ff_seam_hash(tree, cover->ranked[rank], &wide, FF_LOWERED_DIVED, hash);
    }
    return hash > 1 ? hash : 2;
}

/* ---- a vertex ---- */

/* What meets in a vertex: the largest cell of the nodes drawn there, and whether the sheet ends
 * there because a ground before it is drawn. */
typedef struct meeting {
    int32_t cell_wu;
    int ends;
} meeting;

/* 1 where a ground lies and is left out. */
static int is_left_out(const ff_tree *tree, const ff_terrain_info *info, const int32_t place_wu[2])
{
    const int32_t place[3] = { place_wu[0], place_wu[1], 0 };
    const ff_cover *cover = tree->cover;
    ff_spot spot;
    if (!ff_shape_locate(info, &tree->view.frame, place, &spot)) return 0;
    if (ff_left_out(tree, ff_key_make(spot.tile, 0, 0))) return 1;
    uint32_t slot = ff_tree_find(tree, ff_key_make(spot.tile, 0, 0));
    if (slot == FF_SLOT_NONE || !(tree->node[slot].flags & FF_NODE_ACTIVE)) return 0;
    /* its root takes part, and nothing is drawn: some node below it is left out */
    for (uint32_t rank = 0; rank < cover->rank[info - tree->ground]; rank++)
        if (holds(&cover->stands[cover->ranked[rank]], place_wu)) return 1;
    return 0;
}

static meeting meeting_at(const ff_tree *tree, const ff_terrain_info *info,
                          const int32_t place_wu[2])
{
    meeting found = { 0, 0 };
    for (unsigned quarter = 0; quarter < 4; quarter++) {
        const int32_t beside_wu[2] = { place_wu[0] + (quarter & 1 ? 1 : -1),
                                       place_wu[1] + (quarter & 2 ? 1 : -1) };
        const ff_node *node = ff_surface_node(tree, info, beside_wu);
        if (node) {
            int32_t cell_wu = ff_node_cell_wu(info, ff_key_level(node->key));
            found.cell_wu = cell_wu > found.cell_wu ? cell_wu : found.cell_wu;
        } else {
            found.ends |= is_left_out(tree, info, beside_wu);
        }
    }
    return found;
}

/* A ground that dives, and one that it dives under, where they were asked last. */
typedef struct pair {
    const ff_tree *tree;
    const ff_terrain_info *info, *over;
    uint32_t f; /* number of the one over it */
    ff_patch own, other;
} pair;

/* The ground's node at a place; 0: none is drawn there. Inside the last one it is not looked for;
 * on a border always, so that it does not matter who asks. */
static int find_patch(const ff_tree *tree, const ff_terrain_info *info, const int32_t place_wu[2],
                      enum ff_lowered how, ff_patch *patch)
{
    if (patch->node && holds(&patch->area, place_wu)) return 1;
    const ff_node *node = ff_surface_node(tree, info, place_wu);
    if (!node) return 0;
    if (node != patch->node) ff_patch_make(patch, tree, node, how);
    return 1;
}

/* How much it is higher at a place where both are drawn; INT32_MIN where not. */
static int32_t higher_by(pair *p, const int32_t place_wu[2])
{
    if (!find_patch(p->tree, p->info, place_wu, FF_LOWERED_NOT, &p->own) ||
        !find_patch(p->tree, p->over, place_wu, FF_LOWERED_DIVED, &p->other))
        return INT32_MIN;
    int64_t by_wu = (int64_t)ff_patch_z_wu(&p->own, place_wu) - ff_patch_z_wu(&p->other, place_wu);
    return by_wu > INT32_MAX ? INT32_MAX : by_wu < -INT32_MAX ? -INT32_MAX : (int32_t)by_wu;
}

/* 1 when edges that meet in a place may run over the rim. */
static int near_rim(const ff_area *stands, const int32_t place_wu[2], int32_t cell_wu)
{
    for (unsigned axis = 0; axis < 2; axis++)
        if ((int64_t)place_wu[axis] - cell_wu <= stands->lo[axis] ||
            (int64_t)place_wu[axis] + cell_wu >= stands->hi[axis])
            return 1;
    return 0;
}

/* The same at a vertex and half-way along the edges that meet there, at most. Near the rim at the
 * vertex alone: how much further down it goes is seen as a ditch outside. */
static int32_t highest_by(pair *p, const int32_t place_wu[2], int32_t cell_wu)
{
    static const int8_t way[][2] = { { 0, 0 },  { 1, 0 }, { -1, 0 }, { 0, 1 },
                                     { 0, -1 }, { 1, 1 }, { -1, -1 } };
    unsigned count = near_rim(&p->tree->cover->stands[p->f], place_wu, cell_wu)
                         ? 1
                         : sizeof way / sizeof way[0];
    int32_t most = INT32_MIN;
    for (unsigned i = 0; i < count; i++) {
        const int32_t at_wu[2] = { place_wu[0] + way[i][0] * (cell_wu / 2),
                                   place_wu[1] + way[i][1] * (cell_wu / 2) };
        int32_t by_wu = higher_by(p, at_wu);
        most = by_wu > most ? by_wu : most;
    }
    return most;
}

/* The lowest that a node's vertices dive to. */
static int32_t lowest_of(const ff_tree *tree, const ff_node *node)
{
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    uint32_t slot = ff_slot_of(tree, node);
    const uint16_t *dive = ff_seam_drop(tree, slot, FF_LOWERED_DIVED),
                   *height = tree->heights + slot * ff_heights_per_node(tree);
    int32_t lowest = node->height_min;
    for (size_t i = 0; dive && i < ff_heights_per_node(tree); i++)
        if (height[i] - dive[i] < lowest) lowest = height[i] - dive[i];
    return info->hoffset_wu + (int32_t)(((int64_t)lowest * info->hscale_q24) >> 16);
}

/* No node of a ground drawn within a cell of a place is anywhere lower than this; INT32_MAX: there
 * is none. */
static int32_t lowest_beside(const ff_tree *tree, uint32_t f, const int32_t place_wu[2],
                             int32_t cell_wu)
{
    const ff_area at = { { place_wu[0], place_wu[1] }, { place_wu[0], place_wu[1] } };
    ff_area star = ff_area_widened(at, cell_wu);
    int32_t lowest_wu = INT32_MAX;
    ff_over over;
    ff_over_begin(&over, tree, f, &star);
    for (const ff_node *node; (node = ff_over_next(&over)) != NULL;) {
        int32_t of_wu = lowest_of(tree, node);
        lowest_wu = of_wu < lowest_wu ? of_wu : lowest_wu;
    }
    return lowest_wu;
}

/* 1 on the rim of the ground that a vertex belongs to. */
static int on_rim(const ff_area *stands, const int32_t place_wu[2])
{
    return place_wu[0] == stands->lo[0] || place_wu[0] == stands->hi[0] ||
           place_wu[1] == stands->lo[1] || place_wu[1] == stands->hi[1];
}

/* How far a vertex at a height dives. */
static int64_t dive_of(pair *p, const int32_t place_wu[3], const meeting *meet)
{
    const ff_area *own = &p->tree->cover->stands[p->info - p->tree->ground];
    int64_t sag_wu = ff_shape_drop_wu(p->info, meet->cell_wu, 0),
            by_wu = highest_by(p, place_wu, meet->cell_wu);
    /* as far below as one step is: what agrees is not to flicker */
    if (by_wu > INT32_MIN) by_wu += ff_steps_wu(p->info, 1) + MARGIN_WU + sag_wu;
    if (!meet->ends && !on_rim(own, place_wu)) return by_wu;
    int32_t lowest_wu = lowest_beside(p->tree, p->f, place_wu, meet->cell_wu);
    if (lowest_wu == INT32_MAX) return by_wu;
    int64_t end_wu = (int64_t)place_wu[2] - lowest_wu + MARGIN_WU + sag_wu;
    return end_wu > by_wu ? end_wu : by_wu;
}

/* Dives under one ground. 0 when a vertex should go too deep. */
static int dive_under(pair *p, const ff_node *node, uint16_t *dive)
{
    const ff_tree *tree = p->tree;
    const uint16_t *height = tree->heights + ff_slot_of(tree, node) * ff_heights_per_node(tree);
    ff_area area = ff_area_of(tree, node->key, &node->placed);
    uint32_t side = ff_node_side(p->info);
    int deep = 0;
    for (uint32_t i = 0; i < side * side; i++) {
        int32_t place_wu[3];
        meeting meet = { ff_node_cell_wu(p->info, ff_key_level(node->key)), 0 };
        ff_shape_place(p->info, node->key, &node->placed, i % side, i / side, height[i], place_wu);
        if (!holds(&tree->cover->stands[p->f], place_wu)) continue;
        if (!holds(&area, place_wu)) meet = meeting_at(tree, p->info, place_wu);
        int64_t by_wu = dive_of(p, place_wu, &meet);
        if (by_wu > 0) deep |= !ff_seam_lower(&dive[i], ff_seam_steps(p->info, by_wu));
    }
    return !deep;
}

int ff_seam_dive(const ff_tree *tree, const ff_node *node, uint16_t *dive)
{
    const ff_cover *cover = tree->cover;
    pair p = { .tree = tree, .info = ff_ground_of(tree, node->key) };
    int enough = 1;
    for (uint32_t rank = 0; rank < cover->rank[p.info - tree->ground]; rank++) {
        p.f = cover->ranked[rank];
        p.over = &tree->ground[p.f];
        p.other.node = NULL;
        enough &= dive_under(&p, node, dive);
    }
    return enough;
}
