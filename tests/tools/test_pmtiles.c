/* PMTiles: every tile is found where the format says, and whatever is spoilt ends in one line. */
#include "../../tools/bake/bake_say.h"
#include "../../tools/bake/raster/bake_grid.h"
#include "../../tools/bake/tiles/bake_pmtiles.h"

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

enum { ZOOM = 2, TILES = 1 + 4 + 16, IN_LEAF = 4, LEAVES = 6, TILE_BYTES = 8, HEADER = 127 };

static char path[100];
static int file_fd;
static uint8_t whole[2000];
static size_t whole_bytes;

/* ---- a file: directories unpacked, so that what is spoilt reaches the reader ---- */

static size_t put_number(uint8_t *out, uint64_t value)
{
    size_t count = 0;
    for (; value > 127; value >>= 7) out[count++] = (uint8_t)(value | 128);
    out[count++] = (uint8_t)value;
    return count;
}

/* Entries that begin every `step` tiles and lie behind one another. */
static size_t put_directory(uint8_t *out, int first, int count, int step, int run,
                            const size_t *bytes, size_t offset)
{
    size_t at = put_number(out, (uint64_t)count);
    for (int i = 0; i < count; i++) at += put_number(out + at, (uint64_t)(i ? step : first));
    for (int i = 0; i < count; i++) at += put_number(out + at, (uint64_t)run);
    for (int i = 0; i < count; i++) at += put_number(out + at, bytes[i]);
    for (int i = 0; i < count; i++) at += put_number(out + at, i ? 0 : offset + 1);
    return at;
}

static void put_section(int number, size_t offset, size_t bytes)
{
    for (int i = 0; i < 8; i++) {
        whole[8 + 16 * number + i] = (uint8_t)((uint64_t)offset >> 8 * i);
        whole[16 + 16 * number + i] = (uint8_t)((uint64_t)bytes >> 8 * i);
    }
}

static void draw_tile(uint64_t number, uint8_t *tile)
{
    memcpy(tile, "a tile..", TILE_BYTES);
    tile[6] = (uint8_t)number;
}

static void make_file(void)
{
    static const char metadata[] = "{\"encoding\": \"terrarium\"}";
    size_t leaf_bytes[LEAVES], tile_bytes[IN_LEAF], leaves_bytes = 0, at = HEADER;
    uint8_t leaves[LEAVES * 40];
    for (int i = 0; i < IN_LEAF; i++) tile_bytes[i] = TILE_BYTES;
    for (int l = 0; l < LEAVES; l++) {
        int first = l * IN_LEAF, count = TILES - first < IN_LEAF ? TILES - first : IN_LEAF;
        leaf_bytes[l] = put_directory(leaves + leaves_bytes, first, count, 1, 1, tile_bytes,
                                      (size_t)first * TILE_BYTES);
        leaves_bytes += leaf_bytes[l];
    }
    memcpy(whole, "PMTiles\3", 8);
    size_t root_bytes = put_directory(whole + at, 0, LEAVES, IN_LEAF, 0, leaf_bytes, 0);
    put_section(0, at, root_bytes);
    at += root_bytes;
    memcpy(whole + at, metadata, sizeof metadata - 1);
    put_section(1, at, sizeof metadata - 1);
    at += sizeof metadata - 1;
    memcpy(whole + at, leaves, leaves_bytes);
    put_section(2, at, leaves_bytes);
    at += leaves_bytes;
    put_section(3, at, TILES * TILE_BYTES);
    for (uint32_t t = 0; t < TILES; t++, at += TILE_BYTES) draw_tile(t, whole + at);
    whole[97] = whole[98] = 1; /* nothing is packed */
    whole[101] = ZOOM;
    whole_bytes = at;
    assert_true(whole_bytes + 1 < sizeof whole);
}

static void write_file(const uint8_t *bytes, size_t count)
{
    assert_int_equal(pwrite(file_fd, bytes, count, 0), count);
    assert_int_equal(ftruncate(file_fd, (off_t)count), 0);
}

/* ---- reading it ---- */

/* Reads all that there is. The number of tiles, or -1 (said in one line). */
static int read_all(int is_whole)
{
    bake_pmtiles file;
    int found = 0, tiles = 0;
    if (bake_pmtiles_open(path, &file)) return -1;
    char *metadata = bake_pmtiles_metadata(&file);
    for (uint32_t zoom = 0; metadata && found >= 0 && zoom <= ZOOM; zoom++)
        for (uint32_t place = 0; found >= 0 && place < 1u << 2 * zoom; place++) {
            uint32_t x = place >> zoom, y = place & ((1u << zoom) - 1);
            uint8_t *bytes;
            size_t count;
            uint8_t wanted[TILE_BYTES];
            found = bake_pmtiles_get(&file, zoom, x, y, &bytes, &count);
            if (found <= 0) continue;
            draw_tile(bake_pmtiles_number(zoom, x, y), wanted);
            if (is_whole) assert_true(count == TILE_BYTES && !memcmp(bytes, wanted, count));
            free(bytes);
            tiles++;
        }
    if (!metadata) found = -1;
    free(metadata);
    bake_pmtiles_close(&file);
    return found < 0 ? -1 : tiles;
}

/* What was said, in lines. */
static int lines_of(int fd)
{
    char text[4096];
    int lines = 0;
    lseek(fd, 0, SEEK_SET);
    for (ssize_t count; (count = read(fd, text, sizeof text)) > 0;)
        for (ssize_t i = 0; i < count; i++) lines += text[i] == '\n';
    return lines;
}

/* ---- the tests ---- */

static void every_tile_is_where_the_format_says(void **state)
{
    (void)state;
    write_file(whole, whole_bytes);
    assert_int_equal(read_all(1), TILES);
}

static uint32_t seed = 1;
static uint32_t below(uint32_t end)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)seed * end >> 32);
}

/* Bytes of any value, and in the header numbers at an edge. */
static size_t spoil(uint8_t *bytes)
{
    memcpy(bytes, whole, whole_bytes);
    for (uint32_t n = below(3); n > 0; n--)
        bytes[8 + below((uint32_t)whole_bytes - 8)] = (uint8_t)below(256);
    if (!below(3)) bytes[HEADER + below(120)] = (uint8_t)below(256);
    uint64_t edges[] = {
        0, 1, whole_bytes, whole_bytes - 1, UINT32_MAX, UINT64_MAX, UINT64_MAX >> 1
    };
    uint64_t edge = edges[below(7)];
    uint32_t field = 8 + 8 * below(8);
    for (uint32_t i = 0, hit = !below(3); hit && i < 8; i++)
        bytes[field + i] = (uint8_t)(edge >> 8 * i);
    return below(8) ? whole_bytes : below((uint32_t)whole_bytes);
}

static void what_is_spoilt_ends_in_one_line_or_in_tiles(void **state)
{
    static uint8_t bytes[sizeof whole];
    int refused = 0, read = 0, said = bake_temp_open(), was = dup(2);
    (void)state;
    assert_true(said >= 0 && was >= 0);
    dup2(said, 2);
    for (int trial = 0; trial < 20000; trial++) {
        size_t count = spoil(bytes);
        write_file(bytes, count);
        if (read_all(0) < 0)
            refused++;
        else
            read++;
    }
    dup2(was, 2);
    close(was);
    int lines = lines_of(said);
    close(said);
    assert_int_equal(lines, refused);
    assert_true(refused > 2000 && read > 2000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_tile_is_where_the_format_says),
        cmocka_unit_test(what_is_spoilt_ends_in_one_line_or_in_tiles),
    };
    bake_say_setup("test_pmtiles", 1);
    bake_temp_setup("build/x");
    file_fd = bake_temp_open();
    if (file_fd < 0) return 1;
    snprintf(path, sizeof path, "/proc/self/fd/%d", file_fd);
    make_file();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
