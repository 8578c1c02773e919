/* Images that would show no more than one above them are left out, and no others. */
#include "../../platform/sys.h"
#include "../../protocol/ff_image.h"
#include "../../protocol/shape/ff_shape.h"
#include "../../tools/bake/bake_enlarge.h"
#include "../../tools/bake/image/bake_bare.h"
#include "../../tools/bake/image/bake_image_local.h"

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
#define SIDE    (1u << LOG2)
#define QUALITY 75
#define RGB     3

typedef void (*colour_fn)(uint32_t x, uint32_t y, uint8_t rgb[RGB]);

static ff_terrain_info info;
static bake_image image;

static void sea(uint32_t x, uint32_t y, uint8_t rgb[RGB])
{
    (void)x, (void)y;
    memcpy(rgb, "\x1e\x3c\x78", RGB);
}

static void boat(uint32_t x, uint32_t y, uint8_t rgb[RGB])
{
    sea(x, y, rgb);
    if (x / 2 == 20 && y / 2 == 33) memset(rgb, 220, RGB);
}

static void coast(uint32_t x, uint32_t y, uint8_t rgb[RGB])
{
    uint32_t noise = (x * 2654435761u ^ y * 40503u) * 2246822519u;
    sea(x, y, rgb);
    rgb[0] = (uint8_t)(30 + (x + y) / 16); /* nearly level */
    if (x < 30 + y / 8) memset(rgb, 60 + (int)(noise >> 25), RGB);
}

/* A tile of 2^7 samples, of which some columns are ground, with lattices of every 2^n-th point. */
static void make(colour_fn colour, uint32_t samples_x)
{
    info = (ff_terrain_info){ .node_log2 = 3,
                              .tile_log2 = 7,
                              .texture_log2 = LOG2,
                              .texture_levels = LEVELS,
                              .spacing_wu = 256,
                              .hscale_q24 = 1u << 24 };
    bake_temp_setup("build/tests/");
    ff_shape_cover(&info, samples_x, 129);
    image = (bake_image){ .levels = LEVELS };
    for (uint32_t l = 0; l < LEVELS; l++) {
        uint32_t nodes_x = ((samples_x - 2) >> (7 - l)) + 1, skip = LEVELS - 1 - l;
        bake_grid *lattice = &image.lattice[l];
        assert_int_equal(
            bake_grid_open(lattice, nodes_x * (SIDE - 1) + 1, (SIDE - 1) * (1u << l) + 1, RGB), 0);
        for (uint32_t y = 0; y < lattice->height; y++)
            for (uint32_t x = 0; x < lattice->width; x++) {
                uint8_t rgb[RGB];
                colour(x << skip, y << skip, rgb);
                assert_int_equal(bake_grid_write(lattice, y, x, 1, rgb), 0);
            }
    }
    assert_int_equal(bake_bare_find(&image, &info, QUALITY), 0);
}

/* What packs get of a node: 0, or its image decoded. */
static int stored(ff_key key, uint8_t rgb[SIDE * SIDE * RGB], uint8_t *bare)
{
    bake_blob blob = { 0 };
    ff_image read = { 0 };
    assert_int_equal(bake_texture_encode(&image, &info, QUALITY, key, 0, &blob), 0);
    assert_int_equal(blob.record_count, 1);
    if (blob.byte_count) {
        assert_int_equal(ff_image_read(blob.bytes, blob.byte_count, &read), FF_OK);
        assert_int_equal(sys_jpeg_decode(read.coded, read.coded_bytes, SIDE, SIDE, rgb), FF_OK);
        *bare = read.marks.bare;
    }
    int is_stored = blob.byte_count > 0;
    bake_blob_free(&blob);
    return is_stored;
}

static double mean_square(const uint8_t *a, const uint8_t *b, uint32_t column, uint32_t row)
{
    double sum = 0;
    for (uint32_t j = 0; j < 8; j++)
        for (uint32_t i = 0; i < 8 * RGB; i++) {
            size_t at = ((size_t)(row + j) * SIDE + column) * RGB + i;
            sum += (a[at] - b[at]) * (a[at] - b[at]);
        }
    return sum / (64 * RGB);
}

/* Does the image shown over a node, that of `above`, do as well as its own would? */
static int is_near(ff_key key, ff_key above, const uint8_t *shown)
{
    uint8_t lattice[SIDE * SIDE * RGB], own[SIDE * SIDE * RGB], enlarged[SIDE * SIDE * RGB],
        jpeg[4 * SIDE * SIDE + 8192];
    assert_int_equal(bake_texture_read(&image, &info, key, lattice), 0);
    int bytes = sys_jpeg_encode(lattice, SIDE, SIDE, QUALITY, jpeg, sizeof jpeg);
    assert_int_equal(sys_jpeg_decode(jpeg, (size_t)bytes, SIDE, SIDE, own), FF_OK);
    bake_enlarge(&info, shown, above, key, enlarged);
    for (uint32_t row = 0; row < SIDE; row += 8)
        for (uint32_t column = 0; column < SIDE; column += 8) {
            double off = mean_square(enlarged, lattice, column, row);
            if (off > 4 && off > mean_square(own, lattice, column, row) * 25 / 16) return 0;
        }
    return 1;
}

/* 1 when all from a node down are near. */
static int all_near(ff_key key, ff_key above, const uint8_t *shown)
{
    if (!ff_shape_has_ground(&info, key)) return 1;
    if (!is_near(key, above, shown)) return 0;
    for (uint32_t q = 0; q < 4 && ff_key_level(key) + 1 < LEVELS; q++)
        if (!all_near(ff_key_child(key, q), above, shown)) return 0;
    return 1;
}

/* Goes over all nodes: `above` is the nearest that has an image. How many have. */
static uint32_t check(ff_key key, ff_key above, const uint8_t *shown)
{
    uint8_t rgb[SIDE * SIDE * RGB], bare = 0, left_out = 0;
    int is_stored = stored(key, rgb, &bare);
    uint32_t count = (uint32_t)is_stored;
    if (!ff_shape_has_ground(&info, key)) {
        assert_false(is_stored);
        return 0;
    }
    if (above != FF_KEY_NONE) assert_int_equal(is_stored, !all_near(key, above, shown));
    for (uint32_t q = 0; q < 4 && ff_key_level(key) + 1 < LEVELS; q++) {
        ff_key child = ff_key_child(key, q);
        uint32_t below = check(child, is_stored ? key : above, is_stored ? rgb : shown);
        assert_true(is_stored || below == 0);
        if (!below && ff_shape_has_ground(&info, child)) left_out |= (uint8_t)(1u << q);
        count += below;
    }
    if (is_stored) assert_int_equal(bare, left_out);
    return count;
}

static uint32_t count_stored(colour_fn colour, uint32_t samples_x)
{
    make(colour, samples_x);
    uint32_t count = check(ff_key_make(0, 0, 0), FF_KEY_NONE, NULL);
    bake_image_close(&image);
    return count;
}

static void what_shows_no_more_is_left_out(void **state)
{
    (void)state;
    assert_int_equal(count_stored(sea, 129), 1);
    assert_int_equal(count_stored(sea, 70), 1);
    uint32_t all = 1 + 4 + 16 + 64, some = count_stored(coast, 129);
    assert_in_range(some, all / 4, all * 3 / 4);
    assert_in_range(count_stored(coast, 70), 1 + 2 + 8, all * 3 / 4);
}

static void a_boat_in_the_sea_is_seen(void **state)
{
    (void)state;
    assert_int_equal(count_stored(boat, 129), LEVELS);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(what_shows_no_more_is_left_out),
                                        cmocka_unit_test(a_boat_in_the_sea_is_seen) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
