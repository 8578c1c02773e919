/* The Common System API on this machine: clock, events, chance, threads, files and pictures.
 * Sockets: test_tcp.c; surfaces: test_surface.c. */
#include "../../platform/sim/sys_sim.h"
#include "../../platform/sys.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <jpeglib.h>
#include <sys/stat.h>

#define SCRATCH "build/tests/sys-scratch"

/* ---- clock and events ---- */

static void clock_can_be_replaced(void **state)
{
    (void)state;
    int64_t real_us = sys_time_us();
    sys_sim_clock clock = { 123 };
    sys_sim_clock_use(&clock);
    assert_int_equal(sys_time_us(), 123);
    sys_sleep_us(INT64_C(1) << 60); /* would never end on a real clock */
    assert_int_equal(sys_time_us(), 123);
    sys_sim_clock_advance(&clock, 1000);
    assert_int_equal(sys_time_us(), 1123);
    sys_sim_clock_use(NULL);
    assert_true(sys_time_us() >= real_us);
}

static void real_clock_sleeps_at_least_as_long(void **state)
{
    (void)state;
    int64_t before_us = sys_time_us();
    sys_sleep_us(2000);
    assert_true(sys_time_us() - before_us >= 2000);
    sys_sleep_us(-5);
}

static void events_come_out_in_order(void **state)
{
    (void)state;
    sys_event event = { .type = SYS_EVENT_POSITION }, taken;
    uint32_t injected = 0;
    while (sys_event_inject(&event) == FF_OK) event.u.position.x_wu = (int32_t)++injected;
    assert_int_equal(sys_event_inject(&event), FF_ERR_FULL);
    assert_true(injected >= 16);
    for (uint32_t i = 0; i < injected; i++) {
        assert_int_equal(sys_event_take(&taken), 1);
        assert_int_equal(taken.u.position.x_wu, i);
    }
    assert_int_equal(sys_event_take(&taken), 0);
}

static void scripts_inject_what_is_due(void **state)
{
    (void)state;
    const sys_event events[] = {
        { .type = SYS_EVENT_BATTERY, .time_us = 10, .u.battery = { 5, 1 } },
        { .type = SYS_EVENT_INTERRUPTION, .time_us = 20, .u.interruption = { 1 } },
        { .type = SYS_EVENT_INTERRUPTION, .time_us = 20, .u.interruption = { 0 } }
    };
    sys_sim_script script = { events, 3, 0 };
    sys_event taken;
    assert_int_equal(sys_sim_script_run(&script, 9), 0);
    assert_int_equal(sys_sim_script_run(&script, 10), 1);
    assert_int_equal(sys_sim_script_run(&script, 19), 0);
    assert_int_equal(sys_sim_script_run(&script, 1000), 2);
    assert_int_equal(sys_sim_script_run(&script, 1001), 0);
    assert_int_equal(sys_event_take(&taken), 1);
    assert_int_equal(taken.type, SYS_EVENT_BATTERY);
    assert_int_equal(taken.u.battery.percent, 5);
    assert_int_equal(sys_event_take(&taken), 1);
    assert_int_equal(taken.u.interruption.begins, 1);
    assert_int_equal(sys_event_take(&taken), 1);
    assert_int_equal(taken.u.interruption.begins, 0);
    assert_int_equal(sys_event_take(&taken), 0);
}

static void random_numbers_are_those_of_pcg32(void **state)
{
    (void)state;
    /* The demonstration output of the reference implementation: seed 42, stream 54. */
    static const uint32_t expected[] = { 0xa15c02b7, 0x7b47f409, 0xba1d3330,
                                         0x83d2f293, 0xbfa4784b, 0xcbed606e };
    sys_random random;
    sys_random_seed(&random, 42, 54);
    for (size_t i = 0; i < 6; i++) assert_int_equal(sys_random_u32(&random), expected[i]);
    uint32_t seen[7] = { 0 };
    for (int i = 0; i < 70000; i++) {
        uint32_t value = sys_random_below(&random, 7);
        assert_true(value < 7);
        seen[value]++;
    }
    for (int i = 0; i < 7; i++) assert_in_range(seen[i], 9500, 10500);
}

/* ---- threads ---- */

struct counter {
    sys_mutex mutex;
    int value;
};

static void count_up(void *arg)
{
    struct counter *counter = arg;
    for (int i = 0; i < 20000; i++) {
        sys_mutex_lock(&counter->mutex);
        counter->value++;
        sys_mutex_unlock(&counter->mutex);
    }
}

static void threads_take_turns(void **state)
{
    (void)state;
    struct counter counter = { .value = 0 };
    sys_thread threads[3];
    assert_int_equal(sys_mutex_init(&counter.mutex), FF_OK);
    for (int i = 0; i < 3; i++)
        assert_int_equal(sys_thread_start(&threads[i], count_up, &counter), FF_OK);
    for (int i = 0; i < 3; i++) sys_thread_join(&threads[i]);
    assert_int_equal(counter.value, 60000);
    sys_mutex_destroy(&counter.mutex);
}

/* ---- files ---- */

static void files_are_written_whole(void **state)
{
    (void)state;
    sys_mapping mapping;
    struct stat status;
    static uint8_t big[300000];
    memset(big, 7, sizeof big);
    assert_int_equal(sys_write_file(SCRATCH "/file", "old", 3), FF_OK);
    assert_int_equal(sys_map_file(SCRATCH "/file", &mapping), FF_OK);
    assert_int_equal(sys_write_file(SCRATCH "/file", big, sizeof big), FF_OK);
    assert_int_equal(mapping.size, 3); /* whoever mapped the old file still sees it */
    assert_memory_equal(mapping.bytes, "old", 3);
    sys_unmap_file(&mapping);
    assert_null(mapping.bytes);
    assert_int_equal(sys_map_file(SCRATCH "/file", &mapping), FF_OK);
    assert_int_equal(mapping.size, sizeof big);
    assert_memory_equal(mapping.bytes, big, sizeof big);
    sys_unmap_file(&mapping);
    assert_int_equal(stat(SCRATCH "/file", &status), 0);
    assert_int_equal(status.st_mode & 0400, 0400);
    assert_int_equal(sys_write_file(SCRATCH "/file", "", 0), FF_OK);
    assert_int_equal(sys_map_file(SCRATCH "/file", &mapping), FF_OK);
    assert_int_equal(mapping.size, 0);
    sys_unmap_file(&mapping);
}

static void a_write_that_fails_leaves_nothing(void **state)
{
    (void)state;
    sys_mapping mapping;
    assert_int_equal(sys_write_file(SCRATCH "/none/file", "x", 1), FF_ERR_SYSTEM);
    assert_int_equal(mkdir(SCRATCH "/directory", 0777), 0);
    /* the rename fails */
    assert_int_equal(sys_write_file(SCRATCH "/directory", "x", 1), FF_ERR_SYSTEM);
    assert_int_equal(system("test -z \"$(ls " SCRATCH " | grep directory.)\""), 0);
    assert_int_equal(sys_map_file(SCRATCH "/directory", &mapping), FF_ERR_SYSTEM);
    assert_int_equal(sys_map_file(SCRATCH "/absent", &mapping), FF_ERR_NOT_FOUND);
    assert_int_equal(sys_map_file(SCRATCH "/file/absent", &mapping), FF_ERR_NOT_FOUND);
}

/* ---- pictures ---- */

#define SIDE 64

static void paint(uint8_t rgb[SIDE * SIDE * 3])
{
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            uint8_t *pixel = rgb + (y * SIDE + x) * 3;
            pixel[0] = (uint8_t)(x * 4);
            pixel[1] = (uint8_t)(y * 4);
            pixel[2] = (uint8_t)((x ^ y) & 32 ? 200 : 40);
        }
}

static int encode(uint8_t *out, size_t capacity, int quality)
{
    static uint8_t rgb[SIDE * SIDE * 3];
    paint(rgb);
    return sys_jpeg_encode(rgb, SIDE, SIDE, quality, out, capacity);
}

static void jpeg_round_trip(void **state)
{
    (void)state;
    static uint8_t bytes[65536], rgb[SIDE * SIDE * 3], back[SIDE * SIDE * 3];
    paint(rgb);
    int best = encode(bytes, sizeof bytes, 100), count = encode(bytes, sizeof bytes, 70);
    assert_true(count > 100 && count < best);
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, SIDE, SIDE, back), FF_OK);
    uint64_t error = 0;
    for (size_t i = 0; i < sizeof rgb; i++)
        error += (uint64_t)((rgb[i] - back[i]) * (rgb[i] - back[i]));
    assert_true(error / sizeof rgb < 300); /* chroma at half resolution across hard edges */
    /* red grows to the right, */
    assert_true(abs(back[0] - 0) < 40 && back[(SIDE - 1) * 3] > 200);
    /* green downwards: top row first */
    assert_true(back[1] < 40 && back[(SIDE - 1) * SIDE * 3 + 1] > 200);
    /* too long for that */
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, SIDE, SIDE / 2, back), FF_ERR_FORMAT);
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, 0, SIDE, back), FF_ERR_ARGUMENT);
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, SIDE, 65501, back), FF_ERR_ARGUMENT);
}

/* The same picture by way of a whole JPEG with libjpeg's own headers and tables. */
static size_t whole_jpeg(const uint8_t *rgb, int quality, uint8_t *back)
{
    struct jpeg_error_mgr errors;
    struct jpeg_compress_struct out = { .err = jpeg_std_error(&errors) };
    struct jpeg_decompress_struct in = { .err = &errors };
    unsigned char *bytes = NULL;
    unsigned long count = 0;
    jpeg_create_compress(&out);
    jpeg_mem_dest(&out, &bytes, &count);
    out.image_width = out.image_height = SIDE;
    out.input_components = 3;
    out.in_color_space = JCS_RGB;
    jpeg_set_defaults(&out);
    jpeg_set_quality(&out, quality, TRUE);
    jpeg_start_compress(&out, TRUE);
    for (JSAMPROW row; out.next_scanline < SIDE;) {
        row = (JSAMPROW)(uintptr_t)(rgb + out.next_scanline * SIDE * 3);
        jpeg_write_scanlines(&out, &row, 1);
    }
    jpeg_finish_compress(&out);
    jpeg_destroy_compress(&out);
    jpeg_create_decompress(&in);
    jpeg_mem_src(&in, bytes, count);
    jpeg_read_header(&in, TRUE);
    jpeg_start_decompress(&in);
    for (JSAMPROW row; in.output_scanline < SIDE;) {
        row = back + in.output_scanline * SIDE * 3;
        jpeg_read_scanlines(&in, &row, 1);
    }
    jpeg_finish_decompress(&in);
    jpeg_destroy_decompress(&in);
    free(bytes);
    return count;
}

/* A bare JPEG says what a whole one says, in 600 bytes less. */
static void bare_jpegs_share_their_tables(void **state)
{
    (void)state;
    static uint8_t bytes[65536], rgb[SIDE * SIDE * 3], back[SIDE * SIDE * 3],
        whole[SIDE * SIDE * 3];
    paint(rgb);
    for (int quality = 1; quality <= 100; quality += quality < 96 ? 7 : 1) {
        int count = encode(bytes, sizeof bytes, quality);
        assert_int_equal(bytes[0], quality);
        assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, SIDE, SIDE, back), FF_OK);
        size_t whole_bytes = whole_jpeg(rgb, quality, whole);
        assert_in_range(whole_bytes - (size_t)count, 600, 640);
        assert_memory_equal(back, whole, sizeof back);
    }
}

/* Bytes that could bring other tables, sizes or scans are refused before libjpeg sees them. */
static void markers_in_bare_jpegs_are_errors(void **state)
{
    (void)state;
    static uint8_t bytes[65536], back[SIDE * SIDE * 3];
    static const uint8_t whole[] = { 0xFF, 0xD8, 0xFF, 0xC0, 0, 17, 8, 0, SIDE, 0, SIDE, 3 };
    int count = encode(bytes, sizeof bytes, 70);
    for (int marker = 0x01; marker <= 0xFF; marker++) {
        bytes[count] = 0xFF;
        bytes[count + 1] = (uint8_t)marker;
        assert_int_equal(sys_jpeg_decode(bytes, (size_t)count + 2, SIDE, SIDE, back),
                         FF_ERR_FORMAT);
        assert_int_equal(sys_jpeg_decode(bytes, (size_t)count + 1, SIDE, SIDE, back),
                         FF_ERR_FORMAT);
    }
    assert_int_equal(sys_jpeg_decode(whole, sizeof whole, SIDE, SIDE, back), FF_ERR_FORMAT);
    bytes[0] = 0;
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, SIDE, SIDE, back), FF_ERR_FORMAT);
    bytes[0] = 101;
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, SIDE, SIDE, back), FF_ERR_FORMAT);
}

static void jpeg_encoder_knows_its_limits(void **state)
{
    (void)state;
    static uint8_t bytes[65536];
    int count = encode(bytes, sizeof bytes, 70);
    assert_int_equal(encode(bytes, (size_t)count + 64, 70), count);
    for (int capacity = 0; capacity < count; capacity += 37) {
        memset(bytes, 0xEE, sizeof bytes);
        assert_int_equal(encode(bytes, (size_t)capacity, 70), FF_ERR_FULL);
        assert_int_equal(bytes[capacity], 0xEE);
    }
    assert_int_equal(sys_jpeg_encode(bytes, 0, 8, 70, bytes, 8), FF_ERR_ARGUMENT);
    assert_int_equal(sys_jpeg_encode(bytes, 8, 70000, 70, bytes, 8), FF_ERR_ARGUMENT);
    assert_int_equal(sys_jpeg_encode(bytes, 8, 8, 0, bytes, 8), FF_ERR_ARGUMENT);
}

static void truncated_jpegs_are_errors(void **state)
{
    (void)state;
    static uint8_t bytes[65536], back[SIDE * SIDE * 3];
    int count = encode(bytes, sizeof bytes, 80);
    for (int length = 0; length < count; length += length + 16 < count ? 16 : 1) {
        /* of the exact size, so that the sanitizer sees a read past the end */
        uint8_t *exact = malloc((size_t)length + 1);
        memcpy(exact, bytes, (size_t)length);
        assert_int_equal(sys_jpeg_decode(exact, (size_t)length, SIDE, SIDE, back), FF_ERR_FORMAT);
        free(exact);
    }
    /* a few bytes too many may go unseen in libjpeg's bit buffer */
    memset(bytes + count, 0x55, 32);
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count + 32, SIDE, SIDE, back), FF_ERR_FORMAT);
    assert_int_equal(sys_jpeg_decode((const uint8_t *)"not a picture", 13, 8, 8, back),
                     FF_ERR_FORMAT);
    assert_int_equal(sys_jpeg_decode(NULL, 0, 8, 8, back), FF_ERR_FORMAT);
}

static void damaged_jpegs_never_end_the_program(void **state)
{
    (void)state;
    static uint8_t bytes[65536], back[SIDE * SIDE * 3];
    int count = encode(bytes, sizeof bytes, 80), refused = 0, tried = 0;
    sys_random random;
    sys_random_seed(&random, 6, 6);
    for (int i = 0; i < count * 2; i++) {
        uint32_t at = sys_random_below(&random, (uint32_t)count),
                 flip = 1u << sys_random_below(&random, 8);
        bytes[at] ^= (uint8_t)flip;
        int rc = sys_jpeg_decode(bytes, (size_t)count, SIDE, SIDE, back);
        assert_true(rc == FF_OK || rc == FF_ERR_FORMAT);
        refused += rc != FF_OK;
        tried++;
        bytes[at] ^= (uint8_t)flip;
    }
    /* bits of pixels may flip unseen: messages have checksums for that */
    assert_true(refused > 0 && refused < tried);
    assert_int_equal(sys_jpeg_decode(bytes, (size_t)count, SIDE, SIDE, back), FF_OK);
}

static void png_files_are_pngs(void **state)
{
    (void)state;
    static uint8_t rgb[SIDE * SIDE * 3];
    static const uint8_t head[] = { 0x89, 'P',  'N', 'G', '\r', '\n', 0x1A, '\n', 0,
                                    0,    0,    13,  'I', 'H',  'D',  'R',  0,    0,
                                    0,    SIDE, 0,   0,   0,    SIDE, 8,    2 };
    sys_mapping mapping;
    paint(rgb);
    assert_int_equal(sys_png_write(SCRATCH "/a.png", rgb, SIDE, SIDE), FF_OK);
    assert_int_equal(sys_map_file(SCRATCH "/a.png", &mapping), FF_OK);
    assert_true(mapping.size > sizeof head);
    assert_memory_equal(mapping.bytes, head, sizeof head);
    sys_unmap_file(&mapping);
    assert_int_equal(sys_png_write(SCRATCH "/none/a.png", rgb, SIDE, SIDE), FF_ERR_SYSTEM);
    uint8_t *again;
    uint32_t width, height;
    assert_int_equal(sys_png_read(SCRATCH "/a.png", &again, &width, &height), FF_OK);
    assert_int_equal(width, SIDE);
    assert_int_equal(height, SIDE);
    assert_memory_equal(again, rgb, sizeof rgb);
    free(again);
    assert_int_equal(sys_map_file(SCRATCH "/a.png", &mapping), FF_OK);
    assert_int_equal(sys_write_file(SCRATCH "/cut.png", mapping.bytes, (size_t)mapping.size - 20),
                     FF_OK);
    sys_unmap_file(&mapping);
    assert_int_equal(sys_png_read(SCRATCH "/cut.png", &again, &width, &height), FF_ERR_FORMAT);
    assert_int_equal(sys_png_read(SCRATCH "/none.png", &again, &width, &height), FF_ERR_NOT_FOUND);
    assert_int_equal(sys_png_write(SCRATCH "/a.png", rgb, 0, SIDE), FF_ERR_ARGUMENT);
}

static int make_scratch(void **state)
{
    (void)state;
    return system("rm -rf " SCRATCH " && mkdir -p " SCRATCH) == 0 ? 0 : -1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clock_can_be_replaced),
        cmocka_unit_test(real_clock_sleeps_at_least_as_long),
        cmocka_unit_test(events_come_out_in_order),
        cmocka_unit_test(scripts_inject_what_is_due),
        cmocka_unit_test(random_numbers_are_those_of_pcg32),
        cmocka_unit_test(threads_take_turns),
        cmocka_unit_test(files_are_written_whole),
        cmocka_unit_test(a_write_that_fails_leaves_nothing),
        cmocka_unit_test(jpeg_round_trip),
        cmocka_unit_test(bare_jpegs_share_their_tables),
        cmocka_unit_test(markers_in_bare_jpegs_are_errors),
        cmocka_unit_test(jpeg_encoder_knows_its_limits),
        cmocka_unit_test(truncated_jpegs_are_errors),
        cmocka_unit_test(damaged_jpegs_never_end_the_program),
        cmocka_unit_test(png_files_are_pngs),
    };
    return cmocka_run_group_tests(tests, make_scratch, NULL);
}
