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

/* The neighbour by coordinates of the whole terrain at one level. */
static ff_key naive_neighbour(uint32_t tiles_x, uint32_t tiles_y, ff_key key, enum ff_side side)
{
    uint32_t level = ff_key_level(key), tile = ff_key_tile(key), width = 1u << level;
    int64_t x = (int64_t)(tile % tiles_x) * width + ff_morton_x(ff_key_code(key));
    int64_t y = (int64_t)(tile / tiles_x) * width + ff_morton_y(ff_key_code(key));

    x += side == FF_SIDE_EAST ? 1 : side == FF_SIDE_WEST ? -1 : 0;
    y += side == FF_SIDE_NORTH ? 1 : side == FF_SIDE_SOUTH ? -1 : 0;
    if (x < 0 || y < 0 || x >= (int64_t)tiles_x * width || y >= (int64_t)tiles_y * width)
        return FF_KEY_NONE;
    tile = (uint32_t)(y / width) * tiles_x + (uint32_t)(x / width);
    return ff_key_make(tile, level, naive_morton((uint32_t)(x % width), (uint32_t)(y % width)));
}

static void check_neighbours(uint32_t tiles_x, uint32_t tiles_y, ff_key key)
{
    for (int side = 0; side < FF_SIDE_COUNT; side++) {
        ff_key found = ff_key_neighbour(tiles_x, tiles_y, key, (enum ff_side)side);
        assert_true(found == naive_neighbour(tiles_x, tiles_y, key, (enum ff_side)side));
        if (found != FF_KEY_NONE) /* sides 0..3 run round, so the opposite one is two away */
            assert_true(ff_key_neighbour(tiles_x, tiles_y, found, (enum ff_side)((side + 2) % 4)) ==
                        key);
    }
}

static void neighbours_of_small_grids_all(void **state)
{
    (void)state;
    for (uint32_t tiles_y = 1; tiles_y <= 3; tiles_y++)
        for (uint32_t tiles_x = 1; tiles_x <= 3; tiles_x++)
            for (uint32_t level = 0; level <= 4; level++)
                for (uint32_t tile = 0; tile < tiles_x * tiles_y; tile++)
                    for (uint32_t code = 0; code < 1u << (2 * level); code++)
                        check_neighbours(tiles_x, tiles_y, ff_key_make(tile, level, code));
}

static void neighbours_of_large_grids_sampled(void **state)
{
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
        check_neighbours(1u << 14, 1u << 14, ff_key_make(tile, level, code));
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
    BAD(tile_log2, 16);
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
    BAD(spacing_wu, 0);
    BAD(spacing_wu, 1u << 19);
    BAD(hscale_q24, 0);
    BAD(hscale_q24, 1u << 31);
    BAD(hoffset_wu, INT32_MAX);
    t = good;
    t.codec = FF_CODEC_COUNT;
    assert_int_equal(ff_terrain_check(&t), FF_ERR_UNSUPPORTED);
#undef BAD
    t = good;
    t.tiles_x = 1;
    t.samples_x = 1025;
    t.tiles_y = 1u << 12;
    t.spacing_wu = 511;
    assert_int_equal(ff_terrain_check(&t), FF_OK);
    t.spacing_wu = 512; /* northern end at 2^31 wu */
    assert_int_equal(ff_terrain_check(&t), FF_ERR_RANGE);
}

static void positions_of_nodes(void **state)
{
    const ff_terrain_info t = sound_terrain();
    int32_t x, y;

    (void)state;
    ff_node_origin_wu(&t, ff_key_make(5, 2, ff_morton_encode(3, 1)), &x, &y);
    assert_int_equal(x, (1024 + 3 * 256) * 2560);
    assert_int_equal(y, (1024 + 1 * 256) * 2560);
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
        cmocka_unit_test(neighbours_of_small_grids_all),
        cmocka_unit_test(neighbours_of_large_grids_sampled),
        cmocka_unit_test(terrain_ranges),
        cmocka_unit_test(positions_of_nodes),
        cmocka_unit_test(errors_have_texts),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
