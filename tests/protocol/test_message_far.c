/* GET_FAR and FAR: there and back, at the ends of their fields and beyond them. */
#include "../../protocol/message/ff_message.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const uint8_t some[300] = "fins or paint";

static ff_message get_far(ff_get_far get)
{
    return (ff_message){ .type = FF_MSG_GET, .kind = FF_KIND_FAR, .u.get_far = get };
}

static ff_message far_of(ff_far far)
{
    return (ff_message){ .type = FF_MSG_ANSWER, .kind = FF_KIND_FAR, .u.far = far };
}

static ff_get_far least_get(void)
{
    return (ff_get_far){ .low_m = INT16_MIN,
                         .high_m = INT16_MIN,
                         .focal = FF_FAR_FOCAL_MIN,
                         .down = 1,
                         .tolerance_q2 = 1,
                         .sector_count = 1,
                         .sector = { 15 } };
}

static ff_get_far largest_get(void)
{
    return (ff_get_far){ .id = 65535,
                         .position_wu = { INT32_MIN, INT32_MAX, -1 },
                         .front_wu = INT32_MAX,
                         .heading = 65535,
                         .behind_m = 65534,
                         .ahead_m = 65533,
                         .aside_m = 65532,
                         .low_m = -2,
                         .high_m = INT16_MAX,
                         .focal = FF_FAR_FOCAL_MAX,
                         .down = 2 * FF_FAR_FOCAL_MAX,
                         .paint_shift = FF_FAR_SHIFT_MAX,
                         .quality = 100,
                         .tolerance_q2 = 255,
                         .sector_count = 16,
                         .sector = { 7, 0, 6, 1, 5, 2, 4, 3, 15, 8, 14, 9, 13, 10, 12, 11 } };
}

static ff_far sector_with(uint32_t fins_bytes, uint8_t blocks_x)
{
    ff_far far = { .sector = 15, .flags = FF_FACE_LAST };
    far.fins = some;
    far.fins_bytes = fins_bytes;
    if (blocks_x == 0) return far;
    far.blocks_x = blocks_x;
    far.blocks_y = FF_FAR_ROWS_MAX;
    far.top = INT16_MIN;
    far.paint = some + 2;
    far.paint_bytes = 298;
    return far;
}

static ff_far empty_sector(uint8_t flags) { return (ff_far){ .flags = FF_FACE_EMPTY | flags }; }

/* Decodes what was encoded, and neither needs nor takes another byte. */
static int round_trip(const ff_message *message, ff_message *again)
{
    uint8_t bytes[1024];
    int used = ff_message_encode(message, bytes, sizeof bytes);
    assert_in_range(used, 2, ff_message_bytes_max(message));
    for (int room = 0; room <= used; room++) {
        uint8_t *exact = malloc(room > 0 ? (size_t)room : 1);
        assert_int_equal(ff_message_encode(message, exact, (size_t)room),
                         room < used ? FF_ERR_FULL : used);
        memcpy(exact, bytes, (size_t)room);
        assert_int_equal(ff_message_decode(exact, (size_t)room, again), room < used ? 0 : used);
        free(exact);
    }
    assert_int_equal(ff_message_decode(bytes, (size_t)used, again), used);
    assert_int_equal(again->type, message->type);
    assert_int_equal(again->kind, FF_KIND_FAR);
    assert_int_equal(ff_message_id(again), ff_message_id(message));
    /* pointers lead into `bytes`: what they lead to is compared as bytes */
    uint8_t twice[1024];
    assert_int_equal(ff_message_encode(again, twice, sizeof twice), used);
    assert_memory_equal(twice, bytes, (size_t)used);
    return used;
}

static void requests_there_and_back(void **state)
{
    const ff_get_far list[] = { least_get(), largest_get() };
    (void)state;
    for (int i = 0; i < 2; i++) {
        ff_message message = get_far(list[i]), again;
        const ff_get_far *a = &list[i], *b = &again.u.get_far;
        assert_in_range(round_trip(&message, &again), 2, FF_SHORT_BYTES_MAX);
        assert_int_equal(a->id, b->id);
        assert_memory_equal(a->position_wu, b->position_wu, sizeof a->position_wu);
        assert_true(a->front_wu == b->front_wu && a->heading == b->heading);
        assert_true(a->behind_m == b->behind_m && a->ahead_m == b->ahead_m);
        assert_true(a->aside_m == b->aside_m && a->low_m == b->low_m && a->high_m == b->high_m);
        assert_true(a->focal == b->focal && a->down == b->down);
        assert_true(a->paint_shift == b->paint_shift && a->quality == b->quality);
        assert_true(a->tolerance_q2 == b->tolerance_q2 && a->sector_count == b->sector_count);
        assert_memory_equal(a->sector, b->sector, sizeof a->sector);
    }
}

static void sectors_there_and_back(void **state)
{
    const ff_far list[] = { sector_with(0, 128), sector_with(127, 2), sector_with(128, 0),
                            empty_sector(0), empty_sector(FF_FACE_LAST) };
    (void)state;
    for (int i = 0; i < 5; i++) {
        ff_message message = far_of(list[i]), again;
        const ff_far *a = &list[i], *b = &again.u.far;
        round_trip(&message, &again);
        assert_true(a->sector == b->sector && a->flags == b->flags);
        assert_true(a->blocks_x == b->blocks_x && a->blocks_y == b->blocks_y && a->top == b->top);
        assert_int_equal(a->fins_bytes, b->fins_bytes);
        assert_int_equal(a->paint_bytes, b->paint_bytes);
    }
}

/* Each field where SPEC.md has it. */
static void bytes_are_those_of_the_specification(void **state)
{
    static const uint8_t request[] = { 10,   41, 2, 1, 1,  0, 0, 0,  2, 0, 0, 0, 0xfd, 0xff, 0xff,
                                       0xff, 4,  0, 0, 0,  5, 0, 6,  0, 7, 0, 8, 0,    0xf7, 0xff,
                                       10,   0,  0, 1, 12, 0, 3, 70, 2, 3, 5, 0, 4 };
    static const uint8_t sector[] = { 75, 13,   0x23, 3,   'a', 'b', 'c', 4,
                                      5,  0xfe, 0xff, 'd', 'e', 'f', 'g' };
    ff_message out;
    uint8_t again[64];
    (void)state;
    assert_int_equal(ff_message_decode(request, sizeof request, &out), sizeof request);
    const ff_get_far *get = &out.u.get_far;
    assert_true(get->id == 258 && get->position_wu[0] == 1 && get->position_wu[1] == 2);
    assert_true(get->position_wu[2] == -3 && get->front_wu == 4 && get->heading == 5);
    assert_true(get->behind_m == 6 && get->ahead_m == 7 && get->aside_m == 8 && get->low_m == -9);
    assert_true(get->high_m == 10 && get->focal == 256 && get->down == 12 && get->paint_shift == 3);
    assert_true(get->quality == 70 && get->tolerance_q2 == 2 && get->sector_count == 3);
    assert_memory_equal(get->sector, "\5\0\4", 3);
    assert_int_equal(ff_message_encode(&out, again, sizeof again), sizeof request);
    assert_memory_equal(again, request, sizeof request);
    assert_int_equal(ff_message_decode(sector, sizeof sector, &out), sizeof sector);
    const ff_far *far = &out.u.far;
    assert_true(far->sector == 3 && far->flags == FF_FACE_LAST);
    assert_true(far->fins_bytes == 3 && far->blocks_x == 4 && far->blocks_y == 5 && far->top == -2);
    assert_int_equal(far->paint_bytes, 4);
    assert_memory_equal(far->fins, "abc", 3);
    assert_memory_equal(far->paint, "defg", 4);
}

static void ranges_of_requests_hold_both_ways(void **state)
{
    uint8_t bytes[128];
    ff_message m;
    (void)state;
#define BAD(assignment)         \
    m = get_far(largest_get()); \
    m.u.get_far.assignment;     \
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE)
    BAD(front_wu = -1);
    BAD(high_m = -3);
    BAD(focal = FF_FAR_FOCAL_MIN - 1);
    BAD(focal = FF_FAR_FOCAL_MAX + 1);
    BAD(down = 0);
    BAD(down = 2 * FF_FAR_FOCAL_MAX + 1);
    BAD(paint_shift = FF_FAR_SHIFT_MAX + 1);
    BAD(quality = 101);
    BAD(quality = m.u.get_far.tolerance_q2 = 0);
    BAD(sector_count = 0);
    BAD(sector_count = 17);
    BAD(sector[15] = 16);
    BAD(sector[15] = 7);
#undef BAD
    /* as bytes, by their place in the body */
    static const struct {
        uint8_t at, value;
    } spoilt[] = { { 17, 0x80 }, { 29, 0x80 }, { 31, 0 },  { 31, 9 },  { 33, 17 }, { 34, 4 },
                   { 35, 101 },  { 37, 0 },    { 37, 17 }, { 38, 16 }, { 53, 7 } };
    for (size_t i = 0; i < sizeof spoilt / sizeof *spoilt; i++) {
        m = get_far(largest_get());
        int used = ff_message_encode(&m, bytes, sizeof bytes);
        bytes[2 + spoilt[i].at] = spoilt[i].value;
        assert_int_equal(ff_message_decode(bytes, (size_t)used, &m), FF_ERR_RANGE);
    }
}

static void ranges_of_sectors_hold_both_ways(void **state)
{
    uint8_t bytes[1024];
    ff_message m;
    (void)state;
#define BAD(sector, assignment) \
    m = far_of(sector);         \
    m.u.far.assignment;         \
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE)
    BAD(sector_with(5, 2), sector = 16);
    BAD(sector_with(5, 2), flags = 4);
    BAD(sector_with(5, 2), flags = FF_FACE_EMPTY);
    BAD(sector_with(5, 0), flags = FF_FACE_EMPTY);
    BAD(sector_with(0, 2), flags = FF_FACE_EMPTY);
    BAD(sector_with(5, 0), fins_bytes = 0); /* nothing, and not said to be empty */
    BAD(sector_with(5, 2), blocks_x = 0);
    BAD(sector_with(5, 2), blocks_x = 3);
    BAD(sector_with(5, 2), blocks_x = 130);
    BAD(sector_with(5, 2), blocks_y = 0);
    BAD(sector_with(5, 2), paint_bytes = 0);
    BAD(sector_with(5, 0), blocks_y = 1);
    BAD(sector_with(5, 0), top = 1);
    BAD(sector_with(5, 0), paint_bytes = 1);
#undef BAD
}

static void assert_far(const char *body, size_t count, int expected)
{
    uint8_t bytes[64] = { 75, (uint8_t)count };
    ff_message out;
    memcpy(bytes + 2, body, count);
    assert_int_equal(ff_message_decode(bytes, count + 2, &out),
                     expected == FF_OK ? (int)count + 2 : expected);
}

static void bad_sectors_are_refused(void **state)
{
    (void)state;
    assert_far("\x17", 1, FF_OK);
    assert_far("\x37", 1, FF_OK);
    assert_far("\x1f", 1, FF_OK);
    assert_far("\x57", 1, FF_ERR_RANGE);         /* a third flag */
    assert_far("\x17\0", 2, FF_ERR_FORMAT);      /* more than nothing */
    assert_far("\7\0\0", 3, FF_ERR_RANGE);       /* less than something */
    assert_far("\7\1f\0", 4, FF_OK);             /* fins */
    assert_far("\7\2f\0", 4, FF_ERR_TRUNCATED);  /* fewer fins than said */
    assert_far("\7\1f\0\0", 5, FF_ERR_FORMAT);   /* behind them */
    assert_far("\7\x81\0f\0", 5, FF_ERR_RANGE);  /* a length that is too long */
    assert_far("\7\0\2\1\0\0p", 7, FF_OK);       /* paint */
    assert_far("\7\0\2\1\0\0", 6, FF_ERR_RANGE); /* none */
    assert_far("\7\0\3\1\0\0p", 7, FF_ERR_RANGE);
    assert_far("\7\0\x82\1\0\0p", 7, FF_ERR_RANGE);
    assert_far("\7\0\2\0\0\0p", 7, FF_ERR_RANGE);
    assert_far("\7\0\2\xff\0\0p", 7, FF_OK);
}

/* Whatever bit is flipped: what decodes encodes to the same bytes. */
static void flipped_bits_do_no_harm(void **state)
{
    const ff_message list[] = { get_far(largest_get()), far_of(sector_with(5, 4)) };
    uint8_t bytes[1024], again[1024];
    ff_message out;
    (void)state;
    for (int i = 0; i < 2; i++) {
        int used = ff_message_encode(&list[i], bytes, sizeof bytes);
        for (int bit = 0; bit < 8 * used; bit++) {
            bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
            int taken = ff_message_decode(bytes, (size_t)used, &out);
            if (taken > 0) {
                assert_int_equal(ff_message_encode(&out, again, sizeof again), taken);
                assert_memory_equal(again, bytes, (size_t)taken);
            }
            bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        }
    }
}

/* The largest sector that a message can bring, and one byte more. */
static void sectors_end_where_messages_do(void **state)
{
    static uint8_t room[FF_MESSAGE_BODY_MAX + 16], paint[FF_MESSAGE_BODY_MAX];
    ff_message m = far_of(sector_with(5, 4)), out;
    (void)state;
    m.u.far.paint = paint;
    m.u.far.paint_bytes = FF_MESSAGE_BODY_MAX - (1 + 1 + 5 + 1 + 1 + 2);
    assert_int_equal(ff_message_encode(&m, room, sizeof room),
                     FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX);
    assert_int_equal(ff_message_decode(room, sizeof room, &out),
                     FF_MESSAGE_BODY_MAX + FF_MESSAGE_HEADER_MAX);
    m.u.far.paint_bytes++;
    assert_int_equal(ff_message_encode(&m, room, sizeof room), FF_ERR_RANGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(requests_there_and_back),
        cmocka_unit_test(sectors_there_and_back),
        cmocka_unit_test(bytes_are_those_of_the_specification),
        cmocka_unit_test(ranges_of_requests_hold_both_ways),
        cmocka_unit_test(ranges_of_sectors_hold_both_ways),
        cmocka_unit_test(bad_sectors_are_refused),
        cmocka_unit_test(flipped_bits_do_no_harm),
        cmocka_unit_test(sectors_end_where_messages_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
