/* Refinements that come without sides which the nodes across have: the same ground, in whatever
 * order, and asked for again where such a side has gone. */
#include "../../client/terrain/ff_pack_source.h"
#include "../../client/terrain/ff_tree_local.h"
#include "../rig/pack_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define ITEMS_MAX 512

static ff_pack pack;
static uint8_t *pack_bytes;
static int32_t values[FF_REFINED_HEIGHTS_MAX];
static uint32_t random_state = 1;

static uint32_t random_below(uint32_t limit)
{
    random_state = random_state * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)random_state * limit >> 32);
}

/* Two tiles of hills; the ground ends inside the eastern one. */
static int open_pack(void **state)
{
    pack_fixture_desc desc = { .info = pack_fixture_info(6, 2, 1), .height = pack_fixture_hills };
    size_t bytes;
    (void)state;
    desc.info.codec = FF_CODEC_TRAINED;
    desc.info.samples_x = 100;
    pack_bytes = pack_fixture_make(&desc, &bytes);
    return !pack_bytes || ff_pack_open(&pack, pack_bytes, bytes) != FF_OK;
}

static int close_pack(void **state)
{
    (void)state;
    free(pack_bytes);
    return 0;
}

typedef struct held {
    ff_tree *tree;
    ff_decoder *decoder;
    void *tree_memory, *decoder_memory;
} held;

static held open_tree(void)
{
    const ff_terrain_info *info = &pack.header.info;
    ff_tree_desc desc = { .info = *info, .node_count = 1024, .wish_count = 16 };
    held h = { .tree_memory = malloc(ff_tree_bytes(&desc)),
               .decoder_memory = malloc(ff_decoder_bytes(info)) };
    h.tree = ff_tree_create(&desc, h.tree_memory, ff_tree_bytes(&desc));
    h.decoder = ff_decoder_create(info, h.decoder_memory, ff_decoder_bytes(info));
    assert_true(h.tree && h.decoder);
    for (uint32_t tile = 0; tile < 2; tile++)
        assert_int_equal(ff_pack_source_serve(&pack, h.decoder, values, h.tree, FF_KIND_ROOT,
                                              ff_key_make(tile, 0, 0)),
                         FF_OK);
    return h;
}

static void close_tree(held *h)
{
    free(h->tree_memory);
    free(h->decoder_memory);
}

/* As a server answers. Bytes that were left out, or an error. */
static int deliver(held *h, ff_key key, unsigned sides)
{
    static uint8_t less[FF_PAYLOAD_BYTES_MAX];
    const uint8_t *payload;
    const ff_terrain_info *info = &pack.header.info;
    ff_residuals residuals = { .value = values, .cells = ff_shape_cells(info, key, 1) };
    int bytes = ff_pack_record(&pack, FF_SECTION_REFINEMENT, key, &payload);
    assert_true(bytes > 0);
    int fewer = ff_without_sides(info, payload, (size_t)bytes, sides, less);
    assert_true(fewer >= 0);
    if (fewer) payload = less;
    assert_int_equal(
        ff_decode_refinement(h->decoder, payload, (size_t)(fewer ? fewer : bytes), &residuals),
        FF_OK);
    int rc = ff_tree_deliver_children(h->tree, key, 0, &residuals);
    return rc == FF_OK ? bytes - (fewer ? fewer : bytes) : rc;
}

/* All of the pack's refinements, parents first, else as chance has it. */
static uint32_t by_chance(ff_key list[ITEMS_MAX])
{
    uint32_t count = 0, open = 2;
    ff_key wait[ITEMS_MAX] = { ff_key_make(0, 0, 0), ff_key_make(1, 0, 0) };
    while (open > 0) {
        const uint8_t *payload;
        uint32_t i = random_below(open);
        ff_key key = wait[i];
        wait[i] = wait[--open];
        if (ff_key_level(key) + 1 >= ff_terrain_levels(&pack.header.info) ||
            !ff_shape_has_ground(&pack.header.info, key) ||
            ff_pack_record(&pack, FF_SECTION_REFINEMENT, key, &payload) <= 0)
            continue;
        list[count++] = key;
        for (uint32_t q = 0; q < 4; q++) wait[open++] = ff_key_child(key, q);
        assert_true(count < ITEMS_MAX && open + 4 < ITEMS_MAX);
    }
    return count;
}

static void the_ground_is_the_same_in_any_order(void **state)
{
    static ff_key list[ITEMS_MAX];
    held whole = open_tree();
    uint32_t count = by_chance(list), with_all_sides = 0;
    (void)state;
    for (uint32_t i = 0; i < count; i++) deliver(&whole, list[i], 0);
    for (int run = 0; run < 20; run++) {
        held less = open_tree();
        int saved = 0;
        assert_int_equal(by_chance(list), count);
        for (uint32_t i = 0; i < count; i++) {
            unsigned sides = ff_tree_sides(less.tree, list[i]);
            int fewer = deliver(&less, list[i], sides);
            assert_true(fewer >= 0);
            saved += fewer;
            with_all_sides += sides == 15;
        }
        assert_true(saved > 300);
        for (uint32_t slot = 0; slot < whole.tree->node_count; slot++) {
            const ff_node *node = &whole.tree->node[slot];
            uint32_t other = ff_tree_find(less.tree, node->key);
            if (ff_tree_find(whole.tree, node->key) != slot) continue;
            assert_int_not_equal(other, FF_SLOT_NONE);
            assert_memory_equal(ff_heights_of(whole.tree, slot), ff_heights_of(less.tree, other),
                                2 * ff_heights_per_node(whole.tree));
        }
        close_tree(&less);
    }
    assert_true(with_all_sides > 0);
    close_tree(&whole);
}

/* Nothing is drawn that is made of what happens to be there. */
static void without_what_was_left_out_nothing_is_made(void **state)
{
    held h = open_tree();
    const ff_key west = ff_key_make(0, 0, 0), east = ff_key_make(1, 0, 0);
    ff_tree_stats stats;
    (void)state;
    assert_int_equal(ff_tree_sides(h.tree, east), 0);
    assert_true(deliver(&h, west, 0) >= 0);
    assert_int_equal(ff_tree_sides(h.tree, east), 1 << FF_SIDE_WEST);
    ff_tree_drop_children(h.tree, &h.tree->node[ff_tree_find(h.tree, west)]);
    assert_int_equal(deliver(&h, east, 1 << FF_SIDE_WEST), FF_ERR_NOT_FOUND);
    assert_int_equal(deliver(&h, east, 1 << FF_SIDE_SOUTH), FF_ERR_NOT_FOUND);
    ff_tree_get_stats(h.tree, &stats);
    assert_int_equal(stats.sides_gone, 2);
    assert_false(ff_node_has_children(&h.tree->node[ff_tree_find(h.tree, east)]));
    assert_true(deliver(&h, east, 0) >= 0);
    close_tree(&h);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_ground_is_the_same_in_any_order),
        cmocka_unit_test(without_what_was_left_out_nothing_is_made),
    };
    return cmocka_run_group_tests(tests, open_pack, close_pack);
}
