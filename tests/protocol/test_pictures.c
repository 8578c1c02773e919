/* Pictures beside the slow decoder: there and back, neighbours whose rims agree, any bytes, rows of
 * pictures, and bytes that must stay as they are. */
#include "../../protocol/picture/ff_picture.h"
#include "../rig/slow_picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <zlib.h>

#define SIDE_MAX 256
#define TEXELS   (SIDE_MAX * SIDE_MAX)
#define LIMIT    (TEXELS * 16)

static ff_picture_room room;
static uint32_t random_state = 1;

static uint32_t random_below(uint32_t limit)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)random_state * limit >> 32);
}

/* ---- images ---- */

enum { FLAT, SLOPE, CHECKER, NOISE, FIELDS, KINDS };

/* A channel of one wide image, at a place far from its rims. */
static uint8_t channel_at(int kind, uint32_t x, uint32_t y, uint32_t c)
{
    uint32_t hash = (x * 73856093u ^ y * 19349663u ^ (c + 1) * 83492791u) * 2654435761u;
    switch (kind) {
        case FLAT: return (uint8_t)(40 + 70 * c);
        case SLOPE: return (uint8_t)((x + 2 * y + 31 * c) / 4);
        case CHECKER: return (x / 3 + y / 2) % 2 ? 255 : (uint8_t)(10 * c);
        case NOISE: return (uint8_t)(hash >> 24);
        default: return (uint8_t)(60 + 20 * c + (x / 17 * 5 + y / 11 * 3) % 7 * 16 + (hash >> 29));
    }
}

/* North row first, as encoders take it. */
static void make_image(int kind, unsigned log2, uint32_t west, uint32_t south, uint8_t *rgb)
{
    uint32_t side = 1u << log2;
    for (uint32_t y = side; y-- > 0;)
        for (uint32_t x = 0; x < side; x++)
            for (uint32_t c = 0; c < 3; c++) *rgb++ = channel_at(kind, west + x, south + y, c);
}

static uint8_t parent[TEXELS * 3], source[TEXELS * 3], encoded[TEXELS * 3], decoded[TEXELS * 3],
    slow[TEXELS * 3], bytes[LIMIT];

static void make_parent(int kind, unsigned log2)
{
    uint32_t side = 1u << log2;
    uint8_t *rgb = parent;
    for (uint32_t y = side; y-- > 0;)
        for (uint32_t x = 0; x < side; x++)
            for (uint32_t c = 0; c < 3; c++) *rgb++ = channel_at(kind, 2 * x, 2 * y, c);
}

/* Whatever the bytes are, both decoders say the same. 1: they are a picture. */
static int read_alike(size_t count, unsigned log2, ff_picture_above above)
{
    size_t side = (size_t)1 << log2;
    int rc = ff_picture_decode(bytes, count, log2, above, &room, decoded);
    int slow_rc = slow_picture(bytes, (long)count, (int)side, above.rgb, (int)above.quadrant, slow);
    assert_int_equal(rc == FF_OK, slow_rc == 0);
    if (rc != FF_OK) return 0;
    assert_memory_equal(decoded, slow, side * side * 3);
    return 1;
}

static void every_image_comes_back(void **state)
{
    static const unsigned quality[] = { 1, 30, 50, 75, 95, 100 };
    (void)state;
    for (unsigned log2 = 4; log2 <= 7; log2++)
        for (unsigned i = 0; i < 6 * KINDS * 5; i++) {
            int kind = (int)(i / 6 % KINDS), place = (int)(i / 6 / KINDS);
            uint32_t cells = (1u << log2) - 1, q = (uint32_t)place & 3u;
            ff_picture_above above = { place < 4 ? parent : NULL, q };
            make_parent(kind, log2);
            make_image(kind, log2, (q & 1) * cells, (q >> 1) * cells, source);
            int count = ff_picture_encode(source, log2, above, quality[i % 6], &room, encoded,
                                          bytes, sizeof bytes);
            assert_true(count > 0);
            assert_true(read_alike((size_t)count, log2, above));
            assert_memory_equal(decoded, encoded, (size_t)3 << 2 * log2);
            if (quality[i % 6] < 100) continue;
            for (uint32_t t = 0; t < 3u << 2 * log2; t++)
                assert_in_range(decoded[t] + 4 - source[t], 0, 8);
        }
}

/* The same rim, of two parents whose other texels differ: it is decoded alike. */
static void rims_of_neighbours_are_the_same(void **state)
{
    const unsigned log2 = 6, side = 64;
    static uint8_t west[64 * 64 * 3], east[64 * 64 * 3], of_west[64 * 64 * 3], of_east[64 * 64 * 3];
    (void)state;
    for (int kind = 0; kind < KINDS; kind++)
        for (uint32_t south = 0; south < 2; south++) {
            uint32_t x = 63 * 7, y = 63 * south;
            make_parent(kind, log2);
            for (unsigned i = 0; i < side * side * 3; i++) {
                west[i] = (uint8_t)random_below(256);
                east[i] = (uint8_t)random_below(256);
            }
            for (unsigned j = 0; j < side; j++) {
                memcpy(west + (j * side + side - 1) * 3, parent + j * side * 3, 3);
                memcpy(east + j * side * 3, parent + j * side * 3, 3);
            }
            make_image(kind, log2, x - 63, y, source);
            ff_picture_above above = { west, 1 + 2 * south };
            assert_true(ff_picture_encode(source, log2, above, 40, &room, of_west, bytes,
                                          sizeof bytes) > 0);
            make_image(kind, log2, x, y, source);
            above = (ff_picture_above){ east, 2 * south };
            assert_true(ff_picture_encode(source, log2, above, 40, &room, of_east, bytes,
                                          sizeof bytes) > 0);
            for (unsigned j = 0; j < side; j++)
                assert_memory_equal(of_west + (j * side + side - 1) * 3, of_east + j * side * 3, 3);
        }
}

static void what_the_parent_tells_costs_little(void **state)
{
    (void)state;
    make_parent(SLOPE, 6);
    make_image(SLOPE, 6, 0, 63, source);
    ff_picture_above above = { parent, 2 };
    int below = ff_picture_encode(source, 6, above, 75, &room, encoded, bytes, sizeof bytes);
    assert_in_range(below, 1, 40);
}

/* On even ground a line beside blocks would be seen. */
static void even_colours_have_no_lines(void **state)
{
    (void)state;
    for (int root = 0; root < 2; root++) {
        ff_picture_above above = { root ? NULL : parent, 0 };
        for (unsigned i = 0; i < 3u << 2 * 6; i++) {
            source[i] = (uint8_t)(37 + 55 * (i % 3));
            parent[i] = (uint8_t)(source[i] + 9);
        }
        for (unsigned quality = 50; quality < 100; quality += 7) {
            assert_true(ff_picture_encode(source, 6, above, quality, &room, encoded, bytes,
                                          sizeof bytes) > 0);
            int limit = 3 + (int)(100 - quality) / 5;
            for (unsigned i = 0; i < 3u << 2 * 6; i++)
                assert_in_range(encoded[i] + limit - source[i], 0, 2 * limit);
        }
    }
}

static void any_bytes_are_read_alike(void **state)
{
    unsigned good = 0;
    (void)state;
    make_parent(FIELDS, 5);
    for (unsigned i = 0; i < 3000; i++) {
        ff_picture_above above = { i % 3 ? parent : NULL, i % 3 ? i % 4 : 0 };
        unsigned log2 = i % 2 ? 4 : 5;
        size_t count = random_below(60);
        for (size_t b = 0; b < count; b++) bytes[b] = (uint8_t)random_below(256);
        if (i % 5) bytes[0] = (uint8_t)(1 + random_below(100));
        good += (unsigned)read_alike(count, log2, above);
    }
    assert_true(good > 300);
}

static void damage_is_read_alike(void **state)
{
    (void)state;
    make_parent(FIELDS, 4);
    make_image(NOISE, 4, 0, 0, source);
    ff_picture_above above = { parent, 0 };
    int count = ff_picture_encode(source, 4, above, 90, &room, encoded, bytes, sizeof bytes);
    assert_true(count > 100);
    for (int i = 0; i < 8 * count; i++) {
        bytes[i / 8] ^= (uint8_t)(1 << i % 8);
        read_alike((size_t)count, 4, above);
        bytes[i / 8] ^= (uint8_t)(1 << i % 8);
    }
    for (int cut = 0; cut < count; cut++) read_alike((size_t)cut, 4, above);
}

static void streams_are_held_to_their_end(void **state)
{
    ff_picture_above above = { parent, 3 };
    (void)state;
    make_parent(SLOPE, 4);
    make_image(FIELDS, 4, 15, 15, source);
    size_t count = (size_t)ff_picture_encode(source, 4, above, 60, &room, encoded, bytes,
                                             sizeof bytes);
    assert_int_not_equal(bytes[count - 1], 0);
    assert_true(read_alike(count, 4, above));
    bytes[count] = 0;
    assert_int_equal(ff_picture_decode(bytes, count + 1, 4, above, &room, decoded), FF_ERR_FORMAT);
    memset(bytes + count, 1, 8);
    assert_int_equal(ff_picture_decode(bytes, count + 8, 4, above, &room, decoded), FF_ERR_FORMAT);
    assert_int_equal(ff_picture_decode(bytes, 0, 4, above, &room, decoded), FF_ERR_TRUNCATED);
    bytes[0] = 0;
    assert_int_equal(ff_picture_decode(bytes, count, 4, above, &room, decoded), FF_ERR_FORMAT);
    bytes[0] = 101;
    assert_int_equal(ff_picture_decode(bytes, count, 4, above, &room, decoded), FF_ERR_FORMAT);
    assert_int_equal(ff_picture_encode(source, 4, above, 60, &room, encoded, bytes, count - 1),
                     FF_ERR_FULL);
    assert_int_equal(ff_picture_encode(source, 4, above, 101, &room, encoded, bytes, 99),
                     FF_ERR_ARGUMENT);
}

/* An entered root: as if each were decoded after the other. */
static void a_row_of_pictures_is_one_after_the_other(void **state)
{
    static uint8_t level[4][16 * 16 * 3], spare[16 * 16 * 3];
    const uint32_t code = 2 << 4 | 1 << 2 | 3;
    (void)state;
    for (unsigned levels = 0; levels < 4; levels++) {
        static uint8_t row[4000];
        size_t at = 0, last = 0;
        for (unsigned l = 0; l <= levels; l++) {
            ff_picture_above above = { l ? level[l - 1] : NULL,
                                       l ? code >> 2 * (levels - l) & 3u : 0 };
            make_image(FIELDS, 4, 100 * l, 7, source);
            int count = ff_picture_encode(source, 4, above, 70, &room, level[l], bytes, 900);
            assert_true(count > 0);
            if (l < levels) row[at++] = (uint8_t)(count >> 8);
            if (l < levels) row[at++] = (uint8_t)count;
            last = at;
            memcpy(row + at, bytes, (size_t)count);
            at += (size_t)count;
        }
        assert_int_equal(ff_picture_decode_row(row, at, 4, levels, code, &room, decoded, spare),
                         FF_OK);
        assert_memory_equal(decoded, level[levels], sizeof level[0]);
        for (size_t cut = 0; cut <= last; cut++)
            assert_int_not_equal(
                ff_picture_decode_row(row, cut, 4, levels, code, &room, decoded, spare), FF_OK);
    }
}

/* Images without chance: bytes and colours are part of the format. Their CRC-32, by log2. */
static void pictures_stay_as_they_are(void **state)
{
    static const uint32_t golden[5][2] = { { 0xb24a5923, 0x4bc9a868 },
                                           { 0x405da2bd, 0xd63adee1 },
                                           { 0xc2af548b, 0x7099093c },
                                           { 0x42849f69, 0xf63ad348 },
                                           { 0x8b85e955, 0xec34b5f6 } };
    int differ = 0;
    (void)state;
    for (unsigned log2 = 4; log2 <= 8; log2++) {
        uLong of_bytes = 0, of_colours = 0;
        for (unsigned i = 0; i < KINDS * 10; i++) {
            unsigned kind = i % KINDS, place = i / KINDS, q = place & 3u;
            uint32_t cells = (1u << log2) - 1;
            ff_picture_above above = { place < 8 ? parent : NULL, place < 8 ? q : 0 };
            make_parent((int)kind, log2);
            make_image((int)kind, log2, (q & 1) * cells, (q >> 1) * cells, source);
            int count = ff_picture_encode(source, log2, above, place & 1 ? 40 : 80, &room, encoded,
                                          bytes, sizeof bytes);
            of_bytes = crc32(of_bytes, bytes, (uInt)count);
            of_colours = crc32(of_colours, encoded, (uInt)3 << 2 * log2);
        }
        if (golden[log2 - 4][0] == of_bytes && golden[log2 - 4][1] == of_colours) continue;
        print_message("# log2 %u: { 0x%08lx, 0x%08lx }\n", log2, of_bytes, of_colours);
        differ++;
    }
    assert_int_equal(differ, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_image_comes_back),
        cmocka_unit_test(rims_of_neighbours_are_the_same),
        cmocka_unit_test(what_the_parent_tells_costs_little),
        cmocka_unit_test(even_colours_have_no_lines),
        cmocka_unit_test(any_bytes_are_read_alike),
        cmocka_unit_test(damage_is_read_alike),
        cmocka_unit_test(streams_are_held_to_their_end),
        cmocka_unit_test(a_row_of_pictures_is_one_after_the_other),
        cmocka_unit_test(pictures_stay_as_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
