/* Ground that is hidden from O by a ridge, and comes into the viewer's view as he moves: no paint
 * of the set is thrown on it, which would show the ridge once more, on the plain behind it. */
#include "ff_sets.h"

#include "../../protocol/shape/ff_shape.h"

/* Ground may be higher than it is drawn, as a rule by half of the node's error. */
#define HIGHER 2

/* The middle of a square, which lies on the diagonal from its south-west corner, relative to O as
 * it lies there. */
static void middle_of(const ff_set *set, const ff_terrain_info *info, const ff_drawn *drawn,
                      const uint32_t corner[2], uint32_t cells, int64_t away_wu[3])
{
    uint32_t side = ff_node_side(info);
    int32_t place_wu[2][3];
    for (uint32_t i = 0; i < 2; i++) {
        uint32_t column = corner[0] + i * cells, row = corner[1] + i * cells;
        ff_shape_place(info, drawn->key, ff_tree_placed(drawn->node), column, row,
                       drawn->heights[row * side + column], place_wu[i]);
    }
    for (int axis = 0; axis < 3; axis++)
        away_wu[axis] = ((int64_t)place_wu[0][axis] + place_wu[1][axis]) / 2 -
                        set->position_wu[axis];
    away_wu[2] -= ff_shape_drop_wu(info, away_wu[0], away_wu[1]);
}

static int is_hidden(const ff_set *set, unsigned sectors, const int64_t away_wu[3])
{
    for (unsigned s = 0; s < FF_FAR_SECTORS; s++) {
        int32_t forward_q30[2], right_q30[2];
        if (!(sectors >> s & 1u)) continue;
        ff_far_axes(s, forward_q30, right_q30);
        int64_t forward = (away_wu[0] * forward_q30[0] + away_wu[1] * forward_q30[1]) >> 30,
                right = (away_wu[0] * right_q30[0] + away_wu[1] * right_q30[1]) >> 30;
        if (ff_ridges_hide(&set->sector[s].ridges, forward, right, away_wu[2])) return 1;
    }
    return 0;
}

ff_squares ff_sets_hidden(const ff_set *set, unsigned sectors, const ff_terrain_info *info,
                          const ff_drawn *drawn)
{
    unsigned log2 = ff_squares_log2(info->node_log2);
    uint32_t cells = 1u << (info->node_log2 - log2);
    int64_t higher_wu = ff_tree_error_wu(info, drawn->node) / HIGHER;
    ff_squares hidden = 0;
    for (uint32_t row = 0; row < 1u << log2; row++)
        for (uint32_t column = 0; column < 1u << log2; column++) {
            const uint32_t corner[2] = { column * cells, row * cells };
            int64_t away_wu[3];
            middle_of(set, info, drawn, corner, cells, away_wu);
            away_wu[2] += higher_wu;
            if (is_hidden(set, sectors, away_wu))
                hidden |= (ff_squares)1 << (row * FF_SQUARES_ROW + column);
        }
    return hidden;
}
