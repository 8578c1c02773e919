#include "ff_estimate.h"

#include "ff_gaze.h"

#define STEPS_MAX    12 /* from a node down to a part of a cell: 11 splits */
#define CELL_Q8      256
#define PIECE_MIN_Q8 4 /* of a cell */
/* log2, Q8: a cell as rough as the roughest place of its node is off by twice as much as pieces of
 * whole nodes are; others go by the root of their roughness, down to that of a tenth. */
#define ROUGHEST_LOG_Q8  256
#define SMOOTHEST_LOG_Q8 (-425)

FF_STATIC_ASSERT(FF_NODE_LOG2_MAX + 6 < STEPS_MAX && CELL_Q8 >> 6 == PIECE_MIN_Q8);

/* ---- drawn ground ---- */

static void end_patch(ff_gaze *at)
{
    at->spread.patches += at->cell_pixels_q4 * at->cell_pixels_q4;
    at->cell_pixels_q4 = 0;
}

/* Counts the pixels of a piece as a patch with others of its cell; a larger one is several. */
static void count_patch(ff_gaze *at, const uint16_t piece[3], uint64_t pixels_q4)
{
    uint64_t cells = piece[2] / CELL_Q8;
    if (cells) {
        at->spread.patches += pixels_q4 * pixels_q4 / (cells * cells);
        return;
    }
    if (piece[0] / CELL_Q8 != at->cell[0] || piece[1] / CELL_Q8 != at->cell[1]) end_patch(at);
    at->cell[0] = piece[0] / CELL_Q8;
    at->cell[1] = piece[1] / CELL_Q8;
    at->cell_pixels_q4 += pixels_q4;
}

static uint32_t bend(const uint16_t *height, size_t step)
{
    int32_t bent = height[step] - 2 * height[0] + *(height - step);
    return (uint32_t)(bent < 0 ? -bent : bent);
}

/* How rough the ground is at a vertex: second differences; at the rim, of the vertex inside. */
static uint32_t roughness(const uint16_t *heights, uint32_t side, uint32_t column, uint32_t row)
{
    column = column < 1 ? 1 : column > side - 2 ? side - 2 : column;
    row = row < 1 ? 1 : row > side - 2 ? side - 2 : row;
    const uint16_t *height = heights + row * side + column;
    return bend(height, 1) + bend(height, side);
}

static uint32_t roughest(const uint16_t *heights, uint32_t side)
{
    uint32_t most = 0;
    for (uint32_t row = 1; row + 1 < side; row++)
        for (uint32_t column = 1; column + 1 < side; column++) {
            uint32_t rough = roughness(heights, side, column, row);
            most = rough > most ? rough : most;
        }
    return most;
}

/* log2, Q8, of how much more than its whole node the cell of a piece is off. */
static int32_t cell_log_q8(const ff_drawn *drawn, uint32_t side, const uint16_t piece[3],
                           uint32_t most)
{
    uint32_t column = piece[0] / CELL_Q8, row = piece[1] / CELL_Q8, sum = 0;
    for (unsigned i = 0; i < 4; i++)
        sum += roughness(drawn->heights, side, column + (i & 1), row + (i >> 1));
    if (!most) return 0;
    int32_t log_q8 = sum ? (ff_log2_q8((uint64_t)sum << 8) - ff_log2_q8((uint64_t)most << 10)) / 2
                         : SMOOTHEST_LOG_Q8;
    return ROUGHEST_LOG_Q8 + (log_q8 > SMOOTHEST_LOG_Q8 ? log_q8 : SMOOTHEST_LOG_Q8);
}

/* How far a point that is raised by 1 moves in the picture, in lengths across the line of sight,
 * Q14. */
static int64_t rise_q14(const ff_gaze *at, const ff_square *s)
{
    int64_t moved[2];
    for (unsigned i = 0; i < 2; i++) {
        int64_t aside_q14 = (s->eye[i] * (s->inverse_q40 >> 10)) >> 16;
        moved[i] = at->rotation_q14[i][2] - (aside_q14 * at->rotation_q14[2][2] >> 14);
    }
    return about_length(moved[0], moved[1], 0);
}

/* Counts a square of drawn ground that is off by `error_wu` at most. */
static void count_ground(ff_gaze *at, const ff_square *s, const uint16_t piece[3], int64_t error_wu,
                         int32_t more_log_q8)
{
    unsigned sector = ff_gaze_sector(s);
    int32_t slope = ff_gaze_slope_q12(s);
    if (slope < at->horizon_q12[sector]) return;
    at->horizon_q12[sector] = slope;
    uint32_t pixels_q4 = ff_gaze_covers_q4(at, s, 0);
    if (!pixels_q4) return;
    int64_t error_q8 = ff_gaze_pixels_q8(at, s, error_wu) * rise_q14(at, s) >>
                       (14 + FF_GAZE_UNIT_LOG2);
    int32_t log_q8 = error_q8 > 0 ? ff_log2_q8((uint64_t)error_q8) + more_log_q8 : -1;
    if (at->far) ff_gaze_far(at, s, pixels_q4, log_q8);
    at->spread.most[ff_spread_step(log_q8)] += pixels_q4;
    count_patch(at, piece, pixels_q4);
}

/* A piece of a node being looked at: {column, row, edge} in cells Q8, and which of its quarters are
 * next, the nearest first. */
typedef struct descent {
    ff_square ground;
    uint16_t piece[3];
    uint8_t near, next;
} descent;

static void place_cells(const ff_gaze *at, const ff_drawn *drawn, descent *to)
{
    const ff_tree *tree = at->tree;
    const ff_terrain_info *info = ff_ground_of(tree, drawn->key);
    uint32_t side = ff_node_side(info), cells = to->piece[2] / CELL_Q8;
    for (unsigned i = 0; i < 4; i++) {
        uint32_t column = to->piece[0] / CELL_Q8 + (i & 1 ? cells : 0),
                 row = to->piece[1] / CELL_Q8 + (i >> 1 ? cells : 0);
        int32_t place_wu[3];
        ff_shape_place(info, drawn->key, ff_tree_placed(drawn->node), column, row,
                       drawn->heights[row * side + column], place_wu);
        for (unsigned axis = 0; axis < 3; axis++)
            to->ground.corner[i][axis] =
                (int32_t)(((int64_t)place_wu[axis] - tree->view.camera.pos_wu[axis]) >>
                          FF_GAZE_UNIT_LOG2);
    }
}

/* A quarter of a cell or of a part of one: its corners are those of the whole, and means of them.
 */
static void place_quarter(const ff_square *whole, unsigned quarter, ff_square *part)
{
    for (unsigned i = 0; i < 4; i++) {
        unsigned x = (quarter & 1) + (i & 1), y = (quarter >> 1) + (i >> 1);
        const int32_t *south[2] = { whole->corner[x / 2 + y / 2 * 2],
                                    whole->corner[(x + 1) / 2 + y / 2 * 2] },
                      *north[2] = { whole->corner[x / 2 + (y + 1) / 2 * 2],
                                    whole->corner[(x + 1) / 2 + (y + 1) / 2 * 2] };
        for (unsigned axis = 0; axis < 3; axis++)
            part->corner[i][axis] = (int32_t)(((int64_t)south[0][axis] + south[1][axis] +
                                               north[0][axis] + north[1][axis]) >>
                                              2);
    }
}

static void begin_quarters(descent *of)
{
    const ff_square *s = &of->ground;
    int64_t along[2] = { 0, 0 };
    for (unsigned axis = 0; axis < 3; axis++)
        for (unsigned i = 0; i < 2; i++)
            along[i] += (int64_t)s->middle[axis] * (s->corner[i + 1][axis] - s->corner[0][axis]);
    of->near = (along[0] > 0 ? 0 : 1) | (along[1] > 0 ? 0 : 2);
    of->next = 0;
}

static void take_quarter(const ff_gaze *at, const ff_drawn *drawn, descent *of, descent *part)
{
    unsigned quarter = of->near ^ of->next++;
    uint16_t half = of->piece[2] / 2;
    part->piece[0] = (uint16_t)(of->piece[0] + (quarter & 1 ? half : 0));
    part->piece[1] = (uint16_t)(of->piece[1] + (quarter >> 1 ? half : 0));
    part->piece[2] = half;
    if (half < CELL_Q8)
        place_quarter(&of->ground, quarter, &part->ground);
    else
        place_cells(at, drawn, part);
}

/* Walks over the pieces of a node, from near ones to far ones. */
void ff_gaze_node(ff_gaze *at, const ff_drawn *drawn)
{
    const ff_terrain_info *info = ff_ground_of(at->tree, drawn->key);
    int64_t error_wu = ff_tree_error_wu(info, drawn->node);
    uint32_t side = ff_node_side(info), most = 0;
    descent path[STEPS_MAX];
    path[0].piece[0] = path[0].piece[1] = 0;
    path[0].piece[2] = (uint16_t)(CELL_Q8 << info->node_log2);
    place_cells(at, drawn, &path[0]);
    enum ff_sight sight = ff_gaze_look(at, &path[0].ground, 1);
    if (sight == FF_SEEN) count_ground(at, &path[0].ground, path[0].piece, error_wu, 0);
    if (sight != FF_TOO_WIDE) return;
    most = roughest(drawn->heights, side);
    begin_quarters(&path[0]);
    for (descent *of = path; of >= path;) {
        if (of->next == 4) {
            of--;
            continue;
        }
        descent *part = of + 1;
        FF_ASSERT(part < path + STEPS_MAX);
        take_quarter(at, drawn, of, part);
        sight = ff_gaze_look(at, &part->ground, part->piece[2] > PIECE_MIN_Q8);
        if (sight == FF_SEEN)
            count_ground(at, &part->ground, part->piece, error_wu,
                         cell_log_q8(drawn, side, part->piece, most));
        if (sight != FF_TOO_WIDE) continue;
        begin_quarters(part);
        of = part;
    }
    end_patch(at);
}

/* ---- a picture ---- */

uint32_t ff_estimate_p95_q8(const ff_tree *tree, const ff_beyond *beyond)
{
    ff_gaze at;
    if (!tree->has_view) return 0;
    ff_gaze_open(&at, tree);
    for (uint32_t i = 0; i < tree->drawn_count; i++) ff_gaze_node(&at, &tree->drawn[i]);
    ff_gaze_beyond(&at, beyond);
    uint32_t p95_q8 = ff_spread_p95_q8(&at.spread);
    int64_t most_q8 = 2 * about_length(at.half_q8[0], at.half_q8[1], 0);
    return p95_q8 < most_q8 ? p95_q8 : (uint32_t)most_q8;
}
