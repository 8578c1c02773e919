#include "ff_shape.h"

/* ---- place ---- */

/* ff_planar_check: a terrain's longest edge, in samples. */
FF_STATIC_ASSERT((uint64_t)FF_KEY_TILES_MAX << FF_TILE_LOG2_MAX <= 1ull << 48);

static uint32_t tiles_for(const ff_terrain_info *info, uint32_t samples)
{
    FF_ASSERT(samples >= 2);
    return ((samples - 2) >> info->tile_log2) + 1;
}

int ff_planar_check(const ff_terrain_info *info)
{
    uint64_t edge_x, edge_y;

    FF_ASSERT(info->tile_log2 <= FF_TILE_LOG2_MAX);
    if (info->tiles_x < 1 || info->tiles_y < 1 ||
        (uint64_t)info->tiles_x * info->tiles_y > FF_KEY_TILES_MAX)
        return 0;
    edge_x = (uint64_t)info->tiles_x << info->tile_log2;
    edge_y = (uint64_t)info->tiles_y << info->tile_log2;
    /* As many tiles as hold the samples: each has ground. */
    if (info->samples_x < 2 || info->samples_y < 2 ||
        tiles_for(info, info->samples_x) != info->tiles_x ||
        tiles_for(info, info->samples_y) != info->tiles_y)
        return 0;
    /* An edge of 48 bits times a spacing of 32 bits would overflow: so the spacing is compared with
     * the quotient. */
    return info->spacing_wu >= 1 && info->spacing_wu <= INT32_MAX / edge_x &&
           info->spacing_wu <= INT32_MAX / edge_y &&
           info->west_wu <= INT32_MAX - (int64_t)(edge_x * info->spacing_wu) &&
           info->south_wu <= INT32_MAX - (int64_t)(edge_y * info->spacing_wu) &&
           info->first_tile <= FF_KEY_TILES_MAX - ff_planar_tiles(info);
}

/* Of `width` samples from `first` on, how many there are before the last of `samples`. */
static uint32_t extent_along(uint32_t first, uint32_t width, uint32_t samples)
{
    if (first >= samples - 1) return 0;
    return samples - 1 - first < width ? samples - 1 - first : width;
}

ff_extent ff_planar_extent(const ff_terrain_info *info, ff_key key)
{
    uint32_t tile = ff_planar_own_tile(info, ff_key_tile(key)), code = ff_key_code(key),
             edge_log2 = info->tile_log2 - ff_key_level(key);
    ff_extent extent = { 1u << edge_log2, 1u << edge_log2 };

    FF_ASSERT(ff_key_level(key) <= info->tile_log2);
    if (!(((info->samples_x - 1) | (info->samples_y - 1)) & ((1u << info->tile_log2) - 1)))
        return extent; /* the samples fill the tiles */
    extent.columns = extent_along((tile % info->tiles_x << info->tile_log2) +
                                      (ff_morton_x(code) << edge_log2),
                                  1u << edge_log2, info->samples_x);
    extent.rows = extent_along((tile / info->tiles_x << info->tile_log2) +
                                   (ff_morton_y(code) << edge_log2),
                               1u << edge_log2, info->samples_y);
    return extent;
}

ff_placed ff_planar_put(const ff_terrain_info *info, const ff_frame *frame, ff_key key)
{
    uint32_t tile = ff_planar_own_tile(info, ff_key_tile(key)), code = ff_key_code(key);
    int32_t tile_wu = ff_node_edge_wu(info, 0), edge_wu = ff_node_edge_wu(info, ff_key_level(key));
    ff_placed placed;

    (void)frame;
    FF_ASSERT((uint64_t)code >> (2 * ff_key_level(key)) == 0);
    placed.planar.x_wu = info->west_wu + (int32_t)(tile % info->tiles_x) * tile_wu;
    placed.planar.y_wu = info->south_wu + (int32_t)(tile / info->tiles_x) * tile_wu;
    if (code) {
        placed.planar.x_wu += (int32_t)ff_morton_x(code) * edge_wu;
        placed.planar.y_wu += (int32_t)ff_morton_y(code) * edge_wu;
    }
    FF_ASSERT(placed.planar.x_wu >= info->west_wu && placed.planar.y_wu >= info->south_wu);
    FF_ASSERT(((int64_t)placed.planar.x_wu - info->west_wu) % edge_wu == 0);
    FF_ASSERT(((int64_t)placed.planar.y_wu - info->south_wu) % edge_wu == 0);
    return placed;
}

/* ---- neighbour ---- */

/* Moves *tile to the tile across `side`. Returns 0 when the terrain ends there: *tile then names no
 * tile. */
static int next_tile(const ff_terrain_info *info, enum ff_side side, uint32_t *tile)
{
    uint32_t own = ff_planar_own_tile(info, *tile), x = own % info->tiles_x,
             y = own / info->tiles_x;
    switch (side) {
        case FF_SIDE_SOUTH: *tile -= info->tiles_x; return y > 0;
        case FF_SIDE_EAST: *tile += 1; return x + 1 < info->tiles_x;
        case FF_SIDE_NORTH: *tile += info->tiles_x; return y + 1 < info->tiles_y;
        default: *tile -= 1; return x > 0;
    }
}

/* 1 when a node to the east or north of ground is padding. Asked often: who lies before the last
 * sample of its own tile needs no division to know. */
static int is_padding(const ff_terrain_info *info, ff_key key, int north)
{
    uint32_t code = ff_key_code(key), last = (north ? info->samples_y : info->samples_x) - 1,
             in_tile = last & ((1u << info->tile_log2) - 1);
    uint32_t at = (north ? ff_morton_y(code) : ff_morton_x(code))
                  << (info->tile_log2 - ff_key_level(key));

    if (in_tile == 0 || at < in_tile) return 0;
    ff_extent extent = ff_planar_extent(info, key);
    return (north ? extent.rows : extent.columns) == 0;
}

ff_key ff_planar_across(const ff_terrain_info *info, ff_key key, enum ff_side side)
{
    uint32_t tile = ff_key_tile(key), code;

    if (ff_key_step(key, side, &code) && !next_tile(info, side, &tile)) return FF_KEY_NONE;
    key = ff_key_make(tile, ff_key_level(key), code);
    if (side == FF_SIDE_SOUTH || side == FF_SIDE_WEST) return key;
    return is_padding(info, key, side == FF_SIDE_NORTH) ? FF_KEY_NONE : key;
}

/* ---- locate ---- */

/* Along one axis, counted from the first of `samples`: 1, the tile and the place in it, samples
 * Q16; 0 outside. The terrain's far rim belongs to its last tile. */
static int locate_along(const ff_terrain_info *info, int64_t at_wu, uint32_t samples,
                        uint32_t tiles, uint32_t *tile, uint64_t *sample_q16)
{
    uint32_t tile_wu = (uint32_t)ff_node_edge_wu(info, 0), at = (uint32_t)at_wu;

    FF_ASSERT((uint64_t)tiles * tile_wu <= INT32_MAX);
    if (at_wu < 0 || at_wu > ff_planar_length_wu(info, samples)) return 0;
    *tile = at == tiles * tile_wu ? tiles - 1 : at / tile_wu;
    *sample_q16 = ((uint64_t)(at - *tile * tile_wu) << 16) / info->spacing_wu;
    FF_ASSERT(*tile < tiles && *sample_q16 <= UINT64_C(1) << (info->tile_log2 + 16));
    return 1;
}

int ff_planar_locate(const ff_terrain_info *info, const ff_frame *frame, const int32_t place_wu[3],
                     ff_spot *spot)
{
    uint32_t x, y;

    (void)frame;
    if (!locate_along(info, (int64_t)place_wu[0] - info->west_wu, info->samples_x, info->tiles_x,
                      &x, &spot->column_q16) ||
        !locate_along(info, (int64_t)place_wu[1] - info->south_wu, info->samples_y, info->tiles_y,
                      &y, &spot->row_q16))
        return 0;
    spot->tile = info->first_tile + y * info->tiles_x + x;
    return 1;
}

/* ---- horizon ---- */

/* How far away ground has dropped by so much. */
static int64_t dropped_at(const ff_terrain_info *info, int64_t drop_wu)
{
    int64_t away_wu = 0;

    for (int64_t step = INT64_C(1) << 30; step; step >>= 1)
        if (ff_planar_drop_wu(info, away_wu + step, 0) <= drop_wu) away_wu += step;
    return away_wu;
}

/* A line of sight that grazes the level of the lowest ground still meets the highest. */
int32_t ff_planar_horizon_wu(const ff_terrain_info *info, const ff_frame *frame,
                             const int32_t place_wu[3])
{
    int64_t height_wu[2], above_wu, away_wu;

    (void)frame;
    if (!info->curve_q60) return INT32_MAX;
    ff_terrain_range_wu(info, height_wu);
    above_wu = place_wu[2] - height_wu[0];
    away_wu = dropped_at(info, above_wu > 0 ? above_wu : 0) +
              dropped_at(info, height_wu[1] - height_wu[0]);
    FF_ASSERT(away_wu >= 0 && away_wu < INT64_C(1) << 32);
    return away_wu < INT32_MAX ? (int32_t)away_wu : INT32_MAX;
}

/* ---- tiles in reach ---- */

static int64_t floor_div(int64_t a, int64_t b)
{
    int64_t quotient = a / b;
    FF_ASSERT(b > 0);
    return a % b < 0 ? quotient - 1 : quotient;
}

/* Along one axis, counted from the first sample. */
static void reach_along(int64_t centre_wu, int64_t view_wu, int64_t last_wu, int64_t tile_wu,
                        int64_t tiles, int32_t *first, int32_t *last)
{
    int64_t from = floor_div(centre_wu - view_wu - 1, tile_wu); /* touching counts */
    int64_t to = floor_div(centre_wu + view_wu, tile_wu);
    FF_ASSERT(from <= to && from <= INT32_MAX && to >= INT32_MIN);
    if (centre_wu - view_wu > last_wu) from = tiles; /* beyond the ground of the last tile */
    *first = (int32_t)(from < 0 ? 0 : from);
    *last = (int32_t)(to > tiles - 1 ? tiles - 1 : to);
}

ff_reach ff_planar_reach(const ff_terrain_info *info, const ff_frame *frame,
                         const int32_t centre_wu[3], int32_t view_wu, const int64_t height_wu[2])
{
    int64_t tile_wu = ff_node_edge_wu(info, 0);
    ff_reach reach;

    (void)frame;
    reach_along((int64_t)centre_wu[0] - info->west_wu, view_wu,
                ff_planar_length_wu(info, info->samples_x), tile_wu, info->tiles_x,
                &reach.planar.x0, &reach.planar.x1);
    reach_along((int64_t)centre_wu[1] - info->south_wu, view_wu,
                ff_planar_length_wu(info, info->samples_y), tile_wu, info->tiles_y,
                &reach.planar.y0, &reach.planar.y1);
    if (reach.planar.y1 < reach.planar.y0 || height_wu[0] - centre_wu[2] > view_wu ||
        centre_wu[2] - height_wu[1] > view_wu)
        reach.planar.x1 = reach.planar.x0 - 1;
    return reach;
}

static int64_t outside(int64_t value, int64_t lo, int64_t hi)
{
    FF_ASSERT(lo < hi);
    if (value < lo) return lo - value;
    return value > hi ? value - hi : 0;
}

int64_t ff_planar_tile_distance(const ff_terrain_info *info, const ff_frame *frame,
                                const int32_t centre_wu[3], uint32_t tile)
{
    static const int64_t height_wu[2] = { 0, 0 };
    ff_key key = ff_key_make(tile, 0, 0);
    ff_placed placed = ff_planar_put(info, frame, key);
    ff_box ground = ff_planar_box(info, key, &placed, height_wu, centre_wu);
    int64_t away_x = outside(0, ground.lo[0], ground.hi[0]),
            away_y = outside(0, ground.lo[1], ground.hi[1]);

    return away_x > away_y ? away_x : away_y;
}

static int32_t clamp(int64_t value, int32_t lo, int32_t hi)
{
    return value < lo ? lo : value > hi ? hi : (int32_t)value;
}

/* Square rings round the middle, from the inside: the row south of it, the one north of it, the
 * column west, the column east. The middle itself is the south of ring 0. */
ff_walk ff_planar_walk_out(const ff_terrain_info *info, const ff_frame *frame,
                           const ff_reach *reach, const int32_t centre_wu[3])
{
    int32_t edge_wu = ff_node_edge_wu(info, 0);
    ff_walk walk = { .planar = { .reach = *reach, .side = -1 } };

    (void)frame;
    walk.planar.x = clamp(((int64_t)centre_wu[0] - info->west_wu) / edge_wu, reach->planar.x0,
                          reach->planar.x1);
    walk.planar.y = clamp(((int64_t)centre_wu[1] - info->south_wu) / edge_wu, reach->planar.y0,
                          reach->planar.y1);
    return walk;
}

ff_walk ff_planar_walk(const ff_terrain_info *info, const ff_reach *reach)
{
    (void)info;
    return (ff_walk){ .planar = { .reach = *reach, .y = reach->planar.y0, .ring = -1 } };
}

/* The tiles from..to of a row or column, as far as they are in reach. */
static void start_run(const ff_terrain_info *info, ff_walk *walk, int along_x, int32_t other,
                      int32_t from, int32_t to)
{
    const ff_reach *reach = &walk->planar.reach;
    int32_t first = along_x ? reach->planar.x0 : reach->planar.y0,
            last = along_x ? reach->planar.x1 : reach->planar.y1;

    if (other < (along_x ? reach->planar.y0 : reach->planar.x0) ||
        other > (along_x ? reach->planar.y1 : reach->planar.x1))
        return;
    from = from < first ? first : from;
    to = to > last ? last : to;
    if (to < from) return;
    walk->planar.left = (uint32_t)(to - from) + 1;
    walk->planar.step = along_x ? 1 : info->tiles_x;
    walk->planar.tile = along_x ? (uint32_t)other * info->tiles_x + (uint32_t)from
                                : (uint32_t)from * info->tiles_x + (uint32_t)other;
    FF_ASSERT(walk->planar.tile + (walk->planar.left - 1) * walk->planar.step <
              ff_planar_tiles(info));
}

/* 0 when a ring lies all outside the tiles in reach, and so do those round it. */
static int ring_in_reach(const ff_walk *walk)
{
    const ff_reach *reach = &walk->planar.reach;
    int32_t x = walk->planar.x, y = walk->planar.y, r = walk->planar.ring;

    FF_ASSERT(x >= reach->planar.x0 && x <= reach->planar.x1); /* the middle was moved there */
    FF_ASSERT(y >= reach->planar.y0 && y <= reach->planar.y1);
    return x - r >= reach->planar.x0 || x + r <= reach->planar.x1 || y - r >= reach->planar.y0 ||
           y + r <= reach->planar.y1;
}

/* The next row by number, or the next side of a ring; it may have no tile in reach. 0 at the
 * end. */
static int next_run(const ff_terrain_info *info, ff_walk *walk)
{
    const ff_reach *reach = &walk->planar.reach;
    int32_t x = walk->planar.x, y = walk->planar.y, r = walk->planar.ring;

    FF_ASSERT(walk->planar.left == 0);
    if (reach->planar.x1 < reach->planar.x0) return 0;
    if (r < 0) {
        if (y > reach->planar.y1) return 0;
        walk->planar.y++;
        start_run(info, walk, 1, y, reach->planar.x0, reach->planar.x1);
        return 1;
    }
    if (++walk->planar.side > (r ? 3 : 0)) {
        walk->planar.side = 0;
        r = ++walk->planar.ring;
        if (!ring_in_reach(walk)) return 0;
    }
    switch (walk->planar.side) {
        case 0: start_run(info, walk, 1, y - r, x - r, x + r); break;
        case 1: start_run(info, walk, 1, y + r, x - r, x + r); break;
        case 2: start_run(info, walk, 0, x - r, y - r + 1, y + r - 1); break;
        default: start_run(info, walk, 0, x + r, y - r + 1, y + r - 1); break;
    }
    return 1;
}

int ff_planar_next(const ff_terrain_info *info, ff_walk *walk, uint32_t *tile)
{
    while (!walk->planar.left)
        if (!next_run(info, walk)) return 0;
    *tile = info->first_tile + walk->planar.tile;
    walk->planar.tile += walk->planar.step;
    walk->planar.left--;
    return 1;
}

/* ---- sheet ---- */

void ff_planar_cover(ff_terrain_info *info, uint32_t samples_x, uint32_t samples_y)
{
    info->samples_x = samples_x;
    info->samples_y = samples_y;
    info->tiles_x = tiles_for(info, samples_x);
    info->tiles_y = tiles_for(info, samples_y);
}
