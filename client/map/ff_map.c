#include "ff_map.h"

#include "../../protocol/ff_assert.h"
#include "../../protocol/ff_terrain.h"

#define DOWN (-16384) /* a pitch */
/* drawn nodes have so many pixels for a triangle, at least */
#define PIXELS_OF_A_TRIANGLE 10

static int64_t within(int64_t value, int64_t least, int64_t most)
{
    FF_ASSERT(least <= most);
    return value < least ? least : value > most ? most : value;
}

static int32_t coordinate(int64_t wu) { return (int32_t)within(wu, -INT32_MAX, INT32_MAX); }

ff_map ff_map_make(const int32_t place_wu[3], int32_t yaw, int64_t px_wu_q8, const c3d_camera *lens)
{
    FF_ASSERT(px_wu_q8 > 0 && lens->focal_q8 >= 256);
    int64_t focal_q8 = within((int64_t)lens->focal_q8 * FF_MAP_LENS, 256, INT32_MAX);
    return (
        ff_map){ .place_wu = { place_wu[0], place_wu[1], place_wu[2] },
                 .yaw = yaw,
                 .away_wu = within(c3d_muldiv64(px_wu_q8, focal_q8, 65536), 1, FF_MAP_AWAY_WU_MAX),
                 .focal_q8 = (int32_t)focal_q8 };
}

/* Where the eye looks from straight down: unit vector, Q30. */
static void forward_q30(int32_t yaw, int32_t pitch, int32_t forward[3])
{
    int32_t level = c3d_cos_q30(pitch);
    forward[0] = c3d_mul_q30(level, c3d_sin_q30(yaw));
    forward[1] = c3d_mul_q30(level, c3d_cos_q30(yaw));
    forward[2] = c3d_sin_q30(pitch);
}

static void move(int32_t place_wu[3], const int32_t forward[3], int64_t way_wu)
{
    for (int axis = 0; axis < 3; axis++)
        place_wu[axis] = coordinate(place_wu[axis] +
                                    c3d_muldiv64(forward[axis], way_wu, C3D_ONE_Q30));
}

ff_map ff_map_of_camera(const c3d_camera *camera, int64_t away_wu)
{
    int32_t forward[3];
    ff_map map = { .yaw = camera->yaw,
                   .tilt = camera->pitch - DOWN,
                   .away_wu = within(away_wu, 1, FF_MAP_AWAY_WU_MAX),
                   .focal_q8 = camera->focal_q8 };
    forward_q30(camera->yaw, camera->pitch, forward);
    for (int axis = 0; axis < 3; axis++) map.place_wu[axis] = camera->pos_wu[axis];
    move(map.place_wu, forward, map.away_wu);
    return map;
}

void ff_map_camera(const ff_map *map, c3d_camera *camera)
{
    int32_t forward[3];
    FF_ASSERT(map->away_wu >= 1 && map->away_wu <= FF_MAP_AWAY_WU_MAX);
    camera->yaw = map->yaw;
    camera->pitch = map->tilt + DOWN;
    camera->roll = 0;
    camera->focal_q8 = map->focal_q8;
    forward_q30(camera->yaw, camera->pitch, forward);
    for (int axis = 0; axis < 3; axis++) camera->pos_wu[axis] = map->place_wu[axis];
    move(camera->pos_wu, forward, -map->away_wu);
}

int64_t ff_map_px_wu_q8(const ff_map *map)
{
    FF_ASSERT(map->focal_q8 > 0);
    int64_t px_wu_q8 = (map->away_wu << 16) / map->focal_q8;
    return px_wu_q8 > 1 ? px_wu_q8 : 1;
}

/* a^(1-part) b^part, by halving: a bit of part chooses between both halves of what is between. */
static int64_t by_ratio(int64_t a, int64_t b, uint32_t part_q16)
{
    FF_ASSERT(a >= 1 && b >= 1 && a <= INT32_MAX && b <= INT32_MAX);
    if (part_q16 >= 65536) return b;
    uint64_t low = (uint64_t)a << 16, high = (uint64_t)b << 16; /* Q16 */
    for (uint32_t bit = 1u << 15; bit && part_q16; bit >>= 1) {
        /* roots of products of 47 bits: each is the product of its roots */
        uint64_t middle = (uint64_t)c3d_isqrt64(low << 15) * c3d_isqrt64(high << 15) >> 15;
        *(part_q16 & bit ? &low : &high) = middle;
        part_q16 &= ~bit;
    }
    return (int64_t)((low + (1u << 15)) >> 16);
}

static int32_t straight(int32_t from, int32_t to, uint32_t part_q16)
{
    FF_ASSERT(part_q16 <= 65536);
    return (int32_t)(from + (((int64_t)to - from) * part_q16 >> 16));
}

ff_map ff_map_between(const ff_map *from, const ff_map *to, uint32_t part_q16)
{
    int32_t turn = (int16_t)((to->yaw - from->yaw) & 0xFFFF);
    if (part_q16 > 65536) part_q16 = 65536;
    ff_map map = { .yaw = straight(from->yaw, from->yaw + turn, part_q16) & 0xFFFF,
                   .tilt = straight(from->tilt, to->tilt, part_q16),
                   .away_wu = by_ratio(from->away_wu, to->away_wu, part_q16),
                   .focal_q8 = (int32_t)by_ratio(from->focal_q8, to->focal_q8, part_q16) };
    for (int axis = 0; axis < 3; axis++)
        map.place_wu[axis] = straight(from->place_wu[axis], to->place_wu[axis], part_q16);
    FF_ASSERT(map.away_wu >= 1 && map.focal_q8 >= 1);
    return map;
}

/* The next of 1, 2, 5, 10, 20 and so on. */
static uint64_t next_round(uint64_t metres)
{
    uint64_t ten = 1;
    FF_ASSERT(metres > 0);
    while (metres / ten >= 10) ten *= 10;
    return metres / ten == 2 ? 5 * ten : 2 * metres;
}

int32_t ff_map_contour_wu(int64_t px_wu_q8)
{
    uint64_t metres = 1, most = INT32_MAX / FF_WU_PER_METRE,
             least_wu_q8 = (uint64_t)within(px_wu_q8, 1, INT64_MAX / 16) * FF_MAP_CONTOUR_PX;
    while ((metres * FF_WU_PER_METRE << 8) < least_wu_q8 && next_round(metres) <= most)
        metres = next_round(metres);
    FF_ASSERT(metres <= most);
    return (int32_t)(metres * FF_WU_PER_METRE);
}

uint32_t ff_map_bar(int64_t px_wu_q8, uint32_t most_px, uint32_t *metres)
{
    uint64_t px = (uint64_t)within(px_wu_q8, 1, (int64_t)1 << 40), round = 1, best = 0,
             metre_q8 = (uint64_t)FF_WU_PER_METRE << 8;
    for (; round <= UINT32_MAX && round * metre_q8 <= px * most_px; round = next_round(round))
        best = round;
    *metres = (uint32_t)best;
    return (uint32_t)(best * metre_q8 / px);
}

uint32_t ff_map_triangles(uint32_t width, uint32_t height)
{
    FF_ASSERT(width <= 4096 && height <= 4096); /* c3d_camera's */
    return width * height / PIXELS_OF_A_TRIANGLE;
}
