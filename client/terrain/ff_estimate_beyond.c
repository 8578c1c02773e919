/* The part of the estimate that is about what lies beyond the drawn ground. */
#include "ff_gaze.h"

#define LEVELS_MAX                                                                               \
    64                /* squares of level ground that wait: three for each of 20 splits, and one \
                       */
#define LEVEL_MIN 256 /* level ground is not looked at in smaller squares: 16 m */
/* what keeps products within 64 bits */
#define SHIFT_MAX_Q14 (1 << 26)
/* Far ground has slopes that face the viewer: it is seen as if it were tilted by so much. */
#define FAR_TILT 50

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
static int64_t panorama_error_q8(const ff_gaze *at, const ff_square *s, const ff_beyond *beyond)
{
    const c3d_camera *camera = &at->tree->view.camera;
    int64_t from[3], eye[3], shift_q14[2];
    for (unsigned i = 0; i < 3; i++)
        from[i] = s->middle[i] +
                  (((int64_t)camera->pos_wu[i] - beyond->position_wu[i]) >> FF_GAZE_UNIT_LOG2);
    int64_t reach = most_of(from);
    if (!beyond->face_size || reach == 0 || reach > beyond->back_wu >> FF_GAZE_UNIT_LOG2) return -1;
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
static void count_beyond(ff_gaze *at, const ff_square *s, const ff_beyond *beyond)
{
    int32_t slope = ff_gaze_slope_q12(s), edge = at->horizon_q12[ff_gaze_sector(s)];
    if (slope < edge) return;
    int64_t error_q8 = panorama_error_q8(at, s, beyond);
    if (error_q8 < 0)
        error_q8 = edge == INT32_MIN
                       ? INT32_MAX
                       : (((int64_t)slope - edge) * at->tree->view.camera.focal_q8) >> 12;
    unsigned step = error_q8 > 0 ? ff_spread_step(ff_log2_q8((uint64_t)error_q8)) : 0;
    at->spread.known[step] += ff_gaze_covers_q4(at, s, FAR_TILT);
}

/* Squares of level ground: {west, south, edge}. */
static void level_square(const int32_t piece[3], int32_t z, ff_square *s)
{
    for (unsigned i = 0; i < 4; i++) {
        s->corner[i][0] = piece[0] + (i & 1 ? piece[2] : 0);
        s->corner[i][1] = piece[1] + (i >> 1 ? piece[2] : 0);
        s->corner[i][2] = z;
    }
}

/* How much further than the tree draws the square's nearest point, or its middle, lies: largest
 * coordinate difference to the middle of the window. */
static int64_t further(const ff_gaze *at, const ff_square *s, int64_t half)
{
    int64_t away[3];
    for (unsigned i = 0; i < 3; i++)
        away[i] = s->middle[i] -
                  (((int64_t)at->tree->view.centre_wu[i] - at->tree->view.camera.pos_wu[i]) >>
                   FF_GAZE_UNIT_LOG2);
    for (unsigned i = 0; i < 2; i++) away[i] = size_of(away[i]) + half;
    return most_of(away) - (at->tree->quality.view_wu >> FF_GAZE_UNIT_LOG2);
}

/* 1 when some of the ground in reach has not come. */
static int lacks_roots(const ff_tree *tree)
{
    for (uint32_t i = 0; i < tree->wish_count; i++)
        if (tree->wish[i].kind == FF_KIND_ROOT) return 1;
    return 0;
}

/* 1 when the ground in the square's middle is in reach and has not come, of any that lies there. */
static int lacks_ground(const ff_gaze *at, const ff_square *s)
{
    const ff_tree *tree = at->tree;
    int32_t place_wu[3];
    ff_spot spot;
    int lacks = 0;
    for (unsigned i = 0; i < 3; i++) {
        int64_t wu = tree->view.camera.pos_wu[i] + s->middle[i] * (1 << FF_GAZE_UNIT_LOG2);
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

void ff_gaze_beyond(ff_gaze *at, const ff_beyond *beyond)
{
    static const ff_beyond nothing = { 0 };
    const ff_tree *tree = at->tree;
    ff_box box = bounds_of(tree);
    int lacks = lacks_roots(tree);
    int64_t wide = box.hi[0] - box.lo[0], deep = box.hi[1] - box.lo[1];
    int32_t pile[LEVELS_MAX][3] = {
        { (int32_t)(box.lo[0] >> FF_GAZE_UNIT_LOG2), (int32_t)(box.lo[1] >> FF_GAZE_UNIT_LOG2),
          (int32_t)((wide > deep ? wide : deep) >> FF_GAZE_UNIT_LOG2) }
    };
    for (unsigned count = 1; count > 0;) {
        int32_t piece[3] = { pile[count - 1][0], pile[count - 1][1], pile[count - 1][2] };
        ff_square s;
        count--;
        if (piece[0] > box.hi[0] >> FF_GAZE_UNIT_LOG2 || piece[1] > box.hi[1] >> FF_GAZE_UNIT_LOG2)
            continue;
        level_square(piece, (int32_t)(box.lo[2] >> FF_GAZE_UNIT_LOG2), &s);
        enum ff_sight sight = ff_gaze_look(at, &s, piece[2] > LEVEL_MIN);
        if (sight == FF_UNSEEN || (!lacks && further(at, &s, piece[2] / 2) < 0)) continue;
        if (sight == FF_SEEN) {
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
