/* Strip masks: every combination covers a node exactly once, counter-clockwise, with rims that use
 * every 2^d-th vertex. */
#include "../../client/terrain/ff_strips.h"
#include "../../protocol/codec/ff_codec.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <string.h>

#define FINE       8    /* sample points a cell and axis */
#define UNIT       1024 /* integer units a cell */
#define POINTS_MAX (32 * FINE)

static ff_strips strips;
static uint8_t painted[POINTS_MAX][POINTS_MAX];

static long cross(const long a[2], const long b[2], const long p[2])
{
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
}

static void paint_triangle(unsigned n, const uint16_t v[3])
{
    long corner[3][2];
    for (unsigned i = 0; i < 3; i++) {
        assert_true(v[i] < (n + 1) * (n + 1));
        corner[i][0] = (long)(v[i] % (n + 1)) * UNIT;
        corner[i][1] = (long)(v[i] / (n + 1)) * UNIT;
    }
    assert_true(cross(corner[0], corner[1], corner[2]) > 0);
    for (unsigned row = 0; row < n * FINE; row++) {
        for (unsigned column = 0; column < n * FINE; column++) {
            /* 37 and 64 keep the points off all edges: those run 1 cell across and at most 32
             * along. */
            long p[2] = { (long)column * UNIT / FINE + 37, (long)row * UNIT / FINE + 64 };
            painted[row][column] += cross(corner[0], corner[1], p) > 0 &&
                                    cross(corner[1], corner[2], p) > 0 &&
                                    cross(corner[2], corner[0], p) > 0;
        }
    }
}

/* Number of triangles that are not degenerate. */
static unsigned paint_strip(unsigned n, unsigned id)
{
    const uint16_t *index = strips.index + strips.first[id];
    unsigned triangles = 0;
    for (unsigned i = 0; i + 2 < strips.length[id]; i++) {
        uint16_t v[3] = { index[i], index[i + 1 + (i & 1)], index[i + 2 - (i & 1)] };
        if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) {
            paint_triangle(n, v);
            triangles++;
        }
    }
    assert_int_equal(triangles, strips.triangles[id]);
    return triangles;
}

static void assert_painted_once(unsigned n)
{
    for (unsigned row = 0; row < n * FINE; row++) {
        for (unsigned column = 0; column < n * FINE; column++)
            assert_int_equal(painted[row][column], 1);
    }
    memset(painted, 0, sizeof painted);
}

/* Draws the picture once for the inside, adding one combination of sides at a time. */
static void check_combinations(unsigned k)
{
    unsigned n = 1u << k, options = k > 3 ? 2 : k + 1,
             total = options * options * options * options;
    for (unsigned combination = 0; combination < total; combination++) {
        unsigned rest = combination, difference[4], sides = 0;
        for (unsigned side = 0; side < 4; side++, rest /= options)
            difference[side] = k > 3 ? (rest % options) * (1 + combination % k) : rest % options;
        paint_strip(n, FF_STRIP_INNER);
        for (unsigned side = 0; side < 4; side++)
            sides += paint_strip(n, FF_STRIP_SIDE(side, difference[side]));
        unsigned expected = 0;
        for (unsigned side = 0; side < 4; side++) expected += (n >> difference[side]) + n - 2;
        assert_int_equal(sides, expected);
        assert_painted_once(n);
    }
}

static void every_combination_covers_once(void **state)
{
    (void)state;
    for (unsigned k = 1; k <= FF_NODE_LOG2_MAX; k++) {
        assert_int_equal(ff_strips_make(&strips, k), FF_OK);
        assert_int_equal(strips.count, 2 + 4 * (k + 1));
        assert_int_equal(paint_strip(1u << k, FF_STRIP_FULL), 2u << (2 * k));
        assert_painted_once(1u << k);
        check_combinations(k);
    }
}

/* The vertices of a side strip on its rim are exactly every 2^d-th one. */
static void rims_leave_out_vertices(void **state)
{
    (void)state;
    for (unsigned k = 1; k <= FF_NODE_LOG2_MAX; k++) {
        unsigned n = 1u << k;
        assert_int_equal(ff_strips_make(&strips, k), FF_OK);
        for (unsigned side = 0; side < 4; side++) {
            for (unsigned difference = 0; difference <= k; difference++) {
                unsigned id = FF_STRIP_SIDE(side, difference), seen[33] = { 0 };
                for (unsigned i = 0; i < strips.length[id]; i++) {
                    unsigned v = strips.index[strips.first[id] + i], x = v % (n + 1),
                             y = v / (n + 1);
                    unsigned across[4] = { y, n - x, n - y, x }, along[4] = { x, y, x, y };
                    assert_true(across[side] <= 1);
                    if (across[side] == 0) seen[along[side]] = 1;
                }
                for (unsigned i = 0; i <= n; i++)
                    assert_int_equal(seen[i], i % (1u << difference) == 0);
            }
        }
    }
}

static void diagonals_run_north_east(void **state)
{
    (void)state;
    assert_int_equal(ff_strips_make(&strips, 3), FF_OK);
    for (unsigned id = FF_STRIP_FULL; id <= FF_STRIP_INNER; id++) {
        const uint16_t *index = strips.index + strips.first[id];
        for (unsigned i = 0; i + 2 < strips.length[id]; i++) {
            unsigned has_south_west = 0, has_north_east = 0, least = index[i], most = index[i];
            for (unsigned j = 0; j < 3; j++) {
                least = index[i + j] < least ? index[i + j] : least;
                most = index[i + j] > most ? index[i + j] : most;
            }
            if (index[i] == index[i + 1] || index[i + 1] == index[i + 2] ||
                index[i] == index[i + 2])
                continue;
            has_south_west = least % 9 + 1 == most % 9;
            has_north_east = most == least + 10;
            assert_true(has_south_west && has_north_east);
        }
    }
}

static void strips_of_a_mask(void **state)
{
    (void)state;
    uint8_t strip[5];
    assert_int_equal(ff_strips_for(0, strip), 1);
    assert_int_equal(strip[0], FF_STRIP_FULL);
    for (unsigned mask = 1; mask < 16; mask++) {
        assert_int_equal(ff_strips_for(mask, strip), 5);
        assert_int_equal(strip[0], FF_STRIP_INNER);
        for (unsigned side = 0; side < 4; side++)
            assert_int_equal(strip[1 + side], FF_STRIP_SIDE(side, mask >> side & 1));
    }
}

static void node_sizes_out_of_range_are_errors(void **state)
{
    (void)state;
    assert_int_equal(ff_strips_make(&strips, 0), FF_ERR_RANGE);
    assert_int_equal(ff_strips_make(&strips, FF_NODE_LOG2_MAX + 1), FF_ERR_RANGE);
    assert_int_equal(ff_strips_make(&strips, 1), FF_OK);
    assert_int_equal(strips.length[FF_STRIP_INNER], 0);
}

static void indices_add_up(void **state)
{
    (void)state;
    for (unsigned node_log2 = 1; node_log2 <= FF_NODE_LOG2_MAX; node_log2++) {
        unsigned sum = 0;
        assert_int_equal(ff_strips_make(&strips, node_log2), FF_OK);
        for (unsigned i = 0; i < strips.count; i++) sum += strips.length[i];
        assert_int_equal(ff_strips_indices(node_log2), sum);
    }
}

/* Writes down a strip's triangles, corners in the order in which they are drawn: those whose middle
 * lies in one of the squares, or in none of them. */
static unsigned list_triangles(const uint16_t *index, unsigned length, unsigned k, ff_squares in,
                               int wanted, uint16_t list[][3])
{
    unsigned count = 0, n = 1u << k, squares = n < 8 ? n : 8;
    for (unsigned i = 0; i + 2 < length; i++) {
        uint16_t v[3] = { index[i], index[i + 1 + (i & 1)], index[i + 2 - (i & 1)] };
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        unsigned column = (v[0] % (n + 1) + v[1] % (n + 1) + v[2] % (n + 1)) * squares / (3 * n),
                 row = (v[0] / (n + 1) + v[1] / (n + 1) + v[2] / (n + 1)) * squares / (3 * n);
        if ((int)(in >> (8 * row + column) & 1) != wanted) continue;
        memcpy(list[count++], v, sizeof v);
    }
    return count;
}

/* What is left of a node has the triangles of its strips that lie in none of the squares, and no
 * others, each with its corners in the same order. */
static void squares_are_left_out(void **state)
{
    (void)state;
    static uint16_t part[3 * (2 * FF_NODE_HEIGHTS_MAX + 4)], listed[4096][3], left[4096][3];
    static const ff_squares some[] = { 0,
                                       1,
                                       ~(ff_squares)0,
                                       UINT64_C(0x55AA55AA55AA55AA),
                                       UINT64_C(0x0103070F1F3F7FFF),
                                       UINT64_C(0x9E3779B97F4A7C15) };
    for (unsigned k = 1; k <= FF_NODE_LOG2_MAX; k++) {
        assert_int_equal(ff_strips_make(&strips, k), FF_OK);
        for (unsigned i = 0; i < 16 * (sizeof some / sizeof *some); i++) {
            uint8_t id[5];
            ff_squares squares = some[i / 16];
            unsigned count = 0, expected = 0, ids = ff_strips_for(i % 16, id);
            for (unsigned j = 0; j < ids; j++) {
                const uint16_t *index = strips.index + strips.first[id[j]];
                count = ff_strips_without(index, strips.length[id[j]], k, squares, part, count);
                expected += list_triangles(index, strips.length[id[j]], k, squares, 0,
                                           listed + expected);
            }
            unsigned heights = ((1u << k) + 1) * ((1u << k) + 1);
            assert_true(count <= ff_strips_part(heights) && (count > 0) == (expected > 0));
            assert_int_equal(list_triangles(part, count, k, squares, 1, left), 0);
            assert_int_equal(list_triangles(part, count, k, squares, 0, left), expected);
            assert_memory_equal(left, listed, expected * sizeof *left);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_combination_covers_once),
        cmocka_unit_test(rims_leave_out_vertices),
        cmocka_unit_test(diagonals_run_north_east),
        cmocka_unit_test(strips_of_a_mask),
        cmocka_unit_test(indices_add_up),
        cmocka_unit_test(node_sizes_out_of_range_are_errors),
        cmocka_unit_test(squares_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
