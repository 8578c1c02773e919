/* How far off is the join between ground and panorama? The far ground that a set taken at O can
 * show begins on the four upright faces of a cube of half-edge z round O, between the heights that
 * the set's images show or the terrain has (and on the lower or upper face when these reach
 * beyond). Farther ground in the same direction is off by less. In eye space, with P - O = (X, Y,
 * D), m the way from O to O' and d the focal distance, a point is shown at d X/D and truly is at d
 * (X - mx)/(D - mz): it is off by
 *
 *     | (X mz - mx D, Y mz - my D) | d / (D (D - mz))          pixels.
 *
 * With mz = 0 or X = D w/d and mx = 0 that is Hybrid's eq. 6 and 13. The faces are cut into
 * patches. |..|/D is convex over the screen and so largest in one of a patch's corners; D - mz is
 * least in a corner. What is in the window, shown or true, is at least `least_wu` deep, so that
 * corners beside or behind the eye cannot make the bound useless. */
#include "ff_panorama_rules.h"
#include "../../protocol/ff_assert.h"

#define PATCHES 16 /* along a face */
/* z is limited to this: products of two lengths then fit 64 bits, and ground that is taken to be
 * nearer than it is comes out as off by more, never by less. */
#define Z_WU_MAX   (1 << 30)
#define LENGTH_MAX (INT64_C(1) << 32) /* times a focal distance of 31 bits */

/* A corner of the cube is nearer than 2 z, and the way from O to the eye shorter than 2^31. */
FF_STATIC_ASSERT(INT64_C(2) * Z_WU_MAX + INT32_MAX < LENGTH_MAX);

typedef struct join {
    const c3d_camera *camera;
    c3d_rotation rotation;
    int64_t moved_eye_wu[3];
    int64_t half_q8[2];
    int64_t least_wu; /* no point in the window, shown or true, has a smaller D or D - mz */
    int64_t z_wu;
    int64_t error_q8;
} join;

typedef struct corner {
    int64_t eye_wu[3];
    unsigned shown, truly; /* beyond which sides of the window */
} corner;

static int64_t magnitude(int64_t value) { return value < 0 ? -value : value; }

static int64_t larger(int64_t a, int64_t b) { return a > b ? a : b; }

/* A ray through the window covers at most most_q8 / focal along an axis of the cube for each unit
 * of depth. */
static int64_t least_depth_wu(const join *j, int64_t moved_wu)
{
    int64_t most_q8 = 0, reach_wu = j->z_wu - moved_wu;
    FF_ASSERT(moved_wu > 0 && j->z_wu <= Z_WU_MAX);
    for (int axis = 0; axis < 3; axis++)
        most_q8 = larger(most_q8, magnitude(j->rotation.m[2][axis]) * j->camera->focal_q8 +
                                      magnitude(j->rotation.m[0][axis]) * j->half_q8[0] +
                                      magnitude(j->rotation.m[1][axis]) * j->half_q8[1]);
    return c3d_muldiv64(reach_wu, j->camera->focal_q8, (most_q8 >> 30) + 1) -
           magnitude(j->moved_eye_wu[2]) - 2;
}

/* Bit per side of the window, and one for behind the eye, that a point in eye space lies beyond. */
static unsigned beyond(const join *j, int64_t x, int64_t y, int64_t depth)
{
    FF_ASSERT(x > -LENGTH_MAX && x < LENGTH_MAX && y > -LENGTH_MAX && y < LENGTH_MAX);
    FF_ASSERT(depth > -LENGTH_MAX && depth < LENGTH_MAX);
    int64_t focal_q8 = j->camera->focal_q8, reach_x = depth * j->half_q8[0],
            reach_y = depth * j->half_q8[1];
    return (unsigned)(x * focal_q8 > reach_x) | (unsigned)(-x * focal_q8 > reach_x) << 1 |
           (unsigned)(y * focal_q8 > reach_y) << 2 | (unsigned)(-y * focal_q8 > reach_y) << 3 |
           (unsigned)(depth < 0) << 4;
}

static void place_corner(const join *j, const int64_t first_wu[3], const int64_t last_wu[3],
                         int part, corner *at)
{
    const int64_t *m = j->moved_eye_wu;
    int64_t *p = at->eye_wu;
    FF_ASSERT(part >= 0 && part <= PATCHES);
    for (int i = 0; i < 3; i++) p[i] = first_wu[i] + (last_wu[i] - first_wu[i]) * part / PATCHES;
    at->shown = beyond(j, p[0], p[1], p[2]);
    at->truly = beyond(j, p[0] - m[0], p[1] - m[1], p[2] - m[2]);
}

static int not_in_window(const corner at[4])
{
    return (at[0].shown & at[1].shown & at[2].shown & at[3].shown) &&
           (at[0].truly & at[1].truly & at[2].truly & at[3].truly);
}

static int patch_is_off(const join *j, const corner at[4])
{
    const int64_t *m = j->moved_eye_wu;
    int64_t way[4], off = 0, depth_wu = INT64_MAX;
    int deep = 1;
    FF_ASSERT(j->least_wu > 0);
    if (not_in_window(at)) return 0;
    for (int i = 0; i < 4; i++) {
        const int64_t *p = at[i].eye_wu;
        /* 8 z more: eye space is rounded to whole wu */
        way[i] = c3d_length64(p[0] * m[2] - m[0] * p[2], p[1] * m[2] - m[1] * p[2], 0) +
                 8 * j->z_wu;
        deep &= p[2] >= j->least_wu;
        depth_wu = p[2] - m[2] < depth_wu ? p[2] - m[2] : depth_wu;
    }
    for (int i = 0; i < 4; i++)
        off = larger(off, c3d_divide_saturated((uint64_t)way[i],
                                               (uint64_t)(deep ? at[i].eye_wu[2] : j->least_wu)));
    int64_t depth_least_wu = larger(depth_wu, j->least_wu) - 4;
    FF_ASSERT(depth_least_wu < LENGTH_MAX && j->error_q8 <= 1 << 30);
    return depth_least_wu <= 0 || (off + 1) * j->camera->focal_q8 >= depth_least_wu * j->error_q8;
}

/* 1 when the face that looks along `axis` is off somewhere: between low and high along the axis
 * `up`, over its whole length along the third axis. */
static int face_is_off(const join *j, int axis, int sign, int up, int64_t low, int64_t high)
{
    int across = 3 - axis - up;
    FF_ASSERT(axis != up && across >= 0 && across <= 2);
    FF_ASSERT(-j->z_wu <= low && low <= high && high <= j->z_wu);
    int64_t end_wu[2][2][3]; /* of the lower and upper edge: first and last corner */
    corner at[4];
    for (int i = 0; i < 4; i++) {
        int64_t offset_wu[3];
        offset_wu[axis] = sign * j->z_wu;
        offset_wu[across] = i & 1 ? j->z_wu : -j->z_wu;
        offset_wu[up] = i & 2 ? high : low;
        c3d_to_eye(&j->rotation, offset_wu, end_wu[i >> 1][i & 1]);
        place_corner(j, end_wu[i >> 1][i & 1], end_wu[i >> 1][i & 1], 0, &at[i]);
    }
    if (not_in_window(at)) /* most faces, and all there is to do for them */
        return 0;
    for (int i = 0; i <= PATCHES; i++) {
        for (int edge = 0; edge < 2; edge++) {
            at[edge] = at[2 + edge];
            place_corner(j, end_wu[edge][0], end_wu[edge][1], i, &at[2 + edge]);
        }
        if (i > 0 && patch_is_off(j, at)) return 1;
    }
    return 0;
}

static int join_is_off(const join *j, const ff_panorama_sight *sight)
{
    for (unsigned face = 0; face < FF_FACE_COUNT; face++) {
        ff_face_axis at = ff_face_axes[face];
        int64_t low = sight->low_wu[face], high = sight->high_wu[face];
        if (low > high) continue;
        if (at.axis < 2 && face_is_off(j, at.axis, at.sign, 2, low, high)) return 1;
        for (int i = 0; at.axis == 2 && i < PATCHES; i++)
            if (face_is_off(j, 2, at.sign, 1, j->z_wu * (2 * i - PATCHES) / PATCHES,
                            j->z_wu * (2 * i + 2 - PATCHES) / PATCHES))
                return 1;
    }
    return 0;
}

static int32_t kept_wu(int32_t z_wu) { return z_wu < Z_WU_MAX ? z_wu : Z_WU_MAX; }

int ff_panorama_outdated(const c3d_camera *camera, const int32_t taken_wu[3],
                         const ff_panorama_sight *sight, int32_t z_wu, int32_t error_px_q8)
{
    int64_t moved_wu[3], most_wu = 0;
    for (int i = 0; i < 3; i++) {
        moved_wu[i] = (int64_t)camera->pos_wu[i] - taken_wu[i];
        most_wu = larger(most_wu, magnitude(moved_wu[i]));
    }
    if (!most_wu) return 0;
    FF_ASSERT(z_wu > 0);
    if (error_px_q8 <= 0 || c3d_length64(moved_wu[0], moved_wu[1], moved_wu[2]) >= z_wu) return 1;
    join j = { .camera = camera,
               .half_q8 = { camera->width * 128, camera->height * 128 },
               .error_q8 = error_px_q8 < 1 << 30 ? error_px_q8 : 1 << 30,
               .z_wu = kept_wu(z_wu) };
    c3d_rotation_from_camera(camera, &j.rotation);
    c3d_to_eye(&j.rotation, moved_wu, j.moved_eye_wu);
    FF_ASSERT(most_wu < z_wu);
    j.least_wu = least_depth_wu(&j, most_wu);
    return j.least_wu <= 0 || join_is_off(&j, sight);
}

static int64_t within(int64_t value, int64_t low, int64_t high)
{
    FF_ASSERT(low <= high);
    return value < low ? low : value > high ? high : value;
}

void ff_panorama_sight_terrain(ff_panorama_sight *sight, const int32_t taken_wu[3],
                               const int32_t ground_wu[2], int32_t z_wu)
{
    z_wu = kept_wu(z_wu);
    /* Farther away, any ground comes closer to the level of O. */
    int32_t low = (int32_t)within((int64_t)ground_wu[0] - taken_wu[2], -z_wu, 0);
    int32_t high = (int32_t)within((int64_t)ground_wu[1] - taken_wu[2], 0, z_wu);
    for (unsigned face = 0; face < FF_FACE_COUNT; face++) {
        int there = face == FF_FACE_UP ? high == z_wu : face == FF_FACE_DOWN ? low == -z_wu : 1;
        sight->low_wu[face] = there ? low : 1;
        sight->high_wu[face] = there ? high : 0;
    }
}

void ff_panorama_sight_face(ff_panorama_sight *sight, unsigned face, unsigned face_size,
                            unsigned top_row, unsigned row_count, int32_t z_wu)
{
    FF_ASSERT(face < FF_FACE_COUNT && top_row + row_count <= face_size);
    int64_t z = kept_wu(z_wu), size = face_size, top = top_row ? top_row - 1 : 0,
            bottom = top_row + row_count;
    sight->high_wu[face] = row_count ? (int32_t)(z - z * 2 * top / size) : 0;
    sight->low_wu[face] = row_count ? (int32_t)(z - (z * 2 * bottom + size - 1) / size) : 1;
    FF_ASSERT(!row_count || sight->low_wu[face] < sight->high_wu[face]);
}
