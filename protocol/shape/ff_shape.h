/* The shape of the ground: where a terrain's samples lie in space, and which of its nodes touch.
 *
 * Everything that is stored, sent and held of a node is local to it: 16-bit heights on a square
 * grid, and a key. What the grid means in space is asked here, and nowhere else: no other file
 * reads tiles_x, multiplies edges, or takes two sides for opposite because they lie so on a map.
 * Five questions:
 *
 *   place      key, column, row, height -> a point; of a whole node, tile or terrain: a box
 *   neighbour  key, side -> the key across, the side there, and whether it runs the other way
 *   locate     a point -> tile, column, row
 *   frame      a place -> the coordinates in which z is up there
 *   horizon    how far ground is seen, how much it falls away on the way, which tiles are in reach
 *
 * A sixth, the sheet, is for tools that read or write a whole terrain as one raster.
 *
 * Frame: a client, a server's renderer and a judge each work in one frame: its z is up, and so all
 * that the camera, the sky, the panorama's cube, motion and fog know of the ground's shape is that
 * z is up. `frame` gives one for a place, `enter` and `leave` take points into it and out of it; a
 * view names its frame (ff_view), and whoever places ground passes it on. World axes, as in a
 * pack's header and in messages, are the planar terrain's only frame.
 *
 * Which shapes are built is said in ff_shapes.h. With one of them each function below is that
 * shape's own, resolved by the compiler. Lengths are in wu.
 */
#ifndef FF_SHAPE_H
#define FF_SHAPE_H

#include "../ff_terrain.h"

typedef struct ff_box {
    int64_t lo[3], hi[3];
} ff_box; /* wu, relative to a point that whoever asks for the box names */

/* A node across a side, FF_KEY_NONE where the ground ends. It touches with its side `side`;
 * `reversed`: that side's first sample is our side's last one. */
typedef struct ff_beside {
    ff_key key;
    enum ff_side side;
    uint8_t reversed;
} ff_beside;

/* A point of a tile's ground: 0 .. 2^tile_log2 samples of the finest level, Q16. */
typedef struct ff_spot {
    uint32_t tile;
    uint64_t column_q16, row_q16;
} ff_spot;

/* How far the ground reaches along a node's columns and rows, in samples of the finest level from
 * the first. */
typedef struct ff_extent {
    uint32_t columns, rows;
} ff_extent;

/* Place of a tile in the raster of all tiles, or their number each way. */
typedef struct ff_sheet {
    uint32_t x, y;
} ff_sheet;

/* See ff_shape_drop_wu. */
#define FF_SHAPE_DROP_SLACK_WU (512 * FF_WU_PER_METRE)

/* The test of a second shape builds another list. */
#ifndef FF_SHAPES_BUILT
#define FF_SHAPES_BUILT "ff_shapes.h"
#endif
#include FF_SHAPES_BUILT

/* ---- place ---- */

/* 1 when the tiles, samples and spacing make a terrain whose places all fit int32_t. */
static inline int ff_shape_check(const ff_terrain_info *info)
{
    return FF_SHAPE_CALL(info, check, (info));
}
/* How many tiles there are: their numbers are info->first_tile and those that follow. */
static inline uint32_t ff_shape_tiles(const ff_terrain_info *info)
{
    return FF_SHAPE_CALL(info, tiles, (info));
}
/* What is kept of a node's place as long as the frame stays: found once, when the node comes. */
static inline ff_placed ff_shape_put(const ff_terrain_info *info, const ff_frame *frame, ff_key key)
{
    return FF_SHAPE_CALL(info, put, (info, frame, key));
}
/* 2^(n-l) both ways, less where the terrain's last sample lies in the node: what is beyond is
 * padding. */
static inline ff_extent ff_shape_extent(const ff_terrain_info *info, ff_key key)
{
    return FF_SHAPE_CALL(info, extent, (info, key));
}
/* The same in cells of the grid of a payload: the root's own, or that of a node's children. */
static inline ff_cells ff_shape_cells(const ff_terrain_info *info, ff_key key, int refinement)
{
    ff_extent extent = ff_shape_extent(info, key);
    uint32_t levels = ff_key_level(key) + (refinement != 0);
    FF_ASSERT(info->node_log2 + levels <= info->tile_log2 && extent.columns && extent.rows);
    unsigned cell_log2 = info->tile_log2 - info->node_log2 - levels;
    return (ff_cells){ (uint8_t)(((extent.columns - 1) >> cell_log2) + 1),
                       (uint8_t)(((extent.rows - 1) >> cell_log2) + 1) };
}
/* 0 when all of a node is padding: it is neither drawn nor asked for. Every root has ground. */
static inline int ff_shape_has_ground(const ff_terrain_info *info, ff_key key)
{
    ff_extent extent = ff_shape_extent(info, key);
    return extent.columns > 0 && extent.rows > 0;
}
/* The sample in a column and row of the node's grid at a height in steps; columns and rows beyond
 * the last sample lie on it. The nodes that share a sample place it alike, bit for bit, whatever
 * their tiles and levels. */
static inline void ff_shape_place(const ff_terrain_info *info, ff_key key, const ff_placed *placed,
                                  uint32_t column, uint32_t row, uint32_t height,
                                  int32_t place_wu[3])
{
    FF_ASSERT(column <= 1u << info->node_log2 && row <= 1u << info->node_log2);
    FF_SHAPE_CALL(info, place, (info, key, placed, column, row, height, place_wu));
}
/* Holds all ground of the node between two heights, as it is drawn for a viewer at `from_wu`. */
static inline ff_box ff_shape_box(const ff_terrain_info *info, ff_key key, const ff_placed *placed,
                                  const int64_t height_wu[2], const int32_t from_wu[3])
{
    FF_ASSERT(height_wu[0] <= height_wu[1]);
    return FF_SHAPE_CALL(info, box, (info, key, placed, height_wu, from_wu));
}
/* From a point to the middle of the node's ground at a height: for measures. */
static inline void ff_shape_to_middle(const ff_terrain_info *info, ff_key key,
                                      const ff_placed *placed, int32_t height_wu,
                                      const int32_t from_wu[3], int64_t way_wu[3])
{
    FF_SHAPE_CALL(info, to_middle, (info, key, placed, height_wu, from_wu, way_wu));
}
/* Holds all of the terrain between two heights. */
static inline ff_box ff_shape_bounds(const ff_terrain_info *info, const ff_frame *frame,
                                     const int64_t height_wu[2], const int32_t from_wu[3])
{
    FF_ASSERT(height_wu[0] <= height_wu[1]);
    return FF_SHAPE_CALL(info, bounds, (info, frame, height_wu, from_wu));
}
/* Slopes along a node's columns and rows, reckoned with ff_node_cell_wu, become those to the east
 * and to the north. */
static inline void ff_shape_slopes(const ff_terrain_info *info, ff_key key, int32_t slope_q8[2])
{
    FF_SHAPE_CALL(info, slopes, (info, key, slope_q8));
}

/* ---- neighbour ---- */

/* The node of the same level across a side, unless it is padding. Asked back across .side it is
 * `key` again. */
static inline ff_beside ff_shape_neighbour(const ff_terrain_info *info, ff_key key,
                                           enum ff_side side)
{
    return FF_SHAPE_CALL(info, neighbour, (info, key, side));
}
/* The sample across that sample `along` of a side with samples 0..last is. */
static inline uint32_t ff_beside_along(const ff_beside *beside, uint32_t along, uint32_t last)
{
    FF_ASSERT(along <= last);
    return beside->reversed ? last - along : along;
}

/* ---- locate ---- */

/* The ground under or over a point: 1, or 0 where there is none. */
static inline int ff_shape_locate(const ff_terrain_info *info, const ff_frame *frame,
                                  const int32_t place_wu[3], ff_spot *spot)
{
    return FF_SHAPE_CALL(info, locate, (info, frame, place_wu, spot));
}

/* z in the frame of ground at a height of so many steps, Q16, under or over a point; below 0 where
 * it is drawn lower than it is. */
static inline int32_t ff_shape_z_wu(const ff_terrain_info *info, const ff_frame *frame,
                                    const int32_t place_wu[3], int64_t height_q16)
{
    FF_ASSERT(height_q16 <= (int64_t)UINT16_MAX << 16 &&
              height_q16 >= -((int64_t)UINT16_MAX << 16));
    return FF_SHAPE_CALL(info, z_wu, (info, frame, place_wu, height_q16));
}

/* ---- frame ---- */

/* The frame in which z is up at a place in world axes. */
static inline ff_frame ff_shape_frame(const ff_terrain_info *info, const int32_t world_wu[3])
{
    return FF_SHAPE_CALL(info, frame, (info, world_wu));
}
static inline int ff_shape_same_frame(const ff_terrain_info *info, const ff_frame *a,
                                      const ff_frame *b)
{
    return FF_SHAPE_CALL(info, same_frame, (info, a, b));
}
/* A point in world axes as one of the frame, and back. Both may be the same array. */
static inline void ff_shape_enter(const ff_terrain_info *info, const ff_frame *frame,
                                  const int32_t world_wu[3], int32_t place_wu[3])
{
    FF_SHAPE_CALL(info, enter, (info, frame, world_wu, place_wu));
}
static inline void ff_shape_leave(const ff_terrain_info *info, const ff_frame *frame,
                                  const int32_t place_wu[3], int32_t world_wu[3])
{
    FF_SHAPE_CALL(info, leave, (info, frame, place_wu, world_wu));
}

/* ---- horizon ---- */

/* No ground of the terrain is seen from a place further away than this; INT32_MAX: no limit. */
static inline int32_t ff_shape_horizon_wu(const ff_terrain_info *info, const ff_frame *frame,
                                          const int32_t place_wu[3])
{
    return FF_SHAPE_CALL(info, horizon_wu, (info, frame, place_wu));
}
/* How much lower than its height says ground lies for a viewer so far east and north of whom it
 * is, because it is curved. For pictures it is taken from where the viewer was lately, at most
 * FF_SHAPE_DROP_SLACK_WU away along each axis; boxes hold the ground for all such places. */
static inline int32_t ff_shape_drop_wu(const ff_terrain_info *info, int64_t east_wu,
                                       int64_t north_wu)
{
    return FF_SHAPE_CALL(info, drop_wu, (info, east_wu, north_wu));
}
/* The tiles that may have ground within `view_wu` of a place: no further along any axis of the
 * frame. height_wu: lowest and highest ground of the terrain. */
static inline ff_reach ff_shape_reach(const ff_terrain_info *info, const ff_frame *frame,
                                      const int32_t centre_wu[3], int32_t view_wu,
                                      const int64_t height_wu[2])
{
    FF_ASSERT(view_wu >= 0 && height_wu[0] <= height_wu[1]);
    return FF_SHAPE_CALL(info, reach, (info, frame, centre_wu, view_wu, height_wu));
}
static inline int ff_shape_reaches(const ff_terrain_info *info, const ff_reach *reach,
                                   uint32_t tile)
{
    FF_ASSERT(tile - info->first_tile < ff_shape_tiles(info));
    return FF_SHAPE_CALL(info, reaches, (info, reach, tile));
}
/* How far beyond the place a tile begins: an order among tiles that are in reach. */
static inline int64_t ff_shape_tile_distance(const ff_terrain_info *info, const ff_frame *frame,
                                             const int32_t centre_wu[3], uint32_t tile)
{
    FF_ASSERT(tile - info->first_tile < ff_shape_tiles(info));
    return FF_SHAPE_CALL(info, tile_distance, (info, frame, centre_wu, tile));
}
/* Walks over the tiles in reach: from the place outwards, or in the order of their numbers.
 * ff_shape_next gives one after the other, 0 when there are no more. */
static inline ff_walk ff_shape_walk_out(const ff_terrain_info *info, const ff_frame *frame,
                                        const ff_reach *reach, const int32_t centre_wu[3])
{
    return FF_SHAPE_CALL(info, walk_out, (info, frame, reach, centre_wu));
}
static inline ff_walk ff_shape_walk(const ff_terrain_info *info, const ff_reach *reach)
{
    return FF_SHAPE_CALL(info, walk, (info, reach));
}
static inline int ff_shape_next(const ff_terrain_info *info, ff_walk *walk, uint32_t *tile)
{
    return FF_SHAPE_CALL(info, next, (info, walk, tile));
}

/* ---- sheet ---- */

/* Where a tile lies in the raster of the whole terrain, x to the east, y to the north; the tile
 * that lies there; and the number of tiles each way. */
static inline ff_sheet ff_shape_sheet(const ff_terrain_info *info, uint32_t tile)
{
    FF_ASSERT(tile - info->first_tile < ff_shape_tiles(info));
    return FF_SHAPE_CALL(info, sheet, (info, tile));
}
static inline uint32_t ff_shape_sheet_tile(const ff_terrain_info *info, ff_sheet at)
{
    return FF_SHAPE_CALL(info, sheet_tile, (info, at));
}
static inline ff_sheet ff_shape_sheet_tiles(const ff_terrain_info *info)
{
    return FF_SHAPE_CALL(info, sheet_tiles, (info));
}
/* Samples of the source each way. */
static inline ff_sheet ff_shape_sheet_samples(const ff_terrain_info *info)
{
    return FF_SHAPE_CALL(info, sheet_samples, (info));
}
/* East and north, from the first to the last sample of the source. */
static inline void ff_shape_size_wu(const ff_terrain_info *info, int64_t size_wu[2])
{
    FF_SHAPE_CALL(info, size_wu, (info, size_wu));
}
/* Describes a terrain of so many samples: they, and tiles of info->tile_log2 that hold them all. */
static inline void ff_shape_cover(ff_terrain_info *info, uint32_t samples_x, uint32_t samples_y)
{
    FF_SHAPE_CALL(info, cover, (info, samples_x, samples_y));
}

#endif
