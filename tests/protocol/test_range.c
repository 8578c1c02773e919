/* The arithmetic coder of codec trained: decisions of all probabilities come back, and streams end
 * as soon as they can. */
#include "../../protocol/trained/ff_range.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h>

#define DECISIONS_MAX 200000
#define BYTES_MAX     500000

typedef struct decisions {
    uint32_t count;
    uint32_t one[DECISIONS_MAX];
    uint8_t bit[DECISIONS_MAX];
} decisions;

static decisions d;
static uint8_t stream[BYTES_MAX + 16];
static uint32_t random_state = 1;

static uint32_t random_below(uint32_t limit)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)random_state * limit >> 32);
}

static void add(uint32_t one, unsigned bit)
{
    d.one[d.count] = one;
    d.bit[d.count++] = (uint8_t)bit;
}

static void add_random(void)
{
    uint32_t one = 1 + random_below(65535);
    add(one, random_below(2));
}

static int write_all(size_t limit)
{
    ff_range_writer to;
    ff_range_write(&to, stream, limit);
    for (uint32_t i = 0; i < d.count; i++) ff_range_put(&to, d.one[i], d.bit[i]);
    return ff_range_end(&to);
}

/* Whether the decisions are read from these bytes, and whether all of these were read. */
static int reads_back(const uint8_t *bytes, size_t count, int *whole)
{
    ff_range range;
    ff_range_read(&range, bytes, count);
    for (uint32_t i = 0; i < d.count; i++)
        if (ff_range_take(&range, d.one[i]) != d.bit[i]) return 0;
    *whole = ff_range_is_read(&range);
    return 1;
}

static void check_there_and_back(void)
{
    int bytes = write_all(BYTES_MAX), whole = 0;
    assert_in_range(bytes, 0, BYTES_MAX);
    assert_true(reads_back(stream, (size_t)bytes, &whole));
    assert_true(whole);
    assert_true(bytes == 0 || stream[bytes - 1] != 0);
}

static void decisions_of_every_probability_come_back(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) { /* as likely as told; all 0; all 1; the less likely */
        d.count = 0;
        for (uint32_t one = 1; one < 65536; one++)
            add(one, kind == 0 ? random_below(65536) < one : kind < 3 ? kind == 2 : one < 32768);
        check_there_and_back();
    }
    for (int run = 0; run < 2000; run++) {
        uint32_t width = random_below(16);
        d.count = 0;
        for (uint32_t i = random_below(300); i > 0; i--) {
            uint32_t near = 1 + random_below(1u << width), likely = random_below(2);
            add(likely ? 65536 - near : near, random_below(2));
        }
        check_there_and_back();
    }
}

static void decisions_cost_what_they_tell(void **state)
{
    (void)state;
    d.count = 0;
    for (int i = 0; i < 65536; i++) add(65535, 1);
    assert_int_equal(write_all(BYTES_MAX), 0);
    for (int i = 0; i < 4; i++) add(65535, 0); /* 16 bits each, behind 1.4 */
    assert_in_range(write_all(BYTES_MAX), 8, 11);
    d.count = 0;
    for (int i = 0; i < 80000; i++) add(6554, random_below(10) == 0); /* 0.469 bits each */
    assert_in_range(write_all(BYTES_MAX), 4600, 4780);
}

/* No shorter bytes read as the same decisions: tried are all of up to two. */
static void streams_end_as_soon_as_they_can(void **state)
{
    uint32_t lengths[16] = { 0 };
    (void)state;
    for (int run = 0; run < 60; run++) {
        int whole;
        d.count = 0;
        for (int i = run % 12; i > 0; i--) add_random();
        int bytes = write_all(BYTES_MAX);
        assert_in_range(bytes, 0, 15);
        lengths[bytes]++;
        for (int shorter = 0; shorter < bytes && shorter <= 2; shorter++)
            for (uint32_t value = 0; value < 1u << 8 * shorter; value++) {
                const uint8_t tried[2] = { (uint8_t)value, (uint8_t)(value >> 8) };
                assert_false(reads_back(tried, (size_t)shorter, &whole));
            }
    }
    assert_true(lengths[0] && lengths[1] && lengths[2]);
}

/* A reader is four bytes ahead, and zeros that an end leaves out are few: of eight bytes too many
 * some stay unread. */
static void bytes_too_many_are_noticed(void **state)
{
    (void)state;
    for (int run = 1; run < 300; run++) {
        int whole = 0;
        d.count = 0;
        for (int i = 0; i < run; i++) add_random();
        add(32768, 0);
        int bytes = write_all(BYTES_MAX);
        memset(stream + bytes, 0, 8);
        assert_true(reads_back(stream, (size_t)bytes + 8, &whole));
        assert_false(whole);
    }
}

/* At its limit a writer stops, and says so; zeros that are left out need no room. */
static void nothing_is_written_beyond_the_limit(void **state)
{
    (void)state;
    for (int run = 0; run < 400; run++) {
        d.count = 0;
        for (int i = 0; i < run; i++) {
            add_random();
            if (run % 2) d.bit[i] = 1; /* ends in many zeros */
        }
        int bytes = write_all(BYTES_MAX);
        for (int limit = bytes > 8 ? bytes - 8 : 0; limit <= bytes; limit++) {
            memset(stream, 0xa5, (size_t)bytes + 16);
            assert_int_equal(write_all((size_t)limit), limit < bytes ? -1 : bytes);
            for (int i = limit; i < bytes + 16; i++) assert_int_equal(stream[i], 0xa5);
        }
    }
}

static ff_range_writer written(void)
{
    ff_range_writer to;
    memset(stream, 0, 400);
    ff_range_write(&to, stream, BYTES_MAX);
    for (uint32_t i = 0; i < d.count; i++) ff_range_put(&to, d.one[i], d.bit[i]);
    return to;
}

/* Other bits from bit `from` on. */
static void replace_after(int from, int bytes, uint32_t by)
{
    for (int bit = from; bit < 8 * bytes; bit++) {
        uint8_t mask = (uint8_t)(128 >> bit % 8);
        stream[bit / 8] = (uint8_t)(stream[bit / 8] & ~mask);
        if (by == 2 ? random_below(2) : by) stream[bit / 8] |= mask;
    }
}

/* A stream that others follow says the same whatever these are, and takes two to three bits more
 * than a last one does, which ends in a bit 1. */
static void streams_end_within_a_byte(void **state)
{
    uint32_t more = 0;
    (void)state;
    for (int run = 0; run < 2000; run++) {
        ff_range range;
        int whole;
        d.count = 0;
        for (int i = run % 60; i > 0; i--) add_random();
        ff_range_writer to = written();
        int bits = ff_range_end_before(&to), bytes = (bits + 7) / 8 + 8;
        for (uint32_t by = 0; by < 4; by++) {
            replace_after(bits, bytes, by < 2 ? by : 2);
            assert_true(reads_back(stream, (size_t)bytes, &whole));
            ff_range_read(&range, stream, (size_t)bytes);
            for (uint32_t i = 0; i < d.count; i++) ff_range_take(&range, d.one[i]);
            assert_int_equal(ff_range_bits(&range, (size_t)bytes), bits);
        }
        to = written();
        int last = ff_range_end_bits(&to);
        assert_true(last <= bits && reads_back(stream, (size_t)(last + 7) / 8, &whole));
        assert_true(last == 0 || stream[(last - 1) / 8] >> (7 - (last - 1) % 8) & 1);
        replace_after(last, (last + 7) / 8, 1);
        more += (uint32_t)(bits - last);
        if (last == 0) continue;
        replace_after(last - 1, (last + 7) / 8, 0); /* without that bit it says something else */
        assert_false(reads_back(stream, (size_t)(last + 7) / 8, &whole));
    }
    assert_in_range(more, 2 * 2000, 3 * 2000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(decisions_of_every_probability_come_back),
        cmocka_unit_test(decisions_cost_what_they_tell),
        cmocka_unit_test(streams_end_as_soon_as_they_can),
        cmocka_unit_test(streams_end_within_a_byte),
        cmocka_unit_test(bytes_too_many_are_noticed),
        cmocka_unit_test(nothing_is_written_beyond_the_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
