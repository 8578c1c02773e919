/* What farfield-export is made of: encodings of heights, and PMTiles read again by the baker. */
#include "../../tools/bake/bake_say.h"
#include "../../tools/bake/raster/bake_grid.h"
#include "../../tools/bake/tiles/bake_pmtiles.h"
#include "../../tools/export/export_encoding.h"
#include "../../tools/export/export_store.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* after the four above: */
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- encodings ---- */

static void known_heights_have_known_colours(void **state)
{
    static const struct {
        const export_encoding *encoding;
        double metres;
        uint8_t rgb[3];
    } row[] = {
        { &export_encoding_terrarium, 0, { 128, 0, 0 } },
        { &export_encoding_terrarium, -32768, { 0, 0, 0 } },
        { &export_encoding_terrarium, 8848.5, { 162, 144, 128 } },
        { &export_encoding_terrarium, -0.25, { 127, 255, 192 } },
        { &export_encoding_mapbox, -10000, { 0, 0, 0 } },
        { &export_encoding_mapbox, 0, { 1, 134, 160 } },
        { &export_encoding_mapbox, 8848.4, { 2, 224, 68 } },
    };
    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        uint8_t rgb[3];
        export_encode(row[i].encoding, row[i].metres, rgb);
        assert_memory_equal(rgb, row[i].rgb, 3);
        assert_true(fabs(export_decode(row[i].encoding, rgb) - row[i].metres) < 1e-9);
    }
}

static void heights_come_back_within_half_a_step(void **state)
{
    const export_encoding *both[] = { &export_encoding_terrarium, &export_encoding_mapbox };
    (void)state;
    for (int e = 0; e < 2; e++)
        for (double metres = -9999; metres < 9000; metres += 0.7309) {
            uint8_t rgb[3];
            export_encode(both[e], metres, rgb);
            assert_true(fabs(export_decode(both[e], rgb) - metres) <= both[e]->step_m / 2 + 1e-9);
        }
}

static void heights_out_of_range_are_kept_to_it_and_told(void **state)
{
    uint8_t rgb[3];
    (void)state;
    export_encode(&export_encoding_mapbox, -20000, rgb);
    assert_memory_equal(rgb, ((uint8_t[]){ 0, 0, 0 }), 3);
    export_encode(&export_encoding_terrarium, 1e6, rgb);
    assert_memory_equal(rgb, ((uint8_t[]){ 255, 255, 255 }), 3);
    assert_true(export_encoding_holds(&export_encoding_mapbox, -9999, 9000));
    assert_false(export_encoding_holds(&export_encoding_mapbox, -10001, 9000));
    assert_true(export_encoding_holds(&export_encoding_terrarium, -30000, 32767));
    assert_false(export_encoding_holds(&export_encoding_terrarium, 0, 32769));
}

/* ---- PMTiles ---- */

enum { ZOOM = 8, SIDE = 1 << ZOOM, ALIKE_ROWS = 80 };

static char path[100];

/* Tiles of the first rows are alike, as sea is; others tell where they are. */
static size_t draw(uint32_t zoom, uint32_t x, uint32_t y, char bytes[64])
{
    if (y < ALIKE_ROWS) return (size_t)snprintf(bytes, 64, "the sea");
    return (size_t)snprintf(bytes, 64, "%u/%u/%u%.*s", zoom, x, y, (int)((x * x * 7 + y * x) % 23),
                            ".......................");
}

static void write_all(void)
{
    export_tiles_about about = { .about = { .name = "a \"name\"" },
                                 .format = "png",
                                 .encoding = "terrarium",
                                 .side = 256,
                                 .zoom_max = ZOOM,
                                 .bounds = { -180, -85, 180, 85 } };
    export_store *store = export_store_open(path, &about);
    assert_non_null(store);
    for (uint32_t x = SIDE; x-- > 0;)
        for (uint32_t y = 0; y < SIDE; y++) {
            char bytes[64];
            size_t count = draw(ZOOM, x, y, bytes);
            assert_int_equal(export_store_put(store, ZOOM, x, y, (uint8_t *)bytes, count), 0);
        }
    assert_int_equal(export_store_put(store, 0, 0, 0, (const uint8_t *)"the world", 9), 0);
    assert_int_equal(export_store_close(store, 0), 0);
}

static void expect(bake_pmtiles *file, uint32_t zoom, uint32_t x, uint32_t y, const char *wanted,
                   size_t wanted_count)
{
    uint8_t *bytes = NULL;
    size_t count;
    assert_int_equal(bake_pmtiles_get(file, zoom, x, y, &bytes, &count), 1);
    assert_int_equal(count, wanted_count);
    assert_memory_equal(bytes, wanted, count);
    free(bytes);
}

static void every_tile_of_pmtiles_is_found_again_through_leaves(void **state)
{
    bake_pmtiles file;
    (void)state;
    write_all();
    assert_int_equal(bake_pmtiles_open(path, &file), 0);
    assert_true(file.head.leaves.bytes > 0);
    assert_true(file.head.root.offset + file.head.root.bytes <= BAKE_PM_FIRST_BYTES);
    assert_int_equal(file.head.clustered, 1);
    assert_int_equal(file.head.addressed, SIDE * SIDE + 1);
    assert_true(file.head.entries < SIDE * SIDE);
    assert_true(file.head.contents <= file.head.entries);
    expect(&file, 0, 0, 0, "the world", 9);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            char bytes[64];
            size_t count = draw(ZOOM, x, y, bytes);
            expect(&file, ZOOM, x, y, bytes, count);
        }
    char *metadata = bake_pmtiles_metadata(&file);
    assert_non_null(strstr(metadata, "\"name\": \"a \\\"name\\\"\""));
    assert_non_null(strstr(metadata, "\"encoding\": \"terrarium\""));
    free(metadata);
    bake_pmtiles_close(&file);
}

/* "Clustered": what a leaf names lies behind what is named before it, or is there already. */
static void tiles_lie_in_the_order_of_their_numbers(void **state)
{
    bake_pmtiles file;
    uint64_t end = 0;
    uint8_t *bytes = NULL;
    size_t count;
    (void)state;
    assert_int_equal(bake_pmtiles_open(path, &file), 0);
    assert_int_equal(bake_pmtiles_get(&file, 0, 0, 0, &bytes, &count), 1);
    free(bytes);
    assert_true(file.leaf.count > 1000);
    for (size_t e = 0; e < file.leaf.count; e++) {
        const bake_pm_entry *entry = &file.leaf.entry[e];
        assert_true(entry->offset <= end);
        if (entry->offset + entry->bytes > end) end = entry->offset + entry->bytes;
    }
    bake_pmtiles_close(&file);
}

static int set_up(void **state)
{
    (void)state;
    bake_say_setup("test_export", 1);
    snprintf(path, sizeof path, "build/tests/test_export-%ld.pmtiles", (long)getpid());
    bake_temp_setup(path);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    return unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_heights_have_known_colours),
        cmocka_unit_test(heights_come_back_within_half_a_step),
        cmocka_unit_test(heights_out_of_range_are_kept_to_it_and_told),
        cmocka_unit_test(every_tile_of_pmtiles_is_found_again_through_leaves),
        cmocka_unit_test(tiles_lie_in_the_order_of_their_numbers),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
