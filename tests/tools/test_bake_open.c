/* An image that covers a part of the ground: nodes beyond it have no image, texels beyond it the
 * colours of ground without images, and what is stored says so. */
#include "../../client/terrain/ff_shade.h"
#include "../../protocol/ff_image.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../tools/bake/bake_say.h"
#include "../../tools/bake/image/bake_bare.h"
#include "../../tools/bake/image/bake_nearest.h"
#include "../../tools/bake/image/bake_open.h"
#include "../../tools/bake/image/bake_own.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
/* after the four above: */
#include <cmocka.h>

#define LEVELS  4
#define LOG2    4
#define STEPS   ((1u << LOG2) - 1)
#define WIDE    ((STEPS << (LEVELS - 1)) + 1) /* texels of the finest lattice */
#define SAMPLES 129
#define QUALITY 75
#define RGB     3
#define PHOTO   200

static ff_terrain_info info;
static bake_image image;

static int read_hills(const bake_samples *samples, uint32_t row, uint32_t column, uint32_t count,
                      uint16_t *heights, uint8_t *marks)
{
    (void)samples, (void)marks;
    for (uint32_t i = 0; i < count; i++) heights[i] = pack_fixture_hills(NULL, column + i, row);
    return 0;
}

static const bake_samples hills = { .width = SAMPLES, .height = SAMPLES, .read = read_hills };
static const bake_texel_place place = { .samples = (SAMPLES - 1.0) / (WIDE - 1),
                                        .last_x = SAMPLES - 1,
                                        .last_y = SAMPLES - 1 };

typedef int (*covers_fn)(uint32_t x, uint32_t y);

/* The west of the ground, and a boat. */
static int west(uint32_t x, uint32_t y) { return x <= 40 || (x == 100 && y == 70); }
/* Texels on the edge between nodes, and no other. */
static int edge(uint32_t x, uint32_t y) { return x == 4 * STEPS && y > 0; }
static int all_but_a_speck(uint32_t x, uint32_t y) { return x < 50 || x > 53 || y < 50 || y > 53; }

/* Lattices of a photograph where it covers: of random grey, or, `flat`, of one, which goes on
 * everywhere. */
static void make_of(covers_fn covers, int flat)
{
    bake_grid distance;
    info = (ff_terrain_info){ .node_log2 = 3,
                              .tile_log2 = 7,
                              .texture_log2 = LOG2,
                              .texture_levels = LEVELS,
                              .spacing_wu = 32 * 256,
                              .hscale_q24 = 256u << 16,
                              .height_max = 1500 };
    bake_temp_setup("build/tests/");
    ff_shape_cover(&info, SAMPLES, SAMPLES);
    image = (bake_image){ .levels = LEVELS };
    assert_int_equal(bake_grid_open(&distance, WIDE, WIDE, sizeof(uint32_t)), 0);
    for (uint32_t l = 0; l < LEVELS; l++) {
        uint32_t wide = (STEPS << l) + 1, skip = LEVELS - 1 - l;
        assert_int_equal(bake_grid_open(&image.lattice[l], wide, wide, RGB), 0);
        for (uint32_t y = 0; y < wide; y++)
            for (uint32_t x = 0; x < wide; x++) {
                uint8_t rgb[RGB];
                int grey = flat ? 0 : (int)((x << skip) * 7 + (y << skip) * 13) % 56;
                memset(rgb, PHOTO + grey, RGB);
                assert_int_equal(bake_grid_write(&image.lattice[l], y, x, 1, rgb), 0);
            }
    }
    for (uint32_t y = 0; y < WIDE; y++)
        for (uint32_t x = 0; x < WIDE; x++) {
            uint32_t far = covers(x, y) ? 0 : BAKE_NEAREST_FAR;
            assert_int_equal(bake_grid_write(&distance, y, x, 1, &far), 0);
        }
    bake_own *own = bake_own_open(&info, &hills);
    assert_non_null(own);
    assert_int_equal(bake_open_fill(&image, &info, flat ? NULL : own, &place, &distance), 0);
    bake_own_close(own);
    bake_grid_close(&distance);
}

static void make(covers_fn covers) { make_of(covers, 0); }

/* Some texel inside it, not on its edges, is covered. */
static int is_covered(covers_fn covers, ff_key key)
{
    uint32_t level = ff_key_level(key), code = ff_key_code(key), wide = STEPS << (LEVELS - 1),
             side = wide >> level, x0 = ff_morton_x(code) * side, y0 = ff_morton_y(code) * side;
    for (uint32_t y = y0; y <= y0 + side; y++)
        for (uint32_t x = x0; x <= x0 + side; x++)
            if (x % STEPS && y % STEPS && covers(x, y)) return 1;
    return 0;
}

static void check_nodes(covers_fn covers, uint32_t open)
{
    uint32_t found = 0;
    make(covers);
    for (uint32_t level = 0; level < LEVELS; level++)
        for (uint32_t code = 0; code >> 2 * level == 0; code++) {
            ff_key key = ff_key_make(0, level, code);
            int is_open = bake_is_open(&image, &info, key);
            assert_int_equal(is_open, !is_covered(covers, key));
            found += (uint32_t)is_open && level == LEVELS - 1;
        }
    assert_int_equal(found, open);
    bake_image_close(&image);
}

static void nodes_in_which_nothing_is_covered_are_open(void **state)
{
    (void)state;
    check_nodes(west, 64 - 3 * 8 - 1);
    check_nodes(all_but_a_speck, 0);
    check_nodes(edge, 64);
}

static void texels_beyond_have_the_colours_of_the_ground(void **state)
{
    (void)state;
    unsigned photo = 0, own = 0;
    make(west);
    bake_own *colours = bake_own_open(&info, &hills);
    assert_non_null(colours);
    for (uint32_t y = 0; y < WIDE; y++) {
        assert_int_equal(bake_own_row(colours, y * place.samples, place.samples), 0);
        for (uint32_t x = 0; x < WIDE; x++) {
            uint8_t rgb[RGB], expected[RGB];
            assert_int_equal(bake_grid_read(&image.lattice[LEVELS - 1], y, x, 1, rgb), 0);
            bake_own_at(colours, x * place.samples, expected);
            int is_photo = rgb[0] == rgb[1] && rgb[1] == rgb[2] && rgb[0] >= PHOTO;
            if (x <= 40 + BAKE_OPEN_NEAR) assert_true(is_photo); /* no sliver at a ground's rim */
            if (x > 40 + BAKE_OPEN_NEAR && (x < 97 || x > 103)) {
                assert_memory_equal(rgb, expected, RGB);
                own++;
            }
            photo += (unsigned)is_photo;
        }
    }
    assert_true(photo > 0 && own > 0);
    bake_own_close(colours);
    bake_image_close(&image);
}

/* As clients shade the same samples. */
static void colours_of_the_ground_are_those_of_clients(void **state)
{
    (void)state;
    make(west);
    bake_own *colours = bake_own_open(&info, &hills);
    uint16_t framed[11 * 11];
    ff_shade_grid grid = { .info = &info,
                           .cell_wu = (int32_t)info.spacing_wu,
                           .framed = framed,
                           .ramp = { info.height_min, info.height_max } };
    for (uint32_t y = 8; y < 120; y += 8)
        for (uint32_t x = 8; x < 120; x += 8) {
            for (uint32_t j = 0; j < 11; j++)
                for (uint32_t i = 0; i < 11; i++)
                    framed[j * 11 + i] = pack_fixture_hills(NULL, x + i - 1, y + j - 1);
            for (uint32_t j = 0; j < 9; j++) {
                assert_int_equal(bake_own_row(colours, y + j, 1), 0);
                for (uint32_t i = 0; i < 9; i++) {
                    uint8_t rgba[4], rgb[RGB];
                    ff_shade(&grid, i, j, rgba);
                    bake_own_at(colours, x + i, rgb);
                    assert_memory_equal(rgb, rgba, RGB);
                }
            }
        }
    bake_own_close(colours);
    bake_image_close(&image);
}

/* What packs get of a node: bytes, and the marks before it. */
static size_t stored(ff_key key, ff_image *read)
{
    bake_blob blob = { 0 };
    assert_int_equal(bake_texture_encode(&image, &info, QUALITY, key, 0, &blob), 0);
    size_t bytes = blob.byte_count;
    *read = (ff_image){ 0 };
    if (bytes) assert_int_equal(ff_image_read(blob.bytes, bytes, read), FF_OK);
    bake_blob_free(&blob);
    return bytes;
}

static void what_is_stored_tells_where_the_image_ends(void **state)
{
    (void)state;
    make(west);
    assert_int_equal(bake_bare_find(&image, &info, QUALITY), 0);
    for (uint32_t level = 0; level < LEVELS; level++)
        for (uint32_t code = 0; code >> 2 * level == 0; code++) {
            ff_key key = ff_key_make(0, level, code);
            ff_image read;
            size_t bytes = stored(key, &read);
            int open = bake_is_open(&image, &info, key);
            assert_int_equal(bytes == 0, open); /* random grey: none is like one above it */
            for (unsigned q = 0; q < 4 && bytes && level + 1 < LEVELS; q++)
                assert_int_equal(read.marks.open >> q & 1,
                                 bake_is_open(&image, &info, ff_key_child(key, q)));
            if (bytes) assert_int_equal(read.marks.bare, 0);
        }
    bake_image_close(&image);
}

static int has_open(ff_key key)
{
    if (bake_is_open(&image, &info, key)) return 1;
    for (uint32_t q = 0; q < 4 && ff_key_level(key) + 1 < LEVELS; q++)
        if (has_open(ff_key_child(key, q))) return 1;
    return 0;
}

/* Of one colour all are like the root; but its image must not lie on what is open. */
static void no_image_above_stands_for_what_is_open(void **state)
{
    (void)state;
    make_of(west, 1);
    assert_int_equal(bake_bare_find(&image, &info, QUALITY), 0);
    for (uint32_t level = 1; level < LEVELS; level++)
        for (uint32_t code = 0; code >> 2 * level == 0; code++) {
            ff_key key = ff_key_make(0, level, code);
            ff_image read;
            assert_int_equal(stored(key, &read) > 0,
                             has_open(key) && !bake_is_open(&image, &info, key));
        }
    bake_image_close(&image);
}

static void an_open_root_is_stored_as_a_mark(void **state)
{
    (void)state;
    make(edge);
    assert_int_equal(bake_bare_find(&image, &info, QUALITY), 0);
    ff_image read;
    assert_int_equal(stored(ff_key_make(0, 0, 0), &read), 1);
    assert_int_equal(read.marks.open, 15);
    for (uint32_t q = 0; q < 4; q++) assert_int_equal(stored(ff_key_make(0, 1, q), &read), 0);
    bake_image_close(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_in_which_nothing_is_covered_are_open),
        cmocka_unit_test(texels_beyond_have_the_colours_of_the_ground),
        cmocka_unit_test(colours_of_the_ground_are_those_of_clients),
        cmocka_unit_test(what_is_stored_tells_where_the_image_ends),
        cmocka_unit_test(no_image_above_stands_for_what_is_open),
        cmocka_unit_test(an_open_root_is_stored_as_a_mark)
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
