#include "ff_estimate.h"

#include "ff_spread.h"
#include "ff_tree_local.h"

#include <string.h>

/* Lengths are in units of 16 wu from the eye: 2^33 wu fit 32 bits, and their products 64. */
#define UNIT_LOG2 4
#define NARROW    4  /* a square is looked at whole when it is so many times as far as wide */
#define SECTORS   32 /* round the eye, that ground may hide ground in */
#define STEPS_MAX 12 /* from a node down to a part of a cell: 11 splits */
#define LEVELS_MAX                                                                \
    64 /* squares of level ground that wait: three for each of 20 splits, and one \
        */
#define CELL_Q8      256
#define PIECE_MIN_Q8 4 /* of a cell */
/* log2, Q8: a cell as rough as the roughest place of its node is off by twice as much as pieces of
 * whole nodes are; others go by the root of their roughness, down to that of a tenth. */
#define ROUGHEST_LOG_Q8  256
#define SMOOTHEST_LOG_Q8 (-425)
#define LEVEL_MIN        256 /* level ground is not looked at in smaller squares: 16 m */
/* what keeps products within 64 bits */
#define EXTENT_MAX_Q6 (1 << 22)
#define SLOPE_MAX_Q12 (1 << 24)
#define SHIFT_MAX_Q14 (1 << 26)
/* Far ground has slopes that face the viewer: it is seen as if it were tilted by so much. */
#define FAR_TILT 50

FF_STATIC_ASSERT(FF_NODE_LOG2_MAX + 6 < STEPS_MAX && CELL_Q8 >> 6 == PIECE_MIN_Q8);

typedef struct gaze {
    const ff_tree *tree;
    ff_spread spread;
    int32_t rotation_q14[3][3];   /* rows: right, up, forward */
    int32_t half_q8[2];           /* of the picture, pixels */
    int64_t normal_q8[2];         /* length of the normals of its sides */
    int32_t horizon_q12[SECTORS]; /* the steepest slope up to ground seen so far */
    uint8_t under;                /* 1: the eye is below the drawn ground */
    uint64_t cell_pixels_q4;      /* of the cell being looked at */
    uint16_t cell[2];
} gaze;

/* A piece of ground: its corners (south-west, south-east, north-west, north-east), and what is
 * found of it. */
typedef struct square {
    int32_t corner[4][3], middle[3], eye[3];
    int64_t away, wide;
    int64_t inverse_q40; /* of the depth */
} square;

enum sight { UNSEEN, TOO_WIDE, SEEN };

/* ---- geometry ---- */

static int64_t size_of(int64_t value) { return value < 0 ? -value : value; }

static int64_t within(int64_t value, int64_t most)
{
    return value > most ? most : value < -most ? -most : value;
}

/* Length of a vector, at most 8 % off. */
static int64_t about_length(int64_t x, int64_t y, int64_t z)
{
    int64_t a = size_of(x), b = size_of(y), c = size_of(z), most = a > b ? a : b;
    most = most > c ? most : c;
    return most + (a + b + c - most) * 5 / 16;
}

static void find_middle(const gaze *at, square *s)
{
    for (unsigned i = 0; i < 3; i++)
        s->middle[i] = (int32_t)(((int64_t)s->corner[0][i] + s->corner[1][i] + s->corner[2][i] +
                                  s->corner[3][i]) /
                                 4);
    for (unsigned row = 0; row < 3; row++) {
        int64_t sum = 0;
        for (unsigned i = 0; i < 3; i++) sum += (int64_t)at->rotation_q14[row][i] * s->middle[i];
        s->eye[row] = (int32_t)(sum >> 14);
    }
    s->away = about_length(s->middle[0], s->middle[1], s->middle[2]);
    s->wide = (size_of((int64_t)s->corner[3][0] - s->corner[0][0]) +
               size_of((int64_t)s->corner[3][1] - s->corner[0][1])) /
              2;
}

/* 1 when the middle lies in the picture, or not further beside it than `slack`. */
static int in_picture(const gaze *at, const square *s, int64_t slack)
{
    if (s->eye[2] + slack <= 0) return 0;
    for (unsigned i = 0; i < 2; i++)
        if (size_of(s->eye[i]) * at->tree->view.camera.focal_q8 -
                (int64_t)s->eye[2] * at->half_q8[i] >
            slack * at->normal_q8[i])
            return 0;
    return 1;
}

static enum sight look_at(const gaze *at, square *s, int may_split)
{
    find_middle(at, s);
    int64_t relief = (size_of((int64_t)s->corner[3][2] - s->corner[0][2]) +
                      size_of((int64_t)s->corner[2][2] - s->corner[1][2])) /
                     2;
    if (!in_picture(at, s, s->wide * 3 / 4 + relief)) return UNSEEN;
    if (may_split && s->wide * NARROW > s->away) return TOO_WIDE;
    if (s->eye[2] <= 0 || !in_picture(at, s, 0)) return UNSEEN;
    s->inverse_q40 = (INT64_C(1) << 40) / s->eye[2];
    return SEEN;
}

/* Of a length across the line of sight at the square: pixels Q8. */
static int64_t pixels_q8(const gaze *at, const square *s, int64_t length)
{
    int64_t by_depth_q20 = (length * (s->inverse_q40 >> 10)) >> 10;
    if (by_depth_q20 > INT64_C(1) << 31) by_depth_q20 = INT64_C(1) << 31;
    return (by_depth_q20 * at->tree->view.camera.focal_q8) >> 20;
}

/* The same of a length of either sign, pixels Q6; no longer than a picture may be many times. */
static int64_t extent_q6(const gaze *at, const square *s, int64_t length)
{
    int64_t pixels_q6 = pixels_q8(at, s, size_of(length)) >> 2;
    return within(length < 0 ? -pixels_q6 : pixels_q6, EXTENT_MAX_Q6);
}

/* How many pixels the square covers, Q4: half the product of its diagonals as seen; at least what
 * it would cover if it were tilted by 1 in `tilt` (0: not at all) towards the viewer. */
static uint32_t covers_q4(const gaze *at, const square *s, int tilt)
{
    int64_t rising[3], falling[3], facing_q22 = 0;
    for (unsigned i = 0; i < 3; i++) {
        rising[i] = extent_q6(at, s, (int64_t)s->corner[3][i] - s->corner[0][i]);
        falling[i] = extent_q6(at, s, (int64_t)s->corner[2][i] - s->corner[1][i]);
    }
    for (unsigned i = 0; i < 3; i++) {
        unsigned j = (i + 1) % 3, k = (i + 2) % 3;
        int64_t sight_q10 = (s->middle[i] * (s->inverse_q40 >> 15)) >> 15;
        facing_q22 -= (rising[j] * falling[k] - rising[k] * falling[j]) * sight_q10;
    }
    if (facing_q22 < 0 && at->under) facing_q22 = -facing_q22;
    if (tilt) {
        int64_t level_q12 = size_of(rising[0] * falling[1] - rising[1] * falling[0]),
                least_q22 = level_q12 * ((s->away * (s->inverse_q40 >> 15)) >> 15) / tilt;
        facing_q22 = facing_q22 > least_q22 ? facing_q22 : least_q22;
    }
    int64_t covered_q4 = facing_q22 >> 19, all_q4 = (int64_t)at->half_q8[0] * at->half_q8[1] >> 10;
    return covered_q4 <= 0 ? 0 : (uint32_t)(covered_q4 < all_q4 ? covered_q4 : all_q4);
}

/* ---- what hides what ---- */

static unsigned sector_of(const square *s)
{
    int64_t x = size_of(s->middle[0]), y = size_of(s->middle[1]);
    unsigned part = (unsigned)(y * (SECTORS / 4) / (x + y + 1)),
             quarter = (s->middle[1] < 0 ? 2u : 0u) + (s->middle[0] < 0);
    FF_ASSERT(part < SECTORS / 4);
    return quarter * (SECTORS / 4) + part;
}

static int32_t slope_q12(const square *s)
{
    int64_t across = about_length(s->middle[0], s->middle[1], 0);
    int64_t slope = (int64_t)s->middle[2] * 4096 / (across + 1);
    return (int32_t)within(slope, SLOPE_MAX_Q12);
}

/* ---- drawn ground ---- */

static void end_patch(gaze *at)
{
    at->spread.patches += at->cell_pixels_q4 * at->cell_pixels_q4;
    at->cell_pixels_q4 = 0;
}

/* Counts the pixels of a piece as a patch with others of its cell; a larger one is several. */
static void count_patch(gaze *at, const uint16_t piece[3], uint64_t pixels_q4)
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
static int64_t rise_q14(const gaze *at, const square *s)
{
    int64_t moved[2];
    for (unsigned i = 0; i < 2; i++) {
        int64_t aside_q14 = (s->eye[i] * (s->inverse_q40 >> 10)) >> 16;
        moved[i] = at->rotation_q14[i][2] - (aside_q14 * at->rotation_q14[2][2] >> 14);
    }
    return about_length(moved[0], moved[1], 0);
}

/* Counts a square of drawn ground that is off by `error_wu` at most. */
static void count_ground(gaze *at, const square *s, const uint16_t piece[3], int64_t error_wu,
                         int32_t more_log_q8)
{
    unsigned sector = sector_of(s);
    int32_t slope = slope_q12(s);
    if (slope < at->horizon_q12[sector]) return;
    at->horizon_q12[sector] = slope;
    uint32_t pixels_q4 = covers_q4(at, s, 0);
    if (!pixels_q4) return;
    int64_t error_q8 = pixels_q8(at, s, error_wu) * rise_q14(at, s) >> (14 + UNIT_LOG2);
    unsigned step = error_q8 > 0 ? ff_spread_step(ff_log2_q8((uint64_t)error_q8) + more_log_q8) : 0;
    at->spread.most[step] += pixels_q4;
    count_patch(at, piece, pixels_q4);
}

/* A piece of a node being looked at: {column, row, edge} in cells Q8, and which of its quarters are
 * next, the nearest first. */
typedef struct descent {
    square ground;
    uint16_t piece[3];
    uint8_t near, next;
} descent;

static void place_cells(const gaze *at, const ff_drawn *drawn, descent *to)
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
                (int32_t)(((int64_t)place_wu[axis] - tree->view.camera.pos_wu[axis]) >> UNIT_LOG2);
    }
}

/* A quarter of a cell or of a part of one: its corners are those of the whole, and means of them.
 */
static void place_quarter(const square *whole, unsigned quarter, square *part)
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
    const square *s = &of->ground;
    int64_t along[2] = { 0, 0 };
    for (unsigned axis = 0; axis < 3; axis++)
        for (unsigned i = 0; i < 2; i++)
            along[i] += (int64_t)s->middle[axis] * (s->corner[i + 1][axis] - s->corner[0][axis]);
    of->near = (along[0] > 0 ? 0 : 1) | (along[1] > 0 ? 0 : 2);
    of->next = 0;
}

static void take_quarter(const gaze *at, const ff_drawn *drawn, descent *of, descent *part)
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
static void look_at_node(gaze *at, const ff_drawn *drawn)
{
    const ff_terrain_info *info = ff_ground_of(at->tree, drawn->key);
    int64_t error_wu = ff_steps_wu(info, ff_geometric_error_decode(drawn->node->error_code));
    uint32_t side = ff_node_side(info), most = 0;
    descent path[STEPS_MAX];
    path[0].piece[0] = path[0].piece[1] = 0;
    path[0].piece[2] = (uint16_t)(CELL_Q8 << info->node_log2);
    place_cells(at, drawn, &path[0]);
    enum sight sight = look_at(at, &path[0].ground, 1);
    if (sight == SEEN) count_ground(at, &path[0].ground, path[0].piece, error_wu, 0);
    if (sight != TOO_WIDE) return;
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
        sight = look_at(at, &part->ground, part->piece[2] > PIECE_MIN_Q8);
        if (sight == SEEN)
            count_ground(at, &part->ground, part->piece, error_wu,
                         cell_log_q8(drawn, side, part->piece, most));
        if (sight != TOO_WIDE) continue;
        begin_quarters(part);
        of = part;
    }
    end_patch(at);
}

/* ---- beyond ---- */

/* Where a ground's mean lies, as far as it is known: by `roots` of its roots. */
static int32_t mean_of(const ff_tree *tree, const ff_terrain_info *info, uint32_t *roots)
{
    uint64_t sum = 0, count = 0;
    for (uint32_t slot = tree->root_head; slot != FF_SLOT_NONE; slot = tree->node[slot].list_next) {
        if (!ff_terrain_has_node(info, tree->node[slot].key)) continue;
        sum += tree->node[slot].height_mean;
        count++;
    }
    uint32_t middle = ((uint32_t)info->height_min + info->height_max) / 2;
    *roots = (uint32_t)count;
    return ff_height_wu(info, count ? (uint32_t)(sum / count) : middle);
}

static int32_t mean_ground_wu(const ff_tree *tree)
{
    int64_t sum_wu = 0, count = 0;
    uint32_t roots;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        int32_t mean_wu = mean_of(tree, &tree->ground[g], &roots);
        sum_wu += (int64_t)mean_wu * roots;
        count += roots;
    }
    return count ? (int32_t)(sum_wu / count) : mean_of(tree, tree->ground, &roots);
}

/* Holds all grounds, were they level. */
static ff_box bounds_of(const ff_tree *tree)
{
    const int64_t height_wu[2] = { mean_ground_wu(tree), mean_ground_wu(tree) };
    const int32_t *eye_wu = tree->view.camera.pos_wu;
    ff_box all = ff_shape_bounds(tree->ground, &tree->view.frame, height_wu, eye_wu);
    for (uint32_t g = 1; g < tree->ground_count; g++) {
        ff_box box = ff_shape_bounds(&tree->ground[g], &tree->view.frame, height_wu, eye_wu);
        for (unsigned axis = 0; axis < 3; axis++) {
            if (box.lo[axis] < all.lo[axis]) all.lo[axis] = box.lo[axis];
            if (box.hi[axis] > all.hi[axis]) all.hi[axis] = box.hi[axis];
        }
    }
    return all;
}

static int64_t most_of(const int64_t vector[3])
{
    int64_t x = size_of(vector[0]), y = size_of(vector[1]), z = size_of(vector[2]);
    x = x > y ? x : y;
    return x > z ? x : z;
}

/* How far off a panorama shows the square: its parallax, and six tenths of a texel. -1: it does not
 * show it. */
static int64_t panorama_error_q8(const gaze *at, const square *s, const ff_beyond *beyond)
{
    const c3d_camera *camera = &at->tree->view.camera;
    int64_t from[3], eye[3], shift_q14[2];
    for (unsigned i = 0; i < 3; i++)
        from[i] = s->middle[i] +
                  (((int64_t)camera->pos_wu[i] - beyond->position_wu[i]) >> UNIT_LOG2);
    int64_t reach = most_of(from);
    if (!beyond->face_size || reach == 0 || reach > beyond->back_wu >> UNIT_LOG2) return -1;
    for (unsigned row = 0; row < 3; row++) {
        eye[row] = 0;
        for (unsigned i = 0; i < 3; i++) eye[row] += at->rotation_q14[row][i] * from[i];
        eye[row] >>= 14;
    }
    if (eye[2] <= 0) return INT32_MAX;
    for (unsigned i = 0; i < 2; i++)
        shift_q14[i] = within(eye[i] * 16384 / eye[2], SHIFT_MAX_Q14) -
                       ((s->eye[i] * (s->inverse_q40 >> 10)) >> 16);
    int64_t parallax_q8 = about_length(shift_q14[0], shift_q14[1], 0) * camera->focal_q8 >> 14,
            texel_q8 = (int64_t)camera->focal_q8 * 6 / (5 * beyond->face_size),
            slant_q8 = (s->away * (s->inverse_q40 >> 16)) >> 16;
    texel_q8 = texel_q8 * reach / about_length(from[0], from[1], from[2]);
    return parallax_q8 + ((texel_q8 * slant_q8 >> 8) * slant_q8 >> 8);
}

/* Counts a square that no ground is drawn in. */
static void count_beyond(gaze *at, const square *s, const ff_beyond *beyond)
{
    int32_t slope = slope_q12(s), edge = at->horizon_q12[sector_of(s)];
    if (slope < edge) return;
    int64_t error_q8 = panorama_error_q8(at, s, beyond);
    if (error_q8 < 0)
        error_q8 = edge == INT32_MIN
                       ? INT32_MAX
                       : (((int64_t)slope - edge) * at->tree->view.camera.focal_q8) >> 12;
    unsigned step = error_q8 > 0 ? ff_spread_step(ff_log2_q8((uint64_t)error_q8)) : 0;
    at->spread.known[step] += covers_q4(at, s, FAR_TILT);
}

/* Squares of level ground: {west, south, edge}. */
static void level_square(const int32_t piece[3], int32_t z, square *s)
{
    for (unsigned i = 0; i < 4; i++) {
        s->corner[i][0] = piece[0] + (i & 1 ? piece[2] : 0);
        s->corner[i][1] = piece[1] + (i >> 1 ? piece[2] : 0);
        s->corner[i][2] = z;
    }
}

/* How much further than the tree draws the square's nearest point, or its middle, lies: largest
 * coordinate difference to the middle of the window. */
static int64_t further(const gaze *at, const square *s, int64_t half)
{
    int64_t away[3];
    for (unsigned i = 0; i < 3; i++)
        away[i] = s->middle[i] -
                  (((int64_t)at->tree->view.centre_wu[i] - at->tree->view.camera.pos_wu[i]) >>
                   UNIT_LOG2);
    for (unsigned i = 0; i < 2; i++) away[i] = size_of(away[i]) + half;
    return most_of(away) - (at->tree->quality.view_wu >> UNIT_LOG2);
}

/* 1 when some of the ground in reach has not come. */
static int lacks_roots(const ff_tree *tree)
{
    for (uint32_t i = 0; i < tree->wish_count; i++)
        if (tree->wish[i].kind == FF_KIND_ROOT) return 1;
    return 0;
}

/* 1 when the ground in the square's middle is in reach and has not come, of any that lies there. */
static int lacks_ground(const gaze *at, const square *s)
{
    const ff_tree *tree = at->tree;
    int32_t place_wu[3];
    ff_spot spot;
    int lacks = 0;
    for (unsigned i = 0; i < 3; i++) {
        int64_t wu = tree->view.camera.pos_wu[i] + s->middle[i] * (1 << UNIT_LOG2);
        place_wu[i] = (int32_t)within(wu, INT32_MAX);
    }
    if (further(at, s, 0) >= 0) return 0;
    for (uint32_t g = 0; g < tree->ground_count; g++) {
        if (!ff_shape_locate(&tree->ground[g], &tree->view.frame, place_wu, &spot)) continue;
        if (ff_tree_find(tree, ff_key_make(spot.tile, 0, 0)) != FF_SLOT_NONE) return 0;
        lacks = 1;
    }
    return lacks;
}

static void look_beyond(gaze *at, const ff_beyond *beyond)
{
    static const ff_beyond nothing = { 0 };
    const ff_tree *tree = at->tree;
    ff_box box = bounds_of(tree);
    int lacks = lacks_roots(tree);
    int64_t wide = box.hi[0] - box.lo[0], deep = box.hi[1] - box.lo[1];
    int32_t pile[LEVELS_MAX][3] = { { (int32_t)(box.lo[0] >> UNIT_LOG2),
                                      (int32_t)(box.lo[1] >> UNIT_LOG2),
                                      (int32_t)((wide > deep ? wide : deep) >> UNIT_LOG2) } };
    for (unsigned count = 1; count > 0;) {
        int32_t piece[3] = { pile[count - 1][0], pile[count - 1][1], pile[count - 1][2] };
        square s;
        count--;
        if (piece[0] > box.hi[0] >> UNIT_LOG2 || piece[1] > box.hi[1] >> UNIT_LOG2) continue;
        level_square(piece, (int32_t)(box.lo[2] >> UNIT_LOG2), &s);
        enum sight sight = look_at(at, &s, piece[2] > LEVEL_MIN);
        if (sight == UNSEEN || (!lacks && further(at, &s, piece[2] / 2) < 0)) continue;
        if (sight == SEEN) {
            if (further(at, &s, 0) >= 0)
                count_beyond(at, &s, beyond);
            else if (lacks && lacks_ground(at, &s))
                count_beyond(at, &s, &nothing);
            continue;
        }
        FF_ASSERT(count + 4 <= LEVELS_MAX);
        for (unsigned i = 0; i < 4; i++, count++) {
            pile[count][2] = piece[2] / 2;
            pile[count][0] = piece[0] + (i & 1 ? piece[2] / 2 : 0);
            pile[count][1] = piece[1] + (i >> 1 ? piece[2] / 2 : 0);
        }
    }
}

/* ---- a picture ---- */

static void open_eye(gaze *at, const ff_tree *tree)
{
    const c3d_camera *camera = &tree->view.camera;
    c3d_rotation rotation;
    int32_t ground_wu;
    memset(at, 0, sizeof *at);
    at->tree = tree;
    c3d_rotation_from_camera(camera, &rotation);
    for (unsigned row = 0; row < 3; row++)
        for (unsigned i = 0; i < 3; i++) at->rotation_q14[row][i] = rotation.m[row][i] >> 16;
    at->half_q8[0] = camera->width * 128;
    at->half_q8[1] = camera->height * 128;
    for (unsigned i = 0; i < 2; i++)
        at->normal_q8[i] = c3d_isqrt64((uint64_t)camera->focal_q8 * (uint64_t)camera->focal_q8 +
                                       (uint64_t)at->half_q8[i] * (uint64_t)at->half_q8[i]);
    for (unsigned i = 0; i < SECTORS; i++) at->horizon_q12[i] = INT32_MIN;
    at->under =
        (uint8_t)(ff_tree_drawn_height(tree, camera->pos_wu[0], camera->pos_wu[1], &ground_wu) &&
                  ground_wu > camera->pos_wu[2]);
}

uint32_t ff_estimate_p95_q8(const ff_tree *tree, const ff_beyond *beyond)
{
    gaze at;
    if (!tree->has_view) return 0;
    open_eye(&at, tree);
    for (uint32_t i = 0; i < tree->drawn_count; i++) look_at_node(&at, &tree->drawn[i]);
    look_beyond(&at, beyond);
    uint32_t p95_q8 = ff_spread_p95_q8(&at.spread);
    int64_t most_q8 = 2 * about_length(at.half_q8[0], at.half_q8[1], 0);
    return p95_q8 < most_q8 ? p95_q8 : (uint32_t)most_q8;
}
