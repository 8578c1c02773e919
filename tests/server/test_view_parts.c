/* What a view needs, as the server finds it: what a client would ask for level by level, no more,
 * in an order that a client can use. */
#include "../rig/pack_fixture.h"
#include "../../client/terrain/ff_pack_source.h"
#include "../../server/view/ff_view_parts.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define METRE FF_WU_PER_METRE

static ff_pack pack;
static uint8_t *pack_bytes;
static ff_view_part part[FF_PARTS_MAX];
static ff_view_front front;

static int open_pack(void **state)
{
    size_t bytes;
    (void)state;
    pack_bytes = pack_fixture_usual(&bytes);
    return !pack_bytes || ff_pack_open(&pack, pack_bytes, bytes) != FF_OK;
}

static int close_pack(void **state)
{
    (void)state;
    free(pack_bytes);
    return 0;
}

static ff_get_view usual_view(void)
{
    return (ff_get_view){ .yaw = 3000,
                          .pitch = (uint16_t)-2500,
                          .position_wu = { 1500 * METRE, 700 * METRE, 1200 * METRE },
                          .focal_q8 = 208 * 256,
                          .width = 240,
                          .height = 320,
                          .measure = FF_VIEW_BY_PIXELS,
                          .allowed_q8 = 256,
                          .reach_wu = INT32_MAX,
                          .bytes_max = UINT32_MAX };
}

/* What a client's own tree asks for until it has all that it wishes for in view: how many, in
 * `asked`. */
static uint32_t asked_singly(const ff_get_view *view, ff_view_part *asked)
{
    ff_tree_desc desc = { .info = pack.header.info, .node_count = 4096, .wish_count = 64 };
    size_t bytes = ff_tree_bytes(&desc), decoder_bytes = ff_decoder_bytes(&desc.info);
    void *memory = malloc(bytes), *decoder_memory = malloc(decoder_bytes);
    ff_tree *tree = ff_tree_create(&desc, memory, bytes);
    ff_decoder *decoder = ff_decoder_create(&desc.info, decoder_memory, decoder_bytes);
    static int32_t values[FF_REFINED_HEIGHTS_MAX];
    ff_quality quality = { .measure = FF_MEASURE_PIXELS,
                           .error_px_q8 = view->allowed_q8,
                           .sigma_q8 = 320,
                           .view_wu = view->reach_wu };
    ff_view looks = { .camera = { .yaw = view->yaw,
                                  .pitch = (int16_t)view->pitch,
                                  .focal_q8 = view->focal_q8,
                                  .width = view->width,
                                  .height = view->height,
                                  .near_wu = 64,
                                  .far_wu = INT32_MAX } };
    uint32_t count = 0, served;
    memcpy(looks.camera.pos_wu, view->position_wu, sizeof looks.camera.pos_wu);
    memcpy(looks.centre_wu, view->position_wu, sizeof looks.centre_wu);
    do {
        const ff_wish *list;
        ff_wish wish[64];
        ff_tree_select(tree, &looks, &quality);
        uint32_t wishes = ff_tree_wishes(tree, &list);
        memcpy(wish, list, wishes * sizeof *list);
        served = 0;
        for (uint32_t i = 0; i < wishes; i++) {
            if (!wish[i].in_view) continue;
            asked[count++] = (ff_view_part){ .key = wish[i].key, .kind = wish[i].kind };
            served++;
            assert_int_equal(ff_pack_source_serve(&pack, decoder, values, tree,
                                                  (enum ff_kind)wish[i].kind, wish[i].key),
                             FF_OK);
        }
    } while (served);
    free(memory);
    free(decoder_memory);
    return count;
}

static int is_among(const ff_view_part *list, uint32_t count, ff_view_part one)
{
    for (uint32_t i = 0; i < count; i++)
        if (list[i].key == one.key && list[i].kind == one.kind) return 1;
    return 0;
}

/* 1 when what the part is decoded upon comes before it. */
static int has_its_parent(uint32_t i)
{
    ff_key key = part[i].key;
    if (part[i].kind == FF_KIND_ROOT) return 1;
    return ff_key_level(key) == 0
               ? is_among(part, i, (ff_view_part){ .key = key, .kind = FF_KIND_ROOT })
               : is_among(part, i,
                          (ff_view_part){ .key = ff_key_parent(key), .kind = FF_KIND_REFINEMENT });
}

static void all_of_a_view_and_no_more(void **state)
{
    static ff_view_part asked[FF_PARTS_MAX];
    (void)state;
    for (int32_t allowed_q8 = 128; allowed_q8 <= 2048; allowed_q8 *= 4) {
        ff_get_view view = usual_view();
        view.allowed_q8 = allowed_q8;
        uint32_t singly = asked_singly(&view, asked);
        int count = ff_view_parts(&pack, &view, part, &front);
        assert_int_equal(count, singly);
        for (uint32_t i = 0; i < singly; i++) {
            assert_true(is_among(part, singly, asked[i]));
            assert_true(has_its_parent(i));
            assert_false(is_among(part, i, part[i]));
        }
    }
}

static void what_is_named_comes_first_and_bounds_the_rest(void **state)
{
    (void)state;
    ff_get_view view = usual_view();
    int all = ff_view_parts(&pack, &view, part, &front);
    view.count = 2;
    view.roots = 2;
    view.below[0] = ff_key_make(1, 0, 0); /* what refines a root; and, of another, all */
    view.below[1] = ff_key_make(0, 0, 0);
    int count = ff_view_parts(&pack, &view, part, &front);
    assert_in_range(count, 4, all - 1);
    assert_int_equal(part[0].kind, FF_KIND_REFINEMENT);
    assert_int_equal(part[0].key, view.below[0]);
    assert_int_equal(part[1].kind, FF_KIND_ROOT);
    assert_int_equal(part[1].key, view.below[1]);
    for (int i = 0; i < count; i++) {
        assert_true(ff_view_covers(&view, (enum ff_kind)part[i].kind, part[i].key));
        assert_in_range(ff_key_tile(part[i].key), 0, 1);
        assert_false(is_among(part, (uint32_t)i, part[i]));
    }
    /* named although the view does not need it, and there is no such thing */
    view = usual_view();
    view.allowed_q8 = INT32_MAX;
    view.count = 1;
    view.below[0] = ff_key_make(3, 2, 15);
    assert_int_equal(ff_view_parts(&pack, &view, part, &front), 1);
    view.below[0] = ff_key_make(FF_KEY_TILES_MAX - 1, 15, 0x3fffffff);
    assert_int_equal(ff_view_parts(&pack, &view, part, &front), 1);
    assert_int_equal(ff_view_named(&view, part), 1);
}

/* What a client lacks beside what it names comes where the view needs it, and is told. */
static void the_edge_is_refined_where_it_is_needed(void **state)
{
    (void)state;
    ff_get_view view = usual_view();
    int all = ff_view_parts(&pack, &view, part, &front);
    assert_int_equal(front.edge, 0);
    assert_in_range(front.roots, 1, 4);
    view.count = 1;
    view.below[0] = ff_key_make(0, 0, 0);
    int less = ff_view_parts(&pack, &view, part, &front);
    assert_int_equal(front.roots, 0);
    view.edge_count = 4; /* of a client that has the roots */
    for (uint32_t i = 0; i < 3; i++) view.edge[i] = ff_key_make(1 + i, 0, 0);
    view.edge[3] = ff_key_make(FF_KEY_TILES_MAX - 1, 0, 0);
    int count = ff_view_parts(&pack, &view, part, &front);
    assert_in_range(count, less + 1, all);
    assert_true(front.edge != 0 && front.edge >> 3 == 0);
    for (uint32_t i = 0, at = 1; i < 3; i++) {
        if (!(front.edge >> i & 1u)) continue;
        assert_int_equal(part[at].key, view.edge[i]);
        assert_int_equal(part[at++].kind, FF_KIND_REFINEMENT);
    }
    view.allowed_q8 = INT32_MAX; /* nothing needs to be fine */
    assert_int_equal(ff_view_parts(&pack, &view, part, &front), 1);
    assert_int_equal(front.edge, 0);
}

static void bytes_are_bounded(void **state)
{
    (void)state;
    ff_get_view view = usual_view();
    int all = ff_view_parts(&pack, &view, part, &front), before = 0;
    for (view.bytes_max = 0; view.bytes_max < 4000; view.bytes_max += 500) {
        int count = ff_view_parts(&pack, &view, part, &front);
        uint64_t bytes = 0;
        for (int i = 0; i < count; i++) {
            const uint8_t *payload;
            enum ff_section_kind section = (enum ff_section_kind)ff_kind[part[i].kind].section;
            bytes += (uint64_t)ff_pack_record(&pack, section, part[i].key, &payload);
        }
        assert_in_range(count, before, all);
        assert_true(bytes <= view.bytes_max && bytes + 300 > view.bytes_max);
        before = count;
    }
}

/* Views from outside are any numbers in their ranges. */
static void any_view_is_answered(void **state)
{
    uint64_t x = 88172645463325252ull;
    (void)state;
    for (int i = 0; i < 300; i++) {
        uint64_t word[8];
        for (int k = 0; k < 8; k++) word[k] = (x ^= x << 13, x ^= x >> 7, x ^= x << 17);
        unsigned little = word[7] % 3 * 12;
        ff_get_view view = { .yaw = (uint16_t)word[0],
                             .pitch = (uint16_t)(word[0] >> 16),
                             .roll = (uint16_t)(word[0] >> 32),
                             .position_wu = { (int32_t)word[1] >> little,
                                              (int32_t)(word[1] >> 32) >> little,
                                              (int32_t)word[2] >> little },
                             .focal_q8 = 256 + (int32_t)(word[2] >> 34 >> little),
                             .width = (uint16_t)(1 + word[3] % FF_VIEW_SIDE_MAX),
                             .height = (uint16_t)(1 + (word[3] >> 20) % FF_VIEW_SIDE_MAX),
                             .measure = word[3] >> 63,
                             .depth_max = (uint8_t)((word[3] >> 50) % 17),
                             .allowed_q8 = 1 + (int32_t)(word[4] >> 34 >> little),
                             .reach_wu = 1 + (int32_t)((word[4] & 0x3fffffff) >> little),
                             .triangles_max = (uint32_t)word[5] >> little,
                             .bytes_max = (uint32_t)(word[5] >> 32) };
        int count = ff_view_parts(&pack, &view, part, &front);
        assert_in_range(count, 0, FF_PARTS_MAX);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_of_a_view_and_no_more),
        cmocka_unit_test(what_is_named_comes_first_and_bounds_the_rest),
        cmocka_unit_test(the_edge_is_refined_where_it_is_needed),
        cmocka_unit_test(bytes_are_bounded),
        cmocka_unit_test(any_view_is_answered),
    };
    return cmocka_run_group_tests(tests, open_pack, close_pack);
}
