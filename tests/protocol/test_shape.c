/* The planar shape against plain coordinates: neighbours, places, points found again, tiles in
 * reach. */
#include "../../platform/sys.h"
#include "../../protocol/shape/ff_shape.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <string.h>

static const int32_t nowhere[3] = { 0, 0, 0 };

static ff_terrain_info terrain_of(uint32_t tiles_x, uint32_t tiles_y)
{
    ff_terrain_info info = { .node_log2 = 2,
                             .tile_log2 = 5,
                             .spacing_wu = 77,
                             .hscale_q24 = 1 << 22,
                             .hoffset_wu = -1000,
                             .height_min = 10,
                             .height_max = 900 };
    ff_shape_cover(&info, (tiles_x << 5) + 1, (tiles_y << 5) + 1);
    assert_int_equal(ff_terrain_check(&info), FF_OK);
    return info;
}

/* ---- neighbours ---- */

/* By coordinates of the whole terrain at one level. */
static ff_key naive_neighbour(const ff_terrain_info *info, ff_key key, enum ff_side side)
{
    uint32_t level = ff_key_level(key), tile = ff_key_tile(key), width = 1u << level;
    int64_t x = (int64_t)(tile % info->tiles_x) * width + ff_morton_x(ff_key_code(key));
    int64_t y = (int64_t)(tile / info->tiles_x) * width + ff_morton_y(ff_key_code(key));

    x += side == FF_SIDE_EAST ? 1 : side == FF_SIDE_WEST ? -1 : 0;
    y += side == FF_SIDE_NORTH ? 1 : side == FF_SIDE_SOUTH ? -1 : 0;
    if (x < 0 || y < 0 || x >= (int64_t)info->tiles_x * width ||
        y >= (int64_t)info->tiles_y * width)
        return FF_KEY_NONE;
    tile = (uint32_t)(y / width) * info->tiles_x + (uint32_t)(x / width);
    return ff_key_make(tile, level, ff_morton_encode((uint32_t)(x % width), (uint32_t)(y % width)));
}

static void check_neighbours(const ff_terrain_info *info, ff_key key)
{
    for (int side = 0; side < FF_SIDE_COUNT; side++) {
        ff_beside beside = ff_shape_neighbour(info, key, (enum ff_side)side);
        assert_true(beside.key == naive_neighbour(info, key, (enum ff_side)side));
        if (beside.key == FF_KEY_NONE) continue;
        ff_beside back = ff_shape_neighbour(info, beside.key, beside.side);
        assert_true(back.key == key && back.side == (enum ff_side)side);
        assert_int_equal(back.reversed, beside.reversed);
    }
}

static void neighbours_of_small_grids_all(void **state)
{
    (void)state;
    for (uint32_t tiles_y = 1; tiles_y <= 3; tiles_y++)
        for (uint32_t tiles_x = 1; tiles_x <= 3; tiles_x++) {
            ff_terrain_info info = terrain_of(tiles_x, tiles_y);
            for (uint32_t level = 0; level <= 3; level++)
                for (uint32_t tile = 0; tile < ff_shape_tiles(&info); tile++)
                    for (uint32_t code = 0; code < 1u << (2 * level); code++)
                        check_neighbours(&info, ff_key_make(tile, level, code));
        }
}

static void neighbours_of_large_grids_sampled(void **state)
{
    ff_terrain_info info = { .tile_log2 = 15,
                             .tiles_x = 1u << 14,
                             .tiles_y = 1u << 14,
                             .samples_x = (1u << 29) + 1,
                             .samples_y = (1u << 29) + 1 };
    uint32_t random = 1;

    (void)state;
    for (int i = 0; i < 100000; i++) {
        uint32_t level = (uint32_t)i % 16, tile, code;
        random = random * 1664525u + 1013904223u;
        tile = (random >> 3) % FF_KEY_TILES_MAX;
        random = random * 1664525u + 1013904223u;
        code = (uint32_t)(random & (((uint64_t)1 << (2 * level)) - 1));
        if (i % 5 == 0) /* the rims are rare among random ones */
            code &= i % 2 ? 0x55555555u : 0xaaaaaaaau;
        check_neighbours(&info, ff_key_make(tile, level, code));
    }
}

/* ---- places ---- */

/* Sample `along` of a side, as a column and row. */
static void side_sample(const ff_terrain_info *info, enum ff_side side, uint32_t along,
                        uint32_t at[2])
{
    uint32_t last = 1u << info->node_log2;
    at[0] = side == FF_SIDE_EAST ? last : side == FF_SIDE_WEST ? 0 : along;
    at[1] = side == FF_SIDE_NORTH ? last : side == FF_SIDE_SOUTH ? 0 : along;
}

static void place_of(const ff_terrain_info *info, ff_key key, enum ff_side side, uint32_t along,
                     int32_t place_wu[3])
{
    ff_frame frame = ff_shape_frame(info, nowhere);
    ff_placed placed = ff_shape_put(info, &frame, key);
    uint32_t at[2];
    side_sample(info, side, along, at);
    ff_shape_place(info, key, &placed, at[0], at[1], 300 + along, place_wu);
}

static void shared_rims_lie_in_one_place(void **state)
{
    (void)state;
    ff_terrain_info info = terrain_of(3, 2);
    for (uint32_t level = 0; level <= 3; level++)
        for (uint32_t tile = 0; tile < 6; tile++)
            for (uint32_t code = 0; code < 1u << (2 * level); code++)
                for (int side = 0; side < FF_SIDE_COUNT; side++) {
                    ff_key key = ff_key_make(tile, level, code);
                    ff_beside beside = ff_shape_neighbour(&info, key, (enum ff_side)side);
                    int32_t here[3], there[3];
                    if (beside.key == FF_KEY_NONE) continue;
                    for (uint32_t along = 0; along <= 4; along++) {
                        place_of(&info, key, (enum ff_side)side, along, here);
                        place_of(&info, beside.key, beside.side, ff_beside_along(&beside, along, 4),
                                 there);
                        assert_memory_equal(here, there, sizeof here);
                    }
                }
}

static void places_are_products(void **state)
{
    (void)state;
    ff_terrain_info info = terrain_of(3, 2);
    ff_frame frame = ff_shape_frame(&info, nowhere);
    ff_key key = ff_key_make(4, 2, ff_morton_encode(3, 1)); /* tile (1, 1); 8 samples a node */
    ff_placed placed = ff_shape_put(&info, &frame, key);
    const int64_t height_wu[2] = { -50, 70 };
    const int32_t from_wu[3] = { 1000, 2000, 3000 };
    int32_t place_wu[3];
    int64_t way_wu[3];
    ff_shape_place(&info, key, &placed, 2, 3, 100, place_wu);
    assert_int_equal(place_wu[0], (32 + 3 * 8 + 2 * 2) * 77);
    assert_int_equal(place_wu[1], (32 + 1 * 8 + 3 * 2) * 77);
    assert_int_equal(place_wu[2], -1000 + 100 * 64);
    ff_box box = ff_shape_box(&info, key, &placed, height_wu, from_wu);
    assert_int_equal(box.lo[0], 56 * 77 - 1000);
    assert_int_equal(box.hi[0], 64 * 77 - 1000);
    assert_int_equal(box.lo[1], 40 * 77 - 2000);
    assert_int_equal(box.hi[1], 48 * 77 - 2000);
    assert_int_equal(box.lo[2], -3050);
    assert_int_equal(box.hi[2], -2930);
    ff_shape_to_middle(&info, key, &placed, 40, from_wu, way_wu);
    assert_int_equal(way_wu[0], 60 * 77 - 1000);
    assert_int_equal(way_wu[1], 44 * 77 - 2000);
    assert_int_equal(way_wu[2], 40 - 3000);
    box = ff_shape_bounds(&info, &frame, height_wu, from_wu);
    assert_int_equal(box.lo[0], -1000);
    assert_int_equal(box.hi[0], 96 * 77 - 1000);
    assert_int_equal(box.hi[1], 64 * 77 - 2000);
}

/* ---- points ---- */

static void points_are_found_in_their_tile(void **state)
{
    (void)state;
    ff_terrain_info info = terrain_of(3, 2);
    ff_frame frame = ff_shape_frame(&info, nowhere);
    sys_random random;
    sys_random_seed(&random, 1, 1);
    ff_spot spot;
    for (int i = 0; i < 20000; i++) {
        int32_t place_wu[3] = { (int32_t)sys_random_below(&random, 96 * 77 + 1),
                                (int32_t)sys_random_below(&random, 64 * 77 + 1), 5 };
        if (i % 7 == 0) place_wu[0] = place_wu[0] / (32 * 77) * (32 * 77); /* on a border */
        if (i % 11 == 0) place_wu[1] = 64 * 77;
        assert_true(ff_shape_locate(&info, &frame, place_wu, &spot));
        ff_sheet at = ff_shape_sheet(&info, spot.tile);
        uint64_t column = ((uint64_t)at.x << 21) + spot.column_q16,
                 row = ((uint64_t)at.y << 21) + spot.row_q16;
        assert_true(spot.column_q16 <= 32u << 16 && spot.row_q16 <= 32u << 16);
        assert_int_equal(column, ((uint64_t)place_wu[0] << 16) / 77);
        assert_int_equal(row, ((uint64_t)place_wu[1] << 16) / 77);
    }
    const int32_t outside[4][3] = {
        { -1, 5, 0 }, { 5, -1, 0 }, { 96 * 77 + 1, 5, 0 }, { 5, 64 * 77 + 1, 0 }
    };
    for (int i = 0; i < 4; i++) assert_false(ff_shape_locate(&info, &frame, outside[i], &spot));
}

/* The largest tile of the usual nodes, as wide as places reach. */
static void points_are_found_in_one_tile_for_all(void **state)
{
    (void)state;
    ff_terrain_info info = { .node_log2 = 3,
                             .tile_log2 = 18,
                             .tiles_x = 1,
                             .tiles_y = 1,
                             .samples_x = (1u << 18) + 1,
                             .samples_y = (1u << 17) + 7,
                             .spacing_wu = 8191 };
    ff_frame frame = ff_shape_frame(&info, nowhere);
    sys_random random;
    ff_spot spot;
    sys_random_seed(&random, 2, 1);
    assert_true(ff_shape_check(&info));
    for (int i = 0; i < 20000; i++) {
        int32_t place_wu[3] = { (int32_t)sys_random_below(&random, (1u << 18) * 8191 + 1),
                                (int32_t)sys_random_below(&random, (1u << 17) * 8191), 0 };
        if (i % 7 == 0) place_wu[0] = (1 << 18) * 8191; /* the last sample */
        assert_true(ff_shape_locate(&info, &frame, place_wu, &spot));
        assert_int_equal(spot.column_q16, ((uint64_t)place_wu[0] << 16) / 8191);
        assert_int_equal(spot.row_q16, ((uint64_t)place_wu[1] << 16) / 8191);
    }
    ff_key last = ff_key_make(0, 15, ff_morton_encode((1u << 15) - 1, 1u << 14));
    ff_placed placed = ff_shape_put(&info, &frame, last);
    assert_int_equal(placed.planar.x_wu, ((1 << 18) - 8) * 8191);
    ff_extent extent = ff_shape_extent(&info, last);
    assert_true(extent.columns == 8 && extent.rows == 6);
    assert_true(ff_shape_neighbour(&info, last, FF_SIDE_EAST).key == FF_KEY_NONE);
    assert_true(ff_shape_neighbour(&info, last, FF_SIDE_NORTH).key == FF_KEY_NONE);
    ff_key south = ff_shape_neighbour(&info, last, FF_SIDE_SOUTH).key;
    assert_int_equal(ff_morton_y(ff_key_code(south)), (1u << 14) - 1);
}

/* ---- where the samples end ---- */

static ff_terrain_info ending_terrain(void)
{
    ff_terrain_info info = terrain_of(1, 1);
    ff_shape_cover(&info, 100, 70); /* 4 by 3 tiles of 32 */
    assert_int_equal(ff_terrain_check(&info), FF_OK);
    return info;
}

static uint32_t clamped(int64_t value, uint32_t most)
{
    return value < 0 ? 0 : value > most ? most : (uint32_t)value;
}

static void check_ending_node(const ff_terrain_info *info, ff_key key)
{
    static const int64_t height_wu[2] = { 0, 10 };
    uint32_t level = ff_key_level(key), edge = 32u >> level, code = ff_key_code(key);
    uint32_t x = ff_key_tile(key) % 4 * 32 + ff_morton_x(code) * edge,
             y = ff_key_tile(key) / 4 * 32 + ff_morton_y(code) * edge;
    ff_extent extent = ff_shape_extent(info, key);
    assert_int_equal(extent.columns, clamped((int64_t)99 - x, edge));
    assert_int_equal(extent.rows, clamped((int64_t)69 - y, edge));
    assert_int_equal(ff_shape_has_ground(info, key), x < 99 && y < 69);
    if (!ff_shape_has_ground(info, key)) return;
    ff_frame frame = ff_shape_frame(info, nowhere);
    ff_placed placed = ff_shape_put(info, &frame, key);
    for (uint32_t column = 0; column <= 4; column++)
        for (uint32_t row = 0; row <= 4; row++) {
            int32_t place_wu[3];
            ff_shape_place(info, key, &placed, column, row, 0, place_wu);
            assert_int_equal(place_wu[0], clamped(x + column * (edge / 4), 99) * 77);
            assert_int_equal(place_wu[1], clamped(y + row * (edge / 4), 69) * 77);
        }
    ff_box box = ff_shape_box(info, key, &placed, height_wu, nowhere);
    int64_t way_wu[3];
    ff_shape_to_middle(info, key, &placed, 0, nowhere, way_wu);
    for (int axis = 0; axis < 2; axis++) {
        int64_t first = axis ? y : x, length = axis ? extent.rows : extent.columns;
        assert_int_equal(box.lo[axis], first * 77);
        assert_int_equal(box.hi[axis], (first + length) * 77);
        assert_int_equal(way_wu[axis], first * 77 + length * 77 / 2);
    }
    for (int side = 0; side < FF_SIDE_COUNT; side++) {
        ff_key across = naive_neighbour(info, key, (enum ff_side)side);
        if (across != FF_KEY_NONE && !ff_shape_has_ground(info, across)) across = FF_KEY_NONE;
        assert_true(ff_shape_neighbour(info, key, (enum ff_side)side).key == across);
    }
}

static void nodes_end_with_the_samples(void **state)
{
    (void)state;
    ff_terrain_info info = ending_terrain();
    for (uint32_t level = 0; level <= 3; level++)
        for (uint32_t tile = 0; tile < 12; tile++)
            for (uint32_t code = 0; code < 1u << (2 * level); code++)
                check_ending_node(&info, ff_key_make(tile, level, code));
}

static void nothing_is_found_beyond_the_samples(void **state)
{
    (void)state;
    static const int64_t height_wu[2] = { -100, 100 };
    ff_terrain_info info = ending_terrain();
    ff_frame frame = ff_shape_frame(&info, nowhere);
    ff_spot spot;
    const int32_t corner[3] = { 99 * 77, 69 * 77, 0 }, east[3] = { 99 * 77 + 1, 5, 0 },
                  north[3] = { 5, 69 * 77 + 1, 0 };
    assert_true(ff_shape_locate(&info, &frame, corner, &spot));
    assert_int_equal(spot.tile, 11);
    assert_int_equal(spot.column_q16, 3 << 16);
    assert_int_equal(spot.row_q16, 5 << 16);
    assert_false(ff_shape_locate(&info, &frame, east, &spot));
    assert_false(ff_shape_locate(&info, &frame, north, &spot));
    ff_box all = ff_shape_bounds(&info, &frame, height_wu, nowhere);
    assert_int_equal(all.hi[0], 99 * 77);
    assert_int_equal(all.hi[1], 69 * 77);
    /* 20 samples beyond the last one, still over the tile */
    const int32_t beyond[3] = { 119 * 77, 40 * 77, 0 };
    assert_int_equal(ff_shape_tile_distance(&info, &frame, beyond, 7), 20 * 77);
    ff_reach reach = ff_shape_reach(&info, &frame, beyond, 20 * 77, height_wu);
    assert_true(ff_shape_reaches(&info, &reach, 7));
    reach = ff_shape_reach(&info, &frame, beyond, 20 * 77 - 1, height_wu);
    assert_false(ff_shape_reaches(&info, &reach, 7));
}

/* ---- tiles in reach ---- */

/* The ring of a tile round the one nearest the centre, and its place in that ring: rows from west
 * to east before columns from south to north. */
static uint64_t order_of(const ff_reach *reach, const int32_t centre[2], uint32_t x, uint32_t y)
{
    int32_t edge = 32 * 77, at[2] = { centre[0] / edge, centre[1] / edge };
    at[0] = at[0] < reach->planar.x0 ? reach->planar.x0 : at[0];
    at[0] = at[0] > reach->planar.x1 ? reach->planar.x1 : at[0];
    at[1] = at[1] < reach->planar.y0 ? reach->planar.y0 : at[1];
    at[1] = at[1] > reach->planar.y1 ? reach->planar.y1 : at[1];
    int32_t dx = (int32_t)x - at[0], dy = (int32_t)y - at[1];
    uint32_t far_x = (uint32_t)(dx < 0 ? -dx : dx), far_y = (uint32_t)(dy < 0 ? -dy : dy);
    uint64_t ring = far_x > far_y ? far_x : far_y;
    uint64_t run = far_y == ring ? (dy <= 0 ? 0 : 1) : dx < 0 ? 2 : 3;
    return ring << 40 | run << 32 | (run < 2 ? x : y);
}

static void walks_cover_what_is_in_reach(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 2, 1);
    for (int i = 0; i < 3000; i++) {
        ff_terrain_info info = terrain_of(1 + sys_random_below(&random, 9),
                                          1 + sys_random_below(&random, 9));
        ff_frame frame = ff_shape_frame(&info, nowhere);
        int32_t edge = 32 * 77, view = (int32_t)sys_random_below(&random, 6 * 32 * 77);
        const int32_t centre[3] = { (int32_t)sys_random_below(&random, 15 * 32 * 77) - 3 * edge,
                                    (int32_t)sys_random_below(&random, 15 * 32 * 77) - 3 * edge,
                                    (int32_t)sys_random_below(&random, 30000) - 10000 };
        int64_t height_wu[2];
        ff_terrain_range_wu(&info, height_wu);
        ff_reach reach = ff_shape_reach(&info, &frame, centre, view, height_wu);
        uint8_t seen[81] = { 0 };
        uint32_t tile, count = 0, by_number = 0;
        uint64_t before = 0;
        ff_walk walk = ff_shape_walk_out(&info, &frame, &reach, centre);
        for (; ff_shape_next(&info, &walk, &tile); count++) {
            ff_sheet at = ff_shape_sheet(&info, tile);
            uint64_t order = order_of(&reach, centre, at.x, at.y);
            assert_false(seen[tile]++);
            assert_true(count == 0 || order > before);
            before = order;
        }
        int64_t last = -1;
        walk = ff_shape_walk(&info, &reach);
        for (; ff_shape_next(&info, &walk, &tile); by_number++, last = tile)
            assert_true(seen[tile] && (int64_t)tile > last);
        assert_int_equal(by_number, count);
        for (tile = 0; tile < ff_shape_tiles(&info); tile++) {
            ff_sheet at = ff_shape_sheet(&info, tile);
            int64_t x = (int64_t)at.x * edge, y = (int64_t)at.y * edge;
            int touches = x <= (int64_t)centre[0] + view && x + edge >= (int64_t)centre[0] - view &&
                          y <= (int64_t)centre[1] + view && y + edge >= (int64_t)centre[1] - view &&
                          height_wu[0] <= centre[2] + view && height_wu[1] >= centre[2] - view;
            int64_t away = ff_shape_tile_distance(&info, &frame, centre, tile);
            assert_int_equal(seen[tile], touches);
            assert_int_equal(ff_shape_reaches(&info, &reach, tile), touches);
            if (touches) assert_true(away <= view);
        }
    }
}

/* ---- the frame, the sheet ---- */

static void the_plane_has_one_frame_and_no_horizon(void **state)
{
    (void)state;
    ff_terrain_info info = terrain_of(3, 2);
    const int32_t place[3] = { 5000, -7, 123456 };
    int32_t to[3];
    ff_frame here = ff_shape_frame(&info, place), there = ff_shape_frame(&info, nowhere);
    assert_true(ff_shape_same_frame(&info, &here, &there));
    ff_shape_enter(&info, &here, place, to);
    assert_memory_equal(to, place, sizeof to);
    ff_shape_leave(&info, &here, place, to);
    assert_memory_equal(to, place, sizeof to);
    assert_int_equal(ff_shape_horizon_wu(&info, &here, place), INT32_MAX);
    assert_int_equal(ff_shape_drop_wu(&info, 1 << 30, 0), 0);
    assert_int_equal(ff_shape_z_wu(&info, &here, place, (uint64_t)100 << 16), -1000 + 100 * 64);
}

/* ---- curved ground ---- */

/* The square of the distance through the curvature, against double precision, near and far. */
static void curved_ground_falls_away_with_the_square(void **state)
{
    (void)state;
    ff_terrain_info info = terrain_of(3, 2);
    sys_random random;
    sys_random_seed(&random, 8, 8);
    for (int i = 0; i < 100000; i++) {
        info.curve_q60 = sys_random_u32(&random) % FF_CURVE_MAX + 1;
        int64_t east = (int32_t)sys_random_u32(&random) >> sys_random_u32(&random) % 20,
                north = (int32_t)sys_random_u32(&random) >> sys_random_u32(&random) % 20;
        double drop = ((double)east * east + (double)north * north) *
                      ldexp((double)info.curve_q60, -60),
               found = ff_shape_drop_wu(&info, east, north);
        if (drop >= INT32_MAX / 2) continue;
        /* the square is taken in whole 2^31 */
        assert_true(found <= drop + 1 && found >= drop - ldexp(info.curve_q60, -29) - 2);
    }
    assert_int_equal(ff_shape_drop_wu(&info, INT64_MAX, INT64_MIN), INT32_MAX / 2);
}

/* Beyond the horizon a line of sight to the highest ground has met the lowest; a little before it
 * may not have. */
static void nothing_is_seen_beyond_the_horizon(void **state)
{
    (void)state;
    ff_terrain_info info = terrain_of(3, 2);
    info.curve_q60 = 307486195; /* the Earth's, refraction 0.13 */
    const double per_m = ldexp(info.curve_q60, -60) * FF_WU_PER_METRE;
    for (int32_t height_m = 1; height_m < 40000; height_m *= 2) {
        const int32_t place[3] = { 5000, -7, height_m * FF_WU_PER_METRE };
        int64_t range_wu[2];
        ff_terrain_range_wu(&info, range_wu);
        double least_m = (double)range_wu[0] / FF_WU_PER_METRE,
               most_m = (double)range_wu[1] / FF_WU_PER_METRE,
               wanted_m = sqrt((height_m - least_m) / per_m) + sqrt((most_m - least_m) / per_m);
        ff_frame here = ff_shape_frame(&info, place);
        double found_m = (double)ff_shape_horizon_wu(&info, &here, place) / FF_WU_PER_METRE;
        assert_true(found_m >= wanted_m && found_m < wanted_m * 1.001 + 100);
    }
}

/* All ground of a node, seen from within the slack, lies in its box. */
static void boxes_hold_curved_ground(void **state)
{
    (void)state;
    ff_terrain_info info = terrain_of(40, 30);
    const ff_frame world = { 0 };
    sys_random random;
    info.spacing_wu = 40 * FF_WU_PER_METRE;
    info.curve_q60 = 307486195;
    sys_random_seed(&random, 9, 9);
    for (int i = 0; i < 20000; i++) {
        ff_key key = ff_key_make(sys_random_u32(&random) % 1200, 1, sys_random_u32(&random) % 4);
        const int32_t from[3] = { (int32_t)sys_random_u32(&random) >> 4,
                                  (int32_t)sys_random_u32(&random) >> 4, 700000 };
        const int64_t height_wu[2] = { -1000, 60000 };
        ff_placed placed = ff_shape_put(&info, &world, key);
        ff_box box = ff_shape_box(&info, key, &placed, height_wu, from);
        int32_t at[3];
        ff_shape_place(&info, key, &placed, sys_random_u32(&random) % 5,
                       sys_random_u32(&random) % 5, 0, at);
        int64_t slack[2];
        for (int axis = 0; axis < 2; axis++)
            slack[axis] = (int64_t)(sys_random_u32(&random) % (2 * FF_SHAPE_DROP_SLACK_WU)) -
                          FF_SHAPE_DROP_SLACK_WU;
        int64_t drop = ff_shape_drop_wu(&info, (int64_t)at[0] - from[0] + slack[0],
                                        (int64_t)at[1] - from[1] + slack[1]);
        assert_true(height_wu[0] - drop - from[2] >= box.lo[2]);
        assert_true(height_wu[1] - drop - from[2] <= box.hi[2]);
    }
}

static void tiles_cover_the_samples(void **state)
{
    (void)state;
    ff_terrain_info info = { .tile_log2 = 5, .spacing_wu = 10 };
    int64_t size_wu[2];
    ff_shape_cover(&info, 33, 34);
    ff_sheet tiles = ff_shape_sheet_tiles(&info), samples = ff_shape_sheet_samples(&info);
    assert_int_equal(tiles.x, 1);
    assert_int_equal(tiles.y, 2);
    assert_int_equal(samples.x, 33);
    assert_int_equal(samples.y, 34);
    ff_shape_size_wu(&info, size_wu);
    assert_int_equal(size_wu[0], 320);
    assert_int_equal(size_wu[1], 330);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(neighbours_of_small_grids_all),
        cmocka_unit_test(neighbours_of_large_grids_sampled),
        cmocka_unit_test(shared_rims_lie_in_one_place),
        cmocka_unit_test(places_are_products),
        cmocka_unit_test(points_are_found_in_their_tile),
        cmocka_unit_test(points_are_found_in_one_tile_for_all),
        cmocka_unit_test(nodes_end_with_the_samples),
        cmocka_unit_test(nothing_is_found_beyond_the_samples),
        cmocka_unit_test(walks_cover_what_is_in_reach),
        cmocka_unit_test(the_plane_has_one_frame_and_no_horizon),
        cmocka_unit_test(curved_ground_falls_away_with_the_square),
        cmocka_unit_test(nothing_is_seen_beyond_the_horizon),
        cmocka_unit_test(boxes_hold_curved_ground),
        cmocka_unit_test(tiles_cover_the_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
