/* Several sources of one ground: who lacks what is not asked again, and what all lack is a stub. */
#include "../../client/terrain/ff_tree_local.h"
#include "../rig/grounds_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#define SOURCES 3

/* Source 0 has the western half down to level 3, 1 the east down to level 2, and 2 all of it. */
static int has(unsigned source, ff_key key)
{
    uint32_t level = ff_key_level(key);
    int east = ff_key_tile(key) % 3 == 2 || (ff_key_tile(key) % 3 == 1 && level > 0 &&
                                             ff_morton_x(ff_key_code(key)) >> (level - 1));
    if (source == 0) return !east && level < 3;
    return source == 1 ? east && level < 2 : 1;
}

static unsigned sending;

static int says_stub(ff_key key) { return !has(sending, key); }

static void make(grounds_fixture *g, uint32_t nodes)
{
    terrain_fixture fx;
    memset(g, 0, sizeof *g);
    g->source_max = SOURCES;
    fixture_make(&fx, 3, 7, 3, 2, fixture_hills);
    fx.is_stub = says_stub;
    grounds_add(g, &fx, 0, 0);
    grounds_tree(g, nodes, 64);
}

/* Asks one of those that serve and may have it, and hands on what it says. */
static void ask(grounds_fixture *g, const ff_wish *wish, unsigned mask)
{
    int refinement = wish->kind == FF_KIND_REFINEMENT;
    assert_true(mask & ~wish->lacks);
    for (sending = 0; !(mask >> sending & 1u) || wish->lacks >> sending & 1u;) sending++;
    if (refinement && !has(sending, wish->key))
        ff_tree_lacks(g->tree, wish->key, sending);
    else
        (void)fixture_deliver_from(&g->ground[0], wish->key, refinement, sending);
}

static uint32_t settle(grounds_fixture *g, const ff_view *view, unsigned mask)
{
    ff_quality quality = fixture_quality(FF_MEASURE_PIXELS);
    uint32_t asked = 0;
    for (int round = 0; round < 500; round++) {
        const ff_wish *list;
        ff_wish wish[FIXTURE_BAG];
        ff_tree_select(g->tree, view, &quality);
        fixture_assert_whole(&g->ground[0]);
        uint32_t count = ff_tree_wishes(g->tree, &list);
        if (count == 0) return asked;
        count = count > FIXTURE_BAG ? FIXTURE_BAG : count;
        memcpy(wish, list, count * sizeof *wish);
        for (uint32_t i = 0; i < count; i++) ask(g, &wish[i], mask);
        asked += count;
    }
    fail_msg("the tree does not settle");
    return 0;
}

static uint32_t finest_drawn(const grounds_fixture *g, int beyond_all, unsigned mask)
{
    const ff_drawn *list;
    uint32_t count = ff_tree_cut(g->tree, &list), stubs = 0;
    for (uint32_t i = 0; i < count; i++) {
        int anyone = 0;
        for (unsigned s = 0; s < SOURCES; s++) anyone |= mask >> s & 1u && has(s, list[i].key);
        if (list[i].stub) assert_false(anyone);
        stubs += list[i].stub;
    }
    assert_int_equal(stubs > 0, beyond_all);
    return stubs;
}

static void what_one_source_lacks_another_is_asked_for(void **state)
{
    (void)state;
    grounds_fixture g;
    make(&g, 3000);
    ff_view view = fixture_view_above(&g.ground[0], 1900, 1300, 60, 0, -40);
    ff_tree_set_sources(g.tree, 0, 3);
    settle(&g, &view, 3);
    finest_drawn(&g, 1, 3);
    /* one that has all comes: what nobody had is asked for again */
    ff_tree_set_sources(g.tree, 0, 7);
    assert_true(settle(&g, &view, 7) > 0);
    finest_drawn(&g, 0, 7);
    /* it goes: what is held is drawn, and nothing is asked of those left that they lack */
    ff_tree_set_sources(g.tree, 0, 3);
    assert_int_equal(settle(&g, &view, 3), 0);
    grounds_free(&g);
}

/* Nodes that give way and come again are asked about anew. */
static void sources_come_and_go_with_any_pool(void **state)
{
    (void)state;
    for (uint32_t nodes = 40; nodes < 3000; nodes *= 3) {
        grounds_fixture g;
        make(&g, nodes);
        for (int step = 0; step < 24; step++) {
            unsigned mask = step % 7 + 1u;
            ff_view view = fixture_view_above(&g.ground[0], 300 + step * 130, 400 + step * 80, 80,
                                              step * 40, -25);
            ff_tree_set_sources(g.tree, 0, (uint8_t)mask);
            settle(&g, &view, mask);
        }
        grounds_free(&g);
    }
}

static void one_source_alone_takes_no_memory(void **state)
{
    (void)state;
    ff_tree_desc desc = { .node_count = 1000, .wish_count = 64 };
    terrain_fixture fx;
    fixture_make(&fx, 3, 7, 3, 2, fixture_hills);
    desc.info = fx.info;
    size_t one = ff_tree_bytes(&desc);
    desc.source_max = 1;
    assert_int_equal(ff_tree_bytes(&desc), one);
    desc.source_max = 2;
    assert_in_range(ff_tree_bytes(&desc), one + 1000, one + 1040);
    desc.source_max = FF_SOURCES_MAX + 1;
    assert_int_equal(ff_tree_bytes(&desc), 0);
}

/* One may lack an image that another has. */
static void images_of_several_sources_are_whole_for_nobody(void **state)
{
    (void)state;
    for (unsigned mask = 0; mask < 8; mask++) {
        grounds_fixture g;
        uint32_t count;
        make(&g, 40);
        ff_terrain_info *ground = (ff_terrain_info *)ff_tree_grounds(g.tree, &count);
        ground->images_whole = 3;
        ff_tree_set_sources(g.tree, 0, (uint8_t)mask);
        assert_int_equal(ground->images_whole, mask == 3 || mask >= 5 ? 0 : 3);
        grounds_free(&g);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_one_source_lacks_another_is_asked_for),
        cmocka_unit_test(sources_come_and_go_with_any_pool),
        cmocka_unit_test(images_of_several_sources_are_whole_for_nobody),
        cmocka_unit_test(one_source_alone_takes_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
