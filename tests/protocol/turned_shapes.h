/* The list of shapes of test_turned.c: beside the plane one whose tiles are turned. The same ground
 * lies in the same place, but each tile's columns and rows run another way: what the shape answers
 * of sides, order along them, columns, rows and slopes differs from the plane, and whoever takes it
 * for granted draws other ground. */
#ifndef TURNED_SHAPES_H
#define TURNED_SHAPES_H

#include "../../protocol/shape/ff_shapes.h"

/* Quarter turns, counter-clockwise, of the tiles: two bits for each number modulo 16. 0: the plane
 * is asked. */
extern uint32_t turned_tiles;

static inline unsigned turned_by(uint32_t tile) { return turned_tiles >> (tile % 16 * 2) & 3; }

/* A place in a square of 0..last, seen from the square turned by so many quarters. */
static inline void turned_place(unsigned quarters, uint32_t last, uint32_t *x, uint32_t *y)
{
    for (; quarters; quarters--) {
        uint32_t column = *x;
        *x = last - *y;
        *y = column;
    }
}

static inline ff_key turned_key(ff_key key, unsigned quarters)
{
    uint32_t level = ff_key_level(key), code = ff_key_code(key), x = ff_morton_x(code),
             y = ff_morton_y(code);
    turned_place(quarters, (1u << level) - 1, &x, &y);
    return ff_key_make(ff_key_tile(key), level, ff_morton_encode(x, y));
}

/* The node of the plane that lies where a turned one does, and back. */
static inline ff_key turned_to_plane(ff_key key)
{
    return turned_key(key, turned_by(ff_key_tile(key)));
}
static inline ff_key turned_from_plane(ff_key key)
{
    return turned_key(key, (4 - turned_by(ff_key_tile(key))) % 4);
}

static inline ff_placed ff_turned_put(const ff_terrain_info *info, const ff_frame *frame,
                                      ff_key key)
{
    return ff_planar_put(info, frame, turned_to_plane(key));
}

static inline void ff_turned_place(const ff_terrain_info *info, ff_key key, const ff_placed *placed,
                                   uint32_t column, uint32_t row, uint32_t height,
                                   int32_t place_wu[3])
{
    turned_place(turned_by(ff_key_tile(key)), 1u << info->node_log2, &column, &row);
    ff_planar_place(info, key, placed, column, row, height, place_wu);
}

static inline void ff_turned_slopes(const ff_terrain_info *info, ff_key key, int32_t slope_q8[2])
{
    (void)info;
    for (unsigned quarters = turned_by(ff_key_tile(key)); quarters; quarters--) {
        int32_t along_columns = slope_q8[0];
        slope_q8[0] = -slope_q8[1];
        slope_q8[1] = along_columns;
    }
}

/* 1 when the samples of a turned tile's side run to the west or to the south. */
static inline int turned_back(unsigned side, unsigned quarters)
{
    return side % 2 ? quarters == 1 || quarters == 2 : quarters == 2 || quarters == 3;
}

static inline ff_beside ff_turned_neighbour(const ff_terrain_info *info, ff_key key,
                                            enum ff_side side)
{
    unsigned here = turned_by(ff_key_tile(key)), faced = ((unsigned)side + here) % 4;
    ff_beside beside = ff_planar_neighbour(info, turned_to_plane(key), (enum ff_side)faced);
    if (beside.key == FF_KEY_NONE) return beside;
    unsigned there = turned_by(ff_key_tile(beside.key));
    beside.key = turned_from_plane(beside.key);
    beside.side = (enum ff_side)((beside.side + 4 - there) % 4);
    beside.reversed = turned_back(side, here) != turned_back(beside.side, there);
    return beside;
}

static inline int ff_turned_locate(const ff_terrain_info *info, const ff_frame *frame,
                                   const int32_t place_wu[3], ff_spot *spot)
{
    if (!ff_planar_locate(info, frame, place_wu, spot)) return 0;
    uint32_t column = (uint32_t)spot->column_q16, row = (uint32_t)spot->row_q16; /* small tiles */
    turned_place((4 - turned_by(spot->tile)) % 4, 1u << (info->tile_log2 + 16), &column, &row);
    spot->column_q16 = column;
    spot->row_q16 = row;
    return 1;
}

/* The rest of the questions do not touch columns and rows. */
#define ff_turned_check         ff_planar_check
#define ff_turned_tiles         ff_planar_tiles
#define ff_turned_extent        ff_planar_extent /* of whole tiles: no sample is padding */
#define ff_turned_box           ff_planar_box
#define ff_turned_to_middle     ff_planar_to_middle
#define ff_turned_bounds        ff_planar_bounds
#define ff_turned_z_wu          ff_planar_z_wu
#define ff_turned_frame         ff_planar_frame
#define ff_turned_same_frame    ff_planar_same_frame
#define ff_turned_enter         ff_planar_enter
#define ff_turned_leave         ff_planar_leave
#define ff_turned_horizon_wu    ff_planar_horizon_wu
#define ff_turned_drop_wu       ff_planar_drop_wu
#define ff_turned_reach         ff_planar_reach
#define ff_turned_reaches       ff_planar_reaches
#define ff_turned_tile_distance ff_planar_tile_distance
#define ff_turned_walk_out      ff_planar_walk_out
#define ff_turned_walk          ff_planar_walk
#define ff_turned_next          ff_planar_next
#define ff_turned_sheet         ff_planar_sheet
#define ff_turned_sheet_tile    ff_planar_sheet_tile
#define ff_turned_sheet_tiles   ff_planar_sheet_tiles
#define ff_turned_sheet_samples ff_planar_sheet_samples
#define ff_turned_size_wu       ff_planar_size_wu
#define ff_turned_cover         ff_planar_cover

#undef FF_SHAPE_CALL
#define FF_SHAPE_CALL(info, question, arguments) \
    (turned_tiles ? ff_turned_##question arguments : ff_planar_##question arguments)

#endif
