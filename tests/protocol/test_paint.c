/* Paint there and back, the slow decoder beside ours, and what takes little. */
#include "../../protocol/picture/ff_paint.h"
#include "../rig/slow_picture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#ifndef TEST_STRIDE
#define TEST_STRIDE 1
#endif
#define COLUMNS 32
#define ROWS    32
#define TEXELS  (COLUMNS * ROWS * 64)

typedef struct canvas {
    unsigned columns;
    uint8_t there[COLUMNS * ROWS], rgb[TEXELS * 3];
} canvas;

static uint8_t rgb[TEXELS * 3], there[COLUMNS * ROWS], bytes[TEXELS * 4];
static canvas encoded, decoded;
static uint64_t room[4096];
#define ROOM ((ff_paint_room *)(void *)room)

static uint32_t random_state;

static uint32_t chance(uint32_t below)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)random_state * below >> 32);
}

static void lay(void *context, unsigned column, unsigned row, uint8_t texel[64][3])
{
    canvas *on = context;
    on->there[row * on->columns + column]++;
    for (unsigned i = 0; i < 64; i++)
        memcpy(on->rgb + (((row * 8 + i / 8) * on->columns + column) * 8 + i % 8) * 3, texel[i], 3);
}

static ff_paint_sink sink_of(canvas *on, unsigned columns)
{
    memset(on, 0, sizeof *on);
    on->columns = columns;
    return (ff_paint_sink){ on, lay };
}

/* Hills before haze, of which some blocks are there. `noise`: how rough. */
static ff_paint_source scene(unsigned columns, unsigned rows, unsigned noise)
{
    unsigned width = columns * 8;
    for (unsigned i = 0; i < width * rows * 8; i++) {
        unsigned x = i % width, y = i / width, light = 200 - y + x / 4;
        for (unsigned c = 0; c < 3; c++) {
            unsigned value = light + 10 * c + (noise ? chance(noise) : 0);
            rgb[3 * i + c] = (uint8_t)(value > 255 ? 255 : value);
        }
    }
    for (unsigned i = 0; i < columns * rows; i++) there[i] = chance(5) > 0;
    there[chance(columns * rows)] = 1;
    return (ff_paint_source){ columns, rows, there, rgb };
}

static int encode(const ff_paint_source *source, unsigned quality)
{
    const ff_paint_sink sink = sink_of(&encoded, source->columns);
    return ff_paint_encode(source, quality, ROOM, &sink, bytes, sizeof bytes);
}

/* How many blocks; both decoders say so, and make the same of them. */
static int decode(const uint8_t *from, size_t count, unsigned columns, unsigned rows)
{
    static uint8_t slow[TEXELS * 3], slow_there[COLUMNS * ROWS];
    const ff_paint_sink sink = sink_of(&decoded, columns);
    uint8_t *exact = malloc(count + 1);
    memcpy(exact, from, count);
    exact = realloc(exact, count ? count : 1);
    int found = ff_paint_decode(exact, count, columns, rows, ROOM, &sink),
        told = slow_paint(exact, (long)count, (int)columns, (int)rows, slow_there, slow);
    free(exact);
    assert_true(found < 0 ? told < 0 : told == found);
    if (found < 0) return found;
    assert_memory_equal(decoded.there, slow_there, columns * rows);
    assert_memory_equal(decoded.rgb, slow, columns * rows * 192);
    return found;
}

static void both_decoders_make_what_the_encoder_made(void **state)
{
    (void)state;
    random_state = 1;
    for (unsigned run = 0; run < 200; run += TEST_STRIDE) {
        unsigned columns = 1 + chance(run % 8 ? 9 : COLUMNS), rows = 1 + chance(run % 8 ? 9 : ROWS);
        ff_paint_source source = scene(columns, rows, chance(3) * chance(90));
        int count = encode(&source, 1 + chance(100)), blocks = 0;
        assert_true(count > 0);
        for (unsigned i = 0; i < columns * rows; i++) blocks += there[i];
        assert_int_equal(decode(bytes, (size_t)count, columns, rows), blocks);
        assert_memory_equal(encoded.there, there, columns * rows);
        assert_memory_equal(&encoded, &decoded, sizeof encoded);
    }
}

/* By how much is what is there off, in all? */
static int off_by(const ff_paint_source *source)
{
    int all = 0;
    for (unsigned i = 0; i < source->columns * source->rows * 192; i++) {
        unsigned x = i / 3 % (source->columns * 8), y = i / 3 / (source->columns * 8);
        int off = abs(rgb[i] - encoded.rgb[i]);
        if (there[y / 8 * source->columns + x / 8]) all += off;
    }
    return all;
}

static void the_better_the_quality_the_nearer(void **state)
{
    int before = INT32_MAX, bytes_before = 0;
    (void)state;
    for (unsigned quality = 20; quality <= 100; quality += 20) {
        random_state = 5;
        ff_paint_source source = scene(8, 8, 40);
        int count = encode(&source, quality), off = off_by(&source);
        assert_true(off < before && count > bytes_before);
        before = off;
        bytes_before = count;
    }
    assert_true(before < 8 * 8 * 192 * 3 / 4); /* under 0.75 a channel, at 100 */
}

static void haze_takes_next_to_nothing(void **state)
{
    (void)state;
    random_state = 7;
    ff_paint_source source = scene(8, 8, 0);
    memset(there, 1, sizeof there);
    assert_true(encode(&source, 80) < 60);
    assert_true(off_by(&source) < 64 * 64 * 3 * 4);
}

static void blocks_that_are_not_there_take_a_fraction_of_a_bit(void **state)
{
    (void)state;
    random_state = 8;
    ff_paint_source source = scene(32, 32, 0);
    memset(there, 0, sizeof there);
    there[500] = 1;
    assert_in_range(encode(&source, 80), 3, 40);
}

static void a_stream_says_nothing_twice(void **state)
{
    (void)state;
    random_state = 9;
    ff_paint_source source = scene(6, 5, 30);
    int count = encode(&source, 70);
    const ff_paint_sink sink = sink_of(&encoded, 6);
    assert_true(decode(bytes, (size_t)count, 6, 5) > 0);
    bytes[count] = 0;
    assert_int_equal(decode(bytes, (size_t)count + 1, 6, 5), FF_ERR_FORMAT);
    bytes[count] = 1;
    assert_int_equal(decode(bytes, (size_t)count + 8, 6, 5), FF_ERR_FORMAT);
    assert_int_equal(decode(bytes, 0, 6, 5), FF_ERR_TRUNCATED);
    bytes[0] = 0;
    assert_int_equal(decode(bytes, (size_t)count, 6, 5), FF_ERR_FORMAT);
    bytes[0] = 101;
    assert_int_equal(decode(bytes, (size_t)count, 6, 5), FF_ERR_FORMAT);
    assert_int_equal(ff_paint_encode(&source, 70, ROOM, &sink, bytes, (size_t)count - 1),
                     FF_ERR_FULL);
    assert_int_equal(ff_paint_encode(&source, 70, ROOM, &sink, bytes, 0), FF_ERR_FULL);
    assert_int_equal(ff_paint_encode(&source, 0, ROOM, &sink, bytes, 99), FF_ERR_ARGUMENT);
    memset(there, 0, sizeof there); /* no block at all is refused */
    count = encode(&source, 70);
    assert_int_equal(decode(bytes, (size_t)count, 6, 5), FF_ERR_FORMAT);
}

static void damaged_paint_is_refused_or_read_alike(void **state)
{
    (void)state;
    random_state = 10;
    ff_paint_source source = scene(5, 4, 25);
    size_t count = (size_t)encode(&source, 75);
    for (size_t bit = 0; bit < 8 * count; bit += TEST_STRIDE) {
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        decode(bytes, count, 5, 4);
        bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    for (size_t cut = 1; cut < count; cut++) decode(bytes, cut, 5, 4);
    for (unsigned run = 0; run < 3000; run += TEST_STRIDE) {
        count = 1 + chance(60);
        bytes[0] = (uint8_t)chance(101);
        for (size_t i = 1; i < count; i++) bytes[i] = (uint8_t)chance(256);
        decode(bytes, count, 1 + chance(6), 1 + chance(6));
    }
}

static uint32_t hash(const uint8_t *from, size_t count)
{
    uint32_t sum = 2166136261u; /* FNV-1a */
    for (size_t i = 0; i < count; i++) sum = (sum ^ from[i]) * 16777619u;
    return sum;
}

/* Bytes and texels as they have been since protocol 10: whoever changes them changes the format. */
static void paint_stays_as_it_is(void **state)
{
    (void)state;
    random_state = 11;
    ff_paint_source source = scene(6, 5, 30);
    int count = encode(&source, 80);
    assert_int_equal(hash(bytes, (size_t)count), 0xa8ec6d23u);
    assert_int_equal(hash(encoded.rgb, 6 * 5 * 192), 0x753d2d02u);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_decoders_make_what_the_encoder_made),
        cmocka_unit_test(the_better_the_quality_the_nearer),
        cmocka_unit_test(haze_takes_next_to_nothing),
        cmocka_unit_test(blocks_that_are_not_there_take_a_fraction_of_a_bit),
        cmocka_unit_test(a_stream_says_nothing_twice),
        cmocka_unit_test(damaged_paint_is_refused_or_read_alike),
        cmocka_unit_test(paint_stays_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
