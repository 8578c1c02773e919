/* GET_VIEW and the parts that answer it: there and back, at the ends of their fields and beyond
 * them; and which node each part is of. */
#include "../../protocol/message/ff_parts.h"

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
        view.below[i] = view.roots >> i & 1u
                            ? ff_key_make(FF_KEY_TILES_MAX - 1 - i, 0, 0)
                            : ff_key_make(FF_KEY_TILES_MAX - 1, i ? i - 1 : 0,
                                          (uint32_t)((UINT64_C(1) << 2 * (i ? i - 1 : 0)) - 1));
    view.edge_count = FF_VIEW_EDGE_MAX;
    for (unsigned i = 0; i < FF_VIEW_EDGE_MAX; i++)
        view.edge[i] = ff_key_make(FF_KEY_TILES_MAX - 1, 14, 0xfffffff - i);
    return view;
}

/* Decodes what was encoded, and neither needs nor takes another byte. */
static void round_trip(const ff_message *message, ff_message *again)
{
    uint8_t bytes[512], exact[512];
    int used = ff_message_encode(message, bytes, sizeof bytes);
    assert_in_range(used, 1, ff_message_bytes_max(message));
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
        assert_true(a->edge_count == b->edge_count);
        assert_memory_equal(a->edge, b->edge, sizeof a->edge);
    }
    /* the longest request is no longer than said */
    uint8_t bytes[FF_REQUEST_BYTES_MAX];
    ff_message longest = get_view(largest_view());
    assert_in_range(ff_message_encode(&longest, bytes, sizeof bytes), 150, FF_REQUEST_BYTES_MAX);
}

static void parts_there_and_back(void **state)
{
    const ff_part list[] = {
        { 15, payload, sizeof payload, 0 },
        { 1, payload, 1, 0 },
        { 0, NULL, 0, 0 },
        { 0, NULL, 0, FF_PARTS_LATER_MAX },
    };
    (void)state;
    for (int i = 0; i < 4; i++) {
        ff_message message = part_of(list[i]), again;
        round_trip(&message, &again);
        assert_int_equal(again.u.part.below, list[i].below);
        assert_int_equal(again.u.part.later, list[i].later);
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
    BAD(edge_count = FF_VIEW_EDGE_MAX + 1);
    BAD(edge[3] = ff_key_make(0, 2, 16));
    m = get_view(least_view()); /* what names nothing has no edge */
    m.u.view.edge_count = 1;
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE);
    m = (ff_message){ .type = FF_MSG_EDGE, .u.edge = { 1u << FF_VIEW_EDGE_MAX } };
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE);
#undef BAD
#define BAD(assignment)                         \
    m = part_of((ff_part){ 3, payload, 5, 0 }); \
    m.u.part.assignment;                        \
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE)
    BAD(below = 16);
    BAD(byte_count = 0);
    BAD(later = 1);
#undef BAD
    m = part_of((ff_part){ .later = FF_PARTS_LATER_MAX + 1 });
    assert_int_equal(ff_message_encode(&m, bytes, sizeof bytes), FF_ERR_RANGE);
    /* as bytes: a key that is neither root nor refinement */
    m = get_view(least_view());
    m.u.view.count = 1;
    int used = ff_message_encode(&m, bytes, sizeof bytes);
    bytes[used - 4] = 2;
    assert_int_equal(ff_message_decode(bytes, (size_t)used, &m), FF_ERR_RANGE);
    /* roots: a tile that there cannot be, and one too many */
    uint8_t roots[3 + FF_PARTS_MAX + 1] = { 74, 0x81, 4 };
    assert_int_equal(ff_message_decode(roots, sizeof roots, &m), FF_ERR_RANGE);
    roots[1] = 0x80;
    assert_int_equal(ff_message_decode(roots, sizeof roots, &m), sizeof roots - 1);
    assert_int_equal(ff_message_decode((const uint8_t *)"\x4a\5\x80\x80\x80\x80\1", 7, &m),
                     FF_ERR_RANGE);
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
    view.edge_count = 1;
    view.edge[0] = ff_key_make(5, 2, 10);
    assert_true(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(5, 4, 10 * 16)));
    assert_int_equal(ff_view_names(&view, FF_KIND_REFINEMENT, view.edge[0]), 0);
    view.below[1] = ff_key_make(5, 0, 0); /* what refines a root is not the root */
    assert_true(ff_view_covers(&view, FF_KIND_REFINEMENT, ff_key_make(5, 15, 0x3fffffff)));
    assert_false(ff_view_covers(&view, FF_KIND_ROOT, ff_key_make(5, 0, 0)));
}

/* ---- which node a part is of ---- */

static ff_key awaited(const ff_parts *parts, enum ff_kind expected)
{
    enum ff_kind kind;
    ff_key key;
    int named;
    assert_true(ff_parts_next(parts, &kind, &key, &named));
    assert_int_equal(kind, expected);
    return key;
}

static int comes(ff_parts *parts, unsigned below)
{
    const ff_part part = { (uint8_t)below, payload, 1, 0 };
    return ff_parts_take(parts, &part);
}

/* What is named, then what each announces, breadth first. */
static void parts_come_as_they_were_announced(void **state)
{
    static ff_parts parts;
    ff_get_view view = least_view();
    const ff_key root = ff_key_make(7, 0, 0), node = ff_key_make(7, 2, 9);
    (void)state;
    view.count = 2;
    view.roots = 2;
    view.below[0] = node;
    view.below[1] = root;
    ff_parts_begin(&parts, &view);
    assert_int_equal(awaited(&parts, FF_KIND_REFINEMENT), node);
    assert_int_equal(comes(&parts, 1 + 8), FF_OK);
    assert_int_equal(awaited(&parts, FF_KIND_ROOT), root);
    assert_int_equal(comes(&parts, 1), FF_OK);
    assert_int_equal(awaited(&parts, FF_KIND_REFINEMENT), ff_key_child(node, 0));
    assert_int_equal(comes(&parts, 0), FF_OK);
    assert_int_equal(awaited(&parts, FF_KIND_REFINEMENT), ff_key_child(node, 3));
    assert_int_equal(comes(&parts, 0), FF_OK);
    assert_int_equal(awaited(&parts, FF_KIND_REFINEMENT), root); /* what refines it */
    assert_false(ff_parts_done(&parts));
    assert_int_equal(comes(&parts, 0), FF_OK);
    assert_true(ff_parts_done(&parts));
    assert_int_equal(comes(&parts, 0), FF_ERR_FORMAT);
}

/* Those that are put off stand behind all others, and as they stood. */
static void what_comes_later_goes_to_the_end(void **state)
{
    static ff_parts parts;
    ff_get_view view = least_view();
    (void)state;
    view.count = 4;
    for (uint32_t i = 0; i < 4; i++) view.below[i] = ff_key_make(0, 1, i);
    ff_parts_begin(&parts, &view);
    ff_part later = { .later = 4 };
    assert_int_equal(ff_parts_take(&parts, &later), FF_ERR_FORMAT); /* all of them: behind what? */
    later.later = 2;
    assert_int_equal(ff_parts_take(&parts, &later), FF_OK);
    static const uint32_t order[] = { 2, 3, 0, 1 };
    for (int i = 0; i < 4; i++) {
        assert_int_equal(ff_key_code(awaited(&parts, FF_KIND_REFINEMENT)), order[i]);
        assert_int_equal(comes(&parts, 0), FF_OK);
    }
    assert_true(ff_parts_done(&parts));
}

static void roots_are_told_where_nothing_was_named(void **state)
{
    static ff_parts parts;
    const ff_get_view view = least_view();
    const ff_roots roots = { (const uint8_t *)"\5\2", 2 };
    (void)state;
    ff_parts_begin(&parts, &view);
    assert_false(ff_parts_done(&parts));
    assert_int_equal(comes(&parts, 0), FF_ERR_FORMAT); /* of what? */
    assert_int_equal(ff_parts_roots(&parts, &roots), FF_OK);
    assert_int_equal(ff_parts_roots(&parts, &roots), FF_ERR_FORMAT); /* again */
    assert_int_equal(awaited(&parts, FF_KIND_ROOT), ff_key_make(5, 0, 0));
    assert_int_equal(comes(&parts, 2), FF_ERR_FORMAT); /* a root has itself below it, alone */
    ff_parts_begin(&parts, &view);
    assert_int_equal(ff_parts_roots(&parts, &(ff_roots){ NULL, 0 }), FF_OK);
    assert_true(ff_parts_done(&parts)); /* no ground in view */
}

/* Of the edge what is told to come, behind what is named; all told before any part. */
static void the_edge_comes_as_it_is_told(void **state)
{
    static ff_parts parts;
    ff_get_view view = least_view();
    (void)state;
    view.count = 1;
    view.below[0] = ff_key_make(0, 1, 0);
    view.edge_count = 3;
    for (uint32_t i = 0; i < 3; i++) view.edge[i] = ff_key_make(0, 1, 1 + i);
    ff_parts_begin(&parts, &view);
    assert_int_equal(comes(&parts, 0), FF_ERR_FORMAT); /* is any of it needed? */
    assert_false(ff_parts_done(&parts));
    assert_int_equal(ff_parts_edge(&parts, 8), FF_ERR_FORMAT); /* there is no fourth */
    assert_int_equal(ff_parts_edge(&parts, 5), FF_OK);
    assert_int_equal(ff_parts_edge(&parts, 5), FF_ERR_FORMAT); /* again */
    for (int i = 0; i < 3; i++) {
        static const uint32_t order[] = { 0, 1, 3 };
        enum ff_kind kind;
        ff_key key;
        int named;
        assert_true(ff_parts_next(&parts, &kind, &key, &named));
        assert_int_equal(ff_key_code(key), order[i]);
        assert_int_equal(named, i == 0);
        assert_int_equal(comes(&parts, 0), FF_OK);
    }
    assert_true(ff_parts_done(&parts));
}

static void an_answer_has_an_end(void **state)
{
    static ff_parts parts;
    ff_get_view view = least_view();
    unsigned count = 1;
    (void)state;
    view.count = 1;
    view.below[0] = ff_key_make(0, FF_KEY_LEVEL_MAX, 0);
    ff_parts_begin(&parts, &view);
    assert_int_equal(comes(&parts, 1), FF_ERR_FORMAT); /* nothing is finer */
    view.below[0] = ff_key_make(0, 0, 0);
    ff_parts_begin(&parts, &view);
    while (comes(&parts, 15) == FF_OK) count++;
    assert_in_range(count, FF_PARTS_MAX / 4, FF_PARTS_MAX / 4 + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_there_and_back),
        cmocka_unit_test(parts_there_and_back),
        cmocka_unit_test(ranges_hold_both_ways),
        cmocka_unit_test(a_view_covers_what_lies_below),
        cmocka_unit_test(parts_come_as_they_were_announced),
        cmocka_unit_test(what_comes_later_goes_to_the_end),
        cmocka_unit_test(roots_are_told_where_nothing_was_named),
        cmocka_unit_test(the_edge_comes_as_it_is_told),
        cmocka_unit_test(an_answer_has_an_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
