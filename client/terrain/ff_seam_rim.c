/* Rims: vertices on the border of where a ground stands go below the grounds after it. */
#include "ff_seam.h"

#define SIDE_MAX  ((1 << FF_NODE_LOG2_MAX) + 1)
#define MARGIN_WU 4 /* more than heights are rounded by */

/* The node's area, and what pieces of rim beside it reach: a cell of its neighbours', which may be
 * twice its own. */
static ff_area reach_of(const ff_tree *tree, const ff_node *node)
{
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    ff_area area = ff_area_of(tree, node->key, &node->placed);
    return ff_area_widened(area, 2 * (int64_t)ff_node_cell_wu(info, ff_key_level(node->key)));
}

int ff_seam_has_rim(const ff_tree *tree, const ff_node *node)
{
    const ff_cover *cover = tree->cover;
    uint32_t g = ff_ground_number(tree, ff_key_tile(node->key));
    const ff_area *own = &cover->stands[g];
    ff_area area = ff_area_of(tree, node->key, &node->placed);
    if (area.lo[0] != own->lo[0] && area.hi[0] != own->hi[0] && area.lo[1] != own->lo[1] &&
        area.hi[1] != own->hi[1])
        return 0;
    area = reach_of(tree, node);
    for (uint32_t rank = cover->rank[g] + 1u; rank < tree->ground_count; rank++) {
        const ff_area *other = &cover->stands[cover->ranked[rank]];
        if (area.lo[0] <= other->hi[0] && area.hi[0] >= other->lo[0] &&
            area.lo[1] <= other->hi[1] && area.hi[1] >= other->lo[1])
            return 1;
    }
    return 0;
}

uint64_t ff_seam_rim_of(const ff_tree *tree, const ff_node *node)
{
    const ff_cover *cover = tree->cover;
    uint32_t g = ff_ground_number(tree, ff_key_tile(node->key));
    ff_area area = ff_area_of(tree, node->key, &node->placed), wide = reach_of(tree, node);
    uint64_t hash = ff_seam_hash(tree, g, &area, FF_LOWERED_DIVED, 0);
    for (unsigned axis = 0; axis < 2; axis++)
        hash = (hash ^ (uint32_t)cover->stands[g].lo[axis] ^
                (uint64_t)(uint32_t)cover->stands[g].hi[axis] << 32) *
               UINT64_C(0x9E3779B97F4A7C15);
    for (uint32_t rank = cover->rank[g] + 1u; rank < tree->ground_count; rank++)
        hash = ff_seam_hash(tree, cover->ranked[rank], &wide, FF_LOWERED_DRAWN, hash);
    return hash > 1 ? hash : 2;
}

/* ---- a segment ---- */

/* A piece of a rim between two vertices that are drawn one after the other: it runs along `axis`,
 * at `at_wu` across. Heights are those of the dive. */
typedef struct segment {
    unsigned axis;
    int32_t at_wu, from_wu, to_wu, z_wu[2];
} segment;

/* A node of a ground after it, as the segment sees it: places of its vertices along and across. */
typedef struct under {
    ff_patch patch;
    int32_t along_wu[SIDE_MAX], across_wu[SIDE_MAX];
    int32_t from_wu, to_wu; /* the part of the segment that lies on it */
    unsigned last;
} under;

/* How far the segment is above the node at a place, and at the next one, at most. */
static int64_t above_at(const segment *s, const under *u, int64_t along_wu, int64_t most_wu)
{
    for (unsigned i = 0; i < 2; i++, along_wu++) {
        int32_t place_wu[2];
        int64_t run = (int64_t)s->to_wu - s->from_wu, rise = (int64_t)s->z_wu[1] - s->z_wu[0],
                at = along_wu < u->from_wu ? u->from_wu
                     : along_wu > u->to_wu ? u->to_wu
                                           : along_wu;
        place_wu[s->axis] = (int32_t)at;
        place_wu[!s->axis] = s->at_wu;
        int64_t z_wu = s->z_wu[0] + rise * (at - s->from_wu) / run + 1,
                by_wu = z_wu - ff_patch_z_wu(&u->patch, place_wu);
        most_wu = by_wu > most_wu ? by_wu : most_wu;
    }
    return most_wu;
}

/* The same where the segment meets what may be an edge of the node's mesh, between vertices `i`
 * along and `j` across, and `k` and `l`. */
static int64_t above_edge(const segment *s, const under *u, int i, int j, int k, int l,
                          int64_t most_wu)
{
    if (k < 0 || l < 0 || j < 0 || k > (int)u->last || l > (int)u->last) return most_wu;
    int64_t low = u->across_wu[j], high = u->across_wu[l];
    if (low >= high || s->at_wu < low || s->at_wu > high) return most_wu;
    int64_t along = u->along_wu[i] +
                    ((int64_t)u->along_wu[k] - u->along_wu[i]) * (s->at_wu - low) / (high - low);
    if (along + 1 < u->from_wu || along > (int64_t)u->to_wu + 1) return most_wu;
    return above_at(s, u, along - 1, above_at(s, u, along + 1, most_wu));
}

/* At all places where the node's sheet may bend along the segment. Edges run along, across and from
 * south-west to north-east; beside coarser nodes to vertices up to two further, either way. */
static int64_t above_node(const segment *s, const under *u)
{
    int64_t most_wu = above_at(s, u, u->from_wu, above_at(s, u, u->to_wu - 1, INT64_MIN));
    int reach = u->patch.coarser ? 2 : 1;
    for (int j = 0; j < (int)u->last; j++) {
        if (u->across_wu[j + 1] < s->at_wu || (j > 0 && u->across_wu[j - 1] > s->at_wu)) continue;
        for (int i = 0; i <= (int)u->last; i++) {
            for (int k = i - reach; k <= i + reach; k++)
                most_wu = above_edge(s, u, i, j, k, j + 1, most_wu);
            for (int k = i - 1; reach == 2 && k <= i + 1; k++) {
                most_wu = above_edge(s, u, i, j, k, j + 2, most_wu);
                most_wu = above_edge(s, u, i, j - 1, k, j + 1, most_wu);
            }
        }
    }
    return most_wu;
}

/* A place is rounded by no more than this makes of heights. */
static int64_t slope_margin(const under *u)
{
    const ff_tree *tree = u->patch.tree;
    const ff_node *node = u->patch.node;
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    uint32_t slot = ff_slot_of(tree, node);
    const uint16_t *drop = ff_seam_drop(tree, slot, FF_LOWERED_DRAWN),
                   *height = tree->heights + slot * ff_heights_per_node(tree);
    int32_t lowest = INT32_MAX, highest = INT32_MIN;
    for (size_t i = 0; i < ff_heights_per_node(tree); i++) {
        int32_t at = height[i] - (drop ? drop[i] : 0);
        lowest = at < lowest ? at : lowest;
        highest = at > highest ? at : highest;
    }
    int64_t range_wu = ((int64_t)(highest - lowest) * info->hscale_q24) >> 16,
            cell_wu = ff_node_cell_wu(info, ff_key_level(node->key));
    return MARGIN_WU + 3 * (range_wu / cell_wu + 1) + ff_shape_drop_wu(info, cell_wu, 0);
}

/* How far the segment has to go down to lie below one node; 0: it lies below. */
static int64_t need_under(const ff_tree *tree, const segment *s, const ff_node *node)
{
    const ff_terrain_info *info = ff_ground_of(tree, node->key);
    under u = { .last = ff_node_side(info) - 1 };
    ff_patch_make(&u.patch, tree, node, FF_LOWERED_DRAWN);
    const ff_area *area = &u.patch.area;
    u.from_wu = s->from_wu > area->lo[s->axis] ? s->from_wu : area->lo[s->axis];
    u.to_wu = s->to_wu < area->hi[s->axis] ? s->to_wu : area->hi[s->axis];
    for (unsigned i = 0; i <= u.last; i++) {
        int32_t place_wu[3];
        ff_shape_place(info, node->key, &node->placed, i, i, 0, place_wu);
        u.along_wu[i] = place_wu[s->axis];
        u.across_wu[i] = place_wu[!s->axis];
    }
    int64_t need_wu = above_node(s, &u) + slope_margin(&u);
    return need_wu > 0 ? need_wu : 0;
}

/* The same of all grounds after its own, where they are drawn. */
static int64_t need_of(const ff_tree *tree, uint32_t ground, const segment *s)
{
    const ff_cover *cover = tree->cover;
    int64_t most_wu = 0;
    ff_area area;
    area.lo[s->axis] = s->from_wu;
    area.hi[s->axis] = s->to_wu;
    area.lo[!s->axis] = area.hi[!s->axis] = s->at_wu;
    for (uint32_t rank = cover->rank[ground] + 1u; rank < tree->ground_count; rank++) {
        const ff_area *other = &cover->stands[cover->ranked[rank]];
        ff_over over;
        /* one that ends there lies under nothing: it would be seen to end above the rim */
        if (other->lo[!s->axis] >= s->at_wu || other->hi[!s->axis] <= s->at_wu) continue;
        ff_over_begin(&over, tree, cover->ranked[rank], &area);
        for (const ff_node *node; (node = ff_over_next(&over)) != NULL;) {
            if (node->parent != FF_SLOT_NONE && node->flags & FF_NODE_LEFT_OUT) continue;
            int64_t need_wu = need_under(tree, s, node);
            most_wu = need_wu > most_wu ? need_wu : most_wu;
        }
    }
    return most_wu;
}

/* ---- a side of a node ---- */

/* The node's side along the rim: which of its vertices lie there, and their places along it. */
typedef struct rim {
    const ff_tree *tree;
    const ff_node *node;
    unsigned axis, side;
    int32_t at_wu;
} rim;

/* Vertex `i` along the rim; z as it dives. */
static void rim_vertex(const rim *r, unsigned i, int32_t place_wu[3])
{
    const ff_tree *tree = r->tree;
    const ff_terrain_info *info = ff_ground_of(tree, r->node->key);
    uint32_t count = ff_node_side(info), other = r->side & 2 ? count - 1 : 0,
             column = r->axis ? other : i, row = r->axis ? i : other,
             slot = ff_slot_of(tree, r->node), at = row * count + column;
    const uint16_t *dive = ff_seam_drop(tree, slot, FF_LOWERED_DIVED);
    int64_t steps = tree->heights[slot * ff_heights_per_node(tree) + at] - (dive ? dive[at] : 0);
    ff_shape_place(info, r->node->key, &r->node->placed, column, row, 0, place_wu);
    place_wu[2] = info->hoffset_wu + (int32_t)((steps * info->hscale_q24) >> 16);
}

/* The need of the piece between vertices i and i + 1; 0 where both are one. */
static int64_t piece_need(const rim *r, unsigned i)
{
    int32_t from_wu[3], to_wu[3];
    rim_vertex(r, i, from_wu);
    rim_vertex(r, i + 1, to_wu);
    const segment s = {
        r->axis, r->at_wu, from_wu[r->axis], to_wu[r->axis], { from_wu[2], to_wu[2] }
    };
    if (s.from_wu >= s.to_wu) return 0;
    return need_of(r->tree, ff_ground_number(r->tree, ff_key_tile(r->node->key)), &s);
}

/* The need of the piece of the neighbour's rim that ends in this one's first vertex, or begins in
 * its last. */
static int64_t need_beside(const rim *r, int after)
{
    const ff_terrain_info *info = ff_ground_of(r->tree, r->node->key);
    ff_area area = ff_area_of(r->tree, r->node->key, &r->node->placed);
    int32_t place_wu[2];
    rim beside = *r;
    place_wu[!r->axis] = r->side & 2 ? r->at_wu - 1 : r->at_wu + 1; /* on this side of it */
    place_wu[r->axis] = after ? area.hi[r->axis] + 1 : area.lo[r->axis] - 1;
    beside.node = ff_surface_node(r->tree, info, place_wu);
    if (!beside.node) return 0;
    if (after) return piece_need(&beside, 0);
    for (unsigned i = ff_node_side(info) - 1; i-- > 0;) {
        int32_t from_wu[3], to_wu[3];
        rim_vertex(&beside, i, from_wu);
        rim_vertex(&beside, i + 1, to_wu);
        if (from_wu[r->axis] < to_wu[r->axis]) return piece_need(&beside, i);
    }
    return 0;
}

/* The last vertex that lies where vertex `i` does: what is beyond the last sample is drawn on it.
 */
static unsigned last_alike(const rim *r, unsigned i, unsigned last)
{
    int32_t place_wu[3], next_wu[3];
    rim_vertex(r, i, place_wu);
    for (; i < last; i++) {
        rim_vertex(r, i + 1, next_wu);
        if (next_wu[r->axis] != place_wu[r->axis]) break;
    }
    return i;
}

/* Lowers vertex `i` along the rim, and what is drawn on it from beyond. */
static int lower_vertex(const rim *r, unsigned i, uint32_t steps, uint16_t *drop)
{
    const ff_terrain_info *info = ff_ground_of(r->tree, r->node->key);
    const uint16_t *dive = ff_seam_drop(r->tree, ff_slot_of(r->tree, r->node), FF_LOWERED_DIVED);
    uint32_t count = ff_node_side(info);
    int enough = 1;
    for (uint32_t across = 0; across < count; across++) {
        uint32_t column = r->axis ? across : i, row = r->axis ? i : across,
                 at = row * count + column;
        int32_t place_wu[3];
        ff_shape_place(info, r->node->key, &r->node->placed, column, row, 0, place_wu);
        if (place_wu[!r->axis] == r->at_wu)
            enough &= ff_seam_lower(&drop[at], (dive ? dive[at] : 0) + steps);
    }
    return enough;
}

/* Lowers the vertices of a side by what the pieces need that meet in them. 0 when some are not
 * lowered enough. */
static int lower_side(const rim *r, uint16_t *drop)
{
    const ff_terrain_info *info = ff_ground_of(r->tree, r->node->key);
    unsigned last = ff_node_side(info) - 1;
    int64_t before_wu = need_beside(r, 0);
    int enough = 1;
    for (unsigned i = 0, end; i <= last; i = end + 1) {
        end = last_alike(r, i, last);
        int64_t after_wu = end < last ? piece_need(r, end) : need_beside(r, 1),
                most_wu = after_wu > before_wu ? after_wu : before_wu;
        for (unsigned k = i; most_wu > 0 && k <= end; k++)
            enough &= lower_vertex(r, k, ff_seam_steps(info, most_wu), drop);
        before_wu = after_wu;
    }
    return enough;
}

int ff_seam_rim(const ff_tree *tree, const ff_node *node, uint16_t *drop)
{
    ff_area area = ff_area_of(tree, node->key, &node->placed);
    const ff_area *stands = &tree->cover->stands[ff_ground_number(tree, ff_key_tile(node->key))];
    int enough = 1;
    for (unsigned side = 0; side < 4; side++) {
        unsigned across = side & 1;
        int32_t line = side & 2 ? stands->hi[across] : stands->lo[across];
        rim r = { tree, node, !across, side, line };
        if ((side & 2 ? area.hi[across] : area.lo[across]) == line) enough &= lower_side(&r, drop);
    }
    return enough;
}
