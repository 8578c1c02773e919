/* From far set to far set: how long a fade lasts, and what is thrown and seen meanwhile. */
#include "../rig/flat_ground.h"
#include "../rig/picture.h"
#include "../../client/far/ff_sets.h"
#include "../../client/terrain/ff_tree_local.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define M FF_WU_PER_METRE

enum { WIDE = 240, HIGH = 160, FOCAL = 208, SIDE = 128, FRAME_US = 30000 };
static const int64_t start_us = 5000000;

typedef struct stage {
    picture_kit kit;
    ff_sets sets;
    ff_terrain_info info;
    ff_requests requests;
    ff_motion motion;
    c3d_vertex scratch[81];
    uint16_t indices[2 * 81];
    uint64_t memory[4096];
    uint8_t rgb[WIDE * HIGH * 3];
} stage;

static void open_stage(stage *s)
{
    const ff_far_desc desc = { .enabled = FF_FAR_PAINT, .front_wu = 1000 * M, .coarse = 4 };
    memset(s, 0, sizeof *s);
    assert_int_equal(picture_open(&s->kit, PICTURE_SOFT, WIDE, HIGH, 0), FF_OK);
    s->info = flat_ground();
    ff_sets_init(&s->sets, s->kit.device, &desc, &s->info, SIDE);
    ff_sets_scratch(&s->sets, s->scratch, s->indices, 81);
    assert_true(ff_requests_bytes(8) <= sizeof s->memory);
    ff_requests_init(&s->requests, 8, s->memory);
    s->kit.frame.camera = flat_ground_camera(WIDE, HIGH, FOCAL);
}

/* A set with one fin in sector 0, 10 km away, under paint of one colour; nothing in the others. */
static void give_set(stage *s, int index, uint16_t colour)
{
    static uint8_t slot[FF_FAR_VERTICES_MAX * sizeof(ff_fin_vertex) + SIDE * SIDE * 2];
    ff_set *set = &s->sets.set[index];
    const c3d_camera *camera = &s->kit.frame.camera;
    ff_fin_vertex *fin = (ff_fin_vertex *)(void *)slot;
    uint16_t *texel = (uint16_t *)(void *)(fin + FF_FAR_VERTICES_MAX);
    *set = (ff_set){ .key = (ff_key)index + 1, .front_wu = 1000 * M, .focal = FOCAL, .painted = 1 };
    set->region = (ff_set_region){ .behind_wu = M, .ahead_wu = M, .aside_wu = M, .high_wu = M };
    memcpy(set->position_wu, camera->pos_wu, sizeof set->position_wu);
    for (int i = 0; i < 2; i++)
        fin[i] = (ff_fin_vertex){ .column = (int16_t)(80 * i - 40),
                                  .up_q2 = 80,
                                  .distance = (uint16_t)ff_far_distance_step(10000 * M),
                                  .begins = i == 0 };
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE, y = i / SIDE;
        texel[i] = x > 0 && x < SIDE - 1 && y > 0 && y < SIDE - 1 ? colour : 0;
    }
    ff_new_item item = { .key = set->key,
                         .kind = FF_KIND_FAR,
                         .pixels = (uint16_t *)(void *)slot,
                         .width = SIDE,
                         .height = SIDE,
                         .u.far = { .fins = 2, .middle = SIDE / 2, .top = SIDE / 2 } };
    assert_int_equal(ff_sets_take(&s->sets, &item, 0), 1);
    set->empty = (uint16_t)(ff_sets_in_view(camera) & ~1u);
}

static int update(stage *s, int64_t now_us, int hold)
{
    return ff_sets_update(&s->sets, &s->requests, &s->kit.frame.camera, &s->motion, 600 * M, hold,
                          now_us);
}

/* One set is drawn, another one takes over. */
static void swap(stage *s)
{
    give_set(s, 0, 0xF801);
    give_set(s, 1, 0x003F);
    s->sets.active = 0;
    s->sets.next = 1;
    assert_int_equal(update(s, start_us, 1), 1);
    assert_int_equal(s->sets.active, 1);
    assert_int_equal(s->sets.under, 0);
}

static void a_fade_lasts_as_long_as_is_said(void **state)
{
    (void)state;
    static stage s;
    c3d_stats stats;
    int64_t now_us = start_us;
    open_stage(&s);
    swap(&s);
    unsigned last = s.sets.through;
    assert_in_range(last, 250, 255);
    for (now_us += FRAME_US; now_us < start_us + FF_SETS_FADE_US; now_us += FRAME_US) {
        assert_int_equal(update(&s, now_us, 1), 1);
        assert_in_range(s.sets.through, 1, last - 1);
        last = s.sets.through;
    }
    assert_in_range(last, 1, 30);
    assert_int_equal(update(&s, now_us, 1), 1); /* once more, without the other */
    assert_int_equal(s.sets.through, 0);
    assert_int_equal(s.sets.under, -1);
    assert_int_equal(s.sets.set[0].key, 0);
    c3d_get_stats(s.kit.device, &stats);
    assert_int_equal(stats.texture_held, 1);
    for (int i = 0; i < 10; i++) assert_int_equal(update(&s, now_us += FRAME_US, 1), 0);
    picture_close(&s.kit);
}

static void a_fade_ends_when_the_clock_jumps(void **state)
{
    (void)state;
    static const int64_t by_us[] = { 10000000, -10000000 };
    for (int i = 0; i < 2; i++) {
        static stage s;
        open_stage(&s);
        swap(&s);
        assert_int_equal(update(&s, start_us + by_us[i], 1), 1);
        assert_int_equal(s.sets.under, -1);
        picture_close(&s.kit);
    }
}

static void no_set_is_begun_in_the_place_of_one_that_fades(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s);
    swap(&s);
    s.sets.set[1].position_wu[0] += 3 * M; /* it is good no more */
    (void)update(&s, start_us + FRAME_US, 0);
    assert_int_equal(s.sets.serial, 0);
    assert_int_equal(s.sets.set[0].key, 1);
    (void)update(&s, start_us + FF_SETS_FADE_US, 0);
    assert_int_equal(s.sets.serial, 1);
    assert_int_equal(s.sets.next, 0);
    picture_close(&s.kit);
}

static void who_leaves_both_behind_has_none(void **state)
{
    (void)state;
    static stage s;
    c3d_stats stats;
    open_stage(&s);
    swap(&s);
    s.kit.frame.camera.pos_wu[1] += 1000 * M;
    assert_int_equal(update(&s, start_us + FRAME_US, 1), 1);
    assert_int_equal(s.sets.active, -1);
    assert_int_equal(s.sets.under, -1);
    c3d_get_stats(s.kit.device, &stats);
    assert_int_equal(stats.texture_held, 0);
    assert_int_equal(update(&s, start_us + 2 * FRAME_US, 1), 0);
    picture_close(&s.kit);
}

/* ---- pictures ---- */

/* The colour in the middle of the fin. */
static const uint8_t *show(stage *s)
{
    c3d_begin(s->kit.device, &s->kit.frame);
    ff_sets_aim(&s->sets, &s->kit.frame.camera);
    ff_sets_draw(&s->sets, &s->kit.frame.camera);
    c3d_end(s->kit.device);
    assert_int_equal(c3d_read_rgb(s->kit.device, s->rgb), FF_OK);
    return s->rgb + 3 * ((HIGH / 2 - 15) * WIDE + WIDE / 2);
}

static void colours_go_from_one_to_the_other(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s);
    swap(&s);
    for (int64_t past_us = 0; past_us <= FF_SETS_FADE_US; past_us += FRAME_US) {
        int expected = (int)(255 * past_us / FF_SETS_FADE_US);
        (void)update(&s, start_us + past_us, 1);
        const uint8_t *pixel = show(&s);
        assert_in_range(pixel[2] + 4, expected, expected + 8);
        assert_in_range(pixel[0] + 4, 255 - expected, 255 - expected + 8);
        assert_in_range(pixel[1], 0, 4);
    }
    picture_close(&s.kit);
}

/* It comes over the colours that the fins have by themselves. */
static void the_first_set_fades_in(void **state)
{
    (void)state;
    static stage s;
    open_stage(&s);
    give_set(&s, 0, 0x003F);
    s.sets.next = 0;
    assert_int_equal(update(&s, start_us, 1), 1);
    assert_int_equal(s.sets.under, -1);
    int bare = show(&s)[1];
    assert_true(bare > 40);
    assert_int_equal(update(&s, start_us + FF_SETS_FADE_US / 2, 1), 1);
    assert_in_range(show(&s)[1], bare / 2 - 4, bare / 2 + 4);
    assert_int_equal(update(&s, start_us + FF_SETS_FADE_US, 1), 1);
    assert_int_equal(show(&s)[1], 0);
    picture_close(&s.kit);
}

/* Whoever needs no sets any more: the drawn one goes as the first came; what is coming, at once. */
static void the_last_set_fades_out(void **state)
{
    (void)state;
    static stage s;
    c3d_stats stats;
    open_stage(&s);
    give_set(&s, 0, 0x003F);
    give_set(&s, 1, 0xF801);
    s.sets.active = 0;
    s.sets.next = 1;
    assert_int_equal(show(&s)[1], 0);
    ff_sets_leave(&s.sets, &s.requests, start_us);
    assert_int_equal(s.sets.active, -1);
    assert_int_equal(s.sets.next, -1);
    c3d_get_stats(s.kit.device, &stats);
    assert_int_equal(stats.texture_held, 1);
    int last = show(&s)[1];
    assert_in_range(last, 0, 4);
    for (int64_t past_us = FRAME_US; past_us < FF_SETS_FADE_US; past_us += FRAME_US) {
        assert_int_equal(update(&s, start_us + past_us, 1), 1);
        int green = show(&s)[1]; /* of the fin's own colour */
        assert_true(green >= last + 4);
        last = green;
    }
    assert_true(last > 40);
    assert_int_equal(update(&s, start_us + FF_SETS_FADE_US, 1), 1);
    c3d_get_stats(s.kit.device, &stats);
    assert_int_equal(stats.texture_held, 0);
    assert_int_equal(update(&s, start_us + FF_SETS_FADE_US, 1), 0);
    picture_close(&s.kit);
}

/* Of both sets on a node the lower one lies as it is; alone it fades out. */
static void nodes_wear_both(void **state)
{
    (void)state;
    static stage s;
    const ff_frame world = { 0 };
    ff_node node = { .key = ff_key_make(0, 0, 0) };
    const uint16_t heights[81] = { 0 };
    const ff_squares *without[FF_THROWS_MAX] = { NULL };
    ff_drawn drawn = { .key = node.key, .node = &node, .heights = heights };
    open_stage(&s);
    node.placed = ff_shape_put(&s.info, &world, node.key);
    for (int image = 0; image < 2; image++)
        for (int both = 0; both < 2; both++) {
            for (int i = 0; i < 2; i++) {
                ff_set *set = &s.sets.set[i];
                set->front_wu = i && !both ? 100000 * M : 1000 * M;
                set->position_wu[0] = 11000 * M;
                set->position_wu[1] = -40000 * M;
                for (unsigned k = 0; k < FF_FAR_SECTORS; k++)
                    set->sector[k].paint.id = (uint32_t)i * 100 + k + 1;
            }
            s.sets.under = 0;
            s.sets.active = 1;
            s.sets.through = 200;
            c3d_draw draws[FF_THROWS_MAX] = { { .flags = image ? C3D_DRAW_TEXTURED
                                                               : C3D_DRAW_COLOURED } };
            ff_view_kept kept = { 0 };
            unsigned count = ff_sets_lay(&s.sets, &s.info, &drawn, &kept, draws, without),
                     of[2] = { 0, 0 };
            int plain = image || !both;
            assert_int_equal(!(draws[0].flags & C3D_DRAW_PROJECTED), plain);
            for (unsigned i = (unsigned)plain; i < count; i++) {
                int upper = draws[i].texture.id > 100;
                assert_true(draws[i].flags & C3D_DRAW_PROJECTED);
                assert_int_equal(draws[i].through, upper ? 200 : both ? 0 : 56);
                assert_true(i == 0 || (draws[i].flags & C3D_DRAW_ALPHA_TEST));
                assert_true(upper || of[1] == 0); /* the lower one first */
                of[upper]++;
            }
            assert_int_equal(of[0], 3);
            assert_int_equal(of[1], both ? 3 : 0);
        }
    memset(s.sets.set, 0, sizeof s.sets.set);
    picture_close(&s.kit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fade_lasts_as_long_as_is_said),
        cmocka_unit_test(a_fade_ends_when_the_clock_jumps),
        cmocka_unit_test(no_set_is_begun_in_the_place_of_one_that_fades),
        cmocka_unit_test(who_leaves_both_behind_has_none),
        cmocka_unit_test(colours_go_from_one_to_the_other),
        cmocka_unit_test(the_first_set_fades_in),
        cmocka_unit_test(the_last_set_fades_out),
        cmocka_unit_test(nodes_wear_both),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
