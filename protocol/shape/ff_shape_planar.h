/* The plane, flat or bent about the viewer (ff_terrain_info.curve_q60): tiles_x by tiles_y tiles in
 * a rectangle, tile number = first_tile + y * tiles_x + x, x to the east, y to the north; a column
 * is spacing_wu of x, a row of y, a height is z. One frame: world axes, the south-west sample at
 * west_wu, south_wu. What ff_shape.h says of each function is not said again; it includes this
 * file. */
#ifndef FF_SHAPE_PLANAR_H
#define FF_SHAPE_PLANAR_H

/* ff_shape_planar.c */
int ff_planar_check(const ff_terrain_info *info);
ff_extent ff_planar_extent(const ff_terrain_info *info, ff_key key);
ff_placed ff_planar_put(const ff_terrain_info *info, const ff_frame *frame, ff_key key);
ff_key ff_planar_across(const ff_terrain_info *info, ff_key key, enum ff_side side);
int ff_planar_locate(const ff_terrain_info *info, const ff_frame *frame, const int32_t place_wu[3],
                     ff_spot *spot);
ff_reach ff_planar_reach(const ff_terrain_info *info, const ff_frame *frame,
                         const int32_t centre_wu[3], int32_t view_wu, const int64_t height_wu[2]);
int64_t ff_planar_tile_distance(const ff_terrain_info *info, const ff_frame *frame,
                                const int32_t centre_wu[3], uint32_t tile);
ff_walk ff_planar_walk_out(const ff_terrain_info *info, const ff_frame *frame,
                           const ff_reach *reach, const int32_t centre_wu[3]);
ff_walk ff_planar_walk(const ff_terrain_info *info, const ff_reach *reach);
int ff_planar_next(const ff_terrain_info *info, ff_walk *walk, uint32_t *tile);
int32_t ff_planar_horizon_wu(const ff_terrain_info *info, const ff_frame *frame,
                             const int32_t place_wu[3]);
void ff_planar_cover(ff_terrain_info *info, uint32_t samples_x, uint32_t samples_y);

/* ---- how the ground falls away ---- */

static inline uint64_t ff_planar_square_of(int64_t away_wu)
{
    int64_t most = away_wu > INT32_MAX ? INT32_MAX : away_wu < -INT32_MAX ? -INT32_MAX : away_wu;
    return (uint64_t)(most * most); /* below 2^62 */
}

static inline int32_t ff_planar_drop_wu(const ff_terrain_info *info, int64_t east_wu,
                                        int64_t north_wu)
{
    uint64_t away2 = ff_planar_square_of(east_wu) + ff_planar_square_of(north_wu);
    uint64_t drop_wu = ((away2 >> 31) * info->curve_q60) >> 29;
    FF_ASSERT(away2 >> 31 <= UINT32_MAX && info->curve_q60 <= FF_CURVE_MAX);
    return drop_wu < INT32_MAX / 2 ? (int32_t)drop_wu : INT32_MAX / 2;
}

/* ---- place ---- */

static inline uint32_t ff_planar_tiles(const ff_terrain_info *info)
{
    FF_ASSERT((uint64_t)info->tiles_x * info->tiles_y <= FF_KEY_TILES_MAX);
    return info->tiles_x * info->tiles_y;
}

/* A tile counted from the terrain's own first. */
static inline uint32_t ff_planar_own_tile(const ff_terrain_info *info, uint32_t tile)
{
    FF_ASSERT(tile - info->first_tile < ff_planar_tiles(info));
    return tile - info->first_tile;
}

/* From the first of so many samples to the last. */
static inline int32_t ff_planar_length_wu(const ff_terrain_info *info, uint32_t samples)
{
    FF_ASSERT(samples >= 2 && samples - 1 <= INT32_MAX / info->spacing_wu);
    return (int32_t)((samples - 1) * info->spacing_wu);
}

/* x and y of the last sample. */
static inline int32_t ff_planar_east_wu(const ff_terrain_info *info)
{
    return info->west_wu + ff_planar_length_wu(info, info->samples_x);
}

static inline int32_t ff_planar_north_wu(const ff_terrain_info *info)
{
    return info->south_wu + ff_planar_length_wu(info, info->samples_y);
}

static inline int32_t ff_planar_least(int32_t a, int32_t b) { return a < b ? a : b; }

static inline void ff_planar_place(const ff_terrain_info *info, ff_key key, const ff_placed *placed,
                                   uint32_t column, uint32_t row, uint32_t height,
                                   int32_t place_wu[3])
{
    int32_t cell_wu = ff_node_cell_wu(info, ff_key_level(key));
    place_wu[0] = ff_planar_least(placed->planar.x_wu + (int32_t)column * cell_wu,
                                  ff_planar_east_wu(info));
    place_wu[1] = ff_planar_least(placed->planar.y_wu + (int32_t)row * cell_wu,
                                  ff_planar_north_wu(info));
    place_wu[2] = ff_height_wu(info, height);
}

/* How near and how far ground of a box beside the viewer lies along an axis, with the slack, in
 * units of 128 m, rounded to the safe side: a box is made for every node that is looked at. */
#define FF_PLANAR_COARSE_LOG2 15
FF_STATIC_ASSERT(FF_SHAPE_DROP_SLACK_WU == 4 << FF_PLANAR_COARSE_LOG2);
static inline uint32_t ff_planar_nearest(int64_t lo, int64_t hi)
{
    int32_t away = (int32_t)((lo > 0 ? lo : hi < 0 ? -hi : 0) >> FF_PLANAR_COARSE_LOG2) - 4;
    return away > 0 ? (uint32_t)away : 0;
}
static inline uint32_t ff_planar_farthest(int64_t lo, int64_t hi)
{
    return (uint32_t)((hi > -lo ? hi : -lo) >> FF_PLANAR_COARSE_LOG2) + 5;
}
/* The drop at so many units; above 5 900 km along an axis as at that distance. */
static inline int64_t ff_planar_coarse_drop_wu(const ff_terrain_info *info, uint32_t east,
                                               uint32_t north)
{
    east = east < 46340 ? east : 46340; /* two squares of it fit 32 bits */
    north = north < 46340 ? north : 46340;
    return (int64_t)((uint64_t)(east * east + north * north) * info->curve_q60 >> 30);
}

/* From a south-west corner to the ground's end, or to a place before it. */
static inline ff_box ff_planar_part(const ff_terrain_info *info, int32_t x_wu, int32_t y_wu,
                                    int32_t east_wu, int32_t north_wu, const int64_t height_wu[2],
                                    const int32_t from_wu[3])
{
    ff_box box;
    box.lo[0] = (int64_t)x_wu - from_wu[0];
    box.hi[0] = (int64_t)ff_planar_least(east_wu, ff_planar_east_wu(info)) - from_wu[0];
    box.lo[1] = (int64_t)y_wu - from_wu[1];
    box.hi[1] = (int64_t)ff_planar_least(north_wu, ff_planar_north_wu(info)) - from_wu[1];
    FF_ASSERT(box.lo[0] < box.hi[0] && box.lo[1] < box.hi[1]); /* no node of padding is held */
    box.lo[2] = height_wu[0] - from_wu[2];
    box.hi[2] = height_wu[1] - from_wu[2];
    if (info->curve_q60) {
        box.lo[2] -= ff_planar_coarse_drop_wu(info, ff_planar_farthest(box.lo[0], box.hi[0]),
                                              ff_planar_farthest(box.lo[1], box.hi[1]));
        box.hi[2] -= ff_planar_coarse_drop_wu(info, ff_planar_nearest(box.lo[0], box.hi[0]),
                                              ff_planar_nearest(box.lo[1], box.hi[1]));
    }
    return box;
}

static inline ff_box ff_planar_box(const ff_terrain_info *info, ff_key key, const ff_placed *placed,
                                   const int64_t height_wu[2], const int32_t from_wu[3])
{
    int32_t edge_wu = ff_node_edge_wu(info, ff_key_level(key)), x_wu = placed->planar.x_wu,
            y_wu = placed->planar.y_wu;
    FF_ASSERT(x_wu <= INT32_MAX - edge_wu && y_wu <= INT32_MAX - edge_wu);
    return ff_planar_part(info, x_wu, y_wu, x_wu + edge_wu, y_wu + edge_wu, height_wu, from_wu);
}

static inline void ff_planar_to_middle(const ff_terrain_info *info, ff_key key,
                                       const ff_placed *placed, int32_t height_wu,
                                       const int32_t from_wu[3], int64_t way_wu[3])
{
    int32_t edge_wu = ff_node_edge_wu(info, ff_key_level(key)), x_wu = placed->planar.x_wu,
            y_wu = placed->planar.y_wu;
    way_wu[0] = (int64_t)x_wu + ff_planar_least(edge_wu, ff_planar_east_wu(info) - x_wu) / 2 -
                from_wu[0];
    way_wu[1] = (int64_t)y_wu + ff_planar_least(edge_wu, ff_planar_north_wu(info) - y_wu) / 2 -
                from_wu[1];
    way_wu[2] = (int64_t)height_wu - from_wu[2];
}

static inline ff_box ff_planar_bounds(const ff_terrain_info *info, const ff_frame *frame,
                                      const int64_t height_wu[2], const int32_t from_wu[3])
{
    (void)frame;
    return ff_planar_part(info, info->west_wu, info->south_wu, INT32_MAX, INT32_MAX, height_wu,
                          from_wu);
}

/* Columns run east, rows north, and cells are square. */
static inline void ff_planar_slopes(const ff_terrain_info *info, ff_key key, int32_t slope_q8[2])
{
    (void)info, (void)key, (void)slope_q8;
}

/* ---- neighbour ---- */

/* The sides run round a node: so the one opposite is two further on. */
FF_STATIC_ASSERT(FF_SIDE_COUNT == 4 && FF_SIDE_NORTH - FF_SIDE_SOUTH == 2 &&
                 FF_SIDE_WEST - FF_SIDE_EAST == 2);

static inline ff_beside ff_planar_neighbour(const ff_terrain_info *info, ff_key key,
                                            enum ff_side side)
{
    enum ff_side opposite = (enum ff_side)((side + 2) % FF_SIDE_COUNT);
    return (ff_beside){ ff_planar_across(info, key, side), opposite, 0 };
}

/* ---- locate ---- */

static inline int32_t ff_planar_z_wu(const ff_terrain_info *info, const ff_frame *frame,
                                     const int32_t place_wu[3], int64_t height_q16)
{
    (void)frame, (void)place_wu;
    return info->hoffset_wu + (int32_t)((height_q16 * (int64_t)info->hscale_q24) >> 32);
}

/* ---- frame ---- */

static inline ff_frame ff_planar_frame(const ff_terrain_info *info, const int32_t world_wu[3])
{
    (void)info, (void)world_wu;
    return (ff_frame){ 0 };
}

static inline int ff_planar_same_frame(const ff_terrain_info *info, const ff_frame *a,
                                       const ff_frame *b)
{
    return (void)info, (void)a, (void)b, 1;
}

static inline void ff_planar_enter(const ff_terrain_info *info, const ff_frame *frame,
                                   const int32_t world_wu[3], int32_t place_wu[3])
{
    (void)info, (void)frame;
    for (unsigned axis = 0; axis < 3; axis++) place_wu[axis] = world_wu[axis];
}

static inline void ff_planar_leave(const ff_terrain_info *info, const ff_frame *frame,
                                   const int32_t place_wu[3], int32_t world_wu[3])
{
    ff_planar_enter(info, frame, place_wu, world_wu);
}

/* ---- tiles in reach ---- */

static inline int ff_planar_reaches(const ff_terrain_info *info, const ff_reach *reach,
                                    uint32_t tile)
{
    uint32_t own = ff_planar_own_tile(info, tile);
    int32_t x = (int32_t)(own % info->tiles_x), y = (int32_t)(own / info->tiles_x);
    return x >= reach->planar.x0 && x <= reach->planar.x1 && y >= reach->planar.y0 &&
           y <= reach->planar.y1;
}

/* ---- sheet ---- */

static inline ff_sheet ff_planar_sheet(const ff_terrain_info *info, uint32_t tile)
{
    uint32_t own = ff_planar_own_tile(info, tile);
    return (ff_sheet){ own % info->tiles_x, own / info->tiles_x };
}

static inline uint32_t ff_planar_sheet_tile(const ff_terrain_info *info, ff_sheet at)
{
    FF_ASSERT(at.x < info->tiles_x && at.y < info->tiles_y);
    return info->first_tile + at.y * info->tiles_x + at.x;
}

static inline ff_sheet ff_planar_sheet_tiles(const ff_terrain_info *info)
{
    return (ff_sheet){ info->tiles_x, info->tiles_y };
}

static inline ff_sheet ff_planar_sheet_samples(const ff_terrain_info *info)
{
    return (ff_sheet){ info->samples_x, info->samples_y };
}

static inline void ff_planar_size_wu(const ff_terrain_info *info, int64_t size_wu[2])
{
    size_wu[0] = ff_planar_length_wu(info, info->samples_x);
    size_wu[1] = ff_planar_length_wu(info, info->samples_y);
}

#endif
