/* Keys and Morton codes against plain x, y arithmetic. */
#include "../../protocol/ff_key.h"
#include "../../protocol/codec/ff_codec.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

static uint32_t naive_morton(uint32_t x, uint32_t y)
{
    uint32_t code = 0;

    for (int bit = 0; bit < 16; bit++)
        code |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
    return code;
}

static void morton_is_interleaving(void **state)
{
    (void)state;
    for (uint32_t y = 0; y < 64; y++)
        for (uint32_t x = 0; x < 64; x++)
            assert_int_equal(ff_morton_encode(x, y), naive_morton(x, y));
    for (uint32_t v = 0; v < 65536; v++) {
        assert_int_equal(ff_morton_encode(v, 65535 - v), naive_morton(v, 65535 - v));
        assert_int_equal(ff_morton_x(ff_morton_encode(v, v * 7919u & 65535u)), v);
        assert_int_equal(ff_morton_y(ff_morton_encode(v * 7919u & 65535u, v)), v);
    }
}

static void fields_survive(void **state)
{
    static const uint32_t tiles[] = { 0, 1, 77, FF_KEY_TILES_MAX - 1 };

    (void)state;
    for (unsigned t = 0; t < 4; t++)
        for (uint32_t level = 0; level <= FF_KEY_LEVEL_MAX; level++) {
            uint32_t code = (uint32_t)(((uint64_t)1 << (2 * level)) - 1);
            ff_key key = ff_key_make(tiles[t], level, code);
            assert_int_equal(ff_key_tile(key), tiles[t]);
            assert_int_equal(ff_key_level(key), level);
            assert_int_equal(ff_key_code(key), code);
            assert_true(key != FF_KEY_NONE);
        }
}

static void children_lie_in_their_quadrants(void **state)
{
    ff_key parent = ff_key_make(5, 3, ff_morton_encode(6, 3));

    (void)state;
    for (uint32_t q = 0; q < 4; q++) {
        ff_key child = ff_key_child(parent, q);
        assert_int_equal(ff_morton_x(ff_key_code(child)), 12 + (q & 1));
        assert_int_equal(ff_morton_y(ff_key_code(child)), 6 + (q >> 1));
        assert_int_equal(ff_key_quadrant(child), q);
        assert_true(ff_key_parent(child) == parent);
    }
}

/* One step to every side, against coordinates. */
static void steps_move_one_coordinate(void **state)
{
    (void)state;
    for (uint32_t level = 0; level <= 5; level++)
        for (uint32_t at = 0; at < 1u << (2 * level); at++) {
            uint32_t x = ff_morton_x(at), y = ff_morton_y(at), last = (1u << level) - 1;
            for (int side = 0; side < FF_SIDE_COUNT; side++) {
                uint32_t code, to_x = x, to_y = y;
                int over = ff_key_step(ff_key_make(9, level, at), (enum ff_side)side, &code);
                to_x += side == FF_SIDE_EAST ? 1 : side == FF_SIDE_WEST ? last : 0;
                to_y += side == FF_SIDE_NORTH ? 1 : side == FF_SIDE_SOUTH ? last : 0;
                assert_int_equal(code, naive_morton(to_x & last, to_y & last));
                assert_int_equal(over, (side == FF_SIDE_EAST && x == last) ||
                                           (side == FF_SIDE_WEST && x == 0) ||
                                           (side == FF_SIDE_NORTH && y == last) ||
                                           (side == FF_SIDE_SOUTH && y == 0));
            }
        }
}

static ff_terrain_info sound_terrain(void)
{
    return (ff_terrain_info){ .node_log2 = 3,
                              .tile_log2 = 10,
                              .codec = FF_CODEC_DEFLATE,
                              .tiles_x = 4,
                              .tiles_y = 2,
                              .samples_x = 4097,
                              .samples_y = 2000,
                              .spacing_wu = 2560,
                              .hscale_q24 = 1677722,
                              .hoffset_wu = -1000,
                              .height_max = 43000 };
}

static void terrain_ranges(void **state)
{
    const ff_terrain_info good = sound_terrain();
    ff_terrain_info t;

    (void)state;
    assert_int_equal(ff_terrain_check(&good), FF_OK);
#define BAD(field, value) \
    t = good;             \
    t.field = value;      \
    assert_int_equal(ff_terrain_check(&t), FF_ERR_RANGE)
    BAD(node_log2, 0);
    BAD(node_log2, 6);
    BAD(tile_log2, 2);
    for (uint8_t k = 1; k <= FF_NODE_LOG2_MAX; k++) {
        t = good;
        t.node_log2 = k;
        t.tile_log2 = k + FF_KEY_LEVEL_MAX;
        t.samples_x = t.samples_y = (1u << t.tile_log2) + 1;
        t.tiles_x = t.tiles_y = 1;
        t.spacing_wu = 2047;
        assert_int_equal(ff_terrain_check(&t), FF_OK);
        assert_int_equal(ff_terrain_levels(&t), FF_KEY_LEVEL_MAX + 1);
        assert_true(ff_terrain_has_node(&t, ff_key_make(0, FF_KEY_LEVEL_MAX, (1u << 30) - 1)));
        assert_false(ff_terrain_has_node(&t, FF_KEY_NONE));
        t.tile_log2++;
        assert_int_equal(ff_terrain_check(&t), FF_ERR_RANGE);
    }
    BAD(tile_log2, 19);
    BAD(flags, 4);
    BAD(texture_log2, 3);
    BAD(texture_log2, 9);
    BAD(texture_log2, 6);
    BAD(texture_levels, 1);
    BAD(height_min, 43001);
    BAD(max_error, 32768);
    BAD(tiles_x, 0);
    BAD(tiles_y, 0);
    BAD(tiles_x, UINT32_MAX);
    BAD(samples_x, 1);
    BAD(samples_y, 2050);
    BAD(samples_y, 1025); /* the northern tiles would be padding */
    BAD(samples_x, 3073);
    BAD(spacing_wu, 0);
    BAD(spacing_wu, 1u << 19);
    BAD(hscale_q24, 0);
    BAD(hscale_q24, 1u << 31);
    BAD(curve_q60, FF_CURVE_MAX + 1);
    BAD(hoffset_wu, INT32_MAX);
    t = good;
    t.codec = FF_CODEC_COUNT;
    assert_int_equal(ff_terrain_check(&t), FF_ERR_UNSUPPORTED);
#undef BAD
    t = good;
    t.tiles_x = 1;
    t.samples_x = 1025;
    t.tiles_y = 1u << 12;
    t.samples_y = (1u << 22) + 1;
    t.spacing_wu = 511;
    assert_int_equal(ff_terrain_check(&t), FF_OK);
    t.spacing_wu = 512; /* northern end at 2^31 wu */
    assert_int_equal(ff_terrain_check(&t), FF_ERR_RANGE);
}

static void nodes_of_a_terrain(void **state)
{
    const ff_terrain_info t = sound_terrain();

    (void)state;
    assert_true(ff_terrain_has_node(&t, ff_key_make(7, 7, (1u << 14) - 1)));
    assert_false(ff_terrain_has_node(&t, ff_key_make(7, 7, 1u << 14)));
    assert_false(ff_terrain_has_node(&t, ff_key_make(8, 0, 0)));
    assert_false(ff_terrain_has_node(&t, ff_key_make(0, 8, 0)));
    assert_false(ff_terrain_has_node(&t, FF_KEY_NONE));
}

static void errors_have_texts(void **state)
{
    (void)state;
    assert_string_equal(ff_error_text(FF_OK), "ok");
    assert_string_equal(ff_error_text(17), "ok");
    assert_string_equal(ff_error_text(FF_ERR_CHECKSUM), "checksum mismatch: the data is damaged");
    assert_string_equal(ff_error_text(FF_ERR_LAST - 1), "unknown error");
    for (int error = FF_ERR_LAST; error < 0; error++)
        assert_string_not_equal(ff_error_text(error), "unknown error");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(morton_is_interleaving),
        cmocka_unit_test(fields_survive),
        cmocka_unit_test(children_lie_in_their_quadrants),
        cmocka_unit_test(steps_move_one_coordinate),
        cmocka_unit_test(terrain_ranges),
        cmocka_unit_test(nodes_of_a_terrain),
        cmocka_unit_test(errors_have_texts),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
