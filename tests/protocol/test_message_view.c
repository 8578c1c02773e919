/* GET_VIEW and PART: there and back, at the ends of their fields and beyond them. */
#include "../../protocol/message/ff_message.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const uint8_t payload[] = "some bytes of a refinement";

static ff_message get_view(ff_get_view view)
{
    return (ff_message){ .type = FF_MSG_GET, .kind = FF_KIND_VIEW, .u.view = view };
}

static ff_message part_of(ff_part part)
{
    return (ff_message){ .type = FF_MSG_ANSWER, .kind = FF_KIND_VIEW, .u.part = part };
}

static ff_get_view least_view(void)
{
    return (ff_get_view){ .focal_q8 = 256,
                          .width = 1,
                          .height = 1,
                          .allowed_q8 = 1,
                          .reach_wu = 1,
                          .fine_wu = 1,
                          .coarse = 1 };
}

static ff_get_view largest_view(void)
{
    ff_get_view view = { .id = 65535,
                         .yaw = 65535,
                         .pitch = 49152,
                         .roll = 1,
                         .position_wu = { INT32_MIN, INT32_MAX, -1 },
                         .focal_q8 = INT32_MAX,
                         .width = FF_VIEW_SIDE_MAX,
                         .height = FF_VIEW_SIDE_MAX - 1,
                         .measure = FF_VIEW_BY_PIXELS,
                         .depth_max = 16,
                         .allowed_q8 = INT32_MAX,
                         .reach_wu = INT32_MAX - 1,
                         .fine_wu = INT32_MAX - 2,
                         .coarse = FF_VIEW_COARSE_MAX,
                         .triangles_max = UINT32_MAX,
                         .bytes_max = UINT32_MAX - 1,
                         .roots = 0x8002,
                         .count = FF_VIEW_KEYS_MAX };
    for (unsigned i = 0; i < FF_VIEW_KEYS_MAX; i++)
        view.below[i] = view.roots >> i & 1u ? ff_key_make(FF_KEY_TILES_MAX - 1 - i, 0, 0)
                                             : ff_key_make(FF_KEY_TILES_MAX - 1, i,
                                                           (uint32_t)((UINT64_C(1) << 2 * i) - 1));
    return view;
}

/* Decodes what was encoded, and neither needs nor takes another byte. */
static void round_trip(const ff_message *message, ff_message *again)
{
    uint8_t bytes[512], exact[512];
    int used = ff_message_encode(message, bytes, sizeof bytes);
    assert_in_range(used, 2, ff_message_bytes_max(message));
    assert_int_equal(ff_message_decode(bytes, (size_t)used, again), used);
    for (int room = 0; room < used; room++) {
        ff_message half;
        assert_int_equal(ff_message_encode(message, exact, (size_t)room), FF_ERR_FULL);
        assert_int_equal(ff_message_decode(bytes, (size_t)room, &half), 0);
    }
    assert_int_equal(again->type, message->type);
    assert_int_equal(again->kind, FF_KIND_VIEW);
    assert_int_equal(ff_message_id(again), ff_message_id(message));
}

static void views_there_and_back(void **state)
{
    const ff_get_view list[] = { least_view(), largest_view() };
    (void)state;
    for (int i = 0; i < 2; i++) {
        ff_message message = get_view(list[i]), again;
        const ff_get_view *a = &list[i], *b = &again.u.view;
        round_trip(&message, &again);
        assert_true(a->id == b->id && a->yaw == b->yaw && a->pitch == b->pitch);
        assert_true(a->roll == b->roll && a->focal_q8 == b->focal_q8);
        assert_memory_equal(a->position_wu, b->position_wu, sizeof a->position_wu);
        assert_true(a->width == b->width && a->height == b->height);
        assert_true(a->measure == b->measure && a->depth_max == b->depth_max);
        assert_true(a->allowed_q8 == b->allowed_q8 && a->reach_wu == b->reach_wu);
        assert_true(a->fine_wu == b->fine_wu && a->coarse == b->coarse);
        assert_true(a->triangles_max == b->triangles_max && a->bytes_max == b->bytes_max);
        assert_true(a->roots == b->roots && a->count == b->count);
        assert_memory_equal(a->below, b->below, sizeof a->below);
    }
    /* the longest request is no longer than said */
    uint8_t bytes[FF_REQUEST_BYTES_MAX];
    ff_message longest = get_view(largest_view());
    assert_in_range(ff_message_encode(&longest, bytes, sizeof bytes), 150, FF_REQUEST_BYTES_MAX);
}

static void parts_there_and_back(void **state)
{
    const ff_part list[] = {
        { 65535, FF_PART_REFINEMENT, ff_key_make(FF_KEY_TILES_MAX - 1, 15, 0x3fffffff), payload,
          sizeof payload },
        { 1, FF_PART_ROOT, ff_key_make(3, 0, 0), payload, 1 },
        { 2, FF_PART_END, 0, NULL, 0 },
    };
    (void)state;
    for (int i = 0; i < 3; i++) {
        ff_message message = part_of(list[i]), again;
        round_trip(&message, &again);
        assert_int_equal(again.u.part.what, list[i].what);
        assert_int_equal(again.u.part.key, list[i].key);
        assert_int_equal(again.u.part.byte_count, list[i].byte_count);
        if (list[i].byte_count)
            assert_memory_equal(again.u.part.bytes, payload, list[i].byte_count);
    }
}

static void ranges_hold_both_ways(void **state)
{
    uint8_t bytes[512];
    ff_message m;
    (void)state;
#define BAD(assignment)           \
    m = get_view(largest_view()); \
    m.u.view.assignment;          \
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE)
    BAD(focal_q8 = 255);
    BAD(width = 0);
    BAD(height = FF_VIEW_SIDE_MAX + 1);
    BAD(measure = 2);
    BAD(depth_max = 17);
    BAD(allowed_q8 = 0);
    BAD(reach_wu = 0);
    BAD(fine_wu = 0);
    BAD(coarse = 0);
    BAD(coarse = FF_VIEW_COARSE_MAX + 1);
    BAD(count = FF_VIEW_KEYS_MAX + 1);
    BAD(count = 15); /* a root beyond them */
    BAD(below[2] = ff_key_make(0, 2, 16));
    BAD(below[1] = ff_key_make(0, 1, 0)); /* a root is of level 0 */
#undef BAD
#define BAD(assignment)                                                                \
    m = part_of((ff_part){ 1, FF_PART_REFINEMENT, ff_key_make(0, 1, 3), payload, 5 }); \
    m.u.part.assignment;                                                               \
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE)
    BAD(what = 3);
    BAD(what = FF_PART_ROOT);
    BAD(what = FF_PART_END);
    BAD(key = ff_key_make(0, 1, 4));
    BAD(byte_count = 0);
#undef BAD
    /* as bytes: a key that is neither root nor refinement; an end with a level, or with more */
    m = get_view(least_view());
    m.u.view.count = 1;
    int used = ff_message_encode(&m, bytes, sizeof bytes);
    bytes[used - 3] = 2;
    assert_int_equal(ff_message_decode(bytes, (size_t)used, &m), FF_ERR_RANGE);
    assert_int_equal(ff_message_decode((const uint8_t *)"\x4a\3\1\0\2", 5, &m), 5);
    assert_int_equal(ff_message_decode((const uint8_t *)"\x4a\3\1\0\x12", 5, &m), FF_ERR_RANGE);
    assert_int_equal(ff_message_decode((const uint8_t *)"\x4a\4\1\0\2\0", 6, &m), FF_ERR_RANGE);
}

static void a_view_covers_what_lies_below(void **state)
{
    ff_get_view view = least_view();
    (void)state;
    assert_true(ff_view_covers(&view, FF_KIND_ROOT, ff_key_make(7, 0, 0))); /* nothing named: all */
    view.count = 2;
    view.roots = 1;
    view.below[0] = ff_key_make(7, 0, 0);
    view.below[1] = ff_key_make(5, 2, 9);
    assert_true(ff_view_covers(&view, FF_KIND_ROOT, ff_key_make(7, 0, 0)));
    assert_true(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(7, 15, 77)));
    assert_false(ff_view_covers(&view, FF_KIND_ROOT, ff_key_make(6, 0, 0)));
    assert_true(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(5, 2, 9)));
    assert_true(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(5, 4, 9 * 16 + 15)));
    assert_false(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(5, 4, 10 * 16)));
    assert_false(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(5, 1, 2)));
    assert_false(ff_view_covers(&view, FF_KIND_ROOT, ff_key_make(5, 0, 0)));
    view.below[1] = ff_key_make(5, 0, 0); /* what refines a root is not the root */
    assert_true(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(5, 15, 0x3fffffff)));
    assert_false(ff_view_covers(&view, FF_KIND_ROOT, ff_key_make(5, 0, 0)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_there_and_back),
        cmocka_unit_test(parts_there_and_back),
        cmocka_unit_test(ranges_hold_both_ways),
        cmocka_unit_test(a_view_covers_what_lies_below),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
