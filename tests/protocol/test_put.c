/* Grounds held together: where each is put, and the numbers of its tiles. */
#include "../../platform/sys.h"
#include "../../protocol/shape/ff_shape.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

/* A terrain, and the same put elsewhere with other numbers of its tiles: all that is asked of its
 * shape differs by that and nothing else. */
typedef struct pair {
    ff_terrain_info own, put;
    int32_t from[2][3], point[2][3];
} pair;

static pair pair_by_chance(sys_random *random)
{
    pair p = { .own = { .node_log2 = 2,
                        .tile_log2 = 5,
                        .spacing_wu = 77,
                        .hscale_q24 = 1 << 22,
                        .height_max = 900 } };
    ff_shape_cover(&p.own, 130 + sys_random_u32(random) % 30, 200 + sys_random_u32(random) % 24);
    p.put = p.own;
    p.put.first_tile = sys_random_u32(random) % 1000;
    p.put.west_wu = (int32_t)sys_random_u32(random) / 3;
    p.put.south_wu = (int32_t)sys_random_u32(random) / 3;
    assert_int_equal(ff_terrain_check(&p.put), FF_OK);
    assert_int_equal(ff_terrain_same(&p.own, &p.put), 1);
    for (int axis = 0; axis < 3; axis++) {
        int32_t by = axis == 2 ? 0 : axis ? p.put.south_wu : p.put.west_wu;
        p.from[0][axis] = (int32_t)(sys_random_u32(random) % 30000) - 8000;
        p.point[0][axis] = (int32_t)(sys_random_u32(random) % 20000) - 1000;
        p.from[1][axis] = p.from[0][axis] + by;
        p.point[1][axis] = p.point[0][axis] + by;
    }
    return p;
}

static const ff_frame world = { 0 };
static const int64_t heights_wu[2] = { 0, 100 };

static void expect_node_moved(const pair *p, ff_key key)
{
    ff_key there = ff_terrain_key(&p->put, key);
    int32_t at[2][3];
    assert_true(ff_terrain_own_key(&p->put, there) == key);
    assert_true(ff_terrain_has_node(&p->put, there));
    assert_int_equal(ff_terrain_has_node(&p->put, key), ff_key_tile(key) >= p->put.first_tile);
    if (!ff_shape_has_ground(&p->own, key)) return;
    ff_placed placed = ff_shape_put(&p->own, &world, key),
              moved = ff_shape_put(&p->put, &world, there);
    ff_shape_place(&p->own, key, &placed, 3, 2, 700, at[0]);
    ff_shape_place(&p->put, there, &moved, 3, 2, 700, at[1]);
    assert_int_equal(at[1][0], at[0][0] + p->put.west_wu);
    assert_int_equal(at[1][1], at[0][1] + p->put.south_wu);
    assert_int_equal(at[1][2], at[0][2]);
    ff_box a = ff_shape_box(&p->own, key, &placed, heights_wu, p->from[0]),
           b = ff_shape_box(&p->put, there, &moved, heights_wu, p->from[1]);
    assert_memory_equal(&a, &b, sizeof a);
    for (int side = 0; side < FF_SIDE_COUNT; side++) {
        ff_key one = ff_shape_neighbour(&p->own, key, (enum ff_side)side).key,
               other = ff_shape_neighbour(&p->put, there, (enum ff_side)side).key;
        assert_true(other == (one == FF_KEY_NONE ? FF_KEY_NONE : ff_terrain_key(&p->put, one)));
    }
}

static void expect_found_moved(const pair *p)
{
    ff_spot spot[2];
    ff_box a = ff_shape_bounds(&p->own, &world, heights_wu, p->from[0]),
           b = ff_shape_bounds(&p->put, &world, heights_wu, p->from[1]);
    assert_memory_equal(&a, &b, sizeof a);
    int found = ff_shape_locate(&p->own, &world, p->point[0], &spot[0]);
    assert_int_equal(ff_shape_locate(&p->put, &world, p->point[1], &spot[1]), found);
    if (!found) return;
    assert_int_equal(spot[1].tile, spot[0].tile + p->put.first_tile);
    assert_true(spot[1].column_q16 == spot[0].column_q16);
    assert_true(spot[1].row_q16 == spot[0].row_q16);
}

static void expect_walk_moved(const pair *p)
{
    const ff_terrain_info *info[2] = { &p->own, &p->put };
    ff_reach reach[2];
    ff_walk walk[2];
    uint32_t next[2];
    for (int i = 0; i < 2; i++) {
        reach[i] = ff_shape_reach(info[i], &world, p->from[i], 4000, heights_wu);
        walk[i] = ff_shape_walk_out(info[i], &world, &reach[i], p->from[i]);
    }
    while (ff_shape_next(&p->own, &walk[0], &next[0])) {
        assert_int_equal(ff_shape_next(&p->put, &walk[1], &next[1]), 1);
        assert_int_equal(next[1], next[0] + p->put.first_tile);
        assert_int_equal(ff_shape_reaches(&p->put, &reach[1], next[1]), 1);
        assert_true(ff_shape_tile_distance(&p->own, &world, p->from[0], next[0]) ==
                    ff_shape_tile_distance(&p->put, &world, p->from[1], next[1]));
    }
    assert_int_equal(ff_shape_next(&p->put, &walk[1], &next[1]), 0);
}

static void a_terrain_lies_where_it_is_put(void **state)
{
    (void)state;
    sys_random random;
    sys_random_seed(&random, 4, 4);
    for (int i = 0; i < 3000; i++) {
        pair p = pair_by_chance(&random);
        uint32_t tile = sys_random_u32(&random) % 35;
        expect_node_moved(&p, ff_key_make(tile, 2, sys_random_u32(&random) % 16));
        expect_found_moved(&p);
        expect_walk_moved(&p);
        p.put.west_wu = INT32_MAX - 1000;
        assert_int_equal(ff_terrain_check(&p.put), FF_ERR_RANGE);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_terrain_lies_where_it_is_put),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
