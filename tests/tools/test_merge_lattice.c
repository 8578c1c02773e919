/* Which packs lie on one lattice, and where: spacings, places, heights. */
#include "../../protocol/codec/ff_codec_list.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../tools/merge/merge_lattice.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* after the four above: */
#include <cmocka.h>

/* A pack of `columns` x `rows` samples, `apart_wu` apart, its south-west sample x_mm, y_mm from a
 * common place; heights 100 to 900 steps of a metre. */
static ff_terrain_info pack(uint32_t apart_wu, int64_t x_mm, int64_t y_mm, uint32_t columns,
                            uint32_t rows)
{
    ff_terrain_info info = { .node_log2 = 3,
                             .tile_log2 = 10,
                             .codec = FF_CODEC_DEFLATE,
                             .height_min = 100,
                             .height_max = 900,
                             .spacing_wu = apart_wu,
                             .hscale_q24 = 1 << 24,
                             .epsg = 32632,
                             .origin_x_mm = 500000000 + x_mm,
                             .origin_y_mm = 5100000000 + y_mm };
    ff_shape_cover(&info, columns, rows);
    return info;
}

static merge_lattice lattice;
static merge_place place[3];
static uint32_t which;

static enum merge_fault find(const ff_terrain_info *a, const ff_terrain_info *b,
                             const ff_terrain_info *c)
{
    const ff_terrain_info *info[3] = { a, b, c };
    return merge_lattice_find(info, c ? 3 : 2, &lattice, place, &which);
}

static void fine_packs_lie_on_the_places_of_coarse_ones(void **state)
{
    ff_terrain_info coarse = pack(40 * 256, 0, 0, 11, 6), fine = pack(10 * 256, 50000, 30000, 9, 5);
    (void)state;
    assert_int_equal(find(&coarse, &fine, NULL), MERGE_FITS);
    assert_int_equal(lattice.width, 41);
    assert_int_equal(lattice.height, 21);
    assert_int_equal(lattice.apart_log2, 2);
    assert_int_equal(lattice.info.spacing_wu, 2560);
    assert_int_equal(lattice.info.origin_x_mm, 500000000);
    assert_int_equal(place[0].apart_log2, 2);
    assert_int_equal(place[0].left, 0);
    assert_int_equal(place[1].apart_log2, 0);
    assert_int_equal(place[1].left, 5);
    assert_int_equal(place[1].bottom, 3);
    assert_true(merge_place_precedes(place, 1, 0) && !merge_place_precedes(place, 0, 1));
}

static void the_corners_are_places_of_the_coarsest_pack(void **state)
{
    /* the fine one sticks out by 3 places in the west and 1 in the north */
    ff_terrain_info fine = pack(2560, -30000, 0, 9, 22), coarse = pack(4 * 2560, 0, 0, 11, 6);
    (void)state;
    assert_int_equal(find(&fine, &coarse, NULL), MERGE_FITS);
    assert_int_equal(lattice.width, 45);
    assert_int_equal(lattice.height, 25);
    assert_int_equal(place[0].left, 1);
    assert_int_equal(place[1].left, 4);
    assert_int_equal(lattice.info.origin_x_mm, 500000000 - 40000);
    assert_int_equal(lattice.info.origin_y_mm, 5100000000);
}

static void origins_at_the_ends_of_numbers_lie_nowhere(void **state)
{
    (void)state;
    const int64_t end_mm[] = { INT64_MIN, INT64_MAX, INT64_C(1) << 62 };
    for (size_t i = 0; i < sizeof end_mm / sizeof *end_mm; i++) {
        ff_terrain_info a = pack(10 * 256, 0, 0, 100, 100), b = a;
        a.origin_x_mm = end_mm[i];
        assert_int_equal(find(&a, &b, NULL), MERGE_PLACES);
        assert_int_equal(find(&b, &a, NULL), MERGE_PLACES);
        b.origin_x_mm = end_mm[i];
        assert_int_equal(find(&a, &b, NULL), MERGE_PLACES);
    }
}

static void origins_are_whole_millimetres_and_places_are_not(void **state)
{
    /* 7 world units are 27.34375 mm */
    ff_terrain_info a = pack(7, 0, 0, 100, 100), b = pack(7, 2734, -55, 50, 50);
    (void)state;
    assert_int_equal(find(&a, &b, NULL), MERGE_FITS);
    assert_int_equal(place[1].left, 100);
    assert_int_equal(place[0].bottom, 2);
    assert_int_equal(lattice.info.origin_y_mm, b.origin_y_mm); /* its own, not reckoned */
    b.origin_x_mm += 13;
    assert_int_equal(find(&a, &b, NULL), MERGE_PLACES);
}

static void what_lies_on_no_lattice_is_told_apart(void **state)
{
    ff_terrain_info a = pack(2560, 0, 0, 9, 9), b = pack(2560, 80000, 0, 9, 9), c = b;
    (void)state;
    assert_int_equal(find(&a, &b, NULL), MERGE_FITS);
    c.epsg = 32633;
    assert_int_equal(find(&a, &c, NULL), MERGE_SYSTEM);
    assert_int_equal(which, 1);
    c = b;
    c.spacing_wu = 7680;
    assert_int_equal(find(&a, &c, NULL), MERGE_SPACING);
    assert_int_equal(find(&a, &b, &c), MERGE_SPACING);
    assert_int_equal(which, 2);
    c = b;
    c.origin_y_mm += 5000;
    assert_int_equal(find(&a, &c, NULL), MERGE_PLACES);
    c = b;
    c.hscale_q24 /= 2;
    assert_int_equal(find(&a, &c, NULL), MERGE_STEP);
    c = b;
    c.hoffset_wu += 128; /* half a step */
    assert_int_equal(find(&a, &c, NULL), MERGE_STEP);
    c = b;
    c.node_log2 = 4;
    assert_int_equal(find(&a, &c, NULL), MERGE_NODES);
    c = b;
    c.codec = FF_CODEC_RICE;
    assert_int_equal(find(&a, &c, NULL), MERGE_NODES);
    c = b;
    c.max_error = 1;
    assert_int_equal(find(&a, &c, NULL), MERGE_LOSSY);
    c = b;
    c.curve_q60 = 9;
    assert_int_equal(find(&a, &c, NULL), MERGE_CURVE);
    c = b;
    c.hoffset_wu = -70000 * 256;
    assert_int_equal(find(&a, &c, NULL), MERGE_RANGE);
    c = b;
    c.origin_x_mm += INT64_C(1) << 50;
    assert_int_equal(find(&a, &c, NULL), MERGE_PLACES);
}

/* 20 m beside 40 m where both are places of 10 m: the coarser one would be finer than it is. */
static void lattices_that_are_not_in_each_other_do_not_fit(void **state)
{
    ff_terrain_info a = pack(40 * 256, 0, 0, 9, 9), b = pack(20 * 256, 10000, 0, 9, 9),
                    c = pack(10 * 256, 0, 0, 9, 9);
    (void)state;
    assert_int_equal(find(&a, &c, &b), MERGE_PLACES);
    assert_int_equal(which, 2);
    b.origin_x_mm += 10000;
    assert_int_equal(find(&a, &c, &b), MERGE_FITS);
}

static void heights_are_whole_steps_apart(void **state)
{
    ff_terrain_info a = pack(2560, 0, 0, 9, 9), b = pack(2560, 80000, 0, 9, 9);
    (void)state;
    b.hoffset_wu = -500 * 256;
    b.height_min = 20; /* -480 m */
    assert_int_equal(find(&a, &b, NULL), MERGE_FITS);
    assert_int_equal(lattice.info.hoffset_wu, -480 * 256); /* the lowest, as a bake has it */
    assert_int_equal(place[0].steps, 480);
    assert_int_equal(place[1].steps, -20);
    assert_int_equal(lattice.info.height_min, 0);
    assert_int_equal(lattice.info.height_max, 1380);
    a.hscale_q24 = b.hscale_q24 = 1677722; /* a tenth */
    b.hoffset_wu = -12800;
    assert_int_equal(find(&a, &b, NULL), MERGE_FITS);
    assert_int_equal(lattice.info.hoffset_wu, -48 * 256);
    assert_int_equal(place[0].steps, 480);
}

static void what_no_pack_reaches_is_measured(void **state)
{
    ff_terrain_info a = pack(2560, 0, 0, 5, 10), b = pack(2560, 50000, 0, 5, 5);
    (void)state;
    assert_int_equal(find(&a, &b, NULL), MERGE_FITS); /* side by side: 5 + 5 columns */
    assert_true(merge_lattice_gap(&lattice, place, 2) == 0.25);
    assert_true(merge_place_precedes(place, 0, 1) && !merge_place_precedes(place, 1, 0));
    a = pack(5120, 0, 0, 5, 10); /* places between packs side by side belong to them */
    b = pack(5120, 100000, 0, 5, 10);
    ff_terrain_info c = pack(2560, 0, 0, 3, 3);
    assert_int_equal(find(&a, &b, &c), MERGE_FITS);
    assert_true(merge_lattice_gap(&lattice, place, 3) == 0);
    merge_rectangle reach = merge_place_reach(&lattice, &place[1]);
    assert_int_equal(reach.left, 9);
    assert_int_equal(reach.right, 18);
    assert_int_equal(reach.bottom, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fine_packs_lie_on_the_places_of_coarse_ones),
        cmocka_unit_test(the_corners_are_places_of_the_coarsest_pack),
        cmocka_unit_test(origins_at_the_ends_of_numbers_lie_nowhere),
        cmocka_unit_test(origins_are_whole_millimetres_and_places_are_not),
        cmocka_unit_test(what_lies_on_no_lattice_is_told_apart),
        cmocka_unit_test(lattices_that_are_not_in_each_other_do_not_fit),
        cmocka_unit_test(heights_are_whole_steps_apart),
        cmocka_unit_test(what_no_pack_reaches_is_measured),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
