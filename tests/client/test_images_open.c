/* Images of a part of the ground: what an image tells to lie beyond them shows colours, and nothing
 * is asked for there, near or far, of JPEGs and pictures alike. */
#include "../../client/ff_client_local.h"
#include "../../common3d/soft/c3d_soft.h"
#include "../rig/client_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#define MB    ((size_t)1 << 20)
#define LOG2  5
#define NAMES 256

/* What a client draws, and images of its ground as this test likes them: they are held by name, and
 * count as on the device. */
typedef struct scene {
    client_rig rig;
    ff_textures textures;
    ff_texture_slot slot[NAMES];
    ff_wear wear[FF_WEAR_MAX];
    ff_texture_wish list[NAMES];
    const ff_drawn *drawn;
    uint32_t drawn_count;
} scene;

static void open_scene(scene *s, int depth_max)
{
    memset(s, 0, sizeof *s);
    rig_open(&s->rig, LOG2);
    s->rig.desc.backend = c3d_backend_soft();
    s->rig.desc.surface_api = sys_surface_memory();
    s->rig.desc.quality.depth_max = (uint8_t)depth_max;
    rig_client(&s->rig, 4 * MB);
    assert_true(rig_settle(&s->rig, 600));
    s->drawn_count = ff_tree_drawn(ff_client_tree(s->rig.client), &s->drawn);
    s->textures = (ff_textures){ .info = s->rig.client->textures.info,
                                 .texel_px_q8 = FF_TEXEL_PX_Q8,
                                 .slot = s->slot,
                                 .slot_count = NAMES,
                                 .texture_count = NAMES,
                                 .wear = s->wear };
}

static void hold(scene *s, ff_key key, unsigned open)
{
    const ff_image_marks marks = { 0, open & 15u };
    assert_int_equal(ff_textures_put(&s->textures, key, marks, NULL), 1);
    for (unsigned i = 0; i < NAMES; i++)
        if (s->slot[i].tag && s->slot[i].key == key && open != 15) s->slot[i].texture.id = 1 + i;
}

static void hold_roots(scene *s, unsigned open)
{
    for (uint32_t tile = 0; tile < 4; tile++) hold(s, ff_key_make(tile, 0, 0), open);
}

static uint32_t wishes(scene *s)
{
    int changed = 0;
    return ff_textures_wishes(&s->textures, s->rig.client->tree, s->drawn, s->drawn_count,
                              &s->rig.client->last_view, &s->rig.client->desc.quality, s->list,
                              NAMES, &changed);
}

static ff_key above(ff_key key, uint32_t level)
{
    while (ff_key_level(key) > level) key = ff_key_parent(key);
    return key;
}

static unsigned worn(scene *s, uint32_t i, ff_wear list[FF_WEAR_MAX])
{
    const ff_view *view = &s->rig.client->last_view;
    const ff_texel_look look = ff_textures_look(&s->textures, &view->frame, &view->camera);
    return ff_textures_worn(&s->textures, s->rig.client->tree, &s->drawn[i], &look, list);
}

/* In child 2 of each root. */
static int is_beyond(ff_key key)
{
    return ff_key_level(key) > 0 && ff_key_quadrant(above(key, 1)) == 2;
}

static void nothing_is_asked_for_beyond_an_image(void **state)
{
    (void)state;
    scene s;
    open_scene(&s, 0);
    hold_roots(&s, 0);
    uint32_t all = wishes(&s), beyond = 0;
    for (uint32_t i = 0; i < all; i++) beyond += (uint32_t)is_beyond(s.list[i].key);
    assert_in_range(beyond, 1, all - 1);
    for (unsigned i = 0; i < NAMES; i++) s.slot[i].marks.open = 1 << 2;
    assert_int_equal(wishes(&s), all - beyond);
    for (uint32_t i = 0; i < all - beyond; i++) assert_false(is_beyond(s.list[i].key));
    rig_close(&s.rig);
}

static void ground_beyond_an_image_shows_colours_and_the_rest_the_image(void **state)
{
    (void)state;
    scene s;
    unsigned coloured = 0, dressed = 0;
    open_scene(&s, 0);
    hold_roots(&s, 1 << 2);
    for (uint32_t i = 0; i < s.drawn_count; i++) {
        ff_wear list[FF_WEAR_MAX];
        ff_key key = s.drawn[i].key;
        if (!ff_key_level(key)) continue;
        assert_int_equal(worn(&s, i, list), 1); /* nothing finer than roots is held */
        assert_true(list[0].image == (is_beyond(key) ? FF_KEY_NONE : above(key, 0)));
        *(is_beyond(key) ? &coloured : &dressed) += 1;
    }
    assert_true(coloured > 0 && dressed > 0);
    rig_close(&s.rig);
}

/* So an image ends at the half of a node that is drawn as large as it. */
static void a_node_shows_colours_on_the_squares_beyond_its_own_image(void **state)
{
    (void)state;
    scene s;
    open_scene(&s, 1); /* roots are drawn */
    hold_roots(&s, 1 << 2);
    for (uint32_t i = 0; i < s.drawn_count; i++) {
        ff_wear list[FF_WEAR_MAX];
        ff_key key = s.drawn[i].key;
        unsigned log2 = s.textures.info.node_log2;
        ff_squares open = ff_wear_squares(log2, key, ff_key_child(key, 2)),
                   all = ff_wear_squares(log2, key, key);
        assert_int_equal(ff_key_level(key), 0);
        assert_int_equal(worn(&s, i, list), 2);
        assert_true(list[0].image == key && list[1].image == FF_KEY_NONE); /* colours come last */
        assert_true(list[1].squares == open);
        assert_true((list[0].squares & all) == (all & ~open));
    }
    rig_close(&s.rig);
}

static void under_an_open_root_all_is_colours(void **state)
{
    (void)state;
    scene s;
    open_scene(&s, 0);
    hold_roots(&s, 15);
    for (uint32_t i = 0; i < s.drawn_count; i++) {
        ff_wear list[FF_WEAR_MAX];
        assert_int_equal(worn(&s, i, list), 1);
        assert_true(list[0].image == FF_KEY_NONE);
    }
    assert_int_equal(wishes(&s), 0);
    assert_int_equal(s.textures.lacking, 0);
    rig_close(&s.rig);
}

/* Of a pack of which the device holds a part, others may have the images that this says are left
 * out, but not those that there are not. */
static void what_is_beyond_an_image_is_so_for_all_sources(void **state)
{
    (void)state;
    scene s;
    open_scene(&s, 0);
    hold_roots(&s, 1 << 2);
    uint32_t count = wishes(&s);
    for (unsigned i = 0; i < NAMES; i++) s.slot[i].marks.bare = 1 << 1;
    assert_true(wishes(&s) < count);
    ff_textures_doubt(&s.textures);
    assert_int_equal(wishes(&s), count);
    rig_close(&s.rig);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_asked_for_beyond_an_image),
        cmocka_unit_test(ground_beyond_an_image_shows_colours_and_the_rest_the_image),
        cmocka_unit_test(a_node_shows_colours_on_the_squares_beyond_its_own_image),
        cmocka_unit_test(under_an_open_root_all_is_colours),
        cmocka_unit_test(what_is_beyond_an_image_is_so_for_all_sources)
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
